"""The one graph type of the toolkit: an immutable digraph with canonical node ids.

An arc ``(u, v)`` means *v hears u*, as everywhere in the field; an undirected edge is two arcs.
Ids ``0..n-1`` follow the canonical label order of :mod:`certificates.graph`, so that equal graphs have
equal ids, equal bytes and an equal SHA-256, however they were built.
"""

from __future__ import annotations

import warnings
from collections.abc import Hashable, Iterable, Mapping, Set
from functools import cached_property
from typing import TYPE_CHECKING, Any, final

import numpy as np
import numpy.typing as npt

from certificates.errors import MalformedGraph
from certificates.graph import Label, digest, encode_graph, label_key
from robustness.errors import InvalidGraph

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["Digraph", "GraphLike", "GraphWarning", "as_digraph"]


class GraphWarning(UserWarning):
    """Something in the input was dropped because no definition depends on it."""


@final
class Digraph:
    """An immutable digraph: labels in canonical order and, for every node, its in-neighbours.

    Parameters
    ----------
    labels : iterable of int, str or tuples of these
        The nodes, in any order. ``1`` and ``'1'`` are two nodes.
    arcs : iterable of pairs of labels
        ``(u, v)``: v hears u. Repeated arcs count once (``N_i`` is a set). Self-loops are dropped with a
        :class:`GraphWarning`: a node of S is never outside S, so no definition sees them.
    directed : bool
        Whether the source was a directed graph; only shown to the user, never used in mathematics.

    Raises
    ------
    InvalidGraph
        For a repeated label, an arc with an unknown end, or a label of another type.

    Notes
    -----
    Memory is linear in nodes plus arcs (``in_indptr`` and ``in_indices`` are the usual compressed rows);
    bit masks, quadratic in the worst case, are made only when an algorithm asks for them.

    >>> graph = Digraph("ab", [("a", "b")])
    >>> graph.n, graph.arc_count, graph.in_masks
    (2, 1, (0, 1))
    """

    labels: tuple[Label, ...]
    directed: bool
    in_indptr: npt.NDArray[np.int64]
    in_indices: npt.NDArray[np.int32]

    def __init__(
        self, labels: Iterable[Hashable], arcs: Iterable[tuple[Hashable, Hashable]], *, directed: bool = True
    ) -> None:
        given = list(labels)
        plain = {label: _plain(label) for label in given}
        if len(plain) != len(given):
            raise InvalidGraph("node labels are distinct, but one is given twice: give every node its own label")
        self.labels = tuple(_canonical_order(plain.values()))
        place = {label: i for i, label in enumerate(self.labels)}
        index = {label: place[value] for label, value in plain.items()}
        try:
            ends = np.fromiter((index[end] for arc in arcs for end in arc), dtype=np.int64).reshape(-1, 2)
        except KeyError as unknown:
            raise InvalidGraph(f"an arc joins two nodes of the graph, but {unknown} is none: add the node") from None
        loops = ends[:, 0] == ends[:, 1]
        if loops.any():
            warnings.warn(
                f"{int(loops.sum())} self-loop(s) dropped: no robustness definition depends on them",
                GraphWarning,
                stacklevel=2,
            )
            ends = ends[~loops]
        codes = np.sort(ends[:, 1] * len(given) + ends[:, 0])
        heads, tails = np.divmod(codes[np.diff(codes, prepend=-1) > 0], max(len(given), 1))
        self.in_indptr = np.searchsorted(heads, np.arange(len(given) + 1)).astype(np.int64)
        self.in_indices = tails.astype(np.int32)
        self.in_indptr.setflags(write=False)
        self.in_indices.setflags(write=False)
        self.directed = directed

    @classmethod
    def from_networkx(cls, graph: nx.Graph) -> Digraph:
        """Return the digraph of a networkx graph, which is read and never changed.

        Undirected edges become two arcs; parallel edges of a multigraph count once, with a
        :class:`GraphWarning`; attributes and weights are ignored.
        """
        arcs: list[tuple[Hashable, Hashable]] = [(edge[0], edge[1]) for edge in graph.edges()]
        if graph.is_multigraph() and len({frozenset(a) if not graph.is_directed() else a for a in arcs}) < len(arcs):
            warnings.warn("parallel edges count once: N_i is a set", GraphWarning, stacklevel=2)
        if not graph.is_directed():
            arcs += [(v, u) for u, v in arcs if u != v]
        return cls(graph.nodes(), arcs, directed=graph.is_directed())

    def to_networkx(self) -> nx.Graph:
        """Return a new networkx graph: a ``Graph`` when the source was undirected, else a ``DiGraph``."""
        import networkx as nx

        graph: nx.Graph = nx.DiGraph() if self.directed else nx.Graph()
        graph.add_nodes_from(self.labels)
        graph.add_edges_from((self.labels[u], self.labels[v]) for u, v in self.arcs())
        return graph

    def without(self, removed: frozenset[int]) -> Digraph:
        """Return the graph without the nodes whose ids are in ``removed``."""
        kept = [label for i, label in enumerate(self.labels) if i not in removed]
        arcs = [(self.labels[u], self.labels[v]) for u, v in self.arcs() if u not in removed and v not in removed]
        return Digraph(kept, arcs, directed=self.directed)

    @property
    def n(self) -> int:
        """The number of nodes."""
        return len(self.labels)

    @property
    def arc_count(self) -> int:
        """The number of arcs; an undirected edge counts as two."""
        return len(self.in_indices)

    def arcs(self) -> Iterable[tuple[int, int]]:
        """Return the arcs ``(u, v)`` as ids, sorted."""
        heads = self.heads
        order = np.lexsort((heads, self.in_indices))
        return zip(self.in_indices[order].tolist(), heads[order].tolist(), strict=True)

    @property
    def heads(self) -> npt.NDArray[np.int64]:
        """The receiver of every arc, shape ``(m,)``, beside its sender in ``in_indices``; made anew, in linear time."""
        return np.repeat(np.arange(self.n, dtype=np.int64), self.in_degrees)

    def in_neighbours(self, node: int) -> npt.NDArray[np.int32]:
        """Return ``N_i``: the ids that node ``i`` hears, ascending."""
        return self.in_indices[self.in_indptr[node] : self.in_indptr[node + 1]]

    @cached_property
    def in_degrees(self) -> npt.NDArray[np.int64]:
        """``d_i = |N_i|`` for every id, shape ``(n,)``."""
        return np.diff(self.in_indptr)

    @cached_property
    def is_symmetric(self) -> bool:
        """Whether every arc has its reverse, as in an undirected graph."""
        heads = self.heads
        forward = heads * max(self.n, 1) + self.in_indices
        return bool(np.array_equal(forward, np.sort(self.in_indices.astype(np.int64) * max(self.n, 1) + heads)))

    @cached_property
    def in_masks(self) -> tuple[int, ...]:
        """``N_i`` as a Python integer for every id: bit ``j`` is set when i hears j."""
        return tuple(sum(1 << j for j in self.in_neighbours(i).tolist()) for i in range(self.n))

    @cached_property
    def in_words(self) -> npt.NDArray[np.uint64]:
        """``N_i`` as rows of 64-bit words, shape ``(n, ceil(n / 64))``: bit ``j % 64`` of word ``j // 64``."""
        words = np.zeros((self.n, max(1, -(-self.n // 64))), dtype=np.uint64)
        bits = np.uint64(1) << (self.in_indices % 64).astype(np.uint64)
        np.bitwise_or.at(words, (self.heads, self.in_indices // 64), bits)
        return words

    @cached_property
    def index(self) -> Mapping[Label, int]:
        """The id of every label."""
        return {label: i for i, label in enumerate(self.labels)}

    def ids(self, labels: Iterable[Hashable]) -> frozenset[int]:
        """Return the ids of ``labels``; an unknown label is an :class:`InvalidGraph` error."""
        try:
            return frozenset(self.index[_plain(label)] for label in labels)
        except KeyError as unknown:
            raise InvalidGraph(f"a node set holds nodes of the graph, but {unknown} is none") from None

    def labels_of(self, ids: Iterable[int]) -> frozenset[Label]:
        """Return the labels of ``ids``."""
        return frozenset(self.labels[i] for i in ids)

    def canonical_bytes(self) -> bytes:
        """Return the one byte string of this graph that certificates are bound to."""
        return encode_graph(self.labels, self.arcs())

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of :meth:`canonical_bytes`, lower-case hexadecimal."""
        return digest(self.canonical_bytes())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Digraph):
            return NotImplemented
        return (
            # Comparing the bytes would do; this stops at the first difference.
            self.labels == other.labels
            and np.array_equal(self.in_indptr, other.in_indptr)
            and np.array_equal(self.in_indices, other.in_indices)
        )

    def __hash__(self) -> int:
        return hash(self.sha256)

    def __repr__(self) -> str:
        kind = "directed" if self.directed else "undirected"
        return f"<Digraph {kind}, {self.n} nodes, {self.arc_count} arcs>"


#: What the public functions accept as a graph.
GraphLike = Any


def as_digraph(graph: GraphLike) -> Digraph:
    """Return ``graph`` as a :class:`Digraph`; networkx graphs are converted, anything else is refused."""
    if isinstance(graph, Digraph):
        return graph
    if hasattr(graph, "is_multigraph") and hasattr(graph, "edges"):
        return Digraph.from_networkx(graph)
    raise InvalidGraph(
        f"a graph is a networkx Graph or DiGraph or a robustness.Digraph, not {type(graph).__name__}: "
        "convert it to networkx first"
    )


def _plain(label: Hashable) -> Label:
    """Return ``label`` with numpy scalars made plain Python values."""
    if isinstance(label, np.generic):
        label = label.item()
    if type(label) is tuple:
        return tuple(_plain(part) for part in label)
    if isinstance(label, str) and type(label) is not str:
        return str(label)
    return label  # type: ignore[return-value]  # label_key refuses every other type


def _canonical_order(labels: Iterable[Label] | Set[Label]) -> list[Label]:
    try:
        return sorted(labels, key=label_key)
    except MalformedGraph as problem:
        raise InvalidGraph(str(problem)) from None
