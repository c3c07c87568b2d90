"""The links that would mend a network: what a page proposes to whoever runs it."""

from __future__ import annotations

from robustness.mending import Goal, MendResult, MendVerdict
from robustness.reporting.wording import in_models
from robustness.spelled import Spelling, counted, robust

__all__ = ["in_sentences"]


def in_sentences(found: MendResult) -> list[str]:
    """Return the proposal in words, the links last."""
    wish, count = _wish(found.goals), len(found.links)
    if found.verdict is MendVerdict.IMPOSSIBLE:
        return [f"No further links between these nodes give a network that {wish}."]
    if found.cost is None:
        least = f"{counted(found.lower_bound, 'more link is', 'more links are')} needed"
        return [f"At least {least} for a network that {wish}; none were found in time."]
    told = f"With {counted(count, 'more link')} it {wish}"
    if found.verdict is MendVerdict.OPTIMAL:
        told += ". Fewer do not suffice: this is proven."
    else:
        told += ". " + _at_least(found.lower_bound)
    spelled = Spelling(found.before.labels)
    arrow = "\N{RIGHTWARDS ARROW}" if found.one_way else "\N{EN DASH}"
    return [told, ", ".join(f"{spelled(u)} {arrow} {spelled(v)}" for u, v in found.links)]


def _at_least(count: float) -> str:
    if count <= 0:
        return "How few would do was not proven in time."
    return f"At least {counted(count, 'is', 'are')} needed; more was not proven in time."


def _wish(goals: tuple[Goal, ...]) -> str:
    wishes = [f"is {robust(goal.r, goal.s)}" for goal in goals if goal.r is not None]
    survived = [goal for goal in goals if goal.survive is not None]
    if survived:
        f = survived[0].survive
        under = in_models([goal.model for goal in survived])
        wishes.append(f"survives {counted(f or 0, 'malicious node')} under {under}")
    return " and ".join(wishes)
