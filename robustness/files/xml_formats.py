"""GraphML, GEXF and SNDlib XML: read here; GraphML and GEXF are written by networkx.

What a graph is made of is taken from the document wherever it stands, in every namespace: all ``node``, ``edge`` and
``link`` elements, members of groups included, and the direction of each edge. Types of attributes, drawings and colours
are not the graph and never stop the reading.

A document type declaration is the door to entity bombs and to entities that read files; no topology needs one, so it is
refused as soon as the XML parser itself, expat, reports it.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.files.text import texts_of, warn_lossy
from robustness.places import place_of, turned_up
from robustness.spelled import counted, plural

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["DEPTH_LIMIT", "decode_xml", "encode_gexf", "encode_graphml"]

#: The deepest nesting of elements that is read.
DEPTH_LIMIT = 100

_FORMS = {"graphml": "GraphML", "gexf": "GEXF", "network": "SNDlib XML"}

#: Attributes whose text a drawing shows, in the order in which they are looked for.
_SEEN = ("nodelabel", "label", "name", "shared name")


def decode_xml(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a GraphML, GEXF or SNDlib document; the root element tells which it is.

    A node is named by what its drawing shows, where every node shows something of its own, else by its id, as text.
    ``directed`` or ``type`` of an edge goes before the default of its graph. Edges that a drawing shows without arrow
    heads run both ways, since editors write ``edgedefault="directed"`` whatever is drawn. A group that no edge meets
    is a box in a drawing and no node. In SNDlib a link runs both ways.
    """
    found = _inspect(data)
    form = _FORMS[found.root]
    met = {end for edge in found.edges for end in (edge.source, edge.target)}
    nodes = [node for node in found.nodes.values() if not node.is_group or node.id in met]
    notes = [note for note in found.notes() if note]
    is_doubtful = bool(notes)
    if len(nodes) < len(found.nodes):
        notes.append(f"{counted(len(found.nodes) - len(nodes), 'group is a box', 'groups are boxes')} and no nodes")
    return graph_of(
        Found(
            [Node(node.id, _seen(node), node.attributes, place_of(node.attributes)) for node in nodes],
            [Link(edge.source, edge.target, edge.one_way, edge.attributes) for edge in found.edges],
            found.default_directed,
            notes,
            loss=f"{form} reads every label as text",
            is_doubtful=is_doubtful,
        ),
        options,
    )


def encode_graphml(graph: Digraph) -> bytes:
    """Return ``graph`` as GraphML."""
    import networkx as nx

    stream = io.BytesIO()
    nx.write_graphml_xml(_with_text_labels(graph, "GraphML", lambda x, y: {"x": x, "y": y}), stream)
    return stream.getvalue()


def encode_gexf(graph: Digraph) -> bytes:
    """Return ``graph`` as GEXF."""
    import networkx as nx

    stream = io.BytesIO()
    where = _with_text_labels(graph, "GEXF", lambda x, y: {"viz": {"position": {"x": x, "y": y, "z": 0.0}}})
    nx.write_gexf(where, stream)
    return stream.getvalue()


def _with_text_labels(graph: Digraph, form: str, placed: Callable[[float, float], dict[str, object]]) -> nx.Graph:
    """Return the network with its labels as text, and where its nodes stand in the words of the format."""
    texts = texts_of(graph.labels, form, is_allowed=_survives_xml)
    if any(type(label) is not str for label in graph.labels):
        warn_lossy(f"{form} makes every label text")
    bare = Digraph(texts, ((texts[u], texts[v]) for u, v in graph.arcs()), directed=graph.directed)
    written = bare.to_networkx()
    for text, place in zip(texts, graph.places or (), strict=False):
        written.nodes[text].update(placed(*place))
    return written


def _survives_xml(text: str) -> bool:
    """Return whether an XML attribute gives ``text`` back: parsers reject or normalise control characters."""
    return all(c >= " " and c not in "\ufffe\uffff" for c in text)


def _seen(node: _Node) -> list[str]:
    return [key for wanted in _SEEN for key in node.attributes if key.lower() == wanted]


@dataclass(slots=True)
class _Node:
    """A node of a document and the texts that the document gives it, by the names of its attributes."""

    id: str
    is_group: bool
    attributes: dict[str, Any] = field(default_factory=dict)


@dataclass(slots=True)
class _Edge:
    """An edge of a document: its ends, whether its graph or itself says directed, and how it is drawn."""

    line: int
    source: str
    target: str
    one_way: bool | None
    default: bool
    is_headless: bool = False
    attributes: dict[str, Any] = field(default_factory=dict)


