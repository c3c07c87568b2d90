"""What ``mend`` and ``thin`` are asked: the goal, lists of links and caps in files, and what to write."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .choices import THREAT_MODEL_NAMES
from .named import FILE
from .options import asked_reading

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

    from robustness.digraph import Digraph
    from robustness.mending import Goal

__all__ = [
    "FILE",
    "Kept",
    "caps_in",
    "costs_in",
    "goal_and_files",
    "goals_from",
    "link_costs",
    "links_in",
]


_GOAL_OPTIONS = (
    click.option("-r", "r", type=click.IntRange(min=0), metavar="R", help="The goal: (R,S)-robust."),
    click.option("-s", "s", type=click.IntRange(min=1), metavar="S", help="With -r; 1 unless given."),
    click.option("--survive", type=click.IntRange(min=0), metavar="F", help="The goal: survive F malicious nodes."),
    click.option(
        "--model",
        type=click.Choice(THREAT_MODEL_NAMES),
        help="With --survive: under this threat model; malicious unless given.",
    ),
)


_KEEP_OPTIONS = (
    click.option("-o", "--output", type=FILE, metavar="FILE", help="Write the network with its new set of links."),
    click.option(
        "--certificate",
        type=FILE,
        metavar="FILE",
        help="Write a certificate about GRAPH: the links reach the goal, and the violations behind the lower bound.",
    ),
    click.option(
        "--goal-certificate",
        type=FILE,
        metavar="FILE",
        help="Write a certificate that the result is as asked.",
    ),
    click.option(
        "--plot",
        "picture",
        type=FILE,
        metavar="FILE",
        help="Draw it, new links thick and dropped ones dashed: .svg, .png or .pdf.",
    ),
)


@dataclass(frozen=True, slots=True)
class Kept:
    """Where what is found is written; None where it is not."""

    output: Path | None
    certificate: Path | None
    goal_certificate: Path | None
    picture: Path | None

    def require_writable(self, inputs: Iterable[str | Path | None]) -> None:
        """Guarantees that no output is an input, and that each can be written as its suffix says, before any work."""
        from robustness.files.front import require_written_format
        from robustness.files.writing import require_different_files

        require_different_files(inputs, [self.output, self.certificate, self.goal_certificate, self.picture])
        if self.output is not None:
            require_written_format(self.output)
        if self.picture is not None:
            from robustness.figures.saving import picture_format

            picture_format(self.picture)


def goal_and_files(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that name a goal and the files to write; the command gets ``goals`` and ``kept``.

    A command with a budget also gets ``climbed``: the threat model for which, without a goal, the budget buys the most.
    """

    @wraps(command)
    def with_goal(
        *arguments: Any,
        r: int | None,
        s: int | None,
        survive: int | None,
        model: str | None,
        output: Path | None,
        certificate: Path | None,
        goal_certificate: Path | None,
        picture: Path | None,
        **own: Any,
    ) -> Any:
        asked = r is not None or survive is not None or s is not None
        goals = goals_from(r, s, survive, model) if asked or own.get("budget") is None else ()
        if "budget" in own:
            own["climbed"] = None if goals else model
        kept = Kept(output, certificate, goal_certificate, picture)
        return command(*arguments, goals=goals, kept=kept, **own)

    for option in reversed((*_GOAL_OPTIONS, *_KEEP_OPTIONS)):
        with_goal = option(with_goal)
    return with_goal


def goals_from(r: int | None, s: int | None, survive: int | None, model: str | None) -> tuple[Goal, ...]:
    """Return the goal that the options name, or a usage error."""
    from robustness.mending import Goal

    if r is None and survive is None:
        raise click.UsageError("name a goal: -r R, or --survive F.")
    if s is not None and r is None:
        raise click.UsageError("-s goes with -r: give -r as well.")
    if model is not None and survive is None:
        raise click.UsageError("--model goes with --survive: give --survive as well.")
    return (Goal(r, s or 1, survive, model or "malicious"),)


def links_in(path: Path | None, graph: Digraph, *, are_there: bool = False) -> list[tuple[Hashable, Hashable]] | None:
    """Return the links that a file lists: the links of a network in any format, whose nodes are those of GRAPH.

    ``are_there``: links that GRAPH does not have, neither way, are refused.
    """
    if path is None:
        return None
    listed, named = _listed(path, graph)
    links = dict.fromkeys((named[listed.labels[u]], named[listed.labels[v]]) for u, v in listed.arcs())
    if are_there:
        own = {frozenset((graph.labels[u], graph.labels[v])) for u, v in graph.arcs()}
        _refuse_others(path, graph, (link for link in links if frozenset(link) not in own))
    return list(links)


