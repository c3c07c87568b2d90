"""What to mark in a picture of a network: the sets that an answer is about, and the arcs that count.

Answers are told apart by what they hold, not by their type, so that every answer of this package that has two sets, or
links to add, can be drawn without this module importing its room.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from certificates.graph import Label
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.figures.wording import Names

__all__ = ["Marks", "marks_of"]


@dataclass(frozen=True)
class Marks:
    """Three node sets, which may be empty, and the arcs of interest, as pairs of ids.

    Attributes
    ----------
    S1, S2, M : frozenset of int
        The two sides, and who is malicious (in a violation a member of a side as well).
    counted : frozenset of arcs
        From outside into a side: what the definition counts.
    silenced : frozenset of arcs
        From malicious nodes into a side: what it does not count.
    lost_nodes : frozenset of int
        Nodes whose loss destroys a goal.
    added, kept, dropped, lost : frozenset of arcs
        Links that a mended network gains; that stay in a thinned one, and can go; whose loss destroys a goal.
    title : str
    """

    S1: frozenset[int] = frozenset()
    S2: frozenset[int] = frozenset()
    M: frozenset[int] = frozenset()
    counted: frozenset[tuple[int, int]] = frozenset()
    silenced: frozenset[tuple[int, int]] = frozenset()
    lost_nodes: frozenset[int] = frozenset()
    added: frozenset[tuple[int, int]] = frozenset()
    kept: frozenset[tuple[int, int]] = frozenset()
    dropped: frozenset[tuple[int, int]] = frozenset()
    lost: frozenset[tuple[int, int]] = frozenset()
    title: str = ""


def marks_of(graph: Digraph, answer: Any) -> Marks:
    """Return what an answer marks in its graph.

    Parameters
    ----------
    graph : Digraph
    answer : object or None
        A :class:`~robustness.results.RobustnessResult`, a witness or any pair of node sets, a trap (its search's result
        or three sets M, S1, S2), an :class:`~robustness.simulation.attacks.Attack`, a tolerance result, a joint result,
        an outcome of a run, a mended network, or a mapping with ``S1``, ``S2`` and perhaps ``M``. None marks nothing.

    Raises
    ------
    InvalidParameter
        When it is none of these, or names nodes that the graph does not have.
    """
    title = _title(answer)
    for part in _parts(answer):
        links = _links(graph, part, title)
        if links is not None:
            return links
        sets = _sets(part)
        if sets is not None:
            return _with_arcs(graph, *sets, title)
    if answer is None or any(hasattr(answer, name) for name in ("verdict", "guaranteed", "exists", "losses", "best")):
        return Marks(title=title)
    raise InvalidParameter(
        f"a picture marks a result, an attack, a pair (S1, S2) or a trap (M, S1, S2), not {type(answer).__name__}"
    )


def _parts(answer: Any) -> Iterator[Any]:
    """Yield the answer and what it carries that may hold sets."""
    yield answer
    for name in ("best", "witness", "violation", "shorter_fails", "attack_sets", "sets"):
        part = getattr(answer, name, None)
        if part is not None:
            yield part
            inner = getattr(part, "witness", None)
            if inner is not None:
                yield inner
    groups = getattr(getattr(answer, "scenario", None), "groups", None)
    if groups:
        yield {"M": getattr(getattr(answer, "start", None), "malicious", ()), "S1": groups[0], "S2": groups[1]}


def _links(graph: Digraph, part: Any, title: str) -> Marks | None:
    """Return what a part marks that has links to add, to keep, to spare or to lose; None when it has none."""
    links, dropped = getattr(part, "links", ()), getattr(part, "dropped", ())
    if getattr(part, "losses", None):
        gone = graph.ids(part.nodes)
        around = [(u, v) for u, v in graph.arcs() if u in gone or v in gone]
        return Marks(lost_nodes=gone, lost=_arcs(graph, part) | frozenset(around), title=title)
    if not (links or dropped):
        return None
    arcs = _arcs(graph, part)
    kept, added = (arcs, frozenset()) if getattr(part, "thinned", False) else (frozenset(), arcs)
    return Marks(added=added, kept=kept, dropped=_arcs(graph, part, "dropped"), title=title)


def _sets(part: Any) -> tuple[Any, Any, Any] | None:
    """Return (M, S1, S2) of one part, or None."""
    if isinstance(part, dict):
        if "S1" in part and "S2" in part:
            return part.get("M", part.get("malicious", ())), part["S1"], part["S2"]
        return None
    first, second = getattr(part, "S1", None), getattr(part, "S2", None)
    if first and second:
        return getattr(part, "malicious", None) or getattr(part, "M", None) or (), first, second
    if isinstance(part, tuple | list) and len(part) in (2, 3):
        rows = [row for row in part if isinstance(row, Iterable) and not isinstance(row, str)]
        if len(rows) == len(part):
            return (rows[0] if len(rows) == 3 else ()), rows[-2], rows[-1]
    return None


def _with_arcs(graph: Digraph, bad: Any, first: Any, second: Any, title: str) -> Marks:
    M, S1, S2 = (graph.ids(labels) for labels in (bad, first, second))
    counted: set[tuple[int, int]] = set()
    silenced: set[tuple[int, int]] = set()
    for u, v in graph.arcs():
        for side in (S1, S2):
            if v in side and u not in side and v not in M:
                (silenced if u in M - S1 - S2 else counted).add((u, v))
    return Marks(S1, S2, M, frozenset(counted), frozenset(silenced), title=title)


def _arcs(graph: Digraph, part: Any, name: str = "links") -> frozenset[tuple[int, int]]:
    """Return the links of a part: both arcs of each in an undirected graph, unless they are single arcs."""
    found = set()
    for u, v in getattr(part, name, ()):
        (i,), (j,) = graph.ids([u]), graph.ids([v])
        found.add((i, j))
        if not (graph.directed or getattr(part, "one_way", False)):
            found.add((j, i))
    return frozenset(found)


def _title(answer: Any) -> str:
    """Return the answer in one short line."""
    if hasattr(answer, "guaranteed") and hasattr(answer, "threat"):
        refuted = "no attack known" if answer.refuted is None else f"split for f = {answer.refuted}"
        return f"{answer.threat.name}: agreement for f <= {answer.guaranteed}, {refuted}"
    if getattr(answer, "kind", None) and hasattr(answer, "malicious"):
        who: frozenset[Label] = answer.malicious
        everybody = answer.graph.labels if hasattr(answer, "graph") else who
        liars = Names(everybody).together(who) if who else "nobody"
        return f"{answer.kind} for f = {answer.f}: {liars} malicious"
    if callable(getattr(answer, "summary", None)):
        return str(answer.summary()).splitlines()[0]
    return ""
