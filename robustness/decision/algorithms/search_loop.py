"""The resumable depth-first search over the states of :mod:`robustness.decision.algorithms.search_kernel`.

``search`` works on an explicit stack of subproblems, so that it can stop after a number of nodes, hand a pending
subproblem to another thread, or flush its transcript, and go on as if nothing had happened.

A level of the stack is *pending* while its state has not been propagated: the false child of a branch, or a fresh
cube. A *symmetric* level holds the same sets on both sides, so that a root v may be chosen without loss of
generality as a satisfied node of S1, and is satisfied in neither set when that is refuted. A pending level whose
subproblem was *given* away is skipped when the search comes back to it.
"""

from __future__ import annotations

import numpy as np

from robustness.decision.algorithms.search_kernel import (
    BRANCH,
    MEMBER,
    ROOT,
    SATISFIED,
    C,
    F,
    P,
    T,
    assume,
    copy_state,
    core,
    propagate,
    varint,
)
from robustness.decision.algorithms.words import ONE, bit_of, count, first, jit

__all__ = ["CLOSED", "DONATED", "FLUSH", "FOUND", "GIVEN", "GROW", "PAUSED", "PENDING", "SYMMETRIC", "search"]

# Why ``search`` returned.
CLOSED, FOUND, PAUSED, FLUSH, GROW, DONATED, STUCK = range(7)

# Columns of the table of levels.
PENDING, SYMMETRIC, GIVEN = 0, 1, 2

# Counters.
NODES, FAILED, PROBES = 0, 1, 2

#: Look-ahead tries this many nodes on one side. Trying all on both costs more than it saves: see docs/adr/0002.
_TRIED = 8


@jit
def _harvest(width, state, hears, need, pair):  # type: ignore[no-untyped-def]
    """Try to read a violating pair off the state: all of a side that stands alone, the rest for the other."""
    words = len(width)
    nobody = np.zeros(words, np.uint64)
    for side in range(2):
        other = 1 - side
        for w in range(words):
            pair[side, w] = state[P + side, w]
            nobody[w] = state[F + side, w] & ~state[P + side, w]
        if not core(width, hears, need, pair[side], nobody):
            continue
        for w in range(words):
            pair[other, w] = state[P + other, w] & ~pair[side, w]
            pair[side, w] |= nobody[w]
            nobody[w] = state[F + other, w] & ~state[P + other, w]
        if core(width, hears, need, pair[other], nobody):
            for w in range(words):
                pair[other, w] |= nobody[w]
            return True
    return False


