"""The experiments of the source paper by name, each a few runs with what the paper reports and the reading taken.

The paper leaves things open; every reading is stated where it is used and in ``docs/paper-experiments.md``:

* the arcs of its 5-node figure are not in the text: ``five_node_figure`` offers three readings, all are run;
* the weights a_ij are not given: unit weights;
* the values that vehicle 4 sends are read in the transformed coordinate p (its ``x_4[2k] = 2 + kTr`` moves along with
  the target, its 200 does not); the other reading, absolute positions, is run beside it;
* vehicles that have not updated yet have heard nothing and only brake towards the target speed;
* in Setting 2 vehicles 1 and 5 update at even steps, at which the last claim is 200, that of the odd step before; that
  they hear the true position at even steps is run beside it.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import networkx as nx

from robustness.constructions.counterexamples import FIVE_NODE_READINGS, five_node_figure, two_f_robust_counterexample
from robustness.decision.front import check_rs_robustness
from robustness.digraph import Digraph, as_digraph
from robustness.errors import InternalError, InvalidParameter
from robustness.paper.gain_cases import GainRun, gains_outside, push_runs, swap_runs
from robustness.simulation.adversaries import Adversary, Alternating, Constant, Liar, TwoFace
from robustness.simulation.attacks import attack_from_trap, attack_from_violation
from robustness.simulation.gains import PromiseWarning
from robustness.simulation.motion import Creep, InAbsolutePositions, InTurns
from robustness.simulation.outcome import Outcome
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import (
    AdversarialDelays,
    AdversarialUpdates,
    EveryStep,
    LatestDelays,
    PeriodicUpdates,
    Schedule,
)
from robustness.simulation.topology import Topology, as_topology
from robustness.spelled import counted
from robustness.time_varying import TimeVaryingGraph, check_joint_robustness

__all__ = ["EXPERIMENTS", "Case", "CaseResult", "Experiment", "experiment_named", "run_experiment"]

_PERIOD, _SPEED = 0.01, 100.0
#: Steps enough for the slowest mode to die out below the last bit of a position, in either setting.
_HORIZON_1, _HORIZON_2 = 10_000, 30_000
_UPDATES = PeriodicUpdates(12, {1: 6, 2: 9, 3: 11, 5: 4})


@dataclass(frozen=True)
class Case:
    """One run of an experiment.

    Attributes
    ----------
    name : str
    reading : str
        What was read into the paper's text, or which condition holds.
    reported : str or None
        The verdict that the paper reports or that a theorem proves, ``"agreement"``, ``"split"`` or ``"divergence"``;
        None: a reading that is run for comparison only.
    scenario : Scenario
    start : Start
    """

    name: str
    reading: str
    reported: str | None
    scenario: Scenario
    start: Start


@dataclass(frozen=True)
class CaseResult:
    """A case and what came of it."""

    case: Case
    outcome: Outcome

    @property
    def as_reported(self) -> bool | None:
        """Whether the outcome is the reported one; None when nothing is reported."""
        return None if self.case.reported is None else self.outcome.verdict.value == self.case.reported

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON-ready values."""
        case = self.case
        extra = {"case": case.name, "reading": case.reading, "reported": case.reported, "as_reported": self.as_reported}
        return extra | self.outcome.as_dict()


@dataclass(frozen=True)
class Experiment:
    """A named experiment: its first case is the one the paper shows.

    Attributes
    ----------
    name, title : str
    cases : callable
        Returns the cases; solving for evidence happens here.
    """

    name: str
    title: str
    cases: Callable[[], tuple[Case, ...]]


def _five_nodes(
    network: nx.Graph, positions: list[float], gains: dict[Hashable, float], adversary: Adversary, **more: Any
) -> tuple[Scenario, Start]:
    """Return the common frame of Settings 1 and 2: vehicle 4 is malicious and has no gain of its own."""
    velocities = tuple(v - _SPEED for v in (50.0, 70.0, 70.0, 60.0, 10.0))
    scenario = Scenario(
        Topology((as_digraph(network),)), f=1, rule="adp-msr", adversary=adversary, schedule=Schedule(_UPDATES),
        T=_PERIOD, target_speed=_SPEED, alpha={**gains, 4: 1.0}, weights="unit", **more,
    )  # fmt: skip
    return scenario, Start(frozenset({4}), tuple(positions), velocities)


