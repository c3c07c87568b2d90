"""Lemma 1 item by item: exhaustively on small graphs and digraphs, by Hypothesis above, and the page that says so."""

from __future__ import annotations

from pathlib import Path

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustness.constructions.lemma_1 import STATEMENTS, profile
from robustness.digraph import Digraph, as_digraph
from robustness.paper.lemma_audit import audit, page
from robustness.testing import digraphs, graphs, rs_robust_graphs

PAGE = Path(__file__).parents[2] / "docs" / "lemma-1.md"

#: (item, start of the text) of what fails, for graphs and for digraphs, on up to 5 and 4 nodes. All else holds.
FAILS_FOR_GRAPHS = {
    ("(iii)", "r-connected implies"),
    ("(iv)", "(r,s)-robust implies a directed"),
    ("(vii)", "a new node of in-degree >= max(r, r+s-2)"),
    ("last line", "(r,s)-robust implies (r+s-1)"),
    ("Section 4", "for odd n only K_n"),
}
FAILS_FOR_DIGRAPHS = FAILS_FOR_GRAPHS - {("Section 4", "for odd n only K_n")} | {
    ("(iii)", "(r,s)-robust implies at least"),
    ("Section 3", "r-robust implies every in-degree"),
}


def statement(item, start):
    (found,) = [each for each in STATEMENTS if each.item == item and each.text.startswith(start)]
    return found


@pytest.mark.parametrize(("directed", "expected"), [(False, FAILS_FOR_GRAPHS), (True, FAILS_FOR_DIGRAPHS)])
def test_exhaustively_on_small_graphs(directed, expected):
    findings = audit(directed=directed, largest=4 if directed else 5)
    failed = {each.statement for each in findings if each.counterexample is not None}
    assert failed == {statement(*key) for key in expected}
    assert all(
        each.tried == {True: 237 if not each.statement.has_choices else 19, False: 51}[directed]
        for each in findings
        if each.counterexample is None
    )


class TestCounterexamples:
    """Each counterexample of the page, verified from the definition alone."""

    def test_a_one_robust_digraph_that_is_not_strongly_connected(self, holds):
        G = nx.DiGraph([(1, 0)])
        assert holds(G, 1)
        assert not nx.is_strongly_connected(G)
        assert statement("(iii)", "(r,s)-robust implies at least").refute(as_digraph(G))

    def test_two_connected_but_not_two_robust(self, holds):
        G = nx.cycle_graph(4)
        assert nx.node_connectivity(G) == 2
        assert not holds(G, 2)
        assert statement("(iii)", "r-connected").refute(as_digraph(G))

    def test_in_degree_r_plus_s_minus_two_is_too_small(self, holds):
        G = nx.complete_graph(4)
        G.remove_edge(1, 3)
        assert holds(G, 2, 2)
        pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
        assert any(not holds(nx.Graph([*G.edges, *((4, i) for i in pair)]), 2, 2) for pair in pairs)

    def test_five_nodes_have_two_three_robust_graphs(self, holds):
        G = nx.complete_graph(5)
        G.remove_edge(0, 2)
        assert holds(G, 3)
        D = nx.complete_graph(5, create_using=nx.DiGraph)
        D.remove_edges_from([(2, 3), (3, 4), (4, 2)])
        assert holds(D, 3)
        assert statement("Section 4", "for odd").refute(as_digraph(D)) == "3-robust with 3 arcs missing"

    def test_refutations_are_not_given_for_nothing(self):
        wheel = as_digraph(nx.wheel_graph(5))
        refuted = [each.item for each in STATEMENTS if each.refute(wheel) is not None]
        assert refuted == ["(iii)", "(vii)", "last line"]


HOLDS = [
    (each, directed)
    for each in STATEMENTS
    for directed, fails in ((False, FAILS_FOR_GRAPHS), (True, FAILS_FOR_DIGRAPHS))
    if each not in {statement(*key) for key in fails} and each.item != "Section 4"
]


@pytest.mark.parametrize(("each", "directed"), HOLDS, ids=lambda value: getattr(value, "text", str(value))[:40])
def test_by_hypothesis_on_larger_graphs(each, directed):
    largest = {(True, True): 4, (True, False): 6, (False, True): 6, (False, False): 8}[each.has_choices, directed]

    @settings(max_examples=25)
    @given(
        st.one_of(
            digraphs(min_nodes=2, max_nodes=largest) if directed else graphs(min_nodes=2, max_nodes=largest),
            rs_robust_graphs(2, 2, directed=directed, min_nodes=3, max_nodes=largest),
        )
    )
    def check(G):
        if not (each.has_choices and G.size() > 13):
            assert each.refute(as_digraph(G)) is None

    check()


class TestPage:
    def test_has_a_row_for_every_statement(self):
        rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")][1:]
        assert [row.split(" | ")[2] for row in rows] == [each.text for each in STATEMENTS]
        assert [
            ("fails" in row.split(" | ")[3], "fails" in row.split(" | ")[4]) for row in rows if "Section 4" not in row
        ] == [
            (
                each in {statement(*key) for key in FAILS_FOR_GRAPHS},
                each in {statement(*key) for key in FAILS_FOR_DIGRAPHS},
            )
            for each in STATEMENTS
            if each.item != "Section 4"
        ]

    def test_is_made_by_the_command(self):
        small = page(graphs=3, digraphs=3).splitlines()
        committed = PAGE.read_text(encoding="utf-8").splitlines()
        assert small[:6] == committed[:6]
        assert small[-12:] == committed[-12:]

    @pytest.mark.slow
    def test_is_what_the_command_writes_today(self):
        assert PAGE.read_text(encoding="utf-8") == page()


def test_profile_of_a_digraph():
    assert profile(Digraph(range(3), [(0, 1), (1, 2)])) == [3, 1, 0]
