"""``robustness draw``: a picture of a network, with the sets that a question about it turns up."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .exit_codes import ExitCode
from .named import FILE
from .options import ReadingCommand, graph_argument, load_graph
from .output import Console, ProgressLine, graph_document
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.digraph import Digraph
    from robustness.results import RobustnessResult

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/draw/1"


@click.command("draw", cls=ReadingCommand, short_help="Draw GRAPH with the two sets that do not listen.")
@graph_argument
@click.option(
    "-r",
    "r",
    type=click.IntRange(min=0),
    metavar="R",
    help="Decide R-robustness, and mark the two sets that refute it.",
)
@click.option("-s", "s", type=click.IntRange(min=1), metavar="S", help="With -r: (R,S)-robustness; 1 unless given.")
@click.option(
    "--attack",
    "attack_file",
    type=FILE,
    metavar="FILE",
    help="Mark the attack that 'attack -o' wrote.",
)
@click.option(
    "-o",
    "--output",
    required=True,
    type=FILE,
    metavar="FILE",
    help="The picture: .svg, .png or .pdf.",
)
@query_options(algorithm=True)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    r: int | None,
    s: int | None,
    attack_file: Path | None,
    output: Path,
) -> None:
    """Draw GRAPH: nodes where the file places them, or S1 left and S2 right; arcs that count are drawn strong.

    Without -r and --attack only the network is drawn. Exit code 0 when the picture is written; with -r 30 when a limit
    came before the decision, and then no set is marked.
    """
    from robustness.figures.network import draw_to_file
    from robustness.figures.saving import picture_format
    from robustness.files.writing import require_different_files

    if r is not None and attack_file is not None:
        raise click.UsageError("give one of -r and --attack.")
    if s is not None and r is None:
        raise click.UsageError("-s belongs to -r.")
    require_different_files([source, attack_file], [output])
    picture_format(output)  # before the work that it might be lost for
    graph = load_graph(source)
    answer: Any = None
    undecided = False
    if r is not None:
        from robustness.decision.front import check_rs_robustness
        from robustness.results import Verdict

        with ProgressLine(console) as line:

            def work() -> RobustnessResult:
                return check_rs_robustness(graph, r, s or 1, algorithm=query.algorithm, **query.effort(line))

            answer = query.wait_for(work, line)
        undecided = answer.verdict is Verdict.UNDECIDED
    elif attack_file is not None:
        answer = _attack(graph, attack_file)
    told = answer.summary() if r is not None else ""
    if told and not query.as_json:
        console.result(told)
    draw_to_file(graph, answer, output)
    if query.as_json:
        verdict = answer.verdict.value if r is not None else None
        content = {"graph": graph_document(graph), "output": str(output), "verdict": verdict, "summary": told}
        console.document(SCHEMA, content)
    console.talk(f"wrote {output}")
    ctx.exit(ExitCode.UNDECIDED if undecided else ExitCode.DONE)


def _attack(graph: Digraph, path: Path) -> Any:
    """Return the attack in a file, its evidence checked anew."""
    from robustness.errors import InvalidParameter, UnreadableTopology
    from robustness.simulation.attacks import Attack
    from robustness.whole_file import read_text

    try:
        return Attack.from_dict(graph, json.loads(read_text(path)))
    except (OSError, ValueError, RecursionError, InvalidParameter) as problem:
        raise UnreadableTopology(f"{path}: not an attack of this graph as 'attack -o' writes it: {problem}") from None
