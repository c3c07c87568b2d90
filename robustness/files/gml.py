"""GML: read here, written by networkx; labels become text.

GML is keys and values, a value being a number, a text in quotes, or a list of keys and values in brackets. Of the
one list ``graph``, every ``node`` and ``edge`` counts, wherever it stands; all other keys are not the graph.
"""

from __future__ import annotations

import html.entities
import io
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.text import decode_utf8, texts_of, warn_lossy

if TYPE_CHECKING:
    pass

__all__ = ["decode", "encode"]

_TOKEN = re.compile(
    r"""(?P<space>\s+|\#[^\n]*)|(?P<text>"[^"]*")|(?P<open>\[)|(?P<close>\])
    |(?P<number>[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(?![\w.]))|(?P<key>[A-Za-z_][\w.]*)""",
    re.VERBOSE,
)

_ENTITY = re.compile(r"&(?:#(\d{1,7})|#x([0-9A-Fa-f]{1,6})|(\w+));")

#: The deepest nesting of lists that is read.
_DEPTH_LIMIT = 100

_Record = dict[str, int | str]


def decode(data: bytes) -> Digraph:
    """Return the graph of a GML file: nodes are named by ``label`` where each has one of its own, else by ``id``."""
    records, settings = _read(decode_utf8(data))
    nodes = [record for kind, record, _ in records if kind == "node"]
    edges = [(record, line) for kind, record, line in records if kind == "edge"]
    labels = _labels(nodes)
    links = [tuple(_end(record, end, labels, line) for end in ("source", "target")) for record, line in edges]
    directed = str(settings.get("directed", 0)) == "1"
    arcs = links if directed else links + [(v, u) for u, v in links if u != v]
    distinct = len(set(links) if directed else {frozenset(link) for link in links})
    notes = [f"read as: {'directed' if directed else 'undirected'}, {len(nodes)} nodes, {distinct} links"]
    if distinct < len(links):
        notes.append(f"{len(links) - distinct} parallel ones count once")
    if any("label" in node for node in nodes) and list(labels) == list(labels.values()):
        notes.append("labels repeat or lack, so nodes are named by id")
    warn_lossy(f"{'; '.join(notes)}; GML reads a quoted label as text")
    return Digraph(labels.values(), arcs, directed=directed)  # type: ignore[arg-type]


def _tokens(text: str) -> Iterator[tuple[int, str, str]]:
    place, line = 0, 1
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise UnreadableTopology(f"line {line}: {text[place : place + 20]!r} is no key, number, text or bracket")
        found = next(name for name in ("space", "text", "open", "close", "number", "key") if match[name] is not None)
        if found != "space":
            yield line, found, match[0]
        line += match[0].count("\n")
        place = match.end()


def _read(text: str) -> tuple[list[tuple[str, _Record, int]], _Record]:
    """Return all nodes and edges of the graph with their numbers and texts, and those of the graph itself."""
    records: list[tuple[str, _Record, int]] = []
    settings: _Record = {}
    # What is open: the names of lists from the outermost on, and the record that each adds to.
    names: list[str] = []
    targets: list[_Record | None] = []
    key: str | None = None
    graphs = 0
    line = 1
    for line, kind, token in _tokens(text):
        if kind == "key" and key is None:
            key = token.lower()
            continue
        if kind == "close" and key is None and names:
            names.pop()
            targets.pop()
            continue
        if key is None or kind in ("close", "key"):
            raise UnreadableTopology(f"line {line}: {token!r} where a {'value' if key else 'key'} is expected")
        if kind == "open":
            if len(names) >= _DEPTH_LIMIT:
                raise UnreadableTopology(f"line {line}: lists are nested more than {_DEPTH_LIMIT} deep")
            target: _Record | None = None
            if key == "graph" and not names:
                graphs += 1
                target = settings
            elif key in ("node", "edge") and names[:1] == ["graph"] and not {"node", "edge"} & set(names):
                target = {}
                records.append((key, target, line))
            names.append(key)
            targets.append(target)
        elif targets and targets[-1] is not None:
            targets[-1].setdefault(key, _value(kind, token))
        key = None
    if names or key is not None:
        raise UnreadableTopology(f"line {line}: the file ends inside {names[-1] if names else key!r}: it was cut off")
    if graphs != 1:
        raise UnreadableTopology(f"the file has {graphs} lists 'graph', where one is expected")
    return records, settings


def _value(kind: str, token: str) -> int | str:
    if kind == "text":
        return _ENTITY.sub(_letter, token[1:-1])
    return int(token) if re.fullmatch(r"[+-]?\d{1,18}", token) else token


def _letter(match: re.Match[str]) -> str:
    """Return the letter that an entity stands for, or the entity itself where it stands for none."""
    code = int(match[1] or "0") or int(match[2] or "0", 16) or html.entities.name2codepoint.get(match[3] or "", -1)
    return chr(code) if 0 <= code <= 0x10FFFF else match[0]


def _labels(nodes: list[_Record]) -> dict[int | str, int | str]:
    """Return what names each node, by its id."""
    ids: list[int | str] = []
    for node in nodes:
        if "id" not in node:
            raise UnreadableTopology("a node has no id: give every node one")
        ids.append(node["id"])
    if len(set(ids)) < len(ids):
        raise UnreadableTopology(f"the id {next(i for i in ids if ids.count(i) > 1)} is given twice: keep one")
    labels = [node.get("label") for node in nodes]
    if None in labels or len(set(labels)) < len(labels):
        return dict(zip(ids, ids, strict=True))
    return dict(zip(ids, (label for label in labels if label is not None), strict=True))


def _end(edge: _Record, end: str, labels: dict[int | str, int | str], line: int) -> int | str:
    if end not in edge:
        raise UnreadableTopology(f"line {line}: an edge has no {end}")
    if edge[end] not in labels:
        raise UnreadableTopology(f"line {line}: an edge joins {edge[end]!r}, which is the id of no node: add the node")
    return labels[edge[end]]


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as GML."""
    import networkx as nx

    # networkx reads these two strings back as an empty tuple and an empty list.
    texts = texts_of(graph.labels, "GML", is_allowed=lambda text: text not in ("()", "[]"))
    if any(type(label) is not str for label in graph.labels):
        warn_lossy("GML makes every label text")
    stream = io.BytesIO()
    nx.write_gml(nx.relabel_nodes(graph.to_networkx(), dict(zip(graph.labels, texts, strict=True))), stream)
    return stream.getvalue()
