"""Every bound against the exact value, and every piece of evidence re-checked without the code that made it."""

from __future__ import annotations

import functools
import itertools
from fractions import Fraction

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from networkx.generators.atlas import graph_atlas_g

import robustness as rb
from robustness.answers import Answer, Question
from robustness.decision.algorithms import exhaustive
from robustness.decision.algorithms.transform import largest_s
from robustness.decision.bounds import all_bounds, bounds, settle
from robustness.decision.bounds.cuts import closed_pair, degree_pair, separating_pair
from robustness.decision.bounds.degree import degree_bound, robust_by_degree
from robustness.decision.bounds.growth import find_growth, growth_order
from robustness.decision.bounds.spectral import is_positive_definite, prove_lambda_2_above, spectral_evidence
from robustness.decision.front import robustness_profile
from robustness.definitions import half_split, is_violation
from robustness.evidence import DegreeRule, Growth, Pair, Spectral
from robustness.limits import Limits, Steps
from robustness.results import Verdict

DEFINED = Limits()


def digraph(graph: nx.Graph) -> rb.Digraph:
    return rb.Digraph.from_networkx(graph)


def arcs_of(n: int, code: int) -> list[tuple[int, int]]:
    places = [(i, j) for i in range(n) for j in range(n) if i != j]
    return [place for k, place in enumerate(places) if code >> k & 1]


@functools.cache
def small_graphs() -> tuple[tuple[rb.Digraph, dict[int, int]], ...]:
    """All graphs on 2..6 nodes and all digraphs on 2..4 nodes (n = 4: every fifth), with their exact profiles."""
    graphs = [digraph(graph) for graph in graph_atlas_g()[2:209]]
    graphs += [rb.Digraph(range(n), arcs_of(n, code)) for n in (2, 3) for code in range(1 << n * (n - 1))]
    graphs += [rb.Digraph(range(4), arcs_of(4, code)) for code in range(0, 1 << 12, 5)]
    return tuple((graph, exact_profile(graph)) for graph in graphs)


def exact_profile(graph: rb.Digraph) -> dict[int, int]:
    return dict(robustness_profile(graph, algorithm="transform"))


def r_star(profile: dict[int, int]) -> int:
    return max((r for r, s in profile.items() if s), default=0)


