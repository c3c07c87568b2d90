"""Adjacency matrices: row u, column v nonzero is the arc (u, v), so v hears u; nodes are ``0..n-1``.

A symmetric pattern of nonzeros is an undirected graph. Weights are ignored and the diagonal is self-loops.
"""

from __future__ import annotations

import io
import math
import re

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files.graph6 import warn_of_lost_labels
from robustness.files.rows import Rows, is_number
from robustness.files.text import warn_lossy

__all__ = ["decode_npy", "encode_csv", "encode_npy", "matrix_of_rows"]

_TRUTH = {"true": True, "false": False}


def matrix_of_rows(rows: Rows, *, in_text: bool) -> Digraph | None:
    """Return the graph of a matrix with or without labels, or None when the rows are no matrix.

    Raises
    ------
    UnreadableTopology
        When the rows may be a matrix and may be links, or a cell may be a link and may be none.
    """
    cells, lines = rows.cells, rows.lines
    height, width = len(cells), len(cells[0])
    labels: list[str] | None = None
    top, left = 0, 0
    inner = [row[1:] for row in cells[1:]]
    is_framed = height == width > 2 and _all_values(inner) and not _all_values(cells)
    if is_framed and cells[0][1:] == [row[0] for row in cells[1:]]:
        labels, top, left = cells[0][1:], 1, 1
    elif is_framed and not cells[0][0]:
        raise UnreadableTopology("the labels of the rows are not those of the columns: give both the same order")
    elif height == width + 1 and width > 2 and _all_values(cells[1:]) and not any(map(_is_value, cells[0])):
        labels, top = cells[0], 1
    elif height != width or not _all_values(cells) or (in_text and width == 2):
        _refuse_a_matrix_that_is_damaged(rows, in_text)
        return None
    block = [row[left:] for row in cells[top:]]
    if labels is None and width in (2, 3) and not _is_surely_a_matrix(block):
        what = "with weights " if width == 3 else ""
        raise UnreadableTopology(
            f"{height} rows of {width} numbers may be a matrix and may be {height} links {what}between nodes that are "
            "numbers: name the columns source and target in a first line, or the nodes in a first line and column"
        )
    if labels is not None and len(set(labels)) < len(labels):
        raise UnreadableTopology(f"line {lines[0]}: a label is given twice: give every node its own")
    pattern = _pattern(block, lines[top:], left)
    return _graph_of(pattern, labels)


def _is_value(cell: str) -> bool:
    return is_number(cell) or cell.lower() in _TRUTH


def _all_values(cells: list[list[str]]) -> bool:
    return all(_is_value(cell) for row in cells for cell in row)


def _refuse_a_matrix_that_is_damaged(rows: Rows, in_text: bool) -> None:
    """Refuse a block of numbers that is too wide for links and not square."""
    width, height = len(rows.cells[0]), len(rows.cells)
    values = sum(_is_value(cell) for row in rows.cells for cell in row)
    if in_text or width < 4 or values < 0.9 * width * height:
        return
    for row, line in zip(rows.cells, rows.lines, strict=True):
        for column, cell in enumerate(row, 1):
            if not _is_value(cell):
                raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is not a number")
    if height != width and _all_values(rows.cells):
        raise UnreadableTopology(f"an adjacency matrix is square, not {height} x {width}")


def _is_surely_a_matrix(block: list[list[str]]) -> bool:
    """Return whether numbers in two or three columns are no links: only 0 and 1, or nothing on the diagonal."""
    values = [[_value(cell) for cell in row] for row in block]
    return all(values[k][k] == 0 for k in range(len(values)))


def _value(cell: str) -> float:
    return float(_TRUTH[cell.lower()]) if cell.lower() in _TRUTH else float(cell)


