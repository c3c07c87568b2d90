"""Constraint programming with clause learning: the violation model solved by OR-tools' CP-SAT.

The programme, its proof and what is trusted: :mod:`robustness.decision.algorithms.violation_model`. Through MathOpt it
is as fast as through CP-SAT's own interface (0.48 s and 0.43 s to refute r = 8 on G(30, .5)).
"""

from __future__ import annotations

from robustness.answers import Answer
from robustness.decision.algorithms import model_solving
from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.results import Bounds

__all__ = ["decide", "largest_r", "largest_s"]

_SOLVER = "CP_SAT"


def decide(graph: Digraph, r: int, s: int, limits: Limits, *, pair_counting: bool = True) -> Answer:
    """Decide (r,s)-robustness of a digraph by CP-SAT.

    Parameters
    ----------
    graph : Digraph
        Any digraph with at least two nodes.
    r, s : int
        ``r >= 1`` and ``1 <= s <= n``.
    limits : Limits
        The solver gets what is left of the time, ``jobs`` workers and the seed.
    pair_counting : bool
        Whether pairs of nodes that pair counting excludes become rows; it never changes the verdict.

    >>> import networkx as nx
    >>> decide(Digraph.from_networkx(nx.cycle_graph(6)), 2, 1, Limits()).verdict
    <Verdict.NOT_ROBUST: 'not-robust'>
    """
    return model_solving.decide(graph, r, s, limits, _SOLVER, pair_counting=pair_counting)


def largest_s(graph: Digraph, r: int, limits: Limits, *, pair_counting: bool = True) -> Bounds:
    """Return bounds on s_max(r) (equal when CP-SAT finished) by minimising ``|X_S1| + |X_S2|``.

    >>> import networkx as nx
    >>> bounds = largest_s(Digraph.from_networkx(nx.cycle_graph(6)), 1, Limits())
    >>> bounds.lower.value, bounds.upper.value
    (4, 4)
    """
    return model_solving.largest_s(graph, r, limits, _SOLVER, pair_counting=pair_counting)


def largest_r(graph: Digraph, limits: Limits) -> Bounds:
    """Return bounds on r* (equal when CP-SAT finished) by the programme of Usevitch and Panagou.

    >>> import networkx as nx
    >>> bounds = largest_r(Digraph.from_networkx(nx.wheel_graph(6)), Limits())
    >>> bounds.lower.value, bounds.upper.value
    (2, 2)
    """
    return model_solving.largest_r(graph, limits, _SOLVER)
