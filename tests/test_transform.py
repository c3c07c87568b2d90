"""The subset-minimum transform: profiles, best pairs, its blocks, and what it refuses before it allocates."""

from __future__ import annotations

import time
import tracemalloc

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness import Digraph, Undecided, Verdict, robustness_profile
from robustness.answers import Question
from robustness.decision.algorithms import exhaustive, transform
from robustness.decision.ladder import decide
from robustness.limits import Limits
from tests.oracles import brute_profile, digraphs, graphs, is_violating, labelled_digraphs

NO_LIMITS = Limits()


def random_digraph(n: int, p: float, seed: int) -> Digraph:
    return Digraph.from_networkx(nx.gnp_random_graph(n, p, seed=seed, directed=True))


def test_profiles_of_all_labelled_digraphs():
    for n in (1, 2, 3, 4):
        for graph in labelled_digraphs(n):
            assert transform.profile(graph, NO_LIMITS) == brute_profile(graph), list(graph.arcs())


def test_profiles_of_all_graphs():
    for n in range(1, 7):
        for graph in graphs(n):
            assert transform.profile(graph, NO_LIMITS) == brute_profile(graph), list(graph.arcs())


def test_profiles_are_those_of_the_shipped_oracle():
    for graph in [*digraphs(3), *graphs(4), *graphs(5), random_digraph(8, 0.5, 1), random_digraph(8, 0.7, 2)]:
        table = {
            r: max((s for s in range(1, graph.n + 1) if is_robust(graph, r, s)), default=0)
            for r in range(1, (graph.n + 1) // 2 + 1)
        }
        assert transform.profile(graph, NO_LIMITS) == table


def is_robust(graph: Digraph, r: int, s: int) -> bool:
    return exhaustive.decide(graph, r, s, NO_LIMITS).verdict is Verdict.ROBUST


def test_the_empty_graph_has_the_empty_profile():
    assert transform.profile(Digraph([], []), NO_LIMITS) == {}


def test_the_pair_is_a_best_one():
    # It violates the least s that any pair violates, whatever s was asked for.
    for graph in [*digraphs(4), *(random_digraph(9, 0.6, seed) for seed in range(10))]:
        for r, s_max in transform.profile(graph, NO_LIMITS).items():
            answer = transform.decide(graph, r, graph.n, NO_LIMITS)
            assert (answer.pair is None) == (s_max == graph.n)
            if answer.pair is not None:
                assert is_violating(graph, *answer.pair, r, s_max + 1)


@settings(max_examples=40)
@given(n=st.integers(2, 9), p=st.floats(0.1, 0.9), seed=st.integers(0, 10**6), bits=st.integers(0, 5))
def test_the_size_of_a_block_changes_nothing(n, p, seed, bits):
    graph = random_digraph(n, p, seed)
    expected = transform.profile(graph, NO_LIMITS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(transform, "_BLOCK_BITS", bits)
        assert transform.profile(graph, NO_LIMITS) == expected
        for r, s_max in expected.items():
            answer = transform.decide(graph, r, graph.n, NO_LIMITS)
            assert answer.pair is None or is_violating(graph, *answer.pair, r, s_max + 1)


@pytest.mark.parametrize("stride", [1, 4, 1 << 16])
def test_the_choice_of_passes_changes_nothing(stride, monkeypatch):
    graph = random_digraph(11, 0.6, 3)
    expected = transform.profile(graph, NO_LIMITS)
    monkeypatch.setattr(transform, "_SMALL_STRIDE", stride)
    assert transform.profile(graph, NO_LIMITS) == expected


@pytest.mark.parametrize("n", [16, 17, 18])
def test_several_full_blocks(n):
    # Known: a cocktail party of m parts has s_max = n up to r = m - 1, and r* = m - 1.
    complete = transform.profile(Digraph.from_networkx(nx.complete_graph(n)), NO_LIMITS)
    assert set(complete.values()) == {n}
    if n % 2 == 0:
        m = n // 2
        party = transform.profile(Digraph.from_networkx(nx.complete_multipartite_graph(*[2] * m)), NO_LIMITS)
        assert party == dict.fromkeys(range(1, m), n) | {m: 0}


def test_relabelling_changes_no_profile():
    G = nx.gnp_random_graph(17, 0.6, seed=4, directed=True)
    order = np.random.default_rng(5).permutation(17).tolist()
    first, second = Digraph.from_networkx(G), Digraph.from_networkx(nx.relabel_nodes(G, dict(enumerate(order))))
    assert first != second
    assert transform.profile(first, NO_LIMITS) == transform.profile(second, NO_LIMITS)


def test_memory_is_compared_before_it_is_taken(monkeypatch):
    graph = random_digraph(20, 0.5, 1)
    monkeypatch.setattr(transform, "available_memory", lambda: 1_000_000)
    tracemalloc.start()
    answer = transform.decide(graph, 2, 1, NO_LIMITS)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert answer.verdict is Verdict.UNDECIDED
    assert "20 nodes" in answer.stats["reason"]
    assert peak < 1_000_000
    with pytest.raises(Undecided, match="memory"):
        transform.profile(graph, NO_LIMITS)


@pytest.mark.parametrize("n", [61, 5000])
def test_hopeless_sizes_are_refused_at_once(n):
    graph = Digraph.from_networkx(nx.cycle_graph(n))
    answer = transform.decide(graph, 2, 1, NO_LIMITS)  # had it been tried: 2^61 sets
    assert answer.verdict is Verdict.UNDECIDED
    assert "subset-search" in answer.stats["reason"]


@pytest.mark.parametrize("n", [10, 18, 20])
def test_the_estimate_covers_what_is_allocated(n):
    graph = random_digraph(n, 0.5, 1)
    _ = graph.in_masks
    tracemalloc.start()
    transform.decide(graph, 2, 1, NO_LIMITS)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= transform.memory_needed(n) + 50_000  # Python's own objects
    assert transform.memory_needed(n) < 3 * (1 << n) + (1 << 22)


def test_available_memory_is_that_of_this_machine():
    assert 1 << 20 < transform.available_memory() < 1 << 50


def test_available_memory_where_the_system_says_little(monkeypatch):
    def nothing(*_args: object, **_options: object) -> str:
        raise OSError

    monkeypatch.setattr(transform.Path, "read_text", nothing)
    physical = transform.available_memory()
    assert physical > 1 << 20
    monkeypatch.setattr(transform.os, "sysconf", nothing)
    assert transform.available_memory() == 1 << 30


def test_available_memory_is_no_more_than_the_control_group_leaves(monkeypatch):
    files = {
        "meminfo": "MemTotal: 9 kB\nMemAvailable:    8000 kB\n",
        "memory.current": "1000\n",
        "memory.max": "5000\n",
    }
    monkeypatch.setattr(transform.Path, "read_text", lambda path, **_: files[path.name])
    assert transform.available_memory() == 4000
    files["memory.max"] = "max\n"
    assert transform.available_memory() == 8000 * 1024


@pytest.mark.parametrize("seconds", [0.0, 0.15])
def test_a_passed_deadline_is_no_verdict(seconds):
    graph = random_digraph(23, 0.9, 1)
    limits = Limits(deadline=time.monotonic() + seconds)
    with pytest.raises(Undecided, match="time limit"):
        transform.profile(graph, limits)
    answer = transform.decide(graph, 3, 1, limits)
    assert answer.verdict is Verdict.UNDECIDED
    assert "time limit" in answer.stats["reason"]


def test_progress_is_reported_and_may_interrupt():
    seen = []

    def interrupt(progress):
        seen.append(progress)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        transform.profile(random_digraph(23, 0.5, 1), Limits(progress=interrupt))
    assert seen[0].nodes > 0
    assert seen[0].note


def test_a_profile_that_a_limit_cuts_short_is_told_as_far_as_it_goes(monkeypatch):
    graph = random_digraph(17, 0.6, 1)
    whole = transform.profile(graph, NO_LIMITS)
    assert sum(map(bool, whole.values())) > 2
    work = transform._Lattice.least_exempt

    def stopping(self, r):
        if r == 3:
            raise Undecided("the time limit was reached: raise it")
        return work(self, r)

    monkeypatch.setattr(transform._Lattice, "least_exempt", stopping)
    with pytest.raises(Undecided, match="time limit") as stopped:
        transform.profile(graph, NO_LIMITS)
    assert dict(stopped.value.profile) == {1: whole[1], 2: whole[2]}
    assert stopped.value.bounds.lower.value <= whole[3] <= stopped.value.bounds.upper.value == whole[2]


def test_up_to_28_nodes_one_transform_for_every_r_up_to_one_beyond_the_greatest(monkeypatch):
    """And without the memory for it, the descent by search."""
    graph = random_digraph(23, 0.4, 2)
    asked = []
    work = transform._Lattice.least_exempt
    monkeypatch.setattr(transform._Lattice, "least_exempt", lambda self, r: (asked.append(r), work(self, r))[1])
    table = robustness_profile(graph)
    greatest = max(r for r, s in table.items() if s)
    assert asked == list(range(1, greatest + 2))
    monkeypatch.setattr(transform, "available_memory", lambda: 1 << 20)
    assert robustness_profile(graph) == table


def test_where_the_search_takes_longer_the_transform_decides_and_both_agree():
    for seed in range(2):
        graph = nx.gnp_random_graph(22, 0.9, seed=seed)
        profile = rb.robustness_profile(graph)
        for r, largest in profile.items():
            for s in {min(max(s, 1), 22) for s in (2, largest - 1, largest, largest + 1, r)}:
                answer = rb.check_rs_robustness(graph, r, s)
                assert answer.verdict is (Verdict.ROBUST if s <= largest else Verdict.NOT_ROBUST), (seed, r, s)
    hard = nx.gnp_random_graph(24, 0.9, seed=0)
    assert rb.check_rs_robustness(hard, 9, 9).algorithm == "transform"
    assert rb.check_rs_robustness(hard, 9, 9, algorithm="subset-search", time_limit=0.5).verdict is Verdict.UNDECIDED


@pytest.mark.parametrize("why", ["a budget of steps", "too little memory", "s = 1", "cubes that are written down"])
def test_what_stays_with_the_search(why, monkeypatch, tmp_path):
    hard, limits, question = nx.gnp_random_graph(24, 0.9, seed=0), Limits(steps=10**7), (9, 9)
    monkeypatch.setattr("robustness.decision.algorithms.transform.decide", lambda *_: pytest.fail("the transform ran"))
    if why == "too little memory":
        limits = Limits.of(0.3, 1, 0)
        monkeypatch.setattr("robustness.decision.algorithms.transform.memory_suffices", lambda n: False)
    elif why == "s = 1":
        limits, question = Limits(), (9, 1)
    elif why == "cubes that are written down":
        limits = Limits.of(0.3, 1, 0).spread_over(state=tmp_path / "journal")
    answer = decide(Question(Digraph.from_networkx(hard), *question), limits)
    assert answer.verdict is (Verdict.ROBUST if why == "s = 1" else Verdict.UNDECIDED)