def _inspect(data: bytes) -> _Inspector:
    """Return what a document holds, after it was found well-formed, without a document type, with unique nodes."""
    inspector = _Inspector()
    try:
        inspector.parser.Parse(data, True)
    except expat.ExpatError as problem:
        raise UnreadableTopology(
            f"line {problem.lineno}, column {problem.offset + 1}: {expat.ErrorString(problem.code)}"
        ) from None
    except UnreadableTopology:
        raise
    except (LookupError, ValueError) as problem:  # an encoding that Python or expat does not know
        raise UnreadableTopology(f"line 1: the encoding cannot be read: {problem}") from None
    if inspector.root not in _FORMS:
        raise UnreadableTopology(f"the document is <{inspector.root}>, neither GraphML, GEXF nor a network of SNDlib")
    if not inspector.has_graph and inspector.root != "network":
        raise UnreadableTopology("the document has no <graph>")
    if inspector.root == "network" and not inspector.nodes:
        raise UnreadableTopology("the document has no <node>")
    for edge in inspector.edges:
        for end in (edge.source, edge.target):
            if end not in inspector.nodes:
                raise UnreadableTopology(f"line {edge.line}: <edge> joins {end!r}, which is no node: add the node")
        # A default that differs between graphs, as in nested ones, is what each edge says of itself.
        if edge.one_way is None and edge.default != inspector.default_directed:
            edge.one_way = edge.default
    return inspector


