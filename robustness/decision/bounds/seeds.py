"""Compiled search for small robust seeds of growth certificates (see :mod:`robustness.decision.bounds.growth`).

Importing this module imports numba: import it inside the function that needs it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

__all__ = ["EXHAUSTIVE_NODES", "by_degree", "find_seed", "least_exempt"]

#: Seeds up to this size are examined subset by subset; larger ones must satisfy the degree rule.
EXHAUSTIVE_NODES = 16
_NO_PAIR = 255


@njit(nogil=True, cache=True)
def by_degree(hears: Any, size: int, r: int) -> bool:
    """Return whether each of ``size`` nodes hears ``size // 2 + r - 1`` of them: (r,s)-robust for every s.

    ``hears[i]`` has bit j set when node i of the seed hears node j of it.
    """
    for i in range(size):
        mask, degree = hears[i], 0
        while mask:
            mask &= mask - np.uint64(1)
            degree += 1
        if degree < size // 2 + r - 1:
            return False
    return True


@njit(nogil=True, cache=True)
def least_exempt(hears: Any, size: int, r: int) -> int:
    """Return the least ``|X_S1| + |X_S2|`` over pairs in which neither side is fully reachable, or 255 without any.

    The graph on ``size <= 16`` nodes is (r,s)-robust exactly when this is at least s. With c(S) = ``|X_S|``, or 255
    when X_S = S, and M(T) the least c over nonempty subsets of T, it is the least c(S) + M(V \\ S).
    """
    everyone = (1 << size) - 1
    ones = np.zeros(1 << size, np.uint8)
    for members in range(1, 1 << size):
        ones[members] = ones[members >> 1] + (members & 1)
    cost = np.empty(1 << size, np.uint8)
    cost[0] = _NO_PAIR
    for members in range(1, 1 << size):
        reachable = 0
        for i in range(size):
            if members >> i & 1:
                reachable += ones[np.int64(hears[i]) & (everyone ^ members)] >= r
        cost[members] = _NO_PAIR if reachable == ones[members] else reachable
    least = cost.copy()
    for i in range(size):
        for members in range(1 << size):
            if members >> i & 1 and least[members ^ (1 << i)] < least[members]:
                least[members] = least[members ^ (1 << i)]
    best = _NO_PAIR
    for members in range(1, everyone):
        if cost[members] < _NO_PAIR and least[everyone ^ members] < _NO_PAIR:
            best = min(best, int(cost[members]) + int(least[everyone ^ members]))
    return best


@njit(nogil=True, cache=True)
def _proven(hears: Any, size: int, r: int, s: int) -> bool:
    """Return whether the seed is (r,s)-robust by the degree rule or, when it is small, by all its subsets."""
    if by_degree(hears, size, r):
        return True
    if size > EXHAUSTIVE_NODES:
        return False
    for i in range(size):
        mask, degree = hears[i], 0
        while mask:
            mask &= mask - np.uint64(1)
            degree += 1
        if degree < r:
            return False
    return least_exempt(hears, size, r) >= s


@njit(nogil=True, cache=True)
def _join(indptr: Any, indices: Any, seed: Any, size: int, links: Any, met: Any, count: int) -> Any:
    """Count the neighbours of ``seed[size]`` as linked; return how many nodes were met so far, and which seeds now."""
    bits = np.uint64(0)
    for k in range(indptr[seed[size]], indptr[seed[size] + 1]):
        j = indices[k]
        for q in range(size):
            if seed[q] == j:
                bits |= np.uint64(1) << np.uint64(q)
        if links[j] == 0:
            met[count] = j
            count += 1
        links[j] += 1
    return count, bits


@njit(nogil=True, cache=True)
def _most_linked(seed: Any, size: int, links: Any, met: Any, count: int) -> int:
    """Return the node outside the seed with most links to it, or -1."""
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    best, most = -1, 0
    for k in range(count):
        if links[met[k]] > most:
            best, most = met[k], links[met[k]]
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    return best


@njit(nogil=True, cache=True)
def find_seed(
    in_indptr: Any, in_indices: Any, out_indptr: Any, out_indices: Any, anchors: Any, barred: Any, r: int, s: int,
    limit: int, work: int, seed: Any,
) -> tuple[int, int]:
    """Grow dense sets around the anchors until one is provably (r,s)-robust; return (anchors tried, its size or 0).

    From an anchor the node with most arcs to and from the set joins, up to ``limit`` <= 64 nodes; as soon as the set is
    large enough for others to hear r + s - 1 of it, its robustness is examined at each size. Anchors in ``barred``
    are passed over. About ``work`` elementary steps are spent per call. The ids are left in ``seed[:size]``.
    """
    links = np.zeros(len(barred), np.int32)
    met = np.empty(len(barred), np.int32)
    hears = np.zeros(64, np.uint64)
    for tried in range(len(anchors)):
        if work <= 0:
            return tried, 0
        if barred[anchors[tried]]:
            continue
        fresh, size, count, found = anchors[tried], 0, 0, False
        while size < limit and fresh >= 0 and not found:
            seed[size] = fresh
            count, hears[size] = _join(in_indptr, in_indices, seed, size, links, met, count)
            count, heard_by = _join(out_indptr, out_indices, seed, size, links, met, count)
            for q in range(size):
                hears[q] |= (heard_by >> np.uint64(q) & np.uint64(1)) << np.uint64(size)
            degree = in_indptr[fresh + 1] - in_indptr[fresh] + out_indptr[fresh + 1] - out_indptr[fresh]
            size += 1
            work -= degree * size + count
            if size >= max(2 * r - 1, r + s - 1):
                found = _proven(hears, size, r, s)
                work -= size << min(size, EXHAUSTIVE_NODES)
            fresh = _most_linked(seed, size, links, met, count)
        for k in range(count):
            links[met[k]] = 0
        if found:
            return tried + 1, size
    return len(anchors), 0
