"""What a question about mending is answered with: frozen, and never called optimal without a proof."""

from __future__ import annotations

import enum
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any

from certificates.graph import Label
from robustness.digraph import Digraph, GraphLike
from robustness.mending.actions import Actions
from robustness.mending.goal import Goal, Part
from robustness.natural_order import natural_key
from robustness.showing import Shown
from robustness.spelled import Spelling, counted
from robustness.traps.question import Sets

__all__ = ["Demand", "MendResult", "MendVerdict", "Problem"]

Link = tuple[Label, Label]


class MendVerdict(enum.Enum):
    """What is known about the cheapest links."""

    #: The links reach the goal, and nothing cheaper does.
    OPTIMAL = "optimal"
    #: The links reach the goal; whether something cheaper does is not known.
    FEASIBLE = "feasible"
    #: A limit came before any choice that reaches the goal.
    UNDECIDED = "undecided"
    #: No choice of these candidates reaches the goal.
    IMPOSSIBLE = "impossible"


@dataclass(frozen=True, slots=True)
class Demand:
    """A violation of the network before mending, which every choice has to break.

    ``goal`` says of which condition in words; M is empty for (r,s)-robustness.
    """

    goal: str
    M: frozenset[Label]
    S1: frozenset[Label]
    S2: frozenset[Label]


@dataclass(frozen=True, slots=True)
class Problem:
    """The question behind a result, in ids: what a certificate of it speaks about.

    Attributes
    ----------
    graph : Digraph
        To which links are added; of :func:`robustness.thin` the nodes without any link.
    actions : Actions
    parts : tuple of Part
    chosen : frozenset of int or None
        Indices of the chosen actions.
    least : int or None
        The lower bound in units of the actions' scale; None when no choice reaches the goal.
    pairs : tuple of (Part, Sets)
        Violations of ``graph``; the bound follows from them and from the covers.
    covers : tuple of (Part, starts, cover)
        Covers of its links with their starts, all masks of nodes (:mod:`robustness.mending.covers`).
    is_up_to_swapping : bool
        Whether the bound needs images of the pairs under swaps of nodes as well (:mod:`robustness.mending.completing`).
    """

    graph: Digraph
    actions: Actions
    parts: tuple[Part, ...]
    chosen: frozenset[int] | None
    least: int | None
    pairs: tuple[tuple[Part, Sets], ...]
    covers: tuple[tuple[Part, tuple[int, ...], tuple[int, ...]], ...] = ()
    is_up_to_swapping: bool = False


