"""Where the attributes of a node place it, in the words of the editors and collections that write them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["place_of", "turned_up", "two_numbers"]

#: Pairs of attributes that hold a place, horizontal first. GraphML of yEd has x and y, which its reader turns up
#: (:func:`turned_up`); topology collections have longitude and latitude.
_PAIRS = (("x", "y"), ("lon", "lat"), ("longitude", "latitude"), ("lng", "lat"))


def place_of(attributes: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the place that a node's attributes give, or None.

    Read are ``pos`` (two numbers, or DOT's ``"x,y"``), ``x`` and ``y``, longitude and latitude in any spelling of case,
    GEXF's ``viz``/``position`` and GML's ``graphics``.
    """
    lowered = {str(key).lower(): value for key, value in attributes.items()}
    for nested in (lowered.get("viz"), lowered.get("graphics"), lowered.get("position")):
        if isinstance(nested, Mapping):
            inner = nested.get("position", nested)
            if isinstance(inner, Mapping):
                lowered = {**lowered, **{str(key).lower(): value for key, value in inner.items()}}
    pos = lowered.get("pos")
    if isinstance(pos, str):
        pos = pos.rstrip("!").split(",")
    if isinstance(pos, Sequence) and len(pos) == 2:
        return two_numbers(*pos)
    for across, up in _PAIRS:
        if across in lowered and up in lowered:
            return two_numbers(lowered[across], lowered[up])
    return None


def two_numbers(across: Any, up: Any) -> tuple[float, float] | None:
    """Return two finite numbers, or None."""
    try:
        x, y = float(across), float(up)
    except (TypeError, ValueError):
        return None
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None


def turned_up(down: str) -> str:
    """Return the y of a drawing whose y points down, as that of yEd does, such that up is up.

    >>> turned_up("30.5"), turned_up("-2"), turned_up("high")
    ('-30.5', '2.0', 'high')
    """
    try:
        return repr(0.0 - float(down))
    except ValueError:
        return down
