"""Graphs in the shapes of JSON that other programs write, told apart by their keys.

========================================  =================================================================
shape                                     written by
========================================  =================================================================
``elements`` of ``data``, or these alone  Cytoscape
``graph`` with ``nodes`` and ``edges``    JSON Graph Format, nodes as an object or a list
``nodes`` and ``adjacency``               networkx, adjacency data
``nodes`` with ``key``                    graphology, sigma.js
``edges`` with ``from`` and ``to``        vis.js, pyvis; ``arrows`` says which way
``links`` between places or names         D3, where nodes have no ``id``
``nodes`` and ``edges`` as plain lists    by hand
``{u: [v, ...], ...}``                    by hand; networkx, dicts of lists or dicts
``[[u, v], ...]``, ``[{...}, ...]``       lists of links
========================================  =================================================================

NetJSON is node-link JSON with other words around it and needs nothing of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from robustness.errors import UnreadableTopology
from robustness.files.found import COLUMN_NAMES, Found, Link, Node
from robustness.files.json_text import flag, kind_of, label_of, list_of, plain_label
from robustness.places import place_of
from robustness.spelled import counted

__all__ = ["found_in"]


def found_in(document: Any) -> Found | None:
    """Return what a document of another shape than node-link JSON holds; None for node-link JSON and all else."""
    if isinstance(document, list):
        is_cytoscape = bool(document) and all(isinstance(row, dict) and _has_data(row) for row in document)
        return _cytoscape({"elements": document}) if is_cytoscape else _list_of_links(document)
    if not isinstance(document, dict):
        return None
    for is_this, read in _SHAPES:
        if is_this(document):
            return read(document)
    return None


def _objects(document: Mapping[str, Any], key: str) -> list[dict[str, Any]]:
    rows = list_of(document, key)
    for i, row in enumerate(rows):
        if not isinstance(row, dict):
            raise UnreadableTopology(f"{key}[{i}]: is an object, not {kind_of(row)}")
    return rows


def _link(row: Any, place: str, one_way: bool | None = None, *, source: str = "source", target: str = "target") -> Link:
    """Return the link that an object describes."""
    return Link(label_of(row, source, place), label_of(row, target, place), one_way)


def _first(document: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """Return the first object of a list, or nothing."""
    rows = document.get(key)
    return rows[0] if isinstance(rows, list) and rows and isinstance(rows[0], dict) else {}


def _cytoscape(document: Mapping[str, Any]) -> Found:
    elements = document.get("elements", document)
    if isinstance(elements, list):
        elements = {
            "nodes": [row for row in elements if isinstance(row, dict) and not _is_edge(row)],
            "edges": [row for row in elements if isinstance(row, dict) and _is_edge(row)],
        }
    if not isinstance(elements, dict):
        raise UnreadableTopology(f"'elements' is an object or a list, not {kind_of(elements)}")
    nodes = []
    for i, row in enumerate(_objects(elements, "nodes")):
        data = row.get("data", {})
        nodes.append(Node(label_of(data, "id", f"nodes[{i}].data"), _seen(data), data, place_of({**data, **row})))
    links = []
    for i, row in enumerate(_objects({"edges": [], **elements}, "edges")):
        data = row.get("data", {})
        links.append(_link(data, f"edges[{i}].data"))
    return Found(_without_boxes(nodes, links), links, _said(document))


def _has_data(row: Mapping[str, Any]) -> bool:
    """Return whether an object is an element of Cytoscape."""
    data = row.get("data")
    return isinstance(data, dict) and ("id" in data or "source" in data) and "id" not in row and "source" not in row


def _is_edge(row: Mapping[str, Any]) -> bool:
    data = row.get("data")
    return row.get("group") == "edges" or (isinstance(data, dict) and "source" in data)


def _without_boxes(nodes: list[Node], links: list[Link]) -> list[Node]:
    """Return the nodes without the compound ones that only hold others."""
    met = {end for link in links for end in (link.source, link.target)}
    parents = {node.attributes.get("parent") for node in nodes if isinstance(node.attributes.get("parent"), (str, int))}
    return [node for node in nodes if node.id not in parents or node.id in met]


def _json_graph_format(document: Mapping[str, Any]) -> Found:
    if "graphs" in document:
        graphs = document["graphs"]
        if not isinstance(graphs, list) or len(graphs) != 1:
            raise UnreadableTopology("'graphs' holds more than one graph: keep one graph a file")
        document = {"graph": graphs[0]}
    graph = document["graph"]
    if not isinstance(graph, dict):
        raise UnreadableTopology(f"'graph' is an object, not {kind_of(graph)}")
    if graph.get("hyperedges"):
        raise UnreadableTopology("a hyperedge joins more than two nodes: write edges")
    nodes: Any = graph.get("nodes", {})
    if isinstance(nodes, list):
        named = [(label_of(row, "id", f"nodes[{i}]"), row) for i, row in enumerate(nodes)]
    elif isinstance(nodes, dict):
        named = [(label, row if isinstance(row, dict) else {}) for label, row in nodes.items()]
    else:
        raise UnreadableTopology(f"'nodes' is an object or a list, not {kind_of(nodes)}")
    links = []
    for i, row in enumerate(_objects({"edges": [], **graph}, "edges")):
        links.append(_link(row, f"edges[{i}]", flag(row, "directed", default=None)))
    found = [Node(label, _seen(row), {**_metadata(row), **row}, place_of(_metadata(row))) for label, row in named]
    return Found(found, links, flag(graph, "directed", default=True), is_doubtful="directed" not in graph)


def _metadata(row: Mapping[str, Any]) -> Mapping[str, Any]:
    data = row.get("metadata")
    return data if isinstance(data, dict) else {}


def _adjacency_data(document: Mapping[str, Any]) -> Found:
    nodes = [
        Node(label_of(row, "id", f"nodes[{i}]"), (), row, place_of(row))
        for i, row in enumerate(_objects(document, "nodes"))
    ]
    lists = list_of(document, "adjacency")
    if len(lists) != len(nodes):
        raise UnreadableTopology(f"'adjacency' has a list for each of {counted(len(nodes), 'node')}, not {len(lists)}")
    directed = flag(document, "directed", default=None)
    links = []
    for i, (node, heads) in enumerate(zip(nodes, lists, strict=True)):
        if not isinstance(heads, list):
            raise UnreadableTopology(f"adjacency[{i}]: is a list, not {kind_of(heads)}")
        links += [Link(node.id, label_of(head, "id", f"adjacency[{i}][{k}]")) for k, head in enumerate(heads)]
    links = links if directed else _each_once(links)
    return Found(nodes, links, directed)


def _each_once(links: list[Link]) -> list[Link]:
    """Return the links of an undirected graph that lists each of them at both ends, or at one, once."""
    return list({frozenset((link.source, link.target)): link for link in links}.values())


def _graphology(document: Mapping[str, Any]) -> Found:
    nodes = []
    for i, row in enumerate(_objects(document, "nodes")):
        own = row.get("attributes")
        data = {**own, **row} if isinstance(own, dict) else row
        nodes.append(Node(label_of(row, "key", f"nodes[{i}]"), _seen(data), data, place_of(data)))
    options = document.get("options")
    kind = options.get("type", "mixed") if isinstance(options, dict) else "mixed"
    links = []
    for i, row in enumerate(_objects({"edges": [], **document}, "edges")):
        one_way = kind == "directed" or (kind == "mixed" and not flag(row, "undirected", default=False))
        links.append(_link(row, f"edges[{i}]", one_way))
    return Found(nodes, links, kind != "undirected")


def _vis(document: Mapping[str, Any]) -> Found:
    key = "edges" if "edges" in document else "links"
    nodes = [
        Node(label_of(row, "id", f"nodes[{i}]"), _seen(row), row, place_of(row))
        for i, row in enumerate(_objects(document, "nodes"))
    ]
    links = []
    for i, row in enumerate(_objects(document, key)):
        heads = _arrow_heads(row.get("arrows", _general_arrows(document)))
        one_way = None if not heads else len(heads) == 1
        ends = ("to", "from") if heads == {"from"} else ("from", "to")
        links.append(_link(row, f"{key}[{i}]", one_way, source=ends[0], target=ends[1]))
    return Found(nodes, links, _said(document))


def _general_arrows(document: Mapping[str, Any]) -> Any:
    options = document.get("options")
    edges = options.get("edges") if isinstance(options, dict) else None
    return edges.get("arrows") if isinstance(edges, dict) else None


def _arrow_heads(arrows: Any) -> set[str]:
    """Return at which ends vis.js draws heads: of text such as ``to, from`` or an object with ``enabled``."""
    if isinstance(arrows, str):
        return {end for end in ("from", "to") if end in arrows}
    if isinstance(arrows, dict):
        return {
            end
            for end in ("from", "to")
            if (arrows[end].get("enabled", True) if isinstance(arrows.get(end), dict) else arrows.get(end))
        }
    return set()


def _by_position(document: Mapping[str, Any]) -> Found:
    key = "links" if "links" in document else "edges"
    rows = _objects(document, "nodes")
    links = [_link(row, f"{key}[{i}]") for i, row in enumerate(_objects(document, key))]
    if links and type(links[0].source) is str:
        named = [Node(label_of(row, "name", f"nodes[{i}]"), (), row, place_of(row)) for i, row in enumerate(rows)]
        return Found(named, links, _said(document), ["nodes are named by their name"])
    nodes = [Node(i, _seen(row), row, place_of(row)) for i, row in enumerate(rows)]
    for i, link in enumerate(links):
        for end in (link.source, link.target):
            if type(end) is not int or not 0 <= end < len(nodes):
                raise UnreadableTopology(
                    f"{key}[{i}]: {end!r} is no place in 'nodes', whose objects have no 'id': give every node an id"
                )
    return Found(nodes, links, _said(document), ["links join places in the list of nodes, counted from 0"])


def _plain_lists(document: Mapping[str, Any]) -> Found:
    key = "links" if "links" in document else "edges"
    nodes = [plain_label(value, f"nodes[{i}]") for i, value in enumerate(list_of(document, "nodes"))]
    return Found([Node(label) for label in nodes], _pairs(list_of(document, key), f"{key}"), _said(document))


def _pairs(rows: Iterable[Any], name: str) -> list[Link]:
    links = []
    for i, row in enumerate(rows):
        if not isinstance(row, list) or len(row) < 2 or any(isinstance(cell, str) for cell in row[2:]):
            raise UnreadableTopology(f"{name}[{i}]: is a list of two labels, and perhaps a weight: [u, v]")
        links.append(Link(plain_label(row[0], f"{name}[{i}]"), plain_label(row[1], f"{name}[{i}]")))
    return links


def _dict_of_neighbours(document: Mapping[str, Any]) -> Found:
    links = []
    for label, heads in document.items():
        links += [Link(label, plain_label(head, f"the neighbours of {label!r}")) for head in heads]
    are_numbers = bool(links) and all(type(link.target) is int for link in links)
    nodes: dict[Hashable, None] = dict.fromkeys(document)
    if are_numbers and all(label.lstrip("-").isdigit() and str(int(label)) == label for label in document):
        # Keys of JSON are text whatever they were; the lists keep numbers.
        links = [Link(int(str(link.source)), link.target) for link in links]
        nodes = dict.fromkeys(int(label) for label in document)
    missing = next((link.target for link in links if link.target not in nodes), None)
    if missing is not None:
        raise UnreadableTopology(f"{missing!r} is somebody's neighbour and has no list of its own: give it one")
    pairs = {(link.source, link.target) for link in links}
    if all((v, u) in pairs for u, v in pairs):
        return Found([Node(label) for label in nodes], _each_once(links), False)
    # Lists that do not agree name each link once, or say who hears whom.
    return Found([Node(label) for label in nodes], links, None, ["node u lists who hears u"], is_doubtful=True)


def _list_of_links(rows: list[Any]) -> Found | None:
    if not rows:
        return None
    if all(isinstance(row, dict) for row in rows):
        named = [_ends_by_name(row, i) for i, row in enumerate(rows)]
        links = [Link(u, v) for u, v in named]
    elif all(isinstance(row, list) for row in rows):
        if len({len(row) for row in rows}) == 1 and len(rows) == len(rows[0]) and len(rows) > 1 and _are_numbers(rows):
            raise UnreadableTopology(
                f"{len(rows)} lists of {len(rows)} numbers may be a matrix and may be links: write node-link JSON, "
                "or a "
                "matrix in .csv"
            )
        if any(len(row) > 3 for row in rows) and _are_numbers(rows):
            raise UnreadableTopology("lists of numbers are no links [u, v]: write a matrix in .csv or .npy")
        links = _pairs(rows, "the list")
    else:
        return None
    nodes = dict.fromkeys(end for link in links for end in (link.source, link.target))
    return Found([Node(label) for label in nodes], links, None, loss="a list of links has no isolated nodes")


def _are_numbers(rows: list[Any]) -> bool:
    return all(isinstance(cell, (int, float)) for row in rows for cell in row)


def _ends_by_name(row: Mapping[str, Any], i: int) -> tuple[Hashable, Hashable]:
    ends = []
    for end in ("source", "target"):
        keys = [key for key in row if key.lower() in COLUMN_NAMES[end]]
        if len(keys) != 1:
            raise UnreadableTopology(f"[{i}]: a link is an object with 'source' and 'target', or a list [u, v]")
        ends.append(plain_label(row[keys[0]], f"[{i}]: '{keys[0]}'"))
    return ends[0], ends[1]


def _said(document: Mapping[str, Any]) -> bool | None:
    """Return the flag ``directed``, the one key about direction that all shapes share; None without it."""
    return flag(document, "directed", default=None)  # type: ignore[no-any-return]  # a truth value or None


def _seen(data: Mapping[str, Any]) -> list[str]:
    return [key for key in ("label", "name") if key in data]


def _is_by_position(document: Mapping[str, Any]) -> bool:
    rows = document.get("nodes")
    link = _first(document, "links") or _first(document, "edges")
    has_objects = isinstance(rows, list) and bool(rows) and all(isinstance(row, dict) for row in rows)
    return has_objects and not any("id" in row for row in rows or []) and type(link.get("source")) in (int, str)


def _is_dict_of_neighbours(document: Mapping[str, Any]) -> bool:
    def is_neighbours(value: Any) -> bool:
        if isinstance(value, list):
            return all(type(head) in (int, str) for head in value)
        return isinstance(value, dict) and all(isinstance(data, dict) for data in value.values())

    reserved = {"nodes", "edges", "links", "graph", "graphs", "elements", "adjacency", "steps"}
    if not document or reserved & set(document) or not all(map(is_neighbours, document.values())):
        return False
    return any(document.values()) or all(isinstance(value, list) for value in document.values())


def _is_plain(document: Mapping[str, Any]) -> bool:
    rows = document.get("nodes")
    edges = document.get("edges", document.get("links"))
    return (
        isinstance(rows, list)
        and isinstance(edges, list)
        and bool(rows)
        and not any(isinstance(row, dict) for row in [*rows, *edges])
    )


_Shape = tuple[Callable[[Mapping[str, Any]], bool], Callable[[Mapping[str, Any]], Found]]

_SHAPES: tuple[_Shape, ...] = (
    (lambda document: "elements" in document or _has_data(_first(document, "nodes")), _cytoscape),
    (lambda document: "graphs" in document, _json_graph_format),
    (lambda document: isinstance(document.get("graph"), dict) and "nodes" in document["graph"], _json_graph_format),
    (lambda document: "adjacency" in document, _adjacency_data),
    (lambda document: "key" in _first(document, "nodes") and "id" not in _first(document, "nodes"), _graphology),
    (lambda document: {"from", "to"} <= set(_first(document, "edges") or _first(document, "links")), _vis),
    (_is_by_position, _by_position),
    (_is_plain, _plain_lists),
    (_is_dict_of_neighbours, _dict_of_neighbours),
)
