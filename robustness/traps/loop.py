"""The resumable depth-first search over the states of :mod:`robustness.traps.kernel`.

``search`` works on an explicit stack, so that it can stop after a number of nodes and go on as if nothing had happened:
that is how time limits and Ctrl-C reach it.

A *symmetric* level holds the same sets on both sides. There a root v is chosen without loss of generality as a normal
node of side 1; when that is refuted, v is normal on neither side (it may still be malicious).

M is never enumerated. *Lazily*, it is first settled who can be normal where under the most favourable M that the bound
allows; a node is drawn (malicious or not) when a node of T cannot do without, or when no node can be normal on both
sides any more. *Eagerly*, what the nodes of T hear is drawn first. The first is better where few nodes are tight (dense
graphs), the second on sparse graphs; nobody knows before, so :mod:`robustness.traps.searching` runs both in
turns.
"""

from __future__ import annotations

import numpy as np

from robustness.decision.algorithms.words import ONE, ZERO, bit_of, count, first, jit, out_of_line
from robustness.traps.kernel import (
    MALICIOUS,
    NORMAL,
    ROWS,
    F,
    P,
    Q,
    T,
    Z,
    assume,
    copy_state,
    lack,
    propagate,
    sure,
)

__all__ = ["CLOSED", "FOUND", "GROW", "NODES", "PAUSED", "PROBES", "search"]

# Why ``search`` returned.
CLOSED, FOUND, PAUSED, GROW, STUCK = range(5)

# Counters.
NODES, FAILED, PROBES = 0, 1, 2


