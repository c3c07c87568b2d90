"""Two-face: alternates between the ends of the normal range, and shows each half of the vehicles its own end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["TwoFace"]


@dataclass(frozen=True, slots=True)
class TwoFace:
    """Like :class:`Alternating`, but without evidence: the groups are the lower and the upper half at each step.

    It claims the least normal value at even steps and the greatest at odd ones. Vehicles below the middle are made
    to see the former and the others the latter: by delays of 0 or 1 step where the schedule leaves the delays to
    the adversary, or directly under a Byzantine model.
    """

    def play(self, view: View) -> Move:
        """Return the end in turn, and for every receiver the delay or the claim that shows it its own end."""
        setting = view.setting
        low, high = setting.normal_range(view.p)
        sent = setting.by_malicious((low if view.step % 2 == 0 else high) + 0.0 * view.p)
        lower = (view.p <= (low + high) / 2)[:, setting.heads]
        if setting.model.byzantine:
            told = np.where(lower, low, high)
            return Move(sent=sent, positions=sent, told=np.where(setting.from_malicious, told, np.nan))
        if not (setting.chooses_delays and setting.longest_delay >= 1):
            return Move(sent=sent, positions=sent)
        late = ~lower if view.step % 2 == 0 else lower
        return Move(sent=sent, positions=sent, delays=np.where(setting.from_malicious, late.astype(np.int64), -1))
