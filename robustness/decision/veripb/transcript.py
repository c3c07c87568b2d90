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
from certificates.refutation import SATISFIED, Replay
from robustness.decision.veripb.inequalities import Model
from robustness.decision.veripb.proof import Proof
from robustness.decision.veripb.settling import Knowledge, Settling, ids

__all__ = ["derive_refutation"]


def derive_refutation(model: Model, whole: Model, body: bytes, proof: Proof) -> None:
    """Write the proof that ``body``, the verified transcript of a refutation, amounts to.

    ``model`` is the part of ``whole`` that the transcript is about.
    """
    start = Knowledge.of_all_pairs(model.graph.n)
    start.symmetric = True
    _Derivation(model, whole, body, proof).run(start)


class _Derivation(Replay[Knowledge]):
    """The kernel's walk through a transcript, which writes what each of its steps amounts to."""

    def __init__(self, model: Model, whole: Model, body: bytes, proof: Proof) -> None:
        super().__init__(model.question, model.graph.n, body)
        self.model = model
        self.proof = proof
        self.assumed: list[str] = []
        self.settling = Settling(model, whole, proof, self.assumed)

    def settle(self, state: Knowledge) -> None:
        """Settle a state; where that closes a branch, close it in the proof."""
        try:
            self.settling.settle(state)
        except Contradiction:
            self.close()
            raise

    def exclude(self, state: Knowledge, which: int) -> None:
        """Carry out an EXCLUDE step; where that closes a branch, close it in the proof."""
        try:
            super().exclude(state, which)
        except Contradiction:
            self.close()
            raise

    def branch(self, state: Knowledge, kind: int, side: int, node: int) -> tuple[Knowledge, Knowledge] | None:
        """Carry out a branch and assume its literal; ``state`` becomes the false child."""
        children = super().branch(state, kind, side, node)
        state.symmetric = False
        name = self.model.satisfied if kind == SATISFIED else self.model.member
        self.assumed.append(name(side, node))
        self.proof.open_level()
        return children

    def mirror(self, state: Knowledge, node: int) -> None:
        """Derive that the node of a root is not satisfied on side 2, since the sides may be swapped."""
        super().mirror(state, node)
        state.symmetric = True
        self.proof.without_loss([(1, "~" + self.model.satisfied(1, node))], 1, self.settling.swap())

    def close(self) -> None:
        """Close a branch: what is assumed does not all hold; the false child needs no assumption for it."""
        if self.assumed:
            self.proof.refuted(self.assumed)
            self.assumed.pop()
        else:
            self.proof.clause([])

    def count(self, state: Knowledge, side: int, node: int, blockers: list[int]) -> None:
        """Check the exclusion of j and add up what makes *count* propagate: that j is not satisfied on this side.

        With a_v the number of blockers that hear v, the needs add up to ``sum_v a_v x_v + [v in N_j] y_v`` against
        ``sum_I k_i + k_j``. Where both x_v and y_v are open, ``~x_v + ~y_v >= 1`` takes one of them away; x_j goes with
        all its weight, as j is to be on this side. Of nodes that could only be exempt members it is counted that they
        are exempt, and the bounds on those are added.
        """
        super().count(state, side, node, blockers)
        model, hears, other, j = self.model, self.model.question.hears, 1 - side, node
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
