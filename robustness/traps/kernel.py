"""The compiled heart of the trap search: one state and its propagation rules.

What is looked for
------------------
Disjoint sets M, N1, N2 with N1, N2 nonempty. N_k are normal nodes that stay where they are; node i of N_k is *held*
when at least ``k_i = d_i - f`` of its in-neighbours are *inside* side k. Two kinds, by what a malicious node can do:

* two faces (a trap): every node of M is inside both sides;
* one face (a violation): every node of M is inside exactly one side.

Two bounds on M: *total*, ``|M| <= f``; *local*, every node outside M hears at most f nodes of M.

State
-----
Nine node sets as rows of 64-bit words; k is 1 or 2:

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
    most that further malicious nodes can add. This is pair counting of
    :mod:`robustness.decision.algorithms.search_kernel` with M on both sides at once

Everything here releases the GIL. The loop that drives it is in :mod:`robustness.traps.loop`.
"""

from __future__ import annotations

import numpy as np

from robustness.decision.algorithms.words import ONE, ZERO, bit_of, count, first, jit, out_of_line

__all__ = ["MALICIOUS", "NORMAL", "ROWS", "F", "P", "Q", "T", "Z", "assume", "copy_state", "lack", "propagate", "sure"]

# Rows of a state.
P, Q, F, T, Z = 0, 2, 4, 6, 8
ROWS = 9

# Kinds of literals.
NORMAL, MALICIOUS = 0, 1


@jit
def copy_state(target, source):  # type: ignore[no-untyped-def]
    """Copy a state; element by element, which compiles ten times faster than a slice assignment."""
    for row in range(ROWS):
        for w in range(source.shape[1]):
            target[row, w] = source[row, w]


@jit
def _roles(state, two_faces):  # type: ignore[no-untyped-def]
    """Apply *roles* to every word; return 0 for a contradiction, 2 when something changed, else 1."""
    out_of_line()
    changed = False
    for w in range(state.shape[1]):
        p1, p2, q1, q2 = state[P, w], state[P + 1, w], state[Q, w], state[Q + 1, w]
        f1, f2, t1, t2, z = state[F, w], state[F + 1, w], state[T, w], state[T + 1, w], state[Z, w]
        while True:
            f1 |= t1
            f2 |= t2
            q1 &= ~(t1 | t2)
            q2 &= ~(t1 | t2)
            if two_faces:
                z |= f1 & f2
            else:
                q1 &= ~f2
                q2 &= ~f1
            z |= f1 & ~p1 | f2 & ~p2
            p1 &= ~(z | f2)
            p2 &= ~(z | f1)
            if two_faces:
                f1 |= z
                f2 |= z
            else:
                f1 |= z & ~q2
                f2 |= z & ~q1
            t1 |= f1 & ~q1
            t2 |= f2 & ~q2
            if f1 & ~(p1 | q1) or f2 & ~(p2 | q2) or t1 & ~p1 or t2 & ~p2 or z & ~(q1 | q2):
                return 0
            if not two_faces and f1 & f2:
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


@jit
def sure(state, side, word):  # type: ignore[no-untyped-def]
    """Return a word of ``D_side``: who can be inside the side without a further malicious node."""
    return state[P + side, word] | state[F + side, word] | state[Z, word] & state[Q + side, word]


@jit
def _heard(hears, row, node):  # type: ignore[no-untyped-def]
    """Return how many nodes of ``row`` the node hears."""
    total = 0
    for x in range(row.shape[0]):
        total += count(hears[node, x] & row[x])
    return total


@jit
def _budget(state, hears, f, local):  # type: ignore[no-untyped-def]  # noqa: C901 - compiled: calls cost
    """Apply *budget*; return 0 for a contradiction, 2 when something changed, else 1."""
    out_of_line()
    n, words = hears.shape
    changed = False
    if not local:
        used = 0
        for w in range(words):
            used += count(state[Z, w])
        if used > f:
            return 0
        if used == f:
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
        used = _heard(hears, state[Z], i)
        if used < f:
            continue
        if (state[Q, w] | state[Q + 1, w]) & bit:
            if used > f:
                state[Z, w] |= bit
                changed = True
            continue
        if used > f:
            return 0
        for x in range(words):
            lost = hears[i, x] & ~state[Z, x]
            if (state[Q, x] | state[Q + 1, x]) & lost:
                state[Q, x] &= ~lost
                state[Q + 1, x] &= ~lost
                changed = True
    return 2 if changed else 1


@jit
def _left(state, hears, f, local, node):  # type: ignore[no-untyped-def]
    """Return how many further malicious nodes a normal node can hear."""
    if local:
        return f - _heard(hears, state[Z], node)
    used = 0
    for x in range(state.shape[1]):
        used += count(state[Z, x])
    return f - used


@jit
def _peel(state, hears, need, f, local, side):  # type: ignore[no-untyped-def]
    """Apply *peel* and *force* to one side; return 0 for a contradiction, 2 when something changed, else 1."""
    out_of_line()
    words = state.shape[1]
    changed, some = False, False
    for w in range(words):
        rest = state[P + side, w]
        while rest:
            i = (w << 6) + first(rest)
            rest &= rest - ONE
            bit = bit_of(i)
            inside, extra = 0, 0
            for x in range(words):
                known = sure(state, side, x)
                inside += count(hears[i, x] & known)
                extra += count(hears[i, x] & state[Q + side, x] & ~known)
            held = state[T + side, w] & bit
            if inside > need[i] or (inside == need[i] and not held):
                continue
            usable = min(_left(state, hears, f, local, i), extra)
            if inside + usable < need[i]:
                if held:
                    return 0
                state[P + side, w] &= ~bit
                changed = True
            elif inside + usable == need[i] and held:
                for x in range(words):
                    wanted = hears[i, x] & sure(state, side, x)
                    if usable == extra:
                        wanted |= hears[i, x] & state[Q + side, x]
                    if wanted & ~state[F + side, x]:
                        state[F + side, x] |= wanted
                        changed = True
        some |= state[P + side, w] != ZERO
    if not some:
        return 0
    return 2 if changed else 1


