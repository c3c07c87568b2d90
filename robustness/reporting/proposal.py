"""The links that would mend a network: what a page proposes to whoever runs it."""

from __future__ import annotations

from robustness.errors import RobustnessError
from robustness.mending import Goal, MendResult, MendVerdict, mend
from robustness.showing import labels_in_words
from robustness.surveying import Gate
from robustness.surveying.row import Findings

__all__ = ["in_sentences", "proposal_for"]

#: Larger networks are not mended on a page: within seconds little would be found.
_LARGEST = 80


def proposal_for(findings: Findings, gate: Gate, seconds: float) -> MendResult | None:
    """Return the cheapest links that give a network what it lacks; None where nothing is to be proposed.

    Parameters
    ----------
    findings : Findings
    gate : Gate
        What is asked of it. A network that passes needs nothing; where nothing is asked it is one more r.
    seconds : float
        The limit; past it the best links so far are proposed, with the lower bound.
    """
    goals = _goals(findings, gate)
    if not goals or not 1 < findings.graph.n <= _LARGEST:
        return None
    try:
        return mend(findings.graph, goals, time_limit=seconds)
    except RobustnessError:  # a goal that no network of this size has
        return None


def _goals(findings: Findings, gate: Gate) -> list[Goal]:
    row = findings.row
    if gate.r is None and gate.survive is None:
        return [] if row.r is None else [Goal(row.r + 1)]
    if row.gate == "passed":
        return []
    goals = [] if gate.r is None else [Goal(gate.r, gate.s)]
    return goals + [Goal(survive=gate.survive, model=model) for model in row.guaranteed if gate.survive is not None]


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