def _networks() -> list[tuple[str, nx.Graph, str]]:
    figures = [(f"figure read as {name}", five_node_figure(name), "split") for name in FIVE_NODE_READINGS]
    return [*figures, ("complete graph", nx.complete_graph(range(1, 6)), "agreement")]


def _setting_1() -> tuple[Case, ...]:
    positions: list[float] = [4.0, 250.0, 150.0, 8.0, 0.0]
    gains: dict[Hashable, float] = {1: 2.0, 5: 2.0, 2: 3.0, 3: 3.0}
    moving = Alternating(2.0, 200.0)
    fixed = InAbsolutePositions(moving, _PERIOD * _SPEED, odd_only=True)
    cases = []
    for name, network, verdict in _networks():
        frame = _five_nodes(network, positions, gains, moving, steps=_HORIZON_1)
        cases.append(Case(name, "claims are transformed positions p", verdict, *frame))
    frame = _five_nodes(five_node_figure(), positions, gains, fixed, steps=_HORIZON_1)
    return (*cases, Case("figure read as wheel", "claims are absolute positions x", None, *frame))


def _setting_2() -> tuple[Case, ...]:
    positions: list[float] = [100.0, 400.0, 500.0, 10.0, 0.0]
    gains: dict[Hashable, float] = {1: 2.0, 5: 2.0, 2: 10.0, 3: 10.0}
    per_step = _PERIOD * _SPEED
    moving: Adversary = Liar(Constant(200.0), Creep())
    fixed: Adversary = Liar(Constant(200.0), InAbsolutePositions(Creep(), per_step))
    more: dict[str, Any] = {"active": frozenset({2, 3}), "steps": _HORIZON_2}
    cases = []
    for name, network, verdict in _networks():
        frame = _five_nodes(network, positions, gains, moving, **more)
        cases.append(Case(name, "claims and motion of vehicle 4 are transformed positions p", verdict, *frame))
    frame = _five_nodes(five_node_figure(), positions, gains, fixed, **more)
    cases.append(Case("figure read as wheel", "the motion of vehicle 4 is in absolute positions x", None, *frame))
    honest: Adversary = Liar(InTurns(Creep(), Constant(200.0)), Creep())
    frame = _five_nodes(five_node_figure(), positions, gains, honest, **more)
    reading = "at even steps, where vehicles 1 and 5 update, vehicle 4 says where it is; 200 at odd ones"
    return (*cases, Case("figure read as wheel", reading, None, *frame))


def _proposition_1() -> tuple[Case, ...]:
    """Return the attack on the literal and on the corrected graph, for f = 1, 2, 3."""
    cases = []
    for variant in ("paper", "corrected"):
        for f in (1, 2, 3):
            network = two_f_robust_counterexample(f, variant)
            attack = attack_from_trap(network, f, *(network.graph["trap"][key] for key in ("M", "S1", "S2")))
            reading = f"{2 * f}-robust, {attack.story()}"
            cases.append(Case(f"{variant} graph, f = {f}", reading, "split", attack.scenario(1000), attack.start()))
    return tuple(cases)


def _necessity() -> tuple[Case, ...]:
    """Return the attack of the necessity proof on graphs that are not (f+1,f+1)-robust, under every rule."""
    cases = []
    two_cliques = nx.compose(nx.complete_graph(range(5)), nx.complete_graph(range(5, 10)))
    two_cliques.add_edges_from((i, i + 5) for i in range(5))
    networks = (
        ("cycle of 6", nx.cycle_graph(6), 1),
        ("two 5-cliques and a matching", two_cliques, 1),
        # 2f-robust, so without a malicious node there would be no split.
        *((f"paper's Proposition 1 graph, f = {f}", two_f_robust_counterexample(f, "paper"), f) for f in (1, 2)),
    )
    for name, network, f in networks:
        witness = check_rs_robustness(network, f + 1, f + 1).witness
        if witness is None:
            raise InternalError(f"the {name} was expected to violate ({f + 1},{f + 1})-robustness: please report")
        attack = attack_from_violation(network, f, witness)
        for rule in ("adp-msr", "dp-msr", "w-msr"):
            reading = f"not ({f + 1},{f + 1})-robust, {attack.story()}"
            cases.append(Case(f"{name}, {rule}", reading, "split", attack.scenario(500, rule=rule), attack.start()))
    return tuple(cases)


