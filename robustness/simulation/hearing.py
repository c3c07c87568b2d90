"""The arrays that a step of a batch works on: what vehicles hear, what they keep, how they move, where they are.

Named tuples, which the compiled :class:`robustness.kernels.steps.Turn` takes as they are; B runs, n nodes, A arcs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robustness.simulation.dynamics import Floats

__all__ = ["Hearing", "Law", "States", "Stores", "stores_for"]

#: The step that a value never heard was sent at.
_NEVER = -(1 << 62)


class Stores(NamedTuple):
    """What vehicles keep from earlier steps; shape ``(1, 1)`` where nothing is kept.

    Attributes
    ----------
    hold, remember : bool
        Whether values are held between updates, and whether links that come and go are remembered.
    held, kept : arrays, shape ``(B, A)``
        The values heard at the last update, and whether they passed the filter.
    memory, stamp : arrays, shape ``(B, A)``
        The last delivered value of every arc and the step it left its sender.
    """

    hold: bool
    remember: bool
    held: Floats
    kept: npt.NDArray[np.uint8]
    memory: Floats
    stamp: npt.NDArray[np.int64]


class Hearing(NamedTuple):
    """What reaches the vehicles at one step, and who updates.

    Attributes
    ----------
    ring : array, shape ``(H, B, C)``
        What was announced on every channel at step k, in slot ``k % H``.
    channel : integer array, shape ``(A,)``
    delay, status : integer arrays, shape ``(1 or B, A)``
        Status 0: no link now, 1: delivered, 2: withheld by the sender.
    update : array, shape ``(1 or B, n)``
    """

    ring: Floats
    channel: npt.NDArray[np.int64]
    delay: npt.NDArray[np.int64]
    status: npt.NDArray[np.uint8]
    update: npt.NDArray[np.uint8]


class Law(NamedTuple):
    """How vehicles move: what is the same at every step.

    Attributes
    ----------
    f : int
        How many values the filter drops on either side, less those that were withheld.
    first_order, strict : bool
        See :class:`robustness.simulation.update_rules.Rule`.
    T : float
        The sampling period.
    indptr : array, shape ``(n + 1,)``
        Arcs ``indptr[i] .. indptr[i + 1] - 1`` end in node i.
    weight : array, shape ``(A,)``
    alpha : array, shape ``(n,)``
    """

    f: int
    first_order: bool
    strict: bool
    T: float
    indptr: npt.NDArray[np.int64]
    weight: Floats
    alpha: Floats


class States(NamedTuple):
    """Positions and velocities now, and arrays for those one step later; each of shape ``(B, n)``."""

    p: Floats
    q: Floats
    new_p: Floats
    new_q: Floats

    @classmethod
    def after(cls, p: Floats, q: Floats) -> States:
        """Return ``p`` and ``q`` with new arrays for what comes after them."""
        return cls(p, q, np.empty_like(p), np.empty_like(q))


def stores_for(runs: int, arcs: int, *, hold: bool, remember: bool) -> Stores:
    """Return empty stores."""
    held, remembered = (runs, arcs) if hold else (1, 1), (runs, arcs) if remember else (1, 1)
    return Stores(
        hold, remember, np.zeros(held), np.zeros(held, dtype=np.uint8),
        np.zeros(remembered), np.full(remembered, _NEVER, dtype=np.int64),
    )  # fmt: skip
