"""The inner loop of :mod:`robustness.decision.bounds.local_search`: tabu search over S1, S2 and neither.

A state puts every node into side 0 (S1), side 1 (S2) or 2 (neither). A node of a side pays a price that grows
with the number e by which its in-neighbours outside that side exceed r - 1; a node in neither pays a fixed fee. For
r-robustness the price is max(0, e), and a state in which no node of a side pays is a violating pair. For (r,s) the
price is concave, so that a few nodes are given up (exempt) rather than many of them a little, and two anchors, one
per side, must not be among them.

A step picks a random node that pays, and makes the best move among: that node to another side, or one of its
in-neighbours to its side, unless that node moved a few steps ago (tabu list: Glover 1989; starting from a violated
constraint: Selman, Kautz, Cohen 1994). The gain of a move costs O(1), because for every node and side the sums of
the marginal prices of its hearers are kept; they change only around the threshold, where marginal prices do.

Tried and left: annealing over bipartitions and over three sides (hundreds of times slower on G(60,.8), G(50,.8)
and sparse regular graphs); scanning the moves of all nodes (as good per step on dense graphs, five times slower per
step on sparse ones); longer tabu tenures.

Memory is linear in the nodes.
"""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.passes import both_cores

__all__ = ["tabu"]

_FACTOR, _INCREMENT, _ALL_BITS = 6364136223846793005, 1442695040888963407, 0xFFFFFFFFFFFFFFFF


def _tell(in_indptr, in_indices, rise, fall, i, side, up, down):
    """Add changes of node i's marginal prices to what its in-neighbours would cause by leaving or joining its side."""
    if up != 0 or down != 0:
        for k in range(in_indptr[i], in_indptr[i + 1]):
            rise[in_indices[k], side] += up
            fall[in_indices[k], side] += down


def _draw(state):
    """Return the next state of Knuth's 64-bit linear congruential generator; ``>> 33`` are its good bits."""
    return (state * _FACTOR + _INCREMENT) & _ALL_BITS


def tabu(
    in_indptr, in_indices, out_indptr, out_indices, side, kind, price, r, s, fee, least, steps, tenure, seed,
    first, second,
):  # fmt: skip
    """Search ``steps`` moves from ``side`` for a pair that violates (r,s); fill ``first`` and ``second`` with it.

    ``kind[i]`` is 1 for an anchor, which never moves. ``price[kind, x + 1]`` is what x in-neighbours outside cost, for
    x = -1 .. largest in-degree + 1. Sides never get smaller than ``least`` nodes. ``side`` is changed in place.
    Returns whether a pair was found.
    """
    luck = _draw(seed)
    n = len(side)
    inside = np.zeros((n, 3), np.int32)
    outside = np.zeros(n, np.int32)
    rise = np.zeros((n, 3), np.int32)
    fall = np.zeros((n, 3), np.int32)
    size = np.zeros(3, np.int64)
    exposed = np.zeros(3, np.int64)
    paying = np.empty(n, np.int32)
    place = np.full(n, -1, np.int32)
    until = np.zeros(n, np.int64)
    count = cost = 0
    for i in range(n):
        size[side[i]] += 1
        for k in range(in_indptr[i], in_indptr[i + 1]):
            inside[i, side[in_indices[k]]] += 1
    for i in range(n):
        a = side[i]
        if a == 2:
            continue
        x = outside[i] = in_indptr[i + 1] - in_indptr[i] - inside[i, a]
        t = kind[i]
        _tell(in_indptr, in_indices, rise, fall, i, a, price[t, x + 2] - price[t, x + 1], price[t, x + 1] - price[t, x])
        cost += price[t, x + 1]
        if x >= r:
            exposed[a] += 1
            place[i] = count
            paying[count] = i
            count += 1
    best = cost + fee * size[2]
    for step in range(steps):
        if count < s and size[0] > exposed[0] and size[1] > exposed[1]:
            for i in range(n):
                first[i] = side[i] == 0
                second[i] = side[i] == 1
            return True
        if (
            s == 1
            and step % n == n - 1
            and both_cores(in_indptr, in_indices, out_indptr, out_indices, side, r, first, second)
        ):
            return True
        if count == 0:
            return False
        # The best move around one paying node.
        luck = _draw(luck)
        u = paying[((luck >> 33) & 0x7FFFFFFF) % count]
        current = cost + fee * size[2]
        mover, goal, gain, ties = -1, 0, 1 << 40, 0
        for k in range(in_indptr[u], in_indptr[u + 1] + 1):
            v = u if k == in_indptr[u + 1] else in_indices[k]
            a = side[v]
            if kind[v] == 1 or (v != u and a == side[u]) or (a < 2 and size[a] <= least):
                continue
            degree = in_indptr[v + 1] - in_indptr[v]
            leave = rise[v, a] - price[0, outside[v] + 1] if a < 2 else -fee
            for b in range(3):
                if b == a or (v != u and b != side[u]):
                    continue
                change = leave + (price[0, degree - inside[v, b] + 1] - fall[v, b] if b < 2 else fee)
                if change > gain or (until[v] > step and current + change >= best):
                    continue
                ties = ties + 1 if change == gain else 1
                luck = _draw(luck)
                if change < gain or ((luck >> 33) & 0x7FFFFFFF) % ties == 0:
                    mover, goal, gain = v, b, change
        if mover < 0:
            continue
        # Make it: first the mover's own price, then its hearers'.
        v, a, b = mover, side[mover], goal
        if a < 2:
            x = outside[v]
            _tell(
                in_indptr, in_indices, rise, fall, v, a,
                price[0, x + 1] - price[0, x + 2], price[0, x] - price[0, x + 1],
            )  # fmt: skip
            cost -= price[0, x + 1]
            if x >= r:
                exposed[a] -= 1
                count -= 1
                paying[place[v]] = paying[count]
                place[paying[count]] = place[v]
        side[v] = b
        size[a] -= 1
        size[b] += 1
        if b < 2:
            x = outside[v] = in_indptr[v + 1] - in_indptr[v] - inside[v, b]
            _tell(
                in_indptr, in_indices, rise, fall, v, b,
                price[0, x + 2] - price[0, x + 1], price[0, x + 1] - price[0, x],
            )  # fmt: skip
            cost += price[0, x + 1]
            if x >= r:
                exposed[b] += 1
                place[v] = count
                paying[count] = v
                count += 1
        for k in range(out_indptr[v], out_indptr[v + 1]):
            i = out_indices[k]
            c = side[i]
            inside[i, a] -= 1
            inside[i, b] += 1
            if c == 2 or (c != a and c != b):
                continue
            t = kind[i]
            x = outside[i]
            y = x + 1 if c == a else x - 1
            outside[i] = y
            cost += price[t, y + 1] - price[t, x + 1]
            _tell(
                in_indptr, in_indices, rise, fall, i, c,
                price[t, y + 2] - price[t, y + 1] - price[t, x + 2] + price[t, x + 1],
                price[t, y + 1] - price[t, y] - price[t, x + 1] + price[t, x],
            )  # fmt: skip
            if y == r and x < r:
                exposed[c] += 1
                place[i] = count
                paying[count] = i
                count += 1
            elif x == r and y < r:
                exposed[c] -= 1
                count -= 1
                paying[place[i]] = paying[count]
                place[paying[count]] = place[i]
        luck = _draw(luck)
        until[v] = step + tenure + ((luck >> 33) & 0x7FFFFFFF) % (tenure + 1)
        best = min(best, cost + fee * size[2])
    return False


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
