"""Traps: what makes delayed resilient consensus fail although the graph is robust enough without delays.

A *trap for f* in a digraph is a triple (M, S1, S2) of disjoint node sets with ``|M| <= f`` and S1, S2 nonempty, such
that every node of S1 has at most f in-neighbours outside ``S1 ∪ M``, and every node of S2 at most f outside ``S2 ∪
M``.

Why it traps: start S1 at a, S2 at b and all others between. Each node of M alternates between a and b, and the delays
are chosen so that S1 always sees M at a and S2 always at b. All other outside values that a node of S1 hears are at
most f, so it drops them: S1 stays at a and S2 at b for ever. Proposition 1 of the source paper is one instance.

A trap for f exists iff for some M with at most f nodes the graph without M is not (f+1)-robust: (S1, S2) is
a pair that violates it.
"""

from __future__ import annotations

import time
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from itertools import combinations

from certificates.graph import Label
from robustness.decision.front import check_rs_robustness
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.results import Verdict

__all__ = ["Trap", "find_trap", "is_trap"]


@dataclass(frozen=True, slots=True)
class Trap:
    """A trap (M, S1, S2); see the module."""

    M: frozenset[Label]
    S1: frozenset[Label]
    S2: frozenset[Label]

    def as_dict(self) -> dict[str, list[Label]]:
        """Return the sets as sorted lists, as kept in ``G.graph["trap"]``."""
        return {name: sorted(getattr(self, name), key=repr) for name in ("M", "S1", "S2")}


def is_trap(G: GraphLike, f: int, M: Iterable[Hashable], S1: Iterable[Hashable], S2: Iterable[Hashable]) -> bool:
    """Return whether (M, S1, S2) is a trap for f in G.

    Parameters
    ----------
    G : networkx graph or Digraph
        An arc ``(u, v)`` means v hears u.
    f : int
        At least 0.
    M, S1, S2 : iterables of nodes
        The malicious set and the two sets held apart.

    Raises
    ------
    InvalidParameter
        For a negative f.
    InvalidGraph
        When a set holds something that is not a node of G.

    Notes
    -----
    Linear in the in-degrees of S1 and S2.

    >>> import networkx as nx
    >>> is_trap(nx.wheel_graph(5), 1, {0}, {1, 2}, {3, 4})
    True
    """
    _require_f(f)
    graph = as_digraph(G)
    m, first, second = graph.ids(M), graph.ids(S1), graph.ids(S2)
    if not first or not second or len(m) > f or m & first or m & second or first & second:
        return False
    return all(
        sum(j not in side and j not in m for j in graph.in_neighbours(i).tolist()) <= f
        for side in (first, second)
        for i in side
    )


def find_trap(G: GraphLike, f: int, *, time_limit: float | None = None) -> Trap | None:
    """Return a trap for f in G with a smallest M, or None when G has none.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    time_limit : float, optional
        Wall-clock seconds in all.

    Raises
    ------
    Undecided
        When the limit stopped the search and no trap was found.

    Notes
    -----
    Straight from the equivalence in the module: one exact (f+1)-robustness check for each of the
    ``sum C(n, m), m <= f`` sets M. For small n and f.

    >>> import networkx as nx
    >>> find_trap(nx.wheel_graph(5), 1).M
    frozenset({0})
    >>> find_trap(nx.complete_graph(5), 1) is None
    True
    """
    _require_f(f)
    graph = as_digraph(G)
    deadline = None if time_limit is None else time.monotonic() + time_limit
    for size in range(min(f, graph.n - 2) + 1):
        for removed in combinations(range(graph.n), size):
            left = None if deadline is None else max(deadline - time.monotonic(), 1e-6)
            result = check_rs_robustness(without(graph, frozenset(removed)), f + 1, time_limit=left)
            if result.verdict is Verdict.UNDECIDED:
                raise Undecided(f"whether a trap for f = {f} exists was not decided: raise the time limit")
            if result.witness is not None:
                return Trap(graph.labels_of(removed), result.witness.S1, result.witness.S2)
    return None


def without(graph: Digraph, removed: frozenset[int]) -> Digraph:
    """Return the graph without the nodes whose ids are in ``removed``."""
    kept = [label for i, label in enumerate(graph.labels) if i not in removed]
    arcs = [(graph.labels[u], graph.labels[v]) for u, v in graph.arcs() if u not in removed and v not in removed]
    return Digraph(kept, arcs, directed=graph.directed)


def _require_f(f: int) -> None:
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
