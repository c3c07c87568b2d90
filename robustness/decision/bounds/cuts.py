"""Upper bounds on r* that structure gives at once, each with its violating pair.

* ``ceil(n/2)``: in a split into two halves nobody has more than ceil(n/2) in-neighbours across.
* ``max(1, min in-degree)``: the node v of smallest in-degree against all others. Nobody else hears more than
  one node, v, across, so the pair violates every r >= 2 with d_v < r.
* a separating node: in an undirected graph, two components of G - v hear only v from outside. The pair violates r = 2.
* two closed sets: see :mod:`robustness.decision.bounds.reaching`. The pair violates r = 1.
"""

from __future__ import annotations

import numpy as np

from robustness.decision.bounds.reaching import one_robustness
from robustness.definitions import half_split, largest_conceivable_r
from robustness.digraph import Digraph
from robustness.evidence import Pair

__all__ = ["at_once", "closed_pair", "degree_pair", "separating_pair"]


def degree_pair(graph: Digraph, r: int) -> Pair | None:
    """Return ``({v}, V \\ {v})`` for a node v of smallest in-degree when that violates r-robustness, else None.

    >>> degree_pair(Digraph(range(3), [(0, 1), (1, 2), (2, 0)]), 2)
    Pair(first=frozenset({0}), second=frozenset({1, 2}))
    """
    v = int(np.argmin(graph.in_degrees))
    if r < 2 or graph.in_degrees[v] >= r:
        return None
    return Pair(frozenset({v}), frozenset(range(graph.n)) - {v})


def at_once(graph: Digraph, r: int) -> Pair | None:
    """Return the pair that the number of nodes or the smallest in-degree gives against r, or None. n >= 2."""
    return half_split(graph) if r > largest_conceivable_r(graph.n) else degree_pair(graph, r)


def separating_pair(graph: Digraph) -> Pair | None:
    """Return two components of G - v for a separating node v of an undirected graph: a pair against r = 2. Linear time.

    None when there is no such node, or an arc without its reverse.
    """
    if graph.n < 3 or not graph.is_symmetric:
        return None
    from robustness.kernels.passes import articulation, breadth_first

    indptr, indices = graph.in_indptr, graph.in_indices
    v = articulation(indptr, indices)
    if v < 0:
        return None
    sets: list[frozenset[int]] = []
    seen, order = np.zeros(graph.n, np.uint8), np.empty(graph.n, np.int32)
    seen[v] = True
    for start in graph.in_neighbours(v).tolist():
        size = breadth_first(indptr, indices, start, order, seen, 0)
        if size:
            sets.append(frozenset(order[:size].tolist()))
        if len(sets) == 2:
            break
    return Pair(*sets)


def closed_pair(graph: Digraph) -> Pair | None:
    """Return two disjoint sets that hear nobody outside: a pair against r = 1, or None. n >= 2."""
    return one_robustness(graph)
