"""``robustness simulate``: consensus under attack, the paper's experiments, and certificates put to the test."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .exit_codes import ExitCode
from .options import (
    jobs_option,
    json_option,
    load_graph,
    seed_option,
    talk_options,
    timeout_option,
)
from .output import Console, graph_document, pass_console, set_document, set_text

if TYPE_CHECKING:
    from certificates.graph import Label
    from robustness.digraph import Digraph
    from robustness.paper.experiments import CaseResult
    from robustness.simulation.attacks import Attack
    from robustness.simulation.outcome import Outcome
    from robustness.simulation.scenario import Scenario, Start
    from robustness.simulation.topology import Topology

__all__ = ["SCHEMA", "command", "exit_code", "node_named"]

SCHEMA = "robustness/simulate/1"

# Written out so that --help need not import the library; tests compare them with its registries.
_RULES = ("adp-msr", "dp-msr", "w-msr")
_MODELS = ("malicious", "malicious-local", "byzantine", "byzantine-local")
_SCHEDULES = ("synchronous", "periodic", "random", "adversarial", "delayed")
_ADVERSARIES = ("auto", "constant", "ramp", "sine", "random", "two-face", "extreme", "greedy", "crash", "omission")
_EXPERIMENTS = (
    "setting-1", "setting-2", "proposition-1", "necessity", "sufficiency", "gap", "corollary-1", "corollary-2",
    "gains-outside", "swap", "push",
)  # fmt: skip

#: Seconds for the search for an attack.
_PATIENCE = 5.0

#: Where a counterexample to a certificate is written when --save names no other place.
_COUNTEREXAMPLE = "counterexample.json"

_FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("simulate")
@click.argument("source", metavar="[GRAPH]", required=False)
@click.option("--experiment", type=click.Choice(_EXPERIMENTS), help="An experiment of the paper instead of GRAPH.")
@click.option("--replay", type=_FILE, metavar="FILE", help="A run recorded with --save instead of GRAPH.")
@click.option("--attack", "attack_file", type=_FILE, metavar="FILE", help="Play the attack that 'attack -o' wrote.")
@click.option("--certificate", type=_FILE, metavar="FILE", help="Play the whole battery against a certificate.")
@click.option("-f", "f", type=click.IntRange(min=0), help="The bound on faults.  [default: 1]")
@click.option("--malicious", multiple=True, metavar="NODE", help="May be repeated.  [default: the F heard by most]")
@click.option(
    "--adversary",
    type=click.Choice(_ADVERSARIES),
    default="auto",
    show_default=True,
    help="auto: the attack that splits this network, where 5 seconds find one; else greedy.",
)
@click.option("--rule", type=click.Choice(_RULES), default="adp-msr", show_default=True)
@click.option("--model", type=click.Choice(_MODELS), default="malicious", show_default=True)
@click.option("--schedule", type=click.Choice(_SCHEDULES), default="synchronous", show_default=True)
@click.option("--tau", type=click.IntRange(min=0), help="The bound on the age of values.  [default: 0 or 3]")
@click.option("--over-time", is_flag=True, help="GRAPH is a sequence of graphs, as 'joint' reads it.")
@click.option("--period", "repeat", type=click.IntRange(min=1), metavar="P", help="With it: the last P steps repeat.")
@click.option("--active", multiple=True, metavar="NODE", help="Senses actively; may be repeated.")
@click.option("--steps", type=click.IntRange(min=1), default=1000, show_default=True)
@click.option("--runs", type=click.IntRange(min=1), default=1, show_default=True, help="Random starts.")
@click.option("-T", "--sampling-period", "period", type=float, default=1.0, show_default=True)
@click.option("--speed", type=float, default=0.0, show_default=True, help="The target speed.")
@click.option("--alpha", type=float, help="The gain of every vehicle.  [default: 1.5/T]")
@click.option("--weights", type=click.Choice(("uniform", "unit")), default="uniform", show_default=True)
@click.option("--save", type=_FILE, metavar="FILE", help="Record the (first) run, or a counterexample.")
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="A picture (.png, .svg, .pdf); with --experiment also a folder for one per case.",
)
@click.option("--animate", type=_FILE, metavar="FILE", help="The first run as a film: .gif, or .html to play.")
@click.option("--expect", type=click.Choice(("agreement", "split")), help="Exit with 10 when it ends otherwise.")
@json_option
@timeout_option
@jobs_option
@seed_option
@talk_options
@pass_console
@click.pass_context
def command(ctx: click.Context, console: Console, /, **options: Any) -> None:
    """Run resilient consensus on GRAPH under attack, and say whether it ends in agreement or split.

    Exit code 0 for agreement, split or divergence, 30 when undecided at the horizon; with --expect 10 for another one.
    An experiment ends in 10 when a case differs from what the paper reports. With --certificate, 10 is a
    counterexample; it is saved for --replay, as counterexample.json unless --save names another file.
    """
    if sum(options[name] is not None for name in ("source", "experiment", "replay")) != 1:
        raise click.UsageError("give one of GRAPH, --experiment and --replay.")
    if options["source"] is None and (options["attack_file"] or options["certificate"]):
        raise click.UsageError("--attack and --certificate need the GRAPH they are about.")
    if options["attack_file"] and options["certificate"]:
        raise click.UsageError("give one of --attack and --certificate.")
    if options["animate"] is not None and (options["experiment"] or options["certificate"]):
        raise click.UsageError("--animate shows one run: give it with GRAPH or --replay.")
    if options["over_time"] and (options["source"] is None or options["certificate"]):
        raise click.UsageError("--over-time says what GRAPH is, and a certificate is about one graph.")
    if options["repeat"] is not None and not options["over_time"]:
        raise click.UsageError("--period belongs to a sequence: give --over-time as well.")
    from robustness.files.writing import require_different_files

    inputs = [options[name] for name in ("source", "replay", "attack_file", "certificate")]
    require_different_files(inputs, [options[name] for name in ("save", "plot", "animate")])
    if options["experiment"] is not None:
        code = _experiment(console, options)
    elif options["certificate"] is not None:
        code = _certificate(ctx, console, options)
    else:
        code = _runs(ctx, console, options)
    ctx.exit(code)


def exit_code(outcome: str, expected: str | None) -> ExitCode:
    """Return the exit code of an outcome: undecided is never a verdict, and the other verdict refutes."""
    if outcome == "undecided":
        return ExitCode.UNDECIDED
    return ExitCode.REFUTED if expected not in (None, outcome) else ExitCode.DONE


def node_named(graph: Digraph, text: str) -> Label:
    """Return the node that ``text`` names: a label in JSON, such as ``3``, ``"3"`` or ``[0, 1]``, or a bare string."""
    from robustness.errors import InvalidParameter

    try:
        label = _hashable(json.loads(text))
    except (ValueError, RecursionError):
        label = text
    for candidate in (label, text):
        if type(candidate) in (int, str, tuple) and candidate in graph.index:
            return candidate
    raise InvalidParameter(f"a node is named by its label, but {text!r} is none: list them with 'check -v'")


def _hashable(value: Any) -> Any:
    return tuple(_hashable(part) for part in value) if isinstance(value, list) else value


def _runs(ctx: click.Context, console: Console, options: dict[str, Any]) -> ExitCode:
    """Run one scenario from one or more starts."""
    from robustness.errors import InvalidParameter
    from robustness.simulation.attacks import Attack
    from robustness.simulation.run import simulate

    try:
        recorded = _recorded(options)
    except InvalidParameter as problem:  # of a file, where elsewhere it is of the command line
        console.error(f"error: {problem}")
        return ExitCode.BAD_INPUT
    if recorded is None:
        scenario, starts = _scenario(_network(options), options)
        if options["adversary"] == "auto" and not options["malicious"]:
            scenario, starts = _worst(scenario, starts, options)
    elif isinstance(recorded, Attack):
        scenario, starts = _scenario_of_attack(recorded, options), [recorded.start(seed=options["seed"])]
    else:
        scenario, starts = recorded[0], [recorded[1]]
    outcomes = simulate(
        scenario, starts, record=options["plot"] is not None or options["animate"] is not None, jobs=options["jobs"],
        time_limit=options["timeout"],
    )  # fmt: skip
    if options["save"] is not None:
        from robustness.simulation.replay import write_run

        write_run(options["save"], scenario, starts[0], outcomes[0])
    if options["plot"] is not None:
        from robustness.figures.simulation import Run, draw_runs

        draw_runs([Run(scenario, starts[0], outcomes[0])], options["plot"])
        console.talk(f"wrote {options['plot']}")
    if options["animate"] is not None:
        from robustness.figures.animation import animate
        from robustness.figures.simulation import Run

        animate(Run(scenario, starts[0], outcomes[0]), options["animate"])
        console.talk(f"wrote {options['animate']}")
    overall = _overall(outcomes)
    if options["as_json"]:
        console.document(SCHEMA, _document(scenario, starts, outcomes, overall))
    else:
        console.result("\n".join(_lines(scenario, starts, outcomes, overall, whole=console.is_verbose)))
    return exit_code(overall, options["expect"])


def _recorded(options: dict[str, Any]) -> Attack | tuple[Scenario, Start] | None:
    """Return what --replay or --attack names, checked."""
    from robustness.errors import InvalidParameter
    from robustness.simulation.attacks import Attack
    from robustness.simulation.replay import read_run

    if options["replay"] is not None:
        return read_run(options["replay"])
    if options["attack_file"] is None:
        return None
    graph = _network(options).union
    try:
        document = json.loads(options["attack_file"].read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as problem:
        raise InvalidParameter(f"an attack file is JSON as 'attack -o' writes it: {problem}") from None
    return Attack.from_dict(graph, document)


def _network(options: dict[str, Any]) -> Topology:
    """Return the network that GRAPH names: one graph, or with --over-time a sequence of them."""
    from robustness.simulation.topology import as_topology

    if not options["over_time"]:
        return as_topology(load_graph(options["source"]), 1)
    from robustness.time_varying import read_sequence

    return as_topology(read_sequence(options["source"], period=options["repeat"]), options["steps"])


def _scenario_of_attack(attack: Attack, options: dict[str, Any]) -> Scenario:
    """Return the attack's scenario under the rule and gains of the options; they change nothing about the split."""
    from dataclasses import replace

    changes: dict[str, Any] = {}
    if options["over_time"]:
        # Whatever the step, a vehicle hears at most what it hears in the union, which the attack is made for.
        tau = max(options["tau"] or 0, attack.schedule.oldest)
        changes = {"network": _network(options), "schedule": replace(attack.schedule, tau=tau)}
    return attack.scenario(
        options["steps"], rule=options["rule"], T=options["period"], target_speed=options["speed"],
        alpha=options["alpha"], weights=options["weights"], **changes,
    )  # fmt: skip


