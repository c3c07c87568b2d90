"""Mending: the cheapest links that make a network robust, proven; thinning and margins are its duals."""

from __future__ import annotations

from robustness.mending.front import mend, thin
from robustness.mending.goal import Goal
from robustness.mending.losses import Margin, margin
from robustness.mending.results import MendResult, MendVerdict

__all__ = ["Goal", "Margin", "MendResult", "MendVerdict", "margin", "mend", "thin"]
