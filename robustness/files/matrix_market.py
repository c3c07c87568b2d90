"""MatrixMarket (.mtx): read here, since SciPy's reader crashes the process on some damaged files.

``%%MatrixMarket matrix coordinate|array real|integer|pattern general|symmetric|skew-symmetric``, comments, a line of
sizes, and the entries: ``row column [value]`` from 1, or all values column by column. Symmetry is spelled out. Which
way rows are read, and what an entry says, is as in :mod:`robustness.files.matrix`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.found import ReadingOptions
from robustness.files.graph6 import warn_of_lost_labels
from robustness.files.matrix import graph_of_entries, graph_of_pattern, links_in
from robustness.files.rows import is_number
from robustness.files.text import decode_utf8
from robustness.spelled import counted

__all__ = ["CELL_LIMIT", "NODE_LIMIT", "decode", "encode", "graph_of_weights"]

#: The most nodes, and the most cells of a matrix that is not sparse, that are read.
NODE_LIMIT = 1_000_000
CELL_LIMIT = 100_000_000

_Lines = list[tuple[int, list[str]]]


def decode(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a MatrixMarket file."""
    first, *others = decode_utf8(data).splitlines() or [""]
    words = first.lower().split()
    if words[:2] != ["%%matrixmarket", "matrix"] or len(words) != 5:
        raise UnreadableTopology("line 1: a MatrixMarket file begins with '%%MatrixMarket matrix' and three more words")
    layout, field, symmetry = words[2:]
    for word, known in (
        (layout, ("coordinate", "array")),
        (field, ("real", "double", "integer", "pattern")),
        (symmetry, ("general", "symmetric", "skew-symmetric")),
    ):
        if word not in known:
            raise UnreadableTopology(f"line 1: {word!r} is not one of {', '.join(known)}")
    rows = [(number, line.split()) for number, line in enumerate(others, 2) if line.strip() and line.lstrip()[0] != "%"]
    if not rows:
        raise UnreadableTopology("a MatrixMarket file has a line of sizes, and here is none")
    n, count = _sizes(rows[0], layout)
    read = _coordinates if layout == "coordinate" else _array
    return read(rows[1:], n, count, field == "pattern", symmetry, options)


def _sizes(row: tuple[int, list[str]], layout: str) -> tuple[int, int]:
    """Return the number of nodes and of entries."""
    number, cells = row
    wanted = 3 if layout == "coordinate" else 2
    if len(cells) != wanted or not all(cell.isascii() and cell.isdigit() and len(cell) < 19 for cell in cells):
        raise UnreadableTopology(
            f"line {number}: the sizes are {counted(wanted, 'number')}, not {' '.join(cells)[:40]!r}"
        )
    sizes = [int(cell) for cell in cells]
    if sizes[0] != sizes[1]:
        raise UnreadableTopology(f"line {number}: an adjacency matrix is square, not {sizes[0]} x {sizes[1]}")
    if sizes[0] > NODE_LIMIT or (layout == "array" and sizes[0] ** 2 > CELL_LIMIT):
        raise UnreadableTopology(f"line {number}: a matrix of {sizes[0]} x {sizes[0]} is larger than what is read")
    return sizes[0], sizes[2] if layout == "coordinate" else sizes[0] ** 2


def _coordinates(rows: _Lines, n: int, count: int, is_pattern: bool, symmetry: str, options: ReadingOptions) -> Digraph:
    if len(rows) != count:
        raise UnreadableTopology(f"the sizes announce {counted(count, 'entry', 'entries')}, and {len(rows)} are there")
    ends, values = [], []
    for number, cells in rows:
        if len(cells) != (2 if is_pattern else 3) or not all(cell.isascii() and cell.isdigit() for cell in cells[:2]):
            raise UnreadableTopology(
                f"line {number}: an entry is a row, a column{'' if is_pattern else ' and a value'}"
            )
        row, column = (int(cell) if len(cell) < 19 else 0 for cell in cells[:2])
        if not (1 <= row <= n and 1 <= column <= n):
            raise UnreadableTopology(f"line {number}: row and column lie in 1..{n}, not {cells[0]}, {cells[1]}")
        ends.append((row - 1, column - 1))
        values.append(1.0 if is_pattern else _value(number, cells[2]))
    pairs = np.array(ends, dtype=np.int64).reshape(-1, 2)
    weights = np.array(values)
    if symmetry != "general":
        off = pairs[:, 0] != pairs[:, 1]
        pairs = np.concatenate([pairs, pairs[off][:, ::-1]])
        weights = np.abs(np.concatenate([weights, weights[off]])) if symmetry == "skew-symmetric" else (
            np.concatenate([weights, weights[off]])
        )  # fmt: skip
    return graph_of_weights(pairs, weights, n, options)