def _sufficiency() -> tuple[Case, ...]:
    """Return (2f+1)-robust graphs under delays, against the adversary that defeats 2f-robust ones."""
    cases = []
    for f, network in ((1, nx.complete_graph(5)), (1, _circulant(12, 3)), (2, nx.complete_graph(9))):
        graph = as_digraph(network)
        scenario = Scenario(
            Topology((graph,)), f, adversary=TwoFace(), schedule=Schedule(AdversarialUpdates(4), AdversarialDelays(3)),
            steps=3000,
        )  # fmt: skip
        name = f"{counted(graph.n, 'node')}, f = {f}, seen two-faced"
        cases.append(Case(name, f"{2 * f + 1}-robust", "agreement", scenario, _spread_out(graph, range(f))))
    return tuple(cases)


def _corollary_2() -> tuple[Case, ...]:
    """Return a network that is 3-robust only jointly, over l <= tau steps, and one that is never more than 2-robust."""
    whole = nx.complete_graph(6)
    edges = sorted(whole.edges)
    parts = [nx.Graph(edges[k::3]) for k in range(3)]
    for part in parts:
        part.add_nodes_from(whole)
    sequence = TimeVaryingGraph(parts, period=3)
    window = check_joint_robustness(sequence, 3).window
    cases = []
    for tau in (3, 5):
        late = Schedule(delay_rule=AdversarialDelays(1), tau=tau)
        scenario = Scenario(as_topology(sequence, 3000), 1, adversary=TwoFace(), schedule=late, steps=3000)
        start = _spread_out(scenario.network.union, [0])
        name = f"complete graph in thirds, tau = {tau}"
        cases.append(Case(name, f"jointly 3-robust over {counted(window or 0, 'step')}", "agreement", scenario, start))
    broken = two_f_robust_counterexample(1, "corrected")
    halves = [nx.Graph(sorted(broken.edges)[k::2]) for k in range(2)]
    for part in halves:
        part.add_nodes_from(broken)
    trap = broken.graph["trap"]
    attack = attack_from_trap(broken, 1, trap["M"], trap["S1"], trap["S2"])
    topology = as_topology(TimeVaryingGraph(halves, period=2), 1000)
    late = Schedule(delay_rule=AdversarialDelays(1), tau=2)
    scenario = attack.scenario(1000, network=topology, schedule=late)
    cases.append(Case("trapped wheel in halves, tau = 2", "jointly 2-robust only", "split", scenario, attack.start()))
    return (*cases, *_late_halves())


def _late_halves() -> Iterator[Case]:
    """Yield K_5 in two halves, jointly 3-robust over l = 2 steps: links remembered for longer than tau are lost."""
    halves = []
    for missing in ([(0, 3), (1, 2)], [(0, 2), (1, 3)]):
        half = nx.complete_graph(5)
        half.remove_edges_from(missing)
        halves.append(half)
    sequence = TimeVaryingGraph(halves, period=2)
    window = check_joint_robustness(sequence, 3).window
    start = Start([4], [0, 0, 100, 100, 50], [0] * 5)
    liar = Alternating(0.0, 100.0, (0, 1), (2, 3))
    for late, tau, verdict in ((2, 2, "split"), (1, 2, "agreement"), (2, 3, "agreement")):
        scenario = Scenario(
            sequence, 1, adversary=liar, schedule=Schedule(EveryStep(), LatestDelays(late), tau=tau), steps=2000,
            groups=((0, 1), (2, 3)),
        )  # fmt: skip
        sign = "<=" if verdict == "agreement" else ">"
        reading = f"jointly 3-robust over l = {window} <= tau steps, (l-1) + (g-1) + b = {1 + late} {sign} tau"
        yield Case(f"K_5 in halves, all delays {late}, tau = {tau}", reading, verdict, scenario, start)


def _about(runs: Callable[[], tuple[GainRun, ...]]) -> Callable[[], tuple[Case, ...]]:
    def cases() -> tuple[Case, ...]:
        return tuple(Case(run.name, run.reading, run.expected, run.scenario, run.start) for run in runs())

    return cases


