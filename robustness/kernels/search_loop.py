"""The resumable depth-first search over the states of :mod:`robustness.kernels.search_rules`.

``Search.run`` works on an explicit stack of subproblems, so that it can stop after a number of nodes, hand a pending
subproblem to another thread, or flush its transcript, and go on as if nothing had happened.

A level of the stack is *pending* while its state has not been propagated: the false child of a branch, or a fresh
cube. A *symmetric* level holds the same sets on both sides, so that a root v may be chosen without loss of
generality as a satisfied node of S1, and is satisfied in neither set when that is refuted. A pending level whose
subproblem was *given* away is skipped when the search comes back to it.
"""

from __future__ import annotations

import numpy as np

from robustness.kernels import layout

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.search_rules import assume
    from robustness.kernels.shared import copy_state, core, most_promising, varint
    from robustness.kernels.words import bit_of, count, first

__all__ = ["Search"]

C, P, F, T = layout.C, layout.P, layout.F, layout.T
ROOT, BRANCH, SATISFIED, MEMBER = layout.ROOT, layout.BRANCH, layout.SATISFIED, layout.MEMBER
PENDING, SYMMETRIC, GIVEN = layout.PENDING, layout.SYMMETRIC, layout.GIVEN
NODES, FAILED, PROBES = layout.NODES, layout.FAILED, layout.PROBES
CLOSED, FOUND, PAUSED, FLUSH = layout.CLOSED, layout.FOUND, layout.PAUSED, layout.FLUSH
GROW, DONATED, STUCK, TRIED = layout.GROW, layout.DONATED, layout.STUCK, layout.TRIED