def _scenario(network: Topology, options: dict[str, Any]) -> tuple[Scenario, list[Start]]:
    """Return the scenario and the starts that the options describe."""
    from dataclasses import replace

    from robustness.simulation.adversaries import ADVERSARIES
    from robustness.simulation.front import most_heard
    from robustness.simulation.scenario import Scenario, random_start
    from robustness.simulation.schedules import schedule_named

    graph, turn = network.union, len(network.sequence)
    bound = 1 if options["f"] is None else options["f"]
    default = turn - 1 + (0 if options["schedule"] == "synchronous" else 3)
    tau = default if options["tau"] is None else options["tau"]
    # A link may be gone for a turn less one step. What tau has beyond that is for waits and delays.
    schedule = replace(schedule_named(options["schedule"], max(tau - turn + 1, 0)), tau=tau)
    malicious = [node_named(graph, text) for text in options["malicious"]] or most_heard(graph, bound)
    adversary = ADVERSARIES["greedy" if options["adversary"] == "auto" else options["adversary"]]()
    scenario = Scenario(
        network, bound, options["rule"], options["model"], adversary,
        schedule, options["steps"], options["period"], options["speed"],
        options["alpha"], options["weights"],
        active=frozenset(node_named(graph, text) for text in options["active"]),
    )  # fmt: skip
    seeds = ((options["seed"] + run) % 2**63 for run in range(options["runs"]))
    return scenario, [random_start(graph, malicious, seed) for seed in seeds]


