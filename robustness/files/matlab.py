"""Matrices of MATLAB (.mat, versions 4 to 7), read by SciPy in a process of its own.

A damaged file can crash SciPy's reader, and with it the process it runs in. So it runs beside ours, and a crash is one
more thing that a file can be unreadable for.
"""

from __future__ import annotations

import io
import pickle
import subprocess
import sys
import warnings
from typing import Any

import numpy as np

from robustness.digraph import Digraph, GraphWarning
from robustness.errors import UnreadableTopology
from robustness.files.found import ReadingOptions
from robustness.files.sparse import graph_of_matrix, scipy_module, the_square_one

__all__ = ["decode_mat", "load"]

#: What the process does: it finds our packages where its parent does.
_CHILD = """
import pickle, sys
path, data = pickle.load(sys.stdin.buffer)
sys.path[:] = path
from robustness.files.matlab import load
sys.stdout.buffer.write(pickle.dumps(load(data)))
"""


def decode_mat(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the graph of the one square matrix in a MATLAB file of version 4 to 7."""
    if data[:10] == b"MATLAB 7.3" or data[1:4] == b"HDF":
        raise UnreadableTopology("is a MATLAB file of version 7.3: save it with save -v7")
    scipy_module("scipy", "MATLAB files")
    found, heard = _load_beside(data)
    for message in heard:
        if message.startswith("Duplicate variable name"):  # and the first would be lost
            raise UnreadableTopology("two variables of the MATLAB file have one name: keep one")
        warnings.warn(f"the MATLAB file: {message.splitlines()[0]}", GraphWarning, stacklevel=2)
    if isinstance(found, str):
        raise UnreadableTopology(f"the MATLAB file cannot be read: {found}")
    variables = {name: value for name, value in found.items() if not name.startswith("__")}
    problem_record = variables.get("Problem")
    if isinstance(problem_record, np.ndarray) and problem_record.dtype.names and "A" in problem_record.dtype.names:
        variables = {"Problem.A": problem_record["A"].flat[0]}  # as the SuiteSparse collection writes it
    return graph_of_matrix(the_square_one(variables), options)


def load(data: bytes) -> tuple[dict[str, Any] | str, list[str]]:
    """Return the variables of a file, or why there are none, and of what SciPy warns."""
    loadmat = scipy_module("scipy.io", "MATLAB files").loadmat
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            found = loadmat(io.BytesIO(data), squeeze_me=False, verify_compressed_data_integrity=True)
        except Exception as problem:  # noqa: BLE001 - SciPy raises whatever its parsing runs into
            found = str(problem) or type(problem).__name__
    return found, [str(each.message) for each in heard]


def _load_beside(data: bytes) -> tuple[dict[str, Any] | str, list[str]]:
    """Return what :func:`load` does, of a process that may crash."""
    if not sys.executable or getattr(sys, "frozen", False):  # no Python that could be started
        return load(data)
    try:
        process = subprocess.run(  # noqa: S603  # our own interpreter and program
            [sys.executable, "-I", "-c", _CHILD],
            input=pickle.dumps((sys.path, data)),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            check=False,
        )
    except OSError:  # a container that allows no other process
        return load(data)
    if process.returncode:
        return "SciPy's reader broke off: it is damaged, or larger than the memory", []
    said: tuple[dict[str, Any] | str, list[str]] = pickle.loads(process.stdout)  # noqa: S301  # said by our own process
    return said