def _corollary_1() -> tuple[Case, ...]:
    """Return a (2f+1)-robust graph with more than f malicious nodes in all, at most f near any normal one."""
    graph = as_digraph(_circulant(24, 3))
    scenario = Scenario(
        Topology((graph,)), 1, model="malicious-local", adversary=TwoFace(), steps=4000,
        schedule=Schedule(AdversarialUpdates(3), AdversarialDelays(2)),
    )  # fmt: skip
    start = _spread_out(graph, [0, 8, 16])
    return (Case("3-nearest ring of 24", "3-robust, 3 malicious, f = 1 local", "agreement", scenario, start),)


def _gap() -> tuple[Case, ...]:
    """Return the delayed attack where the paper's conditions leave a gap: (f+1,f+1)-robust, not (2f+1)-robust."""
    cases = []
    for f in (1, 2):
        network = two_f_robust_counterexample(f, "corrected")
        trap = network.graph["trap"]
        for model, how in (("malicious", "with delays"), ("byzantine", "without delays")):
            attack = attack_from_trap(network, f, trap["M"], trap["S1"], trap["S2"], model)
            reading = f"({f + 1},{f + 1})-robust, {attack.story()}"
            name = f"corrected graph, f = {f}, {model} {how}"
            cases.append(Case(name, reading, "split", attack.scenario(500), attack.start()))
    return tuple(cases)


def _circulant(n: int, k: int) -> nx.Graph:
    return nx.circulant_graph(n, range(1, k + 1))


def _spread_out(graph: Digraph, malicious: Any) -> Start:
    """Return a start at rest with the vehicles spread evenly over 0 .. 100 in id order."""
    places = tuple(100.0 * i / (graph.n - 1) for i in range(graph.n))
    return Start(frozenset(graph.labels[i] for i in malicious), places, (0.0,) * graph.n)


#: Every experiment by its name.
EXPERIMENTS: Mapping[str, Experiment] = MappingProxyType(
    {
        experiment.name: experiment
        for experiment in (
            Experiment("setting-1", "Setting 1: passive sensing, vehicle 4 sends 2 and 200 in turn", _setting_1),
            Experiment("setting-2", "Setting 2: vehicles 2 and 3 see vehicle 4 itself", _setting_2),
            Experiment("proposition-1", "Proposition 1: 2f-robust, and split under delays", _proposition_1),
            Experiment("necessity", "Theorem 1, necessity: not (f+1,f+1)-robust, split without delays", _necessity),
            Experiment("sufficiency", "Theorem 1, sufficiency: (2f+1)-robust, agreement under delays", _sufficiency),
            Experiment("gap", "Between the conditions: (f+1,f+1)-robust and trapped", _gap),
            Experiment("corollary-1", "Corollary 1: (2f+1)-robust under the f-local model", _corollary_1),
            Experiment("corollary-2", "Corollary 2: jointly (2f+1)-robust over at most tau steps", _corollary_2),
            Experiment("gains-outside", "Outside the gain region: delays alone part vehicles", _about(gains_outside)),
            Experiment("swap", "On the edge of the gain region: vehicles swap places for ever", _about(swap_runs)),
            Experiment("push", "Theorem 1 with any positive gain: one liar, delays of one step", _about(push_runs)),
        )
    }
)


def experiment_named(name: str) -> Experiment:
    """Return the experiment of this name, or raise :class:`InvalidParameter` naming those there are."""
    if name not in EXPERIMENTS:
        raise InvalidParameter(f"an experiment is one of {', '.join(EXPERIMENTS)}, not {name!r}")
    return EXPERIMENTS[name]


def run_experiment(
    experiment: Experiment, *, record: bool = False, time_limit: float | None = None
) -> tuple[CaseResult, ...]:
    """Run every case, within a time limit for all together.

    That gains lie outside the theory, as in Settings 1 and 2, is said in the outcomes and not warned of.

    >>> [result.as_reported for result in run_experiment(experiment_named("gap"))]
    [True, True, True, True]
    """
    results = []
    deadline = None if time_limit is None else time.monotonic() + time_limit
    for case in experiment.cases():
        left = None if deadline is None else deadline - time.monotonic()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PromiseWarning)
            (outcome,) = simulate(case.scenario, [case.start], record=record, time_limit=left)
        results.append(CaseResult(case, outcome))
    return tuple(results)
