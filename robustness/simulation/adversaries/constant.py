"""Constant: every malicious node stands still and says so."""

from __future__ import annotations

from dataclasses import dataclass

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Constant"]


@dataclass(frozen=True, slots=True)
class Constant:
    """Holds one value for ever: the attack of the necessity proof, and a node that is stuck.

    Parameters
    ----------
    value : float or None
        The position of all malicious nodes; None: each its own initial one.
    """

    value: float | None = None

    def play(self, view: View) -> Move:
        """Return the constant as claim and as true position."""
        setting = view.setting
        held = setting.by_malicious(setting.initial if self.value is None else self.value + 0.0 * setting.initial)
        return Move(sent=held, positions=held)
