"""Divergence is an outcome of its own: never agreement, never an internal error, and it says at which step."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from cli.main import robustness
from robustness.kernels.steps import extremes
from robustness.simulation import ADVERSARIES, RunVerdict, Scenario, Start, random_start, simulate
from robustness.simulation.outcome import convergence_rate, groups_of, settled_since, verdict_of
from robustness.simulation.reference import simulate_plainly
from robustness.simulation.schedules import schedule_named

pytestmark = pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")

K5 = nx.complete_graph(5)


def outcome(start: Start | None = None, **changes: Any) -> Any:
    scenario = Scenario(K5, 1, adversary="constant", alpha=4.0, steps=300)
    return simulate(replace(scenario, **changes), start or random_start(K5, [4], 0))[0]


@pytest.mark.parametrize("adversary", ADVERSARIES)
@pytest.mark.parametrize(
    "gains",
    [{"alpha": 4.0}, {"alpha": 2.5}, {"alpha": 1e200}, {"T": 1e200}, {"T": 40.0, "alpha": 0.01},
     {"alpha": {0: 1.5, 1: 1.5, 2: 1.5, 3: 9.0, 4: 1.5}}],
)  # fmt: skip
def test_every_adversary_and_unstable_gains(adversary: str, gains: dict[str, Any]) -> None:
    found = outcome(adversary=adversary, **gains)
    assert found.verdict is RunVerdict.DIVERGENCE
    assert 0 < found.diverged_at <= 300
    assert "nothing is promised" in found.promise_gap
    assert not found.exact
    assert (found.since, found.rate, found.safe) == (None, None, None)
    text = json.dumps(found.as_dict(), allow_nan=False)
    assert json.loads(text)["diverged_at"] == found.diverged_at


@pytest.mark.parametrize("schedule", ["periodic", "random", "adversarial", "delayed"])
def test_every_schedule(schedule: str) -> None:
    assert outcome(schedule=schedule_named(schedule, 3)).verdict is RunVerdict.DIVERGENCE


def test_a_malicious_vehicle_alone_does_not_make_a_run_diverge() -> None:
    """It follows the rule with a gain of its own that makes it overflow, and tells the truth about it."""
    gains = {0: 1.5, 1: 1.5, 2: 1.5, 3: 1.5, 4: 1e200}
    found = outcome(adversary=ADVERSARIES["omission"](), alpha=gains, steps=600)
    assert found.verdict is RunVerdict.AGREEMENT
    assert found.promise_gap is None
    assert found.safe


def test_growth_past_the_factor_is_said_at_its_step() -> None:
    small = outcome(growth=10.0)
    large = outcome(growth=1e6)
    assert small.diverged_at < large.diverged_at
    states = simulate(
        Scenario(K5, 1, adversary="constant", alpha=4.0, steps=300, growth=10.0), random_start(K5, [4], 0), record=True
    )[0].trajectory
    at, normal = small.diverged_at, slice(0, 4)
    # Positions start in 0 .. 100 at rest; T = 1 > 1/alpha turns speeds into lengths.
    far = np.maximum(np.abs(states.p[:, normal] - 50), np.abs(states.q[:, normal])).max(axis=1)
    assert far[:at].max() <= 1000 < far[at]
    assert (states.p[at:, normal] == states.p[at, normal]).all()


def test_a_run_in_a_batch_diverges_alone() -> None:
    scenario = Scenario(K5, 1, adversary="constant", alpha={0: 9.0, 1: 1.5, 2: 1.5, 3: 1.5, 4: 1.5}, steps=400)
    starts = [random_start(K5, [v], 1) for v in (4, 0)]
    first, second = simulate(scenario, starts)
    assert (first.verdict, second.verdict) == (RunVerdict.DIVERGENCE, RunVerdict.AGREEMENT)
    assert [simulate(scenario, start)[0] for start in starts] == [first, second]
    assert second.promise_gap is None


def test_large_starts_are_refused_and_those_within_the_limit_do_not_overflow() -> None:
    with pytest.raises(ValueError, match="at most 1e"):
        Start([4], [0, 1, 2, 3, 1e101], [0] * 5)
    far = Start([4], [-1e100, 1e100, 0, 1, 2], [1e100, -1e100, 0, 0, 0])
    for name in ADVERSARIES:
        assert outcome(far, adversary=name, growth=1e100).verdict is not RunVerdict.AGREEMENT


@given(st.data())
@settings(max_examples=60)
def test_the_plain_loop_diverges_at_the_same_step(data: st.DataObject) -> None:
    number = st.floats(-1e3, 1e3)
    start = Start([4], data.draw(st.tuples(*[number] * 5)), data.draw(st.tuples(*[number] * 5)))
    scenario = Scenario(
        K5, 1, adversary=data.draw(st.sampled_from(sorted(ADVERSARIES))), steps=25,
        T=data.draw(st.sampled_from([0.5, 1.0, 3.0, 1e150])), alpha=data.draw(st.sampled_from([1.0, 4.0, 30.0, 1e150])),
        growth=data.draw(st.sampled_from([2.0, 1e3, 1e100])),
    )  # fmt: skip
    (one,), (other,) = simulate(scenario, start, record=True), simulate_plainly(scenario, [start], record=True)
    assert one == other
    for name in ("p", "q", "sent"):
        assert np.array_equal(getattr(one.trajectory, name), getattr(other.trajectory, name))


class TestNotANumber:
    """The measuring functions by themselves: NaN anywhere is never agreement, and never passes as a number."""

    @given(st.integers(0, 19), st.sampled_from([math.nan, math.inf]), st.booleans())
    def test_is_no_agreement(self, at: int, value: float, in_speed: bool) -> None:
        spread, speed = np.zeros(20), np.zeros(20)
        (speed if in_speed else spread)[at] = value
        verdict, exact = verdict_of(spread, speed, 0.1, 20, watched=False, unchanged=True)
        assert (verdict, exact) == (RunVerdict.UNDECIDED, False)
        assert verdict_of(STILL, STILL, 0.1, 5, watched=False, unchanged=True, diverged=True) == (
            RunVerdict.DIVERGENCE, False,
        )  # fmt: skip

    def test_is_not_settled_fits_no_rate_and_is_near_nobody(self) -> None:
        spread = 0.5 ** np.arange(20.0)
        spread[-1] = math.nan
        assert settled_since(spread, 0.5) is None
        assert convergence_rate(spread) is None
        assert convergence_rate(np.full(9, math.nan)) is None
        values = np.array([1.0, math.nan, 1.0])
        assert len(groups_of(values, np.ones(3, dtype=bool), (0, 1, 2), 0.5)) == 2

    @pytest.mark.parametrize("at", range(4))
    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
    def test_passes_through_the_extremes(self, at: int, value: float) -> None:
        p, q = np.zeros((2, 1, 4))
        low, high, fastest = np.zeros((3, 1))
        normal = np.ones((1, 4), dtype=bool)
        p[0, at] = value
        extremes(p, q, normal, low, high, fastest)
        assert not np.isfinite(high - low)
        p[0, at], q[0, at] = 0.0, value
        extremes(p, q, normal, low, high, fastest)
        assert not np.isfinite(fastest)
        normal[0, at] = False
        extremes(p, q, normal, low, high, fastest)
        assert (low, high, fastest) == (0, 0, 0)


STILL = np.zeros(20)


class TestCommand:
    """The command of the issue, with its brothers."""

    def run(self, tmp_path: Path, *arguments: str) -> tuple[int, str]:
        path = tmp_path / "k5.json"
        path.write_text(json.dumps(nx.node_link_data(K5, edges="edges")), encoding="utf-8")
        done = CliRunner().invoke(robustness, ["simulate", str(path), *arguments])
        return done.exit_code, done.stdout

    @pytest.mark.parametrize("expected", ["agreement", "split"])
    def test_is_neither_expected_outcome(self, tmp_path: Path, expected: str) -> None:
        arguments = ("--alpha", "4", "--adversary", "constant", "--steps", "3000", "--expect", expected)
        code, told = self.run(tmp_path, *arguments)
        assert code == 10
        assert told.startswith("divergence:")
        assert "divergence at step" in told
        assert "gains      outside the gains of the theory at node" in told
        code, document = self.run(tmp_path, *arguments, "--json")
        assert code == 10
        read = json.loads(document)
        assert read["outcome"] == "divergence"
        assert read["runs"][0]["diverged_at"] > 0
        assert "alpha T = 4" in read["runs"][0]["promise_gap"]

    def test_is_an_outcome(self, tmp_path: Path) -> None:
        assert self.run(tmp_path, "--alpha", "4", "--adversary", "sine")[0] == 0
        assert self.run(tmp_path, "--alpha", "4", "--adversary", "sine", "--runs", "3")[1].startswith("divergence:")