def _worst(scenario: Scenario, starts: list[Start], options: dict[str, Any]) -> tuple[Scenario, list[Start]]:
    """Return the attack that splits this network, where a search of a few seconds finds one; else what was given."""
    from dataclasses import replace

    from robustness.simulation.finding import find_attack

    graph, delays = scenario.network.union, scenario.schedule.delay_rule
    local = "-local" if scenario.model.endswith("-local") else ""
    # A local bound allows what a bound in all allows, so no Byzantine attack is missed that "byzantine" has.
    model = f"malicious{local}"
    if scenario.model.startswith("byzantine"):
        model = "byzantine"
    elif delays.adversarial and delays.bound >= 1:
        model = f"delayed{local}"
    patience = min(_PATIENCE, options["timeout"] or _PATIENCE)
    attack = find_attack(graph, scenario.f, model, time_limit=patience, seed=options["seed"]).attack
    if attack is None:
        return scenario, starts
    groups = (tuple(set_document(attack.S1)), tuple(set_document(attack.S2)))
    return replace(scenario, adversary=attack.adversary, groups=groups), [attack.start(seed=options["seed"])]


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
        "adversary": repr(scenario.adversary),
        "schedule": repr(scenario.schedule),
        "tau": scenario.schedule.oldest,
        "steps": scenario.steps,
        "runs": runs,
    }


