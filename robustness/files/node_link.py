"""Node-link JSON, the default format: it keeps labels, isolated nodes and direction.

``{"directed": bool, "nodes": [{"id": label}, ...], "edges": [{"source": label, "target": label}, ...]}``.
The canonical form that certificates are bound to (``certify --canonical``) is read as well, and what other programs
write as JSON (:mod:`robustness.files.json_shapes`). ``links`` may stand for ``edges``; a list as label is a tuple;
all other keys are attributes. It is read here and not by networkx, whose reader merges repeated labels and invents
nodes for edges that join none.
"""

from __future__ import annotations

import json
from collections.abc import Hashable, Mapping
from typing import Any

from certificates.errors import MalformedGraph
from certificates.graph import FORMAT as CANONICAL_FORMAT
from certificates.graph import decode_graph
from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.files.json_shapes import found_in
from robustness.files.json_text import flag, kind_of, label_of, list_of, parse_json
from robustness.files.text import decode_utf8
from robustness.places import place_of

__all__ = ["decode", "encode"]


def decode(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of node-link JSON, or of another shape that programs write as JSON."""
    document = parse_json(decode_utf8(data))
    if isinstance(document, dict) and document.get("format") == CANONICAL_FORMAT:
        return _canonical(data, options)
    if isinstance(document, dict) and isinstance(document.get("steps"), list):
        raise UnreadableTopology(
            "is a network over time, as it has 'steps': joint, tolerance --tau and simulate --over-time read it"
        )
    found = found_in(document)
    if found is None and not isinstance(document, dict):
        raise UnreadableTopology(f"node-link JSON is an object with 'nodes' and 'edges', not {kind_of(document)}")
    return graph_of(_node_link(document) if found is None else found, options)


def _node_link(document: Mapping[str, Any]) -> Found:
    """Return what a node-link document holds."""
    multigraph = flag(document, "multigraph", default=False)
    directed = flag(document, "directed", default=None)
    nodes = _nodes(list_of(document, "nodes"))
    if "edges" in document and "links" in document:
        raise UnreadableTopology("'edges' and 'links' are two names of one list: keep one")
    key = "links" if "links" in document else "edges"
    known, links = {node.id for node in nodes}, []
    for i, edge in enumerate(list_of(document, key)):
        ends = [label_of(edge, end, f"{key}[{i}]") for end in ("source", "target")]
        for end in ends:
            if end not in known:
                raise UnreadableTopology(f"{key}[{i}]: {end!r} is no node: add it to 'nodes'")
        said = {name: value for name, value in edge.items() if name not in ("source", "target")}
        links.append(Link(ends[0], ends[1], attributes=said))
    parallel = "" if multigraph else "parallel edge"
    return Found(nodes, links, directed, parallel=parallel)


def _nodes(rows: list[Any]) -> list[Node]:
    seen: set[Hashable] = set()
    nodes = []
    for i, row in enumerate(rows):
        label = label_of(row, "id", f"nodes[{i}]")
        if label in seen:
            raise UnreadableTopology(f"nodes[{i}]: the id {label!r} is given twice: give every node its own")
        seen.add(label)
        nodes.append(Node(label, attributes=row, pos=place_of(row)))
    return nodes


def _canonical(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of the canonical form that certificates are bound to; as undirected when it is symmetric."""
    try:
        graph = decode_graph(data)
    except MalformedGraph as problem:
        raise UnreadableTopology(str(problem)) from None
    arcs = {(j, i) for i, heard in enumerate(graph.hears) for j in heard}
    directed = any((i, j) not in arcs for j, i in arcs)
    labels = graph.labels
    links = [Link(labels[j], labels[i]) for j, i in sorted(arcs) if directed or j < i]
    return graph_of(Found([Node(label) for label in labels], links, directed), options)


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as node-link JSON, one node or edge a line, the same bytes for equal graphs and places."""
    directed = graph.directed or not graph.is_symmetric
    nodes: list[dict[str, Any]] = [{"id": label} for label in graph.labels]
    for node, place in zip(nodes, graph.places or (), strict=False):
        node["pos"] = list(place)
    edges = [{"source": graph.labels[u], "target": graph.labels[v]} for u, v in graph.arcs() if directed or u < v]
    body = ",\n".join(f'"{key}": {_rows(rows)}' for key, rows in (("nodes", nodes), ("edges", edges)))
    head = f'"directed": {json.dumps(directed)},\n"multigraph": false,\n"graph": {{}},'
    return f"{{\n{head}\n{body}\n}}\n".encode("ascii")


def _rows(rows: list[dict[str, Any]]) -> str:
    return "[\n" + ",\n".join(map(json.dumps, rows)) + "\n]" if rows else "[]"
