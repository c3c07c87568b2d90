"""Mending: the cheapest links that make a network robust, proven; thinning and margins are its duals."""

from __future__ import annotations

from robustness.mending.budget import BudgetResult, best_within
from robustness.mending.certification import certify_mending
from robustness.mending.front import mend, thin
from robustness.mending.goal import Goal
from robustness.mending.losses import Margin, margin
from robustness.mending.rebuilding import Confirmation, LeastVerdict, confirm_least
from robustness.mending.results import MendResult, MendVerdict

__all__ = [
    "BudgetResult",
    "Confirmation",
    "Goal",
    "LeastVerdict",
    "Margin",
    "MendResult",
    "MendVerdict",
    "best_within",
    "certify_mending",
    "confirm_least",
    "margin",
    "mend",
    "thin",
]
