"""The resumable depth-first search over the states of :mod:`robustness.kernels.trap_rules`.

``TrapSearch.run`` works on an explicit stack, so that it can stop after a number of nodes and go on as if nothing had
happened: that is how time limits and Ctrl-C reach it.

A *symmetric* level holds the same sets on both sides. There a root v is chosen without loss of generality as a normal
node of side 1; when that is refuted, v is normal on neither side (it may still be malicious).

M is never enumerated. *Lazily*, it is first settled who can be normal where under the most favourable M that the bound
allows; a node is drawn (malicious or not) when a node of T has no place to spare, or when no node can be normal on both
sides any more. *Eagerly*, what the nodes of T hear is drawn first. The first is better where few nodes are tight (dense
graphs), the second on sparse graphs; nobody knows before, so :mod:`robustness.traps.searching` runs both in
turns.

Look-ahead tries a few nodes as normal ones of the side with fewer candidates. In a transcript a node that cannot be
normal there is a branch whose true child closes at once.
"""

from __future__ import annotations

import numpy as np

from robustness.kernels import layout

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.shared import copy_state, core, most_promising, varint
    from robustness.kernels.trap_rules import assume
    from robustness.kernels.words import bit_of, count, first

__all__ = ["TrapSearch"]

P, Q, F, T, Z = layout.TRAP_P, layout.TRAP_Q, layout.TRAP_F, layout.TRAP_T, layout.TRAP_Z
NORMAL, MALICIOUS = layout.NORMAL, layout.MALICIOUS
ROOT, BRANCH = layout.ROOT, layout.BRANCH
NODES, FAILED, PROBES = layout.NODES, layout.FAILED, layout.PROBES
CLOSED, FOUND, PAUSED, FLUSH = layout.CLOSED, layout.FOUND, layout.PAUSED, layout.FLUSH
GROW, STUCK, TRAPS_TRIED = layout.GROW, layout.STUCK, layout.TRAPS_TRIED


