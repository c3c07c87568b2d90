"""``robustness mend``: the cheapest links that make a network robust, proven."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .answered import answer, tell
from .mending import Kept, caps_in, costs_in, goal_and_files, links_in
from .named import FILE
from .options import ReadingCommand, graph_argument, load_graph
from .output import Console
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.digraph import Digraph
    from robustness.mending import Goal

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/mend/1"


@click.command("mend", cls=ReadingCommand, short_help="Find the cheapest links that make GRAPH robust.")
@graph_argument
@goal_and_files
@click.option("--candidates", type=FILE, metavar="FILE", help="A network whose links can be added; all unless given.")
@click.option("--range", "reach", type=float, metavar="X", help="Links can be added between nodes X apart at most.")
@click.option(
    "--cost",
    default="one",
    show_default=True,
    metavar="one|distance|ATTR",
    help="What a link costs: one, its length, or this attribute (column) of it in the file of --candidates.",
)
@click.option("--forbid", type=FILE, metavar="FILE", help="A network whose links may not be added.")
@click.option("--mandatory", type=FILE, metavar="FILE", help="A network whose links have to be added.")
@click.option(
    "--max-in-degree",
    "caps",
    metavar="D|FILE",
    help="No node that gains links hears more; in FILE lines NODE,D or a JSON object, for each node.",
)
@click.option(
    "--budget", type=float, metavar="B", help="Links for B together at most; without a goal, the most they buy."
)
@click.option("--one-way", is_flag=True, help="Add single arcs, also to an undirected network.")
@query_options()
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    goals: tuple[Goal, ...],
    kept: Kept,
    candidates: Path | None,
    reach: float | None,
    cost: str,
    forbid: Path | None,
    mandatory: Path | None,
    caps: str | None,
    budget: float | None,
    climbed: str | None,
    one_way: bool,
) -> None:
    """Which links make GRAPH robust, at least cost?

    The goal is -r R [-s S], or --survive F [--model M], or both. Positions for --range and --cost distance are those of
    the file. Exit code 0: these links, and nothing cheaper. 30: these links, or none yet, and a lower bound. 10: no
    choice of these candidates, within --budget, does it. With --budget and no goal: the greatest r, and then s, of
    (r,s)-robustness that the budget buys, or with --model the most malicious nodes that are survived. Ctrl-C prints the
    best links so far, checked, and the lower bound.
    """
    from robustness.mending import BudgetResult, MendResult, best_within, mend
    from robustness.mending.front import links_within

    if candidates is not None and reach is not None:
        raise click.UsageError("give one of --candidates and --range.")
    if cost not in ("one", "distance") and candidates is None:
        raise click.UsageError(f"--cost {cost} is an attribute of the links in a file: give it with --candidates FILE.")
    if reach is not None:
        links_within({}, reach)  # refuses what is no range, before files are read
    kept.require_writable([source, candidates, forbid, mandatory])
    graph = load_graph(source)
    places = _positions(source, graph) if reach is not None or cost == "distance" else {}
    wanted = links_in(candidates, graph) if reach is None else links_within(places, reach)
    forbidden, needed = links_in(forbid, graph) or [], links_in(mandatory, graph) or []
    price: Any = None
    if cost == "distance":
        price = _distances(places)
    elif cost != "one" and candidates is not None:
        price = costs_in(candidates, graph, cost)

    constraints: dict[str, Any] = {
        "candidates": wanted,
        "cost": price,
        "forbid": forbidden,
        "mandatory": needed,
        "max_in_degree": None if caps is None else caps_in(caps, graph),
        "one_way": True if one_way else None,
    }

    def work(line: Any, keep: Any) -> MendResult | BudgetResult:
        effort = {"on_improvement": keep, **constraints, **query.effort(line)}
        if not goals and budget is not None:
            return best_within(graph, budget, model=climbed, **effort)
        return mend(graph, goals, budget=budget, **effort)

    answered = answer(console, query, work)
    tell(ctx, console, query, SCHEMA, answered, kept)


def _positions(source: str, graph: Digraph) -> dict[Any, tuple[float, float]]:
    from robustness.errors import UnreadableTopology
    from robustness.figures.placement import positions_in

    places = positions_in(graph)
    if places is None:
        raise UnreadableTopology(f"{source}: places not every node: --range and --cost distance need positions")
    return places


def _distances(places: dict[Any, tuple[float, float]]) -> Callable[[Any, Any], float]:
    """Return the cost of a link: how far apart its ends are, to the thousandth."""

    def cost(u: Any, v: Any) -> float:
        return round(math.dist(places[u], places[v]), 3)

    return cost
