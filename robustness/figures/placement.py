"""Where nodes stand in a picture: as the graph's own attributes say, or so that the sets in question are told apart."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import networkx as nx
import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.figures.marking import Marks
from robustness.figures.springs import LARGE, large_layout
from robustness.places import place_of, two_numbers

__all__ = ["Positions", "moved_apart", "positions_for", "positions_in", "scale_of"]

#: Where each node stands, by id.
Positions = dict[int, tuple[float, float]]

#: The angle of the first node of a circle: nearly upright, so that two or four nodes do not lie on one line with those
#: of another circle beside it.
_TURN = 1.25

#: A side of more nodes fills a disc: on a circle they would cover each other.
_MOST_ON_A_CIRCLE = 60

#: Of more nodes none is moved.
_MOST_MOVED = 3000

#: A denser graph looks best on one circle.
_DENSE = 0.5


def positions_in(network: Any) -> dict[Hashable, tuple[float, float]] | None:
    """Return the places that a networkx graph's node attributes give, or None unless every node has one.

    Which attributes are read, :func:`robustness.places.place_of` says.
    """
    if isinstance(network, Digraph):
        network = network.to_networkx()
    if not hasattr(network, "nodes"):
        return None
    found: dict[Hashable, tuple[float, float]] = {}
    for node, data in network.nodes(data=True):
        place = place_of(data)
        if place is None:
            return None
        found[node] = place
    # One point for all is no layout.
    return found if len(found) < 2 or len(set(found.values())) > 1 else None


def positions_for(
    graph: Digraph, marks: Marks, given: Mapping[Hashable, Sequence[float]] | None, own: Mapping[Hashable, Any] | None
) -> Positions:
    """Return where every node stands.

    Parameters
    ----------
    graph : Digraph
    marks : Marks
    given : mapping from labels to pairs of numbers, or None
        What the caller wants; then every node needs one.
    own : mapping or None
        What the graph's attributes say, used when nothing is given.

    Raises
    ------
    InvalidParameter
        When a given place is missing or no pair of finite numbers.
    """
    if given is not None:
        missing = [label for label in graph.labels if label not in given]
        if missing:
            raise InvalidParameter(f"positions are given for every node or not at all, but {missing[0]!r} has none")
        places = {}
        for i, label in enumerate(graph.labels):
            place = given[label]
            pair = two_numbers(*place) if len(place) == 2 else None
            if pair is None:
                raise InvalidParameter(f"the position of {label!r} is two finite numbers, not {place!r}")
            places[i] = pair
        return places
    if own is not None and all(label in own for label in graph.labels):
        return {i: own[label] for i, label in enumerate(graph.labels)}
    if marks.S1 and marks.S2:
        return _sides(graph, marks)
    return _spread(graph)


def scale_of(places: Positions, shape: tuple[float, float], fills: bool) -> np.ndarray:
    """Return points a unit, across and up, of a network drawn in this width and height in inches.

    With ``fills`` the places are stretched to fill it, otherwise one unit is as long across as up.
    """
    extent = np.ptp(np.array(list(places.values())), axis=0) if places else np.zeros(2)
    room = 72 * np.array(shape)
    scale = np.where(extent > 0, room / np.where(extent > 0, extent, 1.0), np.inf)
    scale = scale if fills else np.full(2, scale.min())
    return np.where(np.isfinite(scale), scale, 1.0)


def moved_apart(places: Positions, scale: np.ndarray, wide: float) -> Positions:
    """Return places where nodes so many points wide do not cover each other; those that have room keep theirs.

    Of more than 3000 nodes all keep theirs. Pairs that are too near push each other away, again and again, as in any
    relaxation of a force layout.
    """
    if not 2 <= len(places) <= _MOST_MOVED:
        return places
    nodes = sorted(places)
    start = np.array([places[i] for i in nodes]) * scale
    points = start.copy()
    for _ in range(100):
        near = _near_pairs(points, wide)
        if not near:
            break
        for i, j in near:
            gap = points[i] - points[j]
            length = float(np.hypot(*gap))
            # Nodes on the very same place leave it in directions of their own.
            turn = _TURN + 2.4 * j
            way = gap / length if length > 1e-6 * wide else np.array([math.cos(turn), math.sin(turn)])
            push = max(0.0, 0.51 * (1.03 * wide - length)) * way
            points[i] += push
            points[j] -= push
    moved = (points != start).any(axis=1)
    return {
        node: (float(x), float(y)) if away else places[node]
        for node, away, (x, y) in zip(nodes, moved, points / scale, strict=True)
    }


def _near_pairs(points: np.ndarray, wide: float) -> list[tuple[int, int]]:
    """Return the pairs of points nearer than ``wide``, in order; work grows with what lies near in one direction."""
    order = np.argsort(points[:, 0], kind="stable")
    along = points[order]
    found: list[tuple[int, int]] = []
    for ahead in range(1, len(points)):
        apart = along[ahead:] - along[:-ahead]
        if not (apart[:, 0] < wide).any():
            break
        close = np.flatnonzero(np.hypot(apart[:, 0], apart[:, 1]) < wide)
        pairs = np.sort(np.stack([order[close], order[close + ahead]], axis=1), axis=1)
        found += map(tuple, pairs.tolist())
    return sorted(found)


def _sides(graph: Digraph, marks: Marks) -> Positions:
    """Return places: S1 left, S2 right, above them the malicious nodes outside both, below them all others."""
    others = frozenset(range(graph.n)) - marks.S1 - marks.S2 - marks.M
    apart = marks.M - marks.S1 - marks.S2
    places: Positions = {}
    radius = {name: 0.3 * math.sqrt(max(len(group), 2)) for name, group in
              (("S1", marks.S1), ("S2", marks.S2), ("M", apart), ("rest", others))}  # fmt: skip
    between = max(0.3, (radius["M"] if apart else 0.0), (radius["rest"] if others else 0.0))
    tall = max(radius["S1"], radius["S2"])
    # Arcs between the sides run through the middle: nobody stands in it.
    centres = {
        "S1": (-between - radius["S1"] - 0.45, 0.0),
        "S2": (between + radius["S2"] + 0.45, 0.0),
        "M": (0.0, 0.5 * tall + radius["M"]),
        "rest": (0.0, -0.5 * tall - radius["rest"]),
    }
    at_ends = {node for arc in marks.counted | marks.silenced for node in arc}
    for name, group in (("S1", marks.S1), ("S2", marks.S2), ("M", apart), ("rest", others)):
        if len(group) <= _MOST_ON_A_CIRCLE:
            places.update(_circle(sorted(group), centres[name], radius[name]))
        else:
            # Those that arcs between the sides join stand where the sides face each other.
            facing_first = sorted(group, key=lambda node: (node not in at_ends, node))
            places.update(_disc(facing_first, centres[name], radius[name]))
    return places


def _circle(nodes: list[int], centre: tuple[float, float], radius: float) -> Positions:
    if len(nodes) == 1:
        return {nodes[0]: centre}
    turn = 2 * math.pi / max(len(nodes), 1)
    return {
        node: (centre[0] + radius * math.cos(_TURN + k * turn), centre[1] + radius * math.sin(_TURN + k * turn))
        for k, node in enumerate(nodes)
    }


def _disc(nodes: list[int], centre: tuple[float, float], radius: float) -> Positions:
    """Return places that fill a disc evenly, as seeds do in a sunflower (Vogel, 1979); the first nearest the origin."""
    golden = math.pi * (3 - math.sqrt(5))
    seeds = []
    for k in range(len(nodes)):
        away = radius * math.sqrt((k + 0.5) / len(nodes))
        seeds.append((centre[0] + away * math.cos(k * golden), centre[1] + away * math.sin(k * golden)))
    return dict(zip(nodes, sorted(seeds, key=lambda seed: math.hypot(*seed)), strict=True))


def _spread(graph: Digraph) -> Positions:
    """Return places: the parts of a network that no link joins side by side, the largest first, as in a text."""
    shape = nx.Graph()
    shape.add_nodes_from(range(graph.n))
    shape.add_edges_from(graph.arcs())
    parts = sorted((sorted(part) for part in nx.connected_components(shape)), key=lambda part: (-len(part), part))
    if len(parts) < 2:
        return _part(shape, 1.0)
    radii = [math.sqrt(len(part) - 0.9) for part in parts]
    line = max(2 * radii[0], 2.4 * math.sqrt(sum((radius + 0.3) ** 2 for radius in radii)))
    places: Positions = {}
    x = y = 0.0
    tall = 2 * radii[0]
    for part, radius in zip(parts, radii, strict=True):
        if x > 0 and x + 2 * radius > line:
            x, y, tall = 0.0, y - tall - 0.7, 2 * radius
        inner = _part(shape.subgraph(part), radius)
        places.update({node: (x + radius + across, y - tall / 2 + up) for node, (across, up) in inner.items()})
        x += 2 * radius + 0.7
    return places


def _part(shape: nx.Graph, radius: float) -> Positions:
    """Return places within this distance: on a circle for dense and for small graphs, else by springs, fixed start."""
    nodes = sorted(shape)
    if len(nodes) < 3 or nx.density(shape) > _DENSE:
        return _circle(nodes, (0.0, 0.0), radius)
    if len(nodes) >= LARGE:
        return {
            node: (x, y) for node, (x, y) in zip(nodes, (radius * large_layout(shape, nodes)).tolist(), strict=True)
        }
    placed = nx.spring_layout(shape, seed=1, iterations=300, k=1.6 / math.sqrt(len(nodes)), scale=radius)
    return {node: (float(place[0]), float(place[1])) for node, place in placed.items() if np.isfinite(place).all()}
