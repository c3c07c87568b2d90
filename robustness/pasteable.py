"""Networkx graphs whose ``repr`` can be pasted into a program, for what a failing test prints."""

from __future__ import annotations

import networkx as nx

__all__ = ["PasteableDiGraph", "PasteableGraph"]


class PasteableGraph(nx.Graph):  # type: ignore[misc]  # networkx publishes no types
    """An undirected graph that prints as the call of ``nx.Graph`` which makes an equal one.

    >>> PasteableGraph([(0, 1), (1, 2)])
    nx.Graph({0: [1], 1: [2], 2: []})
    """

    def __repr__(self) -> str:
        place = {node: k for k, node in enumerate(self)}
        rows = {u: [v for v in self[u] if place[u] <= place[v]] for u in self}
        return f"nx.Graph({rows!r})"


class PasteableDiGraph(nx.DiGraph):  # type: ignore[misc]  # networkx publishes no types
    """A directed graph that prints as the call of ``nx.DiGraph`` which makes an equal one.

    >>> PasteableDiGraph([(0, 1), (1, 0)])
    nx.DiGraph({0: [1], 1: [0]})
    """

    def __repr__(self) -> str:
        rows = {u: list(self[u]) for u in self}
        return f"nx.DiGraph({rows!r})"
