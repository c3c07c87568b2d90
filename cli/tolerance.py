"""``robustness tolerance``: what f a network survives under each threat model, with evidence or an attack."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted, plural

from .choices import THREAT_MODEL_NAMES
from .exit_codes import ExitCode
from .interruption import Overrun
from .named import FOLDER
from .options import ReadingCommand, Seconds, graph_argument, load_graph, load_sequence
from .output import Console, ProgressLine, graph_document, set_text, wrapped
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.digraph import Digraph
    from robustness.threat_models import ToleranceResult, ToleranceTable
    from robustness.time_varying import TimeVaryingGraph

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/tolerance/1"

#: Up to this many nodes lemmas are asked, in milliseconds, about the models that a limit or Ctrl-C left unfinished.
_LEMMAS_NODES = 256

#: A time limit that is over at once: what is known without a search.
_MOMENT = 1e-9


@dataclass(frozen=True, slots=True)
class Report:
    """What the command found."""

    graph: Digraph
    table: ToleranceTable
    confirmed: dict[str, bool | None]
    required: int | None
    seconds: float
    is_interrupted: bool = False

    def verdict(self) -> str | None:
        """Return what is known about the required f in the worst of the models, or None when none was required."""
        if self.required is None:
            return None
        standings = {result.standing_of(self.required).value for result in self.table.results}
        return next(each for each in ("refuted", "undecided", "open", "guaranteed") if each in standings)

    def models_at(self, verdict: str | None) -> list[str]:
        """Return the models to whose required f a verdict applies."""
        return [each.model for each in self.table.results if each.standing_of(self.required or 0).value == verdict]

    def exit_code(self) -> ExitCode:
        """Return 0, 10 or 30: with --require about that f, else about whether a limit left something undecided."""
        match self.verdict():
            case None:
                return ExitCode.DONE if self.table.is_decided else ExitCode.UNDECIDED
            case "guaranteed":
                return ExitCode.DONE
            case "refuted":
                return ExitCode.REFUTED
            case _:
                return ExitCode.UNDECIDED

    def document(self) -> dict[str, Any]:
        """Return the content of the schema ``robustness/tolerance/1``."""
        models = [result.as_dict() | {"confirmed": self.confirmed[result.model]} for result in self.table.results]
        return {
            "graph": graph_document(self.graph),
            "summary": self.table.summary(),
            "models": models,
            "require": None if self.required is None else self._required(),
            "seconds": round(self.seconds, 6),
        }

    def _required(self) -> dict[str, Any]:
        verdict = self.verdict()
        return {"f": self.required, "verdict": verdict, "models": self.models_at(verdict)}


@click.command("tolerance", cls=ReadingCommand, short_help="What f does GRAPH survive under each threat model?")
@graph_argument
@click.option("--model", type=click.Choice(THREAT_MODEL_NAMES), help="One threat model instead of all.")
@click.option("--require", "required", type=click.IntRange(min=0), metavar="F", help="A gate: is F survived?")
@click.option(
    "--tau",
    type=click.IntRange(min=1),
    metavar="T",
    help="GRAPH is a sequence as for 'joint'; values are used up to T steps after they were sent, also of links gone.",
)
@click.option("-T", "--sampling-period", "period_T", type=Seconds(), metavar="T", help="Of second-order vehicles.")
@click.option("--alpha", type=float, metavar="A", help="With -T: their gain; 1.5/T unless given.")
@click.option("--sigma", type=float, metavar="S", help="With -T: kept weights add up to at most S; 1 unless given.")
@click.option(
    "--delay", type=click.IntRange(min=0), metavar="B", help="Delays are at most B; with --tau T unless given."
)
@click.option("--gap", type=click.IntRange(min=1), metavar="G", help="Updates at most G steps apart; with --tau 1.")
@click.option("--period", type=click.IntRange(min=1), metavar="P", help="With --tau: the last P steps repeat for ever.")
@click.option("-o", "--output", type=FOLDER, metavar="DIR", help="Write certificates there.")
@query_options()
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    model: str | None,
    required: int | None,
    tau: int | None,
    period_T: float | None,
    alpha: float | None,
    sigma: float | None,
    delay: int | None,
    gap: int | None,
    period: int | None,
    output: Path | None,
) -> None:
    """What does GRAPH survive? For each threat model the largest f guaranteed and the smallest refuted.

    \b
    malicious   in step, at most f liars in all, who tell everybody the same
    byzantine   the same, but each neighbour may be told another lie
    delayed     delays and partly asynchronous updates, at most f liars in all
    ...-local   each of them with up to f liars around every node

    Every f is guaranteed or refuted, unless a limit came first: the conditions are exact. Every attack is carried
    out by the simulator first; -v shows theorems and evidence, -q one line. With --require F: exit code 0 when F is
    guaranteed (under every model shown), 10 when an attack refutes it, 30 when neither is known: "undecided" when a
    limit came first, "open" when theory does not decide it from what is given, such as a trace that ends. Without: 0,
    or 30 when something is undecided or open.

    With -T and --alpha, --sigma, --delay or --gap one line says whether the theorems apply to these vehicles and, if
    not, what would make them apply; --require then counts only what applies.

    With -o, DIR/graph.json is the canonical graph, DIR/MODEL-guaranteed-F.cert and DIR/MODEL-refuted-F.cert are
    certificates, and DIR/MODEL-attack.json is what 'simulate --attack' reads. With --tau, guaranteed
    certificates are about DIR/sequence.json, all else is about the union of the steps, DIR/graph.json.
    """
    if tau is None and period is not None:
        raise click.UsageError("--period belongs to a sequence: give --tau as well.")
    if tau is not None and delay == 0:
        raise click.UsageError("over time delays are at least 1: give --delay 1 or more.")
    vehicles = {"T": period_T, "alpha": alpha, "sigma": sigma, "delay": delay, "gap": gap}
    if tau is not None and model not in (None, "delayed", "delayed-local"):
        raise click.UsageError(f"theory says nothing about {model} over time: with --tau, delayed or delayed-local.")
    if output is not None:
        from robustness.files.writing import require_different_files

        require_different_files([source], [output / "graph.json", output / "sequence.json"], makes_folders=True)
    network, graph = _load(source, tau, period)
    _prepare()
    started = time.perf_counter()
    with ProgressLine(console) as line:
        finished: list[ToleranceResult] = []

        def work() -> Report:
            return _examine(network, graph, model, tau, vehicles, required, query, line, finished.append)

        is_interrupted = False
        try:
            report = query.wait_for(work, line)
        except (Overrun, KeyboardInterrupt) as stop:
            is_interrupted = isinstance(stop, KeyboardInterrupt)
            why = "interrupted" if is_interrupted else "the time limit was reached"
            table = _stopped(network, graph, model, (tau, delay, gap), finished, why)
            report = Report(graph, table, dict.fromkeys(table), required, time.perf_counter() - started, is_interrupted)
    if query.as_json:
        console.document(SCHEMA, report.document())
    else:
        console.answer(_lines(report, source, console))
    if output is not None:
        _write_evidence(console, report, output, query)
    if is_interrupted:
        console.error(
            f"interrupted: {counted(len(finished), 'model was', 'models were')} finished; what is printed "
            "holds, nothing else is claimed"
        )
        ctx.exit(ExitCode.INTERRUPTED)
    ctx.exit(report.exit_code())


def _load(source: str, tau: int | None, period: int | None) -> tuple[Digraph | TimeVaryingGraph, Digraph]:
    """Return the network, and the graph to show: of a sequence the union of its steps."""
    if tau is None:
        graph = load_graph(source)
        return graph, graph
    sequence = load_sequence(source, period=period)
    return sequence, sequence.union(0, len(sequence))


def _examine(
    network: Digraph | TimeVaryingGraph,
    graph: Digraph,
    model: str | None,
    tau: int | None,
    vehicles: Mapping[str, Any],
    required: int | None,
    query: Query,
    line: ProgressLine,
    on_result: Callable[[ToleranceResult], None],
) -> Report:
    from robustness.errors import InternalError
    from robustness.threat_models import tolerance
    from robustness.threat_models.confirmation import confirm
    from robustness.threat_models.results import ToleranceTable

    started = time.perf_counter()
    found = tolerance(network, model, tau=tau, **vehicles, on_result=on_result, **query.effort(line))
    table = found if isinstance(found, ToleranceTable) else ToleranceTable(graph, (found,))
    # Playing an attack is a second look at evidence that was checked before; past the user's limit it is left out.
    ends = math.inf if query.timeout is None else started + query.timeout
    confirmed = {result.model: confirm(result) if time.perf_counter() < ends else None for result in table.results}
    if False in confirmed.values():
        raise InternalError(f"an attack from checked evidence did not split the network ({confirmed}): please report")
    return Report(graph, table, confirmed, required, time.perf_counter() - started)


def _write_evidence(console: Console, report: Report, folder: Path, query: Query) -> None:
    """Write the canonical graph, and for each model its certificates and its attack."""
    from robustness.files import replace_file
    from robustness.threat_models import ToleranceCertificates, certify_tolerance
    from robustness.time_varying import canonical_sequence

    def write(path: Path, data: bytes, note: str = "") -> None:
        replace_file(path, data)
        console.talk(f"wrote {path}{note}")

    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "graph.json", report.graph.canonical_bytes())
    sequence = report.table.results[0].sequence
    if sequence is not None:
        write(folder / "sequence.json", canonical_sequence(sequence))
    for result in report.table.results:

        def work(result: ToleranceResult = result) -> ToleranceCertificates:
            return certify_tolerance(result, **query.effort())

        try:
            found = query.wait_for(work)
        except Overrun:
            found = ToleranceCertificates(None, None)
        claims = (("guaranteed", result.guaranteed, found.guaranteed), ("refuted", result.refuted, found.refuted))
        for what, f, data in claims:
            if data is not None:
                path = folder / f"{result.model}-{what}-{f}.cert"
                write(path, data, f" ({len(data):,} {plural(len(data), 'byte')}, verified)")
            elif f is not None and f >= 0:
                why = "too large, or a limit was reached" if report.graph.n >= 2 else "nobody can disagree"
                why = "it holds only over time, of which no certificate speaks" if what in found.over_time else why
                console.talk(f"no certificate of {result.model}, f = {f} {what}: {why}")
        if result.attack is not None:
            text = json.dumps(result.attack.as_dict(), indent=1) + "\n"
            write(folder / f"{result.model}-attack.json", text.encode())


def _prepare() -> None:
    """Import what the work needs: the user's seconds are for the network, not for reading program files."""
    import robustness.threat_models.confirmation
    import robustness.traps.searching  # noqa: F401


