"""Natural order: numbers in names count by their value, so ``n2`` stands before ``n10``, wherever a set is shown."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, TypeVar

__all__ = ["in_natural_order", "natural_key"]

_Label = TypeVar("_Label")


def natural_key(label: object) -> tuple[int, tuple[Any, ...], str]:
    """Return the sort key of a label: numbers by value, then texts part by part, then tuples, then all else by text.

    It is total: two labels have equal keys only when type and text are the same. (``"01"`` and ``"1"`` are told apart
    by their letters, after their values.)
    """
    if isinstance(label, int):
        return (0, (int(label),), str(label))
    if isinstance(label, tuple):
        return (2, tuple(natural_key(part) for part in label), "")
    text = str(label)
    parts = re.split(r"([0-9]+)", text)
    # Text and numbers take turns, text first, so that like is compared with like. A number compares by its length
    # without leading zeros and then by its digits, which is by value, however long it is.
    key = tuple((len(part.lstrip("0")), part.lstrip("0")) if k % 2 else part for k, part in enumerate(parts))
    return (1 if isinstance(label, str) else 3, key, text)


def in_natural_order(labels: Iterable[_Label]) -> list[_Label]:
    """Return labels in natural order.

    >>> in_natural_order(["n10", "n2", 3, "n1", 20])
    [3, 20, 'n1', 'n2', 'n10']
    """
    return sorted(labels, key=natural_key)
