"""Running a violation model on a MathOpt solver: limits, interruption, and what every outcome means.

The solver runs in a worker thread and the caller waits for it in short steps, so that Ctrl-C is served at once
(Python runs signal handlers in the main thread, between byte codes). CP-SAT is then interrupted. HiGHS and SCIP
cannot be, through MathOpt: HiGHS ignores the request and SCIP's handler writes errors to stderr. Their daemon thread
is left to its time limit, or to the end of the process, which does not wait for it.
"""

from __future__ import annotations

import math
import time
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from robustness.answers import Answer, Verdict
from robustness.decision.algorithms.violation_model import (
    ViolationModel,
    all_pairs,
    compatible_pairs,
    largest_r_model,
    pair_model,
)
from robustness.definitions import is_violation, r_reachable_ids
from robustness.digraph import Digraph
from robustness.errors import InternalError, Undecided
from robustness.evidence import Exhausted, Pair
from robustness.limits import Limits, Progress
from robustness.results import Bound, Bounds, Witness
from robustness.solver_calls import has_passed
from robustness.waiting import GRACE, in_a_thread

if TYPE_CHECKING:
    from ortools.math_opt.python import mathopt

__all__ = ["decide", "largest_r", "largest_s", "verdict_of"]

#: Three years: what the solvers are told for longer limits, which would overflow them.
_LONGEST = 1e8
#: A dual bound may exceed the integer it stands for by the solvers' tolerance (1e-6, times the size of the bound).
_SLACK = 1e-3


def decide(graph: Digraph, r: int, s: int, limits: Limits, solver: str, *, pair_counting: bool) -> Answer:
    """Decide (r,s)-robustness with the named MathOpt solver.

    The model: :mod:`~robustness.decision.algorithms.violation_model`.
    """
    stats: dict[str, Any] = {"solver": solver.lower()}
    try:
        compatible = compatible_pairs(graph, r, s, limits) if pair_counting else all_pairs(graph.n)
        if not any(compatible):
            return Answer(Exhausted(), stats | {"solver_status": "not needed: pair counting"})
        problem = pair_model(graph, r, s, compatible)
        result, was_stopped = _solve(problem.model, solver, limits)
    except Undecided as limit:
        return Answer.undecided(str(limit), stats)
    reason = result.termination.reason
    stats |= {"solver_status": reason.name.lower(), "nodes": result.solve_stats.node_count}
    verdict = verdict_of(reason)
    if verdict is Verdict.UNDECIDED:
        return Answer.undecided(_limit_text(result.termination), stats)
    if verdict is Verdict.ROBUST and was_stopped:
        return Answer.undecided(f"{solver} answered after its limit, which proves nothing", stats)
    if verdict is Verdict.ROBUST:
        return Answer(Exhausted(), stats)
    pair = _best_pair(problem, result)
    if pair is None or not is_violation(graph, pair.first, pair.second, r, s):
        return Answer.undecided(f"{solver} returned no pair that is a violation: numerical tolerances", stats)
    return Answer.violated_by(pair, stats)


def verdict_of(reason: mathopt.TerminationReason) -> Verdict:
    """Return what the end of a search for a violating pair says; NOT_ROBUST still needs its pair checked.

    Every variable is bounded, so "infeasible or unbounded" is infeasible, and "unbounded" is an error of the solver.
    """
    from ortools.math_opt.python.mathopt import TerminationReason as Reason

    match reason:
        case Reason.OPTIMAL | Reason.FEASIBLE:
            return Verdict.NOT_ROBUST
        case Reason.INFEASIBLE | Reason.INFEASIBLE_OR_UNBOUNDED:
            return Verdict.ROBUST
        case Reason.UNBOUNDED | Reason.IMPRECISE | Reason.NO_SOLUTION_FOUND:
            return Verdict.UNDECIDED
        case Reason.NUMERICAL_ERROR | Reason.OTHER_ERROR:
            return Verdict.UNDECIDED
        case _:  # A reason that a later OR-tools adds claims nothing here.
            return Verdict.UNDECIDED


def largest_s(graph: Digraph, r: int, limits: Limits, solver: str, *, pair_counting: bool) -> Bounds:
    """Return bounds on s_max(r), equal when the named solver finished: the least ``|X_S1| + |X_S2|``."""
    nothing = Bounds(Bound(0, "nothing proven"), Bound(graph.n, "s_max(r) <= n"))
    try:
        compatible = compatible_pairs(graph, r, graph.n, limits) if pair_counting else all_pairs(graph.n)
        problem = pair_model(graph, r, None, compatible)
        result, was_stopped = _solve(problem.model, solver, limits)
    except Undecided:
        return nothing
    if verdict_of(result.termination.reason) is Verdict.ROBUST and not was_stopped:
        return Bounds(Bound(graph.n, f"{solver}: no violating pair for any s"), nothing.upper)
    upper, pair = nothing.upper, _best_pair(problem, result)
    if pair is not None and is_violation(graph, pair.first, pair.second, r, graph.n):
        exempt = sum(len(r_reachable_ids(graph, side, r)) for side in pair)
        upper = Bound(exempt, "violating pair", Witness.of(graph, pair))
    return Bounds(nothing.lower if was_stopped else _lower(result, solver, upper.value), upper)


