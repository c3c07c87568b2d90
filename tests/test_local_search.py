"""Pairs found by heuristics: every one violates the definition, and the known ones are found."""

from __future__ import annotations

import itertools

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from networkx.generators.atlas import graph_atlas_g

import robustness as rb
from robustness.decision.bounds.local_search import TINY, best_upper_bound, fewest_exempt, find_violation
from robustness.decision.front import robustness_profile
from robustness.definitions import is_violation, r_reachable_ids
from robustness.limits import Steps


def digraph(graph: nx.Graph) -> rb.Digraph:
    return rb.Digraph.from_networkx(graph)


def exempt(graph: rb.Digraph, pair: tuple[frozenset[int], frozenset[int]], r: int) -> int:
    return sum(len(r_reachable_ids(graph, side, r)) for side in pair)


@st.composite
def digraphs(draw: st.DrawFn, least: int = 13, most: int = 18) -> rb.Digraph:
    n = draw(st.integers(least, most))
    density = draw(st.sampled_from([0.15, 0.3, 0.5, 0.8]))
    seed = draw(st.integers(0, 2**32 - 1))
    return digraph(nx.gnp_random_graph(n, density, seed=seed, directed=draw(st.booleans())))


@settings(max_examples=40, deadline=None)
@given(digraphs(), st.integers(1, 6), st.integers(1, 4))
def test_every_pair_found_is_a_violation(graph: rb.Digraph, r: int, s: int) -> None:
    pair = find_violation(graph, r, s, restarts=3)
    assert pair is None or is_violation(graph, pair.first, pair.second, r, s)


@settings(max_examples=25, deadline=None)
@given(digraphs())
def test_the_upper_bound_comes_with_its_pair_and_every_improvement_is_one(graph: rb.Digraph) -> None:
    steps = []
    upper, pair = best_upper_bound(graph, restarts=3, on_pair=lambda u, p: steps.append((u, p)))
    assert steps[-1] == (upper, pair)
    assert [u for u, _ in steps] == sorted({u for u, _ in steps}, reverse=True)
    assert all(is_violation(graph, p.first, p.second, u + 1, 1) for u, p in steps)
    assert upper <= max(1, int(graph.in_degrees.min()))


@settings(max_examples=20, deadline=None)
@given(digraphs(), st.integers(1, 5))
def test_the_count_of_exempt_nodes_is_that_of_the_pair(graph: rb.Digraph, r: int) -> None:
    found = fewest_exempt(graph, r, restarts=3)
    if found is not None:
        count, pair = found
        assert count == exempt(graph, pair, r)
        assert is_violation(graph, pair.first, pair.second, r, count + 1) or count == graph.n


def test_on_all_small_graphs_the_upper_bound_is_not_below_the_truth() -> None:
    for graph in graph_atlas_g()[:209]:
        small = digraph(graph)
        upper, pair = best_upper_bound(small)
        if small.n < 2:
            assert (upper, pair) == (small.n, None)
            continue
        assert pair is not None
        assert is_violation(small, pair.first, pair.second, upper + 1, 1)


@pytest.mark.parametrize(
    ("graph", "robustness"),
    [
        (nx.gnp_random_graph(25, 0.5, seed=1), 6),
        (nx.gnp_random_graph(40, 0.5, seed=1), 10),
        (nx.gnp_random_graph(50, 0.5, seed=1), 13),
        (nx.gnp_random_graph(60, 0.5, seed=1), 15),
        (nx.gnp_random_graph(40, 0.8, seed=1), 16),
        (nx.gnp_random_graph(50, 0.8, seed=1), 20),
        (nx.random_regular_graph(10, 40, seed=1), 5),
        (nx.random_regular_graph(6, 40, seed=1), 3),
        (nx.barabasi_albert_graph(120, 8, seed=1), 8),
        (nx.circulant_graph(200, range(1, 11)), 10),
        (nx.gnp_random_graph(50, 0.5, seed=1, directed=True), 13),
        (nx.petersen_graph(), 1),
        (nx.heawood_graph(), 1),
        (nx.hypercube_graph(6), 1),
        (nx.grid_2d_graph(12, 15), 1),
        (nx.random_labeled_tree(50, seed=1), 1),
        (nx.cycle_graph(30), 1),
        (nx.icosahedral_graph(), 2),
        (nx.hoffman_singleton_graph(), 3),
        (nx.complete_graph(15), 8),
        (nx.complete_bipartite_graph(6, 9), 5),
        (nx.complete_multipartite_graph(*[2] * 8), 7),
        (nx.wheel_graph(20), 2),
        (nx.disjoint_union(nx.complete_graph(20), nx.complete_graph(20)), 0),
    ],
    ids=str,
)
def test_known_pairs_are_found(graph: nx.Graph, robustness: int) -> None:
    upper, _ = best_upper_bound(digraph(graph), lower=robustness, restarts=2000)
    assert upper == robustness or graph.number_of_nodes() <= TINY


