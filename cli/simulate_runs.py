"""``robustness simulate GRAPH`` and ``--replay``: one scenario from one or more starts."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted

from .exit_codes import ExitCode
from .options import load_graph, load_sequence
from .output import Console, ProgressLine, graph_document, set_document, set_text
from .query import Query
from .simulate_asked import SCHEMA, Simulation

if TYPE_CHECKING:
    from certificates.graph import Label
    from robustness.digraph import Digraph
    from robustness.limits import Limits
    from robustness.simulation.attacks import Attack
    from robustness.simulation.outcome import Outcome
    from robustness.simulation.scenario import Scenario, Start
    from robustness.simulation.topology import Topology

__all__ = ["node_named", "run_scenario"]

#: Steps for each exact search of the worst attack, so that no clock chooses the adversary: about a tenth of a second.
_ATTACK_STEPS = 100_000_000


def run_scenario(console: Console, query: Query, asked: Simulation) -> ExitCode:
    """Run one scenario from one or more starts."""
    from robustness.errors import InvalidParameter
    from robustness.limits import Limits
    from robustness.simulation.attacks import Attack
    from robustness.simulation.run import simulate

    try:
        recorded = _recorded(asked)
    except InvalidParameter as problem:  # of a file, where elsewhere it is of the command line
        console.error(f"error: {problem}")
        console.error_document(ExitCode.BAD_INPUT, str(problem))
        return ExitCode.BAD_INPUT
    limits = Limits.of(query.timeout, query.jobs, query.seed)  # for the choice of the adversary and the run together
    if recorded is None:
        scenario, starts = _scenario(_network(asked), query, asked)
        if asked.adversary == "auto" and not asked.malicious:
            scenario, starts = _worst(console, scenario, starts, query, limits)
    elif isinstance(recorded, Attack):
        scenario, starts = _scenario_of_attack(recorded, asked), [recorded.start(seed=query.seed)]
    else:
        scenario, starts = recorded[0], [recorded[1]]
    record = asked.plot is not None or asked.animate is not None
    left: float | None = limits.keywords()["time_limit"]
    with ProgressLine(console) as line:

        def work() -> tuple[Outcome, ...]:
            return simulate(scenario, starts, record=record, jobs=query.jobs, time_limit=left, progress=line)

        try:
            outcomes = query.within(left).wait_for(work, line)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(line.note) from None
    overall = _overall(outcomes)
    if query.as_json:
        console.document(SCHEMA, _document(scenario, starts, outcomes, overall))
    else:
        console.answer(_lines(scenario, starts, outcomes, overall, whole=console.is_verbose))
    _write(console, asked, scenario, starts[0], outcomes[0])
    return ExitCode.of_outcome(overall, asked.expect)


def _write(console: Console, asked: Simulation, scenario: Scenario, start: Start, outcome: Outcome) -> None:
    """Write the first run to the files that were asked for."""
    if asked.save is not None:
        from robustness.simulation.replay import write_run

        write_run(asked.save, scenario, start, outcome)
        console.talk(f"wrote {asked.save}")
    if asked.plot is not None:
        from robustness.figures.simulation import Run, draw_runs

        draw_runs([Run(scenario, start, outcome)], asked.plot, last_step=asked.last_step)
        console.talk(f"wrote {asked.plot}")
    if asked.animate is not None:
        from robustness.figures.animation import animate
        from robustness.figures.simulation import Run

        animate(Run(scenario, start, outcome), asked.animate, last_step=asked.last_step)
        console.talk(f"wrote {asked.animate}")


def _recorded(asked: Simulation) -> Attack | tuple[Scenario, Start] | None:
    """Return what --replay or --attack names, checked."""
    from robustness.errors import InvalidParameter
    from robustness.simulation.attacks import Attack
    from robustness.simulation.replay import read_run
    from robustness.whole_file import read_text

    if asked.replay is not None:
        return read_run(asked.replay)
    if asked.attack_file is None:
        return None
    graph = _network(asked).union
    try:
        document = json.loads(read_text(asked.attack_file))
    except (OSError, ValueError, RecursionError) as problem:
        raise InvalidParameter(f"an attack file is JSON as 'attack -o' writes it: {problem}") from None
    return Attack.from_dict(graph, document)


def _network(asked: Simulation) -> Topology:
    """Return the network that GRAPH names: one graph, or with --over-time a sequence of them."""
    from robustness.simulation.topology import as_topology

    if not asked.over_time:
        return as_topology(load_graph(str(asked.source)), 1)
    return as_topology(load_sequence(str(asked.source), period=asked.repeat), asked.steps)


def _scenario_of_attack(attack: Attack, asked: Simulation) -> Scenario:
    """Return the attack's scenario under the rule and gains of the options; they change nothing about the split."""
    from dataclasses import replace

    changes: dict[str, Any] = {}
    if asked.over_time:
        # Whatever the step, a vehicle hears at most what it hears in the union, which the attack is made for.
        tau = max(asked.tau or 0, attack.schedule.oldest)
        changes = {"network": _network(asked), "schedule": replace(attack.schedule, tau=tau)}
    return attack.scenario(
        asked.steps, rule=asked.rule, T=asked.period, target_speed=asked.speed,
        alpha=asked.alpha, weights=asked.weights, **changes,
    )  # fmt: skip


