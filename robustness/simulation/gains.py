"""Gains and weights, and the condition under which the theory of second-order MSR rules applies.

Derivation. Let ``sigma_i[k]`` be the sum of the weights that vehicle i keeps. Eliminating the velocity from
``p[k+1] = p + T q + T²/2 u``, ``q[k+1] = q + T u``, ``u = -(L[k] p) - alpha q`` gives, row by row,

    p_i[k+2] = (2 - alpha_i T - T²/2 sigma_i[k+1]) p_i[k+1] + T²/2 sum_j a_ij[k+1] p_j[k+1]
             + (alpha_i T - 1 - T²/2 sigma_i[k]) p_i[k]     + T²/2 sum_j a_ij[k] p_j[k].

The coefficients add up to 1. They are nonnegative, so that every new position is a convex combination of earlier
ones, exactly when ``1 + T²/2 sigma <= alpha T <= 2 - T²/2 sigma``. With weights that add up to at most 1 this is
the condition ``1 + T²/2 <= alpha T <= 2 - T²/2`` of Dibaji and Ishii. Delayed values only move the positions of
the neighbours further back, so the condition is the same under delays. The source paper's own example
(T = 0.01, alpha = 2 to 10) has alpha T <= 0.1 and lies outside: there nothing is promised.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation.dynamics import Floats
from robustness.simulation.rules import Rule

__all__ = ["PromiseWarning", "arc_weights", "gain_interval", "kept_weight_bound", "node_gains", "promise_gap"]


class PromiseWarning(UserWarning):
    """The run is well defined, but outside the hypotheses of the theorems: nothing is promised about it."""


def gain_interval(T: float, sigma: float = 1.0) -> tuple[float, float]:
    """Return the least and greatest ``alpha T`` for which new positions are convex combinations of old ones.

    Parameters
    ----------
    T : float
        The sampling period.
    sigma : float
        A bound on the sum of the weights a vehicle keeps.

    Returns
    -------
    tuple of float
        ``(1 + T²/2 sigma, 2 - T²/2 sigma)``; empty (first above second) when ``sigma T² > 1``.

    >>> gain_interval(1.0)
    (1.5, 1.5)
    """
    return 1 + T * T / 2 * sigma, 2 - T * T / 2 * sigma


def node_gains(graph: Digraph, alpha: float | Mapping[Hashable, float] | None, T: float) -> Floats:
    """Return ``alpha_i`` for every id, shape ``(n,)``; None stands for ``1.5 / T``, the middle of the interval."""
    if alpha is None:
        gains = np.full(graph.n, 1.5 / T)
    elif isinstance(alpha, Mapping):
        gains = np.full(graph.n, np.nan)
        for label, value in alpha.items():
            (i,) = graph.ids([label])
            gains[i] = value
    else:
        gains = np.full(graph.n, float(alpha))
    if not (np.isfinite(gains).all() and (gains > 0).all()):
        raise InvalidParameter("every vehicle has a gain alpha_i > 0: give one number, or one for every node")
    return gains


def arc_weights(graph: Digraph, weights: str | Mapping[tuple[Hashable, Hashable], float]) -> Floats:
    """Return ``a_ij`` for every arc ``j -> i``, in the order of ``graph.in_indices``, shape ``(A,)``.

    ``"unit"``: 1. ``"uniform"``: ``1 / d_i``, so that the weights a vehicle keeps never exceed 1. A mapping: the
    weight of every arc ``(j, i)`` of the graph, positive.
    """
    if isinstance(weights, str):
        if weights not in ("unit", "uniform"):
            raise InvalidParameter(f"weights are 'unit', 'uniform' or a mapping from arcs, not {weights!r}")
        degrees = np.repeat(graph.in_degrees, graph.in_degrees)
        return np.ones(graph.arc_count) if weights == "unit" else 1.0 / degrees
    table = {}
    for (sender, receiver), weight in weights.items():
        (j,), (i,) = graph.ids([sender]), graph.ids([receiver])
        table[j, i] = float(weight)
    heads = np.repeat(np.arange(graph.n), graph.in_degrees)
    arcs = list(zip(graph.in_indices.tolist(), heads.tolist(), strict=True))
    values = np.array([table.get(arc, np.nan) for arc in arcs])
    if not (np.isfinite(values).all() and (values > 0).all()) or len(table) != len(arcs):
        raise InvalidParameter("custom weights give every arc (j, i) of the graph a positive number, and no other pair")
    return values


def kept_weight_bound(graph: Digraph, weights: Floats, f: int) -> Floats:
    """Return a bound on ``sigma_i`` for every id, shape ``(n,)``: all weights but the f smallest.

    The filter drops at least ``min(f, d_i)`` values: each value is ``>= 0`` or ``<= 0``, so if fewer than f lie on
    one side, the others lie on the other side and f of them, or all, are dropped there.
    """
    rows = (np.sort(weights[a:b])[f:].sum() for a, b in zip(graph.in_indptr[:-1], graph.in_indptr[1:], strict=True))
    return np.fromiter(rows, dtype=np.float64, count=graph.n)


def promise_gap(graph: Digraph, rule: Rule, f: int, T: float, alpha: Floats, weights: Floats) -> str | None:
    """Return why the gains lie outside the theory, in one line, or None when they lie inside.

    First-order rules have no gain: every new value is a convex combination by construction.
    """
    if rule.first_order:
        return None
    sigma = kept_weight_bound(graph, weights, f)
    for i in range(graph.n):
        low, high = gain_interval(T, float(sigma[i]))
        product = float(alpha[i]) * T
        if not low * (1 - 1e-12) <= product <= high * (1 + 1e-12):
            return (
                f"the theory of {rule.name} needs {low:.6g} <= alpha T <= {high:.6g} at node {graph.labels[i]!r}, "
                f"where alpha T = {product:.6g}: nothing is promised about this run"
            )
    return None
