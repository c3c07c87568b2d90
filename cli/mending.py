"""What ``mend`` and ``thin`` share: the goal, lists of links in files, and how an answer is told and kept."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from robustness.spelled import plural

from .choices import THREAT_MODEL_NAMES
from .exit_codes import ExitCode
from .interruption import Overrun
from .output import Console, ProgressLine, graph_document, set_text
from .query import Query

if TYPE_CHECKING:
    from collections.abc import Hashable

    from robustness.digraph import Digraph
    from robustness.mending import BudgetResult, Goal, MendResult

__all__ = [
    "FILE",
    "Kept",
    "answer",
    "caps_in",
    "costs_in",
    "goal_and_files",
    "goals_from",
    "link_costs",
    "links_in",
    "tell",
    "tell_bought",
]

#: A file that is read or written whole.
FILE = click.Path(dir_okay=False, path_type=Path)

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
    click.option("--plot", "picture", type=FILE, metavar="FILE", help="Draw it, new links thick: .svg, .png or .pdf."),
)

#: r* and s are told for networks of up to so many nodes: within a second.
_FEW_NODES = 20


@dataclass(frozen=True, slots=True)
class Kept:
    """Where what is found is written; None where it is not."""

    output: Path | None
    certificate: Path | None
    goal_certificate: Path | None
    picture: Path | None

    @property
    def paths(self) -> list[Path | None]:
        """All paths, None for what is not written."""
        return [self.output, self.certificate, self.goal_certificate, self.picture]


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


def links_in(path: Path | None, graph: Digraph) -> list[tuple[Hashable, Hashable]] | None:
    """Return the links that a file lists: the links of a network in any format, whose nodes are those of GRAPH."""
    if path is None:
        return None
    listed, named = _listed(path, graph)
    labels = listed.labels
    return list(dict.fromkeys((named[labels[u]], named[labels[v]]) for u, v in listed.arcs()))


def costs_in(path: Path, graph: Digraph, attribute: str) -> dict[tuple[Hashable, Hashable], Any]:
    """Return what the links that a file lists cost: this attribute of them."""
    listed, named = _listed(path, graph)
    return {(named[u], named[v]): cost for (u, v), cost in link_costs(listed, attribute, str(path)).items()}


def link_costs(graph: Digraph, attribute: str, source: str) -> dict[tuple[Hashable, Hashable], Any]:
    """Return this attribute of the links of a network that has been read, where they have it."""
    from robustness.errors import UnreadableTopology

    costs: dict[tuple[Hashable, Hashable], Any] = {
        link: said[attribute] for link, said in graph.link_attributes.items() if attribute in said
    }
    if not costs:
        have = sorted({name for said in graph.link_attributes.values() for name in said})
        known = f"links here have: {', '.join(have[:12])}" if have else "its links have none"
        raise UnreadableTopology(f"{source}: no link has an attribute {attribute!r}; {known}")
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
            f"--max-in-degree is a number, or a file that says it of each node: {problem}."
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
    from robustness.errors import UnreadableTopology
    from robustness.files import read_topology

    listed = read_topology(path)
    by_name = _by_text(graph)
    unknown = [label for label in listed.labels if str(label) not in by_name]
    if unknown:
        raise UnreadableTopology(
            f"{path}: the node {unknown[0]!r} is none of the network: name links between its nodes"
        )
    return listed, {label: by_name[str(label)] for label in listed.labels}


def answer(
    console: Console, query: Query, work: Callable[[ProgressLine, Callable[[MendResult], None]], MendResult]
) -> tuple[MendResult | None, bool]:
    """Return the answer and whether it was interrupted: then it is the best that was known."""
    from robustness.mending.master import load_solver

    if query.timeout is not None:
        load_solver()
    latest: list[MendResult] = []
    with ProgressLine(console) as line:
        try:
            return query.wait_for(lambda: work(line, latest.append), line), False
        except (KeyboardInterrupt, Overrun) as stop:
            return (latest[-1] if latest else None), isinstance(stop, KeyboardInterrupt)


def tell(
    ctx: click.Context,
    console: Console,
    query: Query,
    schema: str,
    found: MendResult | None,
    *,
    is_interrupted: bool,
    kept: Kept,
) -> None:
    """Print an answer, write what was asked for, and end with the exit code that it deserves."""
    if found is None:
        message = "interrupted: nothing is claimed" if is_interrupted else "undecided: nothing was found in time"
        code = ExitCode.INTERRUPTED if is_interrupted else ExitCode.UNDECIDED
        console.error(message)
        console.error_document(code, message)
        ctx.exit(code)
    after = _facts(found.graph) if found.cost is not None else None
    before = _facts(found.before)
    _keep(console, query, found, kept)
    if query.as_json:
        facts = {"graph": graph_document(found.before), **found.as_dict(), "before": before, "after": after}
        console.document(schema, facts)
    else:
        console.answer(_lines(found, before, after))
    if is_interrupted:
        console.error("interrupted: what is printed holds, nothing else is claimed")
        ctx.exit(ExitCode.INTERRUPTED)
    codes = {"optimal": ExitCode.DONE, "impossible": ExitCode.REFUTED}
    ctx.exit(codes.get(found.verdict.value, ExitCode.UNDECIDED))


def tell_bought(
    ctx: click.Context,
    console: Console,
    query: Query,
    schema: str,
    work: Callable[[ProgressLine], BudgetResult],
    kept: Kept,
) -> None:
    """Print what a budget buys, write what was asked for, and end with the exit code that it deserves."""
    with ProgressLine(console) as line:
        bought = query.wait_for(lambda: work(line), line)
    best = bought.best
    if best is None:
        console.error(bought.summary())
        ctx.exit(ExitCode.REFUTED if bought.is_exact else ExitCode.UNDECIDED)
    _keep(console, query, best, kept)
    before, after = _facts(best.before), _facts(best.graph)
    if query.as_json:
        missed = None if bought.missed is None else bought.missed.goal
        facts = {"graph": graph_document(best.before), **best.as_dict(), "before": before, "after": after}
        console.document(schema, facts | {"missed": missed, "is_exact": bought.is_exact})
    else:
        console.result("\n".join([bought.summary(), *_lines(best, before, after)[1:]]))
    ctx.exit(ExitCode.DONE if bought.is_exact else ExitCode.UNDECIDED)


def _facts(graph: Digraph) -> dict[str, Any]:
    """Return how many links there are, and on few nodes r* and s; on more they can take longer than the answer did."""
    from robustness.decision.front import determine_robustness

    links = graph.arc_count if graph.directed else graph.arc_count // 2
    if graph.n > _FEW_NODES:
        return {"links": links, "r": None, "s": None}
    known = determine_robustness(graph)
    return {"links": links, "r": known.r, "s": known.s}


def _lines(found: MendResult, before: dict[str, Any], after: dict[str, Any] | None) -> list[str]:
    from robustness.spelled import Spelling, counted

    color = {"optimal": "green", "impossible": "red"}.get(found.verdict.value, "yellow")
    head, _, rest = found.summary().partition(":")
    lines = [f"{click.style(head + ':', fg=color, bold=True)}{rest}"]
    arrow, spelled = "->" if found.one_way else "--", Spelling(found.before.labels)
    shown = found.dropped if found.thinned else found.links
    lines += [f"  {'drop' if found.thinned else 'add'}  {spelled(u)} {arrow} {spelled(v)}" for u, v in shown]
    if found.witness is not None and found.witness.S1:
        lines.append(f"no candidate breaks this: {found.witness.goal}")
        sides = (("M", found.witness.M), ("S1", found.witness.S1), ("S2", found.witness.S2))
        lines += [f"  {name:<3} {set_text(labels, found.before.labels)}" for name, labels in sides if labels]
    if found.reason:
        lines.append(f"stopped: {found.reason}")
    for name, facts in (("before", before), ("after", after)):
        if facts is not None:
            known = "" if facts["r"] is None else f", r* = {facts['r']}, s = {facts['s']}"
            lines.append(f"{name:<7} {counted(facts['links'], 'link')}{known}")
    return lines


def _keep(
    console: Console,
    query: Query,
    found: MendResult,
    kept: Kept,
) -> None:
    """Write the mended network, its certificates, and a picture."""
    from robustness.files import write_topology

    if kept.certificate is not None:
        from robustness.mending import certify_mending

        _write(console, kept.certificate, certify_mending(found, **query.effort()))
    if found.cost is None:
        return
    if kept.output is not None:
        write_topology(found.graph, kept.output)
        console.talk(f"wrote {kept.output}")
    if kept.goal_certificate is not None:
        _write(console, kept.goal_certificate, _certificate(found, query))
    if kept.picture is not None:
        from robustness.figures.network import draw_to_file

        draw_to_file(found.graph, found, kept.picture)
        console.talk(f"wrote {kept.picture}")


def _write(console: Console, path: Path, data: bytes | None) -> None:
    from robustness.files import write_certificate

    if data is None:
        console.talk("no certificate: a limit was reached, or the kernel has no evidence of this kind")
    else:
        write_certificate(path, data)
        console.talk(f"wrote {path} ({len(data):,} {plural(len(data), 'byte')}, verified)")


def _certificate(found: MendResult, query: Query) -> bytes | None:
    """Return a certificate that the mended network is what the (one) goal asks."""
    from robustness.decision.certification import certify
    from robustness.threat_models import certify_tolerance, tolerance

    goal = found.goals[0]
    effort = query.effort()
    if goal.r is not None:
        return certify(found.graph, goal.r, goal.s, **effort).certificate
    result = tolerance(found.graph, goal.model, **effort)
    return certify_tolerance(result, **effort).guaranteed