def largest_r(graph: Digraph, limits: Limits, solver: str) -> Bounds:
    r"""Return bounds on r*, equal when the named solver finished: the least ``max |N_i \ S_k|`` over all pairs."""
    if graph.n < 2:
        return Bounds.by_convention(graph.n)
    nothing = Bounds.trivial(graph)
    problem = largest_r_model(graph)
    try:
        result, was_stopped = _solve(problem.model, solver, limits)
    except Undecided:
        return nothing
    upper, pair = nothing.upper, _best_pair(problem, result)
    if pair is not None and pair.first and pair.second and not pair.first & pair.second:
        most = max(sum(j not in side for j in graph.in_neighbours(i).tolist()) for side in pair for i in side)
        upper = min(upper, Bound(most, "violating pair", Witness.of(graph, pair)), key=lambda bound: bound.value)
    return Bounds(nothing.lower if was_stopped else _lower(result, solver, upper.value), upper)


def _lower(result: mathopt.SolveResult, solver: str, upper: int) -> Bound:
    """Return the proven lower bound on an integer minimum, rounded up from the solver's dual bound."""
    dual = result.termination.objective_bounds.dual_bound
    if not math.isfinite(dual) or dual <= 0:
        return Bound(0, "nothing proven")
    return Bound(min(upper, math.ceil(dual - _SLACK)), f"{solver}: dual bound")


def _best_pair(problem: ViolationModel, result: mathopt.SolveResult) -> Pair | None:
    for solution in result.solutions:
        if solution.primal_solution is not None:
            return problem.pair(solution.primal_solution.variable_values)
    return None


def _limit_text(termination: mathopt.Termination) -> str:
    limit = f" ({termination.limit.name.lower()})" if termination.limit is not None else ""
    detail = f": {termination.detail}" if termination.detail else ""
    return f"the solver stopped with {termination.reason.name.lower()}{limit}{detail}"


def _solve(model: mathopt.Model, solver: str, limits: Limits) -> tuple[mathopt.SolveResult, bool]:
    """Run a solver in a worker thread until it answers, or raise Undecided soon after the deadline.

    Return also whether it is CP-SAT and was stopped: then only its solutions count (:mod:`robustness.solver_calls`).
    """
    from ortools.math_opt.python import mathopt
    from ortools.util.python.solve_interrupter import SolveInterrupter

    if limits.expired():
        raise Undecided("the time limit was reached: raise it")
    kind = mathopt.SolverType[solver]
    parameters = _parameters(kind, limits)
    interrupter = SolveInterrupter() if kind is mathopt.SolverType.CP_SAT else None
    started = time.monotonic()

    def look() -> None:
        if has_passed(limits, time.monotonic() - GRACE):
            raise Undecided(f"the time limit was reached and {solver} did not stop: raise the limit")
        if limits.progress is not None:
            limits.progress(Progress(0, f"{solver} is at work, {time.monotonic() - started:.0f} s"))

    def work() -> tuple[mathopt.SolveResult, bool]:
        try:
            result = mathopt.solve(model, kind, params=parameters, interrupter=interrupter)
        except Exception as problem:
            raise InternalError(f"{solver} failed ({problem}): please report, and use another algorithm") from problem
        return result, interrupter is not None and has_passed(limits, time.monotonic())

    stop = None if interrupter is None else interrupter.interrupt
    return in_a_thread(f"robustness-{solver.lower()}", work, stop, look)


def _parameters(kind: mathopt.SolverType, limits: Limits) -> mathopt.SolveParameters:
    from ortools.math_opt.python import mathopt

    seconds = limits.seconds_left()
    parameters = mathopt.SolveParameters(
        time_limit=None if math.isinf(seconds) else timedelta(seconds=min(seconds, _LONGEST)),
        # MathOpt refuses a number of threads for HiGHS, whose tree search uses one.
        threads=None if kind is mathopt.SolverType.HIGHS else limits.jobs,
        random_seed=limits.seed % (1 << 31),
    )
    # Ctrl-C belongs to Python.
    parameters.cp_sat.catch_sigint_signal = False
    parameters.gscip.bool_params["misc/catchctrlc"] = False
    return parameters
