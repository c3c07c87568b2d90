"""Mixed-integer programming after Usevitch and Panagou (2020): branch and bound on linear relaxations.

The programme, its proof and what is trusted: :mod:`robustness.decision.algorithms.violation_model`. A pair is searched
among the feasible solutions of the (r,s) programme; r* and s_max(r) are also minima of their own programmes.
"""

from __future__ import annotations

from robustness.answers import Answer
from robustness.decision.algorithms import model_solving
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits
from robustness.results import Bounds

__all__ = ["SOLVERS", "decide", "largest_r", "largest_s"]

#: The solvers by the option's values, with their MathOpt names.
SOLVERS = {"highs": "HIGHS", "scip": "GSCIP"}


def decide(
    graph: Digraph, r: int, s: int, limits: Limits, *, solver: str = "highs", pair_counting: bool = True
) -> Answer:
    """Decide (r,s)-robustness of a digraph by mixed-integer linear programming.

    Parameters
    ----------
    graph : Digraph
        Any digraph with at least two nodes.
    r, s : int
        ``r >= 1`` and ``1 <= s <= n``.
    limits : Limits
        The solver gets what is left of the time, ``jobs`` threads (SCIP only) and the seed.
    solver : str
        ``"highs"`` or ``"scip"``. Neither wins everywhere: r = 10 on G(40,.5) takes HiGHS 6 s and SCIP 10 s to refute,
        r = 8 on G(30,.5) 3.7 s and 2.5 s, (3,4) on G(20,.5) 1.3 s and 0.3 s.
    pair_counting : bool
        Whether pairs of nodes that pair counting excludes become rows; it never changes the verdict.

    Raises
    ------
    InvalidParameter
        For another solver.

    >>> import networkx as nx
    >>> decide(Digraph.from_networkx(nx.cycle_graph(6)), 2, 1, Limits()).verdict
    <Verdict.NOT_ROBUST: 'not-robust'>
    """
    return model_solving.decide(graph, r, s, limits, _mathopt_name(solver), pair_counting=pair_counting)


def largest_s(graph: Digraph, r: int, limits: Limits, *, solver: str = "highs", pair_counting: bool = True) -> Bounds:
    """Return bounds on s_max(r) (equal when the solver finished) by minimising ``|X_S1| + |X_S2|``.

    Parameters are those of :func:`decide`.

    >>> import networkx as nx
    >>> bounds = largest_s(Digraph.from_networkx(nx.cycle_graph(6)), 1, Limits())
    >>> bounds.lower.value, bounds.upper.value
    (4, 4)
    """
    return model_solving.largest_s(graph, r, limits, _mathopt_name(solver), pair_counting=pair_counting)


def largest_r(graph: Digraph, limits: Limits, *, solver: str = "highs") -> Bounds:
    """Return bounds on r* (equal when the solver finished) by the programme of Usevitch and Panagou.

    Parameters are those of :func:`decide`.

    >>> import networkx as nx
    >>> bounds = largest_r(Digraph.from_networkx(nx.wheel_graph(6)), Limits())
    >>> bounds.lower.value, bounds.upper.value
    (2, 2)
    """
    return model_solving.largest_r(graph, limits, _mathopt_name(solver))


def _mathopt_name(solver: str) -> str:
    if solver not in SOLVERS:
        raise InvalidParameter(f"solver is one of {', '.join(SOLVERS)}, not {solver!r}")
    return SOLVERS[solver]
