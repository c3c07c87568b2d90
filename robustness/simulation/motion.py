"""The motions of the malicious vehicle in the source paper's numerical example."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Adversary, Move, View

__all__ = ["Creep", "InAbsolutePositions"]


@dataclass(frozen=True, slots=True)
class Creep:
    """Moves as ``p[k] = linear k + root sqrt(k)``: Setting 2 of the source paper has 0.1 and 5.

    Parameters
    ----------
    linear, root : float
        Per step, and per square root of the step number. Before step 0 it stands at 0.
    """

    linear: float = 0.1
    root: float = 5.0

    def play(self, view: View) -> Move:
        """Return the point of the motion as claim and as true position."""
        step = max(view.step, 0)
        there = self.linear * step + self.root * float(np.sqrt(step))
        place = view.setting.by_malicious(there + 0.0 * view.setting.initial)
        return Move(sent=place, positions=place)


@dataclass(frozen=True, slots=True)
class InAbsolutePositions:
    """Plays another adversary's numbers as absolute positions x instead of transformed ones: ``p = x - k T r``.

    For the other reading of the source paper's settings.

    Parameters
    ----------
    adversary : Adversary
        Its claims and true positions are shifted at odd steps, or at all.
    per_step : float
        ``T r``: how far the target moves per step.
    odd_only : bool
        Setting 1 writes ``2 + k T r`` at even steps, which already moves along, and the bare number 200 at odd ones.
    """

    adversary: Adversary
    per_step: float
    odd_only: bool = False

    def play(self, view: View) -> Move:
        """Return the other adversary's move, shifted."""
        move = self.adversary.play(view)
        shift = 0.0 if self.odd_only and view.step % 2 == 0 else view.step * self.per_step
        sent, positions = (None if a is None else a - shift for a in (move.sent, move.positions))
        return Move(sent, positions, move.told, move.withheld, move.delays)
