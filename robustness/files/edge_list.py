"""Edge lists: ``u v`` a line, labels without spaces, ``#`` starts a comment, more columns are ignored.

The format does not say whether edges have a direction. As in networkx they have none, unless a comment line
``# directed`` comes before the first edge; :func:`encode` writes it for digraphs, and networkx skips it.
"""

from __future__ import annotations

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files.text import decode_utf8, texts_of, warn_lossy

__all__ = ["decode", "encode"]

_DIRECTED = "# directed"


def decode(data: bytes) -> Digraph:
    """Return the graph of an edge list; labels are text."""
    directed = False
    edges: list[tuple[str, str]] = []
    for number, line in enumerate(decode_utf8(data).split("\n"), 1):
        columns = line.partition("#")[0].split()
        if len(columns) >= 2:
            edges.append((columns[0], columns[1]))
        elif columns:
            raise UnreadableTopology(f"line {number}: an edge is two labels with a space between, not {columns[0]!r}")
        elif not edges and line.strip().lower() == _DIRECTED:
            directed = True
    if not edges:
        raise UnreadableTopology("an edge list holds at least one edge, and here is none")
    warn_lossy("an edge list reads every label as text and has no isolated nodes")
    if not directed:
        edges += [(v, u) for u, v in edges if u != v]
    return Digraph(dict.fromkeys(label for edge in edges for label in edge), edges, directed=directed)


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as an edge list."""
    texts = texts_of(graph.labels, "an edge list", is_allowed=lambda text: text.split() == [text] and "#" not in text)
    if not graph.arc_count:
        raise InvalidGraph("an edge list cannot hold a graph without edges: write .json instead")
    directed = graph.directed or not graph.is_symmetric
    lines = [_DIRECTED] if directed else []
    heard: set[int] = set()
    for u, v in graph.arcs():
        heard.update((u, v))
        if directed or u < v:
            lines.append(f"{texts[u]} {texts[v]}")
    lost = graph.n - len(heard)
    if lost or any(type(label) is not str for label in graph.labels):
        warn_lossy(f"an edge list makes every label text and drops isolated nodes (here {lost})")
    return ("\n".join(lines) + "\n").encode()