class _Inspector:
    """Watches expat parse one file and takes nodes and edges from it."""

    def __init__(self) -> None:
        self.nodes: dict[str, _Node] = {}
        self.edges: list[_Edge] = []
        self.open: list[str] = []
        self.root = ""
        self.has_graph = False
        self.default_directed = False
        self.is_dynamic = False
        #: Whether edges are directed in each graph that is open, the innermost last.
        self.directed: list[bool] = []
        #: The nodes that are open, the innermost last; an edge is None.
        self.owners: list[_Node | None] = []
        #: Names of attributes by their ids, of nodes and of edges.
        self.keys: dict[str, str] = {}
        self.edge_keys: dict[str, str] = {}
        #: The attribute whose text is read now, and its pieces.
        self.reading: tuple[str, list[str]] | None = None
        self.counts: dict[str, int] = {}
        self.parser = expat.ParserCreate(namespace_separator=" ")
        self.parser.buffer_text = True
        self.parser.StartDoctypeDeclHandler = self.refuse_doctype
        self.parser.EntityDeclHandler = self.refuse_entity
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.text

    def notes(self) -> Iterable[str]:
        """Return what was taken for granted about the whole document."""
        headless = sum(edge.is_headless for edge in self.edges)
        yield f"{headless} drawn without arrow heads {plural(headless, 'runs', 'run')} both ways" if headless else ""
        yield "times are left out: every link that is ever there counts" if self.is_dynamic else ""
        for kind, have in (("nodes", len(self.nodes)), ("edges", len(self.edges))):
            if self.counts.get(kind, have) != have:
                yield f"the file announces {self.counts[kind]} {kind} and holds {have}"

    def refuse_doctype(self, name: str, system: str | None, public: str | None, internal: bool) -> None:
        raise UnreadableTopology(f"line {self.parser.CurrentLineNumber}: a DOCTYPE is never read: remove it")

    def refuse_entity(self, *declaration: object) -> None:
        raise UnreadableTopology(f"line {self.parser.CurrentLineNumber}: an ENTITY is never read: remove it")

    def start(self, tag: str, given: dict[str, str]) -> None:
        line, name = self.parser.CurrentLineNumber, tag.rpartition(" ")[2].lower()
        attributes = {key.rpartition(" ")[2].lower(): value for key, value in given.items()}
        self.root = self.root or name
        self.open.append(name)
        if len(self.open) > DEPTH_LIMIT:
            raise UnreadableTopology(f"line {line}: elements are nested more than {DEPTH_LIMIT} deep")
        needed = {"node": ("id",), "edge": ("source", "target")}.get(name, ())
        for attribute in needed:
            if attribute not in attributes:
                raise UnreadableTopology(f"line {line}: <{name}> has no '{attribute}'")
        match name:
            case "graph":
                self.open_graph(line, attributes)
            case "hyperedge":
                raise UnreadableTopology(f"line {line}: a <hyperedge> joins more than two nodes: write links")
            case "node":
                self.open_node(line, attributes)
            case "edge":
                edge = _Edge(
                    line, attributes["source"], attributes["target"], self.own(line, attributes), self.inside()
                )
                edge.attributes.update({key: attributes[key] for key in ("weight",) if key in attributes})
                self.edges.append(edge)
                self.owners.append(None)
            case "link" if self.root == "network":
                self.edges.append(_Edge(line, "", "", None, False))
                self.owners.append(None)
            case "arrows" if "edge" in self.open:
                self.draw(attributes)
            case _:
                self.describe(name, attributes)

    def open_graph(self, line: int, attributes: dict[str, str]) -> None:
        if self.has_graph and "node" not in self.open:
            raise UnreadableTopology(f"line {line}: a second <graph>: keep one graph a file")
        given = attributes.get("edgedefault", attributes.get("defaultedgetype"))
        directed = self.inside() if given is None else given.strip().lower() == "directed"
        if not self.has_graph:
            self.default_directed = directed
        self.is_dynamic = self.is_dynamic or attributes.get("mode", "").lower() == "dynamic"
        self.has_graph = True
        self.directed.append(directed)

    def open_node(self, line: int, attributes: dict[str, str]) -> None:
        name = attributes["id"]
        if name in self.nodes:
            raise UnreadableTopology(f"line {line}: node {name!r} is given twice: keep one")
        node = _Node(name, "yfiles.foldertype" in attributes)
        if "label" in attributes:
            node.attributes["label"] = attributes["label"]
        self.nodes[name] = node
        self.owners.append(node)

    def inside(self) -> bool:
        """Return whether edges of the innermost graph are directed."""
        return self.directed[-1] if self.directed else False

    def own(self, line: int, attributes: dict[str, str]) -> bool | None:
        """Return whether an edge says of itself that it has a direction."""
        said = attributes.get("directed", attributes.get("type", "")).strip().lower()
        if said in ("true", "1", "directed"):
            return True
        if said in ("false", "0", "undirected", "mutual"):
            return False
        if "directed" in attributes:
            raise UnreadableTopology(f"line {line}: directed is true or false, not {attributes['directed']!r}")
        return None

    def draw(self, attributes: dict[str, str]) -> None:
        """Note which arrow heads the drawing of the last edge has."""
        heads = [attributes.get(end, "none").lower() for end in ("source", "target")]
        edge = self.edges[-1]
        is_directed = edge.default if edge.one_way is None else edge.one_way
        if is_directed and heads == ["none", "none"]:
            edge.is_headless, edge.one_way = True, False
        elif is_directed and heads[0] != "none":
            # A head at the source: against the arc, or both ways.
            if heads[1] != "none":
                edge.one_way = False
            else:
                edge.source, edge.target = edge.target, edge.source

    def describe(self, name: str, attributes: dict[str, str]) -> None:
        """Take what an element says of attributes, of the node that is open, or of how many there are."""
        owner = self.owners[-1] if self.owners else None
        is_of_edge = self.open[-2:-1] in (["edge"], ["attvalues"]) and owner is None and bool(self.edges)
        match name:
            case "key" if attributes.get("for", "node") in ("node", "edge", "all"):
                self.name_key(attributes, "attr.name", attributes.get("for", "node"))
            case "attribute":
                self.name_key(attributes, "title", "all")
            case "nodes" | "edges" if attributes.get("count", "").isdigit() and name not in self.counts:
                self.counts[name] = int(attributes["count"][:9])
            case "source" | "target" if self.root == "network" and self.open[-2:-1] == ["link"]:
                self.reading = (name, [])
            case "x" | "y" if self.root == "network" and owner is not None:
                self.reading = (name, [])
            case "data" if owner is not None and "key" in attributes:
                self.reading = (self.keys.get(attributes["key"], attributes["key"]), [])
            case "data" if is_of_edge and "key" in attributes:
                self.reading = (self.edge_keys.get(attributes["key"], attributes["key"]), [])
            case "nodelabel" if owner is not None:
                self.reading = ("nodelabel", [])
            case "geometry" | "position" if owner is not None:
                owner.attributes.update(_drawn_place(name, attributes))
            case "attvalue" if owner is not None and "value" in attributes:
                key = attributes.get("for", attributes.get("id", ""))
                owner.attributes.setdefault(self.keys.get(key, key), attributes["value"])
            case "attvalue" if is_of_edge and "value" in attributes:
                key = attributes.get("for", attributes.get("id", ""))
                self.edges[-1].attributes.setdefault(self.edge_keys.get(key, key), attributes["value"])
            case _:
                self.finish_text()  # the text of an element ends where its first child begins

    def name_key(self, attributes: dict[str, str], title: str, of: str) -> None:
        """Take the name that a document gives to an attribute's id."""
        name = attributes.get(title, attributes.get("id", ""))
        for keys in [*([self.keys] if of != "edge" else []), *([self.edge_keys] if of != "node" else [])]:
            keys[attributes.get("id", "")] = name

    def text(self, data: str) -> None:
        if self.reading is not None:
            self.reading[1].append(data)
        elif self.open[-1] in ("graph", "nodes", "edges", "graphml", "gexf") and data.strip():
            raise UnreadableTopology(
                f"line {self.parser.CurrentLineNumber}: the text {data.strip()[:30]!r} stands where nodes and edges "
                "are expected: the file is damaged"
            )

    def finish_text(self) -> None:
        """Give what was read to its owner."""
        if self.reading is None:
            return
        (name, pieces), self.reading = self.reading, None
        text = " ".join("".join(pieces).split())
        owner = self.owners[-1] if self.owners else None
        if owner is not None and text:
            owner.attributes.setdefault(name, text)
        elif owner is None and self.edges and self.root == "network":
            setattr(self.edges[-1], name, text)
        elif owner is None and self.edges and text:
            self.edges[-1].attributes.setdefault(name, text)

    def end(self, tag: str) -> None:
        self.finish_text()
        match self.open.pop():
            case "graph":
                self.directed.pop()
            case "node" | "edge":
                self.owners.pop()
            case "link" if self.root == "network":
                self.owners.pop()


def _drawn_place(element: str, attributes: dict[str, str]) -> dict[str, str]:
    """Return the x and y of an element that places a node; those of yEd's geometry point down."""
    found = {str(key): attributes[key] for key in ("x", "y") if key in attributes}
    if element == "geometry" and "y" in found:
        found["y"] = turned_up(found["y"])
    return found
