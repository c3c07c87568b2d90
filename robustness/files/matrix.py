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
from robustness.files.text import decode_utf8

__all__ = ["decode_csv", "decode_npy", "encode_csv", "encode_npy"]

_SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")


def decode_csv(data: bytes) -> Digraph:
    """Return the graph of a matrix of numbers, one row a line, separated by commas, semicolons or spaces."""
    rows: list[npt.NDArray[np.bool_]] = []
    for number, line in enumerate(decode_utf8(data).split("\n"), 1):
        if not line.strip():
            continue
        cells = _SEPARATOR.split(line.strip())
        if rows and len(cells) != len(rows[0]):
            raise UnreadableTopology(f"line {number}: has {len(cells)} columns, but the first row has {len(rows[0])}")
        rows.append(np.array([_is_arc(cell, number, column) for column, cell in enumerate(cells, 1)]))
    if not rows:
        raise UnreadableTopology("an adjacency matrix has at least one row, and here is none")
    if len(rows) != len(rows[0]):
        raise UnreadableTopology(f"an adjacency matrix is square, not {len(rows)} x {len(rows[0])}")
    return _graph_of(np.stack(rows))


def decode_npy(data: bytes) -> Digraph:
    """Return the graph of a NumPy array of numbers or truth values; pickled objects are never loaded."""
    shape, dtype, start = _npy_header(data)
    if dtype.hasobject or dtype.kind not in "biuf":
        raise UnreadableTopology(f"an adjacency matrix holds numbers or truth values, not {dtype}")
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


def _is_arc(cell: str, line: int, column: int) -> bool:
    try:
        value = float(cell)
    except ValueError:
        raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is not a number") from None
    if not math.isfinite(value):
        raise UnreadableTopology(f"line {line}, column {column}: {cell!r} is not a finite number")
    return value != 0


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


def _graph_of(pattern: npt.NDArray[np.bool_]) -> Digraph:
    tails, heads = np.nonzero(pattern)
    arcs = zip(tails.tolist(), heads.tolist(), strict=True)
    return Digraph(range(len(pattern)), arcs, directed=not np.array_equal(pattern, pattern.T))


def _matrix_of(graph: Digraph) -> npt.NDArray[np.uint8]:
    warn_of_lost_labels(graph, "an adjacency matrix")
    weights = np.zeros((graph.n, graph.n), dtype=np.uint8)
    weights[graph.in_indices, np.repeat(np.arange(graph.n), graph.in_degrees)] = 1
    return weights
