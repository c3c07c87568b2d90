"""The census: connected graphs between the paper's two conditions, with and without a trap."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robustness.constructions.small_graphs import (
    LARGEST_GRAPHS,
    Batch,
    batch_profiles,
    digraph_of_masks,
    graphs_up_to_isomorphism,
)
from robustness.cubes.executors import mapped
from robustness.digraph import Digraph
from robustness.traps import find_trap

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["CensusRow", "census", "count_row", "one_node_more"]


#: Graphs that a worker grows at a time.
_PART = 32


@dataclass(frozen=True, slots=True)
class CensusRow:
    """Connected graphs on n nodes for one f.

    Attributes
    ----------
    n, f : int
    connected : int
        How many connected graphs there are, up to isomorphism.
    promised : int
        How many of them are (2f+1)-robust.
    refuted : int
        How many are not (f+1,f+1)-robust.
    trapped, free : tuple of Digraph
        Those in between, with and without a trap for f.
    """

    n: int
    f: int
    connected: int
    promised: int
    refuted: int
    trapped: tuple[Digraph, ...]
    free: tuple[Digraph, ...]

    @property
    def gap(self) -> int:
        """How many graphs lie between the two conditions."""
        return len(self.trapped) + len(self.free)


def census(largest: int = 8, *, executor: Any = None) -> tuple[CensusRow, ...]:
    """Return the rows for n = 2 .. ``largest`` (at most 8) and every f that leaves a graph unrefuted.

    ``executor``, of ``concurrent.futures`` or a ``distributed.Client``, grows the graphs and looks for traps.

    >>> [(row.n, row.f, row.gap, len(row.free)) for row in census(5)]
    [(3, 1, 1, 0), (4, 1, 2, 1), (5, 1, 4, 0), (5, 2, 1, 0)]
    """
    rows = []
    for n in range(2, largest + 1):
        batch = (
            graphs_up_to_isomorphism(n)
            if n <= LARGEST_GRAPHS
            else one_node_more(graphs_up_to_isomorphism(n - 1), executor)
        )
        connected = [digraph_of_masks(masks, directed=False) for masks in batch[batch_profiles(batch)[:, 1] > 0]]
        for f in range(1, (n - 1) // 2 + 1):
            rows.append(count_row(n, f, connected, executor))
    return tuple(rows)


def one_node_more(batch: Batch, executor: Any = None) -> Batch:
    """Return all graphs with one node more than those in ``batch``, which are all of their size, up to isomorphism.

    Every graph arises from one of them by adding a node of its largest degree, so no other is tried. Those that agree
    in degrees and triangles around every node and its neighbours are compared by networkx.

    >>> [len(one_node_more(graphs_up_to_isomorphism(n))) for n in range(2, 6)]
    [4, 11, 34, 156]
    """
    parents = batch.tolist()
    parts = [parents] if executor is None else [parents[k : k + _PART] for k in range(0, len(parents), _PART)]
    seen: dict[object, list[nx.Graph]] = defaultdict(list)
    found = []
    for grown in (each for part in mapped(executor, _grown, parts) for each in part):
        if executor is None or _is_new(grown, seen):
            found.append(grown)
    return np.array(found, dtype=np.int64)


def _grown(parents: list[list[int]]) -> list[list[int]]:
    """Return what grows out of some graphs by a node of largest degree, up to isomorphism, in order."""
    seen: dict[object, list[Any]] = defaultdict(list)
    found = []
    n = len(parents[0]) + 1
    for masks in parents:
        for heard in range(1 << (n - 1)):
            grown = [mask | (heard >> i & 1) << (n - 1) for i, mask in enumerate(masks)] + [heard]
            if max(mask.bit_count() for mask in grown) > heard.bit_count():
                continue
            if _is_new(grown, seen):
                found.append(grown)
    return found


def _is_new(masks: list[int], seen: dict[object, list[Any]]) -> bool:
    """Return whether no graph seen is isomorphic, and remember it."""
    import networkx as nx

    graph = digraph_of_masks(np.array(masks, dtype=np.int64), directed=False).to_networkx()
    kind = {v: (graph.degree(v), triangles) for v, triangles in nx.triangles(graph).items()}
    key = tuple(sorted((kind[v], *sorted(kind[u] for u in graph[v])) for v in graph))
    if any(nx.is_isomorphic(graph, other) for other in seen[key]):
        return False
    seen[key].append(graph)
    return True


def _has_trap(question: tuple[tuple[int, ...], int]) -> bool:
    """Return whether the undirected graph with these masks has a trap for f."""
    masks, f = question
    return bool(find_trap(digraph_of_masks(np.array(masks, dtype=np.int64), directed=False), f).decided())


def count_row(n: int, f: int, connected: Iterable[Digraph], executor: Any = None) -> CensusRow:
    """Return the row of one f, given all connected graphs on n nodes up to isomorphism."""
    graphs = list(connected)
    profiles = batch_profiles(np.array([graph.in_masks for graph in graphs], dtype=np.int64))
    columns = profiles.shape[1]
    necessary = profiles[:, f + 1] >= f + 1 if f + 1 < columns else profiles[:, 0] < 0
    sufficient = profiles[:, 2 * f + 1] >= 1 if 2 * f + 1 < columns else profiles[:, 0] < 0
    trapped: list[Digraph] = []
    free: list[Digraph] = []
    between = [graphs[k] for k in (necessary & ~sufficient).nonzero()[0].tolist()]
    questions = [(tuple(graph.in_masks), f) for graph in between]
    for graph, is_trapped in zip(between, mapped(executor, _has_trap, questions), strict=True):
        (trapped if is_trapped else free).append(graph)
    return CensusRow(n, f, len(graphs), int(sufficient.sum()), int((~necessary).sum()), tuple(trapped), tuple(free))
