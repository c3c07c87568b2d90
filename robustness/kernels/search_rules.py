"""The heart of ``subset-search``: one state and its propagation rules.

State
-----
The search looks for a violating pair (S1, S2) of (r,s)-robustness. With ``k_i = d_i - r + 1``, node i of S_k is
*satisfied* when at least ``k_i`` of its in-neighbours lie in S_k (equivalently ``i not in X_Sk``), else *exempt*.
A pair violates (r,s) exactly when both sides hold a satisfied node and at most ``s - 1`` nodes are exempt. A state is
eight node sets, four a side, as rows of 64-bit words, shape ``(8, words)``:

====  ==========================================================================
C_k   may be a member of S_k
P_k   may be a satisfied member of S_k (subset of C_k)
F_k   is a member of S_k
T_k   is a satisfied member of S_k (subset of F_k and of P_k)
====  ==========================================================================

``F_k - P_k`` is exempt for certain; ``b = s - 1`` minus these is the number of exemptions left. ``D_k = P_k | F_k``
are the nodes that can be members without using one of them.

Rules (each preserves every violating pair of the state; lemmas in docs/certificate-format.md)
----------------------------------------------------------------------------------------------
*peel*
    i leaves P_k when fewer than k_i in-neighbours can be members, that is when
    ``|N_i & D_k| + min(b, |N_i & C_k - D_k|) < k_i``
*force*
    equality at i in T_k makes those in-neighbours members
*share*
    when side 2 needs t exemptions to satisfy T_2 and anybody at all, side 1 has ``b_1 = b - t`` (and mirrored);
    peel and force use b_k in the place of b
*disjoint*
    a member of one side leaves the other; no exemption left: everybody is satisfied; P_k empty: contradiction
*count*
    blockers I within T_1 exclude j from P_2 (and mirrored) when
    ``sum_I (|N_i & D_1 - j| - k_i) + |N_j & D_2 - union_I N_i & D_1| + b + (|I| - 1) b_1 < k_j``:
    at most ``|N_i & D_1| - k_i`` (+ b) of i's in-neighbours can be missing from S1, hence be in S2. One blocker
    is pair counting, two are found greedily. A literal whose propagation fails is thereby false (look-ahead).

Everything here runs without the interpreter's lock. :mod:`robustness.kernels.search_loop` drives it.
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

__all__ = ["Rules"]

C, P, F, T = layout.C, layout.P, layout.F, layout.T
PROPAGATE, EXCLUDE = layout.PROPAGATE, layout.EXCLUDE
SATISFIED = layout.SATISFIED


class Rules:
    """One question about one graph, with the scratch memory that the rules need: one of these for each thread.

    Parameters
    ----------
    hears : array of uint64, shape (n, words)
        Bit j of row i: i hears j.
    need : array of int64, shape (n,)
        ``k_i = max(0, d_i - r + 1)``.
    spare : int
        ``s - 1``, how many nodes may be exempt.
    blockers : 0, 1 or 2
        How many satisfied nodes *count* may combine; 0 switches it off.
    sharing : bool
        Whether the rule *share* is on.

    Attributes
    ----------
    state : array of uint64, shape (8, words)
        What every method works on, see above.
    margin : array of int64, shape (2, n)
        After :meth:`propagate`, how far every candidate of either side is from being excluded by *count*.
    buffer : array of uint8, shape (room,)
        Where the transcript is written; 32 n^2 bytes beyond ``place`` are free at every node.
    place : int
        Where the transcript goes on in ``buffer``; -1: none is kept.
    allowed : array of int64, shape (2,)
        ``b_k`` of the rule *share*.
    blocker, slack : arrays of int64, shape (n,)
        The blockers of one side, and how many of the in-neighbours in ``reach`` each can do without.
    reach : array of uint64, shape (n, words)
        Whom each blocker hears of ``D``.
    trial : array of uint64, shape (words,)
        Scratch.
    """

    def __init__(self, hears, need, spare, blockers, sharing):
        n, words = hears.shape
        self.hears, self.need, self.spare, self.blockers, self.sharing = hears, need, spare, blockers, sharing
        self.n, self.words = n, words
        self.margin = np.zeros((2, n), np.int64)
        self.reach = np.empty((n, words), np.uint64)
        self.slack = np.empty(n, np.int64)
        self.blocker = np.empty(n, np.int64)
        self.trial = np.empty(words, np.uint64)
        self.allowed = np.empty(2, np.int64)
        self.buffer = np.empty(1, np.uint8)
        self.place = -1

    def _least_spare(self, state, left, side):
        """Return the least t for which t exemptions may let T and anybody at all be satisfied, or left + 1."""
        words, trial, hears = self.words, self.trial, self.hears
        for t in range(left + 1):
            for w in range(words):
                trial[w] = state[P + side, w]
            changed = True
            while changed:
                changed = False
                for w in range(words):
                    rest = trial[w]
                    while rest:
                        i = (w << 6) + first(rest)
                        rest &= rest - 1
                        inside, extra = 0, 0
                        for x in range(words):
                            sure = trial[x] | state[F + side, x]
                            inside += count(hears[i, x] & sure)
                            extra += count(hears[i, x] & state[C + side, x] & ~sure)
                        if inside + min(t, extra) < self.need[i]:
                            trial[w] &= ~bit_of(i)
                            changed = True
            some, all_kept = False, True
            for w in range(words):
                if trial[w]:
                    some = True
                if state[T + side, w] & ~trial[w]:
                    all_kept = False
            if some and all_kept:
                return t
        return left + 1

    def _settle(self, state):
        """Apply *disjoint*, *peel*, *force* and *share* until nothing changes.

        Return the exemptions left, or -1 on contradiction; ``allowed[k]`` receives how many of them side k can use.
        """
        words, hears, need, allowed = self.words, self.hears, self.need, self.allowed
        allowed[0] = allowed[1] = self.spare
        while True:
            left = self.spare
            for w in range(words):
                state[F, w] |= state[T, w]
                state[F + 1, w] |= state[T + 1, w]
                state[C, w] &= ~state[F + 1, w]
                state[C + 1, w] &= ~state[F, w]
                for side in range(2):
                    state[P + side, w] &= state[C + side, w]
                    if state[F + side, w] & ~state[C + side, w] or state[T + side, w] & ~state[P + side, w]:
                        return -1
                    left -= count(state[F + side, w] & ~state[P + side, w])
            if left < 0:
                return -1
            changed = False
            for side in range(2):
                spared = min(allowed[side], left)
                if spared == 0:
                    for w in range(words):
                        state[C + side, w] = state[P + side, w] | state[F + side, w]
                        state[T + side, w] = state[P + side, w] & state[F + side, w]
                some = False
                for w in range(words):
                    rest = state[P + side, w]
                    while rest:
                        i = (w << 6) + first(rest)
                        rest &= rest - 1
                        bit = bit_of(i)
                        inside, extra = 0, 0
                        for x in range(words):
                            inside += count(hears[i, x] & (state[P + side, x] | state[F + side, x]))
                        if inside >= need[i] and not (state[T + side, w] & bit and inside <= need[i] + spared):
                            continue
                        if spared:
                            for x in range(words):
                                extra += count(
                                    hears[i, x] & state[C + side, x] & ~(state[P + side, x] | state[F + side, x])
                                )
                        usable = min(spared, extra)
                        if inside + usable < need[i]:
                            if state[T + side, w] & bit:
                                return -1
                            state[P + side, w] &= ~bit
                            changed = True
                        elif inside + usable == need[i] and state[T + side, w] & bit:
                            for x in range(words):
                                wanted = hears[i, x] & (state[P + side, x] | state[F + side, x])
                                if 0 < spared and extra <= spared:
                                    wanted = hears[i, x] & state[C + side, x]
                                if wanted & ~state[F + side, x]:
                                    state[F + side, x] |= wanted
                                    changed = True
                    if state[P + side, w]:
                        some = True
                if not some:
                    return -1
            if changed:
                continue
            if left and self.sharing:
                for side in range(2):
                    fair = left - self._least_spare(state, left, 1 - side)
                    if fair < 0:
                        return -1
                    if fair < min(allowed[side], left):
                        allowed[side] = fair
                        changed = True
            if not changed:
                allowed[0] = min(allowed[0], left)
                allowed[1] = min(allowed[1], left)
                return left

    def _gather_blockers(self, state, side):
        """Note every satisfied member of a side, whom it hears there, and how many of these it can do without."""
        hears, reach, most = self.hears, self.reach, 0
        for w in range(self.words):
            rest = state[T + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - 1
                slack = -self.need[i]
                for x in range(self.words):
                    reach[most, x] = hears[i, x] & (state[P + side, x] | state[F + side, x])
                    slack += count(reach[most, x])
                self.slack[most] = slack
                self.blocker[most] = i
                most += 1
        return most

    def _exclude(self, state, left, side):
        """Apply *count* once to every candidate of the other side; return how many it excludes, -1 on contradiction."""
        words, other, hears, reach = self.words, 1 - side, self.hears, self.reach
        most = self._gather_blockers(state, side)
        found = 0
        for w in range(words):
            rest = state[P + other, w]
            while rest:
                j = (w << 6) + first(rest)
                rest &= rest - 1
                bit = bit_of(j)
                have, gain, next_gain, one, two = left, 0, 0, -1, -1
                for x in range(words):
                    have += count(hears[j, x] & (state[P + other, x] | state[F + other, x]))
                for a in range(most):
                    value = -self.slack[a]
                    if reach[a, w] & bit:
                        value += 1
                    for x in range(words):
                        value += count(hears[j, x] & (state[P + other, x] | state[F + other, x]) & reach[a, x])
                    if value > gain:
                        next_gain, gain, one = gain, value, a
                    elif value > next_gain:
                        next_gain = value
                have -= gain
                self.margin[other, j] = have - self.need[j]
                if one < 0:
                    continue
                if have >= self.need[j]:
                    # Beside another, no blocker gains more than it does alone, and it costs what exemptions allow.
                    if self.blockers < 2 or have - next_gain + self.allowed[side] >= self.need[j]:
                        continue
                    gain = 0
                    for a in range(most):
                        if a == one:
                            continue
                        value = -self.slack[a] - self.allowed[side]
                        if reach[a, w] & bit:
                            value += 1
                        for x in range(words):
                            value += count(
                                hears[j, x] & (state[P + other, x] | state[F + other, x]) & ~reach[one, x] & reach[a, x]
                            )
                        if value > gain:
                            gain, two = value, a
                    self.margin[other, j] = have - gain - self.need[j]
                    if two < 0 or have - gain >= self.need[j]:
                        continue
                self._note_exclusion(other, j, one, two)
                if state[T + other, w] & bit:
                    return -1
                state[P + other, w] &= ~bit
                found += 1
        return found

    def _note_exclusion(self, side, node, one, two):
        """Write an EXCLUDE step to the transcript; ``two`` is -1 for a single blocker."""
        if self.place < 0:
            return
        self.place = varint(self.buffer, self.place, EXCLUDE + side + (2 if two >= 0 else 0))
        self.place = varint(self.buffer, self.place, node)
        self.place = varint(self.buffer, self.place, self.blocker[one])
        if two >= 0:
            self.place = varint(self.buffer, self.place, self.blocker[two])

    def propagate(self, state):
        """Apply all rules until nothing changes; return the exemptions left, or -1 on contradiction.

        The transcript receives every exclusion: EXCLUDE steps, PROPAGATE, EXCLUDE steps, and so on.
        """
        while True:
            left = self._settle(state)
            if left < 0 or self.blockers == 0:
                return left
            excluded = 0
            for side in range(2):
                found = self._exclude(state, left, side)
                if found < 0:
                    return -1
                excluded += found
            if excluded == 0:
                return left
            if self.place >= 0:
                self.place = varint(self.buffer, self.place, PROPAGATE)


def assume(state, kind, side, node, true):
    """Make the literal (kind, side, node) true or false in ``state``, before any propagation.

    Parameters
    ----------
    state : array of uint64, shape (8, words)
    kind : int
        SATISFIED or MEMBER.
    side, node : int
    true : bool
    """
    w, bit = node >> 6, bit_of(node)
    if kind == SATISFIED:
        if true:
            state[T + side, w] |= bit
        else:
            state[P + side, w] &= ~bit
    elif true:
        state[F + side, w] |= bit
    else:
        state[C + side, w] &= ~bit
        state[P + side, w] &= ~bit


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
