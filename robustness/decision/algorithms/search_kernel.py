"""The compiled heart of ``subset-search``: one state and its propagation rules.

State
-----
The search looks for a violating pair (S1, S2) of (r,s)-robustness. With ``k_i = d_i - r + 1``, node i of S_k is
*satisfied* when at least ``k_i`` of its in-neighbours lie in S_k (equivalently ``i not in X_Sk``), else *exempt*.
A pair violates (r,s) exactly when both sides hold a satisfied node and at most ``s - 1`` nodes are exempt. A state is
eight node sets, four a side, as rows of 64-bit words:

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

Everything here releases the GIL. The loop that drives it is in :mod:`robustness.decision.algorithms.search_loop`.
"""

from __future__ import annotations

import numpy as np

from robustness.decision.algorithms.words import ONE, ZERO, bit_of, count, first, jit, out_of_line

__all__ = [
    "BRANCH",
    "EXCLUDE",
    "MEMBER",
    "PROPAGATE",
    "ROOT",
    "SATISFIED",
    "C",
    "F",
    "P",
    "T",
    "assume",
    "copy_state",
    "core",
    "propagate",
    "varint",
]

# Rows of a state.
C, P, F, T = 0, 2, 4, 6

# Transcript opcodes; EXCLUDE + 2 * (blockers - 1) + side, BRANCH + 2 * kind + side. See docs/certificate-format.md.
PROPAGATE, ROOT, BRANCH, EXCLUDE = 0, 1, 2, 6
SATISFIED, MEMBER = 0, 1

# Counters.
NODES, FAILED, PROBES = 0, 1, 2



@jit
def copy_state(width, target, source):  # type: ignore[no-untyped-def]
    """Copy a state; element by element, which compiles ten times faster than a slice assignment."""
    for row in range(8):
        for w in range(len(width)):
            target[row, w] = source[row, w]


@jit
def varint(buffer, place, value):  # type: ignore[no-untyped-def]
    """Write a number, seven bits a byte, low first; return the place behind it."""
    while value >= 128:
        buffer[place] = np.uint8(value & 127 | 128)
        place += 1
        value >>= 7
    buffer[place] = np.uint8(value)
    return place + 1


