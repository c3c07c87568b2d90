"""Malicious motions of named experiments and of the audit: those of the source paper's example, and some of ours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Adversary, Move, View

__all__ = ["Creep", "InAbsolutePositions", "InTurns", "Push", "Withholding"]


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


@dataclass(frozen=True, slots=True)
class InTurns:
    """Says what one adversary says at even steps, and what another says at odd ones; both decide nothing else.

    Setting 2 of the source paper gives the claims of odd steps only; what is heard at even ones is a reading.
    """

    even: Adversary
    odd: Adversary

    def play(self, view: View) -> Move:
        """Return the claims of the one whose turn it is."""
        speaking = self.even if view.step % 2 == 0 else self.odd
        return Move(sent=speaking.play(view).sent)


@dataclass(frozen=True, slots=True)
class Push:
    """Claims to be far ahead and far behind in turn, and shows every vehicle the side to which it is moving.

    By delays of 0 or 1 step, which the schedule has to leave to the adversary. The claim itself is always dropped, but
    it decides from which side the vehicle drops one honest value more.

    Parameters
    ----------
    distance : float
        How far, in both directions.
    """

    distance: float = 1e6

    def play(self, view: View) -> Move:
        """Return the claim in turn, with delays by the sign of every listener's velocity."""
        setting = view.setting
        is_even = view.step % 2 == 0
        sent = setting.by_malicious((self.distance if is_even else -self.distance) + 0.0 * setting.initial)
        if not (setting.chooses_delays and setting.longest_delay >= 1):
            return Move(sent=sent)
        ahead = view.q[:, setting.heads] > 0
        late = np.where(ahead == is_even, 0, 1) if view.step >= 0 else np.zeros(ahead.shape, dtype=np.int64)
        return Move(sent=sent, delays=np.where(setting.from_malicious, late, 0))


@dataclass(frozen=True, slots=True)
class Withholding:
    """Does what another adversary does, but keeps single messages back at random: lying and silence combined.

    Parameters
    ----------
    adversary : Adversary
    probability : float
        Of keeping back each message, drawn from the run's own seed.
    """

    adversary: Adversary
    probability: float = 0.5

    def play(self, view: View) -> Move:
        """Return the other adversary's move with some of its messages withheld."""
        setting, move = view.setting, self.adversary.play(view)
        draws = setting.draws.uniform("withholding", view.step, setting.graph.arc_count)
        silent = setting.from_malicious & (draws < self.probability)
        return Move(move.sent, move.positions, move.told, silent, move.delays)
