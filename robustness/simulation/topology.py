"""Which links exist at which step, as one table of arcs for the whole run.

The arcs of all steps together are numbered once, receiver-major; a step says which of them exist. A vehicle may
use a link that has gone for as long as the value it carried is at most tau steps old (the source paper's remark
on time-varying networks).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidGraph, InvalidParameter
from robustness.spelled import counted
from robustness.time_varying import TimeVaryingGraph

__all__ = ["Topology", "as_topology", "extended_by"]


@dataclass(frozen=True)
class Topology:
    """A sequence of digraphs on one node set.

    Attributes
    ----------
    graphs : tuple of Digraph
        The different graphs that occur.
    sequence : tuple of int
        The graph of step k is ``graphs[sequence[k]]``; after the last entry the sequence starts again.
    """

    graphs: tuple[Digraph, ...]
    sequence: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        if not self.graphs or not self.sequence:
            raise InvalidParameter("a topology has at least one graph and one step: give one")
        for place in self.sequence:
            if type(place) is not int or not 0 <= place < len(self.graphs):
                raise InvalidParameter(
                    f"the graph of a step is a number from 0 to {len(self.graphs) - 1}, not {place!r}"
                )
        for graph in self.graphs:
            if graph.labels != self.graphs[0].labels:
                raise InvalidGraph("the graphs of a time-varying network have one node set: add the missing nodes")

    @property
    def fixed(self) -> bool:
        """Whether the links are the same at every step."""
        return len(self.graphs) == 1

    @cached_property
    def union(self) -> Digraph:
        """All links that ever exist."""
        if self.fixed:
            return self.graphs[0]
        labels = self.graphs[0].labels
        arcs = {arc for graph in self.graphs for arc in graph.arcs()}
        return Digraph(labels, ((labels[u], labels[v]) for u, v in arcs))

    @cached_property
    def _present(self) -> npt.NDArray[np.uint8]:
        """Row g: which arcs of the union graph g has, as kernel status, shape ``(graphs, A)``."""
        table = self.union
        codes = table.heads * table.n + table.in_indices
        rows = [np.isin(codes, g.heads * g.n + g.in_indices).astype(np.uint8) for g in self.graphs]
        return np.stack(rows)

    def present(self, step: int) -> npt.NDArray[np.uint8]:
        """Return which arcs of :attr:`union` exist at this step, shape ``(A,)``; before step 0 as at step 0."""
        return np.asarray(self._present[self.sequence[max(step, 0) % len(self.sequence)]])


def as_topology(network: GraphLike | Callable[[int], GraphLike], steps: int) -> Topology:
    """Return the topology of a run of ``steps`` steps.

    Parameters
    ----------
    network : Topology, networkx graph, Digraph, TimeVaryingGraph or callable
        A fixed graph; a time-varying graph; or a callable from the step to a graph.
    steps : int
        How many steps are asked for; a callable is asked exactly once for each.

    Raises
    ------
    InvalidParameter
        When a finite trace is shorter than the run.
    """
    if isinstance(network, Topology):
        return network
    if isinstance(network, Digraph) or hasattr(network, "is_multigraph"):
        return Topology((as_digraph(network),))
    if isinstance(network, TimeVaryingGraph):
        if network.period is None and len(network) < steps:
            raise InvalidParameter(
                f"a finite trace of {counted(len(network), 'step')} has no step {steps - 1}: give it a period"
            )
        # What repeats from the first step on is kept as one turn; after a prefix, the steps are written out.
        length = len(network) if network.period == len(network) else max(steps, 1)
        stored = [network.stored_step(step) for step in range(length)]
        place = {k: at for at, k in enumerate(dict.fromkeys(stored))}
        return Topology(tuple(network.graph_at(k) for k in place), tuple(place[k] for k in stored))
    if not callable(network):
        raise InvalidGraph(f"a network is a graph, or gives one for every step, not {type(network).__name__}")
    numbered: dict[Digraph, int] = {}
    # Every answer is read anew: a callable may hand out one networkx graph that it changes in between.
    sequence = [numbered.setdefault(as_digraph(network(step)), len(numbered)) for step in range(max(steps, 1))]
    return Topology(tuple(numbered), tuple(sequence))


def extended_by(topology: Topology, links: Iterable[tuple[Hashable, Hashable]], malicious: frozenset[int]) -> Topology:
    """Return the topology with extra links at every step: adversaries that extend the network.

    Parameters
    ----------
    topology : Topology
    links : iterable of pairs of labels
        ``(u, v)``: v now hears u as well.
    malicious : frozenset of int
        Only these may add links, and only from themselves.

    Raises
    ------
    InvalidParameter
        When a link starts at a normal node.
    """
    extra = list(links)
    if not extra:
        return topology
    first = topology.graphs[0]
    for sender, _ in extra:
        if not first.ids([sender]) <= malicious:
            raise InvalidParameter(f"only malicious nodes add links, from themselves, but {sender!r} is normal")
    graphs = []
    for graph in topology.graphs:
        labels = graph.labels
        arcs = [(labels[u], labels[v]) for u, v in graph.arcs()] + extra
        graphs.append(Digraph(labels, arcs))
    return Topology(tuple(graphs), topology.sequence)
