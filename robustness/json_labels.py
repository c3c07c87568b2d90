"""Labels in our own JSON documents, which writes tuples as lists."""

from __future__ import annotations

from typing import Any

__all__ = ["from_json"]


def from_json(value: Any) -> Any:
    """Return a label as it was before JSON: every list is a tuple again; all else stays.

    >>> from_json([0, ["a", 1]]), from_json("a")
    ((0, ('a', 1)), 'a')
    """
    return tuple(from_json(part) for part in value) if isinstance(value, list) else value
