"""Rows of cells in text: links, lists of neighbours or a matrix, by what they look like; refused where in doubt."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from typing import Literal

from robustness.digraph import Digraph, GraphWarning
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files import matrix_market, pajek
from robustness.files.adjacency_list import lists_of, neighbours_of, refuse_lists_of_neighbours
from robustness.files.edge_list import NO_ISOLATED, PARALLEL, arrows_of, links_of, sections_of, without_counts
from robustness.files.found import Found, ReadingOptions, graph_of
from robustness.files.matrix import matrix_of_rows
from robustness.files.number_links import number_links
from robustness.files.rows import content_of, rows_of
from robustness.files.text import texts_of, warn_lossy

__all__ = ["decode_table", "encode_text"]

_DIRECTED = "# directed"

Kind = Literal["table", "edge-list", "matrix", "adjacency-list"]


def decode_table(data: bytes, options: ReadingOptions, kind: Kind = "table", *, in_text: bool = True) -> Digraph:
    """Return the graph of rows in text: links, lists of neighbours, or a matrix, bare or with labels.

    Separators are commas, semicolons, tabs or spaces. Rows that may be two things are refused, with the option that
    says which they are. ``in_text``: two columns are links, as in .txt, and never a matrix of two nodes, as in .csv.
    """
    if kind == "table":
        if re.match(rb"(\xef\xbb\xbf)?%%MatrixMarket", data):
            return matrix_market.decode(data, options)
        if re.match(rb"(\xef\xbb\xbf)?\s*\*(vertices|network)\b", data, re.IGNORECASE):
            return pajek.decode(data, options)
    if kind in ("table", "edge-list") and (long := number_links(data, options, NO_ISOLATED, PARALLEL)) is not None:
        return graph_of(long, options)
    content = content_of(data, options.skip_lines)
    may_be_links = kind in ("table", "edge-list") and options.rows is None
    found: Found | None = None
    if may_be_links and options.columns is None:
        found = arrows_of(content) or sections_of(content)
    may_be_lists = kind == "table" and options.columns is None
    if kind == "adjacency-list" or (found is None and may_be_lists and neighbours_of(content) is not None):
        found = lists_of(content, options)
    if found is not None:
        return graph_of(found, options)
    nodes: list[str] | None = None
    notes: list[str] = []
    if may_be_links and options.columns is None:
        content, nodes, notes = without_counts(content)
    rows = rows_of(content)
    if not rows.cells:
        raise UnreadableTopology(
            "an edge list holds at least one edge, and here is none"
            if in_text
            else "an adjacency matrix has at least one row, and here is none"
        )
    if kind == "matrix" or (options.columns is None and kind == "table" and nodes is None):
        refuse_lists_of_neighbours(rows, is_asked=kind == "matrix")
        matrix = matrix_of_rows(rows, options, in_text=in_text, is_asked=kind == "matrix" or options.rows is not None)
        if matrix is not None:
            return matrix
    return graph_of(links_of(rows, options, nodes, notes), options)


def encode_text(graph: Digraph) -> bytes:
    """Return ``graph`` as an edge list: tabs between labels, in quotes where letters in them mean something."""
    texts = texts_of(graph.labels, "an edge list", is_allowed=lambda text: text.isprintable() and text.strip() == text)
    if not graph.arc_count:
        raise InvalidGraph("an edge list cannot hold a graph without edges: write .json instead")
    directed = graph.directed or not graph.is_symmetric
    pairs = [(u, v) for u, v in graph.arcs() if directed or u < v]
    met = Counter(end for pair in pairs for end in pair)
    # A first link that meets no other one would read as names of the columns.
    pairs.sort(key=lambda pair: met[pair[0]] + met[pair[1]] == 2)
    heard = set(met)
    links = {(texts[u], texts[v]) for u, v in pairs}
    lines = [_DIRECTED] if directed else []
    lines += [f"{_quoted(texts[u])}\t{_quoted(texts[v])}" for u, v in pairs]
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
            found = decode_table(data, ReadingOptions())
    except UnreadableTopology as problem:
        raise InvalidGraph(f"an edge list could not be read back ({problem}): write .json instead") from None
    arcs = {(str(found.labels[u]), str(found.labels[v])) for u, v in found.arcs()}
    wanted = links if directed else links | {(v, u) for u, v in links}
    if arcs != wanted:
        raise InvalidGraph("an edge list would be read back as another graph: write .json instead")
