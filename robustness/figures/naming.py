"""Where the name of a node is written: on it when it is short, else beside it, where it covers no node and no name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["write_names"]

#: So many letters fit on a node.
_ON_A_NODE = 3
#: Width of a letter and height of a line, as parts of the size of the font; and points between a node and its name.
_WIDE, _TALL, _GAP = 0.6, 1.15, 2.0
#: The part of the picture's sides that the network takes; the legend and the margins take the rest.
_TAKEN = 0.75

#: Below, above, right, left: how a name is set off from its node, and aligned there.
_SIDES = ((0, -1, "center", "top"), (0, 1, "center", "bottom"), (1, 0, "left", "center"), (-1, 0, "right", "center"))

Box = tuple[float, float, float, float]


def write_names(
    axes: Axes,
    names: Mapping[int, str],
    places: Mapping[int, tuple[float, float]],
    size: float,
    shape: tuple[float, float],
) -> None:
    """Write every node's name.

    Parameters
    ----------
    axes : matplotlib axes
    names, places : mapping from node
        What to write, and where the nodes stand.
    size : float
        Area of a node in square points.
    shape : pair of float
        Width and height of the picture in inches.
    """
    from matplotlib.patheffects import withStroke

    longest = max(map(len, names.values()), default=1)
    font = max(5.0, min(11.0, 11.0 * (size / 620) ** 0.5)) * (1.0 if longest <= _ON_A_NODE else 0.8)
    if longest <= _ON_A_NODE:
        for node, name in names.items():
            axes.annotate(name, places[node], ha="center", va="center", fontsize=font, zorder=5)
        return
    radius, points = size**0.5 / 2, _in_points(places, shape)
    nodes = np.array([(x - radius, y - radius, x + radius, y + radius) for x, y in points.values()])
    taken = nodes
    for node, name in names.items():
        boxes = [_box(points[node], side, radius, _WIDE * font * len(name), _TALL * font) for side in _SIDES]
        best = min(range(len(boxes)), key=lambda k: (_covered(boxes[k], taken), k))
        across, up, ha, va = _SIDES[best]
        taken = np.vstack([taken, boxes[best]])
        axes.annotate(
            name, places[node], (across * (radius + _GAP), up * (radius + _GAP)), textcoords="offset points", ha=ha,
            va=va, fontsize=font, zorder=5, path_effects=[withStroke(linewidth=2.0, foreground="white")],
        )  # fmt: skip


def _in_points(places: Mapping[int, tuple[float, float]], shape: tuple[float, float]) -> dict[int, tuple[float, float]]:
    """Return where the nodes will stand in the picture, in points from any origin."""
    array = np.array(list(places.values()))
    extent = np.ptp(array, axis=0)
    scale = np.where(extent > 0, 72 * _TAKEN * np.array(shape) / np.where(extent > 0, extent, 1.0), 1.0)
    return {node: (float(x), float(y)) for node, (x, y) in zip(places, array * scale, strict=True)}


def _box(point: tuple[float, float], side: tuple[int, int, str, str], radius: float, wide: float, tall: float) -> Box:
    """Return the left, lower, right and upper edge of a name on one side of its node."""
    across, up = side[:2]
    x = point[0] + across * (radius + _GAP + wide / 2)
    y = point[1] + up * (radius + _GAP + tall / 2)
    return x - wide / 2, y - tall / 2, x + wide / 2, y + tall / 2


def _covered(box: Box, others: np.ndarray) -> float:
    """Return the area of a box that others cover."""
    wide = np.minimum(box[2], others[:, 2]) - np.maximum(box[0], others[:, 0])
    tall = np.minimum(box[3], others[:, 3]) - np.maximum(box[1], others[:, 1])
    return float((wide.clip(0) * tall.clip(0)).sum())
