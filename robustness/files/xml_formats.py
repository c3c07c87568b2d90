"""GraphML and GEXF: read here, written by networkx.

What a graph is made of is taken from the document wherever it stands, in every namespace: all ``node`` and ``edge``
elements, groups and their members included, and the direction of each edge. Attributes, their types, drawings and
colours are not the graph and never stop the reading.

A document type declaration is the door to entity bombs and to entities that read files; no topology needs one, so it is
refused as soon as the XML parser itself, expat, reports it.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.parsers import expat

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.text import texts_of, warn_lossy

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["DEPTH_LIMIT", "decode_gexf", "decode_graphml", "encode_gexf", "encode_graphml"]

#: The deepest nesting of elements that is read.
DEPTH_LIMIT = 100


def decode_graphml(data: bytes) -> Digraph:
    """Return the graph of a GraphML file; nodes are named by their ``id``, as text.

    ``directed`` of an edge goes before ``edgedefault`` of its graph. Edges that a drawing shows without arrow heads run
    both ways, since editors write ``edgedefault="directed"`` whatever is drawn.
    """
    return _decoded(data, "GraphML")


def decode_gexf(data: bytes) -> Digraph:
    """Return the graph of a GEXF file; nodes are named by their ``id``, as text.

    ``type`` of an edge (directed, undirected, mutual) goes before ``defaultedgetype``.
    """
    return _decoded(data, "GEXF")


def _decoded(data: bytes, form: str) -> Digraph:
    found = _inspect(data)
    both_ways = sum(edge.runs_both_ways for edge in found.edges)
    directed = both_ways < len(found.edges) or (not found.edges and found.default_directed)
    arcs = [(edge.source, edge.target) for edge in found.edges]
    arcs += [(edge.target, edge.source) for edge in found.edges if edge.runs_both_ways and edge.source != edge.target]
    pairs = {(e.source, e.target) if not e.runs_both_ways else frozenset((e.source, e.target)) for e in found.edges}
    notes = [f"read as: {'directed' if directed else 'undirected'}, {len(found.nodes)} nodes, {len(pairs)} links"]
    if directed and both_ways:
        notes.append(f"{both_ways} of them in both directions")
    if any(edge.headless for edge in found.edges):
        notes.append("links that are drawn without arrow heads run both ways")
    if len(pairs) < len(found.edges):
        notes.append(f"{len(found.edges) - len(pairs)} parallel ones count once")
    warn_lossy(f"{'; '.join(notes)}; {form} reads every label as text")
    return Digraph(found.nodes, arcs, directed=directed)


def encode_graphml(graph: Digraph) -> bytes:
    """Return ``graph`` as GraphML."""
    import networkx as nx

    stream = io.BytesIO()
    nx.write_graphml_xml(_with_text_labels(graph, "GraphML"), stream)
    return stream.getvalue()


def encode_gexf(graph: Digraph) -> bytes:
    """Return ``graph`` as GEXF."""
    import networkx as nx

    stream = io.BytesIO()
    nx.write_gexf(_with_text_labels(graph, "GEXF"), stream)
    return stream.getvalue()


def _with_text_labels(graph: Digraph, form: str) -> nx.Graph:
    import networkx as nx

    texts = texts_of(graph.labels, form, is_allowed=_survives_xml)
    if any(type(label) is not str for label in graph.labels):
        warn_lossy(f"{form} makes every label text")
    return nx.relabel_nodes(graph.to_networkx(), dict(zip(graph.labels, texts, strict=True)))


def _survives_xml(text: str) -> bool:
    """Return whether an XML attribute gives ``text`` back: parsers reject or normalise control characters."""
    return all(c >= " " and c not in "\ufffe\uffff" for c in text)


@dataclass(slots=True)
class _Edge:
    """One edge of a document: its ends, whether its graph or itself says directed, and how it is drawn."""

    source: str
    target: str
    directed: bool
    headless: bool = False

    @property
    def runs_both_ways(self) -> bool:
        return not self.directed or self.headless


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
    if inspector.root not in ("graphml", "gexf"):
        raise UnreadableTopology(f"the document is <{inspector.root}>, neither GraphML nor GEXF")
    if not inspector.has_graph:
        raise UnreadableTopology("the document has no <graph>")
    for line, end in inspector.ends:
        if end not in inspector.nodes:
            raise UnreadableTopology(f"line {line}: <edge> joins {end!r}, which is no node: add the node")
    return inspector


class _Inspector:
    """Watches expat parse one file and takes nodes and edges from it."""

    def __init__(self) -> None:
        self.nodes: dict[str, None] = {}
        self.edges: list[_Edge] = []
        self.ends: list[tuple[int, str]] = []
        self.open: list[str] = []
        self.root = ""
        self.has_graph = False
        self.default_directed = False
        #: Whether edges are directed in each graph that is open, the innermost last.
        self.directed: list[bool] = []
        self.parser = expat.ParserCreate(namespace_separator=" ")
        self.parser.StartDoctypeDeclHandler = self.refuse_doctype
        self.parser.EntityDeclHandler = self.refuse_entity
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end

    def refuse_doctype(self, name: str, system: str | None, public: str | None, internal: bool) -> None:
        raise UnreadableTopology(f"line {self.parser.CurrentLineNumber}: a DOCTYPE is never read: remove it")

    def refuse_entity(self, *declaration: object) -> None:
        raise UnreadableTopology(f"line {self.parser.CurrentLineNumber}: an ENTITY is never read: remove it")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        line, name = self.parser.CurrentLineNumber, tag.rpartition(" ")[2].lower()
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
                if attributes["id"] in self.nodes:
                    raise UnreadableTopology(f"line {line}: node {attributes['id']!r} is given twice: keep one")
                self.nodes[attributes["id"]] = None
            case "edge":
                self.ends += [(line, attributes["source"]), (line, attributes["target"])]
                directed = self.direction(line, attributes)
                self.edges.append(_Edge(attributes["source"], attributes["target"], directed))
            case "arrows" if "edge" in self.open:
                self.draw(attributes)

    def open_graph(self, line: int, attributes: dict[str, str]) -> None:
        if self.has_graph and "node" not in self.open:
            raise UnreadableTopology(f"line {line}: a second <graph>: keep one graph a file")
        given = attributes.get("edgedefault", attributes.get("defaultedgetype"))
        above = self.directed[-1] if self.directed else False
        directed = above if given is None else given.strip().lower() == "directed"
        self.default_directed = self.default_directed or directed
        self.has_graph = True
        self.directed.append(directed)

    def direction(self, line: int, attributes: dict[str, str]) -> bool:
        """Return whether an edge has a direction: what it says itself, else what its graph says."""
        own = attributes.get("directed", attributes.get("type", "")).strip().lower()
        if own in ("true", "1", "directed"):
            return True
        if own in ("false", "0", "undirected", "mutual"):
            return False
        if "directed" in attributes:
            raise UnreadableTopology(f"line {line}: directed is true or false, not {attributes['directed']!r}")
        return self.directed[-1] if self.directed else False

    def draw(self, attributes: dict[str, str]) -> None:
        """Note which arrow heads the drawing of the last edge has."""
        heads = [attributes.get(end, "none").lower() for end in ("source", "target")]
        edge = self.edges[-1]
        if edge.directed and heads == ["none", "none"]:
            edge.headless = True
        elif edge.directed and heads[0] != "none":
            # A head at the source: against the arc, or both ways.
            if heads[1] != "none":
                edge.directed = False
            else:
                edge.source, edge.target = edge.target, edge.source

    def end(self, tag: str) -> None:
        if self.open.pop() == "graph":
            self.directed.pop()
