"""Caps on in-neighbours: what is chosen keeps them, and the least cost is that of brute force with them."""

from __future__ import annotations

import random
from itertools import combinations
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.mending import MendVerdict
from tests.mending.brute_force import is_robust


def mended(network: nx.Graph, links: Any, one_way: bool) -> nx.DiGraph:
    graph = network.to_directed()
    graph.add_edges_from(links)
    if not one_way:
        graph.add_edges_from([(v, u) for u, v in links])
    return graph


def gains_too_much(network: nx.Graph, made: nx.DiGraph, caps: dict[int, int]) -> bool:
    before = network.to_directed()
    return any(made.in_degree(v) > max(cap, before.in_degree(v)) for v, cap in caps.items())


def least_with_caps(
    network: nx.Graph, r: int, s: int, cost: dict[tuple[int, int], float], caps: dict[int, int], one_way: bool
) -> float | None:
    """Return the least cost of links that reach the goal and keep the caps; None when there are none."""
    best = None
    for count in range(len(cost) + 1):
        for links in combinations(cost, count):
            price = sum(cost[link] for link in links)
            if best is not None and price >= best:
                continue
            made = mended(network, links, one_way)
            if not gains_too_much(network, made, caps) and is_robust(r, s)(rb.Digraph.from_networkx(made)):
                best = price
    return best


def check(
    network: nx.Graph, r: int, s: int, cost: dict[tuple[int, int], float], caps: dict[int, int], one_way: bool
) -> None:
    found = rb.mend(network, (r, s), candidates=list(cost), cost=cost, max_in_degree=caps, one_way=one_way)
    least = least_with_caps(network, r, s, cost, caps, one_way)
    if least is None:
        assert found.verdict is MendVerdict.IMPOSSIBLE
        return
    assert (found.verdict, found.cost, found.lower_bound) == (MendVerdict.OPTIMAL, least, least)
    assert not gains_too_much(network, mended(network, found.links, one_way), caps)


@pytest.mark.parametrize("costs", [(1, 1, 1, 1, 1, 1), (1, 0.5, 3, 0.5, 0.5, 1)])
def test_a_node_with_room_for_one_does_not_gain_two(costs: tuple[float, ...]) -> None:
    links = [(0, 3), (1, 2), (2, 1), (2, 3), (3, 0), (3, 2)]
    network = nx.Graph([(0, 1), (0, 2), (1, 3)])
    check(network, 2, 2, dict(zip(links, costs, strict=True)), {0: 3, 1: 3, 2: 2, 3: 2}, one_way=True)


def test_caps_that_no_choice_keeps_are_impossible() -> None:
    network = nx.empty_graph(9)
    network.add_edges_from([(0, 2), (0, 4), (0, 8), (1, 7), (3, 7), (3, 8), (5, 8)])
    cost = {
        (4, 2): 2, (1, 4): 0, (7, 6): 3, (3, 6): 3, (5, 0): 1, (8, 1): 3, (3, 4): 2, (8, 2): 1, (1, 6): 3, (7, 0): 1,
        (1, 3): 3, (8, 7): 1, (2, 4): 2, (5, 1): 1, (0, 5): 3, (4, 7): 1,
    }  # fmt: skip
    caps = {0: 3, 1: 3, 2: 2, 3: 3, 4: 2, 5: 3, 6: 2, 7: 2, 8: 3}
    found = rb.mend(network, (2, 1), candidates=list(cost), cost=cost, one_way=True, max_in_degree=caps)
    assert found.verdict is MendVerdict.IMPOSSIBLE


@pytest.mark.parametrize("seed", range(60))
def test_against_brute_force(seed: int) -> None:
    random_ = random.Random(seed)
    one_way = seed % 2 == 0
    network = nx.gnp_random_graph(5, 0.45, seed=seed)
    absent = [
        (u, v) for u in range(5) for v in range(5) if u != v and not network.has_edge(u, v) and (one_way or u < v)
    ]
    links = random_.sample(absent, min(8, len(absent)))
    cost = {link: random_.choice((0.5, 1.0, 2.0)) for link in links}
    caps = {v: random_.randint(1, 3) for v in network}
    check(network, 2, random_.choice((1, 2)), cost, caps, one_way)
