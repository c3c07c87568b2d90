"""Alternating: two fixed values in turn, so that with delays each group of vehicles sees only one of them.

The attack behind Proposition 1 of the source paper, and behind every trap: a malicious node sends the same value
to everybody, a at even steps and b at odd ones, yet one group always sees a and the other always b.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robustness.digraph import Digraph
from robustness.simulation.adversaries.protocol import Mask, Move, View

__all__ = ["Alternating"]


@dataclass(frozen=True, slots=True)
class Alternating:
    """Sends ``even`` at even steps and ``odd`` at odd ones; where it may, it shows each group one face.

    Parameters
    ----------
    even, odd : float
        The two positions.
    sees_even, sees_odd : tuple of node labels
        The nodes that are to see only one of them. With a schedule that leaves the delays to the adversary they
        do by a delay of 0 or 1 step; under a Byzantine model by being told so directly. Otherwise no use is made
        of the two groups.
    """

    even: float
    odd: float
    sees_even: tuple[Hashable, ...] = ()
    sees_odd: tuple[Hashable, ...] = ()

    def play(self, view: View) -> Move:
        """Return the value in turn, with the delays (or the claims on single arcs) that keep up both faces."""
        setting = view.setting
        face = self.even if view.step % 2 == 0 else self.odd
        sent = setting.by_malicious(face + 0.0 * setting.initial)
        first, second = (_arcs_into(setting.graph, group) for group in (self.sees_even, self.sees_odd))
        if setting.model.byzantine:
            value = np.where(first, self.even, np.where(second, self.odd, np.nan))
            return Move(sent=sent, positions=sent, told=np.where(setting.from_malicious, value, np.nan))
        if not (setting.chooses_delays and setting.longest_delay >= 1):
            return Move(sent=sent, positions=sent)
        late = second if view.step % 2 == 0 else first
        delay = np.where(first | second, late.astype(np.int64), -1)
        return Move(sent=sent, positions=sent, delays=np.where(setting.from_malicious, delay, -1))


@lru_cache(maxsize=64)
def _arcs_into(graph: Digraph, group: tuple[Hashable, ...]) -> Mask:
    """Return which arcs end in the group, shape ``(A,)``; asked at every step, so worked out once."""
    return np.isin(graph.heads, list(graph.ids(group)))
