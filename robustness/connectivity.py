"""Vertex separators of small graphs and digraphs, by trying them in order of size.

networkx' ``node_connectivity`` is not used: for digraphs it chooses the nodes it compares by total degree and so misses
nodes that hear nothing (on ``0 <-> 1, 2 -> 0, 2 -> 1`` it says 2, and the digraph is not strongly connected).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

from robustness.digraph import Digraph

__all__ = ["Separation", "smallest_separation"]


class Separation(NamedTuple):
    """Without ``separator`` only the nonempty sets ``sources`` and ``sinks`` are left, and no sink hears a source."""

    separator: frozenset[int]
    sources: frozenset[int]
    sinks: frozenset[int]


def smallest_separation(graph: Digraph, below: int) -> Separation | None:
    """Return a separation with the smallest separator, if one has fewer than ``below`` nodes, and None otherwise.

    An undirected graph is separated when it is disconnected, a digraph when it is not strongly connected. Time
    ``O(n C(n, below - 1))`` steps on bit masks.
    """
    hears = graph.in_masks
    heard_by = [sum(1 << v for v in range(graph.n) if hears[v] >> u & 1) for u in range(graph.n)]
    everyone = (1 << graph.n) - 1
    for size in range(min(below, graph.n - 1)):
        for removed in combinations(range(graph.n), size):
            separator = sum(1 << i for i in removed)
            left = everyone & ~separator
            root = left & -left
            reached = _closure(root, left, heard_by)
            if reached != left:  # no node beyond hears a node that hears the root, however indirectly
                return _separation(separator, reached, left & ~reached)
            if graph.directed and (reaching := _closure(root, left, hears)) != left:
                return _separation(separator, left & ~reaching, reaching)
    return None


def _closure(start: int, within: int, neighbours: Sequence[int]) -> int:
    found = fresh = start
    while fresh:
        lowest = fresh & -fresh
        fresh ^= lowest
        new = neighbours[lowest.bit_length() - 1] & within & ~found
        found |= new
        fresh |= new
    return found


def _separation(*masks: int) -> Separation:
    return Separation(*(frozenset(i for i in range(mask.bit_length()) if mask >> i & 1) for mask in masks))
