"""Runs that diverge: found at the step where it happens, and stopped there.

Agreement and split are statements about numbers that exist. A vehicle whose position or speed is no finite number any
more, or has grown past a stated multiple of where it started, ends its run: the run's states stay as they are from then
on, so that nothing after it computes with infinities.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robustness.simulation.dynamics import Floats
from robustness.simulation.gains import Fleet

__all__ = ["LARGEST_START", "Divergence"]

#: Starts and growth limits are at most this large, so that differences of states that have not diverged are finite.
LARGEST_START = 1e100


class Divergence:
    """Watches B runs of n vehicles and stops those that diverge.

    A run diverges at the first step at which the state of a normal vehicle is not finite, or its distance from the
    middle of the normal vehicles' start exceeds ``growth`` times the *extent* of the start: the greatest of their
    spread and of ``reach |q|`` (1 where both are 0). ``reach = max(T, 1/alpha)`` turns a speed into the way that a
    vehicle coasts, and speeds are measured alike. A malicious vehicle whose state is not finite stays where it was.

    Attributes
    ----------
    since : integer array, shape ``(B,)``
        The step at which each run diverged, -1 where none did.
    """

    def __init__(self, normal: npt.NDArray[np.bool_], p: Floats, q: Floats, fleet: Fleet, growth: float) -> None:
        self.since = np.full(len(p), -1, dtype=np.int64)
        self._normal = normal
        low = np.where(normal, p, np.inf).min(axis=1, keepdims=True, initial=np.inf)
        high = np.where(normal, p, -np.inf).max(axis=1, keepdims=True, initial=-np.inf)
        nobody = ~normal.any(axis=1, keepdims=True)
        low, high = np.where(nobody, 0.0, low), np.where(nobody, 0.0, high)
        coasting = np.zeros(p.shape[1]) if fleet.rule.first_order else 1 / fleet.alpha
        self._reach = np.minimum(np.maximum(fleet.T, coasting), LARGEST_START)
        quickest = np.where(normal, self._reach * np.abs(q), 0.0).max(axis=1, keepdims=True, initial=0.0)
        extent = np.maximum(high - low, quickest)
        self._middle = low / 2 + high / 2
        self._limit = growth * np.where(extent > 0, extent, 1.0)

    def stop(self, step: int, p: Floats, q: Floats, new_p: Floats, new_q: Floats) -> None:
        """Look at the states ``new_p, new_q (B, n)`` of a step, which follow ``p, q``; hold those of stopped runs.

        A run that was stopped earlier keeps ``p, q``; so does one that has just left the finite numbers. One that has
        just grown past the limit is stopped with its new, finite state.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            # Where nothing is infinite or NaN, neither is the sum; comparisons with NaN are false.
            far = np.abs(new_p - self._middle) + 0.0 * new_q
            fast = self._reach * np.abs(new_q)
        within = (far <= self._limit) & (fast <= self._limit)
        if within.all() and (self.since < 0).all():
            return
        finite = np.isfinite(new_p) & np.isfinite(new_q)
        lost = ~finite & ~self._normal
        new_p[lost], new_q[lost] = p[lost], 0.0
        leaving = (self._normal & ~within).any(axis=1) & (self.since < 0)
        keep = (self.since >= 0) | (self._normal & ~finite).any(axis=1)
        new_p[keep], new_q[keep] = p[keep], q[keep]
        self.since[leaving] = step
