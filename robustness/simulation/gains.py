"""Gains and weights of a network of vehicles, and whether the theory of second-order MSR rules applies to each.

The region of gains is :mod:`robustness.gain_region`; here it is asked vehicle by vehicle, with the greatest sum of
weights that the filter lets each keep. The source paper's own example (T = 0.01, alpha = 2 to 10) lies inside when kept
weights add up to at most 1; with unit weights on K_5 they add up to 3, and alpha = 2 and 3 lie outside.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.gain_region import gain_gap, hull_velocity_factor
from robustness.simulation.dynamics import Floats
from robustness.simulation.update_rules import Rule
from robustness.spelled import Spelling

__all__ = ["Fleet", "PromiseWarning", "arc_weights", "fleet_of", "kept_weight_bound", "node_gains"]


class PromiseWarning(UserWarning):
    """The run is well defined, but outside the hypotheses of the theorems: nothing is promised about it."""


@dataclass(frozen=True, slots=True, eq=False)
class Fleet:
    """How the n vehicles of a network move, with A arcs in the order of ``graph.in_indices``.

    Attributes
    ----------
    rule : Rule
    T : float
        The sampling period.
    alpha : array, shape ``(n,)``
        The gain of every vehicle; unused by first-order rules.
    weight : array, shape ``(A,)``
        The weight of every arc.
    gaps : tuple of n
        For every vehicle why the theory promises nothing about it, in one line, or None.
    coasting : array, shape ``(n,)``
        The factor c of the hull of all ``p`` and ``p + c q``, see :func:`robustness.gain_region.hull_velocity_factor`;
        0 where there is a gap and for first-order rules.
    """

    rule: Rule
    T: float
    alpha: Floats
    weight: Floats
    gaps: tuple[str | None, ...]
    coasting: Floats

    def gap(self, vehicles: Iterable[int]) -> str | None:
        """Return why nothing is promised about a run whose normal vehicles have these ids, or None."""
        return next((self.gaps[i] for i in vehicles if self.gaps[i] is not None), None)


def fleet_of(
    graph: Digraph,
    rule: Rule,
    f: int,
    T: float,
    alpha: float | Mapping[Hashable, float] | None,
    weights: str | Mapping[tuple[Hashable, Hashable], float],
) -> Fleet:
    """Return the vehicles of a network: gains and weights by id, and what the theory says about each.

    First-order rules have no gain: every new value is a convex combination by construction. For them weights are
    relative to an own weight of 1, and ``"uniform"`` means the same as ``"unit"``.
    """
    gains = node_gains(graph, alpha, T)
    weight = arc_weights(graph, "unit" if rule.first_order and weights == "uniform" else weights)
    gaps: list[str | None] = [None] * graph.n
    coasting = np.zeros(graph.n)
    if rule.update is not None:
        gaps = ["no theorem is about an update rule of one's own: nothing is promised about this run"] * graph.n
    elif not rule.first_order:
        named = Spelling(graph.labels)
        for i, sigma in enumerate(kept_weight_bound(graph, weight, f).tolist()):
            gap = gain_gap(T, float(gains[i]), sigma)
            if gap is None:
                coasting[i] = hull_velocity_factor(T, float(gains[i]), sigma)
            else:
                gaps[i] = (
                    f"outside the gains of the theory at node {named(graph.labels[i])}, nothing is promised: {gap}"
                )
    return Fleet(rule, T, gains, weight, tuple(gaps), coasting)


def node_gains(graph: Digraph, alpha: float | Mapping[Hashable, float] | None, T: float) -> Floats:
    """Return ``alpha_i`` for every id, shape ``(n,)``; None: ``1.5 / T``, in the region for every sigma T² < 1."""
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
    arcs = list(zip(graph.in_indices.tolist(), graph.heads.tolist(), strict=True))
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
