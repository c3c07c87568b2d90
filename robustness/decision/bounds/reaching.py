"""1-robustness, decided exactly in linear time: some node reaches all others.

Theorem. A digraph on n >= 2 nodes is 1-robust exactly when one node reaches all. (Lemma 1 (iv) of the source paper is
one half.)

Proof. A set is not 1-reachable when nobody in it hears anybody outside: it is closed under in-neighbours. If c
reaches all, every nonempty closed set holds c, so no two are disjoint. Otherwise take c in a strongly connected
component that nothing outside it reaches: the nodes that reach c, and the nodes that c does not reach, are two closed
sets, and they are disjoint because all that reach c are reached by c. ∎
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.evidence import Pair

if TYPE_CHECKING:
    from robustness.decision.bounds.adjacency import Adjacency

__all__ = ["one_robustness", "two_closed_sets"]

_PLAIN_NODES = 64


def one_robustness(graph: Digraph) -> Pair | None:
    """Return a pair that violates 1-robustness, or None when ``graph`` (n >= 2) is 1-robust. Linear time.

    >>> one_robustness(Digraph(range(3), [(0, 1), (2, 1)]))
    Pair(first=frozenset({2}), second=frozenset({0}))
    """
    if graph.n <= _PLAIN_NODES:
        return _plain(graph)
    from robustness.decision.bounds.adjacency import adjacency

    sets = two_closed_sets(adjacency(graph))
    return None if sets is None else Pair(*(frozenset(np.flatnonzero(side).tolist()) for side in sets))


def two_closed_sets(arrays: Adjacency) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None:
    """Return two disjoint nonempty sets closed under in-neighbours as masks, or None when one node reaches all."""
    from robustness.kernels.passes import breadth_first, mother

    n = arrays.n
    root = mother(*arrays[2:])
    order, reached, reaching = np.empty(n, np.int32), np.zeros(n, np.uint8), np.zeros(n, np.uint8)
    if breadth_first(*arrays[2:], root, order, reached, 0) == n:
        return None
    breadth_first(*arrays[:2], root, order, reaching, 0)
    return reaching.view(np.bool_), ~reached.view(np.bool_)


def _plain(graph: Digraph) -> Pair | None:
    """Do the same with Python integers as sets, for graphs that are small."""
    hears = graph.in_masks
    heard_by = [0] * graph.n
    for u, v in graph.arcs():
        heard_by[u] |= 1 << v
    everyone = (1 << graph.n) - 1
    seen, root = 0, 0
    for start in range(graph.n):
        if not seen >> start & 1:
            root = start
            seen |= _closure(heard_by, start)
    reached = _closure(heard_by, root)
    if reached == everyone:
        return None
    return Pair(_ids(_closure(hears, root)), _ids(everyone & ~reached))


def _closure(rows: list[int] | tuple[int, ...], start: int) -> int:
    closed = fresh = 1 << start
    while fresh:
        node = fresh.bit_length() - 1
        fresh ^= 1 << node
        more = rows[node] & ~closed
        closed |= more
        fresh |= more
    return closed


def _ids(mask: int) -> frozenset[int]:
    return frozenset(i for i in range(mask.bit_length()) if mask >> i & 1)
