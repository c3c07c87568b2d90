"""Every closed form agrees with the definition, over the ranges that the docstrings name."""

from __future__ import annotations

import json

import networkx as nx
import numpy as np
import pytest

import robustness as rb
from robustness import constructions
from robustness.constructions import FAMILIES, build, known_robustness
from robustness.constructions.families import multipartite_r, platoon_threshold, sparse_parts
from robustness.constructions.small_graphs import batch_profiles, graphs_up_to_isomorphism
from robustness.errors import InvalidParameter

#: Parameters of every family over which its value is compared; random families with three seeds.
RANGES = {
    "complete": [{"n": n} for n in range(13)],
    "path": [{"n": n} for n in range(2, 13)],
    "cycle": [{"n": n} for n in range(3, 13)],
    "star": [{"n": n} for n in range(2, 13)],
    "grid": [{"rows": a, "columns": b} for a in range(1, 5) for b in range(1, 5) if a * b > 1],
    "hypercube": [{"dimension": d} for d in range(1, 5)],
    "petersen": [{}],
    "wheel": [{"n": n} for n in range(4, 13)],
    "complete-bipartite": [{"a": a, "b": b} for a in range(1, 8) for b in range(1, 14 - a)],
    "complete-multipartite": [
        {"sizes": sizes}
        for sizes in [
            (2, 1, 1),
            (3, 2, 2),
            (4, 4, 1),
            (3, 3, 3),
            (5, 2, 1, 1),
            (4, 3, 2, 1),
            (6, 1, 1, 1, 1, 1),
            (7, 4),
        ]
    ],
    "cocktail-party": [{"m": m} for m in range(2, 8)],
    "circulant": [{"n": n, "k": k} for k in range(1, 7) for n in range(2 * k + 1, 14)],
    "directed-circulant": [{"n": n, "k": k} for k in range(1, 9) for n in range(k + 1, 14)],
    "platoon": [{"n": n, "k": k} for k in range(1, 9) for n in range(1, 14)],
    "predecessor-platoon": [
        {"n": n, "predecessors": p, "leaders": m} for n in range(1, 9) for m in range(1, n + 1) for p in range(4)
    ],
    "sparse-robust": [{"n": n, "r": r} for r in range(1, 6) for n in range(2 * r - 1, 14)],
    "growth": [{"n": n, "r": r, "seed": seed} for r in range(1, 5) for n in range(2 * r - 1, 12) for seed in range(3)],
    "preferential-attachment": [
        {"n": n, "r": r, "seed": seed} for r in range(1, 5) for n in range(2 * r - 1, 12) for seed in range(3)
    ],
    "random-geometric": [{"n": n, "radius": 0.5} for n in range(5)],
    "erdos-renyi": [{"n": n, "p": 0.5, "directed": directed} for n in range(5) for directed in (False, True)],
    "two-f-robust": [{"f": f, "variant": variant} for f in (1, 2) for variant in ("paper", "corrected")],
    "five-node-figure": [{"reading": reading} for reading in constructions.FIVE_NODE_READINGS],
}
#: The rest of the ranges that docstrings name, slower.
FURTHER = {
    "circulant": [{"n": n, "k": k} for k in range(1, 8) for n in range(14, 17) if n > 2 * k],
    "directed-circulant": [{"n": n, "k": k} for n in range(14, 17) for k in range(1, n)],
    "platoon": [{"n": n, "k": k} for n in range(14, 17) for k in range(1, n)],
}


def profile_of(G):
    """The whole profile of one graph; batch profiles are compared with the definition in test_small_graphs."""
    graph = rb.Digraph.from_networkx(G)
    return batch_profiles(np.array([graph.in_masks], dtype=np.int64).reshape(1, graph.n))[0].tolist()


def test_every_family_has_a_range_here():
    assert set(RANGES) == set(FAMILIES)


@pytest.mark.parametrize(
    ("name", "ranges"),
    [*RANGES.items(), *(pytest.param(*further, marks=pytest.mark.slow) for further in FURTHER.items())],
)
def test_value(name, ranges):
    for parameters in ranges:
        profile = profile_of(build(name, **parameters))
        known = known_robustness(name, **parameters)
        if known is not None:
            assert known.r == max((r for r, s in enumerate(profile) if r and s), default=0), (parameters, profile)
            assert known.s is None or known.s == profile[known.r], (parameters, profile)


@pytest.mark.parametrize("name", [name for name in RANGES if name not in ("random-geometric", "erdos-renyi")])
def test_something_is_known(name):
    assert any(known_robustness(name, **parameters) is not None for parameters in RANGES[name])


@pytest.mark.parametrize("name", RANGES)
def test_graphs_are_plain_and_numbered_and_reproducible(name):
    parameters = RANGES[name][-1]
    graph = build(name, **parameters)
    first = 1 if name == "five-node-figure" else 0
    assert sorted(graph) == list(range(first, first + len(graph)))
    assert not graph.is_multigraph()
    assert nx.number_of_selfloops(graph) == 0
    assert nx.utils.graphs_equal(graph, build(name, **parameters))
    recorded = json.loads(json.dumps(graph.graph["family"]))
    assert nx.utils.graphs_equal(graph, build(recorded["name"], **recorded["parameters"]))


@pytest.mark.parametrize("name", RANGES)
def test_every_family_says_what_it_is(name):
    family = FAMILIES[name]
    assert family.summary.endswith(".") or family.summary.endswith(")")
    assert family.value


