"""GraphML and GEXF, read and written by networkx, after this module has found the XML harmless.

A document type declaration is the door to entity bombs and to entities that read files; no topology needs
one, so :func:`_inspect` refuses it as soon as the XML parser itself, expat, reports it. That is the parser
networkx's readers use, so no encoding hides a declaration from one and shows it to the other. The same
pass gives what those readers take without a word a place and an error: repeated nodes, edges that join none.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING
from xml.parsers import expat

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.text import parsed_by_networkx, texts_of, warn_lossy

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["DEPTH_LIMIT", "decode_gexf", "decode_graphml", "encode_gexf", "encode_graphml"]

#: The deepest nesting of elements that is read.
DEPTH_LIMIT = 100


def decode_graphml(data: bytes) -> Digraph:
    """Return the graph of a GraphML file; nodes are named by their ``id``, as text."""
    import networkx as nx

    _inspect(data)
    warn_lossy("GraphML reads every label as text")
    return parsed_by_networkx(lambda: nx.read_graphml(io.BytesIO(data)))


def decode_gexf(data: bytes) -> Digraph:
    """Return the graph of a GEXF file; nodes are named by their ``id``, as text."""
    import networkx as nx

    _inspect(data)
    warn_lossy("GEXF reads every label as text")
    return parsed_by_networkx(lambda: nx.read_gexf(io.BytesIO(data)))


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


def _inspect(data: bytes) -> None:
    """Guarantees well-formed XML without a document type, with unique nodes, and edges between these."""
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
    for line, end in inspector.ends:
        if end not in inspector.nodes:
            raise UnreadableTopology(f"line {line}: <edge> joins {end!r}, which is no node: add the node")


class _Inspector:
    """Watches expat parse one file and refuses what networkx's readers must not see."""

    def __init__(self) -> None:
        self.nodes: set[str] = set()
        self.ends: list[tuple[int, str]] = []
        self.depth = self.graphs = 0
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
        self.depth += 1
        line, name = self.parser.CurrentLineNumber, tag.rpartition(" ")[2]
        self.graphs += name == "graph"
        if self.graphs > 1:
            raise UnreadableTopology(f"line {line}: a second <graph>: keep one graph a file")
        if self.depth > DEPTH_LIMIT:
            raise UnreadableTopology(f"line {line}: elements are nested more than {DEPTH_LIMIT} deep")
        needed = {"node": ("id",), "edge": ("source", "target")}.get(name, ())
        for attribute in needed:
            if attribute not in attributes:
                raise UnreadableTopology(f"line {line}: <{name}> has no '{attribute}'")
        if name == "edge":
            self.ends += [(line, attributes["source"]), (line, attributes["target"])]
        elif name == "node":
            if attributes["id"] in self.nodes:
                raise UnreadableTopology(f"line {line}: node {attributes['id']!r} is given twice: keep one")
            self.nodes.add(attributes["id"])

    def end(self, tag: str) -> None:
        self.depth -= 1
