"""GML, read and written by networkx; labels become text."""

from __future__ import annotations

import io
from collections.abc import Hashable
from typing import TYPE_CHECKING

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.text import decode_utf8, parsed_by_networkx, texts_of, warn_lossy

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["decode", "encode"]


def decode(data: bytes) -> Digraph:
    """Return the graph of a GML file: nodes are named by ``label``, or by ``id`` where no node has a label."""
    import networkx as nx

    text = decode_utf8(data)
    warn_lossy("GML reads a quoted label as text")
    return parsed_by_networkx(lambda: _named(nx.parse_gml(text, label=None)))


def _named(graph: nx.Graph) -> nx.Graph:
    """Return ``graph``, whose nodes are GML ids, with labels as nodes; networkx would have to parse it twice."""
    import networkx as nx

    names = {node: attributes["label"] for node, attributes in graph.nodes(data=True) if "label" in attributes}
    if not names:
        return graph
    owners: dict[Hashable, Hashable] = {}
    for node in graph:
        if node not in names:
            raise UnreadableTopology(f"the node of id {node} has no label: label every node or none")
        if owners.setdefault(names[node], node) != node:
            raise UnreadableTopology(f"the label {names[node]!r} is given twice: give every node its own")
    return nx.relabel_nodes(graph, names)


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