def _scenario(network: Topology, query: Query, asked: Simulation) -> tuple[Scenario, list[Start]]:
    """Return the scenario and the starts that the options describe."""
    from dataclasses import replace

    from robustness.simulation.adversaries import ADVERSARIES
    from robustness.simulation.front import most_heard
    from robustness.simulation.scenario import Scenario, random_start
    from robustness.simulation.schedules import schedule_named

    graph, turn = network.union, len(network.sequence)
    bound = 1 if asked.f is None else asked.f
    default = turn - 1 + (0 if asked.schedule == "synchronous" else 3)
    tau = default if asked.tau is None else asked.tau
    # A link may be gone for a turn less one step. What tau has beyond that is for waits and delays.
    schedule = replace(schedule_named(asked.schedule, max(tau - turn + 1, 0)), tau=tau)
    malicious = [node_named(graph, text) for text in asked.malicious] or most_heard(graph, bound)
    adversary = ADVERSARIES["greedy" if asked.adversary == "auto" else asked.adversary]()
    scenario = Scenario(
        network, bound, asked.rule, asked.model, adversary,
        schedule, asked.steps, asked.period, asked.speed,
        asked.alpha, asked.weights,
        active=frozenset(node_named(graph, text) for text in asked.active),
    )  # fmt: skip
    seeds = ((query.seed + run) % 2**63 for run in range(asked.runs))
    return scenario, [random_start(graph, malicious, seed) for seed in seeds]


def node_named(graph: Digraph, text: str) -> Label:
    """Return the node that ``text`` names: a label in JSON, such as ``3``, ``"3"`` or ``[0, 1]``, or a bare string."""
    from robustness.errors import InvalidParameter
    from robustness.json_labels import from_json

    try:
        label = from_json(json.loads(text))
    except (ValueError, RecursionError):
        label = text
    for candidate in (label, text):
        if type(candidate) in (int, str, tuple) and candidate in graph.index:
            return candidate
    raise InvalidParameter(
        f"a node is named by its label, but {text!r} is none: the nodes are {set_text(graph.labels, graph.labels)}"
    )


def _worst(
    console: Console, scenario: Scenario, starts: list[Start], query: Query, limits: Limits
) -> tuple[Scenario, list[Start]]:
    """Return the attack that splits this network, where a search of so many steps finds one; else what was given.

    Only the user's own time limit ends the search sooner.
    """
    from dataclasses import replace

    from robustness.simulation.finding import find_attack_within

    graph, delays = scenario.network.union, scenario.schedule.delay_rule
    local = "-local" if scenario.model.endswith("-local") else ""
    # A local bound allows what a bound in all allows, so no Byzantine attack is missed that "byzantine" has.
    model = f"malicious{local}"
    if scenario.model.startswith("byzantine"):
        model = "byzantine"
    elif delays.adversarial and delays.bound >= 1:
        model = f"delayed{local}"
    found = query.wait_for(lambda: find_attack_within(graph, scenario.f, model, limits.counted(_ATTACK_STEPS)))
    attack = found.attack
    if attack is None:
        if found.outcome == "undecided":
            console.talk(
                f"whether an attack splits it was not decided in short: {_in_words(scenario.adversary)} plays instead"
            )
        return scenario, starts
    groups = (tuple(set_document(attack.S1)), tuple(set_document(attack.S2)))
    return replace(scenario, adversary=attack.adversary, groups=groups), [attack.start(seed=query.seed)]


