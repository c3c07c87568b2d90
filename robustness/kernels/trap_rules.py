"""The heart of the trap search: one state and its propagation rules.

What is looked for is defined in :mod:`robustness.traps.question`: M, N1 and N2, with one face or two, M bounded in
total or locally. Node i of N_k is *satisfied* when at least ``k_i = d_i - f`` of its in-neighbours are *inside* side k:
the nodes of N_k are, and malicious nodes, inside both sides with two faces and inside one of them with one.

State
-----
Nine node sets as rows of 64-bit words, shape ``(9, words)``; k is 1 or 2:

====  ======================================================
P_k   may be a normal node of side k
Q_k   may be malicious and inside side k (two faces: Q_1 = Q_2)
F_k   is inside side k, normal or malicious
T_k   is a normal node of side k (subset of F_k and of P_k)
Z     is malicious
====  ======================================================

``D_k = P_k | F_k | Z & Q_k`` are the nodes that can be inside without a further malicious one (with one face a node of
Z may have no side yet). ``left`` is how many further malicious nodes a node can hear: ``f - |Z|`` (total) or
``f - |N_i & Z|`` (local, i normal).

Rules (each keeps every solution of the state)
----------------------------------------------
*roles*
    a node has one role: what it is for certain excludes the others; inside and not possibly normal: malicious
*budget*
    nothing left: nobody else is malicious. Local: a node that cannot be malicious and hears f malicious ones
    hears no more; one that hears more than f is malicious itself
*peel*
    i leaves P_k when ``|N_i & D_k| + min(left, |N_i & Q_k - D_k|) < k_i``; P_k empty: contradiction
*force*
    equality at i in T_k makes those in-neighbours inside
*share*
    (total) the nodes of T need ``sum (k_i - |N_i & D_k|)`` places inside from further malicious nodes (summed
    where positive), and the ``f - |Z|`` that are left give at most what the most wanted of them give together
*count*
    i in T_1 excludes j from P_2 (and mirrored) when ``|A | B| + |A & B & Z| + gain < k_i + k_j`` with
    ``A = N_i & D_1 - j``, ``B = N_j & D_2 - i``: i and j need ``k_i + k_j`` places inside, a node that is
    inside one side only gives each at most one place in all, a node of Z two (two faces), and *gain* is the
    most that further malicious nodes can add

Everything here runs without the interpreter's lock. :mod:`robustness.kernels.trap_loop` drives it.
"""

from __future__ import annotations

import numpy as np

from robustness.kernels import layout

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.shared import varint
    from robustness.kernels.words import bit_of, count, first

__all__ = ["TrapRules"]

P, Q, F, T, Z = layout.TRAP_P, layout.TRAP_Q, layout.TRAP_F, layout.TRAP_T, layout.TRAP_Z
PROPAGATE, EXCLUDE, NORMAL = layout.PROPAGATE, layout.EXCLUDE, layout.NORMAL


