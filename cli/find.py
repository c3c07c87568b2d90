"""``robustness find``: search for a graph with given properties, or prove that none exists."""

from __future__ import annotations

import json
import re
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import counted

from .build import encode_with_attributes, write_graph
from .exit_codes import ExitCode
from .interruption import Overrun
from .named import FILE_NAME
from .output import Console, ProgressLine, graph_document
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.graph_search import FindResult

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/find/1"


class NodeNumbers(click.ParamType):  # type: ignore[type-arg]  # generic only from click 8.4 on
    """A number of nodes, or a range of them: ``5`` or ``2..7``."""

    name = "nodes"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> range:
        """Return the numbers of nodes that ``value`` spells."""
        match = re.fullmatch(r"(\d{1,4})(?:\.\.(\d{1,4}))?", str(value))
        if match is None:
            self.fail(f"{value!r} is neither a number of nodes nor a range such as 2..7.", param, ctx)
        low, high = int(match[1]), int(match[2] or match[1])
        if high < low:
            self.fail(f"{value!r} is an empty range.", param, ctx)
        return range(low, high + 1)


@click.command("find", short_help="Search for a graph that has or has not given properties.")
@click.option(
    "-n",
    "--nodes",
    type=NodeNumbers(),
    required=True,
    metavar="N|N..N",
    help="The number of nodes; of several, the least.",
)
@click.option("--satisfies", "-p", multiple=True, metavar="PROPERTY", help="A property it has; repeat for more.")
@click.option("--violates", "-x", multiple=True, metavar="PROPERTY", help="A property it has not; repeat for more.")
@click.option("--directed", is_flag=True, help="Search among digraphs.")
@click.option("--fewest-edges", is_flag=True, help="Look for a graph with the fewest edges.")
@click.option("-o", "--output", type=FILE_NAME, metavar="FILE", help="Write the graph there.")
@query_options(cluster=True, state=False)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    nodes: range,
    satisfies: tuple[str, ...],
    violates: tuple[str, ...],
    directed: bool,
    fewest_edges: bool,
    output: str | None,
) -> None:
    """Search for a graph that has, or has not, given properties.

    \b
    PROPERTY is 2-robust  (2,2)-robust  3-connected  4-regular  trap(1)
                min-degree>=3  max-degree<=4  edges<=12  edges>=8  edges=9

    Up to 7 nodes (digraphs: 5) all graphs are tried; beyond, a constraint solver proposes graphs and learns from
    what breaks them. Exit code 0 found (the graph goes to standard output or FILE), 10 none exists, 30 undecided.
    """
    from robustness.files.front import require_written_format
    from robustness.files.writing import require_different_files
    from robustness.graph_search import FindResult, FindVerdict, find_graph

    require_different_files([], [output])
    if output is not None:
        require_written_format(output)
    started, latest = time.monotonic(), [FindResult(FindVerdict.UNDECIDED)]
    with ProgressLine(console) as line:

        def work() -> FindResult:
            return find_graph(
                nodes,
                satisfies,
                violates,
                directed=directed,
                minimise="edges" if fewest_edges else None,
                on_result=latest.append,
                **query.effort(line),
            )

        is_interrupted = False
        try:
            result = query.wait_for(work, line)
        except (Overrun, KeyboardInterrupt) as stop:
            is_interrupted = isinstance(stop, KeyboardInterrupt)
            reason = "interrupted" if is_interrupted else "the time limit was reached"
            known = latest[-1]
            stats = {**known.stats, "reason": f"{reason} ({line.note})" if line.note else reason}
            result = replace(known, stats=stats, seconds=time.monotonic() - started)
    if output is not None and result.graph is not None:
        write_graph(result.graph, output)
    if query.as_json:
        console.document(SCHEMA, _document(result))
    else:
        _print(console, result, nodes, output)
    if output is not None:
        console.talk(f"not written: {output}, as no graph was found" if result.graph is None else f"wrote {output}")
    codes = {
        FindVerdict.FOUND: ExitCode.DONE,
        FindVerdict.IMPOSSIBLE: ExitCode.REFUTED,
        FindVerdict.UNDECIDED: ExitCode.UNDECIDED,
    }
    if is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
        ctx.exit(ExitCode.INTERRUPTED)
    ctx.exit(codes[result.verdict])


def _document(result: FindResult) -> dict[str, Any]:
    from robustness.digraph import as_digraph

    graph = result.graph
    return {
        "verdict": result.verdict.value,
        "n": result.n,
        "edges": result.edges,
        "has_fewest_edges": result.has_fewest_edges,
        "edges_at_least": result.edges_at_least,
        "impossible_for": list(result.impossible_for),
        "graph": None if graph is None else graph_document(as_digraph(graph)),
        "trap": None if graph is None else graph.graph.get("trap"),
        "topology": None if graph is None else json.loads(encode_with_attributes(graph)),
        "method": result.method,
        "stats": dict(result.stats),
        "seconds": round(result.seconds, 6),
    }


def _print(console: Console, result: FindResult, nodes: range, output: str | None) -> None:
    """Print the graph, if any, on standard output and the verdict beside it; a verdict alone is the result."""
    text = _verdict_text(result, nodes)
    if result.graph is None or output is not None:
        console.result(text)
    else:
        console.content(encode_with_attributes(result.graph).decode("ascii").rstrip("\n"))
        console.talk(text)


def _verdict_text(result: FindResult, nodes: range) -> str:
    from robustness.graph_search import FindVerdict

    smaller = f"; none on {_numbers(result.impossible_for)}" if result.impossible_for else ""
    fewest = ", no graph with fewer fits" if result.has_fewest_edges else ""
    match result.verdict:
        case FindVerdict.FOUND:
            return f"found: {counted(result.n or 0, 'node')}, {counted(result.edges or 0, 'edge')}{fewest}{smaller}"
        case FindVerdict.IMPOSSIBLE:
            return f"impossible: no graph on {_numbers(nodes)} fits"
        case _:
            reason = result.stats.get("reason", "a limit was reached")
            if result.graph is not None:
                edges = counted(result.edges or 0, "edge")
                fewer = f"one with {result.edges_at_least}" if result.edges_at_least else "one with fewer"
                known = f"a graph with {edges} fits, whether {fewer} does is open"
                return f"undecided: on {counted(result.n or 0, 'node')} {known} ({reason}){smaller}"
            if result.edges_at_least:
                needed = f"on {counted(result.n or 0, 'node')} at least {counted(result.edges_at_least, 'edge')} needed"
                return f"undecided: {reason}; {needed}{smaller}"
            return f"undecided: {reason}{smaller}"


def _numbers(sizes: range | tuple[int, ...]) -> str:
    return counted(sizes[0], "node") if len(sizes) == 1 else f"{sizes[0]}..{sizes[-1]} nodes"
