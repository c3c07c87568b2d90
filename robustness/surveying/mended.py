"""The links that would mend a network of a survey: the fewest that give it what a gate asks and it lacks."""

from __future__ import annotations

import math
import time
from dataclasses import replace

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.mending import Goal, MendResult, MendVerdict, mend
from robustness.surveying.row import Findings, Gate, Row

__all__ = ["mended_for", "seconds_for_mending", "with_links"]

#: Larger networks are not mended in a survey: within seconds little would be found.
_LARGEST = 80


def mended_for(graph: Digraph, row: Row, gate: Gate, seconds: float, seed: int = 0) -> MendResult | None:
    """Return the cheapest links that give a network what it lacks; None where nothing is to be proposed.

    Parameters
    ----------
    graph : Digraph
    row : Row
        What is known about it.
    gate : Gate
        What is asked of it. A network that passes needs nothing; where nothing is asked it is one more r.
    seconds : float
        The limit; past it the best links so far are proposed, with the lower bound.
    seed : int
    """
    goals = _goals(row, gate)
    if not goals or not 1 < graph.n <= _LARGEST:
        return None
    try:
        return mend(graph, goals, time_limit=seconds, seed=seed)
    except InvalidParameter:  # a goal that no network of this size has
        return None


def _goals(row: Row, gate: Gate) -> list[Goal]:
    if gate.r is None and gate.survive is None:
        return [] if row.r is None else [Goal(row.r + 1)]
    if row.gate == "passed":
        return []
    goals = [] if gate.r is None else [Goal(gate.r, gate.s)]
    return goals + [Goal(survive=gate.survive, model=model) for model in row.guaranteed if gate.survive is not None]


def with_links(findings: Findings, gate: Gate, seconds: float, seed: int = 0) -> Findings:
    """Return the findings with the links that the network lacks, and how many they are in the row."""
    row = findings.row
    if row.gate == "passed":
        return replace(findings, row=replace(row, links=0, links_at_least=0))
    started = time.monotonic()
    found = mended_for(findings.graph, row, gate, seconds, seed)
    row = replace(row, seconds=row.seconds + time.monotonic() - started)
    if found is not None and found.verdict is not MendVerdict.IMPOSSIBLE:
        links = None if found.cost is None else len(found.links)
        row = replace(row, links=links, links_at_least=math.ceil(found.lower_bound))
    return replace(findings, row=row, mended=found)


def seconds_for_mending(seconds: float) -> float:
    """Return the seconds, or raise :class:`InvalidParameter` unless they are a number of at least 0."""
    if not 0 <= seconds < math.inf:
        raise InvalidParameter(f"mending is a number of seconds of at least 0, not {seconds!r}")
    return float(seconds)
