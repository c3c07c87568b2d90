"""Sine: malicious nodes swing across the range of the normal ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Sine"]


@dataclass(frozen=True, slots=True)
class Sine:
    """Swings around the middle of the normal vehicles' initial range.

    Parameters
    ----------
    period : float
        In steps.
    reach : float
        The amplitude as a multiple of half the initial spread; above 1 it leaves the range.
    """

    period: float = 25.0
    reach: float = 1.2

    def __post_init__(self) -> None:
        if not self.period > 0:
            raise InvalidParameter(f"the period of a sine is a positive number of steps, not {self.period}")

    def play(self, view: View) -> Move:
        """Return the point of the sine at this step."""
        setting = view.setting
        low, high = setting.initial_range
        swing = self.reach * np.sin(2 * np.pi * view.step / self.period)
        there = setting.by_malicious((low + high) / 2 + swing * (high - low) / 2 + 0.0 * setting.initial)
        return Move(sent=there, positions=there)