def _refuse_others(path: Path, graph: Digraph, missing: Iterable[tuple[Hashable, Hashable]]) -> None:
    from robustness.errors import UnreadableTopology
    from robustness.spelled import Spelling

    spelled = Spelling(graph.labels)
    for u, v in missing:
        raise UnreadableTopology(f"{path}: the link {spelled(u)} -- {spelled(v)} is not in the network: leave it out")


def costs_in(path: Path, graph: Digraph, attribute: str) -> dict[tuple[Hashable, Hashable], Any]:
    """Return what the links that a file lists cost: this attribute of them."""
    listed, named = _listed(path, graph)
    return {(named[u], named[v]): cost for (u, v), cost in link_costs(listed, attribute, str(path)).items()}


def link_costs(graph: Digraph, attribute: str, source: str) -> dict[tuple[Hashable, Hashable], Any]:
    """Return this attribute of the links of a network that has been read, where they have it."""
    from robustness.errors import InvalidParameter, UnreadableTopology
    from robustness.mending.actions import cost_of
    from robustness.spelled import Spelling

    costs: dict[tuple[Hashable, Hashable], Any] = {
        link: said[attribute] for link, said in graph.link_attributes.items() if attribute in said
    }
    if not costs:
        have = sorted({name for said in graph.link_attributes.values() for name in said})
        known = f"links here have: {', '.join(have[:12])}" if have else "its links have none"
        raise UnreadableTopology(f"{source}: no link has an attribute {attribute!r}; {known}")
    spelled = Spelling(graph.labels)
    for (u, v), cost in costs.items():
        try:
            cost_of(cost, f"{spelled(u)} -- {spelled(v)}")
        except InvalidParameter as problem:
            raise UnreadableTopology(f"{source}: {problem}") from None
    return costs


def caps_in(text: str, graph: Digraph) -> int | dict[Hashable, int]:
    """Return how much nodes may hear: a number for all, or what a file says of each."""
    if text.isascii() and text.isdigit():
        return int(text)
    from robustness.errors import UnreadableTopology
    from robustness.whole_file import read_text

    path = Path(text)
    try:
        lines = read_text(path)
        is_object = lines.lstrip().startswith("{")
        rows = json.loads(lines, object_pairs_hook=list) if is_object else csv.reader(lines.splitlines())
        told = [(str(node).strip(), str(cap).strip()) for node, cap in (row for row in rows if row)]
        if not all(cap.isascii() and cap.isdigit() for _, cap in told):
            raise ValueError
    except OSError as problem:
        raise click.UsageError(
            f"--max-in-degree is a number, or a file that says it of each node; {text}: {problem.strerror}."
        ) from None
    except (ValueError, TypeError, RecursionError):
        raise UnreadableTopology(
            f"{path}: not lines NODE,NUMBER, and no JSON object of whole numbers by node"
        ) from None
    caps = {node: int(cap) for node, cap in told}
    if len(caps) < len(told):
        raise UnreadableTopology(f"{path}: a node has two caps: keep one")
    by_name = _by_text(graph)
    unknown = [name for name in caps if name not in by_name]
    if unknown:
        raise UnreadableTopology(f"{path}: the node {unknown[0]!r} is none of the network")
    return {by_name[name]: cap for name, cap in caps.items()}


def _by_text(graph: Digraph) -> dict[str, Hashable]:
    """Return the nodes by what files write for them."""
    from robustness.errors import InvalidGraph

    by_text: dict[str, Hashable] = {}
    for label in graph.labels:
        if by_text.setdefault(str(label), label) != label:
            raise InvalidGraph(f"two nodes are written {str(label)!r}, which a file cannot tell apart: rename one")
    return by_text


def _listed(path: Path, graph: Digraph) -> tuple[Digraph, dict[Hashable, Hashable]]:
    """Return the network that a file holds, and the labels of ``graph`` that its labels mean."""
    from robustness.errors import AmbiguousTopology, UnreadableTopology
    from robustness.files import read_topology

    directed = asked_reading().directed
    try:
        listed = read_topology(path, directed=directed)
    except AmbiguousTopology:  # of links, since it is asked for them
        listed = read_topology(path, format="edge-list", directed=directed)
    by_name = _by_text(graph)
    unknown = [label for label in listed.labels if str(label) not in by_name]
    if unknown:
        raise UnreadableTopology(
            f"{path}: the node {unknown[0]!r} is none of the network: name links between its nodes"
        )
    return listed, {label: by_name[str(label)] for label in listed.labels}
