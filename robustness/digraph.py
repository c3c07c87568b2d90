"""The one graph type of the toolkit: an immutable digraph with canonical node ids.

An arc ``(u, v)`` means *v hears u*, as everywhere in the field; an undirected edge is two arcs.
Ids ``0..n-1`` follow the canonical label order of :mod:`certificates.graph`, so that equal graphs have
equal ids, equal bytes and an equal SHA-256, however they were built.
"""

from __future__ import annotations

import warnings
from collections.abc import Hashable, Iterable, Mapping, Sequence, Set
from enum import Enum
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NoReturn, final

import numpy as np
import numpy.typing as npt

from certificates.errors import MalformedGraph
from certificates.graph import Label, digest, encode_graph, label_key
from robustness.errors import InvalidGraph
from robustness.places import place_of
from robustness.spelled import counted
from robustness.told import Told, drawing, small_picture

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["Digraph", "GraphLike", "GraphWarning", "as_digraph", "plain_label", "without_loops"]


class GraphWarning(UserWarning):
    """Something in the input was dropped because no definition depends on it."""


@final
class Digraph(Told):
    """An immutable digraph: labels in canonical order and, for every node, its in-neighbours.

    Parameters
    ----------
    labels : iterable of hashable
        The nodes, in any order: integers, strings and tuples of these, as they are (``1`` and ``'1'`` are two nodes);
        any other label that has a stable text (a float, a member of an Enum, an address, a frozenset) by its text.
    arcs : iterable of pairs of labels
        ``(u, v)``: v hears u. Repeated arcs count once (``N_i`` is a set). Self-loops are dropped with a
        :class:`GraphWarning`: a node of S is never outside S, so no definition sees them.
    directed : bool
        Whether the source was a directed graph; only shown to the user, never used in mathematics. An arc without its
        reverse makes the graph directed, whatever is said here.

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
    _said_directed: bool
    #: What a reader took for granted, in one line; empty for a graph that came from no file.
    read_as: str
    #: What a file says of its nodes beside their labels (``pos``, ``label``, ``id``), by label; no mathematics sees it.
    node_attributes: Mapping[Label, Mapping[str, object]]
    #: What a file says of its links beside their ends (costs, weights), by the pair of labels as it names them.
    link_attributes: Mapping[tuple[Label, Label], Mapping[str, object]]
    in_indptr: npt.NDArray[np.int64]
    in_indices: npt.NDArray[np.int32]

    def __init__(
        self,
        labels: Iterable[Hashable],
        arcs: Iterable[tuple[Hashable, Hashable]],
        *,
        directed: bool = True,
        read_as: str = "",
        node_attributes: Mapping[Hashable, Mapping[str, object]] = MappingProxyType({}),
    ) -> None:
        given = list(labels)
        place = {label: i for i, label in enumerate(given)}
        try:
            ends = np.fromiter((place[end] for arc in arcs for end in arc), dtype=np.int64).reshape(-1, 2)
        except KeyError as unknown:
            raise InvalidGraph(f"an arc joins two nodes of the graph, but {unknown} is none: add the node") from None
        self._build(given, ends)
        self._said_directed = directed
        self.read_as = read_as
        self.node_attributes = {plain_label(node): values for node, values in node_attributes.items()}

    @classmethod
    def from_ends(
        cls,
        labels: Sequence[Hashable],
        ends: npt.NDArray[np.int64],
        *,
        directed: bool = True,
        read_as: str = "",
        node_attributes: Mapping[Hashable, Mapping[str, object]] = MappingProxyType({}),
    ) -> Digraph:
        """Return the digraph whose arcs join the labels at these places, shape ``(m, 2)``: without a loop over arcs."""
        graph = cls.__new__(cls)
        graph._build(labels, ends)
        graph._said_directed = directed
        graph.read_as = read_as
        graph.node_attributes = {plain_label(node): values for node, values in node_attributes.items()}
        return graph

    def _build(self, given: Sequence[Hashable], ends: npt.NDArray[np.int64]) -> None:
        """Set labels and rows from the labels in the order given and arcs between their places."""
        self.link_attributes = {}
        plain = [plain_label(label) for label in given]
        if len(set(plain)) < len(plain):
            _refuse_equal_texts(given, plain)
        self.labels = tuple(_canonical_order(plain))
        index = {label: i for i, label in enumerate(self.labels)}
        ends = np.array([index[label] for label in plain], dtype=np.int64)[ends] if len(ends) else ends
        ends = without_loops(ends, stacklevel=4)
        codes = np.sort(ends[:, 1] * len(given) + ends[:, 0])
        heads, tails = np.divmod(codes[np.diff(codes, prepend=-1) > 0], max(len(given), 1))
        self.in_indptr = np.searchsorted(heads, np.arange(len(given) + 1)).astype(np.int64)
        self.in_indices = tails.astype(np.int32)
        self.in_indptr.setflags(write=False)
        self.in_indices.setflags(write=False)

    @classmethod
    def from_networkx(cls, graph: nx.Graph) -> Digraph:
        """Return the digraph of a networkx graph, which is read and never changed.

        Undirected edges become two arcs; parallel edges of a multigraph count once, with a
        :class:`GraphWarning`; weights are ignored, and of attributes all but where a node stands, which is kept as
        ``pos`` for pictures.
        """
        arcs: list[tuple[Hashable, Hashable]] = [(edge[0], edge[1]) for edge in graph.edges()]
        if graph.is_multigraph() and len({frozenset(a) if not graph.is_directed() else a for a in arcs}) < len(arcs):
            warnings.warn("parallel edges count once: N_i is a set", GraphWarning, stacklevel=2)
        if not graph.is_directed():
            arcs += [(v, u) for u, v in arcs if u != v]
        places = ((node, place_of(data)) for node, data in graph.nodes(data=True) if data)
        attributes = {node: {"pos": place} for node, place in places if place is not None}
        return cls(graph.nodes(), arcs, directed=graph.is_directed(), node_attributes=attributes)

    @property
    def places(self) -> list[tuple[float, float]] | None:
        """Where the nodes stand, in the order of their ids; None unless every one has a place."""
        found = [place_of(self.node_attributes.get(label, {})) for label in self.labels]
        placed = [place for place in found if place is not None]
        return placed if placed and len(placed) == len(found) else None

    def to_networkx(self) -> nx.Graph:
        """Return a new networkx graph: a ``Graph`` when the source was undirected, else a ``DiGraph``.

        What the source said of its nodes (``pos``, ``label``, ``id``) are their attributes.
        """
        import networkx as nx

        graph: nx.Graph = nx.DiGraph() if self.directed else nx.Graph()
        graph.add_nodes_from((label, dict(self.node_attributes.get(label, {}))) for label in self.labels)
        graph.add_edges_from((self.labels[u], self.labels[v]) for u, v in self.arcs())
        return graph

    def without(self, removed: frozenset[int]) -> Digraph:
        """Return the graph without the nodes whose ids are in ``removed``."""
        kept = [label for i, label in enumerate(self.labels) if i not in removed]
        arcs = [(self.labels[u], self.labels[v]) for u, v in self.arcs() if u not in removed and v not in removed]
        data: dict[Hashable, Mapping[str, object]] = {
            label: self.node_attributes[label] for label in kept if label in self.node_attributes
        }
        return Digraph(kept, arcs, directed=self.directed, read_as=self.read_as, node_attributes=data)

    @cached_property
    def directed(self) -> bool:
        """Whether the source was a directed graph, or some arc has no reverse: never an undirected network that is."""
        return self._said_directed or not self.is_symmetric

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
            return frozenset(self.index[plain_label(label)] for label in labels)
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

    def summary(self) -> str:
        """Return how large it is, in one line."""
        kind = "directed" if self.directed else "undirected"
        return f"{kind}, {counted(self.n, 'node')}, {counted(self.arc_count, 'arc')}"

    def as_dict(self) -> dict[str, Any]:
        """Return what every document says about the graph, as JSON-ready values; an undirected edge is two arcs.

        ``read_as`` says how its file was read; None for a graph that came from no file. The graph itself is in
        :meth:`canonical_bytes`.
        """
        shape = {"nodes": self.n, "arcs": self.arc_count, "directed": self.directed}
        return {**shape, "sha256": self.sha256, "read_as": self.read_as or None}

    def evidence(self) -> list[tuple[str, str]]:
        """Return what tells the graph from others, as rows of a name and a text."""
        return [("sha256", self.sha256), *([("read as", self.read_as)] if self.read_as else [])]

    def _small_picture(self) -> str:
        return small_picture(self.n, lambda axes: drawing("network").draw(self, ax=axes))


#: What the public functions accept as a graph.
GraphLike = Any


def as_digraph(graph: GraphLike) -> Digraph:
    """Return ``graph`` as a :class:`Digraph`.

    Graphs of networkx are converted; anything else is refused, with the function that converts it.
    """
    if isinstance(graph, Digraph):
        return graph
    if hasattr(graph, "is_multigraph") and hasattr(graph, "edges"):
        return Digraph.from_networkx(graph)
    raise InvalidGraph(
        f"a graph is a networkx Graph or DiGraph or a robustness.Digraph, not {type(graph).__name__}: "
        "robustness.from_adjacency takes a matrix, from_edges pairs, from_neighbours a dict, from_igraph a graph of "
        "igraph, read_topology a file"
    )


def without_loops(ends: npt.NDArray[np.int64], place: str = "", *, stacklevel: int) -> npt.NDArray[np.int64]:
    """Return arcs, shape ``(m, 2)``, without self-loops, which are dropped with a :class:`GraphWarning`."""
    loops = ends[:, 0] == ends[:, 1]
    if not loops.any():
        return ends
    warnings.warn(
        f"{place}{counted(int(loops.sum()), 'self-loop')} dropped: no robustness definition depends on them",
        GraphWarning,
        stacklevel=stacklevel,
    )
    kept: npt.NDArray[np.int64] = ends[~loops]
    return kept


def plain_label(label: Hashable) -> Label:
    """Return what stands for ``label`` in the canonical graph: itself, a plain value for a NumPy one, or its text.

    Integers, strings and tuples stand for themselves. Every other label stands for its text, so far as its type gives
    it one of its own: a frozenset for its members in order, a member of an Enum for its class and name.

    Raises
    ------
    InvalidGraph
        When the text would be another one in the next process, such as ``<object object at 0x...>``.
    """
    if isinstance(label, np.generic):
        label = label.item()
    if type(label) is int or type(label) is str:
        return label
    if isinstance(label, tuple):
        return tuple(plain_label(part) for part in label)
    if isinstance(label, Enum):
        return f"{type(label).__name__}.{label.name}"
    if isinstance(label, str):
        return str(label)
    if isinstance(label, frozenset):
        return "{" + ", ".join(sorted(str(plain_label(part)) for part in label)) + "}"
    kind = type(label)
    if (kind.__str__ is object.__str__ and kind.__repr__ is object.__repr__) or " at 0x" in (text := str(label)):
        raise InvalidGraph(
            f"a node label has a text that stays the same, and {kind.__name__} has none: give it __str__, or relabel "
            "the "
            "nodes, for example with networkx.convert_node_labels_to_integers"
        )
    return text


def _refuse_equal_texts(given: Sequence[Hashable], plain: Sequence[Label]) -> NoReturn:
    """Say which nodes are the same, or stand for the same label."""
    seen: dict[Label, Hashable] = {}
    for label, text in zip(given, plain, strict=True):
        if text in seen and seen[text] == label:
            break
        if text in seen:
            raise InvalidGraph(f"the nodes {seen[text]!r} and {label!r} have the same text {text!r}: relabel one")
        seen[text] = label
    raise InvalidGraph("node labels are distinct, but one is given twice: give every node its own label")


def _canonical_order(labels: Iterable[Label] | Set[Label]) -> list[Label]:
    try:
        return sorted(labels, key=label_key)
    except MalformedGraph as problem:
        raise InvalidGraph(str(problem)) from None
