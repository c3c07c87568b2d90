"""``robustness thin``: which links can go while a network stays as robust as it has to be."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .mending import answer, goal_options, goals_from, links_in, tell
from .options import graph_argument, load_graph
from .output import Console
from .query import Query, query_options

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/thin/1"

_FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("thin")
@graph_argument
@goal_options
@click.option("--keep", type=_FILE, metavar="FILE", help="A network whose links may not go.")
@click.option("-o", "--output", type=_FILE, metavar="FILE", help="Write the thinned network.")
@click.option("--certificate", type=_FILE, metavar="FILE", help="Write a certificate that it still reaches the goal.")
@click.option("--plot", "picture", type=_FILE, metavar="FILE", help="Draw what stays: .svg, .png or .pdf.")
@query_options()
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    r: int | None,
    s: int | None,
    survive: int | None,
    model: str | None,
    keep: Path | None,
    output: Path | None,
    certificate: Path | None,
    picture: Path | None,
) -> None:
    """How many links of GRAPH can go while it keeps what is asked of it?

    The goal is -r R [-s S], or --survive F [--model M], or both. Exit code 0: so many, and no more. 30: so many at
    least. 10: the network does not reach the goal as it is.
    """
    from robustness.files.writing import require_different_files
    from robustness.mending import MendResult, thin

    goals = goals_from(r, s, survive, model)
    require_different_files([source, keep], [output, certificate, picture])
    graph = load_graph(source)
    kept = links_in(keep, graph) or []

    def work(line: Any, improved: Any) -> MendResult:
        return thin(graph, goals, keep=kept, on_improvement=improved, **query.effort(line))

    found, is_interrupted = answer(console, query, work)
    tell(
        ctx, console, query, SCHEMA, found,
        is_interrupted=is_interrupted, output=output, certificate=certificate, picture=picture,
    )  # fmt: skip
