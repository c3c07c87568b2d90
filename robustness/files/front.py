"""Reading and writing topologies: the format is told by the suffix, or by name.

==================================  ========================================================================
suffix                              format
==================================  ========================================================================
``.json``, ``.graph``               node-link JSON, which keeps everything, and JSON of other programs
``.graphml``, ``.gexf``, ``.xml``   GraphML, GEXF and the XML of SNDlib; labels become text
``.gml``                            GML; labels become text
``.edgelist``, ``.txt``, ...        links ``u v``, lists of neighbours, or a matrix; labels become text
``.csv``, ``.tsv``                  a table of links or an adjacency matrix
``.adjlist``                        lists of neighbours
``.npy``, ``.npz``, ``.mat``        adjacency matrix of NumPy, SciPy or MATLAB
``.mtx``                            MatrixMarket
``.dot``, ``.gv``, ``.net``         Graphviz and Pajek; labels become text
``.g6``, ``.s6``, ``.d6``           graph6, sparse6, digraph6; ``FILE#3`` is the third graph of many
==================================  ========================================================================

Row u, column v of a matrix says that v hears u, unless ``rows="hear"``. ``.gz`` may follow any suffix. docs/formats.md
says for each format what is kept, what is lost and what is taken for granted. Besides paths, :func:`read_topology`
takes ``-`` (node-link JSON on standard input) and ``topohub:GROUP/NAME`` (707 real and reference networks; needs the
extra ``topologies``). Whatever is wrong with an input, the answer is one :class:`UnreadableTopology` of one line that
names file and place. An input of more than :data:`SIZE_LIMIT` bytes is refused before it is parsed.
"""

from __future__ import annotations

import functools
import gzip
import io
import os
import re
import stat
import sys
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import AmbiguousTopology, InvalidGraph, InvalidParameter, MissingTopology, UnreadableTopology
from robustness.files import (
    dot,
    gml,
    graph6,
    matlab,
    matrix,
    matrix_market,
    node_link,
    pajek,
    sparse,
    table,
    topohub_names,
    xml_formats,
)
from robustness.files.found import ReadingOptions
from robustness.files.text import one_line
from robustness.files.writing import replace_file

__all__ = [
    "FORMATS",
    "FORMAT_NAMES",
    "SIZE_LIMIT",
    "Format",
    "decode_topology",
    "encode_topology",
    "format_suffix",
    "names_of_graphs",
    "read_bytes",
    "read_topology",
    "read_with",
    "write_topology",
]

#: The longest input that is read, in bytes, packed or not.
SIZE_LIMIT = 256 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class Format:
    """How one format is read from bytes and written to bytes.

    Attributes
    ----------
    name : str
        As people call it.
    decode : callable
        From bytes and :class:`ReadingOptions`; it raises errors without the file's name.
    encode : callable or None
        To bytes; None where the format is only read.
    takes : frozenset of str
        The reading options that mean something in it, beside ``directed``.
    """

    name: str
    decode: Callable[[bytes, ReadingOptions], Digraph]
    encode: Callable[[Digraph], bytes] | None = None
    takes: frozenset[str] = frozenset()


_LABELLED = frozenset({"label_attribute"})
_ROWS = frozenset({"rows"})
_TEXT = frozenset({"rows", "columns", "skip_lines"})


def _table(name: str, kind: table.Kind, encode: Callable[[Digraph], bytes], *, in_text: bool = True) -> Format:
    return Format(name, functools.partial(table.decode_table, kind=kind, in_text=in_text), encode, _TEXT)


