"""GML: read here, written by networkx; labels become text.

GML is keys and values, a value being a number, a text in quotes, or a list of keys and values in brackets. Of the
one list ``graph``, every ``node`` and ``edge`` counts, wherever it stands; all other keys are not the graph.
"""

from __future__ import annotations

import html.entities
import io
import re
from collections.abc import Hashable, Iterator
from typing import Any

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.files.text import decode_utf8, texts_of, warn_lossy
from robustness.places import place_of, turned_up
from robustness.spelled import counted, plural

__all__ = ["decode", "encode"]

_TOKEN = re.compile(
    r"""(?P<space>\s+|\#[^\n]*)|(?P<text>"[^"]*")|(?P<open>\[)|(?P<close>\])
    |(?P<number>[+-](?:inf|nan)\b|[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(?![\w.]))|(?P<key>[A-Za-z_][\w.]*)""",
    re.VERBOSE | re.IGNORECASE,
)

_ENTITY = re.compile(r"&(?:#(\d{1,7})|#x([0-9A-Fa-f]{1,6})|(\w+));")

#: The deepest nesting of lists that is read.
_DEPTH_LIMIT = 100

_Record = dict[str, Any]


def decode(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a GML file: nodes are named by ``label`` where each has one of its own, else by ``id``."""
    records, settings = _read(decode_utf8(data))
    is_drawn = "yfiles" in str(settings.get("creator", "")).lower()
    nodes = [_node(record, is_drawn) for kind, record, _ in records if kind == "node"]
    known = {node.id for node in nodes}
    links = [_link(record, known, line, is_drawn) for kind, record, line in records if kind == "edge"]
    directed = str(settings.get("directed", 0)) == "1"
    notes: list[str] = []
    headless = sum(link.one_way is False for link in links) if directed and is_drawn else 0
    if headless:
        notes.append(f"{headless} drawn without arrow heads {plural(headless, 'runs', 'run')} both ways")
    met = {end for link in links for end in (link.source, link.target)}
    kept = [node for node in nodes if node.id in met or str(node.attributes.get("isgroup", 0)) != "1"]
    if len(kept) < len(nodes):
        notes.append(f"{counted(len(nodes) - len(kept), 'group is a box', 'groups are boxes')} and no nodes")
    loss = "GML reads a quoted label as text"
    return graph_of(Found(kept, links, directed, notes, loss=loss, is_doubtful=bool(headless)), options)


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
            graphs += key == "graph" and not names
            target = _opened(key, names, targets, settings)
            if target is not None and key in ("node", "edge"):
                records.append((key, target, line))
            names.append(key)
            targets.append(target)
        elif targets and targets[-1] is not None:
            targets[-1].setdefault(key, _value(kind, token))
        elif not names and key == "creator":
            settings[key] = _value(kind, token)
        key = None
    if names or key is not None:
        raise UnreadableTopology(f"line {line}: the file ends inside {names[-1] if names else key!r}: it was cut off")
    if graphs != 1:
        raise UnreadableTopology(f"the file has {counted(graphs, 'list')} 'graph', where one is expected")
    return records, settings


def _opened(key: str, names: list[str], targets: list[_Record | None], settings: _Record) -> _Record | None:
    """Return the record that a list adds to: of the graph, of one node or edge, of its drawing; None for all else."""
    if key == "graph" and not names:
        return settings
    if key in ("node", "edge") and names[:1] == ["graph"] and not {"node", "edge"} & set(names):
        return {}
    if key == "graphics" and targets and targets[-1] is not None:
        drawing: _Record = {}
        targets[-1].setdefault(key, drawing)
        return drawing
    return None


def _value(kind: str, token: str) -> int | str:
    if kind == "text":
        return _ENTITY.sub(_letter, token[1:-1])
    return int(token) if re.fullmatch(r"[+-]?\d{1,18}", token) else token


def _letter(match: re.Match[str]) -> str:
    """Return the letter that an entity stands for, or the entity itself where it stands for none."""
    code = int(match[1] or "0") or int(match[2] or "0", 16) or html.entities.name2codepoint.get(match[3] or "", -1)
    return chr(code) if 0 <= code <= 0x10FFFF else match[0]


def _node(record: _Record, is_drawn: bool) -> Node:
    """Return a node; where the editor yEd draws it, y points down."""
    if "id" not in record:
        raise UnreadableTopology("a node has no id: give every node one")
    drawing = record.get("graphics")
    if is_drawn and isinstance(drawing, dict) and "y" in drawing:
        record = {**record, "graphics": {**drawing, "y": turned_up(str(drawing["y"]))}}
    return Node(record["id"], [key for key in ("label", "name") if key in record], record, place_of(record))


def _link(edge: _Record, known: set[Hashable], line: int, is_drawn: bool) -> Link:
    """Return an edge with its numbers and texts; one that the editor yEd draws without arrow heads runs both ways."""
    said = {name: value for name, value in edge.items() if name not in ("source", "target", "graphics")}
    source, target = _end(edge, "source", known, line), _end(edge, "target", known, line)
    if edge.get("directed") in (0, 1):
        return Link(source, target, edge["directed"] == 1, said)
    drawing = edge.get("graphics")
    if not is_drawn or not isinstance(drawing, dict):
        return Link(source, target, attributes=said)
    heads = [str(drawing.get(end, "none")).lower() != "none" for end in ("sourcearrow", "targetarrow")]
    if heads == [True, False]:
        return Link(target, source, attributes=said)
    return Link(source, target, None if heads == [False, True] else False, said)


def _end(edge: _Record, end: str, known: set[Hashable], line: int) -> Hashable:
    if end not in edge:
        raise UnreadableTopology(f"line {line}: an edge has no {end}")
    if edge[end] not in known:
        raise UnreadableTopology(f"line {line}: an edge joins {edge[end]!r}, which is the id of no node: add the node")
    found: Hashable = edge[end]
    return found


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as GML."""
    import networkx as nx

    # networkx reads these two strings back as an empty tuple and an empty list.
    texts = texts_of(graph.labels, "GML", is_allowed=lambda text: bool(text.strip()) and text not in ("()", "[]"))
    if any(type(label) is not str for label in graph.labels):
        warn_lossy("GML makes every label text")
    stream = io.BytesIO()
    bare = Digraph(texts, ((texts[u], texts[v]) for u, v in graph.arcs()), directed=graph.directed)
    written = bare.to_networkx()
    for text, (x, y) in zip(texts, graph.places or (), strict=False):
        written.nodes[text]["graphics"] = {"x": x, "y": y}
    nx.write_gml(written, stream)
    return stream.getvalue()
