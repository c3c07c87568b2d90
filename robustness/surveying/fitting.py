"""The table of a survey on a terminal: it fits the width, and no name is cut.

What does not fit is said shorter, in this order, until it does: what all names begin with is said once; threat models
go by their first letters, which a line at the end explains; columns stand one space apart; names that are longer than
the room left stand above their row. Long notes stand below it and are wrapped.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from robustness.printable import printable, width_of
from robustness.surveying.row import Row
from robustness.surveying.tables import aligned, cells

__all__ = ["fitted"]

#: A note of more columns stands below its row.
_SHORT_NOTE = 10

#: Names are not squeezed into less.
_NARROWEST_NAMES = 8


@dataclass(frozen=True, slots=True)
class _Shortening:
    """How much is said shorter."""

    beginning: str = ""
    letters: Mapping[str, str] | None = None
    gap: int = 2
    #: Whether long names stand above their row.
    splits: bool = False


def fitted(rows: Sequence[Row], models: Sequence[str], width: int) -> str:
    """Return the table of ``tables.cells`` in lines of at most ``width`` columns, unless a name or a row is longer."""
    head, *body = ([printable(cell) for cell in line] for line in cells(rows, models))
    lines: list[str] = []
    for shortening in _shortenings([line[0] for line in body], models):
        lines = list(_lines(head, body, shortening, width))
        if all(width_of(line) <= width for line in lines):
            break
    return "\n".join(lines)


def _shortenings(names: Sequence[str], models: Sequence[str]) -> Iterator[_Shortening]:
    beginning = _common_beginning(names)
    letters = _letters(models)
    yield _Shortening()
    yield _Shortening(beginning)
    yield _Shortening(beginning, letters)
    yield _Shortening(beginning, letters, gap=1)
    yield _Shortening(beginning, letters, gap=1, splits=True)


def _lines(head: Sequence[str], body: Sequence[Sequence[str]], how: _Shortening, width: int) -> Iterator[str]:
    if how.beginning:
        yield from textwrap.wrap(f"All names begin with {how.beginning}", width, break_long_words=False)
    letters = how.letters or {}
    names = [line[0].removeprefix(how.beginning) for line in body]
    notes = [line[-1] if width_of(line[-1]) > _SHORT_NOTE else "" for line in body]
    # A row with a long note has nothing else to tell but the gate, which the note explains.
    facts = [[""] * (len(head) - 1) if note else list(line[1:]) for line, note in zip(body, notes, strict=True)]
    titles = [letters.get(cell, cell) for cell in head]
    room = width
    if how.splits:
        others = max(map(width_of, aligned([titles[1:], *facts], how.gap)))
        room = max(width - others - how.gap, _NARROWEST_NAMES)
    shown = ["" if width_of(name) > room or note else name for name, note in zip(names, notes, strict=True)]
    table = aligned([titles, *([name, *line] for name, line in zip(shown, facts, strict=True))], how.gap)
    yield next(table)
    for name, inline, note, line in zip(names, shown, notes, table, strict=True):
        if name != inline:
            yield name
        if note:
            yield from textwrap.wrap(note, width, initial_indent="  ", subsequent_indent="  ")
        else:
            yield line
    if letters:
        meanings = ", ".join(f"{short}\0{name}" for name, short in letters.items())
        told = textwrap.wrap(f"Threat models: {meanings}", width, break_on_hyphens=False, break_long_words=False)
        yield from (line.replace("\0", " ") for line in told)


def _common_beginning(names: Sequence[str]) -> str:
    """Return what all names begin with, up to a slash."""
    shared = ""
    for letters in zip(*names, strict=False):
        if len(set(letters)) > 1:
            break
        shared += letters[0]
    return shared[: shared.rfind("/") + 1]


def _letters(models: Sequence[str]) -> dict[str, str]:
    """Return for each model the first letters of its words: ``ml`` for ``malicious-local``."""
    return {model: "".join(word[0] for word in model.split("-")) for model in models}
