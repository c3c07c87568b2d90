"""Time-varying networks: windows promise, traps of the union refute, and the simulator splits the sequence itself."""

from __future__ import annotations

import json
import random
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from click.testing import CliRunner

import robustness as rb
from certificates import verify_joint, verify_tolerance
from cli.exit_codes import ExitCode
from cli.interruption import Overrun
from cli.main import robustness
from robustness.errors import InvalidParameter
from robustness.simulation import Scenario, Schedule, Start, as_topology
from robustness.simulation.adversaries import Alternating
from robustness.simulation.adversaries.protocol import View
from robustness.simulation.run import simulate
from robustness.simulation.schedules import EveryStep, Past
from robustness.threat_models import Standing, certify_tolerance, confirm, tolerance
from robustness.time_varying import TimeVaryingGraph, canonical_sequence
from tests.oracles import brute_profile
from tests.tolerance.brute_force import has_trap, has_trap_over_time


def spread(graph: nx.Graph, steps: int, period: int | None) -> TimeVaryingGraph:
    """Return the links of a graph dealt out over ``steps`` steps."""
    links = sorted(graph.edges())
    parts = []
    for k in range(steps):
        part = nx.empty_graph(len(graph), create_using=type(graph))
        part.add_edges_from(links[k::steps])
        parts.append(part)
    return TimeVaryingGraph(parts, period=period)


def drawn(count: int) -> list[tuple[TimeVaryingGraph, int]]:
    draw = random.Random(4)
    found = []
    for _ in range(count):
        n, steps = draw.choice((4, 5, 6)), draw.choice((1, 2, 3))
        graph = nx.gnp_random_graph(n, draw.uniform(0.6, 1), seed=draw.randrange(2**31), directed=draw.random() < 0.5)
        found.append((spread(graph, steps, draw.choice((None, steps))), draw.choice((1, 2, 3))))
    return found


def promised(sequence: TimeVaryingGraph, tau: int) -> int:
    """Return the largest f with a jointly (2f+1)-robust window of at most tau steps, union by union; -1 without.

    With delays of at most 1 and updates at every step these are the windows that promise.
    """
    best = -1
    for f in range(sequence.n):
        for length in range(1, tau + 1):
            starts = sequence.window_starts(length)
            unions = [sequence.union(start, length) for start in starts]
            if unions and all(brute_profile(union).get(2 * f + 1, 0) >= 1 for union in unions):
                best = f
    return best


@pytest.mark.parametrize("part", range(2))
def test_as_defined(part: int) -> None:
    """Periodic sequences exactly, by Theorem C (b) tried out; of a finite trace the two conditions that hold anyway."""
    for k, (sequence, tau) in enumerate(drawn(36)[part::2]):
        ages = (tau, *((1, 1), (min(2, tau), 1), (1, 2))[k % 3])
        table = tolerance(sequence, tau=tau, delay=ages[1], gap=ages[2])
        assert list(table) == ["delayed", "delayed-local"]
        union = sequence.union(0, len(sequence))
        for result in table.results:
            local = result.threat.local
            assert result.over_time
            if sequence.period is None:
                trapped = next(f for f in range(10) if has_trap(union.in_masks, f, local))
                longest = result.longest_window or 0
                assert (result.guaranteed, result.refuted) == (promised(sequence, longest), trapped)
                assert all(result.standing(f) is Standing.OPEN for f in result.between)
            else:
                split = next(f for f in range(10) if has_trap_over_time(sequence, ages, f, local))
                assert (result.guaranteed, result.refuted) == (split - 1, split), (ages, local)
                assert confirm(result) is (None if result.attack is None and sum(ages[1:]) - 1 > tau else True)


def test_before_a_period_nothing_is_claimed_that_its_steps_contradict() -> None:
    """A prefix in which all hear all: what holds the period apart does not hold the prefix apart, so f is open."""
    steps = [nx.complete_graph(5), *(halves_of_k5().graph_at(k).to_networkx() for k in range(2))]
    result = tolerance(TimeVaryingGraph(steps, period=2), "delayed", tau=2)
    assert (result.guaranteed, result.standing(1)) == (0, Standing.OPEN)
    steps[0] = nx.empty_graph(5)
    result = tolerance(TimeVaryingGraph(steps, period=2), "delayed", tau=2)
    assert (result.guaranteed, result.refuted, confirm(result)) == (0, 1, True)


def test_the_attack_splits_the_sequence_itself() -> None:
    seen = 0
    for sequence, tau in drawn(8):
        for result in tolerance(sequence, tau=tau, delay=1).results:
            attack = result.attack
            if attack is None:
                continue
            seen += 1
            if sequence.period is None:
                sequence = TimeVaryingGraph([sequence.graph_at(k) for k in range(len(sequence))], period=len(sequence))
            assert attack.run(30, network=as_topology(sequence, 30)).exact
    assert seen > 4


