"""Contact traces: CSV rows ``time,source,target``, put into bins of equal length; each bin is a step.

Times are decimal numbers and are binned exactly: with bins of 0.1, time 0.3 is in bin 3, which floating-point
division misses. The first line may name the columns, in any order and among others; without it they are the first
three. Empty lines are skipped. The target of a contact hears its source.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from decimal import Decimal, InvalidOperation
from fractions import Fraction

from robustness.errors import InvalidParameter, UnreadableTopology
from robustness.files.text import decode_utf8
from robustness.time_varying.sequence import TimeVaryingGraph

__all__ = ["STEP_LIMIT", "bin_length", "decode_contacts"]

#: The most steps that a contact trace is cut into.
STEP_LIMIT = 1_000_000

#: Times are smaller than 10 to this power, and have at most as many decimals.
_EXPONENT_LIMIT = 30

_COLUMNS = ("time", "source", "target")

#: Line, time, source, target.
_Contact = tuple[int, Fraction, str, str]


def decode_contacts(
    data: bytes, step: Fraction, period: int | None = None, *, both_ways: bool = False
) -> TimeVaryingGraph:
    """Return the sequence of the bins of a contact trace; bin 0 starts at the earliest time.

    Raises
    ------
    UnreadableTopology
        For bytes that are no contact trace, with the line; or when the bins would be more than :data:`STEP_LIMIT`.
    """
    contacts = list(_contacts(decode_utf8(data)))
    if not contacts:
        raise UnreadableTopology("a contact trace holds at least one contact time,source,target, and here is none")
    first, last = min(contact[1] for contact in contacts), max(contact[1] for contact in contacts)
    count = (last - first) // step + 1
    if count > STEP_LIMIT:
        raise UnreadableTopology(f"bins of {float(step):g} make more than {STEP_LIMIT} steps: choose longer ones")
    steps: list[list[tuple[str, str]]] = [[] for _ in range(count)]
    for _, time, source, target in contacts:
        steps[(time - first) // step].append((source, target))
    nodes = dict.fromkeys(label for contact in contacts for label in contact[2:])
    return TimeVaryingGraph.from_arcs(nodes, steps, period, directed=not both_ways)


def bin_length(step: float | str | None) -> Fraction:
    """Return the length of a bin as an exact number: 1 for None, the decimal value of what was written otherwise."""
    value = Fraction(1) if step is None else _number(str(step))
    if value is None or value <= 0:
        raise InvalidParameter(f"the step of a contact trace is a positive decimal number, not {step!r}")
    return value


def _contacts(text: str) -> Iterator[_Contact]:
    """Return the contacts of CSV text with their lines; a line that is none is an error."""
    rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    places, is_first = [0, 1, 2], True
    for row in _rows(rows):
        cells = [cell.strip() for cell in row]
        if not any(cells):
            continue
        names = [cell.lower() for cell in cells]
        if is_first and set(_COLUMNS) <= set(names):
            places, is_first = [names.index(column) for column in _COLUMNS], False
            continue
        is_first = False
        if len(cells) <= max(places):
            raise UnreadableTopology(
                f"line {rows.line_num}: a contact is time,source,target, not {len(cells)} column(s)"
            )
        time, source, target = (cells[place] for place in places)
        moment = _number(time)
        if moment is None:
            raise UnreadableTopology(f"line {rows.line_num}: the time is a decimal number, not {time!r}")
        if not source or not target:
            raise UnreadableTopology(f"line {rows.line_num}: a contact has a source and a target, and one is empty")
        yield rows.line_num, moment, source, target


def _rows(rows: Iterable[list[str]]) -> Iterator[list[str]]:
    try:
        yield from rows
    except csv.Error as problem:
        raise UnreadableTopology(f"line {getattr(rows, 'line_num', 0)}: {problem}") from None


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
