"""Who updates when, with how old values; and which links there are."""

from __future__ import annotations

from typing import Any

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, InvalidParameter
from robustness.simulation import (
    SCHEDULES,
    Scenario,
    Schedule,
    Start,
    Topology,
    as_topology,
    random_start,
    schedule_named,
    simulate,
)
from robustness.simulation.adversaries import Constant
from robustness.simulation.adversaries.protocol import View
from robustness.simulation.engine import Batch
from robustness.simulation.schedules import (
    AdversarialDelays,
    AdversarialUpdates,
    ConstantDelays,
    EveryStep,
    NoDelays,
    PeriodicUpdates,
    RandomDelays,
    RandomUpdates,
)
from robustness.time_varying import TimeVaryingGraph

FIVE = as_topology(nx.complete_graph(range(1, 6)), 1)
START = random_start(FIVE.union, [4], 0)


def played(schedule: Schedule, steps: int = 60, runs: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Return all update flags ``(steps, B, n)`` and delays ``(steps, B, A)`` of a batch."""
    starts = [random_start(FIVE.union, [4], seed) for seed in range(runs)]
    batch = Batch(Scenario(FIVE, 1, schedule=schedule, steps=steps), starts)
    updates, delays = [], []

    class Pool:
        pass

    original = schedule.update_times.updates
    for step in range(steps):
        batch.act(step)
        view = View(batch.setting, step, batch.p, batch.q, batch.previous, batch.last_update)
        updates.append(np.broadcast_to(original(view), batch.p.shape).copy())
        delays.append(np.broadcast_to(batch.delays(view), (runs, FIVE.union.arc_count)).copy())
        batch.advance(step, Pool())  # one part runs without a pool
    return np.array(updates), np.array(delays)


def longest_wait(flags: np.ndarray) -> int:
    """Return the greatest number of steps until somebody's next update, the first one included."""
    worst = 0
    for row in flags.reshape(len(flags), -1).T:
        at = np.flatnonzero(row)
        assert len(at)
        worst = max(worst, int(at[0]) + 1, *np.diff(at).tolist())
    return worst


@pytest.mark.parametrize("name", SCHEDULES)
@pytest.mark.parametrize("tau", [0, 1, 2, 5])
def test_no_value_in_use_is_older_than_tau(name: str, tau: int) -> None:
    schedule = schedule_named(name, tau)
    updates, delays = played(schedule)
    gap = schedule.update_times.gap
    assert longest_wait(updates) <= gap
    assert 0 <= delays.min() <= delays.max() <= schedule.delay_rule.bound
    assert gap - 1 + schedule.delay_rule.bound <= schedule.oldest <= tau


@pytest.mark.parametrize("name", ["random", "adversarial"])
def test_the_bounds_are_used_up(name: str) -> None:
    schedule = schedule_named(name, 4)
    updates, delays = played(schedule)
    assert longest_wait(updates) == schedule.update_times.gap == 3
    assert delays.max() == schedule.delay_rule.bound == 2


def test_the_papers_example() -> None:
    """Vehicles 1, 2, 3, 5 update at 12 l + 6, 9, 11, 4: tau = 11."""
    schedule = Schedule(PeriodicUpdates(12, {1: 6, 2: 9, 3: 11, 5: 4}))
    updates, _ = played(schedule, 36, 1)
    for node, offset in ((0, 6), (1, 9), (2, 11), (4, 4)):
        assert np.flatnonzero(updates[:, 0, node]).tolist() == [offset, offset + 12, offset + 24]
    assert schedule.oldest == 11


@pytest.mark.parametrize("step", [-3, 0, 2, 11])
def test_the_worst_delay_is_the_least_that_shows_the_extreme(step: int) -> None:
    """Against the definition, arc by arc; few values, so that many are equal."""
    draws = np.random.default_rng(step + 9)
    batch = Batch(Scenario(FIVE, 1, schedule=Schedule(EveryStep(), AdversarialDelays(3))), [START, START])
    batch.ring = draws.integers(0, 3, batch.ring.shape).astype(float)
    batch.p = draws.integers(0, 5, batch.p.shape).astype(float)
    batch.act(step)
    view = View(batch.setting, step, batch.p, batch.q, batch.previous, batch.last_update)
    delays, setting = batch.delays(view), batch.setting
    for b in range(2):
        normal = batch.p[b][~setting.malicious[b]]
        middle = (normal.min() + normal.max()) / 2
        for e, (sender, receiver) in enumerate(zip(setting.tails, setting.heads, strict=True)):
            values = [batch.ring[(step - late) % 4, b, sender] for late in range(4)]
            extreme = max(values) if batch.p[b, receiver] > middle else min(values)
            assert delays[b, e] == values.index(extreme)


def test_adversarial_delays_show_everybody_its_own_end() -> None:
    _, delays = played(Schedule(EveryStep(), AdversarialDelays(3)), 30)
    assert delays.max() == 3
    assert delays.min() == 0


def test_random_draws_are_those_of_the_seed() -> None:
    first, second = (played(schedule_named("random", 4), 20) for _ in range(2))
    assert np.array_equal(first[0], second[0])
    assert np.array_equal(first[1], second[1])
    assert not np.array_equal(first[1][:, 0], first[1][:, 1])


@pytest.mark.parametrize(
    ("make", "rule"),
    [
        (lambda: Schedule(PeriodicUpdates(12), NoDelays(), tau=10), "raise tau to 11"),
        (lambda: Schedule(RandomUpdates(gap=3), RandomDelays(2), tau=3), "raise tau to 4"),
        (lambda: PeriodicUpdates(0), "at least 1"),
        (lambda: PeriodicUpdates(3, {"a": 3}), "0..period - 1"),
        (lambda: RandomUpdates(probability=2.0), "0..1"),
        (lambda: RandomUpdates(gap=0), "at least 1"),
        (lambda: AdversarialUpdates(-1), "at least 1"),
        (lambda: ConstantDelays(-1), "future"),
        (lambda: ConstantDelays(0, {("a", "b"): -2}), "future"),
        (lambda: RandomDelays(-1), "at least 0"),
        (lambda: AdversarialDelays(-1), "at least 0"),
        (lambda: schedule_named("lazy", 1), "a schedule is one of"),
        (lambda: schedule_named("random", -1), "at least 0"),
    ],
)
def test_out_of_range_is_refused(make: Any, rule: str) -> None:
    with pytest.raises(InvalidParameter, match=rule):
        make()


def test_a_greater_tau_may_be_stated() -> None:
    assert Schedule(EveryStep(), NoDelays(), tau=7).oldest == 7
    assert Schedule().synchronous


class TestTopology:
    TRIANGLE, PATH = nx.complete_graph(3), nx.path_graph(3)

    def test_a_callable_is_asked_once_for_each_step(self) -> None:
        asked = []

        def network(step: int) -> nx.Graph:
            asked.append(step)
            return self.TRIANGLE if step % 2 else self.PATH

        topology = as_topology(network, 5)
        assert asked == [0, 1, 2, 3, 4]
        assert topology.sequence == (0, 1, 0, 1, 0)
        assert topology.union.arc_count == 6
        assert topology.present(0).tolist() == [1, 0, 1, 1, 0, 1]
        assert topology.present(1).tolist() == [1] * 6

    def test_a_graph_that_is_changed_in_between_is_read_each_time(self) -> None:
        graph = nx.empty_graph(3)

        def growing(step: int) -> nx.Graph:
            graph.add_edge(step % 3, (step + 1) % 3)
            return graph

        assert [g.arc_count for g in as_topology(growing, 3).graphs] == [2, 4, 6]

    def test_a_time_varying_graph(self) -> None:
        sequence = TimeVaryingGraph([self.TRIANGLE, self.PATH, self.PATH], period=2)
        topology = as_topology(sequence, 7)
        assert [topology.present(k).sum() for k in range(7)] == [6, 4, 4, 4, 4, 4, 4]

    def test_a_sequence_that_repeats_is_kept_as_one_turn(self) -> None:
        assert as_topology(TimeVaryingGraph([self.TRIANGLE, self.PATH], period=2), 700).sequence == (0, 1)
        assert as_topology(TimeVaryingGraph([self.TRIANGLE, self.PATH], period=2), 1).sequence == (0, 1)

    @pytest.mark.parametrize("period", [3, 2, None])
    def test_a_network_that_changes_agrees_within_the_run(self, period: int | None) -> None:
        """Also where the steps are written out: a turn as long as the run must not ask for more than the run."""
        edges = sorted(nx.complete_graph(5).edges)
        parts = [nx.Graph(edges[k % 3 :: 3]) for k in range(3 if period else 400)]
        for part in parts:
            part.add_nodes_from(range(5))
        topology = as_topology(TimeVaryingGraph(parts, period=period), 400)
        scenario = Scenario(topology, 0, schedule=Schedule(tau=3), steps=400, T=0.9)
        (outcome,) = simulate(scenario, [random_start(topology.union, [], 0)])
        assert outcome.verdict.value == "agreement"

    def test_a_trace_that_ends_too_soon_is_refused(self) -> None:
        with pytest.raises(InvalidParameter, match="has no step 3"):
            as_topology(TimeVaryingGraph([self.TRIANGLE, self.PATH]), 4)

    @pytest.mark.parametrize("network", [3, None, "graph"])
    def test_anything_else_is_refused(self, network: object) -> None:
        with pytest.raises(InvalidGraph):
            as_topology(network, 3)

    def test_one_node_set(self) -> None:
        with pytest.raises(InvalidGraph, match="one node set"):
            as_topology(lambda k: nx.complete_graph(3 + k), 2)
        with pytest.raises(InvalidParameter, match="at least one"):
            Topology(())

    def test_a_topology_is_its_own(self) -> None:
        assert as_topology(FIVE, 9) is FIVE

    @pytest.mark.parametrize("tau", [0, 1, 2, 3])
    def test_links_are_remembered_for_tau_steps(self, tau: int) -> None:
        """One arc, present at step 0 of four only: b uses the value of step 0 for tau more steps, then nothing."""
        link, none = Digraph("ab", [("a", "b")]), Digraph("ab", [])
        topology = Topology((link, none), (0, 1, 1, 1))
        scenario = Scenario(
            topology, 1, "w-msr", adversary=Constant(), schedule=Schedule(tau=tau), steps=4, added_links=()
        )
        start = Start(frozenset(), (64.0, 0.0), (0.0, 0.0))
        free = Scenario(topology, 0, "w-msr", schedule=Schedule(tau=tau), steps=4)
        (outcome,) = simulate(free, [start], record=True)
        halves = [64 - 64 / 2**k for k in range(5)]
        expected = [halves[min(k, tau + 1)] for k in range(5)]
        assert outcome.trajectory.p[:, 1].tolist() == expected
        assert simulate(scenario, [start])[0].safe is True
