"""The engine against the plain loop, bit for bit; and what a run must not depend on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.simulation import (
    ADVERSARIES,
    RULES,
    Scenario,
    Schedule,
    Start,
    Topology,
    as_topology,
    random_start,
    schedule_named,
    simulate,
)
from robustness.simulation.outcome import Outcome
from robustness.simulation.reference import simulate_plainly
from robustness.simulation.schedules import ConstantDelays, EveryStep, PeriodicUpdates

pytestmark = pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")

SCHEDULES = [("synchronous", 0), ("periodic", 3), ("random", 4), ("adversarial", 4), ("delayed", 2)]
DENSE = nx.gnp_random_graph(7, 0.6, seed=0, directed=True)
PARTS = [nx.gnp_random_graph(7, 0.4, seed=seed, directed=True) for seed in range(3)]
NETWORKS = {"fixed": as_topology(DENSE, 1), "varying": as_topology(lambda k: PARTS[k % 3], 3)}


def starts_on(network: Topology, count: int = 3) -> list[Start]:
    n = network.union.n
    return [random_start(network.union, [b % n, (b + 3) % n], b) for b in range(count)]


def assert_same(first: Outcome, second: Outcome) -> None:
    assert first == second
    for name in ("p", "q", "sent"):
        assert np.array_equal(getattr(first.trajectory, name), getattr(second.trajectory, name), equal_nan=True)


@pytest.mark.parametrize("adversary", ADVERSARIES)
@pytest.mark.parametrize(("schedule", "tau"), SCHEDULES)
def test_the_plain_loop_gives_the_same_bits(adversary: str, schedule: str, tau: int) -> None:
    """Every adversary under every schedule, with every rule, model, sensing and kind of network taken in turn."""
    cases = [
        ("adp-msr", "malicious", frozenset(), "fixed"),
        ("adp-msr", "byzantine", frozenset({0, 3}), "varying"),
        ("w-msr", "malicious", frozenset({1}), "varying"),
        ("w-msr", "byzantine", frozenset(), "fixed"),
        ("dp-msr", "byzantine", frozenset({1, 2}), "fixed"),
    ]
    for rule, model, active, network in cases:
        if RULES[rule].synchronous and schedule != "synchronous":
            continue
        topology = NETWORKS[network]
        scenario = Scenario(
            topology, 2, rule, model, ADVERSARIES[adversary](), schedule_named(schedule, tau), steps=20, T=0.7,
            alpha=2.0, offsets={0: 1.5, 4: -2.25}, active=active,
        )  # fmt: skip
        for first, second in zip(
            simulate(scenario, starts_on(topology), record=True),
            simulate_plainly(scenario, starts_on(topology), record=True),
            strict=True,
        ):
            assert_same(first, second)
            assert np.ptp(first.trajectory.p) > 1  # something happened


@given(st.data())
@settings(max_examples=25)
def test_the_plain_loop_gives_the_same_bits_on_any_network(data: st.DataObject) -> None:
    n = data.draw(st.integers(1, 6), label="n")
    pairs = [(u, v) for u in range(n) for v in range(n) if u != v]
    arcs = data.draw(st.lists(st.sampled_from(pairs), unique=True) if pairs else st.just([]), label="arcs")
    f = data.draw(st.integers(0, 2), label="f")
    bad = data.draw(st.frozensets(st.integers(0, n - 1), max_size=f), label="malicious")
    numbers = st.tuples(*[st.floats(-8, 8) for _ in range(n)])
    start = Start(bad, data.draw(numbers), data.draw(numbers), data.draw(st.integers(0, 99)))
    name, tau = data.draw(st.sampled_from(SCHEDULES), label="schedule")
    adversary = ADVERSARIES[data.draw(st.sampled_from(sorted(ADVERSARIES)), label="adversary")]()
    rule = data.draw(st.sampled_from(["adp-msr", "w-msr"]), label="rule")
    weights = {arc: data.draw(st.floats(0.1, 2)) for arc in arcs}
    scenario = Scenario(
        Topology((Digraph(range(n), arcs),)), f, rule, adversary=adversary, schedule=schedule_named(name, tau),
        steps=15, T=0.5, weights=weights,
    )  # fmt: skip
    (first,), (second,) = simulate(scenario, [start], record=True), simulate_plainly(scenario, [start], record=True)
    assert_same(first, second)


class TestWhatARunDoesNotDependOn:
    @pytest.mark.parametrize("adversary", ["random", "omission", "greedy", "extreme"])
    def test_its_batch(self, adversary: str) -> None:
        topology = NETWORKS["fixed"]
        scenario = Scenario(
            topology, 2, adversary=ADVERSARIES[adversary](), schedule=schedule_named("random", 4), steps=40
        )
        starts = starts_on(topology, 5)
        for start, together in zip(starts, simulate(scenario, starts, record=True), strict=True):
            (alone,) = simulate(scenario, [start], record=True)
            assert_same(alone, together)

    def test_the_threads(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robustness.simulation.engine._WORTH_A_THREAD", 0)
        topology = NETWORKS["fixed"]
        scenario = Scenario(topology, 2, schedule=schedule_named("adversarial", 4), steps=30)
        starts = starts_on(topology, 5)
        for jobs in (2, 9):
            for one, many in zip(
                simulate(scenario, starts, record=True), simulate(scenario, starts, record=True, jobs=jobs), strict=True
            ):
                assert_same(one, many)

    def test_the_arrays_of_the_caller_are_left_alone(self) -> None:
        graph = nx.complete_graph(4)
        before = nx.node_link_data(graph, edges="edges")
        simulate(Scenario(as_topology(graph, 1), 1, steps=5), [random_start(as_topology(graph, 1).union, [0], 0)])
        assert nx.node_link_data(graph, edges="edges") == before


class TestByHand:
    """Two vehicles and a few steps, on paper."""

    PAIR = Topology((Digraph("ab", [("a", "b")]),))

    def run(self, *, positions: tuple[float, float] = (8.0, 0.0), **changes: Any) -> np.ndarray:
        scenario = Scenario(self.PAIR, 0, T=1.0, alpha=1.5, steps=4)
        start = Start(frozenset(), positions, (0.0, 0.0))
        (outcome,) = simulate(replace(scenario, **changes), [start], record=True)
        return outcome.trajectory.p[:, 1]

    def test_synchronous(self) -> None:
        # u = 8 - p - 1.5 q: 8, then p = 4, q = 8, u = 4 - 12 = -8: p = 4 + 8 - 4 = 8, q = 0.
        assert self.run().tolist() == [0.0, 4.0, 8.0, 8.0, 8.0]

    def test_first_order_is_the_plain_mean(self) -> None:
        assert self.run(rule="w-msr").tolist() == [0.0, 4.0, 6.0, 7.0, 7.5]

    def test_weights_of_first_order_are_relative_to_an_own_weight_of_one(self) -> None:
        assert self.run(rule="w-msr", weights={("a", "b"): 3.0}).tolist() == [0.0, 6.0, 7.5, 7.875, 7.96875]

    def test_before_its_first_update_a_vehicle_has_heard_nothing(self) -> None:
        late = Schedule(PeriodicUpdates(4, {"a": 0, "b": 2}))
        assert self.run(schedule=late)[:3].tolist() == [0.0, 0.0, 0.0]
        assert self.run(schedule=late)[3] == 4.0

    def test_values_are_held_between_updates(self) -> None:
        """a moves away at constant speed; b updates at step 0 only and keeps steering for where a was then."""
        once = Schedule(PeriodicUpdates(4, {"a": 0, "b": 0}))
        scenario = Scenario(self.PAIR, 0, T=1.0, alpha={"a": 1.0, "b": 1.5}, steps=4, schedule=once)
        (outcome,) = simulate(scenario, [Start(frozenset(), (8.0, 0.0), (16.0, 0.0))], record=True)
        assert outcome.trajectory.p[:, 0].tolist()[:3] == [8.0, 16.0, 16.0]
        assert outcome.trajectory.p[:, 1].tolist() == [0.0, 4.0, 8.0, 8.0, 8.0]

    def test_a_delay_shows_the_past(self) -> None:
        behind = Schedule(EveryStep(), ConstantDelays(2))
        moving = simulate(
            Scenario(self.PAIR, 0, rule="w-msr", steps=3, schedule=behind), [Start(frozenset(), (8.0, 0.0), (0.0, 0.0))]
        )
        assert moving[0].verdict.value != "split"
        assert self.run(rule="w-msr", schedule=behind).tolist() == [0.0, 4.0, 6.0, 7.0, 7.5]

    def test_delays_of_single_arcs(self) -> None:
        """The malicious a ramps; with a delay of 1 on its arc b lags one step behind its undelayed self."""
        rule = ConstantDelays(0, {("a", "b"): 1})
        ramp = ADVERSARIES["ramp"]()
        start = Start(frozenset({"a"}), (0.0, 0.0), (0.0, 0.0))
        scenario = Scenario(Topology((Digraph("abc", [("a", "b"), ("c", "b")]),)), 1, adversary=ramp, steps=4)
        start = Start(frozenset({"a"}), (0.0, 0.0, 64.0), (0.0, 0.0, 0.0))
        for schedule in (Schedule(), Schedule(EveryStep(), rule)):
            (fast,) = simulate(replace(scenario, schedule=schedule), [start], record=True)
            (plain,) = simulate_plainly(replace(scenario, schedule=schedule), [start], record=True)
            assert_same(fast, plain)

    def test_a_lone_vehicle_brakes(self) -> None:
        scenario = Scenario(Topology((Digraph(["a"], []),)), 0, T=1.0, alpha=1.0, steps=12)
        (outcome,) = simulate(scenario, [Start(frozenset(), (1.0,), (4.0,))], record=True)
        assert outcome.trajectory.p[:, 0].tolist() == [1.0] + [3.0] * 12
        assert outcome.trajectory.q[:, 0].tolist() == [4.0] + [0.0] * 12
        assert outcome.verdict.value == "agreement"


class TestSafety:
    @pytest.mark.parametrize("adversary", ADVERSARIES)
    def test_nobody_leaves_the_initial_range(self, adversary: str) -> None:
        """Whatever the network: the filter alone keeps normal vehicles in their range, with gains inside the theory."""
        graph = nx.gnp_random_graph(9, 0.5, seed=5)
        topology = as_topology(graph, 1)
        starts = [random_start(topology.union, [b % 9, (b + 4) % 9], b) for b in range(9)]
        for rule in ("w-msr", "adp-msr"):
            for name, tau in SCHEDULES:
                scenario = Scenario(topology, 2, rule, adversary=ADVERSARIES[adversary](), steps=60,
                                    schedule=schedule_named(name, tau))  # fmt: skip
                assert all(outcome.safe is True for outcome in simulate(scenario, starts))

    def test_a_filter_that_drops_too_little_is_caught(self) -> None:
        """The check can fail: with three malicious nodes against a filter for two (f-local allows it far away)."""
        graph = nx.complete_graph(4)
        start = Start(frozenset({3}), (0.0, 1.0, 2.0, 50.0), (0.0,) * 4)
        lenient = Scenario(as_topology(graph, 1), 1, "w-msr", steps=5)
        (kept,) = simulate(lenient, [start])
        assert kept.safe is True
        lost = _unfiltered(lenient, start)
        assert lost.safe is False


def _unfiltered(scenario: Scenario, start: Start) -> Outcome:
    """Run with a filter for f = 0 against a malicious node, which no public call allows."""
    from concurrent.futures import ThreadPoolExecutor

    from robustness.simulation.engine import Batch
    from robustness.simulation.observer import Observer

    batch = Batch(scenario, [start])
    batch.law = batch.law._replace(f=0)
    observer = Observer(batch.setting, batch.fleet, scenario, [start], (None,), record=False)
    with ThreadPoolExecutor(1) as pool:
        for step in range(scenario.steps):
            batch.act(step)
            observer.see(step, batch.p, batch.q, batch.sent)
            batch.advance(step, pool)
    observer.see(scenario.steps, batch.p, batch.q, batch.sent)
    return observer.outcomes(batch.divergence.since)[0]


class TestLimits:
    def test_a_time_limit_is_undecided(self) -> None:
        topology = NETWORKS["fixed"]
        with pytest.raises(Undecided, match="time limit"):
            simulate(Scenario(topology, 2, steps=10**6), starts_on(topology), time_limit=0.01)

    def test_more_steps_than_memory_has_room_for(self) -> None:
        topology = NETWORKS["fixed"]
        with pytest.raises(InvalidParameter, match="memory"):
            simulate(Scenario(topology, 2, steps=10**15), starts_on(topology))

    def test_no_starts_no_outcomes(self) -> None:
        assert simulate(Scenario(NETWORKS["fixed"], 1), []) == ()
        assert simulate_plainly(Scenario(NETWORKS["fixed"], 1), []) == ()

    @pytest.mark.parametrize(
        ("start", "rule"),
        [
            (Start(frozenset(), (0.0,) * 6, (0.0,) * 7), "one position"),
            (Start(frozenset(), (0.0,) * 7, (0.0,) * 8), "one velocity"),
            (Start(frozenset({"x"}), (0.0,) * 7, (0.0,) * 7), "'x' is none"),
        ],
    )
    def test_starts_that_do_not_fit_are_refused(self, start: Start, rule: str) -> None:
        with pytest.raises(ValueError, match=rule):
            simulate(Scenario(NETWORKS["fixed"], 1, steps=2), [start])

    @pytest.mark.parametrize(
        ("changes", "rule"),
        [
            ({"f": -1}, "f is an integer"),
            ({"f": True}, "f is an integer"),
            ({"steps": 0}, "number of steps is an integer of at least 1"),
            ({"T": 0.0}, "sampling period"),
            ({"target_speed": float("nan")}, "target speed"),
            ({"tolerance": 0.0}, "tolerance"),
            ({"dwell": 7, "steps": 6}, "dwell"),
            ({"rule": "msr"}, "update rule"),
            ({"model": "evil"}, "fault model"),
            ({"rule": "dp-msr", "schedule": schedule_named("delayed", 1)}, "without delays"),
        ],
    )
    def test_scenarios_out_of_range_are_refused(self, changes: dict[str, Any], rule: str) -> None:
        with pytest.raises(InvalidParameter, match=rule):
            Scenario(**({"network": NETWORKS["fixed"], "f": 1} | changes))
