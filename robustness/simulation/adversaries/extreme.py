"""Extreme value: as far out as the filter just lets pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import Move, View
from robustness.simulation.dynamics import Floats

__all__ = ["ExtremeValue"]

_INSIDE = 1e-9


@dataclass(frozen=True, slots=True)
class ExtremeValue:
    """Sends the most extreme value that some neighbour still keeps.

    A value above the own one survives at a vehicle exactly when at least f others it hears lie above; so the limit
    of a vehicle is the f-th largest value it hears from normal neighbours (its own value if fewer lie above). The
    claim is the greatest limit of all listeners, a relative 1e-9 inside. A Byzantine node sends every listener its
    own limit: upwards above the middle of the range, downwards below.

    Parameters
    ----------
    side : str
        ``"up"``, ``"down"``, or ``"both"``: in turn, step by step.
    """

    side: str = "both"

    def __post_init__(self) -> None:
        if self.side not in ("up", "down", "both"):
            raise InvalidParameter(f"the side of an extreme value is 'up', 'down' or 'both', not {self.side!r}")

    def play(self, view: View) -> Move:
        """Return the limits at this step."""
        setting = view.setting
        low, high = setting.normal_range(view.p)
        ceiling, floor = _upper_limits(view, view.p), -_upper_limits(view, -view.p)
        upwards = self.side == "up" or (self.side == "both" and view.step % 2 == 0)
        hears = np.zeros((setting.graph.n, setting.graph.n), dtype=bool)
        hears[setting.tails, setting.heads] = True
        audience = hears[None] & ~setting.malicious[:, None, :]
        # Only who can be pulled counts: the outermost vehicle keeps nothing beyond its own value.
        if upwards:
            pulled = audience & (ceiling > view.p)[:, None, :]
            best = np.where(pulled, ceiling[:, None, :], -np.inf).max(axis=2, initial=-np.inf)
        else:
            pulled = audience & (floor < view.p)[:, None, :]
            best = np.where(pulled, floor[:, None, :], np.inf).min(axis=2, initial=np.inf)
        claim = setting.by_malicious(np.where(np.isfinite(best), best, view.p))
        if not setting.model.byzantine:
            return Move(sent=claim, positions=claim)
        limit = np.where(view.p > (low + high) / 2, ceiling, floor)[:, setting.heads]
        told = np.where(setting.from_malicious, limit, np.nan)
        return Move(sent=claim, positions=claim, told=told)


def _upper_limits(view: View, p: Floats) -> Floats:
    """Return the greatest value each node would keep, shape ``(B, n)``."""
    setting = view.setting
    limits = np.empty_like(p)
    for i in range(setting.graph.n):
        senders = setting.graph.in_neighbours(i)
        own = p[:, i]
        others = np.where(setting.malicious[:, senders], -np.inf, p[:, senders])
        if setting.f == 0:
            limits[:, i] = np.inf
        elif len(senders) < setting.f:
            limits[:, i] = own
        else:
            limits[:, i] = np.partition(others, len(senders) - setting.f, axis=1)[:, len(senders) - setting.f]
    top = p.max(axis=1, keepdims=True, initial=-np.inf)
    gain = np.maximum(np.minimum(limits, top) - p, 0.0)
    return np.asarray(p + (1 - _INSIDE) * gain)
