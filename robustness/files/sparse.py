"""Matrices in archives of SciPy and NumPy (.npz), and what is common to them and MATLAB's.

SciPy comes with the extra ``formats`` and is imported here only. Which way rows are read, and what an entry says, is
as in :mod:`robustness.files.matrix`.
"""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import MissingExtra, UnreadableTopology
from robustness.files.found import ReadingOptions
from robustness.files.matrix import graph_of_pattern, links_in
from robustness.files.matrix_market import CELL_LIMIT, NODE_LIMIT, graph_of_weights
from robustness.spelled import counted

__all__ = ["decode_npz", "graph_of_matrix", "is_sparse", "scipy_module", "the_square_one"]

#: An archive is not unpacked beyond this many bytes.
BYTE_LIMIT = 2**30


def _require_shape(shape: tuple[int, ...], *, is_sparse: bool) -> None:
    if len(shape) != 2 or shape[0] != shape[1]:
        raise UnreadableTopology(f"an adjacency matrix is square, not {' x '.join(map(str, shape)) or 'one number'}")
    if shape[0] > NODE_LIMIT or (not is_sparse and math.prod(shape) > CELL_LIMIT):
        raise UnreadableTopology(f"a matrix of {shape[0]} x {shape[1]} is larger than what is read")


def decode_npz(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of a .npz archive: a sparse matrix of SciPy, or the one square array in it."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(member.file_size for member in archive.infolist())
            names = {member.filename.removesuffix(".npy") for member in archive.infolist()}
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as problem:
        raise UnreadableTopology(f"is no .npz archive: {problem}") from None
    if size > BYTE_LIMIT:
        raise UnreadableTopology(f"unpacks to {counted(size, 'byte')}, more than {BYTE_LIMIT}, the most that is read")
    try:
        if {"format", "shape", "data"} <= names:
            return graph_of_matrix(scipy_module("scipy.sparse", "a sparse .npz").load_npz(io.BytesIO(data)), options)
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            return graph_of_matrix(the_square_one({name: arrays[name] for name in arrays.files}), options)
    except (UnreadableTopology, MissingExtra):
        raise
    except Exception as problem:  # noqa: BLE001 - NumPy and SciPy raise whatever their parsing runs into
        raise UnreadableTopology(f"the archive cannot be read: {problem}") from None


def the_square_one(matrices: Mapping[str, Any]) -> Any:
    """Return the one square matrix of numbers among these; of several, the one that is more than a number."""
    square = [
        name
        for name, matrix in matrices.items()
        if getattr(matrix, "ndim", 0) == 2 and matrix.shape[0] == matrix.shape[1] and _holds_numbers(matrix)
    ]
    large = [name for name in square if matrices[name].shape[0] > 1] or square
    if len(large) != 1:
        names = ", ".join(large or matrices) or "nothing"
        raise UnreadableTopology(
            f"one square matrix of numbers is the graph, and here are {len(large)}: {names}: keep one"
        )
    return matrices[large[0]]


def _holds_numbers(matrix: Any) -> bool:
    return getattr(matrix.dtype, "kind", "O") in "biuf"


def is_sparse(matrix: Any) -> bool:
    """Return whether this is a sparse matrix of SciPy, without importing SciPy."""
    return hasattr(matrix, "tocoo") and hasattr(matrix, "shape")


def graph_of_matrix(matrix: Any, options: ReadingOptions, labels: Any = None) -> Digraph:
    """Return the graph of a square matrix of numbers, an array or sparse."""
    _require_shape(tuple(matrix.shape), is_sparse=is_sparse(matrix))
    if not is_sparse(matrix):
        array = np.asarray(matrix)
        if array.dtype.kind not in "biuf":
            raise UnreadableTopology(f"an adjacency matrix holds numbers or truth values, not {array.dtype}")
        if array.dtype.kind == "b":
            return graph_of_pattern(array != 0, options, labels)
        pattern, notes = links_in(
            array.astype(np.float64), lambda row, column: f"row {row}, column {column}: {array[row, column]}"
        )
        return graph_of_pattern(pattern, options, labels, notes)
    if hasattr(matrix, "check_format"):  # SciPy converts what points outside the matrix, and crashes
        try:
            matrix.check_format(full_check=True)
        except ValueError as problem:
            raise UnreadableTopology(f"the sparse matrix contradicts itself: {problem}") from None
    entries = matrix.tocsr().tocoo()
    if entries.data.dtype.kind not in "biuf":
        raise UnreadableTopology(f"an adjacency matrix holds numbers or truth values, not {entries.data.dtype}")
    pairs = np.stack([entries.row, entries.col], axis=1).astype(np.int64)
    return graph_of_weights(pairs, entries.data.astype(np.float64), matrix.shape[0], options, labels, name=int)


def scipy_module(module: str, what: str) -> Any:
    """Return a module of SciPy."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError:
        raise MissingExtra(f"{what} needs SciPy: pip install 'graph-robustness[formats]'") from None