#: Every format by the name that ``--format`` takes.
FORMAT_NAMES: Mapping[str, Format] = MappingProxyType(
    {
        "json": Format("node-link JSON", node_link.decode, node_link.encode, _LABELLED),
        "graphml": Format("GraphML", xml_formats.decode_xml, xml_formats.encode_graphml, _LABELLED),
        "gexf": Format("GEXF", xml_formats.decode_xml, xml_formats.encode_gexf, _LABELLED),
        "xml": Format("XML", xml_formats.decode_xml, None, _LABELLED),
        "gml": Format("GML", gml.decode, gml.encode, _LABELLED),
        "edge-list": _table("edge list", "edge-list", table.encode_text),
        "adjacency-list": Format(
            "adjacency list", functools.partial(table.decode_table, kind="adjacency-list"), None, _TEXT
        ),
        "matrix": _table("adjacency matrix", "matrix", matrix.encode_csv),
        "text": _table("edge list", "table", table.encode_text),
        "csv": _table("adjacency matrix", "table", matrix.encode_csv, in_text=False),
        "npy": Format("adjacency matrix", matrix.decode_npy, matrix.encode_npy, _ROWS),
        "npz": Format("adjacency matrix", sparse.decode_npz, None, _ROWS),
        "mat": Format("MATLAB matrix", matlab.decode_mat, None, _ROWS),
        "matrix-market": Format("MatrixMarket", matrix_market.decode, matrix_market.encode, _ROWS),
        "dot": Format("DOT", dot.decode, dot.encode, _LABELLED),
        "pajek": Format("Pajek", pajek.decode, pajek.encode, _LABELLED),
        "graph6": Format("graph6", graph6.decode_graph6, graph6.encode_graph6),
        "sparse6": Format("sparse6", graph6.decode_sparse6, graph6.encode_sparse6),
        "digraph6": Format("digraph6", graph6.decode_digraph6, graph6.encode_digraph6),
    }
)

#: Every format by its suffix.
FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        suffix: FORMAT_NAMES[name]
        for name, suffixes in (
            ("json", ".json .graph"), ("graphml", ".graphml"), ("gexf", ".gexf"), ("xml", ".xml"), ("gml", ".gml"),
            ("text", ".edgelist .txt .edges .el .ncol .dat"), ("csv", ".csv .tsv"), ("adjacency-list", ".adjlist"),
            ("npy", ".npy"), ("npz", ".npz"), ("mat", ".mat"), ("matrix-market", ".mtx"), ("dot", ".dot .gv"),
            ("pajek", ".net .paj"), ("graph6", ".g6"), ("sparse6", ".s6"), ("digraph6", ".d6"),
        )
        for suffix in suffixes.split()
    }
)  # fmt: skip

#: Formats that may hold many graphs, one a line.
_MANY = (".g6", ".s6", ".d6")


def read_topology(
    source: str | os.PathLike[str],
    stdin: BinaryIO | None = None,
    *,
    format: str | None = None,  # noqa: A002 - the word that users know
    directed: bool | None = None,
    label_attribute: str | None = None,
    rows: Any = None,
    columns: Mapping[str, int | str] | None = None,
    skip_lines: int | None = None,
) -> Digraph:
    """Return the graph of a file, of standard input or of a named network; its ``read_as`` says how it was read.

    Parameters
    ----------
    source : str or path
        A path whose suffix is in :data:`FORMATS` (and may be followed by ``.gz``, or by ``#3`` for the third of many
        graph6 lines); ``-`` for node-link JSON on standard input; or ``topohub:GROUP/NAME``, for example
        ``topohub:topozoo/Abilene``.
    stdin : binary stream, optional
        What ``-`` reads; by default ``sys.stdin.buffer``.
    format : str, optional
        A name of :data:`FORMAT_NAMES`, which goes before the suffix.
    directed : bool, optional
        True: a link without a word of its own runs from its first end to its second. False: every link runs both
        ways. By default the file decides, and links of which it says nothing run both ways.
    label_attribute : str, optional
        The attribute that names the nodes; ``"id"`` for what the file itself tells them apart by. By default what a
        drawing shows, where every node shows something of its own.
    rows : "speak" or "hear", optional
        Of a matrix: row u says who hears u (the default), or whom u hears.
    columns : mapping, optional
        Of a table of links: ``{"source": 1, "target": 2}``, by number from 1 or by name.
    skip_lines : int, optional
        So many lines at the beginning of a text are no links: counts, names of columns.

    Raises
    ------
    UnreadableTopology
        When the source yields no graph, or two that differ; one line, with file, place and what decides. When there is
        no such file, it is a FileNotFoundError as well.
    MissingExtra
        For ``topohub:`` and for formats read by SciPy or pydot, when these are not installed.
    InvalidParameter
        For an option that means nothing in the format.

    Warns
    -----
    GraphWarning
        When the file can be read in another way than it was, with the text of ``.read_as``, which says how. Where there
        is one reading alone, ``.read_as`` says what became of labels, parallel links and self-loops, without a warning.

    See Also
    --------
    robustness.write_topology : the other way
    robustness.from_edges : pairs in memory
    robustness.from_adjacency : a matrix in memory

    Notes
    -----
    Linear in the size of the input (quadratic in n for matrices, which are).
    """
    return read_with(source, ReadingOptions(format, directed, label_attribute, rows, columns, skip_lines), stdin)