def _stopped(
    network: Digraph | TimeVaryingGraph,
    graph: Digraph,
    model: str | None,
    ages: tuple[int | None, int | None, int | None],
    finished: list[ToleranceResult],
    why: str,
) -> ToleranceTable:
    """Return what work that was stopped had finished; of the other models what lemmas tell, which takes no search."""
    from robustness.threat_models.models import THREAT_MODELS
    from robustness.threat_models.over_time import MODELS_OVER_TIME
    from robustness.threat_models.results import Reason, Standing, ToleranceResult, ToleranceTable
    from robustness.time_varying import TimeVaryingGraph

    tau, delay, gap = ages
    reason = Reason(Standing.UNDECIDED, 0, "nothing was decided", f"none: {why}", "none")
    sequence = network if isinstance(network, TimeVaryingGraph) else None
    names = (model,) if model is not None else THREAT_MODEL_NAMES if sequence is None else MODELS_OVER_TIME
    known = {result.model: result for result in finished}
    if sequence is None and graph.n <= _LEMMAS_NODES:
        from robustness.threat_models import tolerance

        known |= {name: tolerance(graph, name, time_limit=_MOMENT) for name in names if name not in known}
    rest = {
        name: ToleranceResult(
            graph, THREAT_MODELS[name], -1, None, (reason,), sequence=sequence, tau=tau, delay=delay, gap=gap
        )
        for name in names
    }
    return ToleranceTable(graph, tuple(known.get(name, rest[name]) for name in names))


