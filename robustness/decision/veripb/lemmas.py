"""Proofs of the lemmas on degree and growth, each written out for one graph.

Lemmas 3 and 4 of docs/certificate-format.md. Neither needs a search, so their proofs are short for graphs of any size.
"""

from __future__ import annotations

from collections.abc import Sequence

from robustness.decision.veripb.inequalities import Model, negated
from robustness.decision.veripb.proof import Proof

__all__ = ["derive_degree", "derive_growth"]


def derive_degree(model: Model, proof: Proof) -> None:
    """Derive the contradiction of a model in which every node hears at least ``floor(n/2) + r - 1`` others.

    A satisfied node has a need of at least floor(n/2), so with it its set holds more than half of the nodes. For either
    set a variable says so; were it false, nobody could be satisfied; and two disjoint sets cannot both be so large.
    """
    nodes, half = range(model.graph.n), model.graph.n // 2 + 1
    majorities = []
    for side in (0, 1):
        members = [model.member(side, i) for i in nodes]
        large, room = f"h{side + 1}", model.graph.n - half + 1
        majority = [(half, negated(large)), *((1, member) for member in members)]
        minority = [(room, large), *((1, negated(member)) for member in members)]
        majorities.append(proof.without_loss(majority, half, [(large, "0")]))
        few = proof.without_loss(minority, room, [(large, "1")])
        proof.open_level()
        for i in nodes:
            need = model.needs[side][i]
            if need is not None:
                proof.add_up([(need, 1), (few, 1), *((place, 1) for place in model.membership[side][i : i + 1])])
        proof.refuted([negated(large)])
    proof.add_up([(place, 1) for place in [*majorities, *model.disjoint]])
    proof.clause([])


def derive_growth(model: Model, seed: Sequence[int], order: Sequence[int], proof: Proof) -> Model:
    """Derive that both sets of a violating pair have satisfied nodes in the seed, and return the model of the seed.

    Suppose that nobody of the seed is satisfied. Then nobody of ``order`` is, one by one: at most s - 1 of the earlier
    nodes are members, as all of these are exempt, and the next node needs s of them beside all later ones it hears.
    """
    for side in (0, 1):
        earlier = set(seed)
        proof.open_level()
        for v in order:
            need = model.needs[side][v]
            if need is not None and model.s > 1:
                exemptions = [(model.exemption[side][j], 1) for j in model.graph.hears[v] if j in earlier]
                proof.add_up([(need, 1), (model.budget, 1), *exemptions])
            earlier.add(v)
        proof.refuted([negated(model.satisfied(side, i)) for i in seed])
    return model.induced(seed)
