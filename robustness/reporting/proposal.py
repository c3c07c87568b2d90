"""The links that would mend a network: what a page proposes to whoever runs it."""

from __future__ import annotations

from robustness.mending import Goal, MendResult, MendVerdict
from robustness.showing import labels_in_words

__all__ = ["in_sentences"]


def in_sentences(found: MendResult) -> list[str]:
    """Return the proposal in words, the links last."""
    wish, count = _wish(found.goals), len(found.links)
    if found.verdict is MendVerdict.IMPOSSIBLE:
        return [f"No further links between these nodes give a network that {wish}."]
    if found.cost is None:
        return [
            f"At least {found.lower_bound} more links are needed for a network that {wish}; none were found in time."
        ]
    told = f"With {count} more link{'' if count == 1 else 's'} it {wish}"
    if found.verdict is MendVerdict.OPTIMAL:
        told += ". Fewer do not suffice: this is proven."
    else:
        told += f". At least {found.lower_bound} are needed; more was not proven in time."
    arrow = "\N{RIGHTWARDS ARROW}" if found.one_way else "\N{EN DASH}"
    return [told, ", ".join(f"{_name(u)} {arrow} {_name(v)}" for u, v in found.links)]


def _wish(goals: tuple[Goal, ...]) -> str:
    wishes = [f"is ({goal.r},{goal.s})-robust" for goal in goals if goal.r is not None]
    survived = [goal for goal in goals if goal.survive is not None]
    if survived:
        f = survived[0].survive
        under = f"all {len(survived)} threat models" if len(survived) > 1 else f"the threat model {survived[0].model}"
        wishes.append(f"survives {f} malicious node{'' if f == 1 else 's'} under {under}")
    return " and ".join(wishes)


def _name(label: object) -> str:
    return labels_in_words([label])[1:-1]