def read_with(source: str | os.PathLike[str], options: ReadingOptions, stdin: BinaryIO | None = None) -> Digraph:
    """Return what :func:`read_topology` returns, with the options in one."""
    source = os.fspath(source)
    if source == "-":
        return decode_topology(read_bytes(source, stdin), ".json", "standard input", options=options)
    if source.startswith("topohub:"):
        return decode_topology(topohub_names.read(source), ".json", source, options=options)
    path, part = _path_and_part(source)
    if options.format is None:
        _require_known_suffix(path, source)
    data = read_bytes(path)
    if part is not None:
        lines = graph6.lines_of(data)
        if not 1 <= part <= len(lines):
            raise UnreadableTopology(
                f"{one_line(source)}: the file holds graphs 1..{len(lines)}, and #{part} was asked for"
            )
        data = lines[part - 1]
    return decode_topology(data, format_suffix(path), source, options=options)


def _require_known_suffix(path: str, source: str) -> None:
    """Refuse a file of another suffix before it is read, and a folder with a word about who reads one."""
    if os.path.isdir(path):
        raise UnreadableTopology(
            f"{one_line(source)}: is a directory, not a file; joint, tolerance --tau and simulate --over-time read one "
            "as a network over time, survey and report as many networks"
        )
    if os.path.exists(path):  # of what is not there, its suffix is not the news
        _format_of(format_suffix(path), source)


def names_of_graphs(source: str | os.PathLike[str]) -> list[str]:
    """Return the names of all graphs in a file: its own, or ``FILE#1``, ``FILE#2``, ... for many graph6 lines."""
    path = os.fspath(source)
    if format_suffix(path) not in _MANY or not os.path.isfile(path):
        return [path]
    try:
        count = len(graph6.lines_of(read_bytes(path)))
    except UnreadableTopology:  # whoever reads the graph itself is told why
        return [path]
    return [path] if count < 2 else [f"{path}#{k}" for k in range(1, count + 1)]


def format_suffix(path: str) -> str:
    """Return the suffix that tells the format, in lower case and without ``.gz``."""
    return Path(path.lower().removesuffix(".gz")).suffix


def read_bytes(source: str, stdin: BinaryIO | None = None) -> bytes:
    """Return the bytes of a regular file, or of standard input for ``-``, unpacked when they are packed with gzip.

    Raises
    ------
    UnreadableTopology
        Naming the source; when there is no such file, a FileNotFoundError as well.
    """
    if source == "-":
        if stdin is None and sys.stdin is None:  # as after `<&-` in a shell
            raise UnreadableTopology("standard input: is closed")
        return _not_empty(
            _unpacked(_read_limited(stdin or sys.stdin.buffer, "standard input"), "standard input"), source
        )
    try:
        mode = os.stat(source).st_mode
        if stat.S_ISDIR(mode):
            raise UnreadableTopology(f"{one_line(source)}: is a directory, not a file")
        if not stat.S_ISREG(mode):  # opening a pipe that nobody writes to would wait for ever
            raise UnreadableTopology(f"{one_line(source)}: is a pipe or a device, not a file: pipe it into - instead")
        with open(source, "rb") as stream:
            data = _read_limited(stream, source)
    except FileNotFoundError as problem:
        raise MissingTopology(
            f"{one_line(source) or 'no name'}: cannot be read: {problem.strerror}{_meant(source)}"
        ) from None
    except (OSError, ValueError) as problem:
        if isinstance(problem, UnreadableTopology):
            raise
        reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise UnreadableTopology(f"{one_line(source)}: cannot be read: {one_line(reason)}") from None
    return _not_empty(_unpacked(data, source) if source.lower().endswith(".gz") else data, source)


def _not_empty(data: bytes, source: str) -> bytes:
    """Return what a source holds; nothing at all is no network in any format, and no parser says so as plainly."""
    if not data or data.isspace():
        name = "standard input: nothing came" if source == "-" else f"{one_line(source)}: is empty"
        raise UnreadableTopology(name)
    return data


def _meant(path: str) -> str:
    """Return a question after the file beside ``path`` whose name is most like its own, or nothing."""
    folder, name = os.path.split(path)
    try:
        beside = sorted(entry.name for entry in islice(os.scandir(folder or "."), 1000) if entry.is_file())
    except OSError:
        return ""
    close = get_close_matches(name, beside, 1, 0.75)
    return f": did you mean {one_line(os.path.join(folder, close[0]))}?" if close else ""


