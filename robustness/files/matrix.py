"""Adjacency matrices: row u, column v nonzero is the arc (u, v), so v hears u; nodes are ``0..n-1``.

``rows="hear"`` turns that round: row u, column v nonzero says that u hears v, as control papers write it
(docs/adr/0007-rows-of-a-matrix.md). A symmetric pattern of nonzeros is an undirected graph. Weights are ignored and the
diagonal is self-loops.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import AmbiguousTopology, InvalidGraph, UnreadableTopology
from robustness.files.found import Found, Node, ReadingOptions, graph_of
from robustness.files.graph6 import warn_of_lost_labels
from robustness.files.rows import Rows, is_number
from robustness.spelled import counted

__all__ = [
    "decode_npy",
    "encode_csv",
    "encode_npy",
    "graph_of_entries",
    "graph_of_pattern",
    "links_in",
    "matrix_of_rows",
]

_TRUTH = {"true": True, "false": False}

#: What is taken for granted of a matrix without a single 0.
_COMPLETE = (
    "no entry beside the diagonal is 0, so everybody is linked with everybody; "
    "of distances or weights write 1 for a link and 0 for none"
)


def matrix_of_rows(rows: Rows, options: ReadingOptions, *, in_text: bool, is_asked: bool) -> Digraph | None:
    """Return the graph of a matrix with or without labels, or None when the rows are no matrix.

    Parameters
    ----------
    rows : Rows
    options : ReadingOptions
    in_text : bool
        Two columns are links.
    is_asked : bool
        The user says that this is a matrix, so that nothing else is considered.

    Raises
    ------
    UnreadableTopology
        When the rows may be a matrix and may be links (AmbiguousTopology), or a cell may be a link and may be none.
    """
    cells, lines = _with_blanks_filled(rows.cells), rows.lines
    height, width = len(cells), len(cells[0])
    labels: list[str] | None = None
    top, left = 0, 0
    inner = [row[1:] for row in cells[1:]]
    is_framed = height == width > 2 and _all_values(inner) and (not _all_values(cells) or not cells[0][0])
    if is_framed and cells[0][1:] == [row[0] for row in cells[1:]]:
        labels, top, left = cells[0][1:], 1, 1
    elif is_framed and not cells[0][0]:
        raise UnreadableTopology("the labels of the rows are not those of the columns: give both the same order")
    elif height == width + 1 and width > 2 and _all_values(cells[1:]) and not any(map(_is_value, cells[0])):
        labels, top = cells[0], 1
    elif height == width + 1 and width > 2 and _all_values(cells[1:]) and cells[0] == [str(k) for k in range(width)]:
        top = 1  # a table without names of its own, under the numbers of its columns
    elif not is_asked and (height != width or not _all_values(cells) or (in_text and width < 3)):
        _refuse_a_matrix_that_is_damaged(rows, in_text)
        return None
    block = [row[left:] for row in cells[top:]]
    if len(block) != len(block[0]):
        raise UnreadableTopology(f"an adjacency matrix is square, not {len(block)} x {len(block[0])}")
    if labels is None and not is_asked and not _is_surely_a_matrix(block):
        what = "with weights " if width > 2 else ""
        raise AmbiguousTopology(
            f"{height} rows of {width} numbers may be a matrix and may be {counted(height, 'link')} {what}"
            "between nodes that are numbers: say which with --format matrix or --format edge-list"
        )
    if labels is not None and len(set(labels)) < len(labels):
        raise UnreadableTopology(f"line {lines[0]}: a label is given twice: give every node its own")
    pattern, notes = _pattern(block, lines[top:], left)
    return graph_of_pattern(pattern, options, labels, notes)


def _with_blanks_filled(cells: list[list[str]]) -> list[list[str]]:
    """Return the rows of a table that is framed by the same labels with 0 in its blank cells; others as they are."""
    labels = cells[0][1:]
    if len(labels) < 2 or cells[0][0] or labels != [row[0] for row in cells[1:]]:
        return cells
    return [cells[0], *([row[0], *(cell or "0" for cell in row[1:])] for row in cells[1:])]


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
    """Return whether a block of numbers is no list of links: nothing on the diagonal, only 0 and 1, or no labels."""
    if len(block) == 1 or all(_value(block[k][k]) == 0 for k in range(len(block))):
        return True
    if len(block) > 2 and all(_value(cell) in (0, 1) for row in block for cell in row):
        return True
    return not all(cell.isdigit() for row in block for cell in row[:2]) or any(row[0] == row[1] for row in block)


def _value(cell: str) -> float:
    return float(_TRUTH[cell.lower()]) if cell.lower() in _TRUTH else float(cell)


def _pattern(block: list[list[str]], lines: list[int], left: int) -> tuple[npt.NDArray[np.bool_], list[str]]:
    """Return where a matrix in text has links, and what was taken for granted."""
    for row, line in zip(block, lines, strict=True):
        for column, cell in enumerate(row, 1 + left):
            if not _is_value(cell):
                raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is not a number")
            if _value(cell) == 0 and re.search(r"[1-9]", cell.lower().partition("e")[0]):
                raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is too small a number: write 0 or 1")
    values = np.array([[_value(cell) for cell in row] for row in block])

    def place(row: int, column: int) -> str:
        return f"line {lines[row]}, column {column + 1 + left}: {block[row][column]!r}"

    return links_in(values, place)


def links_in(
    values: npt.NDArray[np.float64], place: Callable[[int, int], str]
) -> tuple[npt.NDArray[np.bool_], list[str]]:
    """Return where a square matrix of numbers has links, and what was taken for granted.

    Nonzero entries are links, with a word where all are and their numbers differ. A Laplacian has them where it is
    negative. In a matrix of costs, where every entry beside the diagonal is positive but for one mark (infinity, not a
    number, or -1), the mark is no link.

    Raises
    ------
    UnreadableTopology
        When an entry may be a link and may be none; ``place`` says where it stands.
    """
    off = ~np.eye(len(values), dtype=bool)
    odd = off & (~np.isfinite(values) | (values < 0))
    if not odd.any() and np.isfinite(values).all():
        beside = values[off]
        # Of three nodes or more these are more likely distances than a complete network.
        is_measured = len(values) > 2 and beside.all() and (beside != beside[:1]).any()
        return values != 0, [_COMPLETE] if is_measured else []
    is_laplacian = np.isfinite(values).all() and (values[off] <= 0).all() and (values.diagonal() >= 0).all()
    if is_laplacian and np.allclose(values.sum(axis=1), 0):
        return odd, ["a Laplacian matrix, whose negative entries are the links"]
    marks = values[odd]
    is_one_mark = np.isposinf(marks).all() or np.isnan(marks).all() or (marks == -1).all()
    if odd.any() and is_one_mark and (values[off & ~odd] > 0).all():
        mark = {True: "inf"}.get(bool(np.isposinf(marks[0])), "nan" if np.isnan(marks[0]) else "-1")
        return off & ~odd, [f"{mark} is no link, since no entry beside the diagonal is 0"]
    row, column = np.argwhere(odd if odd.any() else ~np.isfinite(values))[0].tolist()
    raise UnreadableTopology(
        f"{place(row, column)} may be no link, or a link without a bound or of negative weight: write 0 or 1"
    )


def decode_npy(data: bytes, options: ReadingOptions) -> Digraph:
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
            f"the array needs {counted(math.prod(shape) * dtype.itemsize, 'byte')}, and {len(data) - start} are there"
        )
    weights = np.load(io.BytesIO(data), allow_pickle=False)
    return graph_of_pattern(weights, options) if dtype.kind == "b" else _graph_of_numbers(weights, options)


def _graph_of_numbers(weights: npt.NDArray[Any], options: ReadingOptions) -> Digraph:
    pattern, notes = links_in(
        weights.astype(np.float64), lambda row, column: f"row {row}, column {column}: {weights[row, column]}"
    )
    return graph_of_pattern(pattern, options, None, notes)


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


def graph_of_pattern(
    pattern: npt.NDArray[np.bool_],
    options: ReadingOptions,
    labels: Sequence[Hashable] | None = None,
    notes: Sequence[str] = (),
) -> Digraph:
    """Return the graph of a matrix of truth values, shape ``(n, n)``; of one not symmetric say how it is read."""
    tails, heads = np.nonzero(pattern)
    return graph_of_entries(tails, heads, len(pattern), options, labels, notes)


def graph_of_entries(
    tails: npt.NDArray[np.int64],
    heads: npt.NDArray[np.int64],
    n: int,
    options: ReadingOptions,
    labels: Sequence[Hashable] | None = None,
    notes: Sequence[str] = (),
) -> Digraph:
    """Return the graph of a matrix whose entries (row, column) that are not zero are given.

    Row u says who hears u, unless ``options.rows`` is ``"hear"``: then it says whom u hears (docs/adr/0007).
    """
    names: Sequence[Hashable] = range(n) if labels is None else labels
    said, asked = list(notes), []
    is_doubtful = bool(notes)
    codes = np.unique(tails.astype(np.int64) * n + heads)
    tails, heads = np.divmod(codes, max(n, 1))
    is_symmetric = np.array_equal(codes, np.sort(heads * n + tails))
    if not is_symmetric and options.directed is not False:
        if options.rows == "hear":
            tails, heads = heads, tails
            asked.append("a matrix, in which row u says whom u hears, as asked")
        elif options.rows == "speak":
            asked.append("a matrix, in which row u says who hears u, as asked")
        else:
            is_doubtful = True
            said.append(
                "a matrix, in which row u, column v says that v hears u; --rows hear if row u says whom u hears"
            )
    elif not is_symmetric:
        asked.append("undirected as asked, where the matrix is not symmetric")
    if is_symmetric:
        kept = tails <= heads
        tails, heads = tails[kept], heads[kept]
    ends = np.stack([tails, heads], axis=1)
    directed = options.directed if options.directed is False else not is_symmetric
    found = Found(
        [Node(name) for name in names], [], directed, said, asked, parallel="", ends=ends, is_doubtful=is_doubtful
    )
    # A symmetric matrix is the same graph whatever is asked of its direction.
    return graph_of(found, replace(options, directed=None, label_attribute=None))


def _matrix_of(graph: Digraph) -> npt.NDArray[np.uint8]:
    warn_of_lost_labels(graph, "an adjacency matrix")
    weights = np.zeros((graph.n, graph.n), dtype=np.uint8)
    weights[graph.in_indices, graph.heads] = 1
    return weights
