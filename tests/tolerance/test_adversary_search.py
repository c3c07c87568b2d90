"""Adversaries that search: nothing that the theorems newly promise withstands contraction, and every control does."""

from __future__ import annotations

import random

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import Digraph, as_digraph
from robustness.paper import adversary_search
from robustness.paper.adversary_search import CONTROLS, FLEETS, Vehicles, liars, promised, searched, spread_left
from robustness.paper.audit.census import census


@pytest.mark.parametrize(("name", "graph", "f", "bad", "vehicles"), CONTROLS, ids=[each[0] for each in CONTROLS])
def test_controls_are_held_apart(name: str, graph: Digraph, f: int, bad: frozenset[int], vehicles: Vehicles) -> None:
    assert spread_left(graph, f, bad, vehicles, climb=60) > 0.999


def test_small_networks_contract_under_every_fleet() -> None:
    graphs = list(promised(5, 1, directed=False))
    assert [graph.n for graph in graphs] == [4]
    for vehicles in FLEETS:
        assert spread_left(graphs[0], 1, {0}, vehicles) < 0.5


def test_six_nodes_contract() -> None:
    graphs, sets, left = searched((g for g in promised(6, 1, directed=False) if g.n == 6), 1)
    assert (graphs, sets) == (5, 34)
    assert left < 0.5


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
def test_seven_nodes_contract() -> None:
    for f in (1, 2):
        assert searched((g for g in promised(7, f, directed=False) if g.n == 7), f)[2] < 0.5


@pytest.mark.slow
def test_some_of_eight_nodes_contract() -> None:
    for row in census(8):
        if row.n == 8 and row.free:
            assert searched(random.Random(1).sample(row.free, min(20, len(row.free))), row.f)[2] < 0.5
