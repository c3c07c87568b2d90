"""The most robust network that a budget buys: goals one above the other, each asked within the budget."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits, Progress
from robustness.mending.front import mend
from robustness.mending.goal import Goal
from robustness.mending.results import MendResult, MendVerdict
from robustness.showing import Shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["BudgetResult", "best_within"]

_REACHED = (MendVerdict.OPTIMAL, MendVerdict.FEASIBLE)


@dataclass(frozen=True, slots=True, repr=False)
class BudgetResult(Shown):
    """What a budget buys.

    Attributes
    ----------
    best : MendResult or None
        The links for the highest goal that is known to be affordable; None when none is.
    missed : MendResult or None
        The next goal, which is not, or not known to be; None when there is none, or the work was stopped before it.
    is_exact : bool
        Whether it is proven that the budget buys nothing more.
    """

    best: MendResult | None
    missed: MendResult | None
    is_exact: bool

    def __bool__(self) -> bool:
        raise TypeError("a BudgetResult has no truth value: compare .is_exact")

    def summary(self) -> str:
        """Return the answer in one sentence."""
        bought = "nothing" if self.best is None else f"{_as_noun(self.best)}, for {self.best.cost}"
        if self.missed is None:
            more = "there is nothing more to reach" if self.is_exact else "whether it buys more was not decided"
            return f"the budget buys {bought}; {more}"
        if self.is_exact:
            return f"the budget buys {bought}; it does not buy {_as_noun(self.missed)}"
        return f"the budget buys {bought}; whether it buys {_as_noun(self.missed)} was not decided within the limit"

    def pictured(self) -> GraphLike | None:
        """Return the mended network, where the budget buys one."""
        return None if self.best is None else self.best.graph

    def plot(
        self,
        G: GraphLike | None = None,
        *,
        pos: Mapping[Hashable, Sequence[float]] | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw the best network with the links that were bought, as :meth:`MendResult.plot` does."""
        if self.best is None:
            raise InvalidParameter("the budget buys nothing, so there is no mended network to draw")
        return self.best.plot(G, pos=pos, ax=ax)

    def evidence(self) -> list[tuple[str, str]]:
        """Return the links that are bought and the bound, as rows of a name and a text."""
        return [] if self.best is None else self.best.evidence()

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values."""
        best, missed = (None if found is None else found.as_dict() for found in (self.best, self.missed))
        return {"best": best, "missed": missed, "is_exact": self.is_exact}


def best_within(
    G: GraphLike,
    budget: float,
    *,
    model: str | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_improvement: Callable[[BudgetResult], None] | None = None,
    **constraints: Any,
) -> BudgetResult:
    """Return links within a budget that make G as robust as links within it can, exactly.

    Parameters
    ----------
    G : networkx graph or Digraph
    budget : number
        What the links may cost together.
    model : str, optional
        As robust as can be means: survives the most malicious nodes under this threat model. Unless given: the
        greatest r, and for it the greatest s, of (r,s)-robustness.
    time_limit, jobs, seed, progress
        As for :func:`robustness.mend`, for all goals together.
    on_improvement : callable, optional
        Called with what is known to be bought, as a result that is not exact, each time that is more.
    **constraints
        ``candidates``, ``cost``, ``forbid``, ``mandatory``, ``max_in_degree`` and ``one_way`` of
        :func:`robustness.mend`.

    Returns
    -------
    BudgetResult
        ``best`` ends with the first links within the budget that reach its goal: ask :func:`robustness.mend` for the
        cheapest.

    Raises
    ------
    InvalidParameter
        As :func:`robustness.mend`.

    Notes
    -----
    (r,s)-robustness implies (r-1,s)- and (r,s-1)-robustness, and who survives f survives f - 1. So the first goal of
    the ladder that is out of reach ends it, and a rung costs one call of :func:`robustness.mend`.

    >>> import networkx as nx
    >>> print(best_within(nx.path_graph(5), 3).summary())
    the budget buys (2,2)-robust, for 3; it does not buy (2,3)-robust
    """
    graph = as_digraph(G)
    if budget is None:
        raise InvalidParameter("a budget is a finite number of at least 0, not None")
    limits = Limits.of(time_limit, jobs, seed, progress)
    best: MendResult | None = None
    missed: MendResult | None = None
    is_exact = True
    for climb in (_first_climb, _second_climb):
        goal = climb(best, model, graph.n)
        while goal is not None:
            found = _within(graph, goal, budget, constraints, limits)
            if found.verdict not in _REACHED:
                missed = found
                is_exact = is_exact and found.verdict is MendVerdict.IMPOSSIBLE
                break
            best, goal = found, climb(found, model, graph.n)
            if on_improvement is not None:
                on_improvement(BudgetResult(best, None, is_exact=False))
    return BudgetResult(best, missed, is_exact)


def _as_noun(found: MendResult) -> str:
    """Return the one goal of a result as what can be bought."""
    return found.goal.replace("survives", "the survival of")


def _first_climb(best: MendResult | None, model: str | None, n: int) -> Goal | None:
    """Return the next goal: r, or how many malicious nodes are survived, one higher."""
    if model is not None:
        f = -1 if best is None else best.goals[0].survive
        return Goal(survive=f + 1, model=model) if f is not None and f + 1 < n else None
    r = 0 if best is None else best.goals[0].r
    return Goal(r + 1) if r is not None and r < max(1, largest_conceivable_r(n)) else None


def _second_climb(best: MendResult | None, model: str | None, n: int) -> Goal | None:
    """Return the next goal: for the greatest r, s one higher."""
    if model is not None or best is None or best.goals[0].s >= n:
        return None
    return Goal(best.goals[0].r, best.goals[0].s + 1)


def _within(graph: Digraph, goal: Goal, budget: float, constraints: dict[str, Any], limits: Limits) -> MendResult:
    effort = limits.keywords()
    return mend(
        graph,
        goal,
        budget=budget,
        any_choice=True,
        time_limit=effort["time_limit"],
        jobs=limits.jobs,
        seed=limits.seed,
        progress=limits.progress,
        **constraints,
    )