@dataclass(frozen=True, slots=True, repr=False)
class MendResult(Shown):
    """The cheapest links that reach a goal, as far as they are known.

    Attributes
    ----------
    verdict : MendVerdict
    goals : tuple of Goal
    links : tuple of pairs of labels
        The links to add (of :func:`robustness.thin`: to keep), in natural order; with ``one_way`` an arc each.
    dropped : tuple of pairs of labels
        Of :func:`robustness.thin`: the links that can go.
    thinned : bool
        Whether this answers :func:`robustness.thin`.
    cost : int or float or None
        What ``links`` cost together; None without any.
    lower_bound : int or float
        No choice that reaches the goal costs less; proven.
    graph : Digraph
        The network with the links; the network as it was when there are none.
    before : Digraph
        The network as it was.
    demands : tuple of Demand
        The violations from which the lower bound follows.
    witness : Demand or None
        When the goal is out of reach: what no candidate breaks. None when it is the constraints together that rule
        every choice out.
    one_way : bool
    reason : str
        Why nothing more is known, empty otherwise.
    problem : Problem or None
        The question in ids, for :func:`robustness.mending.certify_mending`.
    seconds : float
    certify : callable or None
        What makes :attr:`certificate`.
    """

    verdict: MendVerdict
    goals: tuple[Goal, ...]
    links: tuple[Link, ...]
    cost: int | float | None
    lower_bound: int | float
    graph: Digraph
    before: Digraph
    dropped: tuple[Link, ...] = ()
    demands: tuple[Demand, ...] = field(default=(), repr=False)
    witness: Demand | None = None
    thinned: bool = False
    one_way: bool = False
    reason: str = ""
    seconds: float = field(default=0.0, compare=False)
    problem: Problem | None = field(default=None, repr=False, compare=False)
    certify: Callable[[MendResult], bytes | None] | None = field(default=None, repr=False, compare=False)

    @property
    def certificate(self) -> bytes | None:
        """A certificate of the links and of the bound, verified by the kernel; None when there is no evidence.

        Made anew whenever it is asked for, without any limit; :func:`robustness.mending.certify_mending` takes limits.
        """
        return None if self.certify is None else self.certify(self)

    def __bool__(self) -> bool:
        raise TypeError("a MendResult has no truth value: compare .verdict")

    @property
    def goal(self) -> str:
        """The goals in words."""
        return " and ".join(map(str, self.goals))

    def pictured(self) -> GraphLike | None:
        """Return the mended network."""
        return self.graph

    def summary(self) -> str:
        """Return the answer in one sentence."""
        if self.verdict is MendVerdict.IMPOSSIBLE and self.problem is not None and self.problem.least is not None:
            return f"impossible: nothing within the budget reaches the goal, {self.goal}"
        if self.verdict is MendVerdict.IMPOSSIBLE:
            return f"impossible: no choice of these links reaches the goal, {self.goal}"
        if self.verdict is MendVerdict.UNDECIDED:
            return f"undecided: no links that reach the goal, {self.goal}; they cost at least {self.lower_bound}"
        what = f"{counted(len(self.links), 'link')}, cost {self.cost}"
        if self.thinned:
            stay = counted(len(self.links), "link stays", "links stay")
            what = f"{counted(len(self.dropped), 'link')} can go, {stay} at cost {self.cost}"
        if self.verdict is MendVerdict.OPTIMAL and not (self.links or self.dropped):
            return f"optimal: the network reaches the goal, {self.goal}, as it is; no link is needed"
        if self.verdict is MendVerdict.OPTIMAL:
            return f"optimal: {what}; nothing cheaper reaches the goal, {self.goal}"
        return f"feasible: {what}; at least {self.lower_bound} is needed for the goal, {self.goal}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return the links and the bound, as rows of a name and a text."""
        spelled = Spelling(self.before.labels)
        arrow = "->" if self.one_way else "--"
        links = ", ".join(f"{spelled(u)} {arrow} {spelled(v)}" for u, v in self.links)
        covers = len(self.problem.covers) if self.problem is not None else 0
        behind = counted(len(self.demands), "violation") + (f" and {counted(covers, 'cover')}" if covers else "")
        gone = ", ".join(f"{spelled(u)} {arrow} {spelled(v)}" for u, v in self.dropped)
        dropped = [("links that can go", gone)] if gone else []
        return [
            *dropped,
            ("links that stay" if self.thinned else "links", links or "none"),
            ("lower bound", f"{self.lower_bound}, from {behind}"),
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values."""

        def sets(demand: Demand) -> dict[str, Any]:
            sides = {name: _ordered(getattr(demand, name)) for name in ("M", "S1", "S2")}
            return {"goal": demand.goal, **sides}

        return {
            "verdict": self.verdict.value,
            "goal": self.goal,
            "links": [list(link) for link in self.links],
            "dropped": [list(link) for link in self.dropped],
            "one_way": self.one_way,
            "cost": self.cost,
            "lower_bound": self.lower_bound,
            "witness": None if self.witness is None else sets(self.witness),
            "demands": len(self.demands),
            "reason": self.reason,
            "seconds": round(self.seconds, 6),
        }


def _ordered(labels: frozenset[Hashable]) -> list[Any]:
    return sorted(labels, key=natural_key)
