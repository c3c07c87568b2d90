"""What holds, and what does not, of the paper's counterexample graphs: by exact search."""

from __future__ import annotations

import json

import networkx as nx
import numpy as np
import pytest

import robustness as rb
from robustness.constructions import five_node_figure, two_f_robust_counterexample
from robustness.constructions.small_graphs import batch_profiles
from robustness.digraph import as_digraph
from robustness.graph_search import find_graph
from robustness.traps import is_trap


def profile_of(G):
    return batch_profiles(np.array([as_digraph(G).in_masks], dtype=np.int64))[0].tolist()


def least_in_degree(G):
    return int(as_digraph(G).in_degrees.min())


@pytest.mark.parametrize("f", [1, 2])
def test_paper_variant(f):
    G = two_f_robust_counterexample(f, variant="paper")
    profile = profile_of(G)
    assert len(G) == 7 * f
    assert profile[2 * f] >= 1
    assert profile[2 * f + 1] == 0
    assert profile[f + 1] == f, "not (f+1,f+1)-robust, against the proof of Proposition 1"
    assert least_in_degree(G) == max(2, 3 * f - 1)


@pytest.mark.parametrize("f", [1, 2])
def test_paper_variant_read_as_undirected_links_gives_the_same_verdicts(f):
    profile = profile_of(two_f_robust_counterexample(f).to_undirected())
    assert (profile[2 * f] >= 1, profile[2 * f + 1] == 0, profile[f + 1]) == (True, True, f)


def test_paper_variant_for_three():
    G = two_f_robust_counterexample(3)
    assert rb.is_r_robust(G, 6)
    assert not rb.is_r_robust(G, 7)
    assert rb.is_rs_robust(G, 4, 3)
    assert not rb.is_rs_robust(G, 4, 4)
    assert least_in_degree(G) == 8


@pytest.mark.parametrize("f", [1, 2, 3])
def test_corrected_variant_has_every_property_claimed(f):
    G = two_f_robust_counterexample(f, variant="corrected")
    profile = profile_of(G)
    assert len(G) == 3 * f + 2
    assert profile[2 * f] >= 1
    assert sum(s > 0 for s in profile[1:]) == 2 * f, "not (2f+1)-robust"
    assert profile[f + 1] == len(G)
    assert least_in_degree(G) == 3 * f >= 2 * f + 1


@pytest.mark.parametrize("f", range(4, 9))
@pytest.mark.parametrize("variant", ["paper", "corrected"])
def test_beyond_three(f, variant):
    G = two_f_robust_counterexample(f, variant)
    paper = variant == "paper"
    assert len(G) == (7 * f if paper else 4 * f - 1)
    assert least_in_degree(G) == (3 * f - 1 if paper else 3 * f)
    assert rb.is_r_robust(G, 2 * f)
    assert not rb.is_r_robust(G, 2 * f + 1)
    assert rb.is_rs_robust(G, f + 1, f if paper else len(G))
    assert rb.is_rs_robust(G, f + 1, f + 1) != paper


@pytest.mark.parametrize("f", [1, 2, 3])
def test_corrected_up_to_three_is_a_clique_without_a_matching(f):
    G = two_f_robust_counterexample(f, "corrected")
    missing = nx.complement(G)
    assert missing.size() == f + 1
    assert max(d for _, d in missing.degree) == 1


def test_for_two_there_is_one_on_seven_nodes():
    G = find_graph(7, ["4-robust", "(3,3)-robust", "min-degree>=5", "trap(2)"]).graph
    missing = nx.complement(G)
    assert sorted(d for _, d in missing.degree) == [0, 0, 0, 1, 1, 1, 1]
    assert is_trap(G, 2, **G.graph["trap"])


@pytest.mark.parametrize("f", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("variant", ["paper", "corrected"])
def test_carries_its_trap(f, variant):
    G = two_f_robust_counterexample(f, variant)
    trap = json.loads(json.dumps(G.graph["trap"]))
    assert set(trap) == {"M", "S1", "S2"}
    assert len(trap["M"]) == f
    assert is_trap(G, f, **trap)
    assert not is_trap(G, f - 1, **trap)


def test_corrected_for_one_is_the_wheel():
    assert nx.is_isomorphic(two_f_robust_counterexample(1, "corrected"), nx.wheel_graph(5))


@pytest.mark.parametrize(("reading", "s"), [("wheel", 5), ("wheel-crossed", 5), ("digraph", 2)])
def test_five_node_figure(reading, s):
    G = five_node_figure(reading)
    assert sorted(G) == [1, 2, 3, 4, 5]
    assert profile_of(G) == [5, 5, s, 0]
    assert G.graph["trap"] == {"M": [4], "S1": [1, 5], "S2": [2, 3]}
    assert is_trap(G, 1, **G.graph["trap"])


def test_wheels_of_the_figure_have_their_rims():
    assert set(five_node_figure("wheel")[1]) == {2, 4, 5}
    assert set(five_node_figure("wheel-crossed")[1]) == {3, 4, 5}
