"""The rules of a refutation: what is known about a violating pair, and what follows from it.

Terms. ``k_i = max(0, d_i - r + 1)`` is the *need* of node i. Node i of S_k is *satisfied* when at least k_i of its
in-neighbours lie in S_k, that is ``i not in X_Sk^r``, else *exempt*. Lemma 1: a pair of disjoint sets violates
(r,s)-robustness exactly when each side holds a satisfied node and at most s - 1 nodes of both sides are exempt.

A *state* stands for all violating pairs with ``F_k <= S_k <= C_k`` whose satisfied nodes contain ``T_k`` and lie in
``P_k``. Every rule keeps the pairs that a state stands for, or raises :class:`Contradiction` when there are none.
docs/certificate-format.md has the proofs, under the same names.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from certificates.graph import CanonicalGraph
from certificates.masks import Contradiction, Network, masks_of

__all__ = ["Question", "State", "excludes", "member", "peel_and_force", "settle", "share", "spent"]


@dataclass(slots=True)
class Question(Network):
    """Is this graph (r,s)-robust: the network, the needs, and how many nodes may be exempt."""

    spare: int

    @classmethod
    def of(cls, graph: CanonicalGraph, r: int, s: int) -> Question:
        """Return the question about ``graph``."""
        hears, heard_by = masks_of(graph)
        return cls(hears, heard_by, tuple(max(0, len(heard) - r + 1) for heard in graph.hears), s - 1)


class State:
    """Bit masks of both sides: candidates C, possibly satisfied P, members F, satisfied members T.

    ``left`` bounds the exempt nodes beyond those of ``F - P``, and ``allowed`` the part of them on either side. They
    are those of the last settling, and stay true while the sets shrink.
    """

    __slots__ = ("C", "F", "P", "T", "allowed", "left")

    def __init__(self, C: list[int], P: list[int], F: list[int], T: list[int]) -> None:
        self.C, self.P, self.F, self.T = C, P, F, T
        self.left = 0
        self.allowed = [0, 0]

    @classmethod
    def of_all_pairs(cls, n: int) -> Self:
        """Return the state that stands for every violating pair."""
        everyone = (1 << n) - 1
        return cls([everyone, everyone], [everyone, everyone], [0, 0], [0, 0])

    def copy(self) -> Self:
        """Return an independent state of the same sets, to be settled."""
        return type(self)(self.C[:], self.P[:], self.F[:], self.T[:])


def settle(question: Question, state: State) -> None:
    """Apply all rules but *count* until nothing changes; the result does not depend on their order.

    *peel* and *force* come back only to nodes for which something they look at has changed. To pass over a node could
    only make the state say less, never too much.
    """
    state.allowed = [question.spare, question.spare]
    looked_at: list[tuple[int, int, int, int] | None] = [None, None]
    while True:
        member(question, state)
        changed = False
        for side in (0, 1):
            spent(state, side)
            last, sure = looked_at[side], state.P[side] | state.F[side]
            now = (min(state.allowed[side], state.left), state.T[side], state.C[side], sure)
            looked_at[side] = now
            nodes = state.P[side]
            if last is not None and last[0] == now[0]:
                nodes &= (now[1] & ~last[1]) | question.hearing((last[2] ^ now[2]) | (last[3] ^ now[3]))
            changed |= peel_and_force(question, state, side, nodes)
        if not changed and not share(question, state):
            break
    state.allowed = [min(allowed, state.left) for allowed in state.allowed]


def member(question: Question, state: State) -> None:
    """*member*: satisfied nodes are members, and a member of one side is no candidate of the other.

    Members that cannot be satisfied are exempt, which at most s - 1 nodes are; and each side holds a satisfied node.
    """
    C, P, F, T = state.C, state.P, state.F, state.T
    F[0] |= T[0]
    F[1] |= T[1]
    C[0] &= ~F[1]
    C[1] &= ~F[0]
    state.left = question.spare
    for side in (0, 1):
        P[side] &= C[side]
        if F[side] & ~C[side] or T[side] & ~P[side] or not P[side]:
            raise Contradiction
        state.left -= (F[side] & ~P[side]).bit_count()
    if state.left < 0:
        raise Contradiction


def spent(state: State, side: int) -> None:
    """*spent*: a side that is allowed no further exempt node has satisfied members only, beside those known exempt."""
    if not min(state.allowed[side], state.left):
        state.C[side] = state.P[side] | state.F[side]
        state.T[side] = state.P[side] & state.F[side]


def peel_and_force(question: Question, state: State, side: int, nodes: int) -> bool:
    """*peel* and *force*: compare how many members each of ``nodes`` can hear with its need; return whether it is news.

    A member is in ``sure = P | F`` or is a further exempt node. When fewer than k_i nodes can be members within N_i,
    node i is not satisfied. When exactly k_i can, and i is, then all that were counted in full are members.
    """
    possible, members, satisfied = state.P[side], state.F[side], state.T[side]
    sure = possible | members
    loose = state.C[side] & ~sure
    spared = min(state.allowed[side], state.left)
    question.look_at(nodes)
    while nodes:
        bit = nodes & -nodes
        nodes ^= bit
        i = bit.bit_length() - 1
        heard, need = question.hears[i], question.need[i]
        inside = (heard & sure).bit_count()
        if inside > need:
            continue
        extra = (heard & loose).bit_count()
        reach = inside + min(extra, spared)
        if reach < need:
            if bit & satisfied:
                raise Contradiction
            possible ^= bit  # It stays in ``sure`` for the rest of this pass, which only weakens it.
        elif reach == need and bit & satisfied:
            members |= heard & (sure | loose if extra <= spared else sure)
    changed = (possible, members) != (state.P[side], state.F[side])
    state.P[side], state.F[side] = possible, members
    return changed


def share(question: Question, state: State) -> bool:
    """*share*: exempt nodes that one side cannot do without are not left for the other; return whether that is news.

    The other rules have come to rest, so ``left`` of them would suffice for either side: P is Q.
    """
    changed = False
    for side in (0, 1) if state.left else ():
        fair = state.left - _least_exempt(question, state, 1 - side)
        if fair < min(state.allowed[side], state.left):
            state.allowed[side] = fair
            changed = True
    return changed


def _least_exempt(question: Question, state: State, side: int) -> int:
    """Return how many further exempt nodes this side needs at least; ``left`` suffice.

    What t of them suffice for, t + 1 do; so after the usual answer, 0, the least is found by bisection.
    """
    if _suffices(question, state, side, 0):
        return 0
    low, high = 1, state.left
    while low < high:
        middle = (low + high) // 2
        if _suffices(question, state, side, middle):
            high = middle
        else:
            low = middle + 1
    return low


def _suffices(question: Question, state: State, side: int, t: int) -> bool:
    """Return whether with t further exempt nodes all of T, and somebody, may be satisfied on this side.

    The satisfied nodes lie in the largest subset Q of P in which every i hears at least k_i possible members: nodes of
    ``Q | F``, and at most t other candidates. Such subsets are closed under union.
    """
    Q = nodes = state.P[side]
    while Q and not state.T[side] & ~Q:
        sure, kept = Q | state.F[side], Q
        loose = state.C[side] & ~sure
        question.look_at(nodes)
        while nodes:
            bit = nodes & -nodes
            nodes ^= bit
            i = bit.bit_length() - 1
            heard = question.hears[i]
            if (heard & sure).bit_count() + min(t, (heard & loose).bit_count()) < question.need[i]:
                kept ^= bit
        if kept == Q:
            return True
        nodes = kept & question.hearing(Q ^ kept)
        Q = kept
    return False


def excludes(question: Question, state: State, side: int, j: int, blockers: list[int]) -> bool:
    """*count*: return whether the satisfied ``blockers`` of the other side leave too few nodes to satisfy j on this.

    Let every node serve as many of the needs of the blockers I and of j as it can, on the side it is on. Nodes of
    D = P | F of the other side and D' of this one serve at most ``sum_I |N_i & D - j| + |N_j & D' - union_I N_i & D|``;
    of the further exempt nodes, at most ``left``, those on the side of I, at most ``allowed``, serve |I| needs, the
    others one. Less than ``sum_I k_i + k_j`` is not enough.
    """
    question.look_at(0)
    other = 1 - side
    sure = state.P[other] | state.F[other]
    own = question.hears[j] & (state.P[side] | state.F[side])
    served = state.left + (len(blockers) - 1) * state.allowed[other]
    needed = question.need[j]
    for i in blockers:
        heard = question.hears[i] & sure
        served += (heard & ~(1 << j)).bit_count()
        needed += question.need[i]
        own &= ~heard
    return served + own.bit_count() < needed
