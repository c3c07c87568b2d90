"""Where the nodes of a large network stand: by distances from a few of them, and then by springs.

Distances from pivots give the outline in time linear in the links (Brandes and Pich, 2007: eigensolver methods for
progressive multidimensional scaling). Springs (Fruchterman and Reingold, 1991) then spread what has fallen together.
Neither needs more than numpy, and the same network gives the same places.
"""

from __future__ import annotations

from collections.abc import Sequence

import networkx as nx
import numpy as np

__all__ = ["LARGE", "large_layout"]

#: From so many nodes on; below, networkx' own springs take less than a second.
LARGE = 500

_PIVOTS = 50
_ROUNDS = 80

#: Springs, quadratic in the nodes, spread no larger network.
_MOST_SPREAD = 4000

#: Rows of the matrix of distances that are held at once.
_BLOCK = 256


def large_layout(shape: nx.Graph, nodes: Sequence[int]) -> np.ndarray:
    """Return places of the nodes of a connected graph, one row each, within a distance of 1 from the origin."""
    numbered = {node: k for k, node in enumerate(nodes)}
    links = np.array([(numbered[u], numbered[v]) for u, v in shape.edges if u != v])
    places = _by_distances(shape, nodes)
    if len(nodes) <= _MOST_SPREAD:
        places = _by_springs(places, links)
    places = places - places.mean(axis=0)
    farthest = max(float(np.hypot(places[:, 0], places[:, 1]).max()), 1e-9)
    return np.asarray(places / farthest)


def _by_distances(shape: nx.Graph, nodes: Sequence[int]) -> np.ndarray:
    """Return the two main directions of the distances from pivots, each as far from the others as can be."""
    pivot, nearest, columns = nodes[0], np.full(len(nodes), np.inf), []
    for _ in range(min(_PIVOTS, len(nodes))):
        away = nx.single_source_shortest_path_length(shape, pivot)
        columns.append(np.array([float(away[node]) for node in nodes]))
        nearest = np.minimum(nearest, columns[-1])
        pivot = nodes[int(nearest.argmax())]
    squares = np.stack(columns, axis=1) ** 2
    centred = squares - squares.mean(axis=0) - squares.mean(axis=1, keepdims=True) + squares.mean()
    directions = np.linalg.eigh(centred.T @ centred)[1][:, [-1, -2]]
    # A direction is known but for its sign.
    directions = directions * np.sign(directions[np.abs(directions).argmax(axis=0), [0, 1]])
    return np.asarray(centred @ directions)


def _by_springs(places: np.ndarray, links: np.ndarray) -> np.ndarray:
    """Return the places after rounds in which links pull and all nodes push, with shorter steps each time."""
    n = len(places)
    spread = np.ptp(places, axis=0).max() or 1.0
    # Leaves of one node are as far from every pivot: they start beside each other, not on each other.
    points = places / spread + 0.01 * np.random.default_rng(1).standard_normal(places.shape)
    ideal = 1.0 / np.sqrt(n)
    for step in np.linspace(0.05, 0.002, _ROUNDS):
        force = np.empty_like(points)
        for start in range(0, n, _BLOCK):
            apart = points[start : start + _BLOCK, None] - points[None]
            near = np.maximum((apart**2).sum(axis=2), 1e-8)
            force[start : start + _BLOCK] = (apart * (ideal**2 / near)[..., None]).sum(axis=1)
        along = points[links[:, 0]] - points[links[:, 1]]
        pull = along * (np.hypot(along[:, 0], along[:, 1]) / ideal)[:, None]
        np.add.at(force, links[:, 0], -pull)
        np.add.at(force, links[:, 1], pull)
        length = np.maximum(np.hypot(force[:, 0], force[:, 1]), 1e-9)
        points = points + force * (np.minimum(length, step) / length)[:, None]
    return points
