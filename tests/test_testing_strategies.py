"""The strategies keep their promises under the definition, shrink to minimal graphs, and the assertions explain."""

from __future__ import annotations

import subprocess
import sys
from itertools import combinations

import networkx as nx
import pytest
from hypothesis import HealthCheck, Phase, find, given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness.decision.algorithms.exhaustive import decide
from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.limits import Limits
from robustness.results import Verdict
from robustness.testing import (
    assert_not_robust,
    assert_robust,
    digraphs,
    graphs,
    malicious_sets,
    not_r_robust_graphs,
    r_robust_graphs,
    rs_robust_graphs,
    time_varying_graphs,
)
from robustness.time_varying import TimeVaryingGraph

QUESTIONS = [(0, 1), (1, 1), (2, 1), (3, 1), (1, 3), (2, 2), (2, 4), (3, 3)]


def holds(G, r, s=1):
    graph = as_digraph(G)
    if r == 0 or graph.n == 1:
        return r <= 1
    return decide(graph, r, s, Limits()).verdict is Verdict.ROBUST


def is_plain(G):
    return sorted(G) == list(range(len(G))) and nx.number_of_selfloops(G) == 0 and not G.is_multigraph()


class TestPromises:
    @given(graphs(max_nodes=5), digraphs(max_nodes=4))
    def test_any_graph(self, G, D):
        assert is_plain(G)
        assert not G.is_directed()
        assert 1 <= len(G) <= 5
        assert is_plain(D)
        assert D.is_directed()
        assert 1 <= len(D) <= 4

    @pytest.mark.parametrize(("r", "s"), QUESTIONS)
    @pytest.mark.parametrize("directed", [False, True])
    def test_rs_robust_graphs(self, r, s, directed):
        least = max(2 * r - 1, s, 1)

        @settings(max_examples=20)
        @given(rs_robust_graphs(r, s, directed=directed, max_nodes=min(least + 4, 8)))
        def check(G):
            assert is_plain(G)
            assert G.is_directed() == directed
            assert least <= len(G) <= least + 4
            assert holds(G, r, s)

        check()

    @given(st.integers(0, 3), st.booleans(), st.data())
    def test_r_robust_graphs(self, r, directed, data):
        assert holds(data.draw(r_robust_graphs(r, directed=directed)), r)

    @given(st.integers(1, 4), st.booleans(), st.data())
    def test_not_r_robust_graphs_come_with_their_pair(self, r, directed, data):
        G, pair = data.draw(not_r_robust_graphs(r, directed=directed))
        assert is_plain(G)
        assert pair.S1
        assert pair.S2
        assert not pair.S1 & pair.S2
        for side in pair:
            assert not rb.r_reachable_nodes(G, side, r)
        assert not holds(G, r)

    @given(st.integers(0, 2), st.booleans(), st.data())
    def test_time_varying_graphs_are_jointly_robust(self, r, directed, data):
        steps = data.draw(time_varying_graphs(r=r, directed=directed))
        assert len({frozenset(step) for step in steps}) == 1
        assert holds(nx.compose_all(steps), r)
        sequence = TimeVaryingGraph(steps, period=len(steps))
        assert sequence.n == len(steps[0])

    @given(st.one_of(graphs(), digraphs()), st.integers(0, 3), st.data())
    def test_malicious_sets(self, G, f, data):
        total = data.draw(malicious_sets(G, f))
        assert total <= set(G)
        assert len(total) <= f
        assert len(total) < len(G)
        local = data.draw(malicious_sets(G, f, model="local"))
        hears = G.predecessors if G.is_directed() else G.neighbors
        assert local <= set(G)
        assert all(len(set(hears(i)) & local) <= f for i in set(G) - local)


class TestVariety:
    """A strategy that draws few graphs keeps its promise too easily."""

    def reachable(self, strategy, condition):
        return find(strategy, condition, settings=settings(max_examples=3000, phases=[Phase.generate], database=None))

    def test_every_graph_that_is_not_two_robust_on_three_nodes_can_be_drawn(self):
        for wanted in (nx.empty_graph(3), nx.path_graph(3), nx.Graph([(0, 1)])):
            wanted.add_nodes_from(range(3))
            self.reachable(
                not_r_robust_graphs(2, max_nodes=3), lambda pair, wanted=wanted: nx.is_isomorphic(pair[0], wanted)
            )

    @pytest.mark.parametrize("directed", [False, True])
    def test_robust_graphs_need_not_be_more_robust(self, directed):
        self.reachable(r_robust_graphs(2, directed=directed, min_nodes=6), lambda G: not rb.is_r_robust(G, 3))

    def test_robust_graphs_may_have_nodes_of_least_degree(self):
        self.reachable(r_robust_graphs(2), lambda G: len(G) >= 5 and min(d for _, d in G.degree) == 2)

    def test_robust_digraphs_may_be_asymmetric(self):
        self.reachable(r_robust_graphs(2, directed=True), lambda G: not as_digraph(G).is_symmetric)

    def test_seeds_may_be_sparser_than_complete(self):
        self.reachable(rs_robust_graphs(2, 5), lambda G: len(G) >= 6 and min(d for _, d in G.degree) < len(G) - 1)

    def test_steps_need_not_be_robust(self):
        self.reachable(
            time_varying_graphs(r=2), lambda steps: len(steps) > 1 and not any(rb.is_r_robust(G, 2) for G in steps)
        )

    def test_local_sets_may_hold_more_than_f_nodes(self):
        self.reachable(malicious_sets(nx.path_graph(7), 1, model="local"), lambda M: len(M) >= 3)

    def test_local_sets_may_hold_all_nodes(self):
        self.reachable(malicious_sets(nx.complete_graph(4), 1, model="local"), lambda M: len(M) == 4)