@jit
def core(width, hears, need, candidates, support):  # type: ignore[no-untyped-def]
    """Shrink ``candidates`` to its largest subset K with ``|N_i & (K | support)| >= need_i`` on K.

    Return whether K is nonempty. Such subsets are closed under union, so there is one largest, whatever the order.
    """
    out_of_line()
    words = len(width)
    while True:
        changed, some = False, False
        for w in range(words):
            rest = candidates[w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                inside = 0
                for x in range(words):
                    inside += count(hears[i, x] & (candidates[x] | support[x]))
                if inside < need[i]:
                    candidates[w] &= ~bit_of(i)
                    changed = True
            some |= candidates[w] != ZERO
        if not changed:
            return some


@jit
def _least_spare(width, state, hears, need, left, side, trial):  # type: ignore[no-untyped-def]
    """Return the least t for which t exemptions may let T and anybody at all be satisfied, or left + 1."""
    out_of_line()
    words = len(width)
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
                    rest &= rest - ONE
                    inside, extra = 0, 0
                    for x in range(words):
                        sure = trial[x] | state[F + side, x]
                        inside += count(hears[i, x] & sure)
                        extra += count(hears[i, x] & state[C + side, x] & ~sure)
                    if inside + min(t, extra) < need[i]:
                        trial[w] &= ~bit_of(i)
                        changed = True
        some, all_kept = False, True
        for w in range(words):
            some |= trial[w] != ZERO
            all_kept &= state[T + side, w] & ~trial[w] == ZERO
        if some and all_kept:
            return t
    return left + 1


@jit
def _settle(width, state, hears, need, spare, allowed):  # type: ignore[no-untyped-def]
    """Apply *disjoint*, *peel*, *force* and *share* until nothing changes.

    Return the exemptions left, or -1 on contradiction; ``allowed[k]`` receives how many of them side k can use.
    """
    out_of_line()
    words = len(width)
    allowed[:] = spare
    while True:
        left = spare
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
                    rest &= rest - ONE
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
                some |= state[P + side, w] != ZERO
            if not some:
                return -1
        if changed:
            continue
        if left:
            trial = np.empty(words, np.uint64)
            for side in range(2):
                fair = left - _least_spare(width, state, hears, need, left, 1 - side, trial)
                if fair < 0:
                    return -1
                if fair < min(allowed[side], left):
                    allowed[side] = fair
                    changed = True
        if not changed:
            allowed[0] = min(allowed[0], left)
            allowed[1] = min(allowed[1], left)
            return left


@jit
def _exclude(  # type: ignore[no-untyped-def]
    width, state, hears, need, left, allowed, side, blockers, reach, margin, buffer, place
):
    """Apply *count* once to every candidate of the other side; return (exclusions or -1 on contradiction, place).

    ``margin[k, j]`` receives how far j is from being excluded from side k.
    """
    out_of_line()
    words, other = len(width), 1 - side
    most = 0
    for w in range(words):
        rest = state[T + side, w]
        while rest:
            i = (w << 6) + first(rest)
            rest &= rest - ONE
            slack = -need[i]
            for x in range(words):
                reach[most, x] = hears[i, x] & (state[P + side, x] | state[F + side, x])
                slack = slack + count(reach[most, x])
            reach[most, words] = np.uint64(slack)
            reach[most, words + 1] = np.uint64(i)
            most += 1
    found = 0
    for w in range(words):
        rest = state[P + other, w]
        while rest:
            j = (w << 6) + first(rest)
            rest &= rest - ONE
            bit = bit_of(j)
            have, gain, next_gain, one = left, np.int64(0), np.int64(0), -1
            for x in range(words):
                have += count(hears[j, x] & (state[P + other, x] | state[F + other, x]))
            for a in range(most):
                value = 0 - np.int64(reach[a, words])
                if reach[a, w] & bit:
                    value += 1
                for x in range(words):
                    value += count(hears[j, x] & (state[P + other, x] | state[F + other, x]) & reach[a, x])
                if value > gain:
                    next_gain, gain, one = gain, value, a
                elif value > next_gain:
                    next_gain = value
            have -= gain
            margin[other, j] = have - need[j]
            if one < 0:
                continue
            two = -1
            if have >= need[j]:
                # Beside another, no blocker gains more than it does alone, and it costs what exemptions allow.
                if blockers < 2 or have - next_gain + allowed[side] >= need[j]:
                    continue
                gain = np.int64(0)
                for a in range(most):
                    if a == one:
                        continue
                    value = -np.int64(reach[a, words]) - allowed[side]
                    if reach[a, w] & bit:
                        value += 1
                    for x in range(words):
                        value += count(
                            hears[j, x]
                            & (state[P + other, x] | state[F + other, x])
                            & ~reach[one, x]
                            & reach[a, x]
                        )
                    if value > gain:
                        gain, two = value, a
                margin[other, j] = have - gain - need[j]
                if two < 0 or have - gain >= need[j]:
                    continue
            if place >= 0:
                place = varint(buffer, place, EXCLUDE + other + (2 if two >= 0 else 0))
                place = varint(buffer, place, j)
                place = varint(buffer, place, np.int64(reach[one, words + 1]))
                if two >= 0:
                    place = varint(buffer, place, np.int64(reach[two, words + 1]))
            if state[T + other, w] & bit:
                return -1, place
            state[P + other, w] &= ~bit
            found += 1
    return found, place


@jit
def propagate(width, state, hears, need, spare, blockers, reach, margin, buffer, place):  # type: ignore[no-untyped-def]
    """Apply all rules until nothing changes; return (exemptions left or -1 on contradiction, place in the transcript).

    ``margin`` (2, n) receives how far every candidate of either side is from being excluded by *count*. With
    ``place >= 0`` every exclusion is written to ``buffer``: EXCLUDE steps, PROPAGATE, EXCLUDE steps, and so on.
    """
    out_of_line()
    allowed = np.empty(2, np.int64)
    while True:
        left = _settle(width, state, hears, need, spare, allowed)
        if left < 0 or blockers == 0:
            return left, place
        excluded = 0
        for side in range(2):
            found, place = _exclude(
                width, state, hears, need, left, allowed, side, blockers, reach, margin, buffer, place
            )
            if found < 0:
                return np.int64(-1), place
            excluded += found
        if excluded == 0:
            return left, place
        if place >= 0:
            place = varint(buffer, place, PROPAGATE)


@jit
def assume(state, kind, side, node, true):  # type: ignore[no-untyped-def]
    """Make the literal (kind, side, node) true or false in ``state``, before any propagation."""
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


@jit
def write_branch(buffer, place, kind, side, node):  # type: ignore[no-untyped-def]
    return varint(buffer, varint(buffer, place, BRANCH + 2 * kind + side), node)
