"""The definitions of robustness, written once. Every pair that any algorithm finds is re-checked here.

For a node set S: ``X_S^r = { i in S : |N_i \\ S| >= r }``; S is *r-reachable* when ``X_S^r`` is nonempty
(SOME node of S, not all). A digraph is *(r,s)-robust* when for every pair of nonempty disjoint S1, S2 at
least one of these holds: ``X_S1 = S1``; ``X_S2 = S2``; ``|X_S1| + |X_S2| >= s``. It is *r-robust* when
it is (r,1)-robust (LeBlanc, Zhang, Koutsoukos, Sundaram 2013, Definitions 11 to 13; Definition 1 of the
source paper).

Corners, settled here for the whole toolkit:

* No graph on n nodes is more than ``ceil(n/2)``-robust. For n <= 1 no pair exists and the definition says nothing;
  the convention of LeBlanc et al. is kept: the empty graph is (0,1)-robust, the graph on one node (1,1)-robust.
* Every graph is (0,s)-robust, since ``X_S^0 = S``.
* ``s`` lies in ``1..n`` (1 for the empty graph); for s > n the third condition could never hold.
* Self-loops, parallel edges and weights are invisible to the definitions.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Set

import numpy as np
import numpy.typing as npt

from certificates.graph import Label
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.evidence import Pair
from robustness.whole_numbers import taking_numpy_integers

__all__ = [
    "MANY",
    "half_split",
    "heard_outside",
    "is_violation",
    "largest_conceivable_r",
    "r_reachable_ids",
    "r_reachable_nodes",
    "require_r_and_s",
]


#: Larger sets are counted by arrays over the whole graph, which is faster then; both count the same.
MANY = 256


def heard_outside(graph: Digraph, members: Set[int]) -> npt.NDArray[np.int64]:
    """Return ``|N_i \\ S|`` for every id i and S = ``members``, shape ``(n,)``; linear in the graph."""
    outside = np.ones(graph.n, dtype=np.int64)
    outside[list(members)] = 0
    before = np.concatenate([[0], np.cumsum(outside[graph.in_indices])])
    heard: npt.NDArray[np.int64] = before[graph.in_indptr[1:]] - before[graph.in_indptr[:-1]]
    return heard


def r_reachable_ids(graph: Digraph, members: Set[int], r: int) -> frozenset[int]:
    """Return ``X_S^r`` for S = ``members``: the ids of S with at least r in-neighbours outside S."""
    if len(members) > MANY:
        return frozenset(members) & frozenset(np.flatnonzero(heard_outside(graph, members) >= r).tolist())
    return frozenset(i for i in members if sum(j not in members for j in graph.in_neighbours(i).tolist()) >= r)


def is_violation(graph: Digraph, first: Set[int], second: Set[int], r: int, s: int) -> bool:
    """Return whether the pair (S1, S2) of id sets shows that ``graph`` is not (r,s)-robust."""
    if not first or not second or first & second:
        return False
    x1, x2 = r_reachable_ids(graph, first, r), r_reachable_ids(graph, second, r)
    return x1 != first and x2 != second and len(x1) + len(x2) < s


def largest_conceivable_r(n: int) -> int:
    """Return ``ceil(n/2)``, which no r* on n nodes exceeds (Lemma 1 (v); split the nodes in two halves)."""
    return (n + 1) // 2


def half_split(graph: Digraph) -> Pair:
    """Return two halves of n >= 2 nodes: nobody hears more than ceil(n/2) across, so they violate every greater r."""
    half = graph.n // 2
    return Pair(frozenset(range(half)), frozenset(range(half, graph.n)))


def require_r_and_s(graph: Digraph, r: int, s: int = 1) -> None:
    """Guarantees that r >= 0 and 1 <= s <= max(n, 1) are integers, or raises :class:`InvalidParameter`."""
    if type(r) is not int or r < 0:
        raise InvalidParameter(f"r is an integer of at least 0, not {r!r}")
    if type(s) is not int or not 1 <= s <= max(graph.n, 1):
        raise InvalidParameter(f"s is an integer in 1..n = 1..{max(graph.n, 1)}, not {s!r}")


@taking_numpy_integers
def r_reachable_nodes(G: GraphLike, S: Iterable[Hashable], r: int) -> frozenset[Label]:
    """Return ``X_S^r = { i in S : |N_i \\ S| >= r }``, the nodes of S with at least r in-neighbours outside S.

    Parameters
    ----------
    G : networkx graph or Digraph
        An arc ``(u, v)`` means v hears u.
    S : iterable of nodes
        Any set of nodes of G.
    r : int
        At least 0.

    Raises
    ------
    InvalidGraph
        When S holds something that is not a node of G.

    Notes
    -----
    Linear in the in-degrees of S. Source: LeBlanc et al. 2013, Definition 12.

    >>> import networkx as nx
    >>> sorted(r_reachable_nodes(nx.path_graph(4), {0, 1}, 1))
    [1]
    """
    graph = as_digraph(G)
    require_r_and_s(graph, r)
    return graph.labels_of(r_reachable_ids(graph, graph.ids(S), r))