def test_the_search_for_one_robustness_is_exact() -> None:
    rng = np.random.default_rng(7)
    for _ in range(60):
        graph = nx.gnp_random_graph(20, 0.08, seed=int(rng.integers(2**31)), directed=True)
        reaches_all = any(len(nx.descendants(graph, v)) == 19 for v in graph)
        assert (find_violation(digraph(graph), 1) is None) == reaches_all


@pytest.mark.parametrize(("seed", "directed"), [(0, False), (1, False), (2, True), (3, True)])
def test_fewest_exempt_meets_the_exact_profile(seed: int, directed: bool) -> None:
    graph = nx.gnp_random_graph(13, 0.6, seed=seed, directed=directed)
    profile = robustness_profile(graph, algorithm="transform")
    greatest = max(r for r, s in profile.items() if s)
    for r, s in profile.items():
        found = fewest_exempt(digraph(graph), r, restarts=60)
        count = 13 if found is None else found[0]
        assert count == s if r >= greatest else count >= s


def test_no_pair_exists_below_two_nodes_or_for_r_zero() -> None:
    assert find_violation(rb.Digraph([], []), 1) is None
    assert find_violation(rb.Digraph("a", []), 1) is None
    assert find_violation(rb.Digraph("ab", []), 0) is None
    assert best_upper_bound(rb.Digraph([], [])) == (0, None)
    assert fewest_exempt(rb.Digraph("a", []), 1) is None


def test_two_nodes() -> None:
    for arcs, robustness in (([], 0), ([("a", "b")], 1), ([("a", "b"), ("b", "a")], 1)):
        graph = rb.Digraph("ab", arcs)
        upper, pair = best_upper_bound(graph)
        assert pair is not None
        assert is_violation(graph, pair.first, pair.second, upper + 1, 1)
        assert upper == robustness


def test_labels_of_equal_text_stay_apart() -> None:
    graph = digraph(nx.Graph(itertools.combinations([1, "1", 2, "2", (1, 2), ("1", 2)], 2)))
    assert best_upper_bound(graph)[0] == 3


def test_a_seed_fixes_the_pair_and_a_stop_ends_the_search() -> None:
    graph = digraph(nx.random_regular_graph(10, 60, seed=3))
    runs = [find_violation(graph, 6, seed=5) for _ in range(2)]
    assert runs[0] is not None
    assert runs[0] == runs[1]
    assert find_violation(graph, 4, steps=Steps(stop=lambda: True)) is None


def test_large_sparse_graphs_take_linear_memory_and_little_time() -> None:
    graph = digraph(nx.circulant_graph(20_000, [1, 2]))
    pair = find_violation(graph, 3)
    assert pair is not None
    assert "in_words" not in vars(graph)
    assert "in_masks" not in vars(graph)


def test_pairs_that_are_rare_are_found() -> None:
    """Of 2^160 halves some hundreds are violating pairs; a counted budget of half a second finds one of each graph."""
    for seed in (101, 107, 108):
        graph = digraph(nx.random_regular_graph(10, 160, seed=seed))
        assert find_violation(graph, 5, steps=Steps(500_000_000), restarts=10**6) is not None
