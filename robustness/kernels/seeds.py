"""Search for small robust seeds of growth certificates (see :mod:`robustness.decision.bounds.growth`)."""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.words import bit_of, count

__all__ = ["by_degree", "find_seed", "least_exempt"]

# Seeds up to this size are examined subset by subset; larger ones must satisfy the degree rule.
EXHAUSTIVE_NODES = 16
_NO_PAIR = 255


def by_degree(hears, size, r):
    """Return whether each of ``size`` nodes hears ``size // 2 + r - 1`` of them: (r,s)-robust for every s.

    ``hears[i]`` has bit j set when node i of the seed hears node j of it.
    """
    for i in range(size):  # noqa: SIM110 - a generator would be a Python object
        if count(hears[i]) < size // 2 + r - 1:
            return False
    return True


def least_exempt(hears, size, r):
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
                reachable += ones[hears[i] & (everyone ^ members)] >= r
        cost[members] = _NO_PAIR if reachable == ones[members] else reachable
    least = np.array(cost)
    for i in range(size):
        for members in range(1 << size):
            if members >> i & 1 and least[members ^ (1 << i)] < least[members]:
                least[members] = least[members ^ (1 << i)]
    best = _NO_PAIR
    for members in range(1, everyone):
        if cost[members] < _NO_PAIR and least[everyone ^ members] < _NO_PAIR:
            best = min(best, int(cost[members]) + int(least[everyone ^ members]))
    return best


def _proven(hears, size, r, s):
    """Return whether the seed is (r,s)-robust by the degree rule or, when it is small, by all its subsets."""
    if by_degree(hears, size, r):
        return True
    if size > EXHAUSTIVE_NODES:
        return False
    for i in range(size):
        if count(hears[i]) < r:
            return False
    return least_exempt(hears, size, r) >= s


def _join(indptr, indices, seed, size, links, met, known):
    """Count the neighbours of ``seed[size]`` as linked; return how many nodes were met so far, and which seeds now."""
    bits = 0
    for k in range(indptr[seed[size]], indptr[seed[size] + 1]):
        j = indices[k]
        for q in range(size):
            if seed[q] == j:
                bits |= bit_of(q)
        if links[j] == 0:
            met[known] = j
            known += 1
        links[j] += 1
    return known, bits


def _most_linked(seed, size, links, met, known):
    """Return the node outside the seed with most links to it, or -1."""
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    best, most = -1, 0
    for k in range(known):
        if links[met[k]] > most:
            best, most = met[k], links[met[k]]
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    return best


def find_seed(in_indptr, in_indices, out_indptr, out_indices, anchors, barred, r, s, limit, work, seed):
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
        fresh, size, known, found = anchors[tried], 0, 0, False
        while size < limit and fresh >= 0 and not found:
            seed[size] = fresh
            known, heard_by = _join(in_indptr, in_indices, seed, size, links, met, known)
            hears[size] = heard_by
            known, heard_by = _join(out_indptr, out_indices, seed, size, links, met, known)
            for q in range(size):
                hears[q] |= (heard_by >> q & 1) << size
            degree = in_indptr[fresh + 1] - in_indptr[fresh] + out_indptr[fresh + 1] - out_indptr[fresh]
            size += 1
            work -= degree * size + known
            if size >= max(2 * r - 1, r + s - 1):
                found = _proven(hears, size, r, s)
                work -= size << min(size, EXHAUSTIVE_NODES)
            fresh = _most_linked(seed, size, links, met, known)
        for k in range(known):
            links[met[k]] = 0
        if found:
            return tried + 1, size
    return len(anchors), 0


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
