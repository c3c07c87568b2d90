"""All small graphs and digraphs up to isomorphism, and the robustness profiles of many of them at once.

A *batch* is an integer array of shape ``(count, n)``: row ``g`` holds the in-neighbour masks of graph ``g``, bit
``j`` of entry ``i`` set when i hears j. Exhaustive statements ("every digraph on 4 nodes ...") are checked on
batches, thousands of graphs in one numpy pass, where a loop over single graphs would take minutes.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import permutations

import numpy as np
import numpy.typing as npt

from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter

__all__ = [
    "LARGEST_DIGRAPHS",
    "LARGEST_GRAPHS",
    "Batch",
    "batch_profiles",
    "batch_s_max",
    "digraph_of_masks",
    "digraphs_up_to_isomorphism",
    "each_graph",
    "graphs_up_to_isomorphism",
]

#: Shape ``(count, n)``: in-neighbour masks.
Batch = npt.NDArray[np.int64]

#: Graphs come from the atlas of Read and Wilson that networkx ships, which ends at 7 nodes.
LARGEST_GRAPHS = 7
#: 9,608 digraphs have 5 nodes and 1,540,944 have 6.
LARGEST_DIGRAPHS = 5

_CHUNK = 1 << 22


@cache
def graphs_up_to_isomorphism(n: int) -> Batch:
    """Return one labelling of every undirected graph on n nodes, fewest edges first, as a batch.

    Parameters
    ----------
    n : int
        0 to 7.

    Raises
    ------
    InvalidParameter
        For any other n.

    >>> [len(graphs_up_to_isomorphism(n)) for n in range(7)]
    [1, 1, 2, 4, 11, 34, 156]
    """
    if not 0 <= n <= LARGEST_GRAPHS:
        raise InvalidParameter(f"graphs are listed up to isomorphism for 0..{LARGEST_GRAPHS} nodes, not {n!r}")
    found = [[sum(1 << j for j in graph[i]) for i in range(n)] for graph in _atlas() if len(graph) == n]
    return _frozen(np.array(found, dtype=np.int64).reshape(len(found), n))


@cache
def digraphs_up_to_isomorphism(n: int) -> Batch:
    """Return one labelling of every digraph on n nodes, fewest arcs first, as a batch.

    Parameters
    ----------
    n : int
        0 to 5.

    Raises
    ------
    InvalidParameter
        For any other n.

    Notes
    -----
    Every digraph on n nodes is one on n - 1 nodes with a node added, so the list for n - 1 is extended in all
    ``4^(n-1)`` ways and one labelling per class is kept: the one whose adjacency bits, read as a number, are least.

    >>> [len(digraphs_up_to_isomorphism(n)) for n in range(5)]
    [1, 1, 3, 16, 218]
    """
    if not 0 <= n <= LARGEST_DIGRAPHS:
        raise InvalidParameter(f"digraphs are listed up to isomorphism for 0..{LARGEST_DIGRAPHS} nodes, not {n!r}")
    if n == 0:
        return _frozen(np.zeros((1, 0), dtype=np.int64))
    smaller = digraphs_up_to_isomorphism(n - 1)
    hears, heard = (side.ravel() for side in np.meshgrid(np.arange(1 << (n - 1)), np.arange(1 << (n - 1))))
    extended = np.zeros((len(smaller), len(hears), n), dtype=np.int64)
    extended[:, :, : n - 1] = smaller[:, None, :] | ((heard[:, None] >> np.arange(n - 1) & 1) << (n - 1))
    extended[:, :, n - 1] = hears
    codes = np.unique(_least_codes(extended.reshape(-1, n)))
    masks = codes[:, None] >> (np.arange(n) * n) & ((1 << n) - 1)
    return _frozen(masks[np.argsort(np.bitwise_count(codes), kind="stable")])


def digraph_of_masks(masks: npt.NDArray[np.int64], *, directed: bool = True) -> Digraph:
    """Return the graph on nodes ``0..n-1`` that has these in-neighbour masks."""
    n = len(masks)
    arcs = [(j, i) for i, mask in enumerate(masks.tolist()) for j in range(n) if mask >> j & 1]
    return Digraph(range(n), arcs, directed=directed)


def each_graph(largest: int, *, directed: bool) -> Iterator[Digraph]:
    """Yield every graph on 0..``largest`` nodes up to isomorphism, fewest nodes and then arcs first."""
    for n in range(largest + 1):
        batch = digraphs_up_to_isomorphism(n) if directed else graphs_up_to_isomorphism(n)
        for masks in batch:
            yield digraph_of_masks(masks, directed=directed)


def batch_profiles(batch: Batch) -> npt.NDArray[np.int64]:
    """Return ``s_max(r)`` of every graph of a batch, shape ``(count, ceil(n/2) + 1)``; column 0 is n (at least 1).

    Notes
    -----
    Let ``c(S) = |X_S^r|``, or infinity when ``X_S^r = S``. By the definition ``s_max(r)`` is the least
    ``c(S1) + c(S2)`` over disjoint nonempty pairs, at most n. With ``M(T)`` the least c over the nonempty subsets of T
    it is the least ``c(S) + M(V \\ S)``. Time ``O(n 2^n)`` for every graph and r. For fewer than two nodes no pair
    exists and the conventions of :mod:`robustness.definitions` hold.

    >>> batch_profiles(graphs_up_to_isomorphism(3)).tolist()
    [[3, 0, 0], [3, 0, 0], [3, 3, 0], [3, 3, 3]]
    """
    count, n = batch.shape
    table = np.full((count, largest_conceivable_r(n) + 1), max(n, 1), dtype=np.int64)
    if n < 2:
        return table
    step = max(1, _CHUNK >> n)
    for start in range(0, count, step):
        part = batch[start : start + step]
        for r in range(1, table.shape[1]):
            table[start : start + step, r] = batch_s_max(part, r)
    return table


def batch_s_max(batch: Batch, r: int) -> npt.NDArray[np.int64]:
    """Return ``s_max(r)`` for every graph of a batch, shape ``(count,)``, for any r >= 1; n >= 2."""
    n = batch.shape[1]
    subsets = np.arange(1 << n)
    cost = np.zeros((len(batch), 1 << n), dtype=np.int8)
    for i in range(n):
        inside = subsets[subsets >> i & 1 == 1]
        cost[:, inside] += np.bitwise_count(batch[:, i, None] & ~inside) >= r
    infinity = np.int8(60)
    cost[cost == np.bitwise_count(subsets)] = infinity  # also the empty set
    least = cost.copy()
    for i in range(n):
        with_i = subsets[subsets >> i & 1 == 1]
        np.minimum(least[:, with_i], least[:, with_i ^ (1 << i)], out=(best := np.empty_like(least[:, with_i])))
        least[:, with_i] = best
    cheapest: npt.NDArray[np.int64] = np.minimum((cost + least[:, ::-1]).min(axis=1), n).astype(np.int64)
    return cheapest


@cache
def _atlas() -> tuple[dict[int, list[int]], ...]:
    """Return the adjacency of all graphs on up to 7 nodes, fewest nodes and then edges first."""
    import networkx as nx

    return tuple({node: list(graph[node]) for node in sorted(graph)} for graph in nx.graph_atlas_g())


def _least_codes(batch: Batch) -> npt.NDArray[np.int64]:
    """Return the least code (mask i in bits ``n i .. n i + n - 1``) over all relabellings of every graph."""
    n = batch.shape[1]
    least = np.full(len(batch), np.iinfo(np.int64).max)
    for order in permutations(range(n)):
        code = np.zeros(len(batch), dtype=np.int64)
        for i in range(n):
            for j in range(n):
                if i != j:
                    code |= (batch[:, i] >> j & 1) << (n * order[i] + order[j])
        np.minimum(least, code, out=least)
    return least


def _frozen(batch: Batch) -> Batch:
    batch.setflags(write=False)
    return batch
