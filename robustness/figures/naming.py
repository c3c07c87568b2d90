"""Where the name of a node is written: on it when it is short, else beside it, where it covers as little as it can."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING
from unicodedata import east_asian_width

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["are_short", "write_names"]

#: So many letters fit on a node.
_ON_A_NODE = 3
#: Width of a letter and height of a line, as parts of the size of the font; and points between a node and its name.
_WIDE, _TALL, _GAP = 0.6, 1.15, 2.0
#: In larger networks a name that finds no place is left out, and arcs are no reason to write it elsewhere.
_ALL_NAMED = 100

#: Below, above, right, left, and between these: how a name is set off from its node, and aligned there.
_SIDES = (
    (0.0, -1.0, "center", "top"), (0.0, 1.0, "center", "bottom"),
    (1.0, 0.0, "left", "center"), (-1.0, 0.0, "right", "center"),
    (0.8, -0.8, "left", "top"), (-0.8, -0.8, "right", "top"),
    (0.8, 0.8, "left", "bottom"), (-0.8, 0.8, "right", "bottom"),
)  # fmt: skip

#: What it costs to cover a square point of a node or a name, of an arrow's head, and of another part of an arc.
_NODE, _HEAD, _ARC = 100.0, 3.0, 0.5
#: Half the sides of the boxes that stand for a head and for a piece of an arc, and how far from the node they are.
_HEAD_BOX, _HEAD_AT, _ARC_BOX, _ARC_AT = 5.0, (6.0,), 1.5, (3.0, 9.0, 15.0, 21.0, 27.0)

Box = tuple[float, float, float, float]
Places = Mapping[int, tuple[float, float]]


def are_short(names: Iterable[str]) -> bool:
    """Return whether names are written on their nodes, where these are large enough."""
    return all(_letters(name) <= _ON_A_NODE for name in names)


def write_names(
    axes: Axes,
    names: Mapping[int, str],
    places: Places,
    points: Places,
    size: float,
    arcs: Sequence[tuple[int, int]],
    arrows: Sequence[tuple[int, int]],
    bend: float,
) -> int:
    """Write the nodes' names, in the order of ``names``: the first ones have the choice. Return how many are left out.

    Parameters
    ----------
    axes : matplotlib axes
    names, places : mapping from node
        What to write, and where the nodes stand.
    points : mapping from node
        Where they will stand in the picture, in points from any origin.
    size : float
        Area of a node in square points.
    arcs, arrows : sequence of pairs
        All arcs, and those of them that are drawn with a head.
    bend : float
        How far arrows bend, as part of their length.
    """
    from matplotlib.patheffects import withStroke

    font = max(5.0, min(11.0, 11.0 * (size / 620) ** 0.5))
    longest = max(map(_letters, names.values()), default=1.0)
    if are_short(names.values()) and _WIDE * font * longest <= 1.15 * size**0.5:
        for node, name in names.items():
            axes.annotate(name, places[node], ha="center", va="center", fontsize=font, zorder=5)
        return 0
    font = max(6.0 if len(names) <= _ALL_NAMED else 5.0, min(9.0, font))
    radius = size**0.5 / 2
    taken = _drawn(points, radius, arcs, arrows, bend)
    left_out = 0
    for node, name in names.items():
        boxes = [_box(points[node], side, radius, _WIDE * font * _letters(name), _TALL * font) for side in _SIDES]
        costs = [_cost(box, taken) for box in boxes]
        best = min(range(len(boxes)), key=lambda k: (costs[k], k))
        across, up, ha, va = _SIDES[best]
        left, low, right, high = boxes[best]
        if len(names) > _ALL_NAMED and costs[best] > 0.1 * _NODE * (right - left) * (high - low):
            left_out += 1
            continue
        taken = np.vstack([taken, (*boxes[best], _NODE)])
        axes.annotate(
            name, places[node], (across * (radius + _GAP), up * (radius + _GAP)), textcoords="offset points", ha=ha,
            va=va, fontsize=font, zorder=5, path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )  # fmt: skip
    return left_out


def _letters(name: str) -> float:
    """Return how many letters of ordinary width a name is as wide as; East Asian ones take nearly two."""
    return sum(1.0 / _WIDE if east_asian_width(letter) in "WF" else 1.0 for letter in name)


def _drawn(
    points: Places,
    radius: float,
    arcs: Sequence[tuple[int, int]],
    arrows: Sequence[tuple[int, int]],
    bend: float,
) -> np.ndarray:
    """Return what names had better not cover, one row each: left, lower, right, upper edge, and the cost of a point."""
    rows = [(x - radius, y - radius, x + radius, y + radius, _NODE) for x, y in points.values()]
    if len(points) <= _ALL_NAMED:
        bent = set(arrows)
        straight = [arc for arc in arcs if arc not in bent]
        rows += _pieces(points, radius, arrows, _HEAD_AT, _HEAD_BOX, _HEAD, bend)
        for lines, how in ((arrows, bend), (straight, 0.0)):
            rows += _pieces(points, radius, lines, _ARC_AT, _ARC_BOX, _ARC, how)
            rows += _pieces(points, radius, [(v, u) for u, v in lines], _ARC_AT, _ARC_BOX, _ARC, -how)
    return np.array(rows)


def _pieces(
    points: Places,
    radius: float,
    arcs: Iterable[tuple[int, int]],
    distances: Sequence[float],
    half: float,
    cost: float,
    bend: float,
) -> list[tuple[float, float, float, float, float]]:
    """Return boxes on arcs, at these distances from the nodes that they run into."""
    rows = []
    for u, v in arcs:
        (x, y), (from_x, from_y) = points[v], points[u]
        # Where matplotlib's arc3 comes from: the control point of its curve, at twice the distance.
        far_x, far_y = from_x - 2 * bend * (from_y - y), from_y + 2 * bend * (from_x - x)
        length = float(np.hypot(far_x - x, far_y - y)) or 1.0
        for distance in distances:
            part = min((radius + distance) / length, 0.5)
            along, up = x + part * (far_x - x), y + part * (far_y - y)
            rows.append((along - half, up - half, along + half, up + half, cost))
    return rows


def _box(
    point: tuple[float, float], side: tuple[float, float, str, str], radius: float, wide: float, tall: float
) -> Box:
    """Return the left, lower, right and upper edge of a name on one side of its node."""
    across, up = side[:2]
    x = point[0] + across * (radius + _GAP) + float(np.sign(across)) * wide / 2
    y = point[1] + up * (radius + _GAP) + float(np.sign(up)) * tall / 2
    return x - wide / 2, y - tall / 2, x + wide / 2, y + tall / 2


def _cost(box: Box, taken: np.ndarray) -> float:
    """Return what it costs to cover what a box covers."""
    wide = np.minimum(box[2], taken[:, 2]) - np.maximum(box[0], taken[:, 0])
    tall = np.minimum(box[3], taken[:, 3]) - np.maximum(box[1], taken[:, 1])
    return float((wide.clip(0) * tall.clip(0) * taken[:, 4]).sum())
