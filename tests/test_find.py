"""find_graph: what it finds fits, by oracles of its own, and both methods agree, with symmetry breaking or without."""

from __future__ import annotations

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness.constructions.small_graphs import each_graph
from robustness.decision.algorithms.exhaustive import decide
from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.graph_search import (
    Connected,
    Edges,
    FindVerdict,
    HasTrap,
    InDegree,
    RRobust,
    RSRobust,
    find_graph,
    parse_property,
    regular,
)
from robustness.graph_search.synthesis import small_violations
from robustness.limits import Limits
from robustness.results import Verdict
from robustness.traps import is_trap

WHEEL = ["2-robust", "(2,2)-robust", "min-degree>=3", "trap(1)"]


class TestTheWheel:
    @pytest.mark.parametrize("method", ["auto", "cp-sat"])
    def test_is_the_smallest_graph_with_its_properties(self, method):
        result = find_graph(range(1, 8), WHEEL, method=method, minimise="edges")
        assert result.verdict is FindVerdict.FOUND
        assert (result.n, result.edges, result.has_fewest_edges) == (5, 8, True)
        assert result.impossible_for == (1, 2, 3, 4)
        assert nx.is_isomorphic(result.graph, nx.wheel_graph(5))
        assert is_trap(result.graph, 1, **result.graph.graph["trap"])

    def test_is_the_only_one_on_five_nodes(self):
        fits = [
            graph
            for graph in each_graph(5, directed=False)
            if graph.n == 5 and all(parse_property(text).holds(graph) for text in WHEEL)
        ]
        assert len(fits) == 1


class TestQuestionsOfTheIssue:
    def test_three_connected_but_not_two_robust(self):
        result = find_graph(range(1, 8), ["3-connected"], ["2-robust"])
        assert result.n == 6
        assert nx.node_connectivity(result.graph) >= 3
        assert not rb.is_r_robust(result.graph, 2)

    def test_four_robust_with_fewest_edges(self):
        assert find_graph(7, ["4-robust"]).edges == 18
        assert find_graph(7, ["4-robust"], method="cp-sat", minimise="edges").edges == 18
        assert find_graph(range(4, 8), ["4-robust"]).n == 7

    def test_two_f_robust_with_an_attack_beyond_the_lists(self):
        result = find_graph(8, ["4-robust", "(3,3)-robust", "min-degree>=5", "trap(2)"], time_limit=60)
        assert result.verdict is FindVerdict.FOUND
        assert result.method == "cp-sat"
        trap = result.graph.graph["trap"]
        assert is_trap(result.graph, 2, trap["M"], trap["S1"], trap["S2"])
        assert rb.is_rs_robust(result.graph, 3, 3, algorithm="exhaustive")

    @pytest.mark.slow
    @pytest.mark.parametrize(("r", "edges"), [(3, 15), (4, 21)])
    def test_fewest_edges_on_eight_nodes(self, r, edges):
        result = find_graph(8, [RRobust(r)], minimise="edges")
        assert (result.edges, result.has_fewest_edges) == (edges, True)


PROPERTIES = [
    "1-robust",
    "2-robust",
    "3-robust",
    "(1,2)-robust",
    "(2,2)-robust",
    "(1,4)-robust",
    "(2,3)-robust",
    "(0,2)-robust",
    "1-connected",
    "2-connected",
    "3-connected",
    "0-connected",
    "trap(0)",
    "trap(1)",
    "trap(2)",
    "min-degree>=2",
    "max-degree<=2",
    "2-regular",
    "edges<=4",
    "edges>=5",
    "edges=6",
    "(1,9)-robust",
    "9-connected",
]


@settings(max_examples=60)
@given(
    n=st.integers(2, 5),
    satisfies=st.lists(st.sampled_from(PROPERTIES), max_size=3),
    violates=st.lists(st.sampled_from(PROPERTIES), max_size=2),
    directed=st.booleans(),
    minimise=st.sampled_from([None, "edges"]),
)
def test_methods_agree(n, satisfies, violates, directed, minimise):
    n = min(n, 4) if directed else n
    listed = find_graph(n, satisfies, violates, directed=directed, method="enumeration")
    searched = find_graph(n, satisfies, violates, directed=directed, method="cp-sat", minimise=minimise)
    assert listed.verdict is searched.verdict
    if minimise and listed.verdict is FindVerdict.FOUND:
        assert listed.edges == searched.edges


@settings(max_examples=25)
@given(
    n=st.integers(2, 5),
    satisfies=st.lists(st.sampled_from(PROPERTIES), max_size=2),
    violates=st.lists(st.sampled_from(PROPERTIES), max_size=2),
    directed=st.booleans(),
)
def test_symmetry_breaking_changes_no_verdict(n, satisfies, violates, directed):
    question = {
        "satisfies": satisfies,
        "violates": violates,
        "directed": directed,
        "method": "cp-sat",
        "minimise": "edges",
    }
    n = min(n, 4) if directed else n
    on, off = (find_graph(n, **question, symmetry_breaking=switch) for switch in (True, False))
    assert (on.verdict, on.edges) == (off.verdict, off.edges)


