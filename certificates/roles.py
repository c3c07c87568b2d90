"""The rules of a refutation of tolerance: what is known about sets that hold a network apart, and what follows from it.

Terms. The *normal members* of side k are ``N_k = S_k - M``. With two faces M is *inside* both sides; with one face it
is split in M_1 and M_2, and M_k is inside side k. ``k_i = max(0, d_i - f)`` is the *need* of node i: sets hold the
network apart exactly when each N_k has a node, M obeys its bound, and every i of N_k hears k_i nodes inside side k.

A *state* stands for all solutions with ``T_k <= N_k <= P_k``, ``Z <= M``, with M (with one face M_k) in Q_k, and with
F_k inside side k. Every rule keeps the solutions that a state stands for, or raises :class:`Contradiction` when there
are none. docs/certificate-format.md has the proofs, under the same names.
"""

from __future__ import annotations

from dataclasses import dataclass

from certificates.graph import CanonicalGraph
from certificates.masks import Contradiction, Network, masks_of

__all__ = ["Roles", "Threat", "excludes", "settle"]


@dataclass(slots=True)
class Threat(Network):
    """Can f malicious nodes with one face or two, bounded in total or locally, hold this network apart?"""

    f: int
    two_faces: bool
    local: bool

    @classmethod
    def of(cls, graph: CanonicalGraph, f: int, two_faces: bool, local: bool) -> Threat:
        """Return the question about ``graph``."""
        hears, heard_by = masks_of(graph)
        return cls(hears, heard_by, tuple(max(0, len(heard) - f) for heard in graph.hears), f, two_faces, local)


class Roles:
    """Bit masks of both sides: possibly normal P, possibly malicious and inside Q, inside F, normal T; malicious Z.

    ``seen`` is what *budget*, and *peel* and *force* on either side, looked at last: a node is looked at again when
    something has changed for it. To pass over a node could only make the state say less, never too much.
    """

    __slots__ = ("F", "P", "Q", "T", "Z", "seen")

    def __init__(self, P: list[int], Q: list[int], F: list[int], T: list[int], Z: int) -> None:
        self.P, self.Q, self.F, self.T, self.Z = P, Q, F, T, Z
        self.seen: list[tuple[int, ...]] = [(), (), ()]

    @classmethod
    def of_all_solutions(cls, n: int) -> Roles:
        """Return the state that stands for every solution."""
        everyone = (1 << n) - 1
        return cls([everyone, everyone], [everyone, everyone], [0, 0], [0, 0], 0)

    def copy(self) -> Roles:
        """Return an independent state of the same sets."""
        made = Roles(self.P[:], self.Q[:], self.F[:], self.T[:], self.Z)
        made.seen = self.seen[:]
        return made

    def sets(self) -> tuple[int, ...]:
        """Return all nine sets."""
        return (*self.P, *self.Q, *self.F, *self.T, self.Z)

    def sure(self, side: int) -> int:
        """Return D: who can be inside the side without a further malicious node."""
        return self.P[side] | self.F[side] | self.Z & self.Q[side]


def settle(threat: Threat, state: Roles) -> None:
    """Apply all rules but *count* until nothing changes; the result does not depend on their order."""
    while True:
        _role(threat, state)
        before = state.sets()
        _budget(threat, state)
        if state.sets() != before:
            continue
        for side in (0, 1):
            _peel_and_force(threat, state, side)
        if state.sets() == before:
            break
    if not threat.local:
        _share(threat, state)


def _role(threat: Threat, state: Roles) -> None:
    """*role*: what a node is for certain rules out its other roles, and the only role left for a node is certain."""
    P, Q, F, T = state.P, state.Q, state.F, state.T
    before: tuple[int, ...] = ()
    while before != (before := state.sets()):
        normal = T[0] | T[1]
        for side in (0, 1):
            F[side] |= T[side]
            Q[side] &= ~normal
        if threat.two_faces:
            state.Z |= F[0] & F[1]
        else:
            Q[0], Q[1] = Q[0] & ~F[1], Q[1] & ~F[0]
        state.Z |= F[0] & ~P[0] | F[1] & ~P[1]
        for side in (0, 1):
            other = 1 - side
            P[side] &= ~(state.Z | F[other])
            F[side] |= state.Z if threat.two_faces else state.Z & ~Q[other]
            T[side] |= F[side] & ~Q[side]
    if state.Z & ~(Q[0] | Q[1]) or not P[0] or not P[1] or (not threat.two_faces and F[0] & F[1]):
        raise Contradiction
    # A node inside a side that can be neither normal nor malicious there: the rules above first put it into Z, then
    # into T, then out of both Q, so that the first condition finds it.


def _budget(threat: Threat, state: Roles) -> None:
    """*budget*: when the bound on M is used up, in all or at a node that is not in M, nobody else is malicious.

    Locally, a node that hears more than f nodes of Z is in M itself.
    """
    Q, Z = state.Q, state.Z
    if not threat.local:
        if Z.bit_count() > threat.f:
            raise Contradiction
        if Z.bit_count() == threat.f:
            Q[0] &= Z
            Q[1] &= Z
        return
    maybe = Q[0] | Q[1]
    last, now = state.seen[2], (Z, maybe)
    state.seen[2] = now
    nodes = (1 << len(threat.hears)) - 1
    if last:
        nodes = threat.hearing(Z ^ last[0]) | maybe ^ last[1]
    nodes &= ~Z
    threat.look_at(nodes)
    while nodes:
        bit = nodes & -nodes
        nodes ^= bit
        heard = threat.hears[bit.bit_length() - 1]
        used = (heard & Z).bit_count()
        if used > threat.f and not bit & maybe:
            raise Contradiction
        if used > threat.f:
            state.Z |= bit
        elif used == threat.f and not bit & maybe:
            Q[0] &= ~heard | Z
            Q[1] &= ~heard | Z


