"""``robustness thin``: which links can go while a network stays as robust as it has to be."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .answered import answer, tell
from .mending import Kept, goal_and_files, link_costs, links_in
from .named import FILE
from .options import ReadingCommand, graph_argument, load_graph
from .output import Console
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.mending import Goal

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/thin/1"


@click.command("thin", cls=ReadingCommand, short_help="How many links can go while GRAPH keeps what is asked of it?")
@graph_argument
@goal_and_files
@click.option(
    "--cost", default="one", show_default=True, metavar="one|ATTR", help="What a link costs: one, or this attribute."
)
@click.option("--keep", type=FILE, metavar="FILE", help="A network whose links may not go.")
@query_options()
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    goals: tuple[Goal, ...],
    kept: Kept,
    cost: str,
    keep: Path | None,
) -> None:
    """How many links of GRAPH can go while it keeps what is asked of it?

    The goal is -r R [-s S], or --survive F [--model M], or both. Exit code 0: so many, and no more. 30: so many at
    least. 10: the network does not reach the goal as it is.
    """
    from robustness.mending import MendResult, thin

    kept.require_writable([source, keep])
    graph = load_graph(source)
    stay = links_in(keep, graph, are_there=True) or []
    price = None if cost == "one" else link_costs(graph, cost, source)

    def work(line: Any, improved: Any) -> MendResult:
        return thin(graph, goals, cost=price, keep=stay, on_improvement=improved, **query.effort(line))

    tell(ctx, console, query, SCHEMA, answer(console, query, work), kept)
