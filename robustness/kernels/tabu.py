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

__all__ = ["Tabu"]

_FACTOR, _INCREMENT, _ALL_BITS = 6364136223846793005, 1442695040888963407, 0xFFFFFFFFFFFFFFFF


def _draw(state):
    """Return the next state of Knuth's 64-bit linear congruential generator; ``>> 33`` are its good bits."""
    return (state * _FACTOR + _INCREMENT) & _ALL_BITS


class Tabu:
    """A search from one state: who is where, who pays how much, and what every move would change.

    Parameters
    ----------
    arcs : (in_indptr, in_indices, out_indptr, out_indices)
        The rows of in-neighbours and of out-neighbours.
    target : Target
        What a pair has to violate, r and s, and what states cost on the way there: ``price``, ``fee`` for a node in
        neither side, ``least`` nodes of a side.

    Attributes
    ----------
    in_indptr, out_indptr : arrays of int64, shape (n + 1,)
    in_indices, out_indices : arrays of int32, shape (m,)
    price : array of int64, shape (2, d + 3)
        ``price[kind, x + 1]`` is what x in-neighbours outside cost, for x = -1 .. d + 1, d the largest in-degree.
    side : array of int8, shape (n,)
        Where every node is, 0, 1 or 2; changed in place.
    kind : array of int8, shape (n,)
        1 for an anchor, which never moves, else 0.
    inside : array of int32, shape (n, 3)
        How many in-neighbours every node has in each side and in neither.
    outside : array of int32, shape (n,)
        How many a node of a side has outside that side.
    rise, fall : arrays of int32, shape (n, 3)
        The sums, over the hearers that a node has in each side, of what they would pay more if the node left that side,
        and less if it joined.
    size, exposed : arrays of int64, shape (3,)
        How many nodes each side has, and how many of them pay.
    paying, place : arrays of int32, shape (n,)
        The ``count`` nodes that pay, and the place of each among them.
    until : array of int64, shape (n,)
        The step before which a node moves only to a state better than the best.
    """

    def __init__(self, arcs, target, side, kind):
        self.in_indptr, self.in_indices, self.out_indptr, self.out_indices = arcs
        self.r, self.s, self.price, self.fee, self.least = target
        self.side, self.kind = side, kind
        self.n = n = len(side)
        self.inside = np.zeros((n, 3), np.int32)
        self.outside = np.zeros(n, np.int32)
        self.rise = np.zeros((n, 3), np.int32)
        self.fall = np.zeros((n, 3), np.int32)
        self.size = np.zeros(3, np.int64)
        self.exposed = np.zeros(3, np.int64)
        self.paying = np.empty(n, np.int32)
        self.place = np.full(n, -1, np.int32)
        self.until = np.zeros(n, np.int64)
        self.count = self.cost = 0
        self._count_all()

    def _count_all(self):
        """Count the sides, and what everybody in them pays."""
        for i in range(self.n):
            self.size[self.side[i]] += 1
            for k in range(self.in_indptr[i], self.in_indptr[i + 1]):
                self.inside[i, self.side[self.in_indices[k]]] += 1
        for i in range(self.n):
            if self.side[i] < 2:
                self._enter(i, self.side[i])

    def _tell(self, i, side, up, down):
        """Tell the in-neighbours of node i how its marginal prices changed: what they cause by leaving or joining."""
        if up != 0 or down != 0:
            for k in range(self.in_indptr[i], self.in_indptr[i + 1]):
                self.rise[self.in_indices[k], side] += up
                self.fall[self.in_indices[k], side] += down

    def _expose(self, i, side):
        """Enter node i of ``side`` in the list of those that pay."""
        self.exposed[side] += 1
        self.place[i] = self.count
        self.paying[self.count] = i
        self.count += 1

    def _cover(self, i, side):
        """Take node i of ``side`` off that list; the last of the list takes its place."""
        self.exposed[side] -= 1
        self.count -= 1
        last = self.paying[self.count]
        self.paying[self.place[i]] = last
        self.place[last] = self.place[i]

    def _enter(self, i, side):
        """Let node i pay as a member of ``side``."""
        t = self.kind[i]
        x = self.in_indptr[i + 1] - self.in_indptr[i] - self.inside[i, side]
        self.outside[i] = x
        before, now, after = self.price[t, x], self.price[t, x + 1], self.price[t, x + 2]
        self._tell(i, side, after - now, now - before)
        self.cost += now
        if x >= self.r:
            self._expose(i, side)

    def _leave(self, i, side):
        """Let node i, which is no anchor, pay no more as a member of ``side``."""
        x = self.outside[i]
        before, now, after = self.price[0, x], self.price[0, x + 1], self.price[0, x + 2]
        self._tell(i, side, now - after, before - now)
        self.cost -= now
        if x >= self.r:
            self._cover(i, side)

    def _best_move(self, u, step, best):
        """Find the best move that helps node u, which pays: return who moves, or -1, and where to."""
        luck, current = self.luck, self.cost + self.fee * self.size[2]
        mover, goal, gain, ties = -1, 0, 1 << 40, 0
        begin, end, own = self.in_indptr[u], self.in_indptr[u + 1], self.side[u]
        for k in range(begin, end + 1):
            v = u if k == end else self.in_indices[k]
            a = self.side[v]
            if self.kind[v] == 1 or (v != u and a == own) or (a < 2 and self.size[a] <= self.least):
                continue
            degree = self.in_indptr[v + 1] - self.in_indptr[v]
            leave = self.rise[v, a] - self.price[0, self.outside[v] + 1] if a < 2 else -self.fee
            for b in range(3):
                if b == a or (v != u and b != own):
                    continue
                if b < 2:
                    change = leave + self.price[0, degree - self.inside[v, b] + 1] - self.fall[v, b]
                else:
                    change = leave + self.fee
                if change > gain or (self.until[v] > step and current + change >= best):
                    continue
                ties = ties + 1 if change == gain else 1
                luck = _draw(luck)
                if change < gain or ((luck >> 33) & 0x7FFFFFFF) % ties == 0:
                    mover, goal, gain = v, b, change
        self.luck = luck
        return mover, goal

    def _move(self, v, b):
        """Move node v to ``b``: first its own price, then those of its hearers."""
        a = self.side[v]
        if a < 2:
            self._leave(v, a)
        self.side[v] = b
        self.size[a] -= 1
        self.size[b] += 1
        if b < 2:
            self._enter(v, b)
        for k in range(self.out_indptr[v], self.out_indptr[v + 1]):
            i = self.out_indices[k]
            c = self.side[i]
            self.inside[i, a] -= 1
            self.inside[i, b] += 1
            if c == 2 or (c != a and c != b):
                continue
            t = self.kind[i]
            x = self.outside[i]
            y = x + 1 if c == a else x - 1
            self.outside[i] = y
            old_before, old, old_after = self.price[t, x], self.price[t, x + 1], self.price[t, x + 2]
            before, now, after = self.price[t, y], self.price[t, y + 1], self.price[t, y + 2]
            self.cost += now - old
            self._tell(i, c, after - now - old_after + old, now - before - old + old_before)
            if y == self.r and x < self.r:
                self._expose(i, c)
            elif x == self.r and y < self.r:
                self._cover(i, c)

    def run(self, steps, tenure, seed, first, second):
        """Make ``steps`` moves; return whether a violating pair was found, and fill ``first`` and ``second`` with it.

        Parameters
        ----------
        steps : int
        tenure : int
            A node that has moved stays for ``tenure`` to twice as many steps, unless its move leads to a best state.
        seed : int
        first, second : arrays of uint8, shape (n,)
        """
        self.luck = _draw(seed)
        best = self.cost + self.fee * self.size[2]
        for step in range(steps):
            if self.count < self.s and self.size[0] > self.exposed[0] and self.size[1] > self.exposed[1]:
                for i in range(self.n):
                    first[i] = self.side[i] == 0
                    second[i] = self.side[i] == 1
                return True
            if (
                self.s == 1
                and step % self.n == self.n - 1
                and both_cores(
                    self.in_indptr, self.in_indices, self.out_indptr, self.out_indices, self.side, self.r, first, second
                )
            ):
                return True
            if self.count == 0:
                return False
            self.luck = _draw(self.luck)
            v, b = self._best_move(self.paying[((self.luck >> 33) & 0x7FFFFFFF) % self.count], step, best)
            if v < 0:
                continue
            self._move(v, b)
            self.luck = _draw(self.luck)
            self.until[v] = step + tenure + ((self.luck >> 33) & 0x7FFFFFFF) % (tenure + 1)
            best = min(best, self.cost + self.fee * self.size[2])
        return False


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