@jit
def _undetermined(width, state, hears, need):  # type: ignore[no-untyped-def]
    """Return (side, node) of a node whose membership an unsatisfied candidate still depends on, or (-1, -1)."""
    words = len(width)
    for side in range(2):
        for w in range(words):
            rest = state[P + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                inside = 0
                for x in range(words):
                    inside += count(hears[i, x] & (state[P + side, x] | state[F + side, x]))
                if inside >= need[i]:
                    continue
                for x in range(words):
                    open_ = hears[i, x] & state[C + side, x] & ~(state[P + side, x] | state[F + side, x])
                    if open_:
                        return np.int64(side), (x << 6) + first(open_)
    return np.int64(-1), np.int64(-1)


@jit
def _weight(width, state):  # type: ignore[no-untyped-def]
    total = 0
    for w in range(len(width)):
        for side in range(2):
            total += count(state[P + side, w]) - count(state[T + side, w])
    return total


@jit
def _most_promising(width, state, hears, margin, side, value, chosen):  # type: ignore[no-untyped-def]
    """Fill ``chosen`` with the nodes that look-ahead tries on ``side``, best first; return how many there are.

    Of the nodes that may be satisfied on either side these are nearest to being excluded from this one and hear most
    satisfied nodes. Ties go to the lower id.
    """
    words = len(width)
    found = 0
    for w in range(words):
        rest = state[P, w] & state[P + 1, w]
        while rest:
            v = (w << 6) + first(rest)
            rest &= rest - ONE
            worth = -4 * margin[side, v]
            for x in range(words):
                worth += count(hears[v, x] & (state[T, x] | state[T + 1, x]))
            place = found
            if found < len(chosen):
                found += 1
            elif worth <= value[found - 1]:
                continue
            else:
                place -= 1
            while place > 0 and value[place - 1] < worth:
                value[place] = value[place - 1]
                chosen[place] = chosen[place - 1]
                place -= 1
            value[place] = worth
            chosen[place] = v
    return found


@jit
def _look_ahead(  # type: ignore[no-untyped-def]
    width, state, hears, need, spare, blockers, reach, margin, scratch, scratch_margin, counters, buffer, place
):
    """Try a few nodes as satisfied ones of the side with fewer candidates; return (side, node, place) to branch on.

    A node that cannot be satisfied there is a failed literal: a branch whose true child closes at once. Of the others
    the one that settles most is branched on. side is -1 when the state became contradictory and 2 when no node is left
    in both sets.
    """
    value = np.empty(_TRIED, np.int64)
    chosen = np.empty(_TRIED, np.int64)
    while True:
        surplus = np.int64(0)
        for w in range(len(width)):
            surplus += count(state[P, w]) - count(state[P + 1, w])
        # On a tie the second side: a root has begun the first one.
        side = np.int64(surplus >= 0)
        found = _most_promising(width, state, hears, margin, side, value, chosen)
        if found == 0:
            return np.int64(2), np.int64(-1), place
        most, node = np.int64(-1), np.int64(-1)
        for a in range(found):
            v = chosen[a]
            if not state[P, v >> 6] & state[P + 1, v >> 6] & bit_of(v):
                continue  # a failed literal has settled it
            counters[PROBES] += 1
            copy_state(width, scratch, state)
            assume(scratch, SATISFIED, side, v, True)
            start = place
            if place >= 0:
                start = varint(buffer, varint(buffer, place, BRANCH + 2 * SATISFIED + side), v)
            left, end = propagate(width, scratch, hears, need, spare, blockers, reach, scratch_margin, buffer, start)
            if left < 0:
                counters[FAILED] += 1
                assume(state, SATISFIED, side, v, False)
                left, place = propagate(width, state, hears, need, spare, blockers, reach, margin, buffer, end)
                if left < 0:
                    return np.int64(-1), np.int64(-1), place
                continue
            settled = _weight(width, state) - _weight(width, scratch)
            if settled > most:
                most, node = settled, v
        if node >= 0 and state[P, node >> 6] & state[P + 1, node >> 6] & bit_of(node):
            return side, node, place


@jit
def _highest_need(width, state, need, both):  # type: ignore[no-untyped-def]
    """Return the node with the greatest need among those that may be satisfied on side 1 (on both sides), or -1."""
    chosen = np.int64(-1)
    for w in range(len(width)):
        rest = state[P, w] & state[P + 1, w] if both else state[P, w]
        while rest:
            v = (w << 6) + first(rest)
            rest &= rest - ONE
            if chosen < 0 or need[v] > need[chosen]:
                chosen = v
    return chosen


@jit
def search(  # type: ignore[no-untyped-def]
    width, stack, table, level, hears, need, spare, blockers, look_ahead, quota, counters, pair, buffer, place
):
    """Run the search for at most ``quota`` nodes; return (why it stopped, level, place).

    Parameters: ``width`` is as long as a node set has words (see ``subset_search``);
    ``stack`` (levels, 8, words) states; ``table`` (levels, 3); ``level`` the current one; ``hears``
    (n, words) masks; ``need`` (n,) k_i; ``spare`` s - 1; ``blockers`` 0, 1 or 2; ``look_ahead`` 0 or 1;
    ``pair`` (2, words) receives S1 and S2 when FOUND; ``buffer`` takes the transcript from ``place`` on, not at -1.
    """
    n, words = hears.shape[0], len(width)
    reach = np.empty((n, words + 2), np.uint64)
    scratch = np.empty((8, words), np.uint64)
    margin = np.zeros((2, n), np.int64)
    scratch_margin = np.zeros((2, n), np.int64)
    room = buffer.shape[0] - 32 * n * n - 4096
    while level >= 0:
        if place >= 0 and place > room:
            return FLUSH, level, place
        if level + 2 > stack.shape[0]:
            return GROW, level, place
        if table[level, GIVEN]:
            return DONATED, level, place
        if quota <= 0:
            return PAUSED, level, place
        quota -= 1
        counters[NODES] += 1
        state = stack[level]
        table[level, PENDING] = 0
        left, place = propagate(width, state, hears, need, spare, blockers, reach, margin, buffer, place)
        if left < 0:
            level -= 1
            continue
        kind, side, node = SATISFIED, np.int64(0), np.int64(-1)
        if table[level, SYMMETRIC]:
            node = _highest_need(width, state, need, False)
        else:
            if _harvest(width, state, hears, need, pair):
                return FOUND, level, place
            if look_ahead:
                side, node, place = _look_ahead(
                    width,
                    state,
                    hears,
                    need,
                    spare,
                    blockers,
                    reach,
                    margin,
                    scratch,
                    scratch_margin,
                    counters,
                    buffer,
                    place,
                )
                if side < 0:
                    level -= 1
                    continue
            else:
                node = _highest_need(width, state, need, True)
            if node < 0:
                if _harvest(width, state, hears, need, pair):
                    return FOUND, level, place
                kind = MEMBER
                side, node = _undetermined(width, state, hears, need)
                if side < 0:
                    return STUCK, level, place
        child = stack[level + 1]
        copy_state(width, child, state)
        assume(child, kind, side, node, True)
        assume(state, kind, side, node, False)
        if table[level, SYMMETRIC]:
            assume(state, kind, 1 - side, node, False)
        if place >= 0:
            place = varint(buffer, place, ROOT if table[level, SYMMETRIC] else BRANCH + 2 * kind + side)
            place = varint(buffer, place, node)
        table[level, PENDING] = 1
        level += 1
        table[level, PENDING], table[level, SYMMETRIC], table[level, GIVEN] = 1, 0, 0
    return CLOSED, level, place
