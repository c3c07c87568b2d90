"""What a network is before it is mended or thinned and after: its links, r*, s, and how many liars it survives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from robustness.spelled import counted

if TYPE_CHECKING:
    from collections.abc import Iterable

    from robustness.digraph import Digraph
    from robustness.limits import Limits

__all__ = ["facts_of", "line_of"]

#: Networks of up to so many nodes are decided whole, within a second.
_FEW_NODES = 20

#: On more nodes each exact search has so many steps, about a tenth of a second.
_STEPS = 100_000_000


def facts_of(graph: Digraph, limits: Limits, *, one_way: bool) -> dict[str, Any]:
    """Return the number of links, the bounds proven on r* and s, and what each threat model guarantees and refutes.

    Links are counted as arcs where some of them run ``one_way``, before as after.
    ``r`` and ``s`` are None where their bounds differ. Networks of more than 20 nodes are decided within ``limits`` and
    budgets of steps; past the deadline nothing but their links is told.
    """
    from robustness.decision.front import determine_within
    from robustness.limits import UNBOUNDED
    from robustness.threat_models.front import tolerance_within

    links = graph.arc_count if one_way else graph.arc_count // 2
    facts: dict[str, Any] = {"links": links} | dict.fromkeys(("r", "s", "r_bounds", "s_bounds", "tolerance"))
    if graph.n > _FEW_NODES and limits.expired():
        return facts
    limits = UNBOUNDED if graph.n <= _FEW_NODES else limits.counted(_STEPS)
    known = determine_within(graph, limits)
    low, high = (known.r, known.r) if known.bounds is None else (known.bounds.lower.value, known.bounds.upper.value)
    facts["r_bounds"] = [low, high]
    if low == high:
        facts |= {"r": low, "s_bounds": [known.s, known.s if known.s_bounds is None else known.s_bounds.upper.value]}
        facts["s"] = known.s if known.s_is_exact else None
    if not limits.expired():
        table = tolerance_within(graph, limits)
        facts["tolerance"] = {
            each.model: {"guaranteed": each.guaranteed, "refuted": each.refuted} for each in table.values()
        }
    return facts


def line_of(name: str, facts: dict[str, Any], models: Iterable[str], *, one_way: bool) -> str:
    """Return these facts as one line, with what is survived under these threat models."""
    told = [counted(facts["links"], "arc" if one_way else "link")]
    for value, bounds in (("r*", facts["r_bounds"]), ("s", facts["s_bounds"])):
        if bounds is not None:
            told.append(f"{value} = {_range(*bounds)}")
    if facts["tolerance"] is not None:
        told += [f"survives {_survived(**facts['tolerance'][model])} under {model}" for model in models]
    return f"{name:<7} {', '.join(told)}"


def _survived(guaranteed: int, refuted: int | None) -> str:
    """Return the f that is survived; not even 0 where normal nodes alone may not agree."""
    if guaranteed < 0:
        return "not even f = 0" if refuted == 0 else "an unknown f"
    if refuted is None:
        return f"f >= {guaranteed}"
    return f"f = {_range(guaranteed, refuted - 1)}"


def _range(low: int, high: int) -> str:
    return str(low) if low == high else f"{low}..{high}"
