"""The shortcuts at work on sequences long enough for each of them, against the naive loop that has none."""

from __future__ import annotations

import time

import networkx as nx
import numpy as np
import pytest

import robustness as rb
from robustness.decision.algorithms.exhaustive import decide as exhaustive
from robustness.limits import Limits
from robustness.time_varying import TimeVaryingGraph, UnionVerdict, check_joint_robustness
from robustness.time_varying.growth import Arcs, Seed, find_seed, grow
from robustness.time_varying.sequence import SlidingUnion
from robustness.time_varying.unions import RULES, UnionDecider


def on_off(graph: nx.Graph, steps: int, off: float, on: float, seed: int) -> TimeVaryingGraph:
    """Return the links of ``graph`` going off and on, each at its own times."""
    draw = np.random.default_rng(seed)
    links = list(graph.edges())
    up = np.ones(len(links), dtype=bool)
    rows = []
    for _ in range(steps):
        change = draw.random(len(links))
        up = np.where(up, change >= off, change < on)
        rows.append([links[k] for k in np.flatnonzero(up)])
    return TimeVaryingGraph.from_arcs(graph, rows, directed=False)


def platoon(n: int, k: int) -> nx.Graph:
    return nx.Graph([(u, v) for u in range(n) for v in range(u + 1, min(n, u + k + 1))])


def naive(sequence: TimeVaryingGraph, r: int, s: int, length: int) -> list[bool]:
    """Return the verdict on every window, each union built and decided on its own."""
    unions = (sequence.union(start, length) for start in sequence.window_starts(length))
    return [rb.is_rs_robust(union, r, s, algorithm="transform") for union in unions]


CASES = {
    "platoon": (on_off(platoon(12, 5), 120, 0.1, 0.3, 1), 3, 1, 3),
    "platoon with s = 2": (on_off(platoon(11, 5), 120, 0.2, 0.3, 2), 2, 2, 3),
    "regular": (on_off(nx.random_regular_graph(6, 12, seed=3), 200, 0.1, 0.2, 3), 2, 1, 2),
    "sparse": (on_off(nx.cycle_graph(9), 80, 0.3, 0.3, 4), 1, 1, 2),
}


@pytest.mark.parametrize("name", CASES)
def test_all_windows_as_in_the_naive_loop(name: str) -> None:
    sequence, r, s, length = CASES[name]
    found = check_joint_robustness(sequence, r, s, window=length, all_windows=True)
    verdicts = [found.union_verdicts[u].verdict is rb.Verdict.ROBUST for u in found.window_unions]
    assert verdicts == naive(sequence, r, s, length)
    assert len(set(verdicts)) == 2, "the case is one in which some windows hold and some fail"


@pytest.mark.parametrize("name", CASES)
def test_smallest_window_as_in_the_naive_loop(name: str) -> None:
    sequence, r, s, _ = CASES[name]
    found = check_joint_robustness(sequence, r, s)
    assert all(naive(sequence, r, s, found.window))
    assert not all(naive(sequence, r, s, found.window - 1))


@pytest.mark.parametrize("rule", sorted(RULES))
def test_each_shortcut_saves_something_and_changes_nothing(rule: str) -> None:
    with_it = without = 0
    for sequence, r, s, length in CASES.values():
        results = [
            check_joint_robustness(sequence, r, s, window=length, all_windows=True, reuse=rules)
            for rules in (RULES, RULES - {rule})
        ]
        assert results[0].failing_starts() == results[1].failing_starts()
        with_it += work_saved(results[0].stats, rule)
        without += work_saved(results[1].stats, rule)
    assert with_it > without


def work_saved(stats: dict[str, int], rule: str) -> int:
    """Return how many windows a rule settled; looking ahead shows in the proofs that later windows find."""
    return stats.get("subgraph" if rule == "ahead" else rule, 0)


@pytest.mark.parametrize("name", CASES)
def test_every_verdict_carries_evidence_that_holds(name: str) -> None:
    sequence, r, s, length = CASES[name]
    found = check_joint_robustness(sequence, r, s, window=length, all_windows=True)
    rules = set()
    for graph, union in zip(found.unions, found.union_verdicts, strict=True):
        rules.add(union.rule)
        if union.verdict is rb.Verdict.NOT_ROBUST:
            assert_pair(graph, union, r, s)
        elif union.growth is not None:
            assert_growth(graph, union, r, s)
    assert rules <= RULES | {"exact"}


def assert_pair(graph: rb.Digraph, union: UnionVerdict, r: int, s: int) -> None:
    reached = []
    for side in union.witness:
        ids = graph.ids(side)
        reached.append({i for i in ids if len(set(graph.in_neighbours(i).tolist()) - ids) >= r})
        assert len(reached[-1]) < len(ids)
    assert not union.witness.S1 & union.witness.S2
    assert len(reached[0]) + len(reached[1]) < s