class TrapSearch:
    """A search under one strategy: its stack, its counters, and what it has found.

    Parameters
    ----------
    rules : TrapRules
        The question.
    look_ahead : bool
        Whether branching first tries a few nodes, and draws M where that presses.
    eager : bool
        When M is drawn.

    Attributes
    ----------
    stack : array of uint64, shape (levels, 9, words)
        States; the caller may replace it by a longer one.
    symmetric : array of int64, shape (levels,)
        Whether the two sides of a level are alike.
    level : int
        The level at work; -1 when all is refuted.
    counters : array of int64, shape (3,)
        NODES, FAILED, PROBES.
    found : array of uint64, shape (4, words)
        After FOUND: the malicious nodes inside side 1 and inside side 2, N1 and N2.
    state, scratch : arrays of uint64, shape (9, words)
        A level of the stack, as methods take it, and the copy that look-ahead tries a node on.
    scratch_margin : array of int64, shape (2, n)
        The margins of that copy.
    value, chosen : arrays of int64, shape (tried,)
        Which nodes look-ahead tries, see :func:`robustness.kernels.shared.most_promising`.
    votes : array of int64, shape (n,)
        How much drawing a node would settle.
    """

    def __init__(self, rules, look_ahead, eager):
        n, words = rules.n, rules.words
        self.rules, self.look_ahead, self.eager = rules, look_ahead, eager
        self.stack = np.zeros((64, layout.TRAP_ROWS, words), np.uint64)
        self.symmetric = np.zeros(64, np.int64)
        self.level = 0
        self.counters = np.zeros(3, np.int64)
        self.found = np.zeros((4, words), np.uint64)
        self.scratch = np.empty((layout.TRAP_ROWS, words), np.uint64)
        self.scratch_margin = np.zeros((2, n), np.int64)
        self.value = np.empty(TRAPS_TRIED, np.int64)
        self.chosen = np.empty(TRAPS_TRIED, np.int64)
        self.votes = np.zeros(n, np.int64)
        self.side, self.node = 0, -1

    def _harvest(self, state):
        """Try to read a solution off the state with M = Z: the largest satisfied set of one side, then of what remains.

        At a fixpoint of the rules Z obeys its bound. ``found`` (4, words) receives the malicious nodes inside side 1
        and inside side 2, N1 and N2.
        """
        words, found = self.rules.words, self.found
        for side in range(2):
            other = 1 - side
            for w in range(words):
                free = 0 if self.rules.two_faces else state[Z, w] & ~state[F, w] & ~state[F + 1, w]
                found[side, w] = state[Z, w] & state[F + side, w] | free
                found[other, w] = state[Z, w] & state[F + other, w]
                found[2 + side, w] = state[P + side, w]
            if not core(self.rules.hears, self.rules.need, found[2 + side], found[side]):
                continue
            for w in range(words):
                found[2 + other, w] = state[P + other, w] & ~found[2 + side, w]
            if core(self.rules.hears, self.rules.need, found[2 + other], found[other]):
                return True
        return False

    def _wanted(self, state):
        """Choose the possibly malicious node that most unsatisfied nodes of a side hear; without one the side is -1."""
        n, words, votes, most = self.rules.n, self.rules.words, self.votes, 0
        self.side, self.node = -1, -1
        for side in range(2):
            for v in range(self.rules.n):
                votes[v] = 0
            for w in range(words):
                rest = state[P + side, w]
                while rest:
                    i = (w << 6) + first(rest)
                    rest &= rest - 1
                    inside = 0
                    for x in range(words):
                        known = state[P + side, x] | state[Z, x] & state[F + side, x]
                        inside += count(self.rules.hears[i, x] & known)
                    if inside >= self.rules.need[i]:
                        continue
                    vote = 64 if state[T + side, w] & bit_of(i) else 1
                    for x in range(words):
                        open_ = self.rules.hears[i, x] & state[Q + side, x] & ~(state[Z, x] & state[F + side, x])
                        while open_:
                            votes[(x << 6) + first(open_)] += vote
                            open_ &= open_ - 1
            for v in range(n):
                if votes[v] > most:
                    most = votes[v]
                    self.side, self.node = side, v

    def _pressing(self, state):
        """Choose the possibly malicious node whose place matters most to the nodes of T; without one the side is -1.

        A node of T counts four times as much for each place that it has less to spare. Lazily, only those count that
        have nothing to spare, and only the places that nobody but a malicious node can take.
        """
        words, votes, most = self.rules.words, self.votes, 0
        self.side, self.node = -1, -1
        for side in range(2):
            for v in range(self.rules.n):
                votes[v] = 0
            for w in range(words):
                rest = state[T + side, w]
                while rest:
                    i = (w << 6) + first(rest)
                    rest &= rest - 1
                    lack = self.rules.lack(state, side, i)
                    if not self.eager and lack < 0:
                        continue
                    vote = 1 << 2 * max(0, lack + 3)
                    for x in range(words):
                        open_ = self.rules.hears[i, x] & state[Q + side, x] & ~state[Z, x]
                        if not self.eager:
                            open_ &= ~self.rules.sure(state, side, x)
                        while open_:
                            votes[(x << 6) + first(open_)] += vote
                            open_ &= open_ - 1
            for v in range(self.rules.n):
                if votes[v] > most:
                    most = votes[v]
                    self.side, self.node = side, v

    def _any_open(self, state):
        """Choose any node that may be malicious on a side but is not settled there; without one the side is -1."""
        for side in range(2):
            for w in range(self.rules.words):
                rest = state[Q + side, w] & ~(state[Z, w] & state[F + side, w])
                if rest:
                    self.side, self.node = side, (w << 6) + first(rest)
                    return
        self.side, self.node = -1, -1

    def _weight(self, state):
        """Return how much is still open: possible normal places that are not taken."""
        total = 0
        for w in range(self.rules.words):
            for side in range(2):
                total += count(state[P + side, w]) - count(state[T + side, w])
        return total

    def _probe(self, state, side, v):
        """Propagate v as a normal node of ``side`` on a copy of ``state``; return whether that is possible.

        The margins of ``state`` are kept.
        """
        self.counters[PROBES] += 1
        copy_state(self.scratch, state)
        assume(self.scratch, NORMAL, side, v, 1, self.rules.two_faces)
        kept = self.rules.margin
        self.rules.margin = self.scratch_margin
        possible = self.rules.propagate(self.scratch)
        self.rules.margin = kept
        return possible

    def _look_ahead(self, state):
        """Try a few nodes as normal ones of the side with fewer candidates; set side and node to branch on.

        A node that cannot be normal there is a failed literal: a branch whose true child closes at once. Of the others
        the one that settles most is branched on. side is -1 when the state became contradictory and 2 when no node is
        left in both.
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
                    place = varint(self.rules.buffer, start, BRANCH + 2 * NORMAL + side)
                    self.rules.place = varint(self.rules.buffer, place, v)
                if not self._probe(state, side, v):
                    self.counters[FAILED] += 1
                    assume(state, NORMAL, side, v, 0, self.rules.two_faces)
                    if not self.rules.propagate(state):
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

    def _highest_need(self, state):
        """Return the node with the greatest need among those that may be normal on both sides, or -1."""
        need, chosen = self.rules.need, -1
        for w in range(self.rules.words):
            rest = state[P, w] & state[P + 1, w]
            while rest:
                v = (w << 6) + first(rest)
                rest &= rest - 1
                if chosen < 0 or need[v] > need[chosen]:
                    chosen = v
        return chosen

    def _next_root(self, state):
        """Return the node that may be normal on side 1 and has fewest in-neighbours to spare; ties: most needed.

        Refuted roots are normal no more, so the next root is among those that hear them: soon some lack too much and
        are peeled. -1 when no node is left.
        """
        words, need = self.rules.words, self.rules.need
        chosen, least = -1, 0
        for w in range(words):
            rest = state[P, w]
            while rest:
                v = (w << 6) + first(rest)
                rest &= rest - 1
                spare = -need[v]
                for x in range(words):
                    spare += count(self.rules.hears[v, x] & self.rules.sure(state, 0, x))
                if chosen < 0 or spare < least or (spare == least and need[v] > need[chosen]):
                    chosen, least = v, spare
        return chosen

    def _choose(self, state, symmetric):
        """Choose the literal to branch on; return its kind, or why there is none."""
        if symmetric:
            self.side, self.node = 0, self._next_root(state)
        elif self._harvest(state):
            return _SOLVED
        elif self.look_ahead:
            self._pressing(state)
            if self.node >= 0:
                return MALICIOUS
            self._look_ahead(state)
            if self.side < 0:
                return _CONTRADICTION
        else:
            self.side, self.node = 0, self._highest_need(state)
        if self.node >= 0:
            return NORMAL
        if self._harvest(state):
            return _SOLVED
        self._wanted(state)
        if self.side < 0:
            self._any_open(state)
        return MALICIOUS if self.side >= 0 else _NOTHING

    def _search(self, quota, room):
        while self.level >= 0:
            level = self.level
            if self.rules.place >= 0 and self.rules.place > room:
                return FLUSH
            if level + 2 > self.stack.shape[0]:
                return GROW
            if quota <= 0:
                return PAUSED
            quota -= 1
            self.counters[NODES] += 1
            state = self.stack[level]
            if not self.rules.propagate(state):
                self.level -= 1
                continue
            symmetric = self.symmetric[level]
            kind = self._choose(state, symmetric)
            if kind == _CONTRADICTION:
                self.level -= 1
                continue
            if kind == _SOLVED:
                return FOUND
            if kind == _NOTHING:
                return STUCK
            child = self.stack[level + 1]
            copy_state(child, state)
            assume(child, kind, self.side, self.node, 1, self.rules.two_faces)
            assume(state, kind, self.side, self.node, 0, self.rules.two_faces)
            if symmetric:
                assume(state, kind, 1 - self.side, self.node, 0, self.rules.two_faces)
            if self.rules.place >= 0:
                opcode = ROOT if symmetric else BRANCH + 2 * kind + self.side
                place = varint(self.rules.buffer, self.rules.place, opcode)
                self.rules.place = varint(self.rules.buffer, place, self.node)
            self.level = level + 1
            self.symmetric[level + 1] = 0
        return CLOSED

    def run(self, quota):
        """Search for at most ``quota`` nodes; return why it stopped.

        CLOSED: every level is refuted. FOUND: ``found`` is a solution. PAUSED: the quota is spent. FLUSH: the
        transcript is to be taken out of the buffer. GROW: the stack is to be made longer.
        """
        room = self.rules.buffer.shape[0] - 32 * self.rules.n * self.rules.n - 4096
        granted = quota
        with cython.nogil:
            why = self._search(granted, room)
        return why


# What _choose may return besides a kind of literal.
_SOLVED, _NOTHING, _CONTRADICTION = 10, 11, 12

#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
