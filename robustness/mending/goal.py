"""What a mended network has to be: (r,s)-robust, or safe from f malicious nodes under a threat model."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from robustness.errors import InvalidParameter
from robustness.spelled import robust
from robustness.threat_models.models import threat_model_named
from robustness.traps.question import Question as TrapQuestion
from robustness.whole_numbers import whole

__all__ = ["Goal", "Part", "goals_of", "parts_of"]


@dataclass(frozen=True, slots=True)
class Goal:
    """What a network has to be; at least one of ``r`` and ``survive`` is given, and both may be.

    Attributes
    ----------
    r, s : int or None, int
        (r,s)-robust.
    survive : int or None
        Agreement is guaranteed against so many malicious nodes under ``model``.
    model : str
        A threat model, a name in ``THREAT_MODELS``.

    Raises
    ------
    InvalidParameter
        For numbers out of range, an unknown model, or a goal that asks nothing.

    >>> print(Goal(r=2, s=2), "-", Goal(survive=1, model="delayed"))
    (2,2)-robust - survives f = 1 under delayed
    """

    r: int | None = None
    s: int = 1
    survive: int | None = None
    model: str = "malicious"

    def __post_init__(self) -> None:
        for name in ("r", "s", "survive"):
            object.__setattr__(self, name, whole(getattr(self, name)))
        if self.r is None and self.survive is None:
            raise InvalidParameter("a goal names r, or how many malicious nodes to survive: give one")
        for name, value, least in (("r", self.r, 0), ("s", self.s, 1), ("survive", self.survive, 0)):
            if value is not None and (type(value) is not int or value < least):
                raise InvalidParameter(f"{name} of a goal is an integer of at least {least}, not {value!r}")
        threat_model_named(self.model)

    def __str__(self) -> str:
        wishes = []
        if self.r is not None:
            wishes.append(robust(self.r, self.s))
        if self.survive is not None:
            wishes.append(f"survives f = {self.survive} under {self.model}")
        return " and ".join(wishes)


class Part(NamedTuple):
    """One condition of a goal: (r,s)-robustness, or with ``trap`` no sets of that kind."""

    r: int = 0
    s: int = 1
    trap: TrapQuestion | None = None

    @property
    def enough(self) -> int:
        """How many nodes outside its side a node hears at least when it can leave it."""
        return self.r if self.trap is None else self.trap.f + 1

    def __str__(self) -> str:
        if self.trap is None:
            return robust(self.r, self.s)
        kind = "trap" if self.trap.two_faces else "violation"
        return f"no {'local ' if self.trap.local else ''}{kind} for f = {self.trap.f}"


def goals_of(goal: object) -> tuple[Goal, ...]:
    """Return the goals that a caller means: a Goal, an integer r, a pair (r, s), or several of these."""
    if isinstance(goal, Goal):
        return (goal,)
    if type(goal) is int:
        return (Goal(goal),)
    if isinstance(goal, tuple) and len(goal) == 2 and all(type(each) is int for each in goal):
        return (Goal(*goal),)
    if isinstance(goal, Iterable) and not isinstance(goal, str):
        found = tuple(each for part in goal for each in goals_of(part))
        if found:
            return found
    raise InvalidParameter(f"a goal is a Goal, an integer r, a pair (r, s), or several of these, not {goal!r}")


def parts_of(goals: Iterable[Goal], n: int) -> tuple[Part, ...]:
    """Return the conditions of all goals on n nodes; one that every network has is left out.

    A network on fewer than two nodes has nobody to hold apart.
    """
    parts = []
    for goal in goals:
        if goal.r is not None:
            if goal.s > max(n, 1):
                raise InvalidParameter(f"s is at most the number of nodes, {n}, not {goal.s}")
            if goal.r > 0:
                parts.append(Part(goal.r, goal.s))
        if goal.survive is not None and n >= 2:
            question = threat_model_named(goal.model).question(goal.survive)
            total_and_one_face = not (question.two_faces or question.local)
            if goal.survive == 0 or total_and_one_face:
                parts.append(Part(goal.survive + 1, min(goal.survive + 1, n)))
            else:
                parts.append(Part(trap=question))
    return tuple(dict.fromkeys(parts))
