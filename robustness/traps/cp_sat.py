r"""The question as a pure 0-1 programme, solved by OR-tools' CP-SAT: the independent second opinion.

For every node i and side k: ``a_ik``, i is a normal node of side k; ``m_ik``, i is malicious and inside side k. With
``k_i = max(0, d_i - f)``::

    a_i1 + a_i2 + (m_i1 + m_i2, or with two faces m_i1 = m_i2) <= 1        every i
    sum of a_ik >= 1                                                       both k
    sum over j in N_i of (a_jk + m_jk) >= k_i a_ik                         every i, k
    sum of m_i <= f            (total),  or for every i that is not malicious
    sum over j in N_i of m_j <= f + (d_i - f) m_i                          (local)

with ``m_i = m_i1 + m_i2``, or their common value. These are the definitions of :mod:`robustness.traps.question` row by
row, and all data are small integers. What is trusted is CP-SAT's word that the programme is infeasible; a solution
is re-checked.
"""

from __future__ import annotations

from typing import Any

from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.solver_calls import solve_within
from robustness.traps.question import Question, Sets, TrapAnswer

__all__ = ["decide"]


def decide(graph: Digraph, question: Question, limits: Limits) -> TrapAnswer:
    """Return whether a solution exists, one, and the solver's status; None past the deadline or when it gave up."""
    from ortools.sat.python import cp_model

    if limits.expired():
        return TrapAnswer.undecided("the time limit was reached")
    model = cp_model.CpModel()
    normal, inside, malicious = _variables(model, graph, question)
    for i, degree in enumerate(graph.in_degrees.tolist()):
        heard = graph.in_neighbours(i).tolist()
        need = max(0, degree - question.f)
        for k in range(2):
            model.add(sum(normal[j][k] + inside[j][k] for j in heard) >= need * normal[i][k])
        if question.local and degree > question.f:
            model.add(sum(malicious[j] for j in heard) <= question.f + (degree - question.f) * malicious[i])
    if not question.local:
        model.add(sum(malicious) <= question.f)
    for k in range(2):
        model.add_bool_or([sides[k] for sides in normal])
    outcome = solve_within(model, limits)
    stats = {"solver_status": outcome.said}
    if outcome.is_infeasible:
        return TrapAnswer(False, stats=stats)
    if not outcome.has_solution:
        return TrapAnswer.undecided("the solver stopped without an answer", stats)
    bad = frozenset(i for i, each in enumerate(malicious) if outcome.value(each))
    S1, S2 = (
        frozenset(
            i for i in range(graph.n)
            if outcome.value(normal[i][k]) or (not question.two_faces and outcome.value(inside[i][k]))
        )
        for k in range(2)
    )  # fmt: skip
    return TrapAnswer(True, Sets(bad, S1, S2), stats=stats)


def _variables(model: Any, graph: Digraph, question: Question) -> tuple[list[Any], list[Any], list[Any]]:
    """Return a_ik, m_ik and m_i, with at most one role for every node and the sides' symmetry broken at one node."""
    normal = [[model.new_bool_var("") for _ in range(2)] for _ in range(graph.n)]
    if question.two_faces:
        malicious: list[Any] = [model.new_bool_var("") for _ in range(graph.n)]
        inside = [[each, each] for each in malicious]
    else:
        inside = [[model.new_bool_var("") for _ in range(2)] for _ in range(graph.n)]
        malicious = [one + two for one, two in inside]
    for roles, each in zip(normal, inside, strict=True):
        model.add_at_most_one([*roles, each[0]] if question.two_faces else [*roles, *each])
    if graph.n:
        model.add_implication(normal[int(graph.in_degrees.argmax())][1], False)
    return normal, inside, malicious