class Search:
    """A search of one thread: its stack, its counters, and what it has found.

    Parameters
    ----------
    rules : Rules
        The question.
    look_ahead : bool
        Whether branching first tries a few nodes.

    Attributes
    ----------
    stack : array of uint64, shape (levels, 8, words)
        States; the caller may replace it by a longer one.
    table : array of int64, shape (levels, 3)
        For each level whether it is PENDING, SYMMETRIC, GIVEN.
    level : int
        The level at work; -1 when all is refuted.
    counters : array of int64, shape (3,)
        NODES, FAILED, PROBES.
    pair : array of uint64, shape (2, words)
        S1 and S2 after FOUND.
    state, scratch : arrays of uint64, shape (8, words)
        A level of the stack, as methods take it, and the copy that look-ahead tries a node on.
    scratch_margin : array of int64, shape (2, n)
        The margins of that copy.
    value, chosen : arrays of int64, shape (tried,)
        Which nodes look-ahead tries, see :func:`robustness.kernels.shared.most_promising`.
    nobody : array of uint64, shape (words,)
        Scratch.
    """

    def __init__(self, rules, look_ahead):
        words, n = rules.words, rules.n
        self.rules, self.look_ahead = rules, look_ahead
        self.stack = np.zeros((64, 8, words), np.uint64)
        self.table = np.zeros((64, 3), np.int64)
        self.level = 0
        self.counters = np.zeros(3, np.int64)
        self.pair = np.zeros((2, words), np.uint64)
        self.nobody = np.zeros(words, np.uint64)
        self.scratch = np.empty((8, words), np.uint64)
        self.scratch_margin = np.zeros((2, n), np.int64)
        self.value = np.empty(TRIED, np.int64)
        self.chosen = np.empty(TRIED, np.int64)
        self.side, self.node = 0, -1

    def _harvest(self, state):
        """Try to read a violating pair off the state: all of a side that stands alone, the rest for the other."""
        pair, nobody = self.pair, self.nobody
        for side in range(2):
            other = 1 - side
            for w in range(self.rules.words):
                pair[side, w] = state[P + side, w]
                nobody[w] = state[F + side, w] & ~state[P + side, w]
            if not core(self.rules.hears, self.rules.need, pair[side], nobody):
                continue
            for w in range(self.rules.words):
                pair[other, w] = state[P + other, w] & ~pair[side, w]
                pair[side, w] |= nobody[w]
                nobody[w] = state[F + other, w] & ~state[P + other, w]
            if core(self.rules.hears, self.rules.need, pair[other], nobody):
                for w in range(self.rules.words):
                    pair[other, w] |= nobody[w]
                return True
        return False

    def _undetermined(self, state):
        """Look for a node whose membership an unsatisfied candidate still depends on; its side is -1 without one."""
        hears, need, words = self.rules.hears, self.rules.need, self.rules.words
        for side in range(2):
            for w in range(words):
                rest = state[P + side, w]
                while rest:
                    i = (w << 6) + first(rest)
                    rest &= rest - 1
                    inside = 0
                    for x in range(words):
                        inside += count(hears[i, x] & (state[P + side, x] | state[F + side, x]))
                    if inside >= need[i]:
                        continue
                    for x in range(words):
                        open_ = hears[i, x] & state[C + side, x] & ~(state[P + side, x] | state[F + side, x])
                        if open_:
                            self.side, self.node = side, (x << 6) + first(open_)
                            return
        self.side, self.node = -1, -1

    def _weight(self, state):
        """Return how much is still open: candidates that are not settled."""
        total = 0
        for w in range(self.rules.words):
            for side in range(2):
                total += count(state[P + side, w]) - count(state[T + side, w])
        return total

    def _probe(self, state, side, v):
        """Propagate v as a satisfied node of ``side`` on a copy of ``state``; return whether that is possible.

        The margins of ``state`` are kept.
        """
        self.counters[PROBES] += 1
        copy_state(self.scratch, state)
        assume(self.scratch, SATISFIED, side, v, True)
        kept = self.rules.margin
        self.rules.margin = self.scratch_margin
        left = self.rules.propagate(self.scratch)
        self.rules.margin = kept
        return left >= 0

    def _look_ahead(self, state):
        """Try a few nodes as satisfied ones of the side with fewer candidates; set side and node to branch on.

        A node that cannot be satisfied there is a failed literal: a branch whose true child closes at once. Of the
        others the one that settles most is branched on. side is -1 when the state became contradictory and 2 when no
        node is left in both sets.
        """
        chosen = self.chosen
        while True:
            surplus = 0
            for w in range(self.rules.words):
                surplus += count(state[P, w]) - count(state[P + 1, w])
            # On a tie the second side: a root has begun the first one.
            side = 1 if surplus >= 0 else 0
            found = most_promising(self.rules.hears, self.rules.margin, state, P, T, side, self.value, chosen)
            if found == 0:
                self.side, self.node = 2, -1
                return
            most, node = -1, -1
            for a in range(found):
                v = chosen[a]
                if not state[P, v >> 6] & state[P + 1, v >> 6] & bit_of(v):
                    continue  # a failed literal has settled it
                start = self.rules.place
                if start >= 0:
                    place = varint(self.rules.buffer, start, BRANCH + 2 * SATISFIED + side)
                    self.rules.place = varint(self.rules.buffer, place, v)
                if not self._probe(state, side, v):
                    self.counters[FAILED] += 1
                    assume(state, SATISFIED, side, v, False)
                    if self.rules.propagate(state) < 0:
                        self.side, self.node = -1, -1
                        return
                    continue
                self.rules.place = start
                settled = self._weight(state) - self._weight(self.scratch)
                if settled > most:
                    most, node = settled, v
            if node >= 0 and state[P, node >> 6] & state[P + 1, node >> 6] & bit_of(node):
                self.side, self.node = side, node
                return

    def _highest_need(self, state, both):
        """Return the node with the greatest need among those that may be satisfied on side 1 (on both sides), or -1."""
        need, chosen = self.rules.need, -1
        for w in range(self.rules.words):
            rest = state[P, w] & state[P + 1, w] if both else state[P, w]
            while rest:
                v = (w << 6) + first(rest)
                rest &= rest - 1
                if chosen < 0 or need[v] > need[chosen]:
                    chosen = v
        return chosen

    def _choose(self, state, symmetric):
        """Choose the literal to branch on; return its kind, or why there is none."""
        if symmetric:
            self.side, self.node = 0, self._highest_need(state, False)
            if self.node >= 0:
                return SATISFIED
        elif self._harvest(state):
            return _PAIR
        elif self.look_ahead:
            self._look_ahead(state)
            if self.side < 0:
                return _CONTRADICTION
        else:
            self.side, self.node = 0, self._highest_need(state, True)
        if self.node >= 0:
            return SATISFIED
        if self._harvest(state):
            return _PAIR
        self._undetermined(state)
        return MEMBER if self.side >= 0 else _NOTHING

    def _search(self, quota, room):
        table, counters = self.table, self.counters
        while self.level >= 0:
            level = self.level
            if self.rules.place >= 0 and self.rules.place > room:
                return FLUSH
            if level + 2 > self.stack.shape[0]:
                return GROW
            if table[level, GIVEN]:
                return DONATED
            if quota <= 0:
                return PAUSED
            quota -= 1
            counters[NODES] += 1
            state = self.stack[level]
            table[level, PENDING] = 0
            if self.rules.propagate(state) < 0:
                self.level -= 1
                continue
            symmetric = table[level, SYMMETRIC]
            kind = self._choose(state, symmetric)
            if kind == _CONTRADICTION:
                self.level -= 1
                continue
            if kind == _PAIR:
                return FOUND
            if kind == _NOTHING:
                return STUCK
            child = self.stack[level + 1]
            copy_state(child, state)
            assume(child, kind, self.side, self.node, True)
            assume(state, kind, self.side, self.node, False)
            if symmetric:
                assume(state, kind, 1 - self.side, self.node, False)
            if self.rules.place >= 0:
                opcode = ROOT if symmetric else BRANCH + 2 * kind + self.side
                place = varint(self.rules.buffer, self.rules.place, opcode)
                self.rules.place = varint(self.rules.buffer, place, self.node)
            table[level, PENDING] = 1
            self.level = level + 1
            table[level + 1, PENDING], table[level + 1, SYMMETRIC], table[level + 1, GIVEN] = 1, 0, 0
        return CLOSED

    def run(self, quota):
        """Search for at most ``quota`` nodes; return why it stopped.

        CLOSED: every level is refuted. FOUND: ``pair`` violates. PAUSED: the quota is spent. FLUSH: the transcript is
        to be taken out of the buffer. GROW: the stack is to be made longer. DONATED: the level was given away.
        """
        room = self.rules.buffer.shape[0] - 32 * self.rules.n * self.rules.n - 4096
        granted = quota
        with cython.nogil:
            why = self._search(granted, room)
        return why


# What _choose may return besides a kind of literal.
_PAIR, _NOTHING, _CONTRADICTION = 10, 11, 12


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