def _lines(
    scenario: Scenario, starts: list[Start], outcomes: Sequence[Outcome], overall: str, *, whole: bool
) -> Iterator[str]:
    yield _headline(overall, len(outcomes))
    for start, outcome in zip(starts, outcomes, strict=True):
        yield f"malicious  {set_text(start.malicious, whole=whole)}, seed {start.seed}: {outcome.verdict.value}" + (
            ", exactly" if outcome.exact else "" if outcome.diverged_at is None else f" at step {outcome.diverged_at}"
        )
        last = _last(scenario, outcome)
        yield f"spread     {outcome.initial_spread:g} at first, {outcome.spread:g} after {last} steps" + (
            "" if outcome.since is None else f", within the tolerance since step {outcome.since}"
        )
        if outcome.diverged_at is not None:
            yield f"gains      {outcome.promise or 'inside the theory: please report'}"
        for value, labels in outcome.groups if outcome.verdict.value != "agreement" else ():
            yield f"group      {set_text(labels, whole=whole)} at {value:g}"
        if outcome.safe is not None:
            yield f"safety     {'kept: nobody left the hull of the start' if outcome.safe else 'LOST: please report'}"
        if outcome.rate is not None and outcome.contraction is not None:
            least, every = outcome.contraction
            proven = f"on a network without a trap the spread loses at least {least:.2g} of itself in {every} steps"
            yield f"rate       {outcome.rate:.4g} a step, fitted; proven: {proven}"
    yield f"rule       {scenario.rule}, f = {scenario.f}, {scenario.model}, {scenario.adversary}"
    yield f"schedule   {scenario.schedule}"


def _last(scenario: Scenario, outcome: Outcome) -> int:
    """Return the step that the outcome's numbers are of: the horizon, or where a divergence ended the run."""
    return scenario.steps if outcome.diverged_at is None else outcome.diverged_at


