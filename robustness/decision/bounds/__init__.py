"""Cheap lower and upper bounds on r*, one technique per file, each with its evidence.

Memory is linear in the arcs, except for the spectral bound, which leaves graphs on more than 150 nodes alone. Every
lower bound is a theorem whose hypotheses were checked in integers; every upper bound below ceil(n/2) carries a pair
that was checked against the definition. Nothing here is a guess, whatever the budget.
"""

from robustness.decision.bounds.interval import all_bounds, bounds, quick_bounds
from robustness.decision.bounds.shortcuts import settle

__all__ = ["all_bounds", "bounds", "quick_bounds", "settle"]
