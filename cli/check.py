"""``robustness check``: decide one (r,s), or determine r*, s and the profile."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted, robust

from .exit_codes import ExitCode
from .interruption import Overrun
from .options import ReadingCommand, Seconds, graph_argument, load_graph
from .output import Console, ProgressLine, graph_document, set_document, set_text
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.digraph import Digraph
    from robustness.results import Bounds, RobustnessResult, Witness

__all__ = ["PROFILE_NODES", "SCHEMA", "command"]

SCHEMA = "robustness/check/1"

#: Up to this many nodes the whole profile is shown: a tenth of a second by the subset-minimum transform, O(n 2^n).
PROFILE_NODES = 22


@dataclass(slots=True)
class Report:
    """What is known when the command ends, by itself, by a limit or by Ctrl-C."""

    graph: Digraph
    verdict: str
    r: int
    s: int
    bounds: Bounds
    s_bounds: Bounds | None = None
    witness: Witness | None = None
    profile: Mapping[int, int] | None = None
    algorithm: str = ""
    reason: str = ""
    estimate: Mapping[str, Any] | None = None
    trusted: str = ""
    seconds: float = 0.0
    is_decision: bool = False
    is_interrupted: bool = False

    def _bounds(self) -> dict[str, Any]:
        """Return what is proven about r*, and about the greatest s for it where that was asked."""
        content = self.bounds.as_dict()
        if self.s_bounds is not None:
            content |= {"s_lower": self.s_bounds.lower.value, "s_upper": self.s_bounds.upper.value}
        return content

    def document(self) -> dict[str, Any]:
        """Return the content of the schema ``robustness/check/1``."""
        pair = self.witness
        return {
            "graph": graph_document(self.graph),
            "verdict": self.verdict,
            "r": self.r,
            "s": self.s,
            "profile": None if self.profile is None else {str(r): s for r, s in self.profile.items()},
            "bounds": self._bounds(),
            "witness": None if pair is None else {"S1": set_document(pair.S1), "S2": set_document(pair.S2)},
            "algorithm": self.algorithm,
            **({} if self.estimate is None else {"estimate": dict(self.estimate)}),
            **({"trusted": self.trusted} if self.trusted else {}),
            "seconds": round(self.seconds, 6),
        }


@click.command("check", cls=ReadingCommand, short_help="Decide robustness exactly with evidence.")
@graph_argument
@click.option("-r", type=click.IntRange(min=0), metavar="R", help="Decide whether GRAPH is (R,S)-robust.")
@click.option("-s", type=click.IntRange(min=1), metavar="S", help="With -r; 1 unless given, which is r-robustness.")
@click.option(
    "--s-timeout",
    type=Seconds(),
    metavar="SECONDS",
    help="Without -r: stop looking for the greatest s after this time, once r* is known.",
)
@query_options(algorithm=True, cluster=True)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    r: int | None,
    s: int | None,
    s_timeout: float | None,
) -> None:
    """Decide robustness exactly, with evidence.

    With -r: is GRAPH (R,S)-robust? Exit code 0 yes, 10 no (with a violating pair), 30 undecided. Without -r: the
    greatest r, the greatest s for it, and on small graphs the whole profile r -> greatest s.
    """
    if s is not None and r is None:
        raise click.UsageError("-s says how many nodes go with -r: give -r as well.")
    if s_timeout is not None and r is not None:
        raise click.UsageError("--s-timeout is for the search for the greatest s: leave out -r.")
    graph = load_graph(source)
    with ProgressLine(console) as line:
        if r is None:
            report = _determine(graph, s_timeout, query, line)
        else:
            report = _decide(graph, r, 1 if s is None else s, query, line)
    if query.as_json:
        console.document(SCHEMA, report.document())
    else:
        console.answer(_lines(report, source, whole=console.is_verbose))
    if report.is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
        ctx.exit(ExitCode.INTERRUPTED)
    ctx.exit(ExitCode.of_verdict(report.verdict))


def _decide(graph: Digraph, r: int, s: int, query: Query, line: ProgressLine) -> Report:
    from robustness.decision.front import check_rs_robustness

    started = time.perf_counter()

    def work() -> RobustnessResult:
        return check_rs_robustness(graph, r, s, algorithm=query.algorithm, **query.effort(line))

    try:
        report = _report_on(graph, query.wait_for(work, line))
    except (KeyboardInterrupt, Overrun) as stop:
        report = _stopped(graph, r, s, query, line, stop)
    report.is_decision, report.seconds = True, time.perf_counter() - started
    return report


def _determine(graph: Digraph, s_timeout: float | None, query: Query, line: ProgressLine) -> Report:
    from robustness.decision.front import determine_robustness

    started = time.perf_counter()

    def work() -> RobustnessResult:
        return determine_robustness(
            graph,
            algorithm=query.algorithm,
            s_time_limit=s_timeout,
            on_bounds=line.note_bounds,
            **query.effort(line),
        )

    try:
        report = _report_on(graph, query.wait_for(work, line))
    except (KeyboardInterrupt, Overrun) as stop:
        report = _stopped(graph, 0, 1, query, line, stop)
        report.r = report.bounds.lower.value
    else:
        if report.verdict == "determined" and report.profile is None and graph.n <= PROFILE_NODES:
            left = None if query.timeout is None else query.timeout - (time.perf_counter() - started)
            if left is None or left > 0:
                _add_profile(report, query.within(left), line)
    report.seconds = time.perf_counter() - started
    return report


def _add_profile(report: Report, query: Query, line: ProgressLine) -> None:
    from robustness.decision.front import robustness_profile
    from robustness.errors import InternalError, Undecided
    from robustness.results import Bound, Bounds

    def work() -> Mapping[int, int]:
        here = replace(query, executor=None, state=None)
        return robustness_profile(report.graph, algorithm=query.algorithm, **here.effort(line))

    try:
        profile = query.wait_for(work, line)
    except (Undecided, Overrun):
        return
    except KeyboardInterrupt:
        report.is_interrupted = True
        return
    low, high = report.s, report.s if report.s_bounds is None else report.s_bounds.upper.value
    if not low <= profile.get(report.r, low) <= high or profile.get(report.r + 1, 0):
        raise InternalError(
            f"the profile {dict(profile)} contradicts r* = {report.r}, s in {low}..{high}: please report"
        )
    report.profile = profile
    if report.r:
        exact = Bound(profile[report.r], "the profile")
        report.s, report.s_bounds = exact.value, Bounds(exact, exact)


def _report_on(graph: Digraph, result: RobustnessResult) -> Report:
    return Report(
        graph,
        result.verdict.value,
        result.r,
        result.s,
        result.bounds or _quick_bounds(graph),
        result.s_bounds,
        result.witness,
        result.profile,
        result.algorithm,
        reason=str(result.stats.get("reason", "")),
        estimate=result.stats.get("estimate"),
        trusted=str(result.stats.get("trusted", "")),
    )


def _stopped(graph: Digraph, r: int, s: int, query: Query, line: ProgressLine, stop: BaseException) -> Report:
    """Return what is proven when the search itself cannot tell any more."""
    is_interrupted = isinstance(stop, KeyboardInterrupt)
    bounds = line.bounds or _quick_bounds(graph)
    return Report(
        graph,
        "undecided",
        r,
        s,
        bounds,
        witness=bounds.upper.witness,
        algorithm=query.algorithm,
        reason="interrupted" if is_interrupted else "the time limit was reached",
        is_interrupted=is_interrupted,
    )


def _quick_bounds(graph: Digraph) -> Bounds:
    from robustness.decision.bounds import quick_bounds

    return quick_bounds(graph)


def _lines(report: Report, source: str, *, whole: bool) -> Iterator[str]:
    graph, bounds = report.graph, report.bounds
    yield _headline(report)
    if report.witness is not None:
        yield _witness_heading(report)
        yield f"  S1 = {set_text(report.witness.S1, graph.labels, whole=whole)}"
        yield f"  S2 = {set_text(report.witness.S2, graph.labels, whole=whole)}"
    kind = "directed" if graph.directed else "undirected"
    yield f"graph      {source}: {counted(graph.n, 'node')}, {counted(graph.arc_count, 'arc')}, {kind}"
    yield f"r* >= {bounds.lower.value:<4} {bounds.lower.reason}"
    yield f"r* <= {bounds.upper.value:<4} {bounds.upper.reason}"
    if report.s_bounds is not None and report.s_bounds.lower.value < report.s_bounds.upper.value:
        low, high = report.s_bounds.lower, report.s_bounds.upper
        yield f"s  >= {low.value:<4} for r = {report.r}: {low.reason}"
        yield f"s  <= {high.value:<4} for r = {report.r}: {high.reason}"
    if report.profile:
        yield from _profile_table(report.profile)
    yield f"algorithm  {report.algorithm}"
    if report.trusted:
        yield f"trusted    {report.trusted}"
    if report.estimate is not None:
        yield f"left       {report.estimate['in_words']}"
    yield f"time       {report.seconds:.3f} s"


def _headline(report: Report) -> str:
    r, s = report.r, report.s
    name = robust(r, s)
    match report.verdict:
        case "robust":
            return f"{click.style('robust:', fg='green', bold=True)} the network is {name}"
        case "not-robust":
            return f"{click.style('not robust:', fg='red', bold=True)} the network is not {name}"
        case "determined":
            verdict = click.style("determined:", fg="green", bold=True)
            known, greatest = f"r* = {r}", f"for r = {r} the greatest s is {s}"
            if report.s_bounds is not None and report.s_bounds.upper.value > s:
                known = f"r* = {r}; s in {s}..{report.s_bounds.upper.value}"
                greatest = f"the greatest s for r = {r} is not known exactly"
            return f"{verdict} {known}: the network is {r}-robust, not {r + 1}-robust; {greatest}"
        case _:
            what = f"whether the network is {name}" if report.is_decision else "the greatest r"
            why = f" ({report.reason})" if report.reason else ""
            verdict = click.style("undecided:", fg="yellow", bold=True)
            return f"{verdict} {what} is not known{why}; only the bounds are proven"


def _witness_heading(report: Report) -> str:
    if report.is_decision:
        r, s = report.r, report.s
    else:
        r, s = report.bounds.upper.value + 1, 1
    if s == 1:
        return f"no node of either set has {r} or more in-neighbours outside its own set:"
    few = f"fewer than {counted(r, 'in-neighbour')} outside its own set"
    return f"in each set some node has {few}, and of all nodes of both fewer than {s} have {r} or more:"


def _profile_table(profile: Mapping[int, int]) -> Iterator[str]:
    width = max(len(str(value)) for pair in profile.items() for value in pair)
    for name, row in (("r", profile.keys()), ("greatest s", profile.values())):
        yield f"{name:<11}" + " ".join(f"{value:>{width}}" for value in row)
