"""Random numbers that depend on the run alone: not on its batch, not on how many draws others made.

A counter-based generator: the value is a hash of (seed of the run, purpose, step, position). So one run of a
thousand can be replayed alone and gives the same bytes, and an adversary needs no hidden state. The hash is the
finaliser of SplitMix64 (Steele, Lea, Flood 2014), which passes the usual test batteries when fed a counter.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

from robustness.errors import InvalidParameter

__all__ = ["Draws"]

_GOLDEN = 0x9E3779B97F4A7C15
_WORD = (1 << 64) - 1


class Draws:
    """The random numbers of B runs.

    Parameters
    ----------
    seeds : sequence of int
        One seed per run, each in ``0 .. 2**63 - 1``.

    >>> alone, together = Draws([7]), Draws([5, 7])
    >>> bool((alone.uniform("noise", 3, 4)[0] == together.uniform("noise", 3, 4)[1]).all())
    True
    """

    def __init__(self, seeds: Sequence[int]) -> None:
        for seed in seeds:
            if not 0 <= int(seed) < 1 << 63:
                raise InvalidParameter(f"a seed is an integer in 0..2**63 - 1, not {seed}")
        self.seeds = tuple(int(seed) for seed in seeds)
        self._keys = _mix(np.array(self.seeds, dtype=np.uint64) + np.uint64(_GOLDEN))

    def uniform(self, purpose: str, step: int, count: int) -> npt.NDArray[np.float64]:
        """Return independent uniform numbers in ``[0, 1)``, shape ``(B, count)``, multiples of ``2**-53``."""
        place = (_salt(purpose) + (step & _WORD) * _GOLDEN) & _WORD
        from robustness.kernels.steps import fill_uniform

        stream = _mix(self._keys ^ _mix(np.array([place], dtype=np.uint64)))
        values = np.empty((len(stream), count))
        fill_uniform(stream, values)
        return values

    def integers(self, purpose: str, step: int, count: int, low: int, high: int) -> npt.NDArray[np.int64]:
        """Return integers uniform (to 2**-53) on ``low .. high`` inclusive, shape ``(B, count)``."""
        scaled = self.uniform(purpose, step, count) * (high - low + 1)
        # Nonnegative, so that cutting off the fraction rounds down.
        return low + scaled.astype(np.int64)


@cache
def _salt(purpose: str) -> int:
    """Return a word for the purpose, so that draws for different purposes have nothing to do with each other."""
    return int.from_bytes(hashlib.sha256(purpose.encode()).digest()[:8], "little")


def _mix(words: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """Return the SplitMix64 finaliser of every word; arithmetic is modulo ``2**64``."""
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))
