"""Contact traces: who met whom when, put into bins of equal length; each bin is a step.

Rows of a table in any form that :mod:`robustness.files.rows` knows: a time and two nodes, in columns that a first line
or a comment above it names, or that ``columns`` says, or in the order time, source, target where nothing else can be
meant. Instead of a time there may be a ``start`` and an ``end``: the contact is there from the one until before the
other. The connection log of the ONE simulator (``TIME CONN a b up``) is read as well.

Times are decimal numbers and are binned exactly: with bins of 0.1, time 0.3 is in bin 3, which floating-point division
misses. The target of a contact hears its source. A contact with ``-1`` is with nobody, as collections write it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from itertools import pairwise
from typing import NoReturn

from robustness.errors import InvalidParameter, UnreadableTopology
from robustness.files.edge_list import columns_of
from robustness.files.found import COLUMN_NAMES, ReadingOptions
from robustness.files.rows import Rows, content_of, is_number, rows_of, split_lines
from robustness.files.text import warn_lossy
from robustness.spelled import counted
from robustness.time_varying.sequence import TimeVaryingGraph

__all__ = ["STEP_LIMIT", "bin_length", "decode_contacts"]

#: The most steps that a contact trace is cut into, and the most arcs in all of them.
STEP_LIMIT = 1_000_000
ARC_LIMIT = 20_000_000

#: Times are smaller than 10 to this power, and have at most as many decimals.
_EXPONENT_LIMIT = 30

#: What collections write for "met nobody" and "met somebody unknown".
_NOBODY = ("-1", "-2")


@dataclass(frozen=True, slots=True)
class _Contact:
    """A contact from ``start`` until before ``end``; at one moment where both are the same."""

    start: Fraction
    end: Fraction
    source: str
    target: str


def decode_contacts(
    data: bytes,
    step: Fraction,
    period: int | None = None,
    *,
    both_ways: bool = False,
    reading: ReadingOptions | None = None,
) -> TimeVaryingGraph:
    """Return the sequence of the bins of a contact trace; bin 0 starts at the earliest time.

    Raises
    ------
    UnreadableTopology
        For bytes that are no contact trace, with the line; for columns that may be read in two ways; or when the bins
        would be more than :data:`STEP_LIMIT`.
    """
    reading = reading or ReadingOptions()
    content = content_of(data, reading.skip_lines)
    notes: list[str] = []
    contacts = _connection_log([(n, text.split()) for n, text in content.lines]) if reading.columns is None else None
    if contacts is not None:
        both_ways = both_ways or reading.directed is not True
        notes.append("a connection log, whose connections run both ways")
    else:
        filled = [(number, text) for number, text in content.lines if text.strip(" ,;\t")]
        contacts = _table(rows_of(replace(content, lines=filled)), reading, notes) if filled else []
    is_doubtful = not both_ways and reading.directed is None and content.is_directed is None
    both_ways = both_ways or reading.directed is False
    if content.is_directed is not None and reading.directed is None:
        both_ways = both_ways or not content.is_directed
    if not contacts:
        raise UnreadableTopology("a contact trace holds at least one contact time,source,target, and here is none")
    met = [contact for contact in contacts if contact.source not in _NOBODY and contact.target not in _NOBODY]
    if len(met) < len(contacts):
        notes.append(
            f"{counted(len(contacts) - len(met), 'row with -1 is a contact', 'rows with -1 are contacts')} with nobody"
        )
    nodes = dict.fromkeys(end for contact in contacts for end in (contact.source, contact.target) if end not in _NOBODY)
    steps = _steps(contacts, met, step)
    sequence = TimeVaryingGraph.from_arcs(nodes, steps, period, directed=not both_ways)
    way = (
        "a contact is both arcs" if both_ways else "the target of a contact hears its source, --undirected if both hear"
    )
    size = f"{counted(len(met), 'contact')} of {counted(len(nodes), 'node')} in {counted(len(steps), 'step')}"
    sequence.read_as = "; ".join([size, way, *notes])
    if is_doubtful:
        warn_lossy(f"read as: {sequence.read_as}")
    return sequence


def _steps(contacts: Sequence[_Contact], met: Sequence[_Contact], step: Fraction) -> list[list[tuple[str, str]]]:
    """Return the pairs that are in contact in each bin."""
    first, last = min(contact.start for contact in contacts), max(contact.start for contact in contacts)
    ends = [-((first - contact.end) // step) for contact in met if contact.end > contact.start]
    count = max([(last - first) // step + 1, *ends])
    if count > STEP_LIMIT:
        raise UnreadableTopology(f"bins of {float(step):g} make more than {STEP_LIMIT} steps: choose longer ones")
    steps: list[list[tuple[str, str]]] = [[] for _ in range(count)]
    arcs = 0
    for contact in met:
        begin = (contact.start - first) // step
        end = max(begin + 1, -((first - contact.end) // step))
        arcs += end - begin
        if arcs > ARC_LIMIT:
            raise UnreadableTopology(
                f"contacts fill more than {ARC_LIMIT} places in bins of {float(step):g}: choose longer"
            )
        for k in range(begin, end):
            steps[k].append((contact.source, contact.target))
    return steps


def bin_length(step: float | str | None) -> Fraction:
    """Return the length of a bin as an exact number: 1 for None, the decimal value of what was written otherwise."""
    value = Fraction(1) if step is None else _number(str(step))
    if value is None or value <= 0:
        raise InvalidParameter(f"the step of a contact trace is a positive decimal number, not {step!r}")
    return value


def _connection_log(lines: list[tuple[int, list[str]]]) -> list[_Contact] | None:
    """Return the contacts of a connection log of the ONE simulator, or None when this is none."""
    if not lines or any(len(cells) != 5 or cells[1].upper() != "CONN" for _, cells in lines):
        return None
    up: dict[tuple[str, str], Fraction] = {}
    contacts: list[_Contact] = []
    moment = Fraction(0)
    for line, (time, _, u, v, kind) in lines:
        moment = _moment(time, line)
        pair = (u, v) if u <= v else (v, u)
        if kind == "up" and pair not in up:
            up[pair] = moment
        elif kind == "down" and pair in up:
            contacts.append(_Contact(up.pop(pair), moment, u, v))
        elif kind not in ("up", "down"):
            raise UnreadableTopology(f"line {line}: a connection goes up or down, not {kind!r}")
    contacts += [_Contact(start, moment, *pair) for pair, start in up.items()]
    return contacts


def _table(rows: Rows, reading: ReadingOptions, notes: list[str]) -> list[_Contact]:
    """Return the contacts in rows."""
    head, body, lines = _head(rows, reading)
    numbered = list(zip(body, lines, strict=True))
    width = len(rows.cells[0])
    if width < 3:
        raise UnreadableTopology(
            f"line {rows.lines[0]}: a contact is time,source,target, not {counted(width, 'column')}"
        )
    names = set(head or []) | {str(name) for name in (reading.columns or {})}
    is_interval = all(_is_there(part, head, reading) for part in ("start", "end"))
    wanted = ("start", "end", "source", "target") if is_interval else ("time", "time", "source", "target")
    if head is None and not reading.columns:
        _require_time_first(body, lines)
        places = [0, 0, 1, 2]
    else:
        missing = [part for part in dict.fromkeys(wanted) if not _is_there(part, head, reading)]
        if missing:
            _refuse_missing(missing, names, rows.lines[0])
        found = dict(
            zip(dict.fromkeys(wanted), columns_of(reading, head, tuple(dict.fromkeys(wanted)), width, {}), strict=True)
        )
        places = [found[part] for part in wanted]
        notes.append("columns by name" if head is not None else "columns as asked")
    return list(_contacts(numbered, places))


def _is_there(part: str, head: list[str] | None, reading: ReadingOptions) -> bool:
    return part in (reading.columns or {}) or (head is not None and any(name in head for name in COLUMN_NAMES[part]))


def _refuse_missing(missing: list[str], names: set[str], line: int) -> NoReturn:
    raise UnreadableTopology(
        f"line {line}: no column is {missing[0]}; there are {', '.join(sorted(names)) or 'no names'}: say where it "
        "stands, for "
        "example --columns time=3,source=1,target=2"
    )


def _head(rows: Rows, reading: ReadingOptions) -> tuple[list[str] | None, list[list[str]], list[int]]:
    """Return the names of the columns, from the first line or from the comment above it, and the rows that follow."""
    first = [cell.lower() for cell in rows.cells[0]]
    is_head = (
        rows.may_have_head
        and not any(is_number(cell) for cell in first)
        and sum(any(cell in names for cell in first) for names in COLUMN_NAMES.values()) >= 2
    )
    if is_head or any(isinstance(place, str) for place in (reading.columns or {}).values()):
        return first, rows.cells[1:], rows.lines[1:]
    named = [cell.strip().lower() for cell in split_lines([rows.comment])[1][0]] if rows.comment else []
    known = {name for names in COLUMN_NAMES.values() for name in names}
    if len(named) == len(first) and len(known & set(named)) >= 3:
        return named, rows.cells, rows.lines
    return None, rows.cells, rows.lines


def _require_time_first(rows: list[list[str]], lines: list[int]) -> None:
    """Guarantees that rows without names can only be time, source, target."""
    columns = [[row[k] for row in rows] for k in range(3)]
    is_square = len(rows) == len(rows[0]) and all(is_number(cell) for row in rows for cell in row)
    hint = "say where they stand, for example --columns time=1,source=2,target=3"
    if is_square and len({cell for row in rows for cell in row}) <= 2:
        raise UnreadableTopology(
            f"{counted(len(rows), 'row')} of {counted(len(rows), 'number')} may be a matrix and no contacts: {hint}"
        )
    if len(rows[0]) > 3 and all(is_number(row[3]) for row in rows) and len({row[3] for row in rows}) > 1:
        raise UnreadableTopology(
            f"line {lines[0]}: of {counted(len(rows[0]), 'column')} of numbers any may be the time: {hint}"
        )
    if not all(is_number(cell) for cell in columns[2]):
        return  # the last column names nodes
    rises = [_is_rising(column) for column in (columns[0], columns[2])]
    if rises[0] and not rises[1]:
        return
    raise UnreadableTopology(
        f"line {lines[0]}: {','.join(rows[0][:3])} may be time,source,target and may be source,target,time: {hint}"
    )


def _is_rising(column: list[str]) -> bool:
    """Return whether a column is numbers that never fall, as the times of a log are."""
    numbers = [_number(cell) for cell in column]
    return None not in numbers and all(a <= b for a, b in pairwise(numbers))  # type: ignore[operator]


def _contacts(rows: list[tuple[list[str], int]], places: list[int]) -> Iterator[_Contact]:
    """Return the contacts in rows; a row that is none is an error."""
    for row, line in rows:
        begin, finish, source, target = (row[place] for place in places)
        start, end = _moment(begin, line), _moment(finish, line)
        if end < start:
            raise UnreadableTopology(f"line {line}: a contact ends at {finish} before it starts at {begin}")
        if not source or not target:
            raise UnreadableTopology(f"line {line}: a contact has a source and a target, and one is empty")
        yield _Contact(start, end, source, target)


def _moment(text: str, line: int) -> Fraction:
    value = _number(text)
    if value is None:
        raise UnreadableTopology(f"line {line}: the time is a decimal number, not {text!r}")
    return value


def _number(text: str) -> Fraction | None:
    """Return the exact value of decimal text, or None when it is none or absurdly large or long."""
    try:
        value = Decimal(text)
    except InvalidOperation:
        return None
    _, digits, exponent = value.as_tuple()
    if not isinstance(exponent, int) or not -_EXPONENT_LIMIT <= exponent <= exponent + len(digits) <= _EXPONENT_LIMIT:
        return None
    return Fraction(value)
