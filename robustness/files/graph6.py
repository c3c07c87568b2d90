"""graph6, sparse6 and digraph6 (McKay): one graph a line, nodes ``0..n-1``; networkx reads sparse6 and writes both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files.found import Found, Node, ReadingOptions, graph_of
from robustness.files.text import warn_lossy
from robustness.spelled import counted

__all__ = [
    "NODE_LIMIT",
    "decode_digraph6",
    "decode_graph6",
    "decode_sparse6",
    "encode_digraph6",
    "encode_graph6",
    "encode_sparse6",
    "lines_of",
    "warn_of_lost_labels",
]

#: The most nodes that are read: nine bytes of sparse6 can announce 2**36.
NODE_LIMIT = 1_000_000

#: The most pairs of nodes that are read from formats that have a bit for each.
BIT_LIMIT = 400_000_000

_Ends = npt.NDArray[np.int64]


def decode_graph6(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the undirected graph of a graph6 line: the upper triangle of its matrix as bits, column by column."""
    return _decode(data, options, b">>graph6<<", b"", _ends_of_graph6)


def decode_sparse6(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the undirected graph of a sparse6 line."""
    return _decode(data, options, b">>sparse6<<", b":", _ends_of_sparse6)


def decode_digraph6(data: bytes, options: ReadingOptions) -> Digraph:
    """Return the digraph of a digraph6 line."""
    return _decode(data, options, b">>digraph6<<", b"&", _ends_of_digraph6)


def lines_of(data: bytes) -> list[bytes]:
    """Return the graphs of a file, a line each."""
    return [line.strip() for line in data.split(b"\n") if line.strip() and not line.strip().endswith(b"6<<")]


def encode_graph6(graph: Digraph) -> bytes:
    """Return an undirected ``graph`` as a graph6 line."""
    import networkx as nx

    return bytes(nx.to_graph6_bytes(_undirected(graph, "graph6"), header=False))


def encode_sparse6(graph: Digraph) -> bytes:
    """Return an undirected ``graph`` as a sparse6 line."""
    import networkx as nx

    return bytes(nx.to_sparse6_bytes(_undirected(graph, "sparse6"), header=False))


def encode_digraph6(graph: Digraph) -> bytes:
    """Return ``graph`` as a digraph6 line: ``&``, n, and the rows of the adjacency matrix as bits."""
    warn_of_lost_labels(graph, "digraph6")
    bits = np.zeros(-(-graph.n * graph.n // 6) * 6, dtype=np.int64)
    bits[graph.in_indices.astype(np.int64) * graph.n + graph.heads] = 1
    body = bits.reshape(-1, 6) @ np.array([32, 16, 8, 4, 2, 1]) + 63
    return b"&" + _encode_size(graph.n) + bytes(body.astype(np.uint8)) + b"\n"


def warn_of_lost_labels(graph: Digraph, form: str) -> None:
    """Warn when the labels are not ``0..n-1``, the only ones that ``form`` knows."""
    if graph.labels != tuple(range(graph.n)):
        warn_lossy(f"{form} replaces the labels by 0..{graph.n - 1} in their canonical order")


def _decode(
    data: bytes, options: ReadingOptions, header: bytes, mark: bytes, parse: Callable[[bytes, int], _Ends]
) -> Digraph:
    lines = data.split(b"\n")
    number, line = next(((i, line.strip()) for i, line in enumerate(lines, 1) if line.strip()), (1, b""))
    others = sum(bool(other.strip()) for other in lines[number:])
    if others:
        raise UnreadableTopology(
            f"line {number + 1}: a second graph follows: one of the {others + 1} is meant, for example FILE#1, the "
            "first"
        )
    line = line.removeprefix(header)
    if not line.startswith(mark) or (not mark and line[:1] in (b":", b"&")):
        raise UnreadableTopology(f"line {number}: the graph does not start as {header.decode().strip('<>')} does")
    for column, byte in enumerate(line[len(mark) :], 1 + len(mark)):
        if not 63 <= byte <= 126:
            raise UnreadableTopology(f"line {number}, column {column}: byte {byte:#04x} is not in '?' .. '~'")
    size, length = _decode_size(line[len(mark) :])
    if size > NODE_LIMIT:
        raise UnreadableTopology(f"line {number}: announces {counted(size, 'node')}, and at most {NODE_LIMIT} are read")
    ends = parse(line if mark == b":" else line[len(mark) + length :], size)
    found = Found([Node(k) for k in range(size)], [], mark == b"&", [], parallel="", ends=ends)
    return graph_of(found, options)


def _decode_size(line: bytes) -> tuple[int, int]:
    """Return n and the number of bytes that tell it: 1, 4 or 8 of six bits each, offset by 63."""
    length = 1 if line[:1] != b"~" else 4 if line[1:2] != b"~" else 8
    if len(line) < length:
        raise UnreadableTopology("the graph ends before its number of nodes is told")
    digits = line[{1: 0, 4: 1, 8: 2}[length] : length]
    size = 0
    for digit in digits:
        size = size << 6 | digit - 63
    return size, length


def _encode_size(n: int) -> bytes:
    if n <= 62:
        return bytes([n + 63])
    marks, digits = (b"~", 3) if n <= 258047 else (b"~~", 6)
    return marks + bytes((n >> 6 * place & 63) + 63 for place in reversed(range(digits)))


def _bits(body: bytes, count: int, n: int) -> npt.NDArray[np.uint8]:
    """Return ``count`` bits, six a byte, the padding checked."""
    if count > BIT_LIMIT:
        raise UnreadableTopology(
            f"{counted(n, 'node')} have {counted(count, 'pair')}, and at most {BIT_LIMIT} are read: write .json"
        )
    if len(body) != -(-count // 6):
        raise UnreadableTopology(
            f"{counted(n, 'node')} need {counted(-(-count // 6), 'byte')} of arcs, and {len(body)} are there"
        )
    bits = np.unpackbits((np.frombuffer(body, dtype=np.uint8) - 63).reshape(-1, 1), axis=1)[:, 2:].reshape(-1)
    if bits[count:].any():
        raise UnreadableTopology("the padding after the last arc is not zero")
    return bits[:count]


def _ends_of_digraph6(body: bytes, n: int) -> _Ends:
    return np.argwhere(_bits(body, n * n, n).reshape(n, n)).astype(np.int64)


def _ends_of_graph6(body: bytes, n: int) -> _Ends:
    places = np.flatnonzero(_bits(body, n * (n - 1) // 2, n))
    starts = np.arange(n, dtype=np.int64) * (np.arange(n, dtype=np.int64) - 1) // 2  # of every column
    columns = np.searchsorted(starts, places, side="right") - 1
    return np.stack([places - starts[columns], columns], axis=1).astype(np.int64)


def _ends_of_sparse6(line: bytes, n: int) -> _Ends:
    import networkx as nx

    try:
        graph = nx.from_sparse6_bytes(line)
    except Exception as problem:  # noqa: BLE001 - networkx raises whatever its parsing runs into
        raise UnreadableTopology(str(problem) or type(problem).__name__) from None
    return np.array(list(graph.edges()), dtype=np.int64).reshape(-1, 2)


def _undirected(graph: Digraph, form: str) -> Any:
    import networkx as nx

    if not graph.is_symmetric:
        raise InvalidGraph(f"{form} holds undirected graphs only, and an arc here has no reverse: write .d6 or .json")
    warn_of_lost_labels(graph, form)
    plain: Any = nx.Graph()
    plain.add_nodes_from(range(graph.n))
    plain.add_edges_from((u, v) for u, v in graph.arcs() if u < v)
    return plain
