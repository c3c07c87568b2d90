"""From the transcript of a refutation to the lines of a proof.

What becomes of each rule (docs/certificate-format.md has the rules, :mod:`~robustness.decision.veripb.inequalities` the
inequalities):

*member*, *spent*
    are unit propagation over the model.
*peel*, *force*
    are unit propagation too as long as nobody else may be exempt, or all candidates that i hears may be members. Else
    a ``pol`` line adds up i's need, "a member is satisfied or counted as exempt" for the nodes outside D that i hears,
    and the bound on exempt nodes.
*count*
    propagates once the needs of the blockers and of j and "no node is on both sides" are added up: a ``pol`` line.
*share*
    takes a new variable, "side k has at least m exempt nodes", and a clause that it is true.
*root*
    is a ``red`` line, "v is not satisfied in S2", whose witness swaps the sides.

A *leaf* is one ``rup`` line: the literals that were assumed on the way to it do not all hold. A false child needs no
assumption, as its literal is false by the line that closed the true child; so one line closes at once all branches
whose false child ends here.

What a state of the kernel knows, propagation in the checker knows at the same place: that is the invariant, and
whether it holds the checker finds out.
"""

from __future__ import annotations

from certificates.masks import Contradiction
from certificates.refutation import SATISFIED
from certificates.walk import BRANCH, EXCLUDE, PROPAGATE, ROOT
from robustness.decision.veripb.inequalities import Model
from robustness.decision.veripb.proof import Proof
from robustness.decision.veripb.settling import Knowledge, Settling, ids

__all__ = ["derive_refutation"]


def derive_refutation(model: Model, whole: Model, body: bytes, proof: Proof) -> None:
    """Write the proof that ``body``, the verified transcript of a refutation, amounts to.

    ``model`` is the part of ``whole`` that the transcript is about.
    """
    _Derivation(model, whole, body, proof).run()


class _Derivation:
    """One transcript being read, and the literals assumed so far."""

    def __init__(self, model: Model, whole: Model, body: bytes, proof: Proof) -> None:
        self.model = model
        self.body = body
        self.proof = proof
        self.place = 0
        self.assumed: list[str] = []
        self.settling = Settling(model, whole, proof, self.assumed)

    def run(self) -> None:
        """Walk the tree in preorder with an explicit stack of the false children to come."""
        state = Knowledge.of_all_pairs(self.model.graph.n)
        waiting: list[Knowledge] = []
        while True:
            try:
                self.settling.settle(state)
                self.exclusions(state)
            except Contradiction:
                if not waiting:
                    self.proof.clause([])
                    break
                self.proof.refuted(self.assumed)
                self.assumed.pop()
                state = waiting.pop()
            else:
                waiting.append(state)
                state = self.branch(state)

    def exclusions(self, state: Knowledge) -> None:
        """Carry out the EXCLUDE steps that come before a branch."""
        while self.body[self.place : self.place + 1] >= bytes([EXCLUDE]):
            while (code := self.number() - EXCLUDE) != PROPAGATE - EXCLUDE:
                side, j = code & 1, self.number()
                blockers = [self.number() for _ in range(1 + (code >> 1))]
                self.count(state, side, j, blockers)
                if state.T[side] >> j & 1:
                    raise Contradiction
                state.P[side] &= ~(1 << j)
            self.settling.settle(state)

    def count(self, state: Knowledge, side: int, j: int, blockers: list[int]) -> None:
        """Add up what makes *count* propagate: that j is not satisfied on this side.

        With a_v the number of blockers that hear v, the needs add up to ``sum_v a_v x_v + [v in N_j] y_v`` against
        ``sum_I k_i + k_j``. Where both x_v and y_v are open, ``~x_v + ~y_v >= 1`` takes one of them away; x_j goes with
        all its weight, as j is to be on this side. Of nodes that could only be exempt members it is counted that they
        are exempt, and the bounds on those are added.
        """
        model, hears, other = self.model, self.model.question.hears, 1 - side
        blockers = [i for i in blockers if model.needs[other][i] is not None]
        summands = [(need, 1) for need in (model.needs[side][j], *(model.needs[other][i] for i in blockers)) if need]
        sure = state.P[other] | state.F[other]
        heard_by_j = hears[j] if model.needs[side][j] else 0
        own = heard_by_j & (state.P[side] | state.F[side])
        heard = 0
        for i in blockers:
            heard |= hears[i]
        summands += [(model.disjoint[v], 1) for v in ids(heard & sure & own)]
        weight = {v: sum(hears[i] >> v & 1 for i in blockers) for v in ids(heard)}
        if j in weight:
            summands.append((model.disjoint[j], weight[j]))
            if model.s > 1:
                summands.append((model.membership[side][j], weight[j]))
        loose = {v: weight[v] for v in ids(heard & state.C[other] & ~sure & ~(1 << j))} if state.allowed[other] else {}
        loose_own = ids(heard_by_j & state.C[side] & ~own) if state.allowed[side] else []
        if loose or loose_own:
            summands += [(model.exemption[other][v], factor) for v, factor in loose.items()]
            summands += [(model.exemption[side][v], 1) for v in loose_own]
            bounds = [model.budget]
            if max(loose.values(), default=0) > 1:
                bounds.append(self.settling.bound(state, other))
            summands += [(bound, bounds.count(bound)) for bound in sorted(set(bounds))]
        self.proof.add_up(summands)

    def branch(self, state: Knowledge) -> Knowledge:
        """Carry out a branch: assume its literal, leave ``state`` to the false child, and return the true child."""
        opcode, node = self.number(), self.number()
        kind, side = (SATISFIED, 0) if opcode == ROOT else divmod(opcode - BRANCH, 2)
        bit = 1 << node
        true = state.copy()
        (true.T if kind == SATISFIED else true.F)[side] |= bit
        if kind != SATISFIED:
            state.C[side] &= ~bit
        state.P[side] &= ~bit
        state.symmetric = opcode == ROOT
        if opcode == ROOT:
            state.P[1] &= ~bit
            self.proof.without_loss([(1, "~" + self.model.satisfied(1, node))], 1, self.settling.swap())
        name = self.model.satisfied if kind == SATISFIED else self.model.member
        self.assumed.append(name(side, node))
        self.proof.open_level()
        return true

    def number(self) -> int:
        """Read one number: seven bits a byte, low first."""
        value = shift = 0
        while True:
            byte = self.body[self.place]
            self.place += 1
            value |= (byte & 127) << shift
            if byte < 128:
                return value
            shift += 7