def shrunk(strategy, fails):
    """What Hypothesis reports for a property that fails on ``fails``, within its default budget of 100 examples."""
    reported = []

    @settings(max_examples=100, database=None, suppress_health_check=list(HealthCheck))
    @given(strategy)
    def property_test(value):
        if fails(value):
            reported.append(value)
            raise AssertionError

    with pytest.raises(AssertionError):
        property_test()
    return reported[-1]


def same(G, H):
    return nx.is_isomorphic(G, H)


class TestShrinking:
    def test_a_connected_graph_that_is_not_two_robust(self):
        G = shrunk(graphs(), lambda G: len(G) >= 3 and nx.is_connected(G) and not rb.is_r_robust(G, 2))
        assert same(G, nx.path_graph(3))

    def test_a_two_connected_graph_that_is_not_two_robust(self):
        G = shrunk(graphs(), lambda G: len(G) >= 3 and nx.is_biconnected(G) and not rb.is_r_robust(G, 2))
        assert same(G, nx.cycle_graph(4))

    def test_a_one_robust_digraph_that_is_not_strongly_connected(self):
        D = shrunk(digraphs(), lambda D: rb.is_r_robust(D, 1) and not nx.is_strongly_connected(D))
        assert sorted(D.edges) in ([(0, 1)], [(1, 0)])

    @pytest.mark.parametrize(("r", "directed"), [(1, False), (2, True), (3, False)])
    def test_any_robust_graph(self, r, directed):
        G = shrunk(r_robust_graphs(r, directed=directed), lambda G: True)
        assert len(G) == 2 * r - 1
        assert same(G, nx.complete_graph(2 * r - 1, create_using=G.__class__))

    @pytest.mark.parametrize("directed", [False, True])
    def test_a_robust_graph_with_six_nodes(self, directed):
        G = shrunk(r_robust_graphs(2, directed=directed), lambda G: len(G) >= 6)
        assert len(G) == 6
        assert sorted(G) == list(range(6))

    def test_a_robust_graph_that_is_not_complete(self):
        G = shrunk(r_robust_graphs(2), lambda G: G.size() < len(G) * (len(G) - 1) // 2)
        assert len(G) == 4
        assert G.size() == 5

    def test_a_graph_that_is_not_robust(self):
        G, pair = shrunk(not_r_robust_graphs(2), lambda drawn: True)
        assert (len(G), G.size()) == (2, 0)
        assert {pair.S1, pair.S2} == {frozenset({0}), frozenset({1})}

    def test_a_connected_graph_that_is_not_robust(self):
        G, _ = shrunk(not_r_robust_graphs(2), lambda drawn: len(drawn[0]) >= 4 and nx.is_connected(drawn[0]))
        assert len(G) == 4
        assert nx.is_tree(G)

    def test_a_sequence(self):
        steps = shrunk(time_varying_graphs(r=2), lambda steps: len(steps) >= 2)
        assert len(steps) == 2
        assert len(steps[0]) == 3
        assert sum(step.size() for step in steps) == 3

    def test_a_malicious_set(self):
        assert shrunk(malicious_sets(nx.complete_graph(6), 3), lambda M: bool(M)) == {0}
        assert len(shrunk(malicious_sets(nx.path_graph(6), 1, model="local"), lambda M: len(M) >= 2)) == 2


class TestPasting:
    """What Hypothesis prints of a failing example makes the same example."""

    @pytest.mark.parametrize(
        "strategy",
        [
            graphs(),
            digraphs(),
            r_robust_graphs(2),
            r_robust_graphs(2, directed=True),
            rs_robust_graphs(2, 2),
            time_varying_graphs(r=1),
            time_varying_graphs(r=1, directed=True),
            not_r_robust_graphs(2).map(lambda drawn: drawn[0]),
        ],
    )
    def test_every_strategy(self, strategy):
        @given(strategy)
        def prints(drawn):
            pasted = eval(repr(drawn), {"nx": nx})  # noqa: S307 - what it printed is what is pasted
            pairs = zip(drawn, pasted, strict=True) if isinstance(drawn, list) else [(drawn, pasted)]
            for one, other in pairs:
                assert type(other) in (nx.Graph, nx.DiGraph)
                assert nx.utils.graphs_equal(one, other)

        prints()

    def test_a_failing_example(self):
        @given(r_robust_graphs(2))
        @settings(database=None)
        def fails(G):
            raise AssertionError

        with pytest.raises(AssertionError) as caught:
            fails()
        (note,) = (line.strip() for each in caught.value.__notes__ for line in each.splitlines() if "G=" in line)
        (drawn,) = eval(f"({note.removeprefix('G=')}\n)", {"nx": nx})  # noqa: S307 - what it printed is what is pasted
        assert nx.is_isomorphic(drawn, nx.complete_graph(3))


class TestAssertions:
    def test_robust(self):
        assert assert_robust(nx.wheel_graph(5), 2, 2) is None

    def test_the_message_draws_the_pair(self):
        with pytest.raises(AssertionError) as caught:
            assert_robust(nx.relabel_nodes(nx.cycle_graph(6), {0: "a"}), 2, algorithm="exhaustive")
        first, *lines = str(caught.value).splitlines()
        assert first.startswith("not 2-robust: 0 of ")
        assert [line.split(" = ")[0].strip() for line in lines if " = " in line] == ["S1", "S2"]
        assert sum(" hears 1 outside {" in line for line in lines) >= 2

    def test_exempt_nodes_are_marked(self):
        with pytest.raises(AssertionError, match=r"\(1,3\)-robust") as caught:
            assert_robust(nx.path_graph(4), 1, 3)
        marked = [line for line in str(caught.value).splitlines() if "*hears" in line]
        assert len(marked) == 2

    def test_the_message_is_true(self):
        G = nx.petersen_graph()
        with pytest.raises(AssertionError) as caught:
            assert_robust(G, 2)
        sides = [line.split(" = ")[1] for line in str(caught.value).splitlines() if " = " in line]
        for text in sides:
            side = {int(node) for node in text.strip("{}").split(", ")}
            assert not rb.r_reachable_nodes(G, side, 2)

    def test_one_node(self):
        with pytest.raises(AssertionError, match="fewer than two nodes"):
            assert_robust(nx.empty_graph(1), 2)
        assert assert_not_robust(nx.empty_graph(1), 2) is None

    def test_not_robust_returns_the_pair(self):
        pair = assert_not_robust(nx.path_graph(4), 2)
        assert not rb.r_reachable_nodes(nx.path_graph(4), pair.S1, 2)

    def test_not_robust_says_when_it_is(self):
        with pytest.raises(AssertionError, match="though it should not be"):
            assert_not_robust(nx.complete_graph(4), 2)

    @pytest.mark.parametrize("check", [assert_robust, assert_not_robust])
    def test_undecided_is_no_verdict(self, check):
        with pytest.raises(Undecided):
            check(nx.random_regular_graph(20, 60, seed=1), 9, time_limit=1e-3)


class TestMisuse:
    @pytest.mark.parametrize(
        "make",
        [
            lambda: r_robust_graphs(-1),
            lambda: rs_robust_graphs(2, 0),
            lambda: r_robust_graphs(3, max_nodes=4),
            lambda: not_r_robust_graphs(0),
            lambda: not_r_robust_graphs(1, min_nodes=1),
            lambda: not_r_robust_graphs(1, min_nodes=5, max_nodes=4),
            lambda: find(graphs(min_nodes=3, max_nodes=2), bool),
            lambda: find(malicious_sets(nx.path_graph(3), -1), bool),
            lambda: find(malicious_sets(nx.path_graph(3), 1, model="global"), bool),
            lambda: find(time_varying_graphs(max_period=0), bool),
        ],
    )
    def test_is_told(self, make):
        with pytest.raises(InvalidParameter):
            make()

    def test_the_graph_given_is_not_changed(self):
        G = nx.path_graph(5)
        find(malicious_sets(G, 2, model="local"), lambda M: True)
        assert list(combinations(G, 2))
        assert nx.utils.graphs_equal(G, nx.path_graph(5))


def test_no_draw_waits_for_an_import() -> None:
    """A draw that does is slow where Hypothesis looks, and fails its health check on a busy machine."""
    program = """
import sys
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from robustness import testing

@settings(max_examples=20, database=None, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.tuples(testing.graphs(), testing.digraphs(), testing.rs_robust_graphs(2, 2), testing.not_r_robust_graphs(2),
                 testing.time_varying_graphs()))
def draws(drawn):
    new = {name.partition(".")[0] for name in set(sys.modules) - before}
    assert not new & {"robustness", "networkx", "scipy", "ortools"}, new

before = set(sys.modules)
draws()
"""
    drawn = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert drawn.returncode == 0, drawn.stderr
