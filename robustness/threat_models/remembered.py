"""Networks that change, decided exactly: is there a triple that holds everything remembered apart at every step?

The definition is Theorem C (b) of docs/theorems.md. With memory tau, delays of at most b and updates at most g steps
apart, a vehicle that updates at step k uses the links ``H[k] = E[k - (tau - b)] | ... | E[k]``, and when all delays are
b exactly these. A node i of S_r is *active* at k when it hears in H[k] at least f + 1 nodes outside ``S_r | M``. A
periodic network reaches agreement against f if and only if there is no triple (M, S1, S2), as in a trap, of which
nobody is ever active at g consecutive steps.

As a 0-1 programme, over the steps k of one period, with ``a_ir`` (i is in S_r), ``m_i`` (i is malicious) and ``c_ik``
(i is not active at k; it is 1 for g = 1)::

    a_i1 + a_i2 + m_i <= 1                                                 every i
    sum of a_ir >= 1                                                       both r
    sum over j in H_i[k] of (a_jr + m_j) >= (d_i[k] - f) (a_ir + c_ik - 1) every i, r, k with d_i[k] > f
    sum over k in W of c_ik >= a_i1 + a_i2                                 every i, every W of g consecutive steps
    sum of m_i <= f   (total),  or for every i that is not malicious
    sum over j in N_i of m_j <= f + (d_i - f) m_i                          (local; N_i in the union of all steps)

What is trusted is CP-SAT's word that the programme has no solution; a solution is re-checked against the definition.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robustness.digraph import Digraph
from robustness.errors import InternalError
from robustness.limits import Limits
from robustness.solver_calls import solve_within
from robustness.spelled import counted
from robustness.time_varying import TimeVaryingGraph
from robustness.traps.question import Question, Sets, obeys_bound

__all__ = ["Remembered", "find_in_all", "holds_apart", "idle_steps"]

#: Programmes with more arcs than this, over all steps together, are not handed to the solver.
_MOST_ARCS = 200_000


@dataclass(frozen=True, slots=True)
class Remembered:
    """The links in use at every step, and how far updates may lie apart.

    Attributes
    ----------
    union : Digraph
        All links that ever occur.
    before : tuple of Digraph
        ``H[k]`` of the steps before everything repeats; none for a periodic network, of which later steps hear more.
    period : tuple of Digraph
        ``H[k]`` of one period.
    gap : int
        g.
    """

    union: Digraph
    before: tuple[Digraph, ...]
    period: tuple[Digraph, ...]
    gap: int

    @classmethod
    def of(cls, sequence: TimeVaryingGraph, tau: int, delay: int, gap: int) -> Remembered:
        """Return what is remembered of an (eventually) periodic sequence, ``tau >= delay``."""
        length = tau - delay + 1
        # From this step on the windows lie inside the part that repeats. Without a prefix every window counts: the
        # first ones, which are shorter, hear less.
        first = sequence.prefix + length - 1 if sequence.prefix else 0
        before = tuple(sequence.union(max(0, k - length + 1), min(length, k + 1)) for k in range(first))
        start = sequence.prefix
        period = tuple(sequence.union(start + k, length) for k in range(sequence.period or 0))
        return cls(sequence.union(0, len(sequence)), before, period, gap)

    @property
    def arcs(self) -> int:
        """The arcs of all steps together."""
        return sum(each.arc_count for each in (*self.before, *self.period))


#: Why a question is open, however long one looks.
BEFORE_THE_PERIOD = "the steps before the period are not held apart by what holds the period apart"


def find_in_all(remembered: Remembered, question: Question, limits: Limits) -> tuple[bool | None, Sets | None, str]:
    """Return whether a triple exists (None: a limit), a re-checked one, and what decided.

    A triple is asked to hold apart the steps before the period too, at each of them; one that holds the period apart
    alone decides nothing (None), unless there is no step before.
    """
    if remembered.arcs > _MOST_ARCS:
        return None, None, f"{counted(remembered.arcs, 'arc')} of all steps together are too many for the solver"
    exists, sets = _solve(remembered, question, limits, with_before=False)
    if exists and remembered.before:
        exists, sets = _solve(remembered, question, limits, with_before=True)
        if exists is False:
            return None, None, BEFORE_THE_PERIOD
    if exists is None:
        return None, None, "the time limit was reached"
    if exists and (sets is None or not holds_apart(remembered, question, sets)):
        raise InternalError(f"the solver returned {sets}, which does not solve {question}: please report")
    return exists, sets, "a 0-1 programme over all steps (cp-sat)"


def idle_steps(graphs: Sequence[Digraph], f: int, side: frozenset[int], M: frozenset[int], node: int) -> list[bool]:
    """Return for every graph whether this node of a side hears at most f nodes outside the side and M."""
    inside = side | M
    return [sum(j not in inside for j in graph.in_neighbours(node).tolist()) <= f for graph in graphs]


def holds_apart(remembered: Remembered, question: Question, sets: Sets) -> bool:
    """Return whether nobody of S1 and S2 is ever active at g consecutive steps: the definition, nothing else."""
    M, S1, S2 = sets
    if not S1 or not S2 or S1 & S2 or M & (S1 | S2):
        return False
    if not obeys_bound(remembered.union, M, question.f, local=question.local):
        return False
    for side in (S1, S2):
        for i in side:
            if not all(idle_steps(remembered.before, question.f, side, M, i)):
                return False
            idle = idle_steps(remembered.period, question.f, side, M, i)
            count = len(idle)
            if not all(any(idle[(k + m) % count] for m in range(remembered.gap)) for k in range(count)):
                return False
    return True


def _solve(
    remembered: Remembered, question: Question, limits: Limits, *, with_before: bool
) -> tuple[bool | None, Sets | None]:
    from ortools.sat.python import cp_model

    if limits.expired():
        return None, None
    f, n = question.f, remembered.union.n
    model = cp_model.CpModel()
    member = [[model.new_bool_var("") for _ in range(2)] for _ in range(n)]
    bad = [model.new_bool_var("") for _ in range(n)]
    for roles, each in zip(member, bad, strict=True):
        model.add_at_most_one([*roles, each])
    for r in range(2):
        model.add_bool_or([roles[r] for roles in member])
    if not question.local:
        model.add(sum(bad) <= f)
    for i, degree in enumerate(remembered.union.in_degrees.tolist()):
        if question.local and degree > f:
            heard = remembered.union.in_neighbours(i).tolist()
            model.add(sum(bad[j] for j in heard) <= f + (degree - f) * bad[i])
        _hold(model, remembered, f, i, member, bad)
        if with_before:
            for graph in remembered.before:
                _require(model, graph, f, i, member, bad, 1)
    outcome = solve_within(model, limits)
    if outcome.is_infeasible:
        return False, None
    if not outcome.has_solution:
        return None, None
    M = frozenset(i for i in range(n) if outcome.value(bad[i]))
    S1, S2 = (frozenset(i for i in range(n) if outcome.value(member[i][r])) for r in range(2))
    return True, Sets(M, S1, S2)


def _hold(model: Any, remembered: Remembered, f: int, i: int, member: Any, bad: Any) -> None:
    """Add the rows of the period for one node."""
    count = len(remembered.period)
    if remembered.gap == 1:
        for graph in remembered.period:
            _require(model, graph, f, i, member, bad, 1)
        return
    idle = [model.new_bool_var("") for _ in range(count)]
    for graph, each in zip(remembered.period, idle, strict=True):
        _require(model, graph, f, i, member, bad, each)
    for k in range(count):
        window = {(k + m) % count for m in range(remembered.gap)}
        model.add(sum(idle[m] for m in window) >= member[i][0] + member[i][1])


def _require(model: Any, graph: Digraph, f: int, i: int, member: Any, bad: Any, idle: Any) -> None:
    heard = graph.in_neighbours(i).tolist()
    need = len(heard) - f
    if need > 0:
        for r in range(2):
            model.add(sum(member[j][r] + bad[j] for j in heard) >= need * (member[i][r] + idle - 1))
