"""``robustness joint``: is a time-varying network jointly (R,S)-robust, and over how few steps?"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted, robust

from .exit_codes import ExitCode
from .interruption import Overrun
from .named import FILE, FILE_NAME
from .options import ReadingCommand, complete_files, load_sequence, reading_options
from .output import Console, ProgressLine, set_text
from .query import Query, query_options

if TYPE_CHECKING:
    from certificates.graph import Label
    from robustness.time_varying import JointResult, TimeVaryingGraph, Violation

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/joint/1"

_TIME_IS_UP = "the time limit was reached"


@dataclass(frozen=True, slots=True)
class Report:
    """What the command found: the decision, what is known of the curve if asked for, what to draw."""

    sequence: TimeVaryingGraph
    result: JointResult
    curve: Mapping[int, int | None] | None
    shown: JointResult
    certificate: bytes | None = None

    def document(self) -> dict[str, Any]:
        """Return the content of the schema ``robustness/joint/1``."""
        sequence, result = self.sequence, self.result
        return {
            "sequence": {
                "nodes": sequence.n,
                "steps": len(sequence),
                "period": sequence.period,
                "arcs": len(sequence.arc_codes),
                "directed": sequence.directed,
                "read_as": sequence.read_as or None,
            },
            "verdict": result.verdict.value,
            "r": result.r,
            "s": result.s,
            "asked_window": result.asked_window,
            "window": result.window,
            "at_least": result.at_least,
            "tau": result.tau,
            "within_tau": result.within_tau,
            "violation": _violation_document(result.violation),
            "shorter_fails": _violation_document(result.shorter_fails),
            "windows": {
                "length": result.examined,
                "decided": len(result.window_unions),
                "unions": len(result.unions),
                "failing": list(result.failing_starts()),
            },
            "curve": None if self.curve is None else {str(r): window for r, window in self.curve.items()},
            "reason": result.reason,
            "stats": dict(result.stats),
            "seconds": round(result.seconds, 6),
        }


@click.command("joint", cls=ReadingCommand, short_help="Decide whether a time-varying network is jointly (R,S)-robust.")
@click.argument("source", metavar="SEQ", shell_complete=complete_files)
@reading_options
@click.option("-r", type=click.IntRange(min=0), metavar="R", required=True, help="Jointly (R,S)-robust?")
@click.option(
    "-s", type=click.IntRange(min=1), metavar="S", default=1, show_default=True, help="See -r; 1 is r-robustness."
)
@click.option("--window", type=click.IntRange(min=1), metavar="L", help="Over every L steps; else find the smallest L.")
@click.option("--tau", type=click.IntRange(min=0), metavar="T", help="A delay bound: say whether L <= T as well.")
@click.option("--period", type=click.IntRange(min=1), metavar="P", help="The last P steps of SEQ repeat for ever.")
@click.option("--step", metavar="TIME", help="Length of a bin of a contact trace; 1 unless given.")
@click.option("--both-ways", is_flag=True, help="A contact of a contact trace is both arcs.")
@click.option("--all-windows", is_flag=True, help="With --window: decide every window, also after one that fails.")
@click.option("--curve", "with_curve", is_flag=True, help="For every r the smallest L as well.")
@click.option(
    "--plot",
    "picture",
    type=FILE_NAME,
    metavar="FILE",
    help="Draw windows and curve: .svg, .png or .pdf.",
)
@click.option(
    "-o",
    "--certificate",
    type=FILE,
    metavar="FILE",
    help="Where a certificate goes.",
)
@click.option("--canonical", type=FILE, metavar="FILE", help="Where the canonical SEQ goes.")
@query_options(algorithm=True)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    r: int,
    s: int,
    window: int | None,
    tau: int | None,
    period: int | None,
    step: str | None,
    both_ways: bool,
    all_windows: bool,
    with_curve: bool,
    picture: str | None,
    certificate: Path | None,
    canonical: Path | None,
) -> None:
    """Decide whether a time-varying network is jointly (R,S)-robust.

    That is: over some L, the union of the graphs of every L consecutive steps is (R,S)-robust. Without --window
    the smallest L is found; with it, the first window that fails is shown with its violating pair.

    \b
    SEQ is a directory       one topology file a step, in the order of the names
           .json or -        {"nodes": [...], "period": P or null,
                              "steps": [[[u, v], ...], ...]},
                             or a list of node-link documents
           .jsonl            a step a line
           .csv, .txt, ...   contacts time,source,target, put into bins of --step

    A finite SEQ says nothing about what comes after it: its windows do not wrap. With a period they do.
    'python -m certificates verify-joint' verifies what --canonical and --certificate write, with nothing but Python.
    Exit code 0 yes, 10 no, 30 undecided, or no certificate in time.
    """
    from robustness.errors import Undecided
    from robustness.files.writing import require_different_files

    if all_windows and window is None:
        raise click.UsageError("--all-windows decides every window of one length: give --window as well.")
    require_different_files([source], [picture, certificate, canonical])
    if picture is not None:
        from robustness.figures.saving import picture_format

        picture_format(picture)  # before the work that it might be lost for
    sequence = load_sequence(source, period=period, step=step, both_ways=both_ways)
    with ProgressLine(console) as line:
        survey = Survey(sequence, r, s, tau, Clock(query.timeout), query, line)
        is_interrupted = False
        drawn = picture is not None
        try:
            report = query.wait_for(
                lambda: survey.report(
                    window, all_windows or drawn, with_curve or drawn, drawn, certified=certificate is not None
                ),
                line,
            )
        except (Overrun, KeyboardInterrupt) as stop:
            is_interrupted = isinstance(stop, KeyboardInterrupt)
            report = survey.stopped(window, "interrupted" if is_interrupted else _TIME_IS_UP)
    written = _write(report, certificate, canonical)
    if query.as_json:
        asked = {} if certificate is canonical is None else {"files": written}
        console.document(SCHEMA, report.document() | asked)
    else:
        why = "interrupted" if is_interrupted else _TIME_IS_UP
        no_curve = why if with_curve or picture is not None else ""
        lines = _lines(report, source, no_curve=no_curve, whole=console.is_verbose)
        console.answer(lines)
    if picture is not None:
        from robustness.figures.joint import draw_joint

        draw_joint(sequence, report.result, report.curve, picture, shown=report.shown)
        console.talk(f"wrote {picture}")
    for path in written.values():
        console.talk(f"wrote {path}")
    if is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
        ctx.exit(ExitCode.INTERRUPTED)
    if certificate is not None and report.certificate is None:
        raise Undecided("no certificate: the time limit was reached: raise --timeout")
    ctx.exit(ExitCode.of_verdict(report.result.verdict.value))


class Clock:
    """How much of the time limit is left for the next part of the command."""

    def __init__(self, timeout: float | None) -> None:
        self._started = time.monotonic()
        self._deadline = None if timeout is None else self._started + timeout

    def spent(self) -> float:
        """Return the seconds since the command began to search."""
        return time.monotonic() - self._started

    def left(self) -> float | None:
        """Return the seconds left: when there are none a moment, in which nothing is searched."""
        return None if self._deadline is None else max(1e-9, self._deadline - time.monotonic())


@dataclass(frozen=True, slots=True)
class Survey:
    """The questions that the command asks about one sequence, under one time limit."""

    sequence: TimeVaryingGraph
    r: int
    s: int
    tau: int | None
    clock: Clock
    query: Query
    line: ProgressLine
    finished: list[JointResult] = field(default_factory=list)
    known: list[JointResult] = field(default_factory=list)
    curves: list[Mapping[int, int | None]] = field(default_factory=list)

    def report(
        self, window: int | None, all_windows: bool, with_curve: bool, drawn: bool, *, certified: bool = False
    ) -> Report:
        """Answer the question of the command line, and what goes with it."""
        result = shown = self._decide(window, all_windows)
        self.finished.append(result)
        failing = result.violation or result.shorter_fails
        if drawn and window is None and failing is not None:
            # At the smallest length nothing fails: the length below it makes the picture, or one that no length mends.
            shown = self._decide(failing.length, all_windows=True)
        report = Report(self.sequence, result, self._curve() if with_curve else None, shown)
        return replace(report, certificate=self._certificate(result)) if certified else report

    def stopped(self, window: int | None, reason: str) -> Report:
        """Return the answer where it was finished, and else what was proven by then."""
        from robustness.results import Verdict
        from robustness.time_varying import JointResult

        if self.finished:
            return Report(self.sequence, self.finished[0], self._known_curve(), self.finished[0])
        result = JointResult(Verdict.UNDECIDED, self.r, self.s, asked_window=window, tau=self.tau, reason=reason)
        if self.known:
            result = self.known[-1]
            result = replace(result, reason=reason) if result.verdict is Verdict.UNDECIDED else result
        return Report(self.sequence, replace(result, seconds=self.clock.spent()), None, result)

    def _decide(self, window: int | None, all_windows: bool) -> JointResult:
        from robustness.time_varying import check_joint_robustness

        return check_joint_robustness(
            self.sequence,
            self.r,
            self.s,
            window=window,
            tau=self.tau,
            all_windows=all_windows,
            algorithm=self.query.algorithm,
            on_result=self.known.append,
            **self._effort(),
        )

    def _curve(self) -> Mapping[int, int | None] | None:
        """Return the smallest window for every r, or up to the r at which the limit stopped it."""
        from robustness.errors import Undecided
        from robustness.time_varying import joint_curve

        try:
            effort = self._effort() | {"on_curve": self.curves.append}
            return joint_curve(self.sequence, self.s, algorithm=self.query.algorithm, **effort)
        except Undecided:
            return self._known_curve()

    def _known_curve(self) -> Mapping[int, int | None] | None:
        return self.curves[-1] if self.curves else None

    def _certificate(self, result: JointResult) -> bytes | None:
        from robustness.time_varying.certification import joint_certificate

        return joint_certificate(self.sequence, result, **self._effort())

    def _effort(self) -> dict[str, Any]:
        return self.query.within(self.clock.left()).effort(self.line)


def _write(report: Report, certificate: Path | None, canonical: Path | None) -> dict[str, str]:
    """Write the files asked for, as far as there is something to write; return their names."""
    from robustness.files import replace_file, write_certificate
    from robustness.time_varying.certification import canonical_sequence

    written: dict[str, str] = {}
    if canonical is not None:
        replace_file(canonical, canonical_sequence(report.sequence))
        written["canonical"] = str(canonical)
    if certificate is not None and report.certificate is not None:
        write_certificate(certificate, report.certificate)
        written["certificate"] = str(certificate)
    return written


def _violation_document(found: Violation | None) -> dict[str, Any] | None:
    if found is None:
        return None
    pair = found.witness
    witness = None if pair is None else pair.as_dict()
    return {"start": found.start, "length": found.length, "witness": witness}


def _lines(report: Report, source: str, *, no_curve: str, whole: bool) -> Iterator[str]:
    from robustness.definitions import largest_conceivable_r

    sequence, result = report.sequence, report.result
    yield _headline(result)
    if result.violation is not None:
        yield from _violation_lines("violating window", result.violation, sequence.labels, whole)
    if result.shorter_fails is not None:
        yield from _violation_lines("one step shorter fails", result.shorter_fails, sequence.labels, whole)
    if result.within_tau is not None:
        yield f"tau        {_tau_text(result)}"
    yield f"sequence   {source}: {counted(sequence.n, 'node')}, {_steps_text(sequence)}"
    if result.stats:
        rules = ", ".join(f"{n} {rule}" for rule, n in result.stats.items() if rule not in ("windows", "searches"))
        searches = counted(result.stats["searches"], "search", "searches")
        yield f"windows    {result.stats['windows']} settled by {rules or 'none'}; {searches}"
    if report.curve is not None:
        yield from _curve_table(report.curve)
    if no_curve and len(report.curve or ()) < largest_conceivable_r(sequence.n):
        yield f"curve      not known{f' from r = {max(report.curve) + 1} on' if report.curve else ''}: {no_curve}"
    yield f"time       {result.seconds:.3f} s"


def _headline(result: JointResult) -> str:
    name = f"jointly {robust(result.r, result.s)}"
    why = f": {result.reason}" if result.reason else ""
    match result.verdict.value:
        case "robust":
            verdict = click.style("robust:", fg="green", bold=True)
            smallest = "; no smaller number will do" if result.shorter_fails is not None else ""
            return f"{verdict} the network is {name} over every {_steps(result.window)}{smallest}"
        case "not-robust":
            verdict = click.style("not robust:", fg="red", bold=True)
            over = f" over every {_steps(result.asked_window)}" if result.asked_window else ""
            return f"{verdict} the network is not {name}{over}{why}"
        case _:
            verdict = click.style("undecided:", fg="yellow", bold=True)
            known = f"; fewer than {counted(result.at_least, 'step')} will not do" if result.at_least > 1 else ""
            return f"{verdict} whether the network is {name} is not known ({result.reason}){known}"


def _violation_lines(title: str, found: Violation, nodes: Sequence[Label], whole: bool) -> Iterator[str]:
    last = found.start + found.length - 1
    yield f"{title}: " + (f"step {last}" if found.length == 1 else f"steps {found.start} to {last}")
    if found.witness is not None:
        yield f"  S1 = {set_text(found.witness.S1, nodes, whole=whole)}"
        yield f"  S2 = {set_text(found.witness.S2, nodes, whole=whole)}"


def _tau_text(result: JointResult) -> str:
    if result.within_tau:
        return f"{result.window} <= {result.tau}: the window is within the delay bound"
    if result.window is None:
        return "no window, so none within the delay bound"
    return f"{result.window} > {result.tau}: the window is longer than the delay bound"


def _steps_text(sequence: TimeVaryingGraph) -> str:
    if sequence.period is None:
        return f"a finite trace of {counted(len(sequence), 'step')}: its windows do not wrap"
    before = f"{counted(sequence.prefix, 'step')}, then " if sequence.prefix else ""
    return f"{before}a period of {counted(sequence.period, 'step')}: its windows wrap"


def _steps(window: int | None) -> str:
    return "step" if window == 1 else counted(window or 0, "step")


def _curve_table(curve: Mapping[int, int | None]) -> Iterator[str]:
    cells = [(str(r), "none" if window is None else str(window)) for r, window in curve.items()]
    width = max((len(cell) for pair in cells for cell in pair), default=1)
    for name, row in zip(("r", "smallest L"), zip(*cells, strict=True), strict=False):
        yield f"{name:<11}" + " ".join(f"{cell:>{width}}" for cell in row)
