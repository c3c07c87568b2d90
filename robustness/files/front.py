"""Reading and writing topologies: the format is told by the suffix.

=========================  =======================================================================
suffix                     format
=========================  =======================================================================
``.json``                  node-link JSON with ``edges`` or ``links``; the default, keeps everything
``.graphml``, ``.gexf``    XML; labels become text
``.gml``                   GML; labels become text
``.edgelist``, ``.txt``    ``u v`` a line; labels become text, isolated nodes are lost
``.csv``, ``.npy``         adjacency matrix: row u, column v nonzero is the arc (u, v): v hears u
``.g6``, ``.s6``, ``.d6``  graph6, sparse6, digraph6, one graph a file; labels are ``0..n-1``
=========================  =======================================================================

Besides paths, :func:`read_topology` takes ``-`` (node-link JSON on standard input) and
``topohub:GROUP/NAME`` (707 real and reference networks; needs the extra ``topologies``). Whatever is wrong
with an input, the answer is one :class:`UnreadableTopology` of one line that names file and place.
An input of more than :data:`SIZE_LIMIT` bytes is refused before it is parsed.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidGraph, UnreadableTopology
from robustness.files import gml, graph6, matrix, node_link, table, topohub_names, xml_formats
from robustness.files.text import one_line
from robustness.files.writing import replace_file

__all__ = [
    "FORMATS",
    "SIZE_LIMIT",
    "Format",
    "decode_topology",
    "encode_topology",
    "read_topology",
    "write_topology",
]

#: The longest input that is read, in bytes.
SIZE_LIMIT = 256 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class Format:
    """How one format is read from bytes and written to bytes. ``decode`` raises errors without the file's name."""

    name: str
    decode: Callable[[bytes], Digraph]
    encode: Callable[[Digraph], bytes]


_EDGE_LIST = Format("edge list", table.decode_text, table.encode_text)

#: Every format by its suffix.
FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        ".json": Format("node-link JSON", node_link.decode, node_link.encode),
        ".graphml": Format("GraphML", xml_formats.decode_graphml, xml_formats.encode_graphml),
        ".gexf": Format("GEXF", xml_formats.decode_gexf, xml_formats.encode_gexf),
        ".gml": Format("GML", gml.decode, gml.encode),
        ".edgelist": _EDGE_LIST,
        ".txt": _EDGE_LIST,
        ".csv": Format("adjacency matrix", table.decode_csv, matrix.encode_csv),
        ".npy": Format("adjacency matrix", matrix.decode_npy, matrix.encode_npy),
        ".g6": Format("graph6", graph6.decode_graph6, graph6.encode_graph6),
        ".s6": Format("sparse6", graph6.decode_sparse6, graph6.encode_sparse6),
        ".d6": Format("digraph6", graph6.decode_digraph6, graph6.encode_digraph6),
    }
)


def read_topology(source: str | os.PathLike[str], stdin: BinaryIO | None = None) -> Digraph:
    """Return the graph of a file, of standard input or of a named network.

    Parameters
    ----------
    source : str or path
        A path whose suffix is in :data:`FORMATS`; ``-`` for node-link JSON on standard input; or
        ``topohub:GROUP/NAME``, for example ``topohub:topozoo/Abilene``.
    stdin : binary stream, optional
        What ``-`` reads; by default ``sys.stdin.buffer``.

    Raises
    ------
    UnreadableTopology
        When the source yields no graph; one line, with file and place.
    MissingExtra
        For ``topohub:`` when the package topohub is not installed.

    Warns
    -----
    GraphWarning
        When the format cannot hold every graph, or something in the file is dropped.

    Notes
    -----
    Linear in the size of the input (quadratic in n for matrices, which are).
    """
    source = os.fspath(source)
    if source == "-":
        if stdin is None and sys.stdin is None:  # as after `<&-` in a shell
            raise UnreadableTopology("standard input: is closed")
        return decode_topology(_read_limited(stdin or sys.stdin.buffer, "standard input"), ".json", "standard input")
    if source.startswith("topohub:"):
        return decode_topology(topohub_names.read(source), ".json", source)
    path = Path(source)
    _format_of(path.suffix, source)  # a wrong suffix is told before a wrong path: nothing has to be opened
    try:
        mode = os.stat(path).st_mode
        if stat.S_ISDIR(mode):
            raise UnreadableTopology(f"{one_line(source)}: is a directory, not a file")
        if not stat.S_ISREG(mode):  # opening a pipe that nobody writes to would wait for ever
            raise UnreadableTopology(f"{one_line(source)}: is a pipe or a device, not a file: pipe it into - instead")
        with open(path, "rb") as stream:
            data = _read_limited(stream, source)
    except (OSError, ValueError) as problem:
        if isinstance(problem, UnreadableTopology):
            raise
        reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise UnreadableTopology(f"{one_line(source)}: cannot be read: {one_line(reason)}") from None
    return decode_topology(data, path.suffix, source)


def decode_topology(data: bytes, suffix: str = ".json", name: str = "the data") -> Digraph:
    """Return the graph that ``data`` holds in the format of ``suffix``; errors call it ``name``."""
    form = _format_of(suffix, name)
    try:
        return form.decode(data)
    except (UnreadableTopology, InvalidGraph) as problem:
        raise UnreadableTopology(f"{one_line(name)}: {one_line(str(problem))}") from None
    except RecursionError:
        raise UnreadableTopology(f"{one_line(name)}: is nested too deeply for {form.name}") from None


def encode_topology(graph: GraphLike, suffix: str = ".json") -> bytes:
    """Return ``graph`` in the format of ``suffix``.

    Raises
    ------
    InvalidGraph
        When the format would turn it into another graph: two labels with one text, arcs in an undirected format.

    Warns
    -----
    GraphWarning
        When labels or isolated nodes are lost on the way.
    """
    return _format_of(suffix, suffix).encode(as_digraph(graph))


def write_topology(graph: GraphLike, path: str | os.PathLike[str]) -> None:
    """Write ``graph`` to ``path`` in the format of its suffix, whole or not at all.

    The bytes go to a new file in the same directory, which then takes the place of ``path``: readers never
    see half a graph, and a failure leaves the old file as it was.

    Raises
    ------
    InvalidGraph
        As in :func:`encode_topology`.
    UnreadableTopology
        For a suffix that names no format.
    OSError
        When the file cannot be written.

    >>> import networkx, tempfile, pathlib
    >>> place = pathlib.Path(tempfile.mkdtemp(), "square.json")
    >>> write_topology(networkx.cycle_graph(4), place)
    >>> read_topology(place)
    <Digraph undirected, 4 nodes, 8 arcs>
    """
    target = Path(path)
    replace_file(target, _format_of(target.suffix, str(target)).encode(as_digraph(graph)))


def _format_of(suffix: str, name: str) -> Format:
    try:
        return FORMATS[suffix.lower()]
    except KeyError:
        known = ", ".join(FORMATS)
        raise UnreadableTopology(
            f"{one_line(name) or 'no name'}: the suffix tells the format and is one of {known}, not {suffix!r}"
        ) from None


def _read_limited(stream: BinaryIO, name: str) -> bytes:
    data = stream.read(SIZE_LIMIT + 1)
    if len(data) > SIZE_LIMIT:
        raise UnreadableTopology(f"{one_line(name)}: is larger than {SIZE_LIMIT} bytes, the most that is read")
    return data
