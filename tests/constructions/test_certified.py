"""A derivation becomes a certificate that the kernel accepts, with the seed searched and nothing else."""

from __future__ import annotations

import random

import networkx as nx
import pytest

from certificates import verify
from robustness import Digraph
from robustness.constructions import operations
from robustness.constructions.certified import certify_derivation
from robustness.constructions.guarantee import Guarantee, Guaranteed
from robustness.constructions.operations import (
    add_arcs,
    add_node,
    blow_up,
    grow,
    guaranteed,
    join_clique,
    remove_in_arcs,
    remove_nodes,
    union,
    weaken,
)
from robustness.errors import InvalidParameter, Undecided

CYCLE = nx.cycle_graph(6)
K7 = nx.complete_graph(7)
DIRECTED = nx.gnp_random_graph(7, 0.8, seed=2, directed=True)


def chain() -> Guaranteed:
    """Return a graph made by one operation of every kind that fits."""
    made = remove_in_arcs(guaranteed(K7), [(0, 1), (2, 3)])
    made = add_node(weaken(made, 2, 2), "7", hears=[0, 2, 4, 6])
    made = add_arcs(made, [("7", 1)])
    made = remove_nodes(grow(made, 12, seed=1), [3])
    return blow_up(join_clique(made, 2), 2, cliques=True)


@pytest.mark.parametrize(
    ("seeds", "made"),
    [
        ([K7], guaranteed(K7)),
        ([K7], weaken(guaranteed(K7), 2, 3)),
        ([CYCLE], add_arcs(guaranteed(CYCLE), [(0, 3), (0, 1)])),
        ([CYCLE, nx.complete_graph(6)], union(guaranteed(CYCLE), guaranteed(nx.complete_graph(6)))),
        ([K7], remove_in_arcs(guaranteed(K7), [(0, 1), (2, 3)])),
        ([K7], remove_nodes(guaranteed(K7), [5, 0])),
        ([K7], add_node(guaranteed(K7), "0", hears=[0, 1, 2])),
        ([K7], grow(guaranteed(K7, 2, 2), 12, seed=3)),
        ([K7], grow(guaranteed(K7), 7)),
        ([CYCLE], join_clique(guaranteed(CYCLE), 2)),
        ([nx.complete_graph(2)], join_clique(guaranteed(nx.complete_graph(2)), 1)),
        ([CYCLE], blow_up(guaranteed(CYCLE), 3)),
        ([CYCLE], blow_up(guaranteed(CYCLE), 2, cliques=True)),
        ([nx.empty_graph(1)], blow_up(guaranteed(nx.empty_graph(1)), 5, cliques=True)),
        ([DIRECTED], add_node(guaranteed(DIRECTED), 9, hears=[0, 1, 5], heard_by=[2])),
        ([DIRECTED], grow(remove_in_arcs(guaranteed(DIRECTED), list(DIRECTED.edges)[:1]), 10)),
        ([K7], chain()),
    ],
)
def test_every_operation(seeds: list[nx.Graph], made: Guaranteed) -> None:
    canonical = Digraph.from_networkx(made.graph).canonical_bytes()
    result = certify_derivation(Guarantee.from_dict(made.guarantee.as_dict()), seeds)
    claim = verify(canonical, result.certificate)
    assert (claim.verdict, claim.r, claim.s, claim.evidence) == (
        "robust",
        made.guarantee.r,
        made.guarantee.s,
        "derivation",
    )
    if made.guarantee.r > 1:
        smaller = certify_derivation(made.guarantee, seeds, made.guarantee.r - 1)
        assert verify(canonical, smaller.certificate).r == made.guarantee.r - 1


def test_a_pair_that_few_nodes_cut_is_cut_in_the_certificate_too() -> None:
    """K_3 without a node is (1,2)-robust, as it has two nodes; Lemma 1 alone would go on with (1,3)."""
    seed = nx.complete_graph(3)
    made = add_node(remove_nodes(guaranteed(seed), [0]), 9, hears=[1, 2])
    result = certify_derivation(made.guarantee, [seed])
    assert (result.r, result.s) == (made.guarantee.r, made.guarantee.s) == (1, 2)


