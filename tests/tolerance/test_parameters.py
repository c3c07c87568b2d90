"""What is promised, asked about given vehicles: whether it applies, and what would make it apply."""

from __future__ import annotations

import warnings

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.main import robustness
from robustness.errors import InvalidParameter
from robustness.files import encode_topology
from robustness.gain_region import gain_gap
from robustness.simulation import PromiseWarning, Scenario, random_start, simulate
from robustness.threat_models import THREAT_MODELS, Parameters, Standing, tolerance

K4 = nx.complete_graph(4)


def given(T=None, alpha=None, sigma=None, delay=None, gap=None) -> Parameters:  # type: ignore[no-untyped-def]
    found = Parameters.of(T, alpha, sigma, delay, gap)
    assert found is not None
    return found


class TestPromise:
    def test_it_applies_in_the_gain_region_and_only_there(self) -> None:
        threat = THREAT_MODELS["delayed"]
        assert given(T=0.5).promise_gap(threat) is None
        assert given(T=0.01, alpha=2.0, delay=7, gap=3).promise_gap(threat) is None
        for T, alpha, sigma in ((1.0, 1.5, 1.0), (0.01, 0.3, 3.0), (0.5, 3.8, 1.0)):
            gap = given(T=T, alpha=alpha, sigma=sigma).promise_gap(threat)
            assert gap == gain_gap(T, alpha, sigma) is not None

    def test_what_is_advised_makes_it_apply(self) -> None:
        gap = given(T=0.01, alpha=0.3, sigma=3.0).promise_gap(THREAT_MODELS["byzantine"])
        assert gap is not None
        assert gap.endswith("take alpha in 3.4491 .. 199.985")
        assert given(T=0.01, alpha=3.4492, sigma=3.0).promise_gap(THREAT_MODELS["byzantine"]) is None

    def test_models_in_step_know_no_delays(self) -> None:
        for name, threat in THREAT_MODELS.items():
            for late in (given(delay=1), given(gap=2)):
                assert (late.promise_gap(threat) is None) == (not name.startswith("malicious"))
            assert given(delay=0, gap=1).promise_gap(threat) is None

    def test_simulate_warns_of_the_same(self) -> None:
        """The simulator's warning and the line of tolerance come from one function."""
        scenario = Scenario(K4, 0, T=0.5, alpha=0.1, steps=2)
        with pytest.warns(PromiseWarning) as told:
            simulate(scenario, [random_start(rb.Digraph.from_networkx(K4), [], 0)])
        gap = given(T=0.5, alpha=0.1).promise_gap(THREAT_MODELS["delayed"])
        assert gap is not None
        assert str(told[0].message).endswith(gap)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            simulate(Scenario(K4, 0, T=0.5, steps=2), [random_start(rb.Digraph.from_networkx(K4), [], 0)])


class TestResult:
    def test_standings_count_only_what_applies(self) -> None:
        inside, outside = tolerance(K4, "delayed", T=0.5), tolerance(K4, "delayed", T=1.0)
        assert [inside.standing_of(f) for f in (1, 2)] == [Standing.GUARANTEED, Standing.REFUTED]
        assert [outside.standing_of(f) for f in (1, 2)] == [Standing.OPEN, Standing.REFUTED]
        in_step = tolerance(K4, "delayed", delay=0, gap=1)
        assert [in_step.standing_of(f) for f in (1, 2)] == [Standing.GUARANTEED, Standing.OPEN]
        assert tolerance(K4, "delayed").standing_of(1) is Standing.GUARANTEED
        assert (inside.guaranteed, inside.refuted) == (outside.guaranteed, outside.refuted) == (1, 2)

    def test_one_line_says_it(self) -> None:
        told = tolerance(K4, "delayed", T=0.5, delay=2, gap=3).summary()
        assert told.endswith(
            "For T = 0.5, alpha = 3, sigma = 1 (alpha T = 1.5 in 0.875 .. 1.875), delays up to 2, "
            "updates at most 3 steps apart: what is known applies."
        )
        assert "take T < 1, or kept weights" in tolerance(K4, T=1.0).summary()
        assert tolerance(K4, T=1.0).as_dict()["delayed"]["parameters"]["applies"] is False
        assert tolerance(K4).as_dict()["delayed"]["parameters"] is None

    def test_over_time(self) -> None:
        sequence = rb.TimeVaryingGraph([nx.complete_graph(5)] * 2, period=2)
        found = tolerance(sequence, "delayed", tau=2, delay=1, gap=2, T=1.0)
        assert found.standing(1) is Standing.GUARANTEED
        assert found.standing_of(1) is Standing.OPEN

    @pytest.mark.parametrize(
        ("asked", "message"),
        [
            ({"alpha": 2.0}, "alpha = 2.0 says something only with a sampling period: give T too"),
            ({"sigma": 1.0}, "sigma = 1.0 says something only with a sampling period: give T too"),
            ({"T": 0.0}, "T is a positive number, not 0.0"),
            ({"T": float("nan")}, "T is a positive number, not nan"),
            ({"T": 1.0, "alpha": -1.0}, "alpha is a positive number, not -1.0"),
            ({"T": 1.0, "sigma": 0.0}, "sigma is a positive number, not 0.0"),
            ({"delay": -1}, "delay is an integer of at least 0, not -1"),
            ({"gap": 0}, "gap is an integer of at least 1, not 0"),
        ],
    )
    def test_numbers_out_of_range(self, asked: dict[str, float], message: str) -> None:
        with pytest.raises(InvalidParameter) as raised:
            tolerance(K4, "delayed", **asked)
        assert str(raised.value) == message


class TestCommand:
    @staticmethod
    def run(*arguments: str) -> Result:
        return CliRunner().invoke(robustness, ["tolerance", "-", *arguments], input=encode_topology(K4))

    @pytest.mark.parametrize(
        ("arguments", "code", "told"),
        [
            (("-T", "0.5"), 0, "what is known applies."),
            (("-T", "0.5", "--alpha", "3", "--sigma", "1", "--model", "delayed", "--delay", "4", "--gap", "2"), 0, ""),
            (("-T", "1"), 30, "what is known does not apply to these vehicles"),
            (("-T", "0.5", "--alpha", "9"), 30, "take alpha in 1.75 .. 3.75"),
            (("--delay", "2"), 30, "malicious, malicious-local: the promise does not apply"),
            (("--alpha", "2"), 2, "give T too"),
        ],
    )
    def test_the_gate_counts_only_what_applies(self, arguments: tuple[str, ...], code: int, told: str) -> None:
        outcome = self.run("--require", "1", *arguments)
        assert outcome.exit_code == code, outcome.output
        assert told in " ".join(outcome.output.split())  # which is wrapped to the terminal
