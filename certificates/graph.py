"""The canonical graph: a label table in a fixed order and the sorted arcs, one byte string per graph.

A certificate speaks about node *ids*; this module fixes which id every label has and which bytes the
SHA-256 in a certificate is taken of. Two graphs have the same bytes exactly when they have the same
labels (``1`` and ``'1'`` differ) and the same arcs, however they were built or stored.

An arc ``(u, v)`` means *v hears u*; ``u`` is then an in-neighbour of ``v``. An undirected edge is two arcs.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from certificates.errors import MalformedGraph
from certificates.strict_json import parse

__all__ = ["FORMAT", "CanonicalGraph", "Label", "decode_graph", "digest", "encode_graph", "label_key"]

FORMAT = "robustness/graph/1"

#: What may name a node: an integer, a string, or a tuple of labels (grid graphs use pairs).
Label = int | str | tuple["Label", ...]

_LABEL_LIMIT = 2**63
_LABEL_DEPTH = 8


def label_key(label: object, depth: int = 0) -> tuple[int, object]:
    """Return the sort key of ``label``: integers by value, then strings by code point, then tuples.

    Raises
    ------
    MalformedGraph
        When the label is of another type, or out of the bounds of the format.
    """
    if type(label) is int:
        if not -_LABEL_LIMIT <= label < _LABEL_LIMIT:
            raise MalformedGraph(f"integer labels lie in -2**63..2**63-1, not {label:#x}: relabel the node")
        return (0, label)
    if type(label) is str:
        if any("\ud800" <= character <= "\udfff" for character in label):
            raise MalformedGraph(f"a string label holds Unicode text without lone surrogates, not {label[:40]!r}")
        return (1, label)
    if type(label) is tuple and depth < _LABEL_DEPTH:
        return (2, tuple(label_key(part, depth + 1) for part in label))
    raise MalformedGraph(
        f"a node label is an int, a str or a tuple of these (at most {_LABEL_DEPTH} deep), "
        f"not {type(label).__name__}: relabel the nodes, for example with networkx.convert_node_labels_to_integers"
    )


def encode_graph(labels: Sequence[Label], arcs: Iterable[tuple[int, int]]) -> bytes:
    """Return the canonical bytes of the graph with these labels (in canonical order) and sorted arcs of ids."""
    document = {"arcs": [[u, v] for u, v in arcs], "format": FORMAT, "labels": labels}
    return json.dumps(document, ensure_ascii=True, separators=(",", ":"), sort_keys=True).encode("ascii")


def digest(canonical: bytes) -> str:
    """Return the SHA-256 of canonical graph bytes in lower-case hexadecimal: what a certificate is bound to."""
    return hashlib.sha256(canonical).hexdigest()


@dataclass(frozen=True, slots=True)
class CanonicalGraph:
    """What the checker works on: for every id the ascending ids it hears, and the digest of the canonical bytes."""

    labels: tuple[Label, ...]
    hears: tuple[tuple[int, ...], ...]
    sha256: str

    @property
    def n(self) -> int:
        """The number of nodes."""
        return len(self.labels)

    @property
    def arc_count(self) -> int:
        """The number of arcs; an undirected edge counts as two."""
        return sum(map(len, self.hears))


#: Bytes of a graph that are read at most.
MAX_GRAPH_BYTES = 2**28


def decode_graph(data: bytes) -> CanonicalGraph:
    """Return the graph in ``data``: canonical bytes, or a node-link JSON document as networkx writes it.

    Canonical bytes are accepted in their one spelling only. A node-link document is brought into it:
    attributes are ignored, an undirected edge is two arcs, self-loops and repeated arcs are dropped.

    Raises
    ------
    MalformedGraph
        When it is neither.
    """
    if len(data) > MAX_GRAPH_BYTES:
        raise MalformedGraph(f"a graph has at most {MAX_GRAPH_BYTES} bytes, not {len(data)}")
    document = parse(data, MalformedGraph, "the graph")
    if not isinstance(document, dict):
        raise MalformedGraph("the graph is a JSON object, canonical or node-link")
    if document.get("format") == FORMAT:
        graph = _from_canonical(document)
        if encode_graph(graph.labels, _arcs(graph.hears)) != data:
            raise MalformedGraph("the graph is not in canonical spelling (spaces, key order or escapes differ)")
        return graph
    return _from_node_link(document)


def _arcs(hears: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    return sorted((u, v) for v, heard in enumerate(hears) for u in heard)


def _from_canonical(document: dict[str, Any]) -> CanonicalGraph:
    if set(document) != {"arcs", "format", "labels"}:
        raise MalformedGraph("a canonical graph has exactly the keys arcs, format and labels")
    labels = valid_labels(document["labels"])
    keys = [label_key(label) for label in labels]
    if any(not a < b for a, b in pairwise(keys)):
        raise MalformedGraph("labels stand in strictly ascending canonical order")
    hears: list[list[int]] = [[] for _ in labels]
    last = (-1, -1)
    if not isinstance(document["arcs"], list):
        raise MalformedGraph("arcs is a list of pairs of ids")
    for arc in document["arcs"]:
        if not (isinstance(arc, list) and len(arc) == 2 and all(type(x) is int for x in arc)):
            raise MalformedGraph("an arc is a pair of ids")
        u, v = arc
        if not (0 <= u < len(labels) and 0 <= v < len(labels) and u != v and last < (u, v)):
            raise MalformedGraph("arcs join two different nodes and stand in strictly ascending order")
        last = (u, v)
        hears[v].append(u)
    return _graph(labels, hears)


def _from_node_link(document: dict[str, Any]) -> CanonicalGraph:
    nodes = document.get("nodes")
    edges = document.get("edges", document.get("links"))
    directed = document.get("directed", False)
    if not isinstance(nodes, list) or not isinstance(edges, list) or not isinstance(directed, bool):
        raise MalformedGraph("a node-link document has lists 'nodes' and 'edges' (or 'links') and a flag 'directed'")
    if "edges" in document and "links" in document:
        raise MalformedGraph("a node-link document has 'edges' or 'links', not both")
    try:
        names = valid_labels([node["id"] for node in nodes])
        pairs = [tuple(valid_labels([edge["source"], edge["target"]])) for edge in edges]
    except (KeyError, TypeError):
        raise MalformedGraph("every node has an 'id', every edge a 'source' and a 'target'") from None
    labels = sorted(names, key=label_key)
    index = {label: i for i, label in enumerate(labels)}
    if len(index) != len(labels):
        raise MalformedGraph("node ids are distinct")
    heard: list[set[int]] = [set() for _ in labels]
    for source, target in pairs:
        if source not in index or target not in index:
            raise MalformedGraph("an edge joins two nodes of the document")
        if source != target:
            heard[index[target]].add(index[source])
            if not directed:
                heard[index[source]].add(index[target])
    return _graph(labels, [sorted(ids) for ids in heard])


def _graph(labels: Sequence[Label], hears: Sequence[Sequence[int]]) -> CanonicalGraph:
    sha256 = digest(encode_graph(labels, _arcs(hears)))
    return CanonicalGraph(tuple(labels), tuple(map(tuple, hears)), sha256)


def valid_labels(values: object) -> list[Label]:
    if not isinstance(values, list):
        raise MalformedGraph("labels is a list")
    return [_label(value, 0) for value in values]


def _label(value: Any, depth: int) -> Label:
    if type(value) is list and depth <= _LABEL_DEPTH:
        value = tuple(_label(part, depth + 1) for part in value)
    label_key(value)
    return value  # type: ignore[no-any-return]  # label_key refuses every other type
