"""Time-varying graphs: a finite trace, a periodic sequence, or a prefix followed by a period.

``G[k] = (V, E[k])`` has one fixed node set V and at every step k its own arcs. What is stored is the set of
arcs that ever occur (the *arc universe*) and, for every stored step, which of them it has.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from itertools import chain
from typing import Any, final

import numpy as np
import numpy.typing as npt

from certificates.graph import Label
from robustness.digraph import Digraph, GraphLike, as_digraph, without_loops
from robustness.errors import InvalidGraph, InvalidParameter
from robustness.spelled import counted
from robustness.told import Told, drawing, small_picture

__all__ = ["SlidingUnion", "TimeVaryingGraph", "as_time_varying"]


@final
class TimeVaryingGraph(Told):
    """A sequence of graphs ``G[0], G[1], ...`` over one node set.

    Parameters
    ----------
    graphs : iterable of networkx graphs or Digraphs
        The stored steps, at least one, all with the same nodes.
    period : int or None
        None: a *finite trace*; nothing is known after the last step, and windows do not wrap.
        p: the last p stored steps repeat for ever, so windows wrap. With p equal to the number of stored steps the
        sequence is *periodic*, with a smaller p it is *eventually periodic*: a prefix, then the period.
    step_name : callable
        How messages call step k; readers of files add the place.

    Raises
    ------
    InvalidGraph
        When a step is not a graph or its node set differs from that of step 0; the message names the step.
    InvalidParameter
        When there is no step at all, or ``period`` is not in ``1..number of steps``.

    Notes
    -----
    Memory is linear in the arcs of all stored steps together.

    >>> import networkx as nx
    >>> links = [nx.Graph([(0, 1)]), nx.Graph([(1, 2)])]
    >>> for graph in links: graph.add_nodes_from(range(3))
    >>> sequence = TimeVaryingGraph(links, period=2)
    >>> sequence.union(1, 2).arc_count, list(sequence.window_starts(2))
    (4, [0, 1])
    >>> list(TimeVaryingGraph(links).window_starts(2))
    [0]
    """

    labels: tuple[Label, ...]
    #: How a reader took its file, in one line; empty for a sequence that came from none.
    read_as: str = ""
    #: Whether some step came from a directed graph; shown to the user, never used in mathematics.
    directed: bool
    period: int | None
    #: The arc universe: ``v * n + u`` for every arc (u, v) of any step, ascending.
    arc_codes: npt.NDArray[np.int64]
    #: For every stored step the ascending positions of its arcs in ``arc_codes``.
    step_arcs: tuple[npt.NDArray[np.int32], ...]

    def __init__(
        self,
        graphs: Iterable[GraphLike],
        period: int | None = None,
        *,
        step_name: Callable[[int], str] = "step {}".format,
    ) -> None:
        if not isinstance(graphs, Iterable):
            raise InvalidParameter(
                f"a time-varying graph is made of an iterable of graphs, not {type(graphs).__name__}; "
                "a function of the step goes to TimeVaryingGraph.from_function with a horizon"
            )
        codes: list[npt.NDArray[np.int64]] = []
        seen: dict[int, npt.NDArray[np.int64]] = {}
        keep_ids = isinstance(graphs, (list, tuple))  # their graphs live on, so an id names one graph
        labels: tuple[Label, ...] = ()
        index: Mapping[Label, int] = {}
        directed = False
        for k, graph in enumerate(graphs):
            if keep_ids and id(graph) in seen:
                codes.append(seen[id(graph)])
                continue
            if k == 0:
                frame = _nodes_of_step(graph, step_name(0))
                labels, index = frame.labels, frame.index
            step, step_directed = _arcs_of_step(graph, step_name(k), index)
            directed |= step_directed
            seen[id(graph)] = step
            codes.append(step)
        self._settle(labels, codes, period, directed)

    @classmethod
    def from_arcs(
        cls,
        nodes: Iterable[Hashable],
        steps: Iterable[Iterable[tuple[Hashable, Hashable]]],
        period: int | None = None,
        *,
        directed: bool = True,
        step_name: Callable[[int], str] = "step {}".format,
    ) -> TimeVaryingGraph:
        """Return the sequence on ``nodes`` whose step k has exactly the arcs ``steps[k]``.

        With ``directed=False`` every pair stands for both arcs. An arc with an unknown end is an
        :class:`InvalidGraph` error that names the step.
        """
        frame = Digraph(nodes, [])
        codes = []
        without_arcs = np.empty(0, np.int64)
        for k, arcs in enumerate(steps):
            pairs = list(arcs)
            if not pairs:  # most steps of many traces
                codes.append(without_arcs)
                continue
            if any(len(pair) != 2 for pair in pairs):
                raise InvalidGraph(f"{step_name(k)}: an arc is a pair (u, v) of nodes, and one is not")
            codes.append(_encode(pairs, step_name(k), frame.index, directed))
        sequence = cls.__new__(cls)
        sequence._settle(frame.labels, codes, period, directed)
        return sequence

    @classmethod
    def from_function(
        cls, function: Callable[[int], GraphLike], horizon: int, period: int | None = None
    ) -> TimeVaryingGraph:
        """Return the sequence with ``G[k] = function(k)`` for ``k = 0 .. horizon - 1``.

        ``function`` is called once per step in order, and its graph is read before the next call. Without a
        ``period`` the sequence is a finite trace of ``horizon`` steps: nothing is claimed beyond it.
        """
        if type(horizon) is not int or horizon < 1:
            raise InvalidParameter(f"the horizon is an integer of at least 1, not {horizon!r}")
        return cls((function(k) for k in range(horizon)), period)

    def _settle(
        self,
        labels: tuple[Label, ...],
        codes: Sequence[npt.NDArray[np.int64]],
        period: int | None,
        directed: bool,
    ) -> None:
        if not codes:
            raise InvalidParameter("a time-varying graph has at least one step, but none is given: add a graph")
        if period is not None and (type(period) is not int or not 1 <= period <= len(codes)):
            raise InvalidParameter(
                f"the period is an integer in 1..number of steps = 1..{len(codes)} or None, not {period!r}"
            )
        self.labels, self.period, self.directed = labels, period, directed
        every = np.concatenate(codes)
        self.arc_codes = np.unique(every)
        places = np.searchsorted(self.arc_codes, every).astype(np.int32)
        self.arc_codes.setflags(write=False)
        places.setflags(write=False)
        self.step_arcs = tuple(np.split(places, np.cumsum([len(step) for step in codes])[:-1]))

    @property
    def n(self) -> int:
        """The number of nodes."""
        return len(self.labels)

    @property
    def prefix(self) -> int:
        """The number of steps before the period; for a finite trace all of them."""
        return len(self) - (self.period or 0)

    def __len__(self) -> int:
        """Return the number of stored steps: the horizon of a trace, prefix plus period otherwise."""
        return len(self.step_arcs)

    def stored_step(self, k: int) -> int:
        """Return which stored step ``G[k]`` is; beyond the horizon of a finite trace it is an error."""
        if 0 <= k < len(self):
            return k
        if self.period is None or k < 0:
            raise InvalidParameter(f"a trace of {counted(len(self), 'step')} has steps 0..{len(self) - 1}, not {k}")
        return self.prefix + (k - self.prefix) % self.period

    def window_starts(self, length: int) -> range:
        """Return the starts of the windows of ``length`` steps that have to be looked at.

        Finite trace of T steps: ``0 .. T - length``; none when ``length > T``. Otherwise there is a window at every
        k >= 0, and the one at ``k >= prefix + period`` equals the one at ``k - period``: ``0 .. prefix + period - 1``.
        """
        if type(length) is not int or length < 1:
            raise InvalidParameter(f"a window has an integer number of steps of at least 1, not {length!r}")
        return range(max(0, len(self) - length + 1)) if self.period is None else range(len(self))

    def union(self, start: int, length: int) -> Digraph:
        """Return the union of ``G[start], ..., G[start + length - 1]``: all nodes, every arc of any of the steps."""
        window = SlidingUnion(self)
        window.move(start, length)
        return self.digraph(window.present)

    def graph_at(self, k: int) -> Digraph:
        """Return ``G[k]``."""
        return self.union(k, 1)

    def digraph(self, present: npt.NDArray[np.bool_]) -> Digraph:
        """Return the graph with the arcs of the universe that ``present``, shape ``(arcs,)``, marks."""
        heads, tails = np.divmod(self.arc_codes[present], max(self.n, 1))
        labels = self.labels
        arcs = ((labels[u], labels[v]) for u, v in zip(tails.tolist(), heads.tolist(), strict=True))
        return Digraph(labels, arcs, directed=self.directed)

    def summary(self) -> str:
        """Return what repeats and how large it is, in one line."""
        kind = {None: "finite trace", len(self): "periodic"}.get(self.period, f"prefix + period {self.period}")
        size = f"{counted(self.n, 'node')}, {counted(len(self), 'step')}"
        return f"{kind}, {size}, {counted(len(self.arc_codes), 'arc')} in all"

    def as_dict(self) -> dict[str, Any]:
        """Return what every document says about the sequence, as JSON-ready values; ``arcs`` are those of any step."""
        shape = {"nodes": self.n, "steps": len(self), "prefix": self.prefix, "period": self.period}
        return {**shape, "arcs": len(self.arc_codes), "directed": self.directed, "read_as": self.read_as or None}

    def evidence(self) -> list[tuple[str, str]]:
        """Return how the file was read, as a row of a name and a text."""
        return [("read as", self.read_as)] if self.read_as else []

    def _small_picture(self) -> str:
        return small_picture(self.n, lambda axes: drawing("network").draw(self, ax=axes))


class SlidingUnion:
    """The union over a window, kept while the window moves: how many of its steps have each arc.

    Moving on by one step costs the arcs of the two steps that enter and leave.
    """

    def __init__(self, sequence: TimeVaryingGraph) -> None:
        self._sequence = sequence
        self._start = self._stop = 0
        #: For every arc of the universe the number of steps of the window that have it.
        self.counts: npt.NDArray[np.int32] = np.zeros(len(sequence.arc_codes), dtype=np.int32)
        #: For every arc of the union the last step of the window that has it: it stays at least until then.
        self.last: npt.NDArray[np.int64] = np.zeros(len(sequence.arc_codes), dtype=np.int64)

    def move(self, start: int, length: int) -> None:
        """Make this the window of ``length`` steps from ``start``.

        A window of an eventually periodic sequence that is longer than prefix + period has the arcs of the one of
        just that length, so a longer one is never counted through.
        """
        sequence = self._sequence
        if sequence.period is not None:
            length = min(length, len(sequence))
        stop = start + length
        if start < self._start or stop < self._stop or start > self._stop:
            self.counts[:] = 0
            self._start = self._stop = start
        for k in range(self._stop, stop):
            arcs = sequence.step_arcs[sequence.stored_step(k)]
            self.counts[arcs] += 1
            self.last[arcs] = k
        for k in range(self._start, start):
            self.counts[sequence.step_arcs[sequence.stored_step(k)]] -= 1
        self._start, self._stop = start, stop

    @property
    def present(self) -> npt.NDArray[np.bool_]:
        """Which arcs of the universe the union has, shape ``(arcs,)``."""
        return self.counts > 0

    def lasting(self, ahead: int) -> npt.NDArray[np.bool_]:
        """Return the arcs that this union and the ``ahead`` next ones, as far as there are any, have in common."""
        probe = SlidingUnion(self._sequence)
        probe.counts, probe._start, probe._stop = self.counts.copy(), self._start, self._stop
        length, common = self._stop - self._start, self.present
        if self._sequence.period is None:
            ahead = min(ahead, len(self._sequence) - self._stop)
        for start in range(self._start + 1, self._start + ahead + 1):
            probe.move(start, length)
            common &= probe.present
        return common


def as_time_varying(sequence: Any) -> TimeVaryingGraph:
    """Return ``sequence`` itself, or the finite trace of an iterable of graphs."""
    if isinstance(sequence, TimeVaryingGraph):
        return sequence
    if isinstance(sequence, (list, tuple)):
        return TimeVaryingGraph(sequence)
    raise InvalidParameter(
        f"a time-varying graph is a TimeVaryingGraph or a list of graphs, not {type(sequence).__name__}"
    )


def _digraph_of_step(graph: GraphLike, name: str) -> Digraph:
    try:
        return as_digraph(graph)
    except InvalidGraph as problem:
        raise InvalidGraph(f"{name}: {problem}") from None


def _nodes_of_step(graph: GraphLike, name: str) -> Digraph:
    """Return the nodes of step 0 without its arcs, which are read (and warned about) like those of every step."""
    if hasattr(graph, "is_multigraph") and hasattr(graph, "edges"):
        return Digraph(graph, [])
    return _digraph_of_step(graph, name)


def _arcs_of_step(graph: GraphLike, name: str, index: Mapping[Label, int]) -> tuple[npt.NDArray[np.int64], bool]:
    """Return the sorted arc codes of the graph of step k, and whether it is directed.

    A plain networkx graph is read directly: thousands of steps need no canonical order each.
    """
    if getattr(graph, "is_multigraph", lambda: True)() or not hasattr(graph, "edges"):
        graph = _digraph_of_step(graph, name)
    if isinstance(graph, Digraph):
        _require_same_nodes(set(graph.labels), name, index)
        return graph.heads * graph.n + graph.in_indices, graph.directed
    _require_same_nodes(set(graph), name, index)
    return _encode(graph.edges(), name, index, graph.is_directed()), graph.is_directed()


def _require_same_nodes(nodes: set[Any], name: str, index: Mapping[Label, int]) -> None:
    if nodes == index.keys():
        return
    odd = min(nodes ^ index.keys(), key=repr)
    what = f"node {odd!r} is new" if odd in nodes else f"node {odd!r} is missing"
    raise InvalidGraph(
        f"{name}: every step has the nodes of step 0, but {what}: add isolated nodes, so that all steps agree"
    )


def _encode(
    pairs: Iterable[tuple[Hashable, Hashable]], name: str, index: Mapping[Any, int], directed: bool
) -> npt.NDArray[np.int64]:
    """Return the sorted codes ``v * n + u`` of the arcs (u, v), or of both directions; self-loops go with a word."""
    n = len(index)
    try:
        ids = np.fromiter(map(index.__getitem__, chain.from_iterable(pairs)), dtype=np.int64).reshape(-1, 2)
    except (KeyError, TypeError) as unknown:
        raise InvalidGraph(f"{name}: an arc joins two nodes of the sequence, but {unknown} is none") from None
    ids = without_loops(ids, f"{name}: ", stacklevel=5)
    codes = ids @ np.array([1, n])
    return np.unique(codes if directed else np.concatenate([codes, ids @ np.array([n, 1])]))