def decode_topology(
    data: bytes, suffix: str = ".json", name: str = "the data", *, options: ReadingOptions | None = None
) -> Digraph:
    """Return the graph that ``data`` holds in the format of ``suffix``, or of ``options``; errors call it ``name``."""
    options = options or ReadingOptions()
    form = _format_of(suffix, name) if options.format is None else _format_named(options.format)
    for option in ("label_attribute", "rows", "columns", "skip_lines"):
        if getattr(options, option) is not None and option not in form.takes:
            raise InvalidParameter(
                f"{option} means nothing in {form.name}, the format of {one_line(name)}: leave it out"
            )
    try:
        return form.decode(data, options)
    except AmbiguousTopology as problem:
        raise AmbiguousTopology(f"{one_line(name)}: {one_line(str(problem))}") from None
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
    UnreadableTopology
        For a suffix that names no format, or one that is only read.

    Warns
    -----
    GraphWarning
        When labels or isolated nodes are lost on the way.
    """
    return _encoder(suffix, suffix)(as_digraph(graph))


def write_topology(graph: GraphLike, path: str | os.PathLike[str]) -> None:
    """Write ``graph`` to ``path`` in the format of its suffix, whole or not at all.

    The bytes go to a new file in the same directory, which then takes the place of ``path``: readers never
    see half a graph, and a failure leaves the old file as it was. A path that ends in ``.gz`` is packed.

    Raises
    ------
    InvalidGraph
        As in :func:`encode_topology`.
    UnreadableTopology
        For a suffix that names no format, or one that is only read.
    OSError
        When the file cannot be written.

    See Also
    --------
    robustness.read_topology : the other way

    >>> import networkx, tempfile, pathlib
    >>> place = pathlib.Path(tempfile.mkdtemp(), "square.json")
    >>> write_topology(networkx.cycle_graph(4), place)
    >>> read_topology(place)
    <Digraph: undirected, 4 nodes, 8 arcs>
    """
    target = os.fspath(path)
    data = _encoder(format_suffix(target), target)(as_digraph(graph))
    replace_file(target, gzip.compress(data, mtime=0) if target.lower().endswith(".gz") else data)


def require_written_format(path: str | os.PathLike[str]) -> None:
    """Guarantees that the suffix of a path names a format that :func:`write_topology` writes, before any work."""
    target = os.fspath(path)
    _encoder(format_suffix(target), target)


def _encoder(suffix: str, name: str) -> Callable[[Digraph], bytes]:
    form = _format_of(suffix, name, otherwise="")
    if form.encode is None:
        raise UnreadableTopology(f"{one_line(name)}: {form.name} is read and not written: write .json instead")
    return form.encode


def _format_of(suffix: str, name: str, otherwise: str = "; --format tells it otherwise") -> Format:
    try:
        return FORMATS[suffix.lower()]
    except KeyError:
        known = ", ".join(FORMATS)
        raise UnreadableTopology(
            f"{one_line(name) or 'no name'}: the suffix tells the format and is one of {known}, "
            f"not {suffix!r}{otherwise}"
        ) from None


def _format_named(name: str) -> Format:
    if name not in FORMAT_NAMES:
        raise InvalidParameter(f"a format is one of {', '.join(FORMAT_NAMES)}, not {name!r}")
    return FORMAT_NAMES[name]


def _path_and_part(source: str) -> tuple[str, int | None]:
    """Return the path and, of ``FILE.g6#3``, the number of the graph; a file of the whole name goes first."""
    match = re.fullmatch(r"(.+)#(\d{1,9})", source, re.DOTALL)
    if match is None or format_suffix(match[1]) not in _MANY or os.path.exists(source):
        return source, None
    return match[1], int(match[2])


def _read_limited(stream: BinaryIO, name: str) -> bytes:
    data = stream.read(SIZE_LIMIT + 1)
    if len(data) > SIZE_LIMIT:
        raise UnreadableTopology(f"{one_line(name)}: is larger than {SIZE_LIMIT} bytes, the most that is read")
    return data


def _unpacked(data: bytes, name: str) -> bytes:
    """Return what gzip packed, or the data themselves where it did not; never more than is read."""
    if not data.startswith(b"\x1f\x8b"):
        return data
    try:
        with gzip.open(io.BytesIO(data)) as stream:
            return _read_limited(stream, name)  # type: ignore[arg-type]  # a stream of bytes for reading
    except (OSError, EOFError, zlib.error) as problem:
        raise UnreadableTopology(f"{one_line(name)}: cannot be unpacked: {one_line(str(problem))}") from None
