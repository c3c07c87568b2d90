"""Crash: an honest node that at some step stops moving and falls silent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Crash"]


@dataclass(frozen=True, slots=True)
class Crash:
    """Follows the update rule until a step, then stands still and sends nothing.

    Parameters
    ----------
    at : int
        The first step of silence.
    """

    at: int = 5

    def play(self, view: View) -> Move:
        """Return nothing before the crash, and silence at a fixed place from then on."""
        if view.step < self.at:
            return Move()
        setting = view.setting
        return Move(positions=np.where(setting.malicious, view.previous, np.nan), withheld=setting.from_malicious)