def halves_of_k5() -> TimeVaryingGraph:
    """K_5, whose even steps lack the links 03 and 12 and whose odd steps lack 02 and 13."""
    steps = []
    for lost in ([(0, 3), (1, 2)], [(0, 2), (1, 3)]):
        step = nx.complete_graph(5)
        step.remove_edges_from(lost)
        steps.append(step)
    return TimeVaryingGraph(steps, period=2)


def test_the_corollary_as_printed_is_false_and_nothing_is_promised_by_it() -> None:
    """Jointly 3-robust over l = 2 <= tau = 2 steps; yet with all delays 2 one liar splits it for ever."""
    sequence = halves_of_k5()
    assert rb.check_joint_robustness(sequence, 3, tau=2).within_tau
    for model in ("delayed", "delayed-local"):
        result = tolerance(sequence, model, tau=2)
        assert (result.guaranteed, result.refuted, confirm(result)) == (0, 1, True)
        assert result.attack_sets is not None
        assert result.attack_sets.remembered
        assert result.attack is None
        assert certify_tolerance(result).refuted is None
        # Delays of at most 1 leave room for windows of two steps.
        assert tolerance(sequence, model, tau=2, delay=1).guaranteed == 1


#: tau, delay, gap, and the greatest l with (l - 1) + (gap - 1) + delay <= tau.
SPANS = [(2, None, None, 1), (5, 2, 1, 4), (5, 2, 3, 2), (3, 3, 3, -1)]


class Late:
    """Every message takes so many steps, unless the adversary hurries one of its own."""

    adversarial = True

    def __init__(self, bound: int) -> None:
        self.bound = bound

    def delays(self, view: View, past: Past) -> np.ndarray:
        return np.full((1, view.setting.graph.arc_count), self.bound, dtype=np.int64)


def test_the_counterexample_splits_in_the_simulator() -> None:
    """All delays are 2, values are used for 2 steps: whoever updates hears one half alone, and 4 has two faces."""
    scenario = Scenario(
        as_topology(halves_of_k5(), 300),
        f=1,
        steps=300,
        T=0.5,
        alpha=3.0,
        schedule=Schedule(EveryStep(), Late(2), tau=2),
        adversary=Alternating(0.0, 100.0, (0, 1), (2, 3)),
        groups=((0, 1), (2, 3)),
    )
    (outcome,) = simulate(scenario, [Start(frozenset({4}), (0.0, 0.0, 100.0, 100.0, 50.0), (0.0,) * 5, 0)])
    assert outcome.exact


@pytest.mark.parametrize(("tau", "delay", "gap", "longest"), SPANS)
def test_how_long_windows_may_be(tau: int, delay: int | None, gap: int | None, longest: int) -> None:
    sequence = spread(nx.complete_graph(8), 4, 4)
    result = tolerance(sequence, "delayed", tau=tau, delay=delay, gap=gap)
    assert result.longest_window == longest
    assert result.guaranteed >= (promised(sequence, longest) if longest >= 1 else -1)


def test_more_tau_promises_more() -> None:
    sequence = spread(nx.complete_graph(8), 4, 4)
    found = [tolerance(sequence, "delayed", tau=tau, delay=1).guaranteed for tau in (1, 2, 3, 4)]
    assert found == sorted(found)
    assert found[-1] == tolerance(nx.complete_graph(8), "delayed").guaranteed
    (first, *_) = tolerance(sequence, "delayed", tau=3, delay=1).reasons
    assert "no triple M, S1, S2 for f = 2 holds what is remembered apart at every step (tau = 3" in first.statement
    (first, *_) = tolerance(spread(nx.complete_graph(6), 2, 2), "delayed", tau=2, delay=1).reasons
    assert "jointly 3-robust over every 2 steps; windows may have up to 2 steps (tau = 2" in first.statement
    assert "Theorem C" in first.theorem


def test_a_finite_trace_says_that_it_ends() -> None:
    (first, *_) = tolerance(spread(nx.complete_graph(6), 2, None), "delayed", tau=2, delay=1).reasons
    assert "nothing is said beyond its last step" in first.statement


@pytest.mark.parametrize("period", [2, None])
def test_certificates_are_about_windows_and_about_the_union(period: int | None) -> None:
    sequence = spread(nx.complete_graph(6), 2, period)
    result = tolerance(sequence, "delayed", tau=2, delay=1)
    found = certify_tolerance(result)
    assert found.guaranteed is not None
    assert found.refuted is not None
    promised = verify_joint(canonical_sequence(sequence), found.guaranteed)
    assert (promised.verdict, promised.r, promised.s, promised.window) == ("robust", 2 * result.guaranteed + 1, 1, 2)
    refuted = verify_tolerance(result.graph.canonical_bytes(), found.refuted)
    assert (refuted.verdict, refuted.f) == ("apart", result.refuted)


