"""What adversaries do, and that none may do more than its model allows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation import (
    ADVERSARIES,
    Scenario,
    Schedule,
    Start,
    Topology,
    as_topology,
    schedule_named,
    simulate,
)
from robustness.simulation.adversaries import (
    Alternating,
    Constant,
    Crash,
    ExtremeValue,
    Liar,
    Move,
    Noise,
    Omission,
    Ramp,
    Sine,
    View,
)
from robustness.simulation.fault_models import FAULT_MODELS
from robustness.simulation.motion import Creep, InAbsolutePositions
from robustness.simulation.schedules import AdversarialDelays, EveryStep

COMPLETE = as_topology(nx.complete_graph(5), 1)
START = Start(frozenset({4}), (0.0, 10.0, 20.0, 30.0, 40.0), (0.0,) * 5)


def sent_by(adversary: Any, steps: int = 6, node: int = 4, **changes: Any) -> list[float]:
    scenario = Scenario(COMPLETE, 1, adversary=adversary, steps=steps, **changes)
    (outcome,) = simulate(scenario, [START], record=True)
    return outcome.trajectory.sent[:, node].tolist()


class TestWhatTheySend:
    def test_constant(self) -> None:
        assert sent_by(Constant()) == [40.0] * 7
        assert sent_by(Constant(-3.0)) == [-3.0] * 7

    def test_constant_in_a_formation(self) -> None:
        assert sent_by(Constant(-3.0), offsets={4: 2.0}) == [-1.0] * 7

    def test_ramp(self) -> None:
        assert sent_by(Ramp(0.5)) == [40.0 + 15.0 * k for k in range(7)]

    def test_sine(self) -> None:
        assert sent_by(Sine(period=4, reach=2.0), 4) == pytest.approx([15.0, 45.0, 15.0, -15.0, 15.0])

    def test_alternating(self) -> None:
        assert sent_by(Alternating(2.0, 200.0), 4) == [2.0, 200.0, 2.0, 200.0, 2.0]

    def test_creep(self) -> None:
        assert sent_by(Creep(0.1, 5.0), 4) == pytest.approx([0.0, 5.1, 0.2 + 5 * 2**0.5, 0.3 + 5 * 3**0.5, 10.4])

    def test_absolute_positions(self) -> None:
        assert sent_by(InAbsolutePositions(Constant(6.0), 1.0), 3) == [6.0, 5.0, 4.0, 3.0]
        assert sent_by(InAbsolutePositions(Constant(6.0), 1.0, odd_only=True), 3) == [6.0, 5.0, 6.0, 3.0]

    def test_noise_depends_on_the_seed_alone(self) -> None:
        assert sent_by(Noise()) == sent_by(Noise())
        assert len(set(sent_by(Noise()))) == 7
        assert all(-15.0 <= value <= 45.0 for value in sent_by(Noise(reach=0.5)))

    def test_crash_stands_still(self) -> None:
        sent = sent_by(Crash(at=3))
        assert sent[2] == sent[3] == sent[6]
        assert sent[1] != sent[2]

    def test_two_face_takes_the_ends_in_turn(self) -> None:
        scenario = Scenario(COMPLETE, 1, adversary=ADVERSARIES["two-face"](), steps=4)
        (outcome,) = simulate(scenario, [START], record=True)
        normal = outcome.trajectory.p[:, :4]
        ends = np.where(np.arange(5) % 2 == 0, normal.min(axis=1), normal.max(axis=1))
        assert np.array_equal(outcome.trajectory.sent[:, 4], ends)

    def test_extreme_value_is_kept_and_anything_farther_is_not(self) -> None:
        """In K5 every normal vehicle hears the other three: the most one keeps for f = 1 is the largest of these."""
        for side, limit, beyond in (("up", 30.0, 31.0), ("down", 0.0, -1.0)):
            value = sent_by(ExtremeValue(side), 1)[0]
            assert value == pytest.approx(limit, abs=1e-6)
            assert 0.0 < value < 30.0
            kept, dropped = (self.first_move(Constant(claim)) for claim in (value, beyond))
            assert not np.array_equal(kept, dropped)
            assert np.array_equal(dropped, self.first_move(Constant(2 * beyond)))

    @staticmethod
    def first_move(adversary: Any) -> np.ndarray:
        scenario = Scenario(COMPLETE, 1, "w-msr", adversary=adversary, steps=1)
        return simulate(scenario, [START], record=True)[0].trajectory.p[1, :4]

    def test_greedy_is_at_least_as_bad_as_every_constant(self) -> None:
        """One step, one malicious node: no claim on a fine grid leaves the others farther apart."""
        network = as_topology(nx.wheel_graph(6), 1)
        start = Start(frozenset({0}), (0.0, 3.0, 50.0, 20.0, 90.0, 40.0), (0.0,) * 6)
        spreads = {}
        claims = {"greedy": ADVERSARIES["greedy"](), **{value: Constant(float(value)) for value in range(-20, 120)}}
        for name, adversary in claims.items():
            (outcome,) = simulate(Scenario(network, 1, "w-msr", adversary=adversary, steps=1), [start])
            spreads[name] = outcome.spread
        assert spreads["greedy"] >= max(spreads.values()) - 1e-9

    def test_omission_withholds_and_the_filter_relaxes(self) -> None:
        """Silent for ever, a malicious node is as good as absent: the others run as without it, with f - 1."""
        silent = Scenario(COMPLETE, 1, "w-msr", adversary=Omission(1.0), steps=8)
        (outcome,) = simulate(silent, [START], record=True)
        rest = Scenario(as_topology(nx.complete_graph(4), 1), 0, "w-msr", steps=8)
        (alone,) = simulate(rest, [Start(frozenset(), START.positions[:4], (0.0,) * 4)], record=True)
        assert np.array_equal(outcome.trajectory.p[:, :4], alone.trajectory.p)

    @pytest.mark.parametrize("make", [lambda: Omission(1.5), lambda: Sine(period=0), lambda: ExtremeValue("left")])
    def test_parameters_out_of_range_are_refused(self, make: Any) -> None:
        with pytest.raises(InvalidParameter):
            make()


class TestSensing:
    def test_passive_believes_and_active_sees(self) -> None:
        """Vehicle 4 says 1000 and stands at -1000: for whom it is an outlier above, and for whom below."""
        liar = Liar(Constant(1000.0), Constant(-1000.0))
        star = Topology((Digraph(range(3), [(2, 0), (2, 1)]),))
        start = Start(frozenset({2}), (0.0, 0.0, 0.0), (0.0,) * 3)
        scenario = Scenario(star, 1, "w-msr", "malicious", liar, steps=1, active=frozenset({1}))
        (kept,) = simulate(scenario, [start], record=True)
        assert kept.trajectory.p[1].tolist()[:2] == [0.0, 0.0]  # f = 1 drops either
        honest = Topology((Digraph(range(4), [(2, 0), (2, 1), (3, 0), (3, 1)]),))
        start = Start(frozenset({2}), (0.0, 0.0, 0.0, 8.0), (0.0,) * 4)
        scenario = Scenario(honest, 1, "w-msr", "malicious", liar, steps=1, active=frozenset({1}))
        (kept,) = simulate(scenario, [start], record=True)
        # Node 0 hears 1000 and 8 and drops 1000; node 1 sees -1000 and 8 and drops both.
        assert kept.trajectory.p[1].tolist()[:2] == [4.0, 0.0]

    def test_silence_does_not_hide_from_a_camera(self) -> None:
        pair = Topology((Digraph(range(3), [(2, 0), (2, 1)]),))
        start = Start(frozenset({2}), (0.0, 0.0, 8.0), (0.0,) * 3)
        scenario = Scenario(pair, 1, "w-msr", adversary=Crash(at=0), steps=1, active=frozenset({1}))
        assert simulate(scenario, [start])[0].safe is True
        withheld = Scenario(pair, 1, "w-msr", adversary=Liar(Crash(0), Constant(8.0)), steps=1, active=frozenset({1}))
        (outcome,) = simulate(withheld, [start], record=True)
        assert outcome.trajectory.p[1].tolist()[:2] == [0.0, 0.0]

    def test_unknown_nodes_are_refused(self) -> None:
        with pytest.raises(ValueError, match="'x' is none"):
            simulate(Scenario(COMPLETE, 1, active=frozenset({"x"}), steps=1), [START])


@dataclass(frozen=True)
class Lawless:
    """An adversary that returns whatever it is told to."""

    field: str
    value: float
    node: int = 4

    def play(self, view: View) -> Move:
        shape = view.p.shape if self.field in ("sent", "positions") else (len(view.p), view.setting.graph.arc_count)
        if self.field == "delays":
            return Move(delays=np.full(shape, int(self.value)))
        column = np.arange(shape[1]) == self.node if len(shape) == 2 and shape == view.p.shape else None
        chosen = column if column is not None else view.setting.tails == self.node
        if self.field == "withheld":
            return Move(withheld=np.broadcast_to(chosen, shape))
        return Move(**{self.field: np.where(np.broadcast_to(chosen, shape), self.value, np.nan)})


class TestFaultModels:
    @pytest.mark.parametrize(
        ("adversary", "rule"),
        [
            (Lawless("sent", 1.0, node=0), "malicious nodes"),
            (Lawless("positions", 1.0, node=0), "malicious nodes"),
            (Lawless("sent", float("inf")), "finite"),
            (Lawless("positions", float("-inf")), "finite"),
            (Lawless("withheld", 1.0, node=0), "silenced a normal one"),
            (Lawless("told", 1.0), "need a Byzantine model"),
            (Lawless("delays", 1), "sets the delays itself"),
        ],
    )
    def test_doing_more_is_an_error(self, adversary: Lawless, rule: str) -> None:
        with pytest.raises(InvalidParameter, match=rule):
            simulate(Scenario(COMPLETE, 1, adversary=adversary, steps=1), [START])

    @pytest.mark.parametrize(
        ("adversary", "rule"),
        [(Lawless("told", 1.0, node=0), "normal node's arc"), (Lawless("told", float("inf")), "finite")],
    )
    def test_byzantine_nodes_have_limits_too(self, adversary: Lawless, rule: str) -> None:
        with pytest.raises(InvalidParameter, match=rule):
            simulate(Scenario(COMPLETE, 1, model="byzantine", adversary=adversary, steps=1), [START])

    def test_delays_beyond_the_bound_are_refused(self) -> None:
        late = Schedule(EveryStep(), AdversarialDelays(2))
        simulate(Scenario(COMPLETE, 1, adversary=Lawless("delays", 2), schedule=late, steps=1), [START])
        with pytest.raises(InvalidParameter, match="at most 2 steps"):
            simulate(Scenario(COMPLETE, 1, adversary=Lawless("delays", 3), schedule=late, steps=1), [START])

    def test_what_is_allowed_is_done(self) -> None:
        assert sent_by(Lawless("sent", 7.0), 2) == [7.0] * 3
        told = Scenario(COMPLETE, 1, model="byzantine", adversary=Lawless("told", 20.0), steps=3)
        same = Scenario(COMPLETE, 1, adversary=Liar(Lawless("sent", 20.0), Constant()), steps=3)
        (first,), (second,) = (simulate(s, [START], record=True) for s in (told, same))
        assert np.array_equal(first.trajectory.p[:, :4], second.trajectory.p[:, :4])

    @pytest.mark.parametrize("model", ["malicious", "byzantine"])
    def test_f_total(self, model: str) -> None:
        with pytest.raises(InvalidParameter, match=r"at most f = 1 node is malicious, not 2"):
            simulate(
                Scenario(COMPLETE, 1, model=model, steps=1), [START, Start(frozenset({0, 1}), (0.0,) * 5, (0.0,) * 5)]
            )

    @pytest.mark.parametrize("model", ["malicious-local", "byzantine-local"])
    def test_f_local(self, model: str) -> None:
        ring = as_topology(nx.cycle_graph(9), 1)
        far, near = (Start(frozenset(bad), (0.0,) * 9, (0.0,) * 9) for bad in ({0, 3, 6}, {0, 2}))
        assert simulate(Scenario(ring, 1, model=model, steps=1), [far])
        with pytest.raises(InvalidParameter, match="hears at most f = 1 malicious ones, but 1 hears 2"):
            simulate(Scenario(ring, 1, model=model, steps=1), [near])

    def test_every_model_is_named(self) -> None:
        assert {(m.local, m.byzantine) for m in FAULT_MODELS.values()} == {(a, b) for a in (0, 1) for b in (0, 1)}


class TestAddedLinks:
    RING = as_topology(nx.cycle_graph(9), 1)

    def test_do_not_matter_f_total(self) -> None:
        """The source paper's remark: extra links from malicious nodes do not change f."""
        links = tuple((4, i) for i in range(4))
        path = as_topology(nx.complete_graph(4), 1)
        graph = Digraph(range(5), [(u, v) for u, v in path.union.arcs()] + [(0, 4)])
        scenario = Scenario(Topology((graph,)), 1, adversary=Ramp(), steps=400, added_links=links)
        (outcome,) = simulate(scenario, [START])
        assert outcome.verdict.value == "agreement"
        assert outcome.safe is True

    def test_may_break_f_local(self) -> None:
        start = Start(frozenset({0, 4}), (0.0,) * 9, (0.0,) * 9)
        fields: dict[str, Any] = {"model": "malicious-local", "steps": 1}
        assert simulate(Scenario(self.RING, 1, **fields), [start])
        with pytest.raises(InvalidParameter, match="hears 2"):
            simulate(Scenario(self.RING, 1, added_links=((0, 5),), **fields), [start])

    def test_start_at_malicious_nodes(self) -> None:
        with pytest.raises(InvalidParameter, match="but 1 is normal"):
            simulate(Scenario(COMPLETE, 1, added_links=((1, 0),), steps=1), [START])


def test_adversaries_of_the_battery_work_without_anybody() -> None:
    """No malicious node at all, everybody malicious, and one vehicle: nothing divides by nothing."""
    for name, make in ADVERSARIES.items():
        for schedule in (schedule_named("synchronous", 0), schedule_named("adversarial", 3)):
            for n, bad in ((0, set()), (1, set()), (1, {0}), (3, set()), (3, {0, 1, 2})):
                network = as_topology(nx.complete_graph(n), 1)
                start = Start(frozenset(bad), tuple(map(float, range(n))), (0.0,) * n)
                (outcome,) = simulate(Scenario(network, 3, adversary=make(), schedule=schedule, steps=30), [start])
                assert np.isfinite(outcome.spread), name