def assert_growth(graph: rb.Digraph, union: UnionVerdict, r: int, s: int) -> None:
    seed, order = union.growth.seed, union.growth.order.tolist()
    degrees = [sum(u in seed for u in graph.in_neighbours(v).tolist()) for v in seed]
    by_degree = min(degrees) >= len(seed) // 2 + r - 1
    assert by_degree or union.growth.seed_proof == "exhaustive"
    induced = rb.Digraph(seed, [(u, v) for u, v in graph.arcs() if u in seed and v in seed])
    assert exhaustive(induced, r, s, Limits()).verdict is rb.Verdict.ROBUST
    assert sorted([*seed, *order]) == list(range(graph.n))
    for k, node in enumerate(order):
        assert len({*seed, *order[:k]} & set(graph.in_neighbours(node).tolist())) >= r + s - 1


def test_growth_and_common_arcs_both_occur() -> None:
    platoon_stats = check_joint_robustness(*CASES["platoon"][:3], window=6).stats
    assert platoon_stats["growth"] > 0
    regular = on_off(nx.random_regular_graph(8, 40, seed=5), 300, 0.01, 0.2, 5)
    found = check_joint_robustness(regular, 3, window=4)
    assert found.stats["searches"] < found.stats["windows"] / 2


def test_where_nothing_lasts_seeds_are_given_up() -> None:
    draw = np.random.default_rng(2)
    pairs = [(u, v) for u in range(40) for v in range(40) if u != v]
    rows = [[pairs[k] for k in np.flatnonzero(draw.random(len(pairs)) < 0.06)] for _ in range(200)]
    found = check_joint_robustness(TimeVaryingGraph.from_arcs(range(40), rows), 3, window=5, all_windows=True)
    assert found.stats["searches"] < 2 * found.stats["windows"]


def arcs_of(graph: rb.Digraph) -> tuple[Arcs, np.ndarray]:
    pairs = np.array(list(graph.arcs()))
    return Arcs(graph.n, pairs[:, 1], pairs[:, 0]), np.ones(len(pairs), dtype=bool)


def test_grow_takes_just_enough_arcs_the_longest_lasting_first() -> None:
    arcs, present = arcs_of(rb.Digraph.from_networkx(nx.complete_graph(6)))
    seed = Seed(arcs, np.arange(3), lambda _: True)
    weight = np.where(arcs.tails == 0, 0, 1)
    order, core = grow(arcs, present, seed, 2, weight)
    assert (seed.members, sorted(order)) == ((0, 1, 2), [3, 4, 5])
    assert sorted(zip(arcs.tails[core].tolist(), arcs.heads[core].tolist(), strict=True)) == sorted(
        [(u, v) for u in range(3) for v in range(3) if u != v] + [(u, v) for u in (1, 2) for v in (3, 4, 5)]
    )


def test_what_a_certificate_can_say_of_a_seed() -> None:
    arcs, present = arcs_of(rb.Digraph.from_networkx(nx.circulant_graph(40, [1, 2, 3])))
    seeds = [Seed(arcs, np.arange(size), lambda _: True) for size in (3, 4, 16, 17)]
    assert [seed.proof(present, 2) for seed in seeds] == ["degree", "degree", "exhaustive", None]


def test_nothing_grows_past_a_node_that_hears_too_few() -> None:
    graph = nx.complete_graph(5)
    graph.add_edge(4, 5)
    arcs, present = arcs_of(rb.Digraph.from_networkx(graph))
    seed = Seed(arcs, np.arange(3), lambda _: True)
    assert grow(arcs, present, seed, 2, np.zeros(len(present), np.int64)) is None
    assert grow(arcs, present, seed, 1, np.zeros(len(present), np.int64)) is not None


def test_a_seed_is_decided_once_for_each_of_its_induced_graphs() -> None:
    arcs, present = arcs_of(rb.Digraph.from_networkx(nx.complete_graph(5)))
    asked: list[rb.Digraph] = []
    seed = Seed(arcs, np.arange(3), lambda graph: asked.append(graph) is None)
    outside = present.copy()
    outside[(arcs.heads == 4) | (arcs.tails == 4)] = False
    inside = present.copy()
    inside[0] = False
    assert all(seed.robust(marks) for marks in (present, outside, inside, present))
    assert [graph.arc_count for graph in asked] == [6, 5]


def test_no_seed_of_a_graph_that_only_the_whole_keeps_robust() -> None:
    arcs, present = arcs_of(rb.Digraph.from_networkx(nx.cycle_graph(30)))
    assert find_seed(arcs, present, 2, 1, lambda graph: rb.is_r_robust(graph, 2)) is None


def test_past_the_deadline_what_is_known_is_still_used() -> None:
    sequence = TimeVaryingGraph([nx.complete_graph(5)] * 2 + [nx.empty_graph(5)])
    decider = UnionDecider(sequence, 2, 1, limits=Limits(deadline=time.monotonic() + 600))
    window = SlidingUnion(sequence)
    window.move(0, 1)
    assert decider.decide(window)[1].verdict is rb.Verdict.ROBUST
    decider._limits = Limits(deadline=0.0)
    window.move(1, 1)
    assert decider.decide(window)[1].verdict is rb.Verdict.ROBUST
    window.move(2, 1)
    key, union = decider.decide(window)
    assert (union.verdict, union.reason) == (rb.Verdict.UNDECIDED, "the time limit was reached")
    assert decider.decide(window, known_robust=True) == (key, UnionVerdict(rb.Verdict.ROBUST, "shorter-window"))