def test_no_time_no_certificate() -> None:
    result = tolerance(spread(nx.complete_graph(6), 2, 2), "delayed", tau=2, delay=1)
    assert certify_tolerance(result, time_limit=1e-9).guaranteed is None


def test_nothing_over_time_is_promised_without_saying_how_far() -> None:
    sentence = "A finite trace is taken to go on as it was"
    for period, said in ((None, True), (2, False)):
        table = tolerance(spread(nx.complete_graph(6), 2, period), tau=2, delay=1)
        assert all((sentence in text) == said for text in (table.summary(), table["delayed"].summary()))


class TestMisuse:
    sequence = spread(nx.complete_graph(4), 2, 2)

    @pytest.mark.parametrize("tau", [None, 0, -1, 1.5, True])
    def test_tau(self, tau: object) -> None:
        with pytest.raises(InvalidParameter, match="needs tau"):
            tolerance(self.sequence, tau=tau)  # type: ignore[call-overload]

    def test_tau_of_a_fixed_graph(self) -> None:
        with pytest.raises(InvalidParameter, match="tau belongs to a time-varying network"):
            tolerance(nx.path_graph(3), tau=1)

    @pytest.mark.parametrize("name", ["delay", "gap"])
    def test_delay_and_gap(self, name: str) -> None:
        with pytest.raises(InvalidParameter, match=f"{name} is an integer of at least 1"):
            tolerance(self.sequence, tau=1, **{name: 0})

    def test_models_without_a_theorem(self) -> None:
        with pytest.raises(InvalidParameter, match="delayed or delayed-local"):
            tolerance(self.sequence, "byzantine", tau=1)


class TestCommand:
    links = json.dumps({"nodes": [0, 1, 2, 3], "period": 2, "steps": [[[0, 1], [1, 2]], [[2, 3], [3, 0]]]}).encode()

    def run(self, *arguments: str) -> tuple[int, str]:
        done = CliRunner().invoke(robustness, ["tolerance", "-", *arguments], input=self.links)
        return done.exit_code, done.stdout

    def test_json(self) -> None:
        code, text = self.run("--tau", "2", "--delay", "1", "--json")
        assert code == ExitCode.DONE
        assert [model["model"] for model in json.loads(text)["models"]] == ["delayed", "delayed-local"]

    def test_arcs_are_said_to_be_those_of_the_union(self) -> None:
        assert "4 nodes, 4 arcs in the union of 2 steps, directed" in self.run("--tau", "2", "--delay", "1")[1]

    @pytest.mark.parametrize(("f", "code"), [(0, ExitCode.DONE), (1, ExitCode.REFUTED)])
    def test_gate(self, f: int, code: ExitCode) -> None:
        assert self.run("--tau", "2", "--delay", "1", "--require", str(f))[0] == code

    def test_files(self, tmp_path: Path) -> None:
        assert self.run("--tau", "2", "--delay", "1", "-o", str(tmp_path))[0] == ExitCode.DONE
        read = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
        for model in ("delayed", "delayed-local"):
            promised = verify_joint(read["sequence.json"], read[f"{model}-guaranteed-0.cert"])
            assert (promised.verdict, promised.r) == ("robust", 1)
            assert verify_tolerance(read["graph.json"], read[f"{model}-refuted-1.cert"]).verdict == "apart"

    def test_work_that_overruns_speaks_of_the_models_over_time_alone(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def overrun(*_: object, **__: object) -> None:
            raise Overrun

        monkeypatch.setattr("cli.query.interruptibly", overrun)
        code, text = self.run("--tau", "2", "--delay", "1", "--json")
        assert code == ExitCode.UNDECIDED
        assert [model["model"] for model in json.loads(text)["models"]] == ["delayed", "delayed-local"]

    def test_usage(self) -> None:
        assert self.run("--period", "2")[0] == ExitCode.USAGE
        assert self.run("--tau", "2", "--delay", "0")[0] == ExitCode.USAGE
        assert self.run("--tau", "2", "--model", "byzantine")[0] == ExitCode.USAGE


def test_an_undecided_window_promises_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    undecided = rb.JointResult(rb.Verdict.UNDECIDED, 1, 1, reason="the time limit was reached")
    monkeypatch.setattr("robustness.threat_models.over_time.check_joint_within", lambda *_, **__: undecided)
    monkeypatch.setattr("robustness.threat_models.over_time.find_in_all", lambda *_: (None, None, "a limit"))
    result = tolerance(spread(nx.complete_graph(5), 2, 2), "delayed", tau=2, delay=1)
    assert result.guaranteed == -1
    assert result.standing(0) is Standing.UNDECIDED
