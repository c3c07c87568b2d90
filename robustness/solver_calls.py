"""Calls of CP-SAT within limits, and what is believed of a call that was stopped.

A call is *stopped* when it was asked to stop, or a limit passed before it returned. Its solutions count, since callers
check them. That the model is infeasible, or a solution optimal, and the bound that the call ends with do not: a worker
that is stopped in the middle of its work may report them wrongly, and releases of CP-SAT did. A bound that was told
while nothing had been stopped counts.

A solver looks at its clock now and then only. Past its limit by more than a grace period it is asked to stop and left
alone: nothing is claimed then.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

from robustness.errors import InternalError
from robustness.limits import Limits
from robustness.waiting import GRACE, in_a_thread

__all__ = ["Outcome", "has_passed", "solve_within"]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a call came to, as far as it is believed."""

    #: The solver's own word, in small letters; "abandoned" when it did not return.
    said: str
    is_infeasible: bool = False
    has_solution: bool = False
    #: Whether the solution is proven to be optimal.
    is_optimal: bool = False
    #: No solution of a problem that minimises is below it.
    bound: float = -math.inf
    solver: Any = None

    def value(self, variable: Any) -> int:
        """Return the variable in the solution."""
        return int(self.solver.value(variable))


class _Abandoned(Exception):
    """The solver did not stop in time."""


def has_passed(limits: Limits, moment: float) -> bool:
    """Return whether the limit had passed at this moment of the monotonic clock."""
    return limits.deadline is not None and moment >= limits.deadline


def solve_within(model: Any, limits: Limits, effort: float | None = None, *, relaxed: bool | None = None) -> Outcome:
    """Return what the solver says about the model, as far as it is believed: the rule is in the module.

    Parameters
    ----------
    model : CpModel
        One with an objective minimises it.
    limits : Limits
        Ctrl-C is served while the solver runs, and stops it.
    effort : float or None
        Bounds the work in the solver's own units, which are counted and not timed.
    relaxed : bool or None
        True: more of the work goes into the linear relaxation: better bounds, for models whose rows are sums, rather
        than solutions. False: none does, for questions without an objective.

    Raises
    ------
    InternalError
        When the solver fails, or refuses the model.
    """
    from ortools.sat.python import cp_model

    solver = cp_model.CpSolver()
    solver.parameters.num_workers = limits.jobs
    solver.parameters.random_seed = limits.seed % (1 << 31)
    solver.parameters.catch_sigint_signal = False
    if limits.deadline is not None:
        solver.parameters.max_time_in_seconds = max(limits.seconds_left(), 1e-3)
    if effort is not None:
        solver.parameters.max_deterministic_time = effort
    if relaxed is not None:
        solver.parameters.linearization_level = 2 if relaxed else 0
    told = [-math.inf]

    def note(bound: float) -> None:
        if not has_passed(limits, time.monotonic()):
            told.append(bound)

    def work() -> tuple[Any, float]:
        try:
            return solver.solve(model), time.monotonic()
        except Exception as problem:
            raise InternalError(f"the solver failed: {problem}: please report") from problem

    def look() -> None:
        if has_passed(limits, time.monotonic() - GRACE):
            raise _Abandoned

    solver.best_bound_callback = note
    try:
        status, returned = in_a_thread("robustness-cp-sat", work, solver.stop_search, look)
    except _Abandoned:
        return Outcome("abandoned", bound=max(told))
    if status == cp_model.MODEL_INVALID:
        raise InternalError("CP-SAT refused a model: please report")
    stopped = has_passed(limits, returned) or (effort is not None and solver.deterministic_time >= effort)
    return Outcome(
        solver.status_name(status).lower(),
        is_infeasible=status == cp_model.INFEASIBLE and not stopped,
        has_solution=status in (cp_model.OPTIMAL, cp_model.FEASIBLE),
        is_optimal=status == cp_model.OPTIMAL and not stopped,
        bound=max(told) if stopped else max(*told, solver.best_objective_bound),
        solver=solver,
    )
