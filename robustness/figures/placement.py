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
from robustness.places import place_of, two_numbers

__all__ = ["Positions", "positions_for", "positions_in"]

#: Where each node stands, by id.
Positions = dict[int, tuple[float, float]]

#: The angle of the first node of a circle: nearly upright, so that two or four nodes do not lie on one line with those
#: of another circle beside it.
_TURN = 1.25

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


def _sides(graph: Digraph, marks: Marks) -> Positions:
    """Return places: S1 left, S2 right, above them the malicious nodes outside both, below them all others."""
    others = frozenset(range(graph.n)) - marks.S1 - marks.S2 - marks.M
    apart = marks.M - marks.S1 - marks.S2
    places: Positions = {}
    radius = {name: 0.3 * math.sqrt(max(len(group), 2)) for name, group in
              (("S1", marks.S1), ("S2", marks.S2), ("M", apart), ("rest", others))}  # fmt: skip
    wide = max(radius["S1"], radius["S2"], (radius["M"] if apart else 0.0), (radius["rest"] if others else 0.0))
    reach = wide + max(radius["S1"], radius["S2"]) + 0.45
    tall = max(radius["S1"], radius["S2"])
    centres = {
        "S1": (-reach, 0.0),
        "S2": (reach, 0.0),
        "M": (0.0, (tall + radius["M"]) * 0.75 if others else 0.0),
        "rest": (0.0, -(tall + radius["rest"]) * 0.75 if apart else 0.0),
    }
    for name, group in (("S1", marks.S1), ("S2", marks.S2), ("M", apart), ("rest", others)):
        places.update(_circle(sorted(group), centres[name], radius[name]))
    return places


def _circle(nodes: list[int], centre: tuple[float, float], radius: float) -> Positions:
    if len(nodes) == 1:
        return {nodes[0]: centre}
    turn = 2 * math.pi / max(len(nodes), 1)
    return {
        node: (centre[0] + radius * math.cos(_TURN + k * turn), centre[1] + radius * math.sin(_TURN + k * turn))
        for k, node in enumerate(nodes)
    }


def _spread(graph: Digraph) -> Positions:
    """Return places: on a circle for dense and for small graphs, otherwise by springs from a fixed start."""
    shape = nx.Graph()
    shape.add_nodes_from(range(graph.n))
    shape.add_edges_from(graph.arcs())
    if graph.n < 3 or nx.density(shape) > _DENSE:
        return _circle(list(range(graph.n)), (0.0, 0.0), 1.0)
    placed = nx.spring_layout(shape, seed=1, iterations=300, k=1.6 / math.sqrt(graph.n))
    return {node: (float(place[0]), float(place[1])) for node, place in placed.items() if np.isfinite(place).all()}
