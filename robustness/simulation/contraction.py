"""How fast agreement is proven to be reached: an explicit factor, to be read beside the one that a run shows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from robustness.digraph import Digraph
from robustness.simulation.gains import Fleet, kept_weight_bound
from robustness.simulation.schedules import Schedule

__all__ = ["Contraction", "proven_contraction"]


class Contraction(NamedTuple):
    """In every ``steps`` steps the hull of the normal vehicles shrinks by at least this fraction of its length.

    Proven for networks without a trap (see :mod:`robustness.traps`); without delays and with one face for all, for
    networks that satisfy the condition of that model. ``shrinks_by`` is a proof's number, not a prediction: often it is
    so small that it is rounded to 0.
    """

    shrinks_by: float
    steps: int


def proven_contraction(graph: Digraph, fleet: Fleet, f: int, normal: int, schedule: Schedule) -> Contraction | None:
    """Return the proven contraction of a run on a fixed network, or None where the theory gives none.

    Parameters
    ----------
    graph : Digraph
    fleet : Fleet
        With no gap at any vehicle.
    f : int
    normal : int
        How many vehicles are normal, N.
    schedule : Schedule
        With the greatest delay b and at most g steps from one update to the next: tau = g - 1 + b and L = tau + g.

    Notes
    -----
    Second order, with s = sigma T², eta = 1 - sqrt(s), kappa = T² beta / 2 for the least weight beta,
    mu = sqrt(s) eta / 2 and theta = kappa mu^(tau+1) / 2: by theta (kappa eta^L)^(N-1) in tau + 1 + (N-1) L steps.
    First order, with omega the least share of the own or of a kept value in the mean: by
    omega^tau (omega^(L+1))^(N-1) / 2 in tau + (N-1) L steps. The worst constants of all vehicles are taken.
    """
    if fleet.rule.update is not None or any(gap is not None for gap in fleet.gaps) or normal < 2:
        return None
    gap, bound = schedule.update_times.gap, schedule.delay_rule.bound
    tau, rounds = gap - 1 + bound, normal - 1
    L = tau + gap
    least = float(fleet.weight.min(initial=np.inf))
    sigma = kept_weight_bound(graph, fleet.weight, f)
    if fleet.rule.first_order:
        omega = min(1.0, least) / (1.0 + float(sigma.max(initial=0.0)))
        logarithm = (tau + rounds * (L + 1)) * math.log(omega) - math.log(2)
        return Contraction(math.exp(logarithm), tau + rounds * L)
    if not sigma.min(initial=0.0 if not graph.n else np.inf) > 0:
        return None
    roots = np.sqrt(sigma) * fleet.T
    eta, mu = 1 - float(roots.max()), float((roots * (1 - roots)).min()) / 2
    kappa = fleet.T**2 * least / 2
    logarithm = math.log(kappa / 2) + (tau + 1) * math.log(mu) + rounds * (math.log(kappa) + L * math.log(eta))
    return Contraction(math.exp(logarithm), tau + 1 + rounds * L)