def _array(rows: _Lines, n: int, count: int, is_pattern: bool, symmetry: str, options: ReadingOptions) -> Digraph:
    if is_pattern or symmetry == "skew-symmetric":
        raise UnreadableTopology("line 1: an array holds numbers, general or symmetric")
    wanted = count if symmetry == "general" else n * (n + 1) // 2
    if len(rows) != wanted or any(len(cells) != 1 for _, cells in rows):
        raise UnreadableTopology(
            f"the sizes announce {counted(wanted, 'value')}, one a line, and {counted(len(rows), 'line')} are there"
        )
    values = np.array([_value(number, cells[0]) for number, cells in rows])
    matrix = np.zeros((n, n))
    if symmetry == "general":
        matrix = values.reshape(n, n).T
    else:
        columns, lower = np.triu_indices(n)
        matrix[lower, columns] = values
        matrix[columns, lower] = values
    pattern, notes = links_in(
        matrix, lambda row, column: f"row {row + 1}, column {column + 1}: {matrix[row, column]:g}"
    )
    return graph_of_pattern(pattern, options, None, notes)


def _value(number: int, cell: str) -> float:
    if not is_number(cell):
        raise UnreadableTopology(f"line {number}: {cell[:40]!r} is not a number")
    return float(cell)


def graph_of_weights(
    pairs: npt.NDArray[np.int64],
    weights: npt.NDArray[np.float64],
    n: int,
    options: ReadingOptions,
    labels: Sequence[int] | None = None,
    *,
    name: Callable[[int], int] = lambda k: k + 1,
) -> Digraph:
    """Return the graph of the entries of a sparse matrix; a Laplacian has its links where it is negative.

    Raises
    ------
    UnreadableTopology
        When an entry may be a link and may be none.
    """
    off = pairs[:, 0] != pairs[:, 1]
    odd = (off & ~(weights >= 0)) | ~np.isfinite(weights)
    notes: list[str] = []
    kept = weights != 0
    if odd.any():
        sums = np.bincount(pairs[:, 0], weights=np.where(np.isfinite(weights), weights, np.inf), minlength=n)
        if not ((weights[off] <= 0).all() and np.allclose(sums, 0)):
            k = int(np.argmax(odd))
            raise UnreadableTopology(
                f"row {name(pairs[k, 0])}, column {name(pairs[k, 1])}: {weights[k]:g} may be no link, or a link of "
                "negative "
                "weight: write 0 or 1"
            )
        kept = off & (weights < 0)
        notes.append("a Laplacian matrix, whose negative entries are the links")
    return graph_of_entries(pairs[kept, 0], pairs[kept, 1], n, options, labels, notes)


def encode(graph: Digraph) -> bytes:
    """Return ``graph`` as a MatrixMarket file: a pattern, symmetric or general; row u, column v is the arc (u, v)."""
    warn_of_lost_labels(graph, "MatrixMarket")
    kind = "symmetric" if graph.is_symmetric else "general"
    # Of a symmetric matrix the lower triangle is written.
    arcs = [(u, v) for u, v in graph.arcs() if not graph.is_symmetric or u > v]
    lines = [f"%%MatrixMarket matrix coordinate pattern {kind}", f"{graph.n} {graph.n} {len(arcs)}"]
    return ("\n".join([*lines, *(f"{u + 1} {v + 1}" for u, v in arcs)]) + "\n").encode("ascii")