def _lines(report: Report, source: str, console: Console) -> Iterator[str]:
    """Yield the gate, the table and a sentence for each outcome; theorems and evidence where -v asks for them."""
    from robustness.threat_models.results import sentences_of

    graph, table = report.graph, report.table
    if report.required is not None:
        yield _gate(report)
    elif console.is_quiet:
        yield _in_one_line(table)
    yield from _table(table)
    yield ""
    yield from map(wrapped, sentences_of(table))
    if console.is_verbose:
        for result in table.results:
            yield ""
            yield from _evidence(result, report.confirmed[result.model])
    kind = "directed" if graph.directed else "undirected"
    yield ""
    over = table.results[0].sequence if table.results else None
    of = "" if over is None else f" in the union of {counted(len(over), 'step')}"
    yield f"graph      {source}: {counted(graph.n, 'node')}, {counted(graph.arc_count, 'arc')}{of}, {kind}"
    if not console.is_verbose:
        yield "evidence   -v shows the theorem and the evidence for each line, -o DIR writes certificates and attacks"
    yield f"time       {report.seconds:.3f} s"


def _in_one_line(table: ToleranceTable) -> str:
    """Return the largest f guaranteed under each model, and where something is not known the smallest f refuted."""
    from robustness.threat_models.results import largest_survived, number

    told = (
        f"{result.model} {largest_survived(result)}"
        + ("" if result.is_decided else f" (refuted: {number(result.refuted)})")
        for result in table.results
    )
    return f"guaranteed f: {', '.join(told)}"


