"""Settling a state as the kernel does, and writing down what unit propagation would not see by itself.

For s = 1 that is nothing. For s > 1 the bounds on exempt nodes have to be brought together with the needs of nodes;
see :mod:`~robustness.decision.veripb.transcript`. The settled state does not depend on the order of the rules, so the
states here are those of the kernel, and branches close where they close there.
"""

from __future__ import annotations

from collections.abc import Sequence

from certificates.masks import Contradiction
from robustness.decision.veripb.inequalities import Model, negated
from robustness.decision.veripb.proof import Proof

__all__ = ["Knowledge", "Settling", "ids"]


def ids(mask: int) -> list[int]:
    """Return the ids in a bit mask, ascending."""
    found = []
    while mask:
        bit = mask & -mask
        mask ^= bit
        found.append(bit.bit_length() - 1)
    return found


class Knowledge:
    """A state: bit masks C, P, F, T of both sides, bounds on further exempt nodes, and how many are known to be needed.

    ``needed[k] = m > 0`` says that by a clause of the proof side k has at least m exempt nodes under what is assumed.
    ``symmetric`` says that both sides have the same sets, so that a root may follow.
    """

    __slots__ = ("C", "F", "P", "T", "allowed", "left", "needed", "symmetric")

    def __init__(
        self, C: list[int], P: list[int], F: list[int], T: list[int], needed: list[int], symmetric: bool = False
    ) -> None:
        self.C, self.P, self.F, self.T = C, P, F, T
        self.needed = needed
        self.symmetric = symmetric
        self.left = 0
        self.allowed = [0, 0]

    @classmethod
    def of_all_pairs(cls, n: int) -> Knowledge:
        """Return the state that knows nothing."""
        everyone = (1 << n) - 1
        return cls([everyone, everyone], [everyone, everyone], [0, 0], [0, 0], [0, 0], symmetric=True)

    def copy(self) -> Knowledge:
        """Return an independent state of the same sets, not to be followed by a root."""
        return Knowledge(self.C[:], self.P[:], self.F[:], self.T[:], self.needed[:])

    def exempt(self, side: int) -> int:
        """Return how many nodes of this side are exempt for certain."""
        return (self.F[side] & ~self.P[side]).bit_count()


def sides(state: Knowledge, side: int) -> tuple[int, ...]:
    """Return the sides to write something for: in a symmetric state both, this one first."""
    return (side, 1 - side) if state.symmetric else (side,)


