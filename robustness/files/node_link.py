"""Node-link JSON, the default format: it keeps labels, isolated nodes and direction.

``{"directed": bool, "nodes": [{"id": label}, ...], "edges": [{"source": label, "target": label}, ...]}``.
The canonical form that certificates are bound to (``certify --canonical``) is read as well. ``links`` may stand for
``edges``; a list as label is a tuple; all other keys are ignored. It is read here and not by networkx, whose reader
merges repeated labels and invents nodes for edges that join none.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Hashable
from typing import Any

from certificates.errors import MalformedGraph
from certificates.graph import FORMAT as CANONICAL_FORMAT
from certificates.graph import decode_graph
from robustness.digraph import Digraph, GraphWarning
from robustness.errors import UnreadableTopology
from robustness.files.text import decode_utf8

__all__ = ["decode", "encode"]


def decode(data: bytes) -> Digraph:
    """Return the graph of node-link JSON."""
    document = _parse(decode_utf8(data))
    if not isinstance(document, dict):
        raise UnreadableTopology(f"node-link JSON is an object with 'nodes' and 'edges', not {_kind(document)}")
    if document.get("format") == CANONICAL_FORMAT:
        return _canonical(data)
    directed, multigraph = (_flag(document, key) for key in ("directed", "multigraph"))
    labels = _labels(_list(document, "nodes"))
    edges = _edges(document, labels)
    if len({pair if directed else frozenset(pair) for pair in edges}) < len(edges) and not multigraph:
        warnings.warn("parallel edges count once: N_i is a set", GraphWarning, stacklevel=4)
    if not directed:
        edges += [(v, u) for u, v in edges if u != v]
    return Digraph(labels, edges, directed=directed)


def _canonical(data: bytes) -> Digraph:
    """Return the graph of the canonical form that certificates are bound to; as undirected when it is symmetric."""
    try:
        graph = decode_graph(data)
    except MalformedGraph as problem:
        raise UnreadableTopology(str(problem)) from None
    arcs = {(j, i) for i, heard in enumerate(graph.hears) for j in heard}
    directed = any((i, j) not in arcs for j, i in arcs)
    labels = graph.labels
    return Digraph(labels, ((labels[j], labels[i]) for j, i in arcs), directed=directed)


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as node-link JSON, one node or edge a line, the same bytes for equal graphs."""
    directed = graph.directed or not graph.is_symmetric
    nodes = [{"id": label} for label in graph.labels]
    edges = [{"source": graph.labels[u], "target": graph.labels[v]} for u, v in graph.arcs() if directed or u < v]
    body = ",\n".join(f'"{key}": {_rows(rows)}' for key, rows in (("nodes", nodes), ("edges", edges)))
    head = f'"directed": {json.dumps(directed)},\n"multigraph": false,\n"graph": {{}},'
    return f"{{\n{head}\n{body}\n}}\n".encode("ascii")


def _rows(rows: list[dict[str, Any]]) -> str:
    return "[\n" + ",\n".join(map(json.dumps, rows)) + "\n]" if rows else "[]"


def _parse(text: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_object_without_repeats)
    except json.JSONDecodeError as problem:
        raise UnreadableTopology(f"line {problem.lineno}, column {problem.colno}: {problem.msg}") from None
    except ValueError as problem:  # an integer with more digits than Python converts
        raise UnreadableTopology(f"a number cannot be read: {problem}") from None


def _object_without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise UnreadableTopology(f"the key {twice!r} stands twice in one object: keep one")
    return found


def _flag(document: dict[str, Any], key: str) -> bool:
    value = document.get(key, False)
    if not isinstance(value, bool):
        raise UnreadableTopology(f"'{key}' is true or false, not {_kind(value)}")
    return value


def _list(document: dict[str, Any], key: str) -> list[Any]:
    if key not in document:
        raise UnreadableTopology(f"node-link JSON needs the key '{key}', which is missing")
    value = document[key]
    if not isinstance(value, list):
        raise UnreadableTopology(f"'{key}' is a list, not {_kind(value)}")
    return value


def _labels(nodes: list[Any]) -> list[Hashable]:
    labels: dict[Hashable, None] = {}
    for i, node in enumerate(nodes):
        label = _label(node, "id", f"nodes[{i}]")
        if label in labels:
            raise UnreadableTopology(f"nodes[{i}]: the id {label!r} is given twice: give every node its own")
        labels[label] = None
    return list(labels)


def _edges(document: dict[str, Any], labels: list[Hashable]) -> list[tuple[Hashable, Hashable]]:
    if "edges" in document and "links" in document:
        raise UnreadableTopology("'edges' and 'links' are two names of one list: keep one")
    key = "links" if "links" in document else "edges"
    known, pairs = set(labels), []
    for i, edge in enumerate(_list(document, key)):
        pair = (_label(edge, "source", f"{key}[{i}]"), _label(edge, "target", f"{key}[{i}]"))
        for end in pair:
            if end not in known:
                raise UnreadableTopology(f"{key}[{i}]: {end!r} is no node: add it to 'nodes'")
        pairs.append(pair)
    return pairs


def _label(item: Any, key: str, place: str) -> Hashable:
    if not isinstance(item, dict):
        raise UnreadableTopology(f"{place}: is an object with '{key}', not {_kind(item)}")
    if key not in item:
        raise UnreadableTopology(f"{place}: has no '{key}'")
    label = item[key]
    if type(label) is int or type(label) is str:
        return label
    if type(label) is list:
        return _tuple(label, f"{place}: '{key}'")
    raise UnreadableTopology(f"{place}: '{key}' is an integer, a string or a list of these, not {_kind(label)}")


def _tuple(parts: list[Any], place: str) -> tuple[Hashable, ...]:
    for part in parts:
        if type(part) not in (int, str, list):
            raise UnreadableTopology(f"{place} holds integers, strings and lists of these, not {_kind(part)}")
    return tuple(_tuple(part, place) if type(part) is list else part for part in parts)


def _kind(value: Any) -> str:
    names = {dict: "an object", list: "a list", str: "a string", bool: "a truth value", type(None): "null"}
    return names.get(type(value), "a number")