def _gate(report: Report) -> str:
    verdict = report.verdict() or ""
    color = {"guaranteed": "green", "refuted": "red"}.get(verdict, "yellow")
    named = report.models_at(verdict)
    models = "every threat model" if set(named) == set(THREAT_MODEL_NAMES) else ", ".join(named)
    what = {
        "guaranteed": "agreement is guaranteed",
        "refuted": "an attack splits the network" if report.required else "the network splits though nobody lies",
        "undecided": "it was interrupted first"
        if report.is_interrupted
        else "the time limit came first, so more time may tell",
        "open": "theory does not decide it from what is given, however long one looks",
    }[verdict]
    f = report.required or 0
    if verdict == "open" and any(each.standing(f) is not each.standing_of(f) for each in report.table.results):
        what = "what is known does not apply to these vehicles"
    return f"{click.style(verdict + ':', fg=color, bold=True)} f = {report.required} under {models}: {what}"


def _table(table: ToleranceTable) -> Iterator[str]:
    from robustness.threat_models.results import largest_survived, number

    yield f"{'model':<17}{'guaranteed':>10}{'refuted':>9}  between"
    for result in table.results:
        between = ", ".join(f"{f} {result.standing(f).value}" for f in result.between) or "-"
        if result.refuted is None and result.graph.n >= 2:
            between = "undecided"
        yield f"{result.model:<17}{largest_survived(result):>10}{number(result.refuted):>9}  {between}"


def _evidence(result: ToleranceResult, confirmed: bool | None) -> Iterator[str]:
    yield wrapped(f"{result.model}: {result.threat.setting}", hanging="  ")
    hanging = " " * 20
    for reason in result.reasons:
        yield wrapped(f"  f = {reason.f:<3} {reason.standing.value}: {reason.statement}", hanging=" " * 10)
        yield wrapped(f"theorem   {reason.theorem}", indent=" " * 10, hanging=hanging)
        yield wrapped(f"evidence  {reason.evidence}", indent=" " * 10, hanging=hanging)
        sets = result.attack_sets
        if reason.standing.value == "refuted" and sets is not None:
            for name, labels in (("M", sets.M), ("S1", sets.S1), ("S2", sets.S2)):
                yield f"          {name:<9} {set_text(labels, result.graph.labels, whole=True)}"
            if confirmed:
                yield "          simulated an exact split under every rule the attack is made for"
