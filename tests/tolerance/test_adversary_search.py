"""Adversaries that search: nothing that the theorems newly promise withstands contraction, and every control does."""

from __future__ import annotations

import json
import random
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import Digraph, as_digraph
from robustness.paper import adversary_search
from robustness.paper.adversary_search import (
    CONTROLS,
    FLEETS,
    Row,
    Vehicles,
    attacked,
    left_of_the_worst,
    liars,
    promised,
    spread_left,
)
from robustness.paper.audit.census import census

DOCS = Path(__file__).resolve().parents[2] / "docs"
TABLE = [Row.of(json.loads(line)) for line in (DOCS / "searching-adversaries.jsonl").read_text().splitlines()]
SPARSEST = min((row for row in TABLE if row.n == 6), key=lambda row: len(row.arcs))


def graph_of(row: Row) -> Digraph:
    return Digraph(range(row.n), row.arcs, directed=row.directed)


@pytest.mark.parametrize(("name", "graph", "f", "bad", "vehicles"), CONTROLS, ids=[each[0] for each in CONTROLS])
def test_controls_are_held_apart(name: str, graph: Digraph, f: int, bad: frozenset[int], vehicles: Vehicles) -> None:
    assert spread_left(graph, f, bad, vehicles, climb=60) > 0.999


def test_small_networks_contract_under_every_fleet() -> None:
    graphs = list(promised(5, 1, directed=False))
    assert [graph.n for graph in graphs] == [4]
    for vehicles in FLEETS:
        assert spread_left(graphs[0], 1, {0}, vehicles) < 0.5


class TestTheCommittedTable:
    """docs/searching-adversaries.jsonl is whole, nothing in it withstands, and it is what comes out."""

    def test_it_holds_every_network_and_every_set_of_liars(self) -> None:
        for directed, most in ((False, 6), (True, 4)):
            for f in (1, 2):
                listed = {row.arcs: row for row in TABLE if (row.directed, row.f) == (directed, f) and row.n <= most}
                graphs = {tuple((int(u), int(v)) for u, v in g.arcs()): g for g in promised(most, f, directed=directed)}
                assert set(listed) == set(graphs)
                for arcs, row in listed.items():
                    assert len(list(liars(graphs[arcs], f, local=row.local))) == row.sets > 0

    def test_everything_contracts(self) -> None:
        assert len(TABLE) > 30
        assert {row.n for row in TABLE} == {4, 6, 7}
        assert max(max(row.left) for row in TABLE) < 0.5

    def test_what_is_left_falls_with_time(self) -> None:
        """The table does not show where a spread ends: after four times as many steps little is left of the most."""
        assert left_of_the_worst(TABLE, 4 * adversary_search.STEPS) < max(max(row.left) for row in TABLE) / 4

    def test_the_page_shows_it(self) -> None:
        text = (DOCS / "searching-adversaries.md").read_text(encoding="utf-8")
        for directed, n, f in {(row.directed, row.n, row.f) for row in TABLE}:
            group = [row for row in TABLE if (row.directed, row.n, row.f) == (directed, n, f)]
            most = [f"{max(each):.1e}" for each in zip(*(row.left for row in group), strict=True)]
            kind, sets = "digraphs" if directed else "graphs", sum(row.sets for row in group)
            line = f"| {kind} | {n} | {f} | {len(group)} | {sets} | {' | '.join(most)} |"
            assert line in text.splitlines()

    @pytest.mark.parametrize("row", [row for row in TABLE if row.n <= 4] + [SPARSEST], ids=lambda row: f"n={row.n}")
    def test_some_of_it_comes_out_again(self, row: Row) -> None:
        """Up to rounding, which another processor may do otherwise, and which the climb may turn into another end."""
        again = attacked(graph_of(row), row.f)
        assert (again.sets, again.local) == (row.sets, row.local)
        assert again.left == pytest.approx(row.left, abs=0.02)

    @pytest.mark.slow
    @pytest.mark.parametrize("row", TABLE, ids=lambda row: f"n={row.n}-{len(row.arcs)}-arcs")
    def test_all_of_it_comes_out_again(self, row: Row) -> None:
        assert attacked(graph_of(row), row.f).left == pytest.approx(row.left, abs=0.02)


def test_digraphs() -> None:
    """In-degrees of at least 2f + 1 leave K_4 alone."""
    assert [graph.arc_count for graph in promised(4, 1, directed=True)] == [12]


def test_liars_obey_their_bound() -> None:
    star = as_digraph(nx.star_graph(4))
    assert len(list(liars(star, 1, local=False))) == 5
    local = set(liars(star, 1, local=True))
    assert frozenset({1, 2}) not in local
    assert frozenset({0, 1, 2}) in local


def test_the_motion_is_that_of_the_theorems() -> None:
    """Without delays, lies and drops one step of the search is p + q + u/2, q + u."""
    hears, start = np.array([[False, True], [True, False]]), np.array([[0.0, 1.0]])
    policies = adversary_search._Policies(
        *(np.zeros((1, adversary_search.PHASES, 2, 2), np.uint8),) * 2, np.ones((1, adversary_search.PHASES, 2), bool)
    )
    vehicles = Vehicles(0.25, 1.5, 0, 1)
    p, q = start[0].copy(), np.zeros(2)
    for _ in range(adversary_search.STEPS):
        u = 0.25 * (p[::-1] - p) - 1.5 * q
        p, q = p + q + u / 2, q + u
    points = np.concatenate([p, p + vehicles.coasting * q])
    got = adversary_search._run(hears, np.ones(2, bool), 0, vehicles, policies, start)
    assert got[0] == pytest.approx(points.max() - points.min(), rel=1e-6, abs=1e-12)


@pytest.mark.slow
def test_some_of_eight_nodes_contract() -> None:
    for row in census(8):
        if row.n == 8 and row.free:
            for graph in random.Random(1).sample(row.free, min(5, len(row.free))):
                assert max(attacked(graph, row.f).left) < 0.5
