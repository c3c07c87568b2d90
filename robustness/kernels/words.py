"""Node sets as 64-bit words: counting and finding bits.

These are the primitives of the kernels, as plain Python sees them. Compiled kernels use the processor's own
instructions instead (``words.pxd``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["bit_of", "count", "first"]


def count(word: Any) -> int:
    """Return the number of bits that are set."""
    return int(word).bit_count()


def first(word: Any) -> int:
    """Return the place of the lowest bit that is set, of a word that is not 0."""
    bits = int(word)
    return (bits & -bits).bit_length() - 1


def bit_of(node: int) -> Any:
    """Return the word with the one bit that ``node`` has in its word."""
    return np.uint64(1 << (int(node) & 63))