def random_step(made: Guaranteed, draw: random.Random) -> Guaranteed:
    """Return what some operation makes of the graph, whichever fits."""
    graph = made.graph
    nodes, fresh = list(graph), 100 + draw.randrange(10**6)
    match draw.randrange(7):
        case 0:
            return remove_nodes(made, draw.sample(nodes, draw.randrange(1, max(2, len(nodes) - 1))))
        case 1:
            heard = draw.sample(nodes, draw.randrange(1, len(nodes) + 1))
            return add_node(made, fresh, hears=heard)
        case 2:
            return join_clique(made, draw.randrange(1, 3))
        case 3:
            return blow_up(made, 2, cliques=draw.random() < 0.5) if len(nodes) < 10 else made
        case 4:
            arcs = list(graph.edges)
            return remove_in_arcs(made, draw.sample(arcs, min(len(arcs), draw.randrange(1, 3))))
        case 5:
            return weaken(made, draw.randint(1, made.guarantee.r), 1)
        case _:
            return grow(made, len(nodes) + draw.randrange(3), seed=draw.randrange(100))


@pytest.mark.parametrize("number", range(60))
def test_every_chain_of_operations_that_guarantees_something_certifies(number: int) -> None:
    draw = random.Random(number)
    n = draw.randrange(2, 7)
    seed = nx.gnp_random_graph(n, draw.choice((0.8, 1.0)), seed=number, directed=number % 3 == 0)
    made = guaranteed(seed)
    certified = 0
    for _ in range(6):
        if made.guarantee.r < 1 or len(made.graph) < 2:
            break
        result = certify_derivation(made.guarantee, [seed])
        claim = verify(Digraph.from_networkx(made.graph).canonical_bytes(), result.certificate)
        assert (claim.verdict, claim.r, claim.s) == ("robust", made.guarantee.r, made.guarantee.s)
        certified += 1
        made = random_step(made, draw)
    assert certified or guaranteed(seed).guarantee.r < 1


def test_only_the_seed_is_searched() -> None:
    """Two hundred nodes, where a search would be hopeless: the blow-up is 25-robust by its seed."""
    seed = nx.gnp_random_graph(20, 0.5, seed=1)
    made = blow_up(guaranteed(seed), 10)
    result = certify_derivation(made.guarantee, [seed])
    assert result.r == 25
    assert len(result.certificate) < 5_000


def test_a_union_follows_its_better_half() -> None:
    """The other half is carried out too, but its steps do not appear."""
    strong, weak = guaranteed(nx.complete_graph(6)), add_arcs(guaranteed(CYCLE), [(0, 2)])
    made = union(weak, strong)
    result = certify_derivation(made.guarantee, [CYCLE, nx.complete_graph(6)])
    assert result.stats["steps"] == 0


@pytest.mark.parametrize(("r", "s"), [(5, 1), (4, 8), (0, 1), (1, 0)])
def test_what_does_not_follow_is_not_certified(r: int, s: int) -> None:
    with pytest.raises(InvalidParameter, match="does not follow"):
        certify_derivation(guaranteed(K7).guarantee, [K7], r, s)


def test_a_missing_seed_and_a_derivation_through_nothing() -> None:
    with pytest.raises(InvalidParameter, match=r"seed graph .* is missing"):
        certify_derivation(chain().guarantee, [CYCLE])
    lost = remove_in_arcs(guaranteed(CYCLE), [(0, 1)])
    with pytest.raises(InvalidParameter, match="proves nothing from there"):
        certify_derivation(join_clique(lost, 3).guarantee, [CYCLE])


def test_a_forged_derivation_is_refused() -> None:
    made = add_arcs(guaranteed(CYCLE), [(0, 3)])
    forged = Guarantee(2, 1, "add-arcs", made.guarantee.parameters, made.guarantee.premises, made.guarantee.sha256)
    with pytest.raises(InvalidParameter, match="carrying it out gives"):
        certify_derivation(forged, [CYCLE])
    leaf = Guarantee(2, 1, "checked", {}, (), made.guarantee.premises[0].sha256)
    with pytest.raises(Undecided, match="it is not, or"):
        certify_derivation(leaf, [CYCLE])


def test_every_rule_is_known() -> None:
    """An operation that is added has to be taught here."""
    assert set(operations.OPERATIONS) == {
        "weaken", "add-arcs", "union", "remove-in-arcs", "remove-nodes", "add-node", "grow", "join-clique", "blow-up",
    }  # fmt: skip