@jit
def _held_core(hears, need, candidates, malicious):  # type: ignore[no-untyped-def]
    """Shrink ``candidates`` to the largest set whose every node hears ``need`` of it and ``malicious``; is it nonempty?

    Such sets are closed under union, so there is one largest, whatever the order of removal.
    """
    out_of_line()
    words = candidates.shape[0]
    while True:
        changed, some = False, False
        for w in range(words):
            rest = candidates[w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                inside = 0
                for x in range(words):
                    inside += count(hears[i, x] & (candidates[x] | malicious[x]))
                if inside < need[i]:
                    candidates[w] &= ~bit_of(i)
                    changed = True
            some |= candidates[w] != ZERO
        if not changed:
            return some


@jit
def _harvest(state, hears, need, two_faces, found):  # type: ignore[no-untyped-def]
    """Try to read a solution off the state with M = Z: the largest held set of one side, then of what remains.

    At a fixpoint of the rules Z obeys its bound. ``found`` (4, words) receives the malicious nodes inside side 1 and
    inside side 2, N1 and N2.
    """
    out_of_line()
    words = state.shape[1]
    for side in range(2):
        other = 1 - side
        for w in range(words):
            free = ZERO if two_faces else state[Z, w] & ~state[F, w] & ~state[F + 1, w]
            found[side, w] = state[Z, w] & state[F + side, w] | free
            found[other, w] = state[Z, w] & state[F + other, w]
            found[2 + side, w] = state[P + side, w]
        if not _held_core(hears, need, found[2 + side], found[side]):
            continue
        for w in range(words):
            found[2 + other, w] = state[P + other, w] & ~found[2 + side, w]
        if _held_core(hears, need, found[2 + other], found[other]):
            return True
    return False


@jit
def _wanted(state, hears, need):  # type: ignore[no-untyped-def]
    """Return (side, node): a possibly malicious node that most unheld nodes of one side hear, or (-1, -1)."""
    out_of_line()
    n, words = hears.shape
    most, best_side, best = 0, np.int64(-1), np.int64(-1)
    votes = np.zeros(n, np.int64)
    for side in range(2):
        for v in range(votes.shape[0]):
            votes[v] = 0
        for w in range(words):
            rest = state[P + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                inside = 0
                for x in range(words):
                    inside += count(hears[i, x] & (state[P + side, x] | state[Z, x] & state[F + side, x]))
                if inside >= need[i]:
                    continue
                vote = 64 if state[T + side, w] & bit_of(i) else 1
                for x in range(words):
                    open_ = hears[i, x] & state[Q + side, x] & ~(state[Z, x] & state[F + side, x])
                    while open_:
                        votes[(x << 6) + first(open_)] += vote
                        open_ &= open_ - ONE
        for v in range(n):
            if votes[v] > most:
                most, best_side, best = votes[v], np.int64(side), np.int64(v)
    return best_side, best


@jit
def _pressing(state, hears, need, eager, votes):  # type: ignore[no-untyped-def]
    """Return (side, node): the possibly malicious node heard by most nodes of T, or (-1, -1).

    Lazily, only nodes of T count that cannot do without a further malicious one.
    """
    out_of_line()
    words = state.shape[1]
    most, best_side, best = 0, np.int64(-1), np.int64(-1)
    for side in range(2):
        for v in range(votes.shape[0]):
            votes[v] = 0
        for w in range(words):
            rest = state[T + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                if not eager and lack(state, hears, need, side, i) == 0:
                    continue
                for x in range(words):
                    open_ = hears[i, x] & state[Q + side, x] & ~state[Z, x]
                    if not eager:
                        open_ &= ~sure(state, side, x)
                    while open_:
                        votes[(x << 6) + first(open_)] += 1
                        open_ &= open_ - ONE
        for v in range(votes.shape[0]):
            if votes[v] > most:
                most, best_side, best = votes[v], np.int64(side), np.int64(v)
    return best_side, best


@jit
def _any_open(state):  # type: ignore[no-untyped-def]
    """Return (side, node) of any node that may be malicious on a side but is not settled there, or (-1, -1)."""
    for side in range(2):
        for w in range(state.shape[1]):
            rest = state[Q + side, w] & ~(state[Z, w] & state[F + side, w])
            if rest:
                return np.int64(side), (w << 6) + first(rest)
    return np.int64(-1), np.int64(-1)


@jit
def _weight(state):  # type: ignore[no-untyped-def]
    """Return how much is still open: possible normal places that are not taken."""
    total = 0
    for w in range(state.shape[1]):
        for side in range(2):
            total += count(state[P + side, w]) - count(state[T + side, w])
    return total


@jit
def _look_ahead(  # type: ignore[no-untyped-def]  # noqa: C901 - compiled: calls cost
    state, hears, need, f, two_faces, local, counting, scratch, shrink, counters
):
    """Try every node that may still be normal on either side; return (side, node) to branch on.

    side is -1 when the state became contradictory and 2 when no node is left in both. The score of a node is the
    product of what its two positive literals settle.
    """
    out_of_line()
    words = state.shape[1]
    while True:
        weight, some, failed = _weight(state), False, False
        for w in range(words):
            rest = state[P, w] & state[P + 1, w]
            while rest:
                v = (w << 6) + first(rest)
                rest &= rest - ONE
                some = True
                for side in range(2):
                    counters[PROBES] += 1
                    copy_state(scratch, state)
                    assume(scratch, NORMAL, side, v, 1, two_faces)
                    if not propagate(scratch, hears, need, f, two_faces, local, counting):
                        counters[FAILED] += 1
                        failed = True
                        assume(state, NORMAL, side, v, 0, two_faces)
                        if not propagate(state, hears, need, f, two_faces, local, counting):
                            return np.int64(-1), np.int64(-1)
                        weight = _weight(state)
                        shrink[0, v] = -1
                        rest &= state[P, w] & state[P + 1, w]
                        break
                    shrink[side, v] = weight - _weight(scratch)
        if not some:
            return np.int64(2), np.int64(-1)
        best, chosen = np.int64(-1), np.int64(-1)
        for w in range(words):
            rest = state[P, w] & state[P + 1, w]
            while rest:
                v = (w << 6) + first(rest)
                rest &= rest - ONE
                score = (2 * shrink[0, v] + 1) * (2 * shrink[1, v] + 1)
                if shrink[0, v] >= 0 and score > best:
                    best, chosen = score, v
        if chosen >= 0:
            return np.int64(0 if shrink[0, chosen] > shrink[1, chosen] else 1), chosen
        if not failed:
            return np.int64(2), np.int64(-1)


@jit
def _highest_need(state, need):  # type: ignore[no-untyped-def]
    """Return the node with the greatest need among those that may be normal on both sides, or -1."""
    chosen = np.int64(-1)
    for w in range(state.shape[1]):
        rest = state[P, w] & state[P + 1, w]
        while rest:
            v = (w << 6) + first(rest)
            rest &= rest - ONE
            if chosen < 0 or need[v] > need[chosen]:
                chosen = v
    return chosen


@jit
def _next_root(state, hears, need):  # type: ignore[no-untyped-def]
    """Return the node that may be normal on side 1 and has fewest in-neighbours inside to spare; ties: most needed.

    Refuted roots are inside no more, so the next root is among those that hear them: soon some can be held by nobody
    and are peeled. -1 when no node is left.
    """
    out_of_line()
    words = state.shape[1]
    chosen, least = np.int64(-1), np.int64(0)
    for w in range(words):
        rest = state[P, w]
        while rest:
            v = (w << 6) + first(rest)
            rest &= rest - ONE
            spare = -need[v]
            for x in range(words):
                spare += count(hears[v, x] & sure(state, 0, x))
            if chosen < 0 or spare < least or (spare == least and need[v] > need[chosen]):
                chosen, least = v, spare
    return chosen


@jit
def search(  # type: ignore[no-untyped-def]  # noqa: C901 - compiled: calls cost
    stack, symmetric, level, hears, need, f, two_faces, local, counting, look_ahead, eager, quota, counters, found
):
    """Run the search for at most ``quota`` nodes; return (why it stopped, level).

    Parameters: ``stack`` (levels, 9, words) states; ``symmetric`` (levels,) flags; ``level`` the current one; ``hears``
    (n, words) in-neighbour masks; ``need`` (n,) k_i; ``counting`` and ``look_ahead`` switch rules; ``eager`` says
    when M is drawn; ``found`` (4, words) receives the solution when FOUND.
    """
    n, words = hears.shape
    scratch = np.empty((ROWS, words), np.uint64)
    shrink = np.zeros((2, n), np.int64)
    votes = np.zeros(n, np.int64)
    while level >= 0:
        if level + 2 > stack.shape[0]:
            return GROW, level
        if quota <= 0:
            return PAUSED, level
        quota -= 1
        counters[NODES] += 1
        state = stack[level]
        if not propagate(state, hears, need, f, two_faces, local, counting):
            level -= 1
            continue
        kind, side, node = NORMAL, np.int64(0), np.int64(-1)
        if symmetric[level]:
            node = _next_root(state, hears, need)
        else:
            if _harvest(state, hears, need, two_faces, found):
                return FOUND, level
            if look_ahead:
                side, node = _pressing(state, hears, need, eager, votes)
                kind = MALICIOUS
            if node < 0 and look_ahead:
                kind = NORMAL
                side, node = _look_ahead(
                    state, hears, need, f, two_faces, local, counting, scratch, shrink, counters
                )
                if side < 0:
                    level -= 1
                    continue
            elif not look_ahead:
                node = _highest_need(state, need)
            if node < 0:
                if _harvest(state, hears, need, two_faces, found):
                    return FOUND, level
                kind = MALICIOUS
                side, node = _wanted(state, hears, need)
                if side < 0:
                    side, node = _any_open(state)
                if side < 0:
                    return STUCK, level
        copy_state(stack[level + 1], state)
        assume(stack[level + 1], kind, side, node, 1, two_faces)
        assume(state, kind, side, node, 0, two_faces)
        if symmetric[level]:
            assume(state, kind, 1 - side, node, 0, two_faces)
        level += 1
        symmetric[level] = 0
    return CLOSED, level
