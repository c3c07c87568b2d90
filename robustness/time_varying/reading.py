"""Reading time-varying graphs: a directory of files, one JSON or JSON Lines document, or a contact trace.

========================  ============================================================================
source                    holds
========================  ============================================================================
a directory               one topology file a step, in any format of :mod:`robustness.files`, in the order
                          of the names with numbers by value (``step9.json`` before ``step10.json``)
``.json``, ``-``          ``{"nodes": [label, ...], "directed": true, "period": p or null, "steps": [...]}``; a step
                          is a list of arcs ``[u, v]`` or node-link JSON; a bare list is a list of steps
``.jsonl``, ``.ndjson``   a step a line; the first line may be the object above without ``steps``
``.csv``, ``.txt``, ...   contacts ``time,source,target`` (target hears source), put into bins of ``step`` time
========================  ============================================================================

A contact trace reads every label as text, as edge lists do. Bins count from the earliest contact; one without
contacts is a step without arcs. The node set is every label that occurs. Whatever is wrong with an input, the
answer is one :class:`UnreadableTopology` of one line that names file and place.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Hashable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, InvalidParameter, UnreadableTopology
from robustness.files import FORMATS, ReadingOptions, decode_topology
from robustness.files.front import format_suffix, read_bytes, read_with
from robustness.files.json_text import parse_json, plain_label
from robustness.files.text import decode_utf8, one_line
from robustness.natural_order import natural_key
from robustness.time_varying.contacts import bin_length, decode_contacts
from robustness.time_varying.sequence import TimeVaryingGraph

__all__ = ["CONTACT_SUFFIXES", "encode_sequence", "read_sequence"]

#: Files with these suffixes are contact traces.
CONTACT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".edges", ".contacts", ".log")

_StepName = Callable[[int], str]


def read_sequence(
    source: str | os.PathLike[str],
    *,
    period: int | None = None,
    step: float | str | None = None,
    both_ways: bool = False,
    stdin: BinaryIO | None = None,
    reading: ReadingOptions | None = None,
) -> TimeVaryingGraph:
    """Return the time-varying graph that a path, or ``-`` for JSON on standard input, holds.

    Parameters
    ----------
    source : str or path
        See the table above.
    period : int, optional
        How many of the last steps repeat for ever; it goes before the ``period`` in a JSON document.
    step : number or decimal text, optional
        For a contact trace: the length of a bin in units of its times, 1 unless given. Bins are exact: text and
        decimal fractions are not rounded.
    both_ways : bool
        For a contact trace: a contact is both arcs.
    stdin : binary stream, optional
        What ``-`` reads; by default ``sys.stdin.buffer``.
    reading : ReadingOptions, optional
        How files are to be read, as for :func:`robustness.read_topology`; of a contact trace the columns, for example
        ``ReadingOptions(columns={"time": 3, "source": 1, "target": 2})``.

    Raises
    ------
    UnreadableTopology
        When the source yields no time-varying graph; one line, with file and place (line, step).
    InvalidParameter
        For a period, a step or a flag that does not fit the source.
    """
    source = os.fspath(source)
    name = "standard input" if source == "-" else source
    suffix = ".json" if source == "-" else format_suffix(source)
    is_directory = source != "-" and os.path.isdir(source)
    reading = reading or ReadingOptions()
    if (step is not None or both_ways) and (is_directory or suffix not in CONTACT_SUFFIXES):
        raise InvalidParameter(f"step and both_ways go with a contact trace (.csv), not with {one_line(name)}")
    if not is_directory and suffix not in CONTACT_SUFFIXES and reading != ReadingOptions():
        raise InvalidParameter(
            f"the way to read a file goes with contact traces and topology files, not {one_line(name)}"
        )
    try:
        if is_directory:
            return _from_directory(Path(source), period, reading)
        if suffix in CONTACT_SUFFIXES:
            data = read_bytes(source, stdin)
            return decode_contacts(data, bin_length(step), period, both_ways=both_ways, reading=reading)
        match suffix:
            case ".json":
                return _from_json(read_bytes(source, stdin), period)
            case ".jsonl" | ".ndjson":
                return _from_json_lines(read_bytes(source, stdin), period)
        raise UnreadableTopology(
            f"a sequence is a directory or a .json, .jsonl, .ndjson or contact file ({', '.join(CONTACT_SUFFIXES)}), "
            "not "
            f"{suffix!r}"
        )
    except (UnreadableTopology, InvalidGraph) as problem:
        if str(problem).startswith(f"{one_line(name)}: "):
            raise
        raise UnreadableTopology(f"{one_line(name)}: {one_line(str(problem))}") from None
    except RecursionError:
        raise UnreadableTopology(f"{one_line(name)}: is nested too deeply") from None


def encode_sequence(sequence: TimeVaryingGraph) -> bytes:
    """Return ``sequence`` as the JSON document that :func:`read_sequence` reads, one step a line."""
    labels = sequence.labels
    head = json.dumps({"directed": True, "period": sequence.period, "nodes": labels})[:-1]
    steps = []
    for k in range(len(sequence)):
        steps.append(json.dumps([[labels[u], labels[v]] for u, v in sequence.graph_at(k).arcs()]))
    body = ",\n".join(steps)
    return f'{head}, "steps": [\n{body}\n]}}\n'.encode("ascii")


def _from_directory(path: Path, period: int | None, reading: ReadingOptions) -> TimeVaryingGraph:
    """Return the sequence of the files of a directory; hidden ones are skipped, others must be topologies."""
    try:
        entries = (entry for entry in path.iterdir() if not entry.name.startswith("."))
        files = sorted(entries, key=lambda entry: natural_key(entry.name))
    except OSError as problem:
        raise UnreadableTopology(f"cannot be read: {problem.strerror}") from None
    if not files:
        raise UnreadableTopology("a directory of steps holds at least one topology file, and here is none")
    for file in files:
        if reading.format is None and format_suffix(file.name) not in FORMATS:
            raise UnreadableTopology(
                f"{file.name}: a step is a topology file ({', '.join(FORMATS)}): move it elsewhere"
            )
    graphs = (read_with(file, reading) for file in files)
    return TimeVaryingGraph(graphs, period, step_name=lambda k: f"step {k} ({files[k].name})")


def _from_json(data: bytes, period: int | None) -> TimeVaryingGraph:
    document = _parse(decode_utf8(data), "")
    if isinstance(document, list):
        document = {"steps": document}
    if not isinstance(document, dict):
        raise UnreadableTopology("a sequence in JSON is an object with 'steps', or a list of steps")
    keys = [key for key in ("steps", "graphs") if key in document]
    if len(keys) != 1 or not isinstance(document[keys[0]], list):
        raise UnreadableTopology("a sequence in JSON needs one list 'steps'")
    return _assemble(document, document[keys[0]], period, "step {}".format)


def _from_json_lines(data: bytes, period: int | None) -> TimeVaryingGraph:
    rows = []
    for number, line in enumerate(decode_utf8(data).split("\n"), 1):
        if line.strip():
            rows.append((number, _parse(line, f"line {number}: ")))
    header: dict[str, Any] = {}
    if rows and isinstance(rows[0][1], dict) and not {"edges", "links"} & rows[0][1].keys():
        header = rows.pop(0)[1]
    return _assemble(header, [row for _, row in rows], period, lambda k: f"step {k} (line {rows[k][0]})")


def _assemble(header: dict[str, Any], steps: list[Any], period: int | None, step_name: _StepName) -> TimeVaryingGraph:
    """Return the sequence of steps, each a list of arcs or node-link JSON, under what the header says for all."""
    if not steps:
        raise UnreadableTopology("a sequence has at least one step, and here is none")
    if period is None:
        period = header.get("period")
        if period is not None and (type(period) is not int or not 1 <= period <= len(steps)):
            raise UnreadableTopology(f"'period' is an integer in 1..number of steps = 1..{len(steps)}, or null")
    directed = header.get("directed", True)
    if type(directed) is not bool:
        raise UnreadableTopology("'directed' is true or false")
    nodes = _nodes(header["nodes"]) if "nodes" in header else None
    if all(isinstance(step, list) for step in steps):
        if nodes is None:
            raise UnreadableTopology("steps that are lists of arcs need 'nodes', the list of all labels")
        arcs = (_arcs(step, step_name(k)) for k, step in enumerate(steps))
        return TimeVaryingGraph.from_arcs(nodes, arcs, period, directed=directed, step_name=step_name)
    return TimeVaryingGraph(_node_link_graphs(header, steps, step_name), period, step_name=step_name)


def _node_link_graphs(header: dict[str, Any], steps: list[Any], step_name: _StepName) -> Iterator[Digraph]:
    shared = {key: header[key] for key in ("nodes", "directed") if key in header}
    for k, step in enumerate(steps):
        if not isinstance(step, dict):
            raise UnreadableTopology(
                f"{step_name(k)}: is node-link JSON like the other steps, or all are lists of arcs"
            )
        yield decode_topology(json.dumps({**shared, **step}).encode("ascii"), ".json", step_name(k))


def _nodes(value: Any) -> list[Hashable]:
    if not isinstance(value, list):
        raise UnreadableTopology("'nodes' is a list of labels")
    return [
        plain_label(item["id"] if isinstance(item, dict) and "id" in item else item, "'nodes': a label")
        for item in value
    ]


def _arcs(step: list[Any], name: str) -> list[tuple[Hashable, Hashable]]:
    for place, arc in enumerate(step):
        if not isinstance(arc, list) or len(arc) != 2:
            raise UnreadableTopology(f"{name}: arc {place}: is a list of two labels [u, v]: v hears u")
    return [(plain_label(u, f"{name}: a label"), plain_label(v, f"{name}: a label")) for u, v in step]


def _parse(text: str, place: str) -> Any:
    """Return what JSON text holds; ``place`` goes before what is said about an error."""
    try:
        return parse_json(text)
    except UnreadableTopology as problem:
        # A document that is one line of a file is counted as line 1; ``place`` says which line of the file it is.
        raise UnreadableTopology(place + str(problem).removeprefix("line 1, " if place else "")) from None