class Settling:
    """The rules *member*, *spent*, *peel*, *force* and *share*, and the sums and clauses that go with them."""

    def __init__(self, model: Model, whole: Model, proof: Proof, assumed: Sequence[str]) -> None:
        self.model = model
        #: The model that ``model`` is a part of.
        self.whole = whole
        self.proof = proof
        #: The literals assumed at the moment; shared with the derivation.
        self.assumed = assumed
        self.spare = model.s - 1
        #: For m, per side: the places of "fewer than m exempt, or the counter is true" and of the cap on this side.
        self.counters: dict[int, tuple[list[int], list[int]]] = {}

    def settle(self, state: Knowledge) -> None:
        """Apply the rules until nothing changes, or raise :class:`~certificates.rules.Contradiction`."""
        state.allowed = [self.spare, self.spare]
        while True:
            self.member(state)
            changed = False
            for side in (0, 1):
                if not min(state.allowed[side], state.left):
                    state.C[side] = state.P[side] | state.F[side]
                    state.T[side] = state.P[side] & state.F[side]
                changed |= self.peel_and_force(state, side)
            if not changed and not self.share(state):
                break
        state.allowed = [min(allowed, state.left) for allowed in state.allowed]

    def member(self, state: Knowledge) -> None:
        """Apply *member*; it is all propagation over the model."""
        C, P, F, T = state.C, state.P, state.F, state.T
        F[0] |= T[0]
        F[1] |= T[1]
        C[0] &= ~F[1]
        C[1] &= ~F[0]
        for side in (0, 1):
            P[side] &= C[side]
            if F[side] & ~C[side] or T[side] & ~P[side] or not P[side]:
                raise Contradiction
        state.left = self.spare - state.exempt(0) - state.exempt(1)
        if state.left < 0:
            raise Contradiction

    def peel_and_force(self, state: Knowledge, side: int) -> bool:
        """Apply *peel* and *force* in one pass and write the sums they need; return whether a set changed."""
        possible, members, satisfied = state.P[side], state.F[side], state.T[side]
        sure = possible | members
        loose = state.C[side] & ~sure
        spared = min(state.allowed[side], state.left)
        for i in ids(possible):
            heard, need, bit = self.model.question.hears[i], self.model.question.need[i], 1 << i
            inside = (heard & sure).bit_count()
            extra = (heard & loose).bit_count()
            reach = inside + min(extra, spared)
            forced = bit & satisfied and reach == need
            if 0 < spared < extra and (reach < need or forced):
                self.exempt_for(side, i, heard & loose, state)
            if reach < need:
                if bit & satisfied:
                    raise Contradiction
                possible &= ~bit
            elif forced:
                members |= heard & (sure | loose if extra <= spared else sure)
        changed = (possible, members) != (state.P[side], state.F[side])
        state.P[side], state.F[side] = possible, members
        return changed

    def exempt_for(self, side: int, i: int, loose: int, state: Knowledge) -> None:
        """Write the sum "of the ``loose`` nodes that i hears, no more are members than may yet be exempt".

        In a symmetric state its mirror image too: the swap at the next root needs both.
        """
        capped = state.allowed[side] < state.left
        for k in sides(state, side):
            bound = self.cap(k, state.needed[1 - side]) if capped else self.model.budget
            self.add_need(k, i, loose, bound)

    def add_need(self, side: int, i: int, loose: int, bound: int) -> None:
        """Write the sum of i's need, "a member is satisfied or exempt" for ``loose``, and a bound on exempt nodes."""
        need = self.model.needs[side][i]
        if need is not None:
            self.proof.add_up([(need, 1), (bound, 1), *((self.model.exemption[side][v], 1) for v in ids(loose))])

    def share(self, state: Knowledge) -> bool:
        """Apply *share*, write clauses on the exempt nodes each side needs; return whether that is news."""
        changed = False
        for side in (0, 1) if state.left else ():
            other = 1 - side
            # Since the state is settled, all that are left suffice.
            t = next(t for t in range(state.left + 1) if self.suffices(state, other, t, 0))
            if state.left - t < min(state.allowed[side], state.left):
                state.allowed[side] = state.left - t
                changed = True
                needed = state.exempt(other) + t
                if needed > state.needed[other]:
                    self.need_exempt(state, other, needed, t)
        return changed

    def suffices(self, state: Knowledge, side: int, t: int, bound: int) -> bool:
        """Return whether with t further exempt nodes all of T, and somebody, may be satisfied on this side.

        The satisfied nodes lie in the largest Q of which every node hears enough of ``Q | F`` and t other candidates.
        With ``bound``, the place of "at most t further exempt nodes", the sums that leave no larger Q are written.
        """
        Q = state.P[side]
        while Q and not state.T[side] & ~Q:
            sure, kept = Q | state.F[side], Q
            loose = state.C[side] & ~sure
            for i in ids(Q):
                heard = self.model.question.hears[i]
                extra = heard & loose
                if (heard & sure).bit_count() + min(t, extra.bit_count()) < self.model.question.need[i]:
                    kept &= ~(1 << i)
                    if bound and 0 < t < extra.bit_count():
                        self.add_need(side, i, extra, bound)
            if kept == Q:
                return True
            Q = kept
        return False

    def need_exempt(self, state: Knowledge, side: int, m: int, t: int) -> None:
        """Derive "this side has at least m exempt nodes": fewer leave t - 1 further ones, which do not suffice."""
        few, _ = self.counter(m)
        for k in sides(state, side):
            self.proof.open_level()
            self.suffices(state, k, t - 1, few[k])
            self.proof.refuted([*self.assumed, negated(self.counter_name(k, m))])
            state.needed[k] = m

    def bound(self, state: Knowledge, side: int) -> int:
        """Return the place of the best bound at hand on the exempt nodes of this side."""
        return self.cap(side, state.needed[1 - side]) if state.allowed[side] < state.left else self.model.budget

    def cap(self, side: int, m: int) -> int:
        """Return the place of "if the other side has at least m exempt nodes, this one has at most s - 1 - m"."""
        return self.counter(m)[1][side]

    def counter_name(self, side: int, m: int) -> str:
        """Return the variable "S1 (S2) has at least m exempt nodes"."""
        return f"{'pq'[side]}{m}"

    def counter(self, m: int) -> tuple[list[int], list[int]]:
        """Define the counters of m for both sides, once, and return the places of what they are good for.

        ``m ~p + sum e >= m`` and ``(n - m + 1) p + sum ~e >= n - m + 1`` say that p is true exactly when at least m
        nodes are exempt; any pair can be made to satisfy them by the right value of p.
        """
        if m not in self.counters:
            proof, model, nodes = self.proof, self.model, range(self.model.graph.n)
            few, caps = [], [0, 0]
            for side in (0, 1):
                name, room = self.counter_name(side, m), model.graph.n - m + 1
                exempt = [model.exempt(side, i) for i in nodes]
                many = proof.without_loss([(m, negated(name)), *((1, e) for e in exempt)], m, [(name, "0")])
                terms = [(room, name), *((1, negated(e)) for e in exempt)]
                few.append(proof.without_loss(terms, room, [(name, "1")]))
                caps[1 - side] = proof.add_for_good([(model.budget, 1), (many, 1)])
            self.counters[m] = few, caps
        return self.counters[m]

    def swap(self) -> list[tuple[str, str]]:
        """Return the exchange of the sides, counters included."""
        names = [[self.counter_name(side, m) for m in self.counters] for side in (0, 1)]
        return [*self.whole.swap(), *zip(*names, strict=True), *zip(*names[::-1], strict=True)]
