"""Rows of cells in a file: a list of links or a matrix, by what they look like; refused where they may be both."""

from __future__ import annotations

import warnings

from robustness.digraph import Digraph, GraphWarning
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files.edge_list import graph_of_links, links_of
from robustness.files.matrix import matrix_of_rows
from robustness.files.rows import arrows_of, rows_of
from robustness.files.text import texts_of, warn_lossy

__all__ = ["decode_csv", "decode_text", "encode_text"]

_DIRECTED = "# directed"


def decode_text(data: bytes) -> Digraph:
    """Return the graph of an edge list, or of a matrix, in text; labels of an edge list are text."""
    arrows = arrows_of(data)
    if arrows is not None:
        return graph_of_links(*arrows, "arrows")
    rows = rows_of(data)
    if not rows.cells:
        raise UnreadableTopology("an edge list holds at least one edge, and here is none")
    matrix = matrix_of_rows(rows, in_text=True)
    return matrix if matrix is not None else links_of(rows)


def decode_csv(data: bytes) -> Digraph:
    """Return the graph of a table: a matrix, bare or with labels, or a list of links.

    Separators are commas, semicolons, tabs or spaces. A table that may be a matrix and may be a list of links is
    refused.
    """
    rows = rows_of(data)
    if not rows.cells:
        raise UnreadableTopology("an adjacency matrix has at least one row, and here is none")
    matrix = matrix_of_rows(rows, in_text=False)
    return matrix if matrix is not None else links_of(rows)


def encode_text(graph: Digraph) -> bytes:
    """Return ``graph`` as an edge list: tabs between labels, in quotes where letters in them mean something."""
    texts = texts_of(graph.labels, "an edge list", is_allowed=lambda text: text.isprintable() and text.strip() == text)
    if not graph.arc_count:
        raise InvalidGraph("an edge list cannot hold a graph without edges: write .json instead")
    directed = graph.directed or not graph.is_symmetric
    lines = [_DIRECTED] if directed else []
    heard: set[int] = set()
    links: set[tuple[str, str]] = set()
    for u, v in graph.arcs():
        heard.update((u, v))
        if directed or u < v:
            links.add((texts[u], texts[v]))
            lines.append(f"{_quoted(texts[u])}\t{_quoted(texts[v])}")
    data = ("\n".join(lines) + "\n").encode()
    _require_the_same(data, links, directed)
    lost = graph.n - len(heard)
    if lost or any(type(label) is not str for label in graph.labels):
        warn_lossy(f"an edge list makes every label text and drops isolated nodes (here {lost})")
    return data


def _quoted(text: str) -> str:
    """Return a label as a cell."""
    if text.isalnum():
        return text
    return '"' + text.replace('"', '""') + '"'


def _require_the_same(data: bytes, links: set[tuple[str, str]], directed: bool) -> None:
    """Guarantees that a reader finds these links and no others: labels such as ``source`` may read as a header."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GraphWarning)
            found = decode_text(data)
    except UnreadableTopology as problem:
        raise InvalidGraph(f"an edge list could not be read back ({problem}): write .json instead") from None
    arcs = {(str(found.labels[u]), str(found.labels[v])) for u, v in found.arcs()}
    wanted = links if directed else links | {(v, u) for u, v in links}
    if arcs != wanted:
        raise InvalidGraph("an edge list would be read back as another graph: write .json instead")