def test_multipartite_formula_on_every_partition():
    def partitions(n, largest):
        if n == 0:
            yield ()
        for part in range(min(n, largest), 0, -1):
            for rest in partitions(n - part, part):
                yield (part, *rest)

    for n in range(2, 11):
        for sizes in partitions(n, n - 1):
            profile = profile_of(build("complete-multipartite", sizes=sizes))
            assert multipartite_r(sizes) == sum(s > 0 for s in profile[1:]), sizes


def test_sparse_parts_reach_r_far_out():
    for r in range(2, 13):
        for n in range(2 * r - 1, 3 * r + 3):
            assert multipartite_r(sparse_parts(n, r)) == r


def test_sparse_robust_graphs_have_the_fewest_edges_up_to_seven_nodes():
    for n in range(3, 8):
        batch = graphs_up_to_isomorphism(n)
        profiles, edges = batch_profiles(batch), np.bitwise_count(batch).sum(axis=1) // 2
        for r in range(2, (n + 1) // 2 + 1):
            assert build("sparse-robust", n=n, r=r).size() == edges[profiles[:, r] > 0].min(), (n, r)


@pytest.mark.parametrize("r", range(1, 8))
def test_sparse_robust_edge_counts(r):
    assert constructions.sparse_robust(2 * r - 1, r).size() == 3 * r * (r - 1) // 2
    assert constructions.sparse_robust(3 * r + 2, r).size() == r * (2 * r + 2)


def test_seeds_matter():
    first, second = (build("growth", n=30, r=3, seed=seed) for seed in (0, 1))
    assert not nx.utils.graphs_equal(first, second)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("complete", {"n": -1}),
        ("path", {"n": 1}),
        ("cycle", {"n": 2}),
        ("star", {"n": 1}),
        ("grid", {"rows": 1, "columns": 1}),
        ("hypercube", {"dimension": 0}),
        ("wheel", {"n": 3}),
        ("complete-bipartite", {"a": 0, "b": 3}),
        ("complete-multipartite", {"sizes": (3,)}),
        ("cocktail-party", {"m": 1}),
        ("circulant", {"n": 4, "k": 2}),
        ("directed-circulant", {"n": 2, "k": 2}),
        ("platoon", {"n": 3, "k": 0}),
        ("predecessor-platoon", {"n": 2, "leaders": 3}),
        ("sparse-robust", {"n": 4, "r": 3}),
        ("growth", {"n": 4, "r": 3}),
        ("preferential-attachment", {"n": 4, "r": 3}),
        ("random-geometric", {"n": 4, "radius": float("nan")}),
        ("erdos-renyi", {"n": 4, "p": 1.5}),
        ("two-f-robust", {"f": 0}),
        ("two-f-robust", {"f": 1, "variant": "other"}),
        ("five-node-figure", {"reading": "other"}),
        ("wheel", {}),
        ("wheel", {"n": 5, "k": 2}),
        ("wheels", {"n": 5}),
        ("wheel", {"n": "5"}),
    ],
)
def test_out_of_range_is_refused_in_one_line(name, parameters):
    with pytest.raises(InvalidParameter) as caught:
        build(name, **parameters)
    assert "\n" not in str(caught.value)


class TestBeyondExhaustion:
    """The ranges that the docstrings name are decided by the exact search."""

    @pytest.mark.parametrize("k", [*range(4, 16), pytest.param(40, marks=pytest.mark.slow)])
    def test_platoon_threshold(self, k):
        n = platoon_threshold(k)
        assert rb.is_r_robust(constructions.platoon(n, k), k)
        assert not rb.is_r_robust(constructions.platoon(n - 1, k), k)

    @pytest.mark.parametrize(("n", "k"), [(30, 9), (40, 6), (44, 13), (64, 5)])
    def test_circulant(self, n, k):
        assert self.largest_r_is(constructions.circulant(n, k), known_robustness("circulant", n=n, k=k).r)

    @pytest.mark.parametrize(("n", "k"), [(30, 9), (31, 12), (40, 16), (39, 20)])
    def test_directed_circulant(self, n, k):
        assert self.largest_r_is(
            constructions.directed_circulant(n, k), known_robustness("directed-circulant", n=n, k=k).r
        )

    @pytest.mark.slow
    def test_all_circulants_of_the_docstring(self):
        for k in range(1, 21):
            for n in range(2 * k + 2, 65):
                assert self.largest_r_is(constructions.circulant(n, k), k), (n, k)
        for n in range(3, 41):
            for k in range(1, n - 1):
                known = known_robustness("directed-circulant", n=n, k=k)
                assert self.largest_r_is(constructions.directed_circulant(n, k), known.r), (n, k)

    def largest_r_is(self, G, r):
        return rb.is_r_robust(G, r) and not rb.is_r_robust(G, r + 1)

    @pytest.mark.parametrize(
        ("name", "parameters"),
        [
            ("circulant", {"n": 65, "k": 3}),
            ("platoon", {"n": 200, "k": 41}),
            ("directed-circulant", {"n": 41, "k": 3}),
            ("platoon", {"n": 14, "k": 7}),
        ],
    )
    def test_nothing_is_claimed_out_of_the_ranges(self, name, parameters):
        assert known_robustness(name, **parameters) is None
