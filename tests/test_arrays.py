"""Arrays and sparse matrices, in files of NumPy, SciPy and MATLAB, and in memory."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import NoReturn

import networkx as nx
import numpy as np
import pytest
import scipy.io
import scipy.sparse

import robustness as rb
from robustness import GraphWarning, UnreadableTopology
from robustness.files import decode_topology
from tests.test_formats import DIAMOND, LINKS, RING, is_same, read


class TestArrays:
    def test_of_memory(self) -> None:
        matrix = np.array([[0, 1], [0, 0]])
        with pytest.warns(GraphWarning, match="--rows hear") as caught:
            assert list(rb.from_adjacency(matrix).arcs()) == [(0, 1)]
        assert caught[0].filename == __file__
        assert list(rb.from_adjacency(scipy.sparse.csr_array(matrix), rows="hear").arcs()) == [(1, 0)]
        assert rb.from_adjacency([[0, 1], [1, 0]], labels=["x", "y"]).labels == ("x", "y")
        for bad, complaint in [
            (np.zeros((2, 3)), "square"),
            ([[0, 1], [1]], "square"),
            ([["a"]], "numbers"),
            ([[0, -1, 0]] * 3, "may be"),
        ]:
            with pytest.raises(rb.InvalidGraph, match=complaint):
                rb.from_adjacency(bad)
        with pytest.raises(rb.InvalidParameter, match="labels name all 2 nodes"):
            rb.from_adjacency(matrix, labels=["x"])

    def test_distances_are_not_taken_for_a_network_in_silence(self) -> None:
        """A table of distances has no 0 beside the diagonal; numbers that are all the same are a complete network."""
        whole = np.array([[0, 3, 4], [3, 0, 5], [4, 5, 0]])
        text = {".csv": ",", ".txt": " "}
        for numbers, warned in (
            (whole, True),
            (np.ones((3, 3)), False),
            (np.array([[0, 3, 0], [3, 0, 5], [0, 5, 0]]), False),
        ):
            files = {".npy": io.BytesIO(), **{suffix: io.BytesIO() for suffix in text}}
            for suffix, mark in text.items():
                np.savetxt(files[suffix], numbers, fmt="%.17g", delimiter=mark)
            np.save(files[".npy"], numbers.astype(np.uint8))
            for suffix, file in files.items():
                with warnings.catch_warnings(record=True) as caught:
                    warnings.simplefilter("always", GraphWarning)
                    graph = decode_topology(file.getvalue(), suffix)
                assert [
                    ("everybody is linked" in str(each.message)) for each in caught if "entry" in str(each.message)
                ] == [True] * warned, suffix
                assert graph.arc_count == np.count_nonzero(numbers - np.diag(np.diag(numbers)))
            for array in (numbers.astype(np.uint8), numbers.astype(float)):
                with warnings.catch_warnings(record=True) as caught:
                    warnings.simplefilter("always", GraphWarning)
                    rb.from_adjacency(array)
                assert any("everybody is linked" in str(each.message) for each in caught) == warned

    def test_other_things_in_memory(self) -> None:
        igraph = pytest.importorskip("igraph")
        graph = igraph.Graph(directed=True)
        graph.add_vertices(["a", "b", "c", "d"])
        graph.add_edges(list(RING.edges))
        assert is_same(rb.from_igraph(graph), RING)
        assert is_same(rb.from_edges(LINKS, directed=False), DIAMOND)
        assert is_same(rb.from_neighbours(nx.to_dict_of_lists(DIAMOND)), DIAMOND)
        assert is_same(rb.from_neighbours({"a": "b", "b": "c", "c": "d", "d": "a"}, directed=True), RING)
        with pytest.raises(rb.InvalidGraph, match="say directed=True or directed=False"):
            rb.from_neighbours({"a": ["b"], "b": []})
        with pytest.raises(rb.InvalidGraph, match="has no entry of its own"):
            rb.from_neighbours({"a": ["b"]})
        with pytest.raises(rb.InvalidGraph, match="from_adjacency takes a matrix, from_edges pairs"):
            rb.is_r_robust(np.zeros((2, 2)), 1)

    def test_what_crashes_scipy_is_unreadable(self, monkeypatch: pytest.MonkeyPatch) -> None:
        stream = io.BytesIO()
        scipy.io.savemat(stream, {"A": np.eye(3)})
        doubles = b"\x09\0\0\0\x48\0\0\0"
        assert stream.getvalue().count(doubles) == 1
        damaged = stream.getvalue().replace(doubles, b"\x0e\0\0\0\x48\0\0\0")  # numbers that are said to be a matrix
        with pytest.raises(UnreadableTopology, match="the MATLAB file cannot be read: SciPy's reader broke off"):
            read(damaged, ".mat")
        for indices, indptr in (([0, 1], [0, 1_000_000, 2]), ([0, 1_000_000], [0, 1, 2]), ([0, -5], [0, 1, 2])):
            stream = io.BytesIO()
            np.savez(stream, format=b"csr", shape=(2, 2), data=[1, 1], indices=indices, indptr=indptr)
            with pytest.raises(UnreadableTopology, match=r"contradicts itself|cannot be read"):
                read(stream.getvalue(), ".npz")
        # Where no Python can be started, SciPy reads in this process.
        monkeypatch.setattr("sys.executable", None)
        with pytest.raises(UnreadableTopology, match="the MATLAB file cannot be read"):
            read(b"MATLAB 5.0" + bytes(200), ".mat")

    def test_where_no_process_can_be_started_scipy_reads_in_this_one(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def refuse(*_: object, **__: object) -> NoReturn:
            raise PermissionError

        monkeypatch.setattr("subprocess.run", refuse)
        stream = io.BytesIO()
        scipy.io.savemat(stream, {"A": nx.to_numpy_array(nx.cycle_graph(5))})
        assert read(stream.getvalue(), ".mat").arc_count == 10

    def test_two_variables_of_one_name_are_two_graphs(self) -> None:
        stream = io.BytesIO()
        scipy.io.savemat(stream, {"A": np.eye(3)[::-1]})
        twice = stream.getvalue() + stream.getvalue()[128:]
        with pytest.raises(UnreadableTopology, match="two variables of the MATLAB file have one name: keep one"):
            read(twice, ".mat")

    def test_sparse_and_several(self, tmp_path: Path) -> None:
        stream = io.BytesIO()
        scipy.io.savemat(stream, {"A": np.eye(3), "B": np.eye(4)})
        with pytest.raises(UnreadableTopology, match="here are 2: A, B: keep one"):
            read(stream.getvalue(), ".mat")
        stream = io.BytesIO()
        scipy.io.savemat(stream, {"A": nx.to_numpy_array(nx.cycle_graph(5)), "n": 5})
        assert read(stream.getvalue(), ".mat").arc_count == 10
        laplacian = nx.laplacian_matrix(nx.cycle_graph(5)).astype(float)
        stream = io.BytesIO()
        scipy.sparse.save_npz(stream, scipy.sparse.coo_matrix(laplacian))
        assert read(stream.getvalue(), ".npz").arc_count == 10
        stream = io.BytesIO()
        np.savez(stream, A=nx.to_numpy_array(nx.cycle_graph(5)))
        assert read(stream.getvalue(), ".npz").arc_count == 10
