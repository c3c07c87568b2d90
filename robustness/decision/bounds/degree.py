"""The degree rule: nodes that hear more than half of the others make any graph robust.

Theorem. If every node has at least ``floor(n/2) + r - 1`` in-neighbours, the graph is (r,s)-robust for every s.

Proof. Of two disjoint sets the smaller, S, has at most floor(n/2) nodes, so each of its nodes has at most
floor(n/2) - 1 in-neighbours inside and at least r outside: X_S = S. ∎ (For complete graphs this is Lemma 1 (v) of
the source paper.)
"""

from __future__ import annotations

from robustness.digraph import Digraph
from robustness.results import Bound, Bounds
from robustness.spelled import counted

__all__ = ["degree_bound", "robust_by_degree", "sufficient_degree"]


def sufficient_degree(n: int, r: int) -> int:
    """Return the in-degree of the theorem, ``floor(n/2) + r - 1``."""
    return n // 2 + r - 1


def robust_by_degree(graph: Digraph, r: int) -> bool:
    """Return whether the degree rule proves ``graph`` to be (r,s)-robust for every s; False says nothing.

    >>> robust_by_degree(Digraph(range(3), [(i, j) for i in range(3) for j in range(3) if i != j]), 2)
    True
    """
    return graph.n >= 2 and int(graph.in_degrees.min()) >= sufficient_degree(graph.n, r)


def degree_bound(graph: Digraph) -> Bound:
    """Return the lower bound on r* that the degree rule gives, ``min in-degree - floor(n/2) + 1`` or 0."""
    if graph.n < 2:
        return Bounds.by_convention(graph.n).lower
    least = int(graph.in_degrees.min())
    value = max(0, least - graph.n // 2 + 1)
    return Bound(value, f"degree: every node hears at least {least} of {counted(graph.n, 'node')}" if value else "none")
