"""Search for small robust seeds of growth certificates (see :mod:`robustness.decision.bounds.growth`)."""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.words import bit_of, count

__all__ = ["by_degree", "find_seed"]

# Seeds up to this size are examined subset by subset; larger ones must satisfy the degree rule.
EXHAUSTIVE_NODES = 16
# More than any number of exempt nodes: a side whose nodes are all reachable from outside makes no violating pair.
_NO_PAIR = 255


def by_degree(hears, size, r):
    """Return whether each of ``size`` nodes hears ``size // 2 + r - 1`` of them: (r,s)-robust for every s.

    ``hears[i]`` has bit j set when node i of the seed hears node j of it.

    Parameters
    ----------
    hears : array of uint64, shape (size,)
    size, r : int
    """
    for i in range(size):  # noqa: SIM110 - a generator would be a Python object
        if count(hears[i]) < size // 2 + r - 1:
            return False
    return True


def _exempt(hears, size, r, side):
    """Return ``|X_S|`` of the nodes S in ``side`` within a seed of at most 16, or 255 when X_S = S.

    Parameters
    ----------
    hears : array of uint64, shape (size,)
    size, r : int
    side : int
        Bit i: node i of the seed.
    """
    outside = ((1 << size) - 1) ^ side
    members, exempt = 0, 0
    for i in range(size):
        if side >> i & 1:
            members += 1
            exempt += count(hears[i] & outside) >= r
    return _NO_PAIR if exempt == members else exempt


def _violated_again(hears, size, r, s, pair):
    """Return whether the pair that refuted the seed without its last node, or with it on either side, refutes it.

    Nothing but the definition: what it finds is a violating pair, which is left in ``pair``. Most seeds that are not
    robust are refuted by what refuted them one node ago, in linear time.

    Parameters
    ----------
    hears : array of uint64, shape (size,)
    size, r, s : int
    pair : array of uint64, shape (2,)
        Each entry a set of nodes of the seed as bits; 0 and 0 when no pair is known.
    """
    last = 1 << (size - 1)
    for k in range(3):
        first, second = pair[0] | (last if k == 1 else 0), pair[1] | (last if k == 2 else 0)
        if _exempt(hears, size, r, first) + _exempt(hears, size, r, second) < s:
            pair[0], pair[1] = first, second
            return True
    return False


def _proven(hears, size, r, s, pair, examine):
    """Return whether the seed is (r,s)-robust by the degree rule or, when it is small, by ``examine``.

    Parameters
    ----------
    hears : array of uint64, shape (size,)
    size, r, s : int
    pair : array of uint64, shape (2,)
    examine : callable
    """
    if by_degree(hears, size, r):
        return True
    if size > EXHAUSTIVE_NODES or (pair[0] and _violated_again(hears, size, r, s, pair)):
        return False
    pair[0] = pair[1] = 0
    for i in range(size):
        if count(hears[i]) < r:
            return False
    return examine(hears, size, pair)


def _join(indptr, indices, seed, size, links, met, known):
    """Count the neighbours of ``seed[size]`` as linked; return how many nodes were met so far, and which seeds now.

    Parameters
    ----------
    indptr : array of int64, shape (n + 1,)
    indices : array of int32, shape (m,)
    seed : array of int32, shape (n,)
    size : int
    links : array of int32, shape (n,)
        How many links every node has to the seed.
    met : array of int32, shape (n,)
        The nodes with a link, as they were met.
    known : int
        How many these are.
    """
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
    """Return the node outside the seed with most links to it, or -1.

    Parameters
    ----------
    seed : array of int32, shape (n,)
    size : int
    links, met : arrays of int32, shape (n,)
    known : int
    """
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    best, most = -1, 0
    for k in range(known):
        if links[met[k]] > most:
            best, most = met[k], links[met[k]]
    for q in range(size):
        links[seed[q]] = -links[seed[q]]
    return best


def find_seed(in_indptr, in_indices, out_indptr, out_indices, anchors, barred, r, s, limit, work, seed, examine):
    """Grow dense sets around the anchors until one is provably (r,s)-robust; return (anchors tried, its size or 0).

    From an anchor the node with most arcs to and from the set joins, up to ``limit`` <= 64 nodes; as soon as the set is
    large enough for others to hear r + s - 1 of it, its robustness is examined at each size. Anchors in ``barred``
    are passed over. About ``work`` elementary steps are spent per call. The ids are left in ``seed[:size]``.

    ``examine(hears, size, pair)`` says whether a seed of at most 16 nodes is proven robust by all its subsets; when it
    is refuted, ``examine`` leaves the violating pair in ``pair``, two sets of nodes of the seed as bits.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    anchors : array of int32, shape (any,)
    barred : array of uint8, shape (n,)
    r, s, limit, work : int
    seed : array of int32, shape (n,)
    examine : callable
    """
    links = np.zeros(len(barred), np.int32)
    met = np.empty(len(barred), np.int32)
    hears = np.zeros(64, np.uint64)
    pair = np.zeros(2, np.uint64)
    for tried in range(len(anchors)):
        if work <= 0:
            return tried, 0
        if barred[anchors[tried]]:
            continue
        fresh, size, known, found = anchors[tried], 0, 0, False
        pair[0] = pair[1] = 0
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
                found = _proven(hears, size, r, s, pair, examine)
            fresh = _most_linked(seed, size, links, met, known)
        for k in range(known):
            links[met[k]] = 0
        if found:
            return tried + 1, size
    return len(anchors), 0


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
