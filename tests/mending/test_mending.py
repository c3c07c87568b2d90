"""The cheapest links are the cheapest: brute force, known optima, constraints, limits, and what a result says."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustness as rb
from certificates import verify_mending
from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter
from robustness.mending import MendVerdict, certify_mending
from robustness.mending.front import links_within
from robustness.traps import find_trap
from tests.mending.brute_force import candidates, is_robust, least_cost, survives
from tests.oracles import graphs

GOALS = [
    (rb.Goal(2), is_robust(2)),
    (rb.Goal(3), is_robust(3)),
    (rb.Goal(2, 2), is_robust(2, 2)),
    *(
        (rb.Goal(survive=1, model=model), survives(1, model))
        for model in ("malicious-local", "delayed", "delayed-local")
    ),
]
IDS = [str(goal) for goal, _ in GOALS]


def connected(n: int) -> list[nx.Graph]:
    return [network for graph in graphs(n) if nx.is_connected(network := graph.to_networkx())]


def assert_least(graph: nx.Graph, goal: rb.Goal, least: int | None) -> None:
    found = rb.mend(graph, goal)
    if least is None:
        assert found.verdict is MendVerdict.IMPOSSIBLE
        assert found.cost is None
        return
    assert (found.verdict, found.cost, found.lower_bound) == (MendVerdict.OPTIMAL, least, least), graph.edges
    assert len(found.links) == least
    assert found.graph.arc_count == rb.Digraph.from_networkx(graph).arc_count + least * (
        1 if graph.is_directed() else 2
    )


@pytest.mark.parametrize(("goal", "condition"), GOALS, ids=IDS)
def test_every_connected_graph_on_up_to_four_nodes(goal: rb.Goal, condition: object) -> None:
    for graph in [*connected(3), *connected(4)]:
        assert_least(graph, goal, least_cost(graph, condition, candidates(graph)))


@pytest.mark.slow
@pytest.mark.parametrize(("goal", "condition"), GOALS, ids=IDS)
def test_every_connected_graph_on_five_nodes(goal: rb.Goal, condition: object) -> None:
    for graph in connected(5):
        assert_least(graph, goal, least_cost(graph, condition, candidates(graph)))


@pytest.mark.parametrize(("goal", "condition"), GOALS, ids=IDS)
def test_some_graphs_on_five_nodes_and_digraphs_on_four(goal: rb.Goal, condition: object) -> None:
    rng = random.Random(str(goal))
    for graph in rng.sample(connected(5), 4):
        assert_least(graph, goal, least_cost(graph, condition, candidates(graph)))
    for seed in range(2):
        graph = nx.gnp_random_graph(4, 0.4, seed=seed, directed=True)
        assert_least(graph, goal, least_cost(graph, condition, candidates(graph)))


def test_costs_and_candidates() -> None:
    rng = random.Random(3)
    for graph in rng.sample(connected(5), 6):
        links = candidates(graph)
        prices = {link: rng.randrange(5) for link in links}
        pool = rng.sample(links, min(len(links), 6))
        least = least_cost(graph, is_robust(2), pool, prices.__getitem__)
        found = rb.mend(graph, 2, candidates=pool, cost=prices)
        if least is None:
            assert found.verdict is MendVerdict.IMPOSSIBLE
        else:
            assert (found.verdict, found.cost) == (MendVerdict.OPTIMAL, least)
            assert set(found.links) <= set(pool)


def test_decimal_costs_are_counted_exactly() -> None:
    found = rb.mend(nx.path_graph(4), 2, cost=lambda u, v: 0.1 * abs(u - v) if abs(u - v) == 2 else 0.7)
    assert found.verdict is MendVerdict.OPTIMAL
    assert found.cost == found.lower_bound
    with pytest.raises(InvalidParameter, match="round them"):
        rb.mend(nx.path_graph(4), 2, cost=lambda u, v: 1 / 3)


class TestKnownOptima:
    @pytest.mark.parametrize("n", [3, 4, 5, 6, pytest.param(7, marks=pytest.mark.slow)])
    def test_fewest_links_of_a_2_2_robust_network_from_nothing(self, n: int) -> None:
        assert rb.mend(nx.empty_graph(n), (2, 2)).cost == 2 * n - 3

    @pytest.mark.parametrize(("name", "links"), [("polska", 1), ("nobel-us", 2), ("geant", 2), ("atlanta", 2)])
    def test_backbones(self, name: str, links: int) -> None:
        pytest.importorskip("topohub")
        found = rb.mend(rb.read_topology(f"topohub:sndlib/{name}"), 2)
        assert (found.verdict, found.cost) == (MendVerdict.OPTIMAL, links)
        assert rb.is_r_robust(found.graph, 2)

    def test_largest_r_on_2r_minus_1_nodes(self) -> None:
        for r in (1, 2, 3):
            assert rb.mend(nx.empty_graph(2 * r - 1), r).cost == 3 * r * (r - 1) // 2


class TestConstraints:
    def test_forbidden_and_required(self) -> None:
        free = rb.mend(nx.path_graph(5), 2)
        forced = rb.mend(nx.path_graph(5), 2, mandatory=[(0, 2), (1, 3)])
        assert {(0, 2), (1, 3)} <= set(forced.links)
        barred = rb.mend(nx.path_graph(5), 2, forbid=free.links)
        assert not set(barred.links) & set(free.links)
        with pytest.raises(InvalidParameter, match="both mandatory and forbidden"):
            rb.mend(nx.path_graph(5), 2, mandatory=[(0, 2)], forbid=[(2, 0)])

    def test_caps_on_what_a_node_hears(self) -> None:
        found = rb.mend(nx.star_graph(5), 2, max_in_degree=3)
        assert found.verdict is MendVerdict.OPTIMAL
        gained = {v for link in found.links for v in link}
        assert all(len(found.graph.in_neighbours(i)) <= 3 for i in found.graph.ids(gained))
        assert rb.mend(nx.path_graph(6), 3, max_in_degree=2).verdict is MendVerdict.IMPOSSIBLE

    def test_one_way_links_on_an_undirected_network(self) -> None:
        found = rb.mend(nx.path_graph(4), 2, one_way=True)
        both = rb.mend(nx.path_graph(4), 2)
        assert found.one_way
        assert both.cost is not None
        assert found.cost is not None
        assert both.cost <= found.cost <= 2 * both.cost
        assert found.graph.directed
        arcs = {arc for u, v in nx.path_graph(4).edges for arc in ((u, v), (v, u))} | set(found.links)
        assert set(found.graph.to_networkx().edges) == arcs
        assert not found.before.directed

    def test_no_network_is_undirected_that_has_an_arc_one_way(self) -> None:
        assert rb.Digraph("ab", [("a", "b")], directed=False).directed
        assert not rb.Digraph("ab", [("a", "b"), ("b", "a")], directed=False).directed
        assert rb.Digraph("ab", [("a", "b"), ("b", "a")]).directed

    def test_radio_range(self) -> None:
        places = {k: (float(k), 0.0) for k in range(6)}
        near = rb.mend(nx.path_graph(6), 2, candidates=links_within(places, 2.0))
        assert near.verdict is MendVerdict.OPTIMAL
        assert all(abs(u - v) == 2 for u, v in near.links)
        assert rb.mend(nx.path_graph(6), 3, candidates=links_within(places, 2.0)).witness is not None

    def test_several_goals(self) -> None:
        found = rb.mend(nx.path_graph(5), [rb.Goal(2, 2), rb.Goal(survive=1, model="malicious-local")])
        assert rb.is_rs_robust(found.graph, 2, 2)
        assert not find_trap(found.graph, 1, faces=1, local=True).decided()


class TestImpossible:
    def test_what_no_candidate_breaks_is_shown(self) -> None:
        found = rb.mend(nx.path_graph(4), 3)
        assert found.verdict is MendVerdict.IMPOSSIBLE
        assert found.witness is not None
        assert found.witness.S1
        assert found.witness.S2
        assert "impossible" in found.summary()

    def test_one_node(self) -> None:
        assert rb.mend(nx.empty_graph(1), 1).verdict is MendVerdict.OPTIMAL
        assert rb.mend(nx.empty_graph(1), 2).verdict is MendVerdict.IMPOSSIBLE
        assert rb.mend(nx.empty_graph(0), 0).cost == 0


def test_a_limit_leaves_checked_links_and_a_bound_that_holds() -> None:
    network = nx.path_graph(16)
    found = rb.mend(network, 3, time_limit=2)
    assert found.verdict in (MendVerdict.FEASIBLE, MendVerdict.UNDECIDED)
    assert found.reason
    if found.cost is not None:
        assert rb.is_r_robust(found.graph, 3)
        assert found.lower_bound <= found.cost


def test_improvements_are_told_and_only_improve() -> None:
    told: list[rb.MendResult] = []
    found = rb.mend(nx.path_graph(6), (2, 2), on_improvement=told.append)
    costs = [each.cost for each in told if each.cost is not None]
    bounds = [each.lower_bound for each in told]
    assert costs == sorted(costs, reverse=True)
    assert bounds == sorted(bounds)
    assert found.cost == 4


@settings(max_examples=25)
@given(st.integers(2, 7), st.integers(0, 10**6), st.sampled_from([(2, 1), (2, 2), (3, 1)]))
def test_a_mended_graph_is_robust_and_no_link_of_it_is_superfluous(n: int, seed: int, goal: tuple[int, int]) -> None:
    graph = nx.gnp_random_graph(n, 0.5, seed=seed)
    if goal[0] > -(-n // 2) or goal[1] > n:
        return
    found = rb.mend(graph, goal, seed=seed)
    assert found.verdict is MendVerdict.OPTIMAL
    assert rb.check_rs_robustness(found.graph, *goal, algorithm="exhaustive").verdict is rb.Verdict.ROBUST
    for link in found.links:
        less = found.graph.to_networkx()
        less.remove_edge(*link)
        assert not rb.is_rs_robust(less, *goal)


class TestThin:
    def test_against_every_set_of_links(self) -> None:
        for graph in random.Random(4).sample(connected(5), 6):
            for goal, condition in GOALS[:3]:
                least = least_cost(nx.empty_graph(5), condition, list(graph.edges))
                found = rb.thin(graph, goal)
                if least is None:
                    assert found.verdict is MendVerdict.IMPOSSIBLE
                else:
                    assert (found.verdict, found.cost) == (MendVerdict.OPTIMAL, least)
                    assert len(found.links) + len(found.dropped) == graph.number_of_edges()
                    assert condition(found.graph)

    def test_links_that_stay(self) -> None:
        kept = [(0, 1), (0, 2), (0, 3), (0, 4)]
        found = rb.thin(nx.complete_graph(6), 2, keep=kept)
        assert set(kept) <= set(found.links)
        with pytest.raises(InvalidParameter, match="is not in the network"):
            rb.thin(nx.path_graph(3), 1, keep=[(0, 2)])


class TestMargin:
    @pytest.mark.parametrize(("goal", "condition"), GOALS, ids=IDS)
    def test_against_every_loss_of_links(self, goal: rb.Goal, condition: object) -> None:
        for graph in random.Random(5).sample(connected(5), 8):
            losses = next(
                (
                    count
                    for count in range(graph.number_of_edges() + 1)
                    for lost in itertools.combinations(graph.edges, count)
                    if not condition(rb.Digraph.from_networkx(nx.restricted_view(graph, [], lost)))  # type: ignore[operator]
                ),
                None,
            )
            found = rb.margin(graph, goal)
            assert found.is_exact
            assert found.losses == losses, (graph.edges, str(goal))
            after = graph.copy()
            after.remove_edges_from(found.links)
            assert not condition(rb.Digraph.from_networkx(after))  # type: ignore[operator]

    def test_against_every_loss_of_nodes(self) -> None:
        for graph in random.Random(6).sample(connected(6), 8):
            for r in (1, 2):
                losses = next(
                    (
                        count
                        for count in range(5)
                        for lost in itertools.combinations(graph, count)
                        if not is_robust(r)(rb.Digraph.from_networkx(graph.subgraph(set(graph) - set(lost))))
                    ),
                    None,
                )
                found = rb.margin(graph, r, of="nodes")
                assert (found.losses, found.is_exact) == (losses, True), (graph.edges, r)

    def test_words(self) -> None:
        assert rb.margin(nx.path_graph(4), 2).losses == 0
        assert "no fewer" in rb.margin(nx.complete_graph(5), 2).summary()
        with pytest.raises(InvalidParameter, match="'links' or 'nodes'"):
            rb.margin(nx.path_graph(4), 2, of="hopes")


@pytest.mark.parametrize("goal", [None, "2", (1.5, 2), rb.Goal, []])
def test_goals_that_cannot_be_meant(goal: object) -> None:
    with pytest.raises(InvalidParameter, match="a goal is"):
        rb.mend(nx.path_graph(4), goal)


def test_the_certificate_of_a_result() -> None:
    found = rb.mend(nx.path_graph(5), 2)
    assert found.certificate == certify_mending(found)
    thinned = rb.thin(nx.complete_graph(4), 2)
    assert verify_mending(as_digraph(nx.empty_graph(4)).canonical_bytes(), thinned.certificate or b"").least == 5
    assert replace(found, certify=None).certificate is None


def test_misuse() -> None:
    for wrong in ({}, {"r": -1}, {"r": 2, "s": 0}, {"survive": -1}, {"survive": 1, "model": "friendly"}):
        with pytest.raises(InvalidParameter):
            rb.Goal(**wrong)  # type: ignore[arg-type]
    with pytest.raises(InvalidParameter, match="a cost is"):
        rb.mend(nx.path_graph(4), 2, cost=lambda u, v: -1)
    with pytest.raises(TypeError, match="no truth value"):
        bool(rb.mend(nx.path_graph(4), 2))
    with pytest.raises(TypeError):
        rb.mend(nx.path_graph(4), 2, timeout=1)  # type: ignore[call-arg]


def test_caps_for_each_node_against_every_set_of_links() -> None:
    rng = random.Random(8)
    for _ in range(6):
        graph = nx.gnp_random_graph(5, 0.4, seed=rng.randrange(1000))
        caps = {i: rng.randint(1, 4) for i in graph if rng.random() < 0.7}

        def within(digraph: rb.Digraph, graph: nx.Graph = graph, caps: dict[int, int] = caps) -> bool:
            gained = [i for i in graph if len(digraph.in_neighbours(*digraph.ids([i]))) > graph.degree(i)]
            return is_robust(2)(digraph) and all(
                len(digraph.in_neighbours(*digraph.ids([i]))) <= caps.get(i, 4) for i in gained
            )

        least = least_cost(graph, within, candidates(graph))
        found = rb.mend(graph, 2, max_in_degree=caps)
        assert found.verdict is (MendVerdict.IMPOSSIBLE if least is None else MendVerdict.OPTIMAL)
        assert found.cost == least


@pytest.mark.parametrize("caps", [-1, 1.5, True, {0: -1}, {0: "2"}])
def test_caps_that_cannot_be_meant(caps: object) -> None:
    with pytest.raises(InvalidParameter, match="max_in_degree is"):
        rb.mend(nx.path_graph(4), 2, max_in_degree=caps)  # type: ignore[arg-type]
