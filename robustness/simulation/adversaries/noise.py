"""Noise: malicious nodes send random values, the same for all neighbours unless they are Byzantine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Noise"]


@dataclass(frozen=True, slots=True)
class Noise:
    """Draws uniformly from the normal vehicles' initial range, widened on both sides.

    Parameters
    ----------
    reach : float
        How far beyond the range on each side, as a multiple of its length.
    """

    reach: float = 0.5

    def play(self, view: View) -> Move:
        """Return fresh draws, from the run's own seed."""
        setting = view.setting
        low, high = setting.initial_range
        bottom, length = low - self.reach * (high - low), (1 + 2 * self.reach) * (high - low)
        graph, draws = setting.graph, setting.draws
        there = setting.by_malicious(bottom + length * draws.uniform("noise: nodes", view.step, graph.n))
        if not setting.model.byzantine:
            return Move(sent=there, positions=there)
        values = bottom + length * draws.uniform("noise: arcs", view.step, graph.arc_count)
        told = np.where(setting.from_malicious, values, np.nan)
        return Move(sent=there, positions=there, told=told)
