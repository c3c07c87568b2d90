"""The exact search as an oracle: a violation that a network still has."""

from __future__ import annotations

from collections.abc import Sequence

from robustness.decision.front import check_within
from robustness.definitions import is_violation
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.limits import Limits
from robustness.mending.goal import Part
from robustness.results import Verdict
from robustness.traps.ladder import decide_trap
from robustness.traps.question import Sets, solves

__all__ = ["find_violation", "first_violation", "violates"]


def violates(graph: Digraph, part: Part, sets: Sets) -> bool:
    """Return whether the sets violate a condition in the network, by its definition."""
    if part.trap is not None:
        return solves(graph, part.trap, sets)
    return is_violation(graph, sets.S1, sets.S2, part.r, part.s)


def find_violation(graph: Digraph, part: Part, limits: Limits) -> Sets | None:
    """Return sets that violate the condition, or None when it holds; exact.

    Empty sets: it is violated by convention, on too few nodes for a pair.

    Raises
    ------
    Undecided
        When a limit stopped the search.
    """
    if part.trap is None:
        result = check_within(graph, part.r, part.s, limits)
        if result.verdict is Verdict.UNDECIDED:
            raise Undecided("whether a proposal reaches the goal was not decided within the limit")
        if result.witness is None:
            return None if result.verdict is Verdict.ROBUST else Sets(frozenset(), frozenset(), frozenset())
        return Sets(frozenset(), graph.ids(result.witness.S1), graph.ids(result.witness.S2))
    answer = decide_trap(graph, part.trap, limits)
    if answer.exists is None:
        raise Undecided("whether a proposal reaches the goal was not decided within the limit")
    return answer.sets


def first_violation(graph: Digraph, parts: Sequence[Part], limits: Limits) -> tuple[Part, Sets] | None:
    """Return a condition that the network fails, with its sets, or None when it has them all."""
    for part in parts:
        sets = find_violation(graph, part, limits)
        if sets is not None:
            return part, sets
    return None
