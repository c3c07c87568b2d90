"""Covers, rigid components, and the lemma on spreading, against every small graph."""

from __future__ import annotations

import random
from itertools import combinations

import networkx as nx
import pytest
from networkx.generators.atlas import graph_atlas_g

import robustness as rb
from robustness.mending.covers import lacking, rigid_components, room, starts_of
from robustness.mending.demands import Side, bits, worth
from robustness.mending.goal import Part

PRIME = (1 << 31) - 1


def masks(graph: nx.Graph, n: int) -> list[int]:
    return [sum(1 << j for j in graph[i]) for i in range(n)]


def rank_in_the_plane(graph: nx.Graph, rng: random.Random) -> int:
    """Return the rank of the rigidity matrix at random places, over a prime field."""
    places = {i: (rng.randrange(PRIME), rng.randrange(PRIME)) for i in graph}
    pivots: dict[tuple[int, int], dict[tuple[int, int], int]] = {}
    for u, v in graph.edges:
        row = {(end, k): sign * (places[u][k] - places[v][k]) for end, sign in ((u, 1), (v, -1)) for k in (0, 1)}
        while row := {key: value % PRIME for key, value in row.items() if value % PRIME}:
            first = min(row)
            if first not in pivots:
                inverse = pow(row[first], PRIME - 2, PRIME)
                pivots[first] = {key: value * inverse for key, value in row.items()}
                break
            factor, pivot = row[first], pivots[first]
            row = {key: row.get(key, 0) - factor * pivot.get(key, 0) for key in row.keys() | pivot.keys()}
    return len(pivots)


def test_rigid_components_cover_the_links_and_their_rooms_add_up_to_the_rank() -> None:
    rng = random.Random(1)
    for _ in range(150):
        n = rng.randint(2, 12)
        graph = nx.gnm_random_graph(n, rng.randint(0, 2 * n), seed=rng.randrange(10**6))
        components = rigid_components(masks(graph, n))
        assert all(any(V >> u & 1 and V >> v & 1 for V in components) for u, v in graph.edges)
        assert all((V & W).bit_count() <= 1 for V, W in combinations(components, 2))
        assert sum(room(V.bit_count(), 2) for V in components) == rank_in_the_plane(graph, rng)


@pytest.mark.parametrize("s", [1, 2, 3])
def test_the_lemma_on_every_robust_graph_of_up_to_six_nodes(s: int) -> None:
    """Of each, some links are said to be new: what the covers of the others demand is there."""
    rng = random.Random(s)
    part, spread, slow = Part(2, s), 0, 0
    for graph in graph_atlas_g():
        n = graph.number_of_nodes()
        if not 2 <= n <= 6 or s > n or not rb.is_rs_robust(graph, 2, s):
            continue
        for _ in range(6):
            links = list(graph.edges)
            old = nx.Graph(rng.sample(links, rng.randint(1, len(links))))
            old.add_nodes_from(range(n))
            cover = rigid_components(masks(old, n))
            new = sum(not any(V >> u & 1 and V >> v & 1 for V in cover) for u, v in links)
            if any(worth(Side(part, 0, U), masks(graph, n)) < s for U in starts_of(masks(old, n))):
                spread += 1
                assert new >= lacking(cover, n, 2), (links, old.edges)
            else:
                slow += 1
    assert spread
    assert slow


def test_the_lemma_is_about_two_nodes_that_are_not_worth_enough() -> None:
    """This graph is (2,2)-robust with fewer than 2n - 3 links, the least number up to n = 7: nothing there spreads."""
    fours = [(7, 8, 10, 11), (6, 9, 12, 13), (6, 7, 11, 12), (6, 8, 10, 13), (7, 9, 11, 13), (8, 9, 10, 12)]
    graph = nx.Graph((u, v) for u, others in enumerate(fours) for v in others)
    heard = masks(graph, 14)
    assert rb.is_rs_robust(graph, 2, 2)
    assert graph.number_of_edges() == 24 < 2 * 14 - 3
    assert lacking(rigid_components(heard), 14, 2) == 1
    assert all(worth(Side(Part(2, 2), 0, U), heard) == 2 for U in starts_of(heard))


def test_rooms() -> None:
    assert [room(size, 2) for size in range(5)] == [0, 0, 1, 3, 5]
    assert [room(size, 3) for size in range(6)] == [0, 0, 1, 3, 6, 9]
    assert list(bits(starts_of([2, 1])[0])) == [0, 1]
