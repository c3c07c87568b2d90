"""Omission: follows the update rule and tells the truth, but not always and not to everybody."""

from __future__ import annotations

from dataclasses import dataclass

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Omission"]


@dataclass(frozen=True, slots=True)
class Omission:
    """Withholds each message with a fixed probability (omissive faults).

    Parameters
    ----------
    probability : float
        In ``0 .. 1``; 1 is permanent silence of a node that keeps moving.
    """

    probability: float = 0.5

    def __post_init__(self) -> None:
        if not 0 <= self.probability <= 1:
            raise InvalidParameter(f"a probability lies in 0..1, not {self.probability}")

    def play(self, view: View) -> Move:
        """Return which messages are withheld at this step, from the run's own seed."""
        setting = view.setting
        draws = setting.draws.uniform("omission", view.step, setting.graph.arc_count)
        return Move(withheld=setting.from_malicious & (draws < self.probability))