def seed_is_robust(graph: rb.Digraph, seed: tuple[int, ...], r: int, s: int) -> bool:
    """Decide (r,s)-robustness of the induced seed by definition, or by the degree rule written again."""
    place = {node: k for k, node in enumerate(seed)}
    arcs = [(place[j], place[i]) for i in seed for j in graph.in_neighbours(i).tolist() if j in place]
    induced = rb.Digraph(range(len(seed)), arcs)
    if all(d >= len(seed) // 2 + r - 1 for d in induced.in_degrees.tolist()):
        return True
    known = exact_profile(induced).get(r, 0)
    # s > n asks that no pair passes by its exempt nodes alone, which s_max = n does not exclude on its own.
    return known >= s if s <= len(seed) else False


def require_growth(graph: rb.Digraph, growth: Growth, r: int, s: int) -> None:
    assert (growth.r, growth.s) == (r, s)
    order = growth.order.tolist()
    assert sorted([*growth.seed, *order]) == list(range(graph.n))
    present = set(growth.seed)
    for node in order:
        assert len(present & set(graph.in_neighbours(node).tolist())) >= r + s - 1
        present.add(node)
    if growth.seed_proof == "node":
        assert (r, s, len(growth.seed)) == (1, 1, 1)
    else:
        assert seed_is_robust(graph, growth.seed, r, s) or s > len(growth.seed)


def require_settled(graph: rb.Digraph, settled: Answer, r: int, s: int) -> None:
    if settled.verdict is Verdict.NOT_ROBUST:
        assert settled.pair is not None
        assert is_violation(graph, *settled.pair, r, s)
    elif isinstance(settled.evidence, Growth):
        require_growth(graph, settled.evidence, r, s)
    elif isinstance(settled.evidence, Spectral):
        assert settled.evidence.r >= r + s - 1
        assert settled.evidence.mu == 2 * (settled.evidence.r - 1)
    else:
        assert isinstance(settled.evidence, DegreeRule)
        assert min(graph.in_degrees) >= graph.n // 2 + r - 1


class TestAgainstTheTruth:
    def test_the_front_never_contradicts_an_exact_value(self) -> None:
        for graph, profile in small_graphs():
            both = bounds(graph)
            assert both.lower.value <= r_star(profile) <= both.upper.value
            assert both.upper.witness is not None
            sides = (graph.ids(both.upper.witness.S1), graph.ids(both.upper.witness.S2))
            assert is_violation(graph, *sides, both.upper.value + 1, 1)

    def test_whatever_is_settled_is_true(self) -> None:
        settled = 0
        for graph, profile in small_graphs():
            for r, s in itertools.product(profile, (1, 2, graph.n)):
                found = settle(Question(graph, r, s), Limits())
                if found is not None:
                    settled += 1
                    require_settled(graph, found, r, s)
                    assert (found.verdict is Verdict.ROBUST) == (profile[r] >= s)
        assert settled > 2000

    def test_the_degree_rule_on_small_graphs(self) -> None:
        for graph, profile in small_graphs():
            assert degree_bound(graph).value <= r_star(profile)
            for r, s in profile.items():
                assert not robust_by_degree(graph, r) or s == graph.n

    def test_one_robustness_is_decided(self) -> None:
        for graph, profile in small_graphs():
            pair = closed_pair(graph)
            assert (pair is None) == (profile[1] >= 1)
            assert pair is None or is_violation(graph, *pair, 1, 1)

    def test_structural_pairs_violate(self) -> None:
        for graph, profile in small_graphs():
            assert is_violation(graph, *half_split(graph), (graph.n + 1) // 2 + 1, 1)
            least = max(1, int(graph.in_degrees.min()))
            pair = degree_pair(graph, least + 1)
            assert pair is not None
            assert is_violation(graph, *pair, least + 1, 1)
            separated = separating_pair(graph)
            assert separated is None or (is_violation(graph, *separated, 2, 1) and r_star(profile) <= 1)

    def test_growth_and_spectrum_on_small_graphs(self) -> None:
        for graph, profile in small_graphs():
            spectral = spectral_evidence(graph)
            assert spectral is None or spectral.r <= r_star(profile)
            for r, s in itertools.product(profile, (1, 2)):
                growth = find_growth(graph, r, s) if s <= graph.n else None
                if growth is not None:
                    require_growth(graph, growth, r, s)
                    assert profile[r] >= s

    def test_a_seed_that_an_old_pair_refutes_is_not_examined_again(self, monkeypatch: pytest.MonkeyPatch) -> None:
        examined: list[int] = []

        def note(graph: rb.Digraph, r: int, limits: Limits) -> tuple[int, Pair | None]:
            examined.append(graph.n)
            return largest_s(graph, r, limits)

        monkeypatch.setattr("robustness.decision.bounds.growth.largest_s", note)
        # From each of 20 anchors the seeds have 9, 10, ... 16 nodes and none is robust.
        assert find_growth(digraph(nx.random_regular_graph(9, 20, seed=1)), 5, 5) is None
        assert 0 < len(examined) < 3 * 20

    def test_a_spent_budget_examines_nothing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robustness.decision.bounds.growth.largest_s", None)
        assert find_growth(digraph(nx.random_regular_graph(9, 20, seed=1)), 5, 5, steps=Steps(20_000_000)) is None

    @settings(max_examples=40, deadline=None)
    @given(st.integers(7, 12), st.sampled_from([0.3, 0.5, 0.7, 0.9]), st.integers(0, 2**32 - 1), st.booleans())
    def test_random_graphs(self, n: int, density: float, seed: int, directed: bool) -> None:
        graph = digraph(nx.gnp_random_graph(n, density, seed=seed, directed=directed))
        profile = exact_profile(graph)
        lower, upper = all_bounds(graph)
        assert all(bound.value <= r_star(profile) for bound in lower)
        assert all(bound.value >= r_star(profile) and bound.witness is not None for bound in upper)
        for r, s in itertools.product(profile, (1, 2, 3)):
            growth = find_growth(graph, r, s)
            if growth is not None:
                require_growth(graph, growth, r, s)
                assert profile[r] >= s
        spectral = spectral_evidence(graph)
        assert spectral is None or spectral.r <= r_star(profile)

    @settings(max_examples=15, deadline=None)
    @given(st.integers(13, 16), st.sampled_from([0.3, 0.6, 0.8]), st.integers(0, 2**32 - 1), st.booleans())
    def test_random_graphs_large_enough_for_every_technique(
        self, n: int, density: float, seed: int, directed: bool
    ) -> None:
        graph = digraph(nx.gnp_random_graph(n, density, seed=seed, directed=directed))
        profile = exact_profile(graph)
        both = bounds(graph)
        assert both.lower.value <= r_star(profile) <= both.upper.value
        for r, s in itertools.product(profile, (1, 2)):
            found = settle(Question(graph, r, s), Limits())
            if found is not None:
                require_settled(graph, found, r, s)
                assert (found.verdict is Verdict.ROBUST) == (profile[r] >= s)


class TestDegree:
    @pytest.mark.parametrize("n", range(2, 9))
    def test_complete_graphs_meet_it(self, n: int) -> None:
        assert degree_bound(digraph(nx.complete_graph(n))).value == (n + 1) // 2

    def test_one_arc_less_and_the_premise_fails(self) -> None:
        graph = nx.complete_graph(5)
        graph.remove_edge(0, 1)
        assert robust_by_degree(digraph(nx.complete_graph(5)), 3)
        assert not robust_by_degree(digraph(graph), 3)

    def test_it_agrees_with_the_definition(self) -> None:
        graph = digraph(nx.complete_multipartite_graph(2, 2, 2))
        assert degree_bound(graph).value == 2
        assert all(exhaustive.decide(graph, 2, s, DEFINED).verdict is Verdict.ROBUST for s in range(1, 7))


class TestGrowth:
    @pytest.mark.parametrize(
        ("graph", "r"),
        [
            (nx.wheel_graph(30), 2),
            (nx.circulant_graph(40, [1, 2, 3]), 3),
            (nx.circulant_graph(60, [1, 2, 3, 4, 5]), 5),
            (nx.complete_bipartite_graph(4, 7), 4),
            (nx.gnp_random_graph(60, 0.5, seed=1), 6),
            (nx.gnp_random_graph(40, 0.4, seed=2, directed=True), 3),
            (nx.barabasi_albert_graph(300, 4, seed=1, initial_graph=nx.complete_graph(5)), 3),
        ],
        ids=str,
    )
    def test_seeds_are_found_and_grow(self, graph: nx.Graph, r: int) -> None:
        growth = find_growth(digraph(graph), r)
        assert growth is not None
        require_growth(digraph(graph), growth, r, 1)

    def test_s_above_one(self) -> None:
        graph = digraph(nx.gnp_random_graph(40, 0.7, seed=1))
        growth = find_growth(graph, 2, 3)
        assert growth is not None
        require_growth(graph, growth, 2, 3)

    def test_a_seed_that_stops_short_proves_nothing(self) -> None:
        # Two triangles joined by one link: each is 2-robust, and neither hears enough of the other.
        graph = digraph(nx.barbell_graph(3, 0))
        assert find_growth(graph, 2) is None
        assert growth_order(graph, 2, [0, 1, 2]) is None
        assert growth_order(graph, 1, [0, 1, 2]) == [3, 4, 5]

    def test_a_seed_that_is_everything_needs_no_order(self) -> None:
        assert growth_order(digraph(nx.complete_graph(3)), 2, [0, 1, 2]) == []


class TestSpectral:
    """lambda_2 is an even integer in all of these: a float that rounds up would claim one r too many."""

    @pytest.mark.parametrize(
        ("graph", "lambda_2"),
        [
            *((nx.complete_graph(n), n) for n in range(2, 24)),
            *((nx.convert_node_labels_to_integers(nx.hypercube_graph(d)), 2) for d in range(1, 8)),
            (nx.petersen_graph(), 2),
            (nx.complete_bipartite_graph(6, 6), 6),
            (nx.complete_multipartite_graph(*[2] * 9), 16),
            (nx.complete_multipartite_graph(4, 4, 4), 8),
            (nx.hoffman_singleton_graph(), 5),
            (nx.star_graph(9), 1),
            (nx.disjoint_union(nx.complete_graph(4), nx.complete_graph(4)), 0),
        ],
        ids=str,
    )
    def test_integer_eigenvalues(self, graph: nx.Graph, lambda_2: int) -> None:
        found = spectral_evidence(digraph(graph))
        assert (found.r if found else 0) == (lambda_2 + 1) // 2
        laplacian = laplacian_of(graph)
        assert lambda_2 == graph.number_of_nodes() or not prove_lambda_2_above(laplacian, lambda_2)
        assert lambda_2 == 0 or prove_lambda_2_above(laplacian, lambda_2 - 1)

    @pytest.mark.parametrize("seed", range(6))
    def test_the_float_proof_agrees_with_exact_elimination(self, seed: int) -> None:
        graph = nx.gnp_random_graph(18, 0.5, seed=seed)
        laplacian = laplacian_of(graph)
        for mu in range(18):
            matrix = (laplacian + 1 - mu * np.eye(18)).astype(int).tolist()
            assert prove_lambda_2_above(laplacian, mu) == is_positive_definite(matrix) == minors_positive(matrix)

    def test_only_links_both_ways_count(self) -> None:
        assert spectral_evidence(digraph(nx.DiGraph([(0, 1), (1, 2), (2, 0)]))) is None
        both_ways = nx.complete_graph(6).to_directed()
        both_ways.remove_edge(0, 1)
        found = spectral_evidence(digraph(both_ways))
        assert found is not None
        assert found.r <= r_star(exact_profile(digraph(both_ways)))

    def test_larger_graphs(self) -> None:
        graph = digraph(nx.random_regular_graph(10, 200, seed=1))
        assert spectral_evidence(graph) == Spectral(3, 4)


def laplacian_of(graph: nx.Graph) -> np.ndarray:
    adjacent = nx.to_numpy_array(graph)
    return np.diag(adjacent.sum(axis=1)) - adjacent


def minors_positive(matrix: list[list[int]]) -> bool:
    """Sylvester's criterion with fractions, as a second opinion."""
    rows = [[Fraction(x) for x in row] for row in matrix]
    for k in range(len(rows)):
        if rows[k][k] <= 0:
            return False
        for i in range(k + 1, len(rows)):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    return True


class TestFront:
    def test_fewer_than_two_nodes(self) -> None:
        for n in (0, 1):
            both = bounds(rb.Digraph(range(n), []))
            assert both.lower.value == both.upper.value == n

    @pytest.mark.parametrize("n", [2, 3, 5, 20, 200])
    def test_no_arcs(self, n: int) -> None:
        both = bounds(rb.Digraph(range(n), []))
        assert both.lower.value == both.upper.value == 0
        assert both.upper.witness is not None

    def test_improvements_are_reported_as_they_come(self) -> None:
        seen: list[rb.Bounds] = []
        final = bounds(digraph(nx.gnp_random_graph(40, 0.5, seed=1)), on_bounds=seen.append)
        assert seen[-1] == final
        for a, b in itertools.pairwise(seen):
            assert a.lower.value <= b.lower.value <= b.upper.value <= a.upper.value
        assert final.upper.value == 10
        assert final.lower.value >= 6

    @pytest.mark.parametrize(
        ("graph", "robustness"),
        [
            (nx.complete_graph(40), 20),
            (nx.circulant_graph(50, [1, 2, 3]), 3),
            (nx.random_labeled_tree(200, seed=1), 1),
            (nx.wheel_graph(50), 2),
            (nx.barbell_graph(20, 0), 1),
            (nx.complete_multipartite_graph(*[2] * 10), 9),
        ],
        ids=str,
    )
    def test_bounds_that_meet(self, graph: nx.Graph, robustness: int) -> None:
        both = bounds(digraph(graph))
        assert (both.lower.value, both.upper.value) == (robustness, robustness)

    def test_all_bounds_name_their_reasons(self) -> None:
        lower, upper = all_bounds(digraph(nx.gnp_random_graph(30, 0.5, seed=1)))
        assert {bound.reason.split(":")[0] for bound in lower} >= {"a node reaches all others", "growth", "spectral"}
        assert len(upper) == 3
        assert all(bound.witness is not None for bound in upper)


class TestLargeGraphs:
    """No matrix, no masks: 50,000 nodes in linear memory."""

    @pytest.mark.parametrize(
        ("graph", "r", "verdict"),
        [
            (lambda: nx.circulant_graph(50_000, [1, 2]), 2, Verdict.ROBUST),
            (lambda: nx.circulant_graph(50_000, [1, 2]), 3, Verdict.NOT_ROBUST),
            (lambda: nx.gnm_random_graph(50_000, 125_000, seed=1), 2, Verdict.NOT_ROBUST),
            (lambda: nx.grid_2d_graph(200, 250), 2, Verdict.NOT_ROBUST),
            (lambda: nx.path_graph(50_000), 1, Verdict.ROBUST),
        ],
    )
    def test_settled(self, graph: object, r: int, verdict: Verdict) -> None:
        large = digraph(graph())  # type: ignore[operator]
        found = settle(Question(large, r, 1), Limits())
        assert found is not None
        assert found.verdict is verdict
        if found.pair is not None:
            assert violates(large, found.pair, r)
        assert not {"in_words", "in_masks"} & set(vars(large))


def violates(graph: rb.Digraph, pair: tuple[frozenset[int], frozenset[int]], r: int) -> bool:
    """Check a large pair against the definition of r-robustness, arc by arc."""
    for side in pair:
        outside = dict.fromkeys(side, 0)
        for u, v in graph.arcs():
            if v in side and u not in side:
                outside[v] += 1
        if not side or max(outside.values()) >= r:
            return False
    return not pair[0] & pair[1]