@jit
def _gain(local, two_faces, left_i, left_j, x, y, z_i, z_j):  # type: ignore[no-untyped-def]
    """Return the most places that further malicious nodes add for i and j together.

    x, y: heard by both, with and without a place counted already; z_i, z_j: heard by one alone, no place counted.
    A node of y gives two places when it has two faces, all others one more; with one face a node of x gives none.
    """
    if not two_faces:
        if local:
            return min(left_i, z_i + y) + min(left_j, z_j + y)
        return min(left_i, z_i + z_j + y)
    if not local:
        twice = min(left_i, y)
        return 2 * twice + min(left_i - twice, x + z_i + z_j)
    # Nodes of x take from both budgets and give one place, so they come last.
    spent_i, spent_j = min(left_i, z_i + y), min(left_j, z_j + y)
    return spent_i + spent_j + min(x, min(left_i - spent_i, left_j - spent_j))


@jit
def _count(state, hears, need, f, two_faces, local, side):  # type: ignore[no-untyped-def]
    """Apply *count* with every blocker of one side; return 0 for a contradiction, 2 when something changed, else 1."""
    out_of_line()
    words, other = state.shape[1], 1 - side
    changed = False
    for v in range(words):
        blockers = state[T + side, v]
        while blockers:
            i = (v << 6) + first(blockers)
            blockers &= blockers - ONE
            left_i = _left(state, hears, f, local, i)
            for w in range(words):
                rest = state[P + other, w]
                while rest:
                    j = (w << 6) + first(rest)
                    rest &= rest - ONE
                    places, x, y, z_i, z_j = 0, 0, 0, 0, 0
                    for u in range(words):
                        a = hears[i, u] & sure(state, side, u)
                        b = hears[j, u] & sure(state, other, u)
                        may = ~ZERO
                        if u == w:
                            a &= ~bit_of(j)
                            may &= ~bit_of(j)
                        if u == v:
                            b &= ~bit_of(i)
                            may &= ~bit_of(i)
                        places += count(a | b)
                        may &= ~state[Z, u]
                        one, two = hears[i, u] & state[Q + side, u] & may, hears[j, u] & state[Q + other, u] & may
                        if two_faces:
                            places += count(a & b & state[Z, u])
                            x += count(one & two & (a | b))
                        y += count(one & two & ~(a | b))
                        z_i += count(one & ~two & ~(a | b))
                        z_j += count(two & ~one & ~(a | b))
                    if places >= need[i] + need[j]:
                        continue
                    left_j = _left(state, hears, f, local, j) if local else left_i
                    if places + _gain(local, two_faces, left_i, left_j, x, y, z_i, z_j) >= need[i] + need[j]:
                        continue
                    if state[T + other, w] & bit_of(j):
                        return 0
                    state[P + other, w] &= ~bit_of(j)
                    changed = True
    return 2 if changed else 1


@jit
def lack(state, hears, need, side, node):  # type: ignore[no-untyped-def]
    """Return how many further malicious nodes the node of T needs inside its side (at least; 0 when none)."""
    inside = 0
    for x in range(state.shape[1]):
        inside += count(hears[node, x] & sure(state, side, x))
    return max(np.int64(0), need[node] - inside)


@jit
def _share(state, hears, need, f, votes):  # type: ignore[no-untyped-def]  # noqa: C901 - compiled: calls cost
    """Apply *share*; return False for a contradiction."""
    out_of_line()
    n, words = hears.shape
    for v in range(n):
        votes[v] = 0
    total = np.int64(0)
    for side in range(2):
        for w in range(words):
            rest = state[T + side, w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - ONE
                missing = lack(state, hears, need, side, i)
                if missing == 0:
                    continue
                total += missing
                for x in range(words):
                    open_ = hears[i, x] & state[Q + side, x] & ~sure(state, side, x)
                    while open_:
                        votes[(x << 6) + first(open_)] += 1
                        open_ &= open_ - ONE
    left = np.int64(f)
    for x in range(words):
        left -= count(state[Z, x])
    while total > 0 and left > 0:
        best = 0
        for v in range(n):
            if votes[v] > votes[best]:
                best = v
        if votes[best] == 0:
            return False
        total -= votes[best]
        votes[best] = 0
        left -= 1
    return total <= 0


@jit
def propagate(state, hears, need, f, two_faces, local, counting):  # type: ignore[no-untyped-def]  # noqa: C901 - compiled: calls cost
    """Apply all rules until nothing changes; return False on contradiction."""
    out_of_line()
    votes = np.empty(hears.shape[0], np.int64)
    while True:
        told = _roles(state, two_faces)
        if told == 0:
            return False
        told = _budget(state, hears, f, local)
        if told == 0:
            return False
        if told == 2:
            continue
        again = False
        for side in range(2):
            told = _peel(state, hears, need, f, local, side)
            if told == 0:
                return False
            again |= told == 2
        if again:
            continue
        if counting:
            if not local and not _share(state, hears, need, f, votes):
                return False
            for side in range(2):
                told = _count(state, hears, need, f, two_faces, local, side)
                if told == 0:
                    return False
                again |= told == 2
        if not again:
            return True


@jit
def assume(state, kind, side, node, true, two_faces):  # type: ignore[no-untyped-def]
    """Make the literal (kind, side, node) true or false in ``state``, before any propagation."""
    out_of_line()
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
