"""Passes over the arcs, each linear in them: transposing, peeling, growing, reaching, sweeping.

The graph comes as two pairs of arrays, compressed rows of in-neighbours and of out-neighbours: ``indptr`` of int64,
shape ``(n + 1,)``, and ``indices`` of int32, shape ``(m,)``. No matrix is ever made, so a million nodes take a few
arrays of a million entries. Sets of nodes are arrays of uint8, shape ``(n,)``, 1 for a member.

The central notion is ``core_r(U)``, the largest non-r-reachable subset of U. It exists and is unique because
such sets are closed under union (a node of S ∪ T has at most as many in-neighbours outside S ∪ T as outside S),
and repeatedly dropping any node with r or more in-neighbours outside what is left finds it: a node of a
non-r-reachable subset of U is never the first of that subset to go.
"""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

__all__ = [
    "articulation",
    "both_cores",
    "breadth_first",
    "clump",
    "core",
    "forget",
    "grow",
    "mother",
    "smooth",
    "sweep",
    "transpose",
]


def transpose(indptr, indices):
    """Return the rows of the reversed arcs, ascending.

    Parameters
    ----------
    indptr : array of int64, shape (n + 1,)
    indices : array of int32, shape (m,)
    """
    n = len(indptr) - 1
    start = np.zeros(n + 1, np.int64)
    for k in range(len(indices)):
        start[indices[k] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    place = np.array(start)
    rows = np.empty(len(indices), np.int32)
    for i in range(n):
        for k in range(indptr[i], indptr[i + 1]):
            rows[place[indices[k]]] = i
            place[indices[k]] += 1
    return np.asarray(start), np.asarray(rows)


def core(in_indptr, in_indices, out_indptr, out_indices, member, r):
    """Shrink the set ``member`` to ``core_r`` of it, in place, and return its size.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    member : array of uint8, shape (n,)
    r : int
    """
    n = len(member)
    outside = np.zeros(n, np.int32)
    stack = np.empty(n, np.int32)
    top = size = 0
    for i in range(n):
        if member[i]:
            size += 1
            for k in range(in_indptr[i], in_indptr[i + 1]):
                if not member[in_indices[k]]:
                    outside[i] += 1
            if outside[i] >= r:
                stack[top] = i
                top += 1
    for k in range(top):
        member[stack[k]] = False
    size -= top
    while top > 0:
        top -= 1
        gone = stack[top]
        for k in range(out_indptr[gone], out_indptr[gone + 1]):
            i = out_indices[k]
            if member[i]:
                outside[i] += 1
                if outside[i] >= r:
                    member[i] = False
                    size -= 1
                    stack[top] = i
                    top += 1
    return size


def both_cores(in_indptr, in_indices, out_indptr, out_indices, side, r, first, second):
    """Try to make a violating pair out of ``side`` (0, 1, or 2 for neither); fill ``first`` and ``second``.

    Whenever C = core_r(S1) is nonempty, the best partner of C is core_r(V \\ C); and the same from S2.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    side : array of int8, shape (n,)
    r : int
    first, second : arrays of uint8, shape (n,)
    """
    for wanted in range(2):
        for i in range(len(side)):
            first[i] = side[i] == wanted
        if core(in_indptr, in_indices, out_indptr, out_indices, first, r) == 0:
            continue
        for i in range(len(side)):
            second[i] = not first[i]
        if core(in_indptr, in_indices, out_indptr, out_indices, second, r) > 0:
            return True
    return False


def grow(out_indptr, out_indices, present, heard, order, size, need):
    """Add every node that hears ``need`` present nodes, until none is left; return how many are present.

    ``order[:size]`` is the seed; the nodes are appended to ``order`` as they join. ``present`` and ``heard`` are
    all zero at the start; :func:`forget` makes them so again, in the time the growth took.

    Parameters
    ----------
    out_indptr : array of int64, shape (n + 1,)
    out_indices : array of int32, shape (m,)
    present : array of uint8, shape (n,)
    heard : array of int32, shape (n,)
        How many present nodes each node hears.
    order : array of int32, shape (n,)
    size, need : int
    """
    for k in range(size):
        present[order[k]] = True
    done = 0
    while done < size:
        node = order[done]
        done += 1
        for k in range(out_indptr[node], out_indptr[node + 1]):
            i = out_indices[k]
            heard[i] += 1
            if heard[i] >= need and not present[i]:
                present[i] = True
                order[size] = i
                size += 1
    return size


def forget(out_indptr, out_indices, present, heard, order, size):
    """Undo :func:`grow`.

    Parameters
    ----------
    out_indptr : array of int64, shape (n + 1,)
    out_indices : array of int32, shape (m,)
    present : array of uint8, shape (n,)
    heard, order : arrays of int32, shape (n,)
    size : int
    """
    for done in range(size):
        present[order[done]] = False
        for k in range(out_indptr[order[done]], out_indptr[order[done] + 1]):
            heard[out_indices[k]] = 0


def breadth_first(indptr, indices, start, order, seen, size):
    """Append to ``order[size:]`` the unseen nodes reached from ``start``, nearest first; return the new size.

    Parameters
    ----------
    indptr : array of int64, shape (n + 1,)
    indices : array of int32, shape (m,)
    start : int
    order : array of int32, shape (n,)
    seen : array of uint8, shape (n,)
    size : int
    """
    if seen[start]:
        return size
    seen[start] = True
    order[size] = start
    done = size
    size += 1
    while done < size:
        node = order[done]
        done += 1
        for k in range(indptr[node], indptr[node + 1]):
            i = indices[k]
            if not seen[i]:
                seen[i] = True
                order[size] = i
                size += 1
    return size


def mother(out_indptr, out_indices):
    """Return a node that no node outside its reach can reach: the last start of a search of the whole graph.

    Suppose x reaches the last start c. Had x been seen in an earlier search, so had c; no search starts later;
    so x was seen in c's own search, hence c reaches x.

    Parameters
    ----------
    out_indptr : array of int64, shape (n + 1,)
    out_indices : array of int32, shape (m,)
    """
    n = len(out_indptr) - 1
    seen = np.zeros(n, np.uint8)
    order = np.empty(n, np.int32)
    last, size = 0, 0
    for start in range(n):
        if not seen[start]:
            last = start
            size = breadth_first(out_indptr, out_indices, start, order, seen, size)
    return last


def smooth(in_indptr, in_indices, out_indptr, out_indices, values, rounds):
    """Take ``values`` through ``rounds`` steps of the lazy random walk on links of either direction, in place.

    With the part along the constant vector removed after each step, this is power iteration towards the Fiedler
    vector of the normalised Laplacian. It only suggests orders; nothing is concluded from these floats.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    values : array of float64, shape (n,)
    rounds : int
    """
    n = len(values)
    for _ in range(rounds):
        fresh = np.empty(n)
        total = weight = largest = 0.0
        for i in range(n):
            acc = 0.0
            for k in range(in_indptr[i], in_indptr[i + 1]):
                acc += values[in_indices[k]]
            for k in range(out_indptr[i], out_indptr[i + 1]):
                acc += values[out_indices[k]]
            degree = in_indptr[i + 1] - in_indptr[i] + out_indptr[i + 1] - out_indptr[i]
            fresh[i] = 0.5 * (values[i] + acc / degree) if degree > 0 else 0.0
            total += fresh[i] * degree
            weight += degree
        for i in range(n):
            fresh[i] -= total / max(weight, 1.0)
            largest = max(largest, abs(fresh[i]))
        for i in range(n):
            values[i] = fresh[i] / largest if largest > 0 else 0.0


def sweep(in_indptr, in_indices, out_indptr, out_indices, order, r, cuts):
    """Find good places to cut ``order`` in two: fill ``cuts`` with one prefix length per equal range of lengths.

    In each range of prefix lengths the one with the fewest nodes that have r or more in-neighbours on the other
    side is kept. One pass: the counts change only along the arcs of the node that changes sides.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    order : array of int32, shape (n,)
    r : int
    cuts : array of int64, shape (lengths,)
    """
    n = len(order)
    before = np.zeros(n, np.uint8)
    across = np.zeros(n, np.int32)
    fewest = np.full(len(cuts), n + 1, np.int64)
    bad = 0
    for place in range(n - 1):
        node = order[place]
        bad -= across[node] >= r
        across[node] = in_indptr[node + 1] - in_indptr[node] - across[node]
        bad += across[node] >= r
        before[node] = True
        for k in range(out_indptr[node], out_indptr[node + 1]):
            i = out_indices[k]
            bad -= across[i] >= r
            across[i] += -1 if before[i] else 1
            bad += across[i] >= r
        part = place * len(cuts) // (n - 1)
        if bad < fewest[part]:
            fewest[part] = bad
            cuts[part] = place + 1


def articulation(indptr, indices):
    """Return a node whose removal disconnects its component of an undirected graph, or -1.

    Depth-first search with low points (Hopcroft, Tarjan 1973), without recursion.

    Parameters
    ----------
    indptr : array of int64, shape (n + 1,)
    indices : array of int32, shape (m,)
    """
    n = len(indptr) - 1
    depth = np.full(n, -1, np.int32)
    low = np.empty(n, np.int32)
    parent = np.empty(n, np.int32)
    after = np.array(indptr[:n])
    for root in range(n):
        if depth[root] >= 0:
            continue
        parent[root], depth[root], low[root] = -1, 0, 0
        node, children = root, 0
        while node >= 0:
            if after[node] < indptr[node + 1]:
                i = indices[after[node]]
                after[node] += 1
                if depth[i] < 0:
                    parent[i], depth[i], low[i] = node, depth[node] + 1, depth[node] + 1
                    children += node == root
                    node = i
                elif i != parent[node]:
                    low[node] = min(low[node], depth[i])
                continue
            above = parent[node]
            if above >= 0:
                low[above] = min(low[above], low[node])
                if above != root and low[node] >= depth[above]:
                    return above
            node = above
        if children > 1:
            return root
    return -1


def clump(in_indptr, in_indices, out_indptr, out_indices, anchors, limit, r, members):
    """Grow a small non-r-reachable set around one anchor after another; return (anchors tried, size found or 0).

    A node i of such a set has at least ``d_i - r + 1`` in-neighbours in it. While a member lacks some, the in-neighbour
    that would itself lack least joins; past ``limit`` members the next anchor is tried. The set is left in
    ``members[:size]``. Work per anchor: ``limit`` times the degrees met.

    Parameters
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    anchors : array of int32, shape (any,)
    limit, r : int
    members : array of int32, shape (n,)
    """
    n = len(in_indptr) - 1
    inside = np.zeros(n, np.int32)
    member = np.zeros(n, np.uint8)
    for tried in range(len(anchors)):
        members[0] = anchors[tried]
        member[anchors[tried]] = True
        size, satisfied = 1, 0
        for k in range(out_indptr[members[0]], out_indptr[members[0] + 1]):
            inside[out_indices[k]] += 1
        # The first ``satisfied`` members lack nothing, and never will again: inside only grows.
        while satisfied < size:
            i = members[satisfied]
            if in_indptr[i + 1] - in_indptr[i] - inside[i] < r:
                satisfied += 1
                continue
            if size == limit:
                break
            joins, least = -1, 1 << 40
            for k in range(in_indptr[i], in_indptr[i + 1]):
                j = in_indices[k]
                lacks = in_indptr[j + 1] - in_indptr[j] - inside[j]
                if not member[j] and lacks < least:
                    joins, least = j, lacks
            members[size] = joins
            member[joins] = True
            size += 1
            for k in range(out_indptr[joins], out_indptr[joins + 1]):
                inside[out_indices[k]] += 1
        for k in range(size):
            member[members[k]] = False
            for q in range(out_indptr[members[k]], out_indptr[members[k] + 1]):
                inside[out_indices[q]] = 0
        if satisfied == size and size < n:
            return tried + 1, size
    return len(anchors), 0


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