def _overall(outcomes: Sequence[Outcome]) -> str:
    """Return the verdict over several runs: one split is a split, one divergence is one, and agreement needs all."""
    verdicts = {outcome.verdict.value for outcome in outcomes}
    return next(verdict for verdict in ("split", "divergence", "undecided", "agreement") if verdict in verdicts)


def _document(scenario: Scenario, starts: list[Start], outcomes: Sequence[Outcome], overall: str) -> dict[str, Any]:
    runs = [
        {"malicious": set_document(start.malicious), "seed": start.seed, **outcome.as_dict()}
        for start, outcome in zip(starts, outcomes, strict=True)
    ]
    return {
        "graph": graph_document(scenario.network.union),
        "outcome": overall,
        "rule": scenario.rule,
        "model": scenario.model,
        "f": scenario.f,
        "adversary": _in_words(scenario.adversary),
        "schedule": _schedule_in_words(scenario),
        "tau": scenario.schedule.oldest,
        "steps": scenario.steps,
        "runs": runs,
    }


def _lines(
    scenario: Scenario, starts: list[Start], outcomes: Sequence[Outcome], overall: str, *, whole: bool
) -> Iterator[str]:
    nodes = scenario.network.union.labels
    yield _headline(overall, len(outcomes))
    for start, outcome in zip(starts, outcomes, strict=True):
        yield (
            f"malicious  {set_text(start.malicious, nodes, whole=whole)}, seed {start.seed}: {outcome.verdict.value}"
            + (
                ", exactly"
                if outcome.exact
                else ""
                if outcome.diverged_at is None
                else f" at step {outcome.diverged_at}"
            )
        )
        last = _last(scenario, outcome)
        yield f"spread     {outcome.initial_spread:g} at first, {outcome.spread:g} after {counted(last, 'step')}" + (
            "" if outcome.since is None else f", within the tolerance since step {outcome.since}"
        )
        if outcome.diverged_at is not None:
            yield f"gains      {outcome.promise_gap or 'inside the theory: please report'}"
        for value, labels in outcome.groups if outcome.verdict.value != "agreement" else ():
            yield f"group      {set_text(labels, nodes, whole=whole)} at {value:g}"
        if outcome.safe is not None:
            yield f"safety     {'kept: nobody left the hull of the start' if outcome.safe else 'LOST: please report'}"
        if outcome.rate is not None and outcome.contraction is not None:
            least, every = outcome.contraction
            steps = counted(every, "step")
            proven = f"on a network without a trap the spread loses at least {least:.2g} of itself in {steps}"
            yield f"rate       {outcome.rate:.4g} a step, fitted; proven: {proven}"
    yield f"rule       {scenario.rule}, f = {scenario.f}, {scenario.model}, adversary {_in_words(scenario.adversary)}"
    yield f"schedule   {_schedule_in_words(scenario)}"


def _schedule_in_words(scenario: Scenario) -> str:
    schedule = scenario.schedule
    oldest = f", values at most {counted(schedule.tau, 'step')} old" if schedule.tau else ""
    return f"{_in_words(schedule.update_times)}, {_in_words(schedule.delay_rule)}{oldest}"


def _in_words(part: object) -> str:
    """Return a part of a scenario in words: its kind, and its numbers with their names."""
    kind = re.sub(r"(?<!^)(?=[A-Z])", " ", type(part).__name__).lower()
    if not dataclasses.is_dataclass(part):
        return kind
    named = [(each.name.replace("_", " "), getattr(part, each.name)) for each in dataclasses.fields(part)]
    numbers = [f"{name} {value:g}" for name, value in named if type(value) in (int, float)]
    return kind + (f" ({', '.join(numbers)})" if numbers else "")


def _last(scenario: Scenario, outcome: Outcome) -> int:
    """Return the step that the outcome's numbers are of: the horizon, or where a divergence ended the run."""
    return scenario.steps if outcome.diverged_at is None else outcome.diverged_at


def _headline(overall: str, runs: int) -> str:
    color = {"agreement": "green", "split": "red", "divergence": "red", "undecided": "yellow"}[overall]
    what = {
        "agreement": "all normal nodes came together",
        "split": "normal nodes stayed apart",
        "divergence": "normal nodes left every bound",
        "undecided": "neither agreement nor a constant gap at the horizon",
    }[overall]
    return f"{click.style(overall + ':', fg=color, bold=True)} {what}" + (
        f", in {counted(runs, 'run')}" if runs > 1 else ""
    )
