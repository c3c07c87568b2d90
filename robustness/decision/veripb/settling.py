"""Settling a state by the kernel's rules, and writing down what unit propagation would not see by itself.

For s = 1 that is nothing. For s > 1 the bounds on exempt nodes have to be brought together with the needs of nodes;
see :mod:`~robustness.decision.veripb.transcript`. Who is peeled and who is forced is found by
:mod:`certificates.rules`, asked about one node at a time; what it changes tells which sum the checker needs. The
settled state does not depend on the order of the rules, so branches close where they close in the kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from certificates.masks import Contradiction
from certificates.rules import State, member, peel_and_force, settle, share, spent
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


class Knowledge(State):
    """A state of the kernel, with how many exempt nodes are known to be needed, and whether both sides are alike.

    ``needed[k] = m > 0`` says that by a clause of the proof side k has at least m exempt nodes under what is assumed.
    ``symmetric`` says that both sides have the same sets, so that a root may follow.
    """

    __slots__ = ("needed", "symmetric")

    def __init__(self, C: list[int], P: list[int], F: list[int], T: list[int]) -> None:
        super().__init__(C, P, F, T)
        self.needed = [0, 0]
        self.symmetric = False

    def copy(self) -> Self:
        """Return an independent state of the same sets, not to be followed by a root."""
        other = super().copy()
        other.needed = self.needed[:]
        return other

    def exempt(self, side: int) -> int:
        """Return how many nodes of this side are exempt for certain."""
        return (self.F[side] & ~self.P[side]).bit_count()


def sides(state: Knowledge, side: int) -> tuple[int, ...]:
    """Return the sides to write something for: in a symmetric state both, this one first."""
    return (side, 1 - side) if state.symmetric else (side,)


class Settling:
    """The sums and clauses that go with the rules *peel*, *force* and *share*."""

    def __init__(self, model: Model, whole: Model, proof: Proof, assumed: Sequence[str]) -> None:
        self.model = model
        #: The model that ``model`` is a part of.
        self.whole = whole
        self.proof = proof
        #: The literals assumed at the moment; shared with the derivation.
        self.assumed = assumed
        #: For m, per side: the places of "fewer than m exempt, or the counter is true" and of the cap on this side.
        self.counters: dict[int, tuple[list[int], list[int]]] = {}

    def settle(self, state: Knowledge) -> None:
        """Apply the rules until nothing changes, or raise :class:`~certificates.masks.Contradiction`."""
        question = self.model.question
        question.looks = 0  # The kernel's bound on them was kept when the certificate was verified.
        if not question.spare:
            settle(question, state)
            return
        state.allowed = [question.spare, question.spare]
        while True:
            member(question, state)
            changed = False
            for side in (0, 1):
                spent(state, side)
                changed |= self.peel_and_force(state, side)
            if not changed and not self.share(state):
                break
        state.allowed = [min(allowed, state.left) for allowed in state.allowed]

    def peel_and_force(self, state: Knowledge, side: int) -> bool:
        """Apply *peel* and *force* to one node after another; return whether a set changed.

        Where fewer may be exempt than i hears candidates outside D, the checker needs a sum to see the change.
        """
        changed = False
        spared = min(state.allowed[side], state.left)
        for i in ids(state.P[side]):
            loose = self.loose(state, side, i)
            in_need = 0 < spared < loose.bit_count()
            try:
                news = peel_and_force(self.model.question, state, side, 1 << i)
            except Contradiction:
                if in_need:
                    self.exempt_for(side, i, loose, state)
                raise
            if news and in_need:
                self.exempt_for(side, i, loose, state)
            changed |= news
        return changed

    def loose(self, state: State, side: int, i: int) -> int:
        """Return the nodes that i hears which could only be exempt members of this side."""
        return self.model.question.hears[i] & state.C[side] & ~(state.P[side] | state.F[side])

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
        before = state.allowed[:]
        news = share(self.model.question, state)
        for side in (0, 1):
            if state.allowed[side] != before[side]:
                other, t = 1 - side, state.left - state.allowed[side]
                needed = state.exempt(other) + t
                if needed > state.needed[other]:
                    self.need_exempt(state, other, needed, t)
        return news

    def rule_out(self, state: Knowledge, side: int, t: int, bound: int) -> None:
        """Write why t further exempt nodes, which do not suffice, leave too few nodes to be satisfied on this side.

        *peel* with this allowance, down to where somebody in T, or everybody, cannot be satisfied. ``bound`` is the
        place of "at most t further exempt nodes".
        """
        trial = State(state.C[:], state.P[:], state.F[:], [0, 0])
        trial.left, trial.allowed = t, [t, t]
        while trial.P[side] and not state.T[side] & ~trial.P[side]:
            for i in ids(trial.P[side]):
                loose = self.loose(trial, side, i)
                if peel_and_force(self.model.question, trial, side, 1 << i) and 0 < t < loose.bit_count():
                    self.add_need(side, i, loose, bound)

    def need_exempt(self, state: Knowledge, side: int, m: int, t: int) -> None:
        """Derive "this side has at least m exempt nodes": fewer leave t - 1 further ones, which do not suffice."""
        few, _ = self.counter(m)
        for k in sides(state, side):
            self.proof.open_level()
            self.rule_out(state, k, t - 1, few[k])
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