def _pattern(block: list[list[str]], lines: list[int], left: int) -> npt.NDArray[np.bool_]:
    """Return where a matrix has links: nonzero entries, or the negative ones of a Laplacian."""
    for row, line in zip(block, lines, strict=True):
        for column, cell in enumerate(row, 1 + left):
            if not _is_value(cell):
                raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is not a number")
            value = _value(cell)
            if not math.isfinite(value):
                raise UnreadableTopology(
                    f"line {line}, column {column}: {cell!r} may be no link, or a link without a bound: write 0 or 1"
                )
            if value == 0 and re.search(r"[1-9]", cell.lower().partition("e")[0]):
                raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is too small a number: write 0 or 1")
    values = np.array([[_value(cell) for cell in row] for row in block])
    negative = values < 0
    if not negative.any():
        nonzero: npt.NDArray[np.bool_] = values != 0
        return nonzero
    off = ~np.eye(len(values), dtype=bool)
    if (values[off] <= 0).all() and (values.diagonal() >= 0).all() and np.allclose(values.sum(axis=1), 0):
        warn_lossy("read as: a Laplacian matrix; its negative entries are the links")
        links: npt.NDArray[np.bool_] = negative & off
        return links
    row, column = np.argwhere(negative)[0].tolist()
    raise UnreadableTopology(
        f"line {lines[row]}, column {column + 1 + left}: {block[row][column]!r} may be no link, or a link of negative "
        "weight: write 0 or 1"
    )


def decode_npy(data: bytes) -> Digraph:
    """Return the graph of a NumPy array of numbers or truth values; pickled objects are never loaded."""
    shape, dtype, start = _npy_header(data)
    if dtype.hasobject or dtype.kind not in "biuf":
        raise UnreadableTopology(f"an adjacency matrix holds numbers or truth values, not {dtype}")
    if not all(type(size) is int and size >= 0 for size in shape):
        raise UnreadableTopology(f"the header gives the shape {shape}, which no array has")
    if len(shape) != 2 or shape[0] != shape[1]:
        raise UnreadableTopology(f"an adjacency matrix is square, not {' x '.join(map(str, shape)) or 'one number'}")
    if math.prod(shape) * dtype.itemsize != len(data) - start:
        raise UnreadableTopology(
            f"the array needs {math.prod(shape) * dtype.itemsize} bytes, and {len(data) - start} are there"
        )
    weights = np.load(io.BytesIO(data), allow_pickle=False)
    if dtype.kind == "f" and not np.isfinite(weights).all():
        row, column = np.argwhere(~np.isfinite(weights))[0].tolist()
        raise UnreadableTopology(f"row {row}, column {column}: {weights[row, column]} is not a finite number")
    return _graph_of(weights != 0)


def encode_csv(graph: Digraph) -> bytes:
    """Return ``graph`` as rows of 0 and 1 separated by commas."""
    if not graph.n:
        raise InvalidGraph("an adjacency matrix in .csv has at least one row: write the empty graph to .json")
    return ("\n".join(",".join(map(str, row)) for row in _matrix_of(graph).tolist()) + "\n").encode("ascii")


def encode_npy(graph: Digraph) -> bytes:
    """Return ``graph`` as a NumPy array of 0 and 1 (``uint8``)."""
    stream = io.BytesIO()
    np.save(stream, _matrix_of(graph), allow_pickle=False)
    return stream.getvalue()


def _npy_header(data: bytes) -> tuple[tuple[int, ...], np.dtype[np.generic], int]:
    """Return shape, type and offset of the numbers, so that nothing is allocated on a header's word alone."""
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read(stream)
    except Exception as problem:  # noqa: BLE001 - numpy evaluates the header as a Python literal, which raises anything
        raise UnreadableTopology(f"the header is not that of a .npy file: {problem}") from None
    return shape, dtype, stream.tell()


def _graph_of(pattern: npt.NDArray[np.bool_], labels: list[str] | None = None) -> Digraph:
    tails, heads = np.nonzero(pattern)
    arcs = zip(tails.tolist(), heads.tolist(), strict=True)
    directed = not np.array_equal(pattern, pattern.T)
    if directed:
        warn_lossy(
            "read as: a directed matrix, in which row u, column v says that v hears u; transpose it if row u says whom "
            "u hears"
        )
    if labels is None:
        return Digraph(range(len(pattern)), arcs, directed=directed)
    return Digraph(labels, ((labels[u], labels[v]) for u, v in arcs), directed=directed)


def _matrix_of(graph: Digraph) -> npt.NDArray[np.uint8]:
    warn_of_lost_labels(graph, "an adjacency matrix")
    weights = np.zeros((graph.n, graph.n), dtype=np.uint8)
    weights[graph.in_indices, graph.heads] = 1
    return weights
