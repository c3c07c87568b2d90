"""Liar: sends one thing and does another. Passive sensing believes the one, active sensing sees the other."""

from __future__ import annotations

from dataclasses import dataclass

from robustness.simulation.adversaries.protocol import Adversary, Move, View

__all__ = ["Liar"]


@dataclass(frozen=True, slots=True)
class Liar:
    """Says what one adversary says and moves as another moves.

    Parameters
    ----------
    says : Adversary
        Its claims, omissions and delays are used.
    does : Adversary
        Its true positions are used.
    """

    says: Adversary
    does: Adversary

    def play(self, view: View) -> Move:
        """Return the claims of the one with the positions of the other."""
        words, deeds = self.says.play(view), self.does.play(view)
        sent = view.p if words.sent is None else words.sent
        claims = view.setting.by_malicious(sent)
        return Move(claims, deeds.positions, words.told, words.withheld, words.delays)
