"""Ramp: malicious nodes drive away at a constant speed and try to drag the others along."""

from __future__ import annotations

from dataclasses import dataclass

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Ramp"]


@dataclass(frozen=True, slots=True)
class Ramp:
    """Moves linearly in the step number.

    Parameters
    ----------
    slope : float
        Per step, as a multiple of the normal vehicles' initial spread (1 where that is 0).
    """

    slope: float = 0.05

    def play(self, view: View) -> Move:
        """Return the initial value plus ``slope * spread * k``."""
        setting = view.setting
        low, high = setting.initial_range
        spread = high - low + (high == low)
        there = setting.by_malicious(setting.initial + self.slope * spread * view.step)
        return Move(sent=there, positions=there)