class TrapRules:
    """One question about one graph, with the scratch memory that the rules need.

    Parameters
    ----------
    hears : array of uint64, shape (n, words)
        Bit j of row i: i hears j.
    need : array of int64, shape (n,)
        ``k_i = max(0, d_i - f)``.
    f : int
        The bound on M.
    two_faces, local : bool
        The kind of question.
    counting : bool
        Whether the rules *share* and *count* are on.

    Attributes
    ----------
    state : array of uint64, shape (9, words)
    margin : array of int64, shape (2, n)
        After :meth:`propagate`, how far every candidate of either side is from being excluded by *count* if nobody
        else is malicious.
    buffer : array of uint8, shape (room,)
        Where the transcript is written; at least 32 n^2 bytes beyond ``place`` are free at every node.
    place : int
        Where the transcript goes on in ``buffer``; -1: none is kept. One is kept with ``counting`` only, since the
        verifier applies *share* by itself.
    blocker, budget, votes : arrays of int64, shape (n,)
        The blockers of one side, how many further malicious nodes each can hear, and scratch of *share*.
    reach, loose : arrays of uint64, shape (n, words)
        Whom each blocker hears of ``D``, and of ``Q - Z``.
    near : array of uint64, shape (3, words)
        Whom the candidate hears of ``D``, of ``Q - Z``, and of ``D`` those that give one place at most.
    """

    def __init__(self, hears, need, f, two_faces, local, counting):
        self.hears, self.need, self.f = hears, need, f
        self.two_faces, self.local, self.counting = two_faces, local, counting
        self.n, self.words = hears.shape
        self.votes = np.zeros(self.n, np.int64)
        self.margin = np.zeros((2, self.n), np.int64)
        self.reach = np.empty((self.n, self.words), np.uint64)
        self.loose = np.empty((self.n, self.words), np.uint64)
        self.near = np.empty((3, self.words), np.uint64)
        self.blocker = np.empty(self.n, np.int64)
        self.budget = np.empty(self.n, np.int64)
        self.buffer = np.empty(1, np.uint8)
        self.place = -1

    def _roles(self, state):
        """Apply *roles* to every word; return 0 for a contradiction, 2 when something changed, else 1."""
        changed = False
        for w in range(self.words):
            p1, p2, q1, q2 = state[P, w], state[P + 1, w], state[Q, w], state[Q + 1, w]
            f1, f2, t1, t2, z = state[F, w], state[F + 1, w], state[T, w], state[T + 1, w], state[Z, w]
            while True:
                f1 |= t1
                f2 |= t2
                q1 &= ~(t1 | t2)
                q2 &= ~(t1 | t2)
                if self.two_faces:
                    z |= f1 & f2
                else:
                    q1 &= ~f2
                    q2 &= ~f1
                z |= f1 & ~p1 | f2 & ~p2
                p1 &= ~(z | f2)
                p2 &= ~(z | f1)
                if self.two_faces:
                    f1 |= z
                    f2 |= z
                else:
                    f1 |= z & ~q2
                    f2 |= z & ~q1
                t1 |= f1 & ~q1
                t2 |= f2 & ~q2
                if f1 & ~(p1 | q1) or f2 & ~(p2 | q2) or t1 & ~p1 or t2 & ~p2 or z & ~(q1 | q2):
                    return 0
                if not self.two_faces and f1 & f2:
                    return 0
                same = p1 == state[P, w] and p2 == state[P + 1, w] and q1 == state[Q, w] and q2 == state[Q + 1, w]
                same = same and f1 == state[F, w] and f2 == state[F + 1, w] and z == state[Z, w]
                same = same and t1 == state[T, w] and t2 == state[T + 1, w]
                if same:
                    break
                changed = True
                state[P, w], state[P + 1, w], state[Q, w], state[Q + 1, w] = p1, p2, q1, q2
                state[F, w], state[F + 1, w], state[T, w], state[T + 1, w], state[Z, w] = f1, f2, t1, t2, z
        return 2 if changed else 1

    def sure(self, state, side, x):
        """Return a word of ``D_side``: who can be inside the side without a further malicious node."""
        return state[P + side, x] | state[F + side, x] | state[Z, x] & state[Q + side, x]

    def _heard_malicious(self, state, node):
        """Return how many nodes of Z the node hears."""
        total = 0
        for x in range(self.words):
            total += count(self.hears[node, x] & state[Z, x])
        return total

    def _budget(self, state):
        """Apply *budget*; return 0 for a contradiction, 2 when something changed, else 1."""
        n, words = self.n, self.words
        changed = False
        if not self.local:
            used = 0
            for w in range(words):
                used += count(state[Z, w])
            if used > self.f:
                return 0
            if used == self.f:
                for w in range(words):
                    if (state[Q, w] | state[Q + 1, w]) & ~state[Z, w]:
                        state[Q, w] &= state[Z, w]
                        state[Q + 1, w] &= state[Z, w]
                        changed = True
            return 2 if changed else 1
        for i in range(n):
            w, bit = i >> 6, bit_of(i)
            if state[Z, w] & bit:
                continue
            used = self._heard_malicious(state, i)
            if used < self.f:
                continue
            if (state[Q, w] | state[Q + 1, w]) & bit:
                if used > self.f:
                    state[Z, w] |= bit
                    changed = True
                continue
            if used > self.f:
                return 0
            for x in range(words):
                lost = self.hears[i, x] & ~state[Z, x]
                if (state[Q, x] | state[Q + 1, x]) & lost:
                    state[Q, x] &= ~lost
                    state[Q + 1, x] &= ~lost
                    changed = True
        return 2 if changed else 1

    def _left(self, state, node):
        """Return how many further malicious nodes a normal node can hear."""
        if self.local:
            return self.f - self._heard_malicious(state, node)
        used = 0
        for x in range(self.words):
            used += count(state[Z, x])
        return self.f - used

    def _peel(self, state, side):
        """Apply *peel* and *force* to one side; return 0 for a contradiction, 2 when something changed, else 1."""
        words = self.words
        changed, some = False, False
        for w in range(words):
            rest = state[P + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - 1
                bit = bit_of(i)
                inside, extra = 0, 0
                for x in range(words):
                    known = self.sure(state, side, x)
                    inside += count(self.hears[i, x] & known)
                    extra += count(self.hears[i, x] & state[Q + side, x] & ~known)
                certain = state[T + side, w] & bit
                if inside > self.need[i] or (inside == self.need[i] and not certain):
                    continue
                usable = min(self._left(state, i), extra)
                if inside + usable < self.need[i]:
                    if certain:
                        return 0
                    state[P + side, w] &= ~bit
                    changed = True
                elif inside + usable == self.need[i] and certain:
                    for x in range(words):
                        wanted = self.hears[i, x] & self.sure(state, side, x)
                        if usable == extra:
                            wanted |= self.hears[i, x] & state[Q + side, x]
                        if wanted & ~state[F + side, x]:
                            state[F + side, x] |= wanted
                            changed = True
            if state[P + side, w]:
                some = True
        if not some:
            return 0
        return 2 if changed else 1

    def _gain(self, left_i, left_j, x, y, z_i, z_j):
        """Return the most places that further malicious nodes add for i and j together.

        x, y: heard by both, with and without a place counted already; z_i, z_j: heard by one alone, no place counted.
        A node of y gives two places when it has two faces, all others one more; with one face a node of x gives none.
        """
        if not self.two_faces:
            if self.local:
                return min(left_i, z_i + y) + min(left_j, z_j + y)
            return min(left_i, z_i + z_j + y)
        if not self.local:
            twice = min(left_i, y)
            return 2 * twice + min(left_i - twice, x + z_i + z_j)
        # Nodes of x take from both budgets and give one place, so they come last.
        spent_i, spent_j = min(left_i, z_i + y), min(left_j, z_j + y)
        return spent_i + spent_j + min(x, min(left_i - spent_i, left_j - spent_j))

    def _gather_blockers(self, state, side):
        """Note every normal node of a side, whom it hears of D, of Q - Z, and how many of these may be malicious."""
        words, most = self.words, 0
        for v in range(words):
            rest = state[T + side, v]
            while rest:
                i = (v << 6) + first(rest)
                rest &= rest - 1
                for x in range(words):
                    self.reach[most, x] = self.hears[i, x] & self.sure(state, side, x)
                    self.loose[most, x] = self.hears[i, x] & state[Q + side, x] & ~state[Z, x]
                self.blocker[most] = i
                self.budget[most] = self._left(state, i)
                most += 1
        return most

    def _further(self, j, a, left_j):
        """Return the most places that further malicious nodes add for candidate j and the blocker at place ``a``."""
        i, x, y, z_i, z_j = self.blocker[a], 0, 0, 0, 0
        for u in range(self.words):
            either = self.reach[a, u] | self.near[0, u]
            one, two = self.loose[a, u], self.near[1, u]
            if u == j >> 6:
                one &= ~bit_of(j)
            if u == i >> 6:
                two &= ~bit_of(i)
            x += count(one & two & either)
            y += count(one & two & ~either)
            z_i += count(one & ~two & ~either)
            z_j += count(two & ~one & ~either)
        return self._gain(self.budget[a], left_j, x, y, z_i, z_j)

    def _exclude(self, state, side):
        """Apply *count* with all blockers of a side; return 0 for a contradiction, 2 when something changed, else 1."""
        words, other, near, reach, need = self.words, 1 - side, self.near, self.reach, self.need
        most = self._gather_blockers(state, side)
        changed = False
        for w in range(words):
            rest = state[P + other, w]
            while rest:
                j = (w << 6) + first(rest)
                rest &= rest - 1
                have = -need[j]
                for x in range(words):
                    near[0, x] = self.hears[j, x] & self.sure(state, other, x)
                    near[1, x] = self.hears[j, x] & state[Q + other, x] & ~state[Z, x]
                    near[2, x] = near[0, x] & ~state[Z, x] if self.two_faces else near[0, x]
                    have += count(near[0, x])
                margin = 2 * self.n
                for a in range(most):
                    i = self.blocker[a]
                    places = have - need[i]
                    for x in range(words):
                        places += count(reach[a, x] & ~near[2, x])
                    if reach[a, w] & bit_of(j):
                        places -= 1
                    if near[0, i >> 6] & bit_of(i):
                        places -= 1
                    margin = min(margin, places)
                    if places >= 0:
                        continue
                    if places + self._further(j, a, self._left(state, j)) >= 0:
                        continue
                    if self.place >= 0:
                        self.place = varint(self.buffer, self.place, EXCLUDE + other)
                        self.place = varint(self.buffer, self.place, j)
                        self.place = varint(self.buffer, self.place, i)
                    if state[T + other, w] & bit_of(j):
                        return 0
                    state[P + other, w] &= ~bit_of(j)
                    changed = True
                    break
                self.margin[other, j] = margin
        return 2 if changed else 1

    def lack(self, state, side, node):
        """Return how many further malicious nodes the node of T needs inside its side; below 0: it can spare some."""
        inside = 0
        for x in range(self.words):
            inside += count(self.hears[node, x] & self.sure(state, side, x))
        return self.need[node] - inside

    def _share(self, state):
        """Apply *share*; return False for a contradiction."""
        n, words = self.n, self.words
        for v in range(n):
            self.votes[v] = 0
        total = 0
        for side in range(2):
            for w in range(words):
                rest = state[T + side, w]
                while rest:
                    i = (w << 6) + first(rest)
                    rest &= rest - 1
                    missing = self.lack(state, side, i)
                    if missing <= 0:
                        continue
                    total += missing
                    for x in range(words):
                        open_ = self.hears[i, x] & state[Q + side, x] & ~self.sure(state, side, x)
                        while open_:
                            self.votes[(x << 6) + first(open_)] += 1
                            open_ &= open_ - 1
        left = self._left(state, 0)  # in total: the same for every node
        while total > 0 and left > 0:
            best = 0
            for v in range(n):
                if self.votes[v] > self.votes[best]:
                    best = v
            if self.votes[best] == 0:
                return False
            total -= self.votes[best]
            self.votes[best] = 0
            left -= 1
        return total <= 0

    def propagate(self, state):
        """Apply all rules until nothing changes; return False on contradiction.

        The transcript receives every exclusion: EXCLUDE steps, PROPAGATE, EXCLUDE steps, and so on.
        """
        while True:
            told = self._roles(state)
            if told == 0:
                return False
            told = self._budget(state)
            if told == 0:
                return False
            if told == 2:
                continue
            again = False
            for side in range(2):
                told = self._peel(state, side)
                if told == 0:
                    return False
                again |= told == 2
            if again:
                continue
            if self.counting:
                if not self.local and not self._share(state):
                    return False
                for side in range(2):
                    told = self._exclude(state, side)
                    if told == 0:
                        return False
                    again |= told == 2
            if not again:
                return True
            if self.place >= 0:
                self.place = varint(self.buffer, self.place, PROPAGATE)


def assume(state, kind, side, node, true, two_faces):
    """Make the literal (kind, side, node) true or false in ``state``, before any propagation.

    Parameters
    ----------
    state : array of uint64, shape (9, words)
    kind : int
        NORMAL or MALICIOUS.
    side, node : int
    true, two_faces : bool
    """
    w, bit = node >> 6, bit_of(node)
    if kind == NORMAL:
        if true:
            state[T + side, w] |= bit
        else:
            state[P + side, w] &= ~bit
    elif true:
        state[Z, w] |= bit
        state[F + side, w] |= bit
    else:
        state[Q + side, w] &= ~bit
        if two_faces:
            state[Q + 1 - side, w] &= ~bit


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