def _left(threat: Threat, state: Roles, heard: int) -> int:
    """Return how many further malicious nodes a normal node that hears ``heard`` can hear; at least 0 when settled."""
    return threat.f - (heard & state.Z if threat.local else state.Z).bit_count()


def _peel_and_force(threat: Threat, state: Roles, side: int) -> None:
    """*peel* and *force*: compare how many nodes inside the side each can hear with its need.

    What node i hears inside is in D or is one of at most ``left`` further malicious nodes. When fewer than k_i can be
    heard inside, i is not normal on this side. When exactly k_i can, and i is, what was counted in full is inside.
    """
    possible, inside, normal, sure = state.P[side], state.F[side], state.T[side], state.sure(side)
    loose = state.Q[side] & ~sure
    left = _left(threat, state, 0)
    last, now = state.seen[side], (left, normal, sure, loose, state.Z)
    state.seen[side] = now
    nodes = possible
    if last and (threat.local or last[0] == left):
        news = (sure ^ last[2]) | (loose ^ last[3]) | (state.Z ^ last[4] if threat.local else 0)
        nodes &= (normal & ~last[1]) | threat.hearing(news)
    threat.look_at(nodes)
    while nodes:
        bit = nodes & -nodes
        nodes ^= bit
        i = bit.bit_length() - 1
        heard, need = threat.hears[i], threat.need[i]
        held = (heard & sure).bit_count()
        if held > need:
            continue
        extra = (heard & loose).bit_count()
        usable = min(extra, _left(threat, state, heard) if threat.local else left)
        if held + usable < need:
            if bit & normal:
                raise Contradiction
            possible ^= bit  # It stays in ``sure`` for the rest of this pass, which only weakens it.
        elif held + usable == need and bit & normal:
            inside |= heard & (sure | loose if usable == extra else sure)
    state.P[side], state.F[side] = possible, inside


def _share(threat: Threat, state: Roles) -> None:
    """*share*: the further malicious nodes that are left serve at most as many wants as the most wanted of them."""
    wanted = 0
    votes: dict[int, int] = {}
    for side in (0, 1):
        sure = state.sure(side)
        loose = state.Q[side] & ~sure
        threat.look_at(state.T[side])
        nodes = state.T[side]
        while nodes:
            i = (nodes & -nodes).bit_length() - 1
            nodes &= nodes - 1
            missing = threat.need[i] - (threat.hears[i] & sure).bit_count()
            if missing <= 0:
                continue
            wanted += missing
            open_ = threat.hears[i] & loose
            threat.look_at(open_)
            while open_:
                bit = open_ & -open_
                open_ ^= bit
                votes[bit] = votes.get(bit, 0) + 1
    if wanted > sum(sorted(votes.values(), reverse=True)[: _left(threat, state, 0)]):
        raise Contradiction


def excludes(threat: Threat, state: Roles, side: int, j: int, i: int) -> bool:
    """*count*: return whether i, normal on the other side, leaves too few places for j to be normal on this one.

    i and j need k_i + k_j places: pairs of one of them and a node that it hears inside its side. A normal node gives
    one place at most, and so does a malicious one with one face; with two faces it gives one to each that hears it.
    """
    threat.look_at(0)
    other = 1 - side
    hears_i, hears_j = threat.hears[i] & ~(1 << j), threat.hears[j] & ~(1 << i)
    sure_i = hears_i & (state.P[other] | state.F[other] | state.Z & state.Q[other])
    sure_j = hears_j & (state.P[side] | state.F[side] | state.Z & state.Q[side])
    either = sure_i | sure_j
    needed = threat.need[i] + threat.need[j] - either.bit_count()
    if threat.two_faces:
        needed -= (sure_i & sure_j & state.Z).bit_count()
    left_i = left_j = _left(threat, state, threat.hears[i])
    if threat.local:
        left_j = _left(threat, state, threat.hears[j])
    if left_i + left_j < needed:
        return True  # Each further malicious node gives one place at most to each of the two.
    one, two = hears_i & state.Q[other] & ~state.Z, hears_j & state.Q[side] & ~state.Z
    both = (one & two & ~either).bit_count()
    only_i, only_j = (one & ~two & ~either).bit_count(), (two & ~one & ~either).bit_count()
    if not threat.two_faces:
        if threat.local:
            places = min(left_i, only_i + both) + min(left_j, only_j + both)
        else:
            places = min(left_i, only_i + only_j + both)
    else:
        again = (one & two & either).bit_count()
        if threat.local:
            # Nodes that have given a place already take from both budgets and give one more: they come last.
            spent_i, spent_j = min(left_i, only_i + both), min(left_j, only_j + both)
            places = spent_i + spent_j + min(again, left_i - spent_i, left_j - spent_j)
        else:
            twice = min(left_i, both)
            places = 2 * twice + min(left_i - twice, again + only_i + only_j)
    return places < needed
