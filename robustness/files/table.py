"""Rows of cells in a file: a list of links or a matrix, by what they look like; refused where they may be both."""

from __future__ import annotations

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.edge_list import graph_of_links, links_of
from robustness.files.matrix import matrix_of_rows
from robustness.files.rows import arrows_of, rows_of

__all__ = ["decode_csv", "decode_text"]


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
