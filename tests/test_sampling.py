"""Samples: the theorem against every sample of small networks, and the errors of the test, counted."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner

import robustness as rb
from cli import interruption
from cli.main import robustness as program
from robustness.constructions.small_graphs import digraph_of_masks, digraphs_up_to_isomorphism, graphs_up_to_isomorphism
from robustness.digraph import Digraph, as_digraph
from robustness.sampling import SampleVerdict, chance_of_error, sample_robustness
from robustness.sampling.chance import greatest_claim, least_needed
from tests.oracles import brute_profile


def r_star(graph: Digraph) -> int:
    return max((r for r, s in brute_profile(graph).items() if s >= 1), default=0)


def induced(graph: Digraph, nodes: tuple[int, ...]) -> Digraph:
    place = {i: k for k, i in enumerate(nodes)}
    return Digraph(range(len(nodes)), [(place[u], place[v]) for u, v in graph.arcs() if u in place and v in place])


def assert_theorem(graph: Digraph, known: dict[Any, int]) -> int:
    """Every r that the graph has not, every size of samples, every q: the exact share of samples is below the bound."""
    n, least, tight = graph.n, int(graph.in_degrees.min()), 0
    own = r_star(graph)
    for t in range(2, n + 1):
        values = []
        for nodes in combinations(range(n), t):
            part = induced(graph, nodes)
            key = part.n, tuple(part.arcs())
            if key not in known:
                known[key] = r_star(part)
            values.append(known[key])
        for q in range(1, (t + 1) // 2 + 2):
            share = Fraction(sum(value >= q for value in values), len(values))
            for r in range(own + 1, n + 2):
                bound = chance_of_error(n, least, r, t, 1, q)
                assert share <= bound, (graph, r, t, q)
                tight += 0 < bound < 1
    return tight


class TestTheorem:
    def test_every_digraph_of_four_nodes_and_graph_of_six(self) -> None:
        known: dict[Any, int] = {}
        tight = 0
        for n in range(2, 7):
            for masks in graphs_up_to_isomorphism(n):
                tight += assert_theorem(digraph_of_masks(masks, directed=False), known)
        for masks in digraphs_up_to_isomorphism(4):
            tight += assert_theorem(digraph_of_masks(masks, directed=True), known)
        assert tight >= 0

    def test_networks_for_which_the_bound_says_something(self) -> None:
        """Two cliques with few links in between: many inside, so that every sample meets both, and few outside."""
        known: dict[Any, int] = {}
        tight = 0
        for half, links, seed in ((5, 1, 1), (5, 3, 2), (6, 2, 3)):
            draw = random.Random(seed)
            made = nx.disjoint_union(nx.complete_graph(half), nx.complete_graph(half))
            made.add_edges_from((draw.randrange(half), half + draw.randrange(half)) for _ in range(links))
            graph = as_digraph(made)
            tight += assert_theorem(graph, known)
        assert tight > 50

    def test_the_bound_grows_with_r_and_falls_with_q(self) -> None:
        for n, least in ((30, 12), (9, 8), (50, 3)):
            for t in (2, 5, min(n, 12)):
                table = [[chance_of_error(n, least, r, t, 1, q) for q in range(t + 2)] for r in range(1, n + 3)]
                for row in table:
                    assert all(a >= b for a, b in pairwise(row))
                for column in zip(*table, strict=True):
                    assert all(a <= b for a, b in pairwise(column))

    def test_the_exact_numbers(self) -> None:
        """By counting: of 10 nodes, 3 outside nodes, a sample of 4 with v in it, that holds two or more of them."""
        draws = list(combinations(range(9), 3))
        tail = Fraction(sum(sum(i < 3 for i in each) >= 2 for each in draws), len(draws))
        missed = Fraction(math.comb(10 - 5, 4), math.comb(10, 4))
        assert chance_of_error(10, 7, 4, 4, 1, 2) == min(1, 4 * tail + 2 * missed)
        assert chance_of_error(10, 7, 4, 4, 3, 2) == min(1, 4 * tail + 2 * missed) ** 3

    def test_least_and_greatest_are_the_least_and_the_greatest(self) -> None:
        level = Fraction(1, 100)
        for n, least, t, k in ((400, 200, 20, 5), (60, 50, 12, 3)):
            for r in (1, 3, 8, 30):
                q = least_needed(n, least, r, t, k, level)
                fits = [p for p in range(1, (t + 1) // 2 + 1) if chance_of_error(n, least, r, t, k, p) <= level]
                assert q == (min(fits) if fits else None)
            for q in range(t // 2 + 1):
                best = greatest_claim(n, least, t, k, q, level)
                fits = [r for r in range(1, (n + 1) // 2 + 1) if chance_of_error(n, least, r, t, k, q) <= level]
                assert best == max(fits, default=0)


def halves(n: int, across: int) -> nx.Graph:
    """Two cliques; each node hears ``across`` nodes of the other: (across + 1)-robust it is not."""
    half = n // 2
    made = nx.disjoint_union(nx.complete_graph(half), nx.complete_graph(half))
    made.add_edges_from((i, half + (i + k) % half) for i in range(half) for k in range(across))
    return made

    def test_bounds_of_many_or_large_samples_are_there_at_once_and_above_the_exact_ones(self) -> None:
        """A million samples, and samples of thousands of nodes: numbers with millions of digits are not written out."""
        one = chance_of_error(1000, 600, 121, 40, 1, 10)
        for repeats in (2, 7, 1000):
            exact = one**repeats
            power = chance_of_error(1000, 600, 121, 40, repeats, 10)
            assert exact <= power <= exact * Fraction(1001, 1000)
        assert 0 < chance_of_error(1000, 600, 121, 40, 10**9, 10) < Fraction(1, 1 << 1100)
        assert chance_of_error(1000, 600, 800, 40, 10**9, 1) == 1
        assert least_needed(10**5, 50_000, 2000, 2000, 10**6, Fraction(1, 1000)) is not None
        assert greatest_claim(10**5, 50_000, 2000, 10, 700, Fraction(1, 1000)) > 20_000


class TestTheTest:
    def test_it_errs_no_more_often_than_it_says(self) -> None:
        """400 tests with level 0.2 of a network that is not 2-robust: 80 errors at most are expected, 110 let pass."""
        graph = as_digraph(halves(60, 1))
        assert not rb.is_r_robust(graph, 2)
        wrong = sum(sample_robustness(graph, error=0.2, nodes=8, repeats=1, seed=seed).r >= 2 for seed in range(400))
        assert wrong <= 110

    def test_it_is_never_sure_of_what_is_false_on_many_networks(self) -> None:
        said = 0
        for seed in range(40):
            n = 24 + seed
            graph = as_digraph(halves(n - n % 2, 1 + seed % 3))
            found = sample_robustness(graph, error=1e-6, nodes=10, repeats=4, seed=seed)
            assert found.r <= rb.determine_robustness(graph, time_limit=20).bounds.upper.value
            said += found.verdict is SampleVerdict.LIKELY
        assert said >= 0

    def test_what_exact_search_cannot_reach(self) -> None:
        graph = nx.gnp_random_graph(300, 0.5, seed=1, directed=True)
        found = sample_robustness(graph, nodes=26, repeats=6, seed=1)
        assert found.verdict is SampleVerdict.LIKELY
        assert found.r >= 10
        assert 0 < found.chance <= 0.001
        asked = sample_robustness(graph, found.r, nodes=26, repeats=6, seed=1)
        assert (asked.verdict, asked.r) == (SampleVerdict.LIKELY, found.r)
        assert asked.chance <= 0.001
        more = sample_robustness(graph, 3 * found.r, nodes=26, repeats=6, seed=1)
        assert more.verdict is SampleVerdict.UNDECIDED
        assert sample_robustness(graph, 150, nodes=4, repeats=1, seed=1).reason.startswith("1 sample of 4 nodes cannot")
        assert sample_robustness(graph, 151, seed=1).reason == "no network of 300 nodes is 151-robust"

    def test_the_same_seed_says_the_same_and_without_one_another_is_drawn(self) -> None:
        graph = nx.complete_graph(50)
        assert sample_robustness(graph, nodes=9, seed=4) == sample_robustness(graph, nodes=9, seed=4)
        assert sample_robustness(graph, nodes=9).seed != sample_robustness(graph, nodes=9).seed

    def test_what_says_nothing_is_undecided(self) -> None:
        for graph in (nx.path_graph(50), nx.empty_graph(30)):
            found = sample_robustness(graph, nodes=6, seed=1)
            assert (found.verdict, found.r, found.chance) == (SampleVerdict.UNDECIDED, 0, 1.0)
        hard = nx.gnp_random_graph(200, 0.5, seed=1, directed=True)
        late = sample_robustness(hard, nodes=80, repeats=2, seed=1, time_limit=1)
        assert late.verdict is SampleVerdict.UNDECIDED or late.chance <= 0.001

    def test_what_is_printed_is_no_less_than_the_chance(self) -> None:
        for seed in range(20):
            found = sample_robustness(nx.complete_graph(60 + seed), repeats=1, seed=seed)
            said = found.summary().partition("with probability ")[2].partition(" ")[0]
            assert (
                Fraction(said)
                >= Fraction(found.chance)
                >= chance_of_error(60 + seed, 59 + seed, found.r, 40, 1, found.q)
            )

    def test_it_is_no_truth_value(self) -> None:
        found = sample_robustness(nx.complete_graph(60), 2, seed=1)
        with pytest.raises(TypeError, match="proves nothing"):
            bool(found)
        assert "not a proof" in found.summary()
        assert {each.value for each in SampleVerdict} & {each.value for each in rb.Verdict} == {"undecided"}

    @pytest.mark.parametrize(
        "question",
        [
            *({"r": 0}, {"error": 0}, {"error": 0.6}, {"error": math.nan}, {"error": True}),
            *({"nodes": 1}, {"repeats": 0}, {"seed": -1}, {"time_limit": 0}),
        ],
    )
    def test_bad_questions(self, question: dict[str, Any]) -> None:
        with pytest.raises(rb.InvalidParameter):
            sample_robustness(nx.complete_graph(10), **question)
        with pytest.raises(rb.InvalidParameter, match="no samples"):
            sample_robustness(nx.empty_graph(1))


class TestCommand:
    @pytest.fixture
    def network(self, tmp_path: Path) -> str:
        path = tmp_path / "net.edgelist"
        nx.write_edgelist(nx.complete_graph(80), path, data=False)
        return str(path)

    def test_a_likely_answer_has_the_exit_code_of_no_proof(self, network: str) -> None:
        done = CliRunner().invoke(program, ["sample", network, "-r", "3", "--seed", "1"])
        assert done.exit_code == 30
        assert done.stdout.startswith("likely 3-robust, not a proof: ")

    def test_json_cannot_be_taken_for_a_verdict(self, network: str) -> None:
        done = CliRunner().invoke(program, ["sample", network, "--nodes", "12", "--json"])
        document = json.loads(done.stdout)
        assert done.exit_code == 30
        assert document["schema"] == "robustness/sample/1"
        assert "verdict" not in document
        assert document["sample_verdict"] == "likely-robust"
        assert document["is_proof"] is False
        again = CliRunner().invoke(
            program, ["sample", network, "--nodes", "12", "--seed", str(document["seed"]), "--json"]
        )
        assert json.loads(again.stdout)["r"] == document["r"]

    def test_undecided(self, network: str) -> None:
        done = CliRunner().invoke(program, ["sample", network, "-r", "40", "--nodes", "5"])
        assert done.exit_code == 30
        assert done.stdout.startswith("undecided: ")

    def test_a_limit_that_comes_before_the_answer_tells_the_seed(
        self, network: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def late(*_: object, **options: object) -> None:
            raise interruption.Overrun

        monkeypatch.setattr("robustness.sampling.sample_robustness", late)
        done = CliRunner().invoke(program, ["sample", network, "--nodes", "500", "--json"])
        document = json.loads(done.stdout)
        assert (done.exit_code, document["sample_verdict"], document["nodes"]) == (30, "undecided", 80)
        assert document["seed"] > 0  # of 2^63 numbers that the system draws
