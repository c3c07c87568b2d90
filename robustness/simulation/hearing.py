"""What reaches vehicles at one step, and what they keep from earlier ones: the arrays that rules are fed with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robustness.simulation.dynamics import Floats

__all__ = ["Hearing", "Stores", "stores_for"]

#: The step that a value never heard was sent at.
_NEVER = -(1 << 62)


@dataclass(frozen=True, slots=True, eq=False)
class Stores:
    """What vehicles keep from earlier steps, for B runs and A arcs; shape ``(1, 1)`` where nothing is kept.

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


@dataclass(frozen=True, slots=True, eq=False)
class Hearing:
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


def stores_for(runs: int, arcs: int, *, hold: bool, remember: bool) -> Stores:
    """Return empty stores."""
    held, remembered = (runs, arcs) if hold else (1, 1), (runs, arcs) if remember else (1, 1)
    return Stores(
        hold, remember, np.zeros(held), np.zeros(held, dtype=np.uint8),
        np.zeros(remembered), np.full(remembered, _NEVER, dtype=np.int64),
    )  # fmt: skip