def _headline(overall: str, runs: int) -> str:
    color = {"agreement": "green", "split": "red", "divergence": "red", "undecided": "yellow"}[overall]
    what = {
        "agreement": "all normal vehicles came together",
        "split": "normal vehicles stayed apart",
        "divergence": "normal vehicles left every bound",
        "undecided": "neither agreement nor a constant gap at the horizon",
    }[overall]
    return f"{click.style(overall + ':', fg=color, bold=True)} {what}" + (f", in {runs} runs" if runs > 1 else "")


def _experiment(console: Console, options: dict[str, Any]) -> ExitCode:
    """Run an experiment of the paper, case by case."""
    from robustness.paper.experiments import EXPERIMENTS, run_experiment

    experiment = EXPERIMENTS[options["experiment"]]
    results = run_experiment(experiment, record=options["plot"] is not None, time_limit=options["timeout"])
    if options["plot"] is not None:
        from robustness.paper.trajectories import draw_experiment

        for path in draw_experiment(experiment.name, results, options["plot"]):
            console.talk(f"wrote {path}")
    overall = results[0].outcome.verdict.value
    confirmed = all(result.as_reported is not False for result in results)
    if options["as_json"]:
        cases = [result.as_dict() for result in results]
        content = {"experiment": experiment.name, "title": experiment.title, "outcome": overall}
        console.document(SCHEMA, {**content, "as_reported": confirmed, "cases": cases})
    else:
        console.result("\n".join(_experiment_lines(experiment.title, results)))
    code = exit_code(overall, options["expect"])
    return code if confirmed else ExitCode.REFUTED


def _experiment_lines(title: str, results: Sequence[CaseResult]) -> Iterator[str]:
    yield title
    for result in results:
        case, outcome = result.case, result.outcome
        said = "" if case.reported is None else f" (reported: {case.reported})"
        yield f"{outcome.verdict.value:<10} {case.name}{said}"
        yield f"           {case.reading}"
        places = ", ".join(f"{set_text(labels)} at {value:.6g}" for value, labels in outcome.groups)
        yield f"           {places}; gap {outcome.spread:.6g}" + (", exact" if outcome.exact else "")


def _certificate(ctx: click.Context, console: Console, options: dict[str, Any]) -> ExitCode:
    """Put a certificate to the test."""
    from robustness.simulation.validate import validate_certificate

    graph = load_graph(options["source"])
    steps = options["steps"] if ctx.get_parameter_source("steps") is click.core.ParameterSource.COMMANDLINE else None
    try:
        evidence = options["certificate"].read_bytes()
    except OSError as problem:
        console.error(f"error: cannot read {options['certificate']}: {problem.strerror}")
        return ExitCode.BAD_INPUT
    # Elsewhere than on a terminal click would still print the label.
    is_shown = sys.stderr is not None and sys.stderr.isatty() and not console.is_quiet
    with click.progressbar(length=1, label="battery", file=sys.stderr if is_shown else io.StringIO()) as bar:

        def advance(done: int, total: int) -> None:
            bar.length = total
            bar.update(done - bar.pos)

        report = validate_certificate(
            graph, evidence, f=options["f"], steps=steps, seed=options["seed"], jobs=options["jobs"],
            time_limit=options["timeout"], progress=advance, save_to=options["save"] or Path(_COUNTEREXAMPLE),
        )  # fmt: skip
    found = report.counterexample
    if options["as_json"]:
        content = {
            "graph": graph_document(graph),
            "outcome": report.outcome,
            "validation": report.verdict,
            "runs": report.runs,
            "exhaustive": report.exhaustive,
            "reason": report.reason,
            "counterexample": None if found is None or found.saved_as is None else str(found.saved_as),
        }
        console.document(SCHEMA, content)
    else:
        console.result(f"{report.verdict}: {report.reason}")
    if found is not None and found.saved_as is not None:
        console.talk(f"wrote {found.saved_as}: play it with 'simulate --replay'")
    if report.verdict == "undecided":
        return ExitCode.UNDECIDED
    return ExitCode.REFUTED if found is not None else exit_code(report.outcome, options["expect"])