@pytest.mark.parametrize("directed", [False, True])
def test_small_violations_are_violations_and_exist_when_there_are_any(directed):
    for graph in each_graph(3 if directed else 4, directed=directed):
        for r in range(1, (graph.n + 1) // 2 + 1):
            for s in range(1, graph.n + 1) if graph.n >= 2 else []:
                pairs = small_violations(graph, r, s, 3)
                assert (decide(graph, r, s, Limits()).verdict is Verdict.NOT_ROBUST) == bool(pairs)
                assert all(rb.definitions.is_violation(graph, *pair, r, s) for pair in pairs)


class TestProperties:
    def by_definition(self, graph, text):
        """An independent reading of each property on a networkx graph."""
        G, degrees = graph.to_networkx(), graph.in_degrees.tolist()
        return {
            "2-connected": len(G) > 2
            and all(
                nx.is_connected(rest) if not graph.directed else nx.is_strongly_connected(rest)
                for rest in [G, *(G.subgraph(set(G) - {v}) for v in G)]
            ),
            "2-regular": set(degrees) <= {2},
            "min-degree>=2": all(d >= 2 for d in degrees),
            "max-degree<=2": all(d <= 2 for d in degrees),
            "edges<=4": G.size() <= 4,
            "edges>=5": G.size() >= 5,
            "edges=6": G.size() == 6,
        }[text]

    @pytest.mark.parametrize(
        "text", ["2-connected", "2-regular", "min-degree>=2", "max-degree<=2", "edges<=4", "edges>=5", "edges=6"]
    )
    @pytest.mark.parametrize("directed", [False, True])
    def test_hold_by_an_independent_reading(self, text, directed):
        for graph in each_graph(3 if directed else 5, directed=directed):
            assert parse_property(text).holds(graph) == self.by_definition(graph, text), (graph.in_masks, text)

    @pytest.mark.parametrize(
        "each",
        [
            RRobust(2),
            RSRobust(3, 4),
            Connected(3),
            regular(4),
            HasTrap(1),
            InDegree(3),
            InDegree(0, 4),
            Edges(8),
            Edges(0, 12),
            Edges(9, 9),
        ],
    )
    def test_texts_and_properties_are_the_same_thing(self, each):
        assert parse_property(str(each)) == each
        assert parse_property(f" {each} ".upper()) == each

    @pytest.mark.parametrize(
        "text", ["", "robust", "2-robust,", "(2,0)-robust", "trap(-1)", "min-degree>3", "edges<=x", "(2;2)-robust"]
    )
    def test_other_texts_are_refused(self, text):
        with pytest.raises(InvalidParameter):
            parse_property(text)

    @pytest.mark.parametrize(
        "make",
        [
            lambda: InDegree(3, 2),
            lambda: Edges(-1),
            lambda: RSRobust(-1, 1),
            lambda: RSRobust(1, 0),
            lambda: Connected(True),
        ],
    )
    def test_out_of_range_is_refused(self, make):
        with pytest.raises(InvalidParameter):
            make()


class HasTriangle:
    """A property of the user's own."""

    def holds(self, graph, limits=None):
        return sum(nx.triangles(graph.to_networkx()).values()) > 0


class TestOwnProperties:
    def test_serve_where_all_graphs_are_listed(self):
        result = find_graph(range(1, 7), ["2-robust"], [HasTriangle()])
        assert (result.n, nx.is_isomorphic(result.graph, nx.complete_bipartite_graph(2, 3))) == (5, True)

    def test_are_refused_beyond(self):
        with pytest.raises(InvalidParameter, match="built-in"):
            find_graph(8, [HasTriangle()])
        with pytest.raises(InvalidParameter, match="built-in"):
            find_graph(8, [], [HasTriangle()])


class TestLimits:
    def test_a_limit_says_undecided_and_keeps_the_graph_that_fits(self):
        result = find_graph(12, ["5-robust"], minimise="edges", time_limit=3)
        assert result.verdict is FindVerdict.UNDECIDED
        assert "limit" in result.stats["reason"]
        assert not result.has_fewest_edges
        if result.graph is not None:
            assert rb.is_r_robust(result.graph, 5)
            assert result.edges_at_least <= result.edges
        with pytest.raises(TypeError, match="three values"):
            bool(result)

    def test_a_passed_limit_stops_the_lists_too(self):
        result = find_graph(7, ["2-connected"], ["1-robust"], time_limit=1e-6)
        assert result.verdict is FindVerdict.UNDECIDED

    def test_properties_raise_past_their_deadline(self):
        with pytest.raises(Undecided):
            RRobust(2).holds(as_digraph(nx.wheel_graph(6)), Limits(deadline=0.0))


class TestMisuse:
    @pytest.mark.parametrize(
        "question",
        [
            {"n": -1},
            {"n": []},
            {"n": "5"},
            {"n": True},
            {"n": 5, "satisfies": "2-robust"},
            {"n": 5, "satisfies": [2]},
            {"n": 5, "minimise": "nodes"},
            {"n": 5, "method": "magic"},
            {"n": 5, "time_limit": 0},
            {"n": 8, "method": "enumeration"},
        ],
    )
    def test_is_one_line(self, question):
        with pytest.raises(InvalidParameter) as caught:
            find_graph(**question)
        assert "\n" not in str(caught.value)

    def test_corners(self):
        assert find_graph(0).n == 0
        assert find_graph(1, ["1-robust"]).verdict is FindVerdict.FOUND
        assert find_graph(0, ["1-robust"]).verdict is FindVerdict.IMPOSSIBLE
        assert find_graph(1, ["1-robust"], method="cp-sat").verdict is FindVerdict.FOUND
        assert find_graph(8).edges is not None
        assert find_graph(6, ["2-robust"], directed=True).graph.is_directed()
