"""What the user sees: results on standard output, talk and progress on standard error, colour where it is wanted.

What is shown holds names of files, labels and values that others have chosen. Nothing of it steers the terminal: a
character that is not printable stands as its escape. Colours are the toolkit's own, and stand only before the text.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import textwrap
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Any, TextIO

import click

from robustness.spelled import plural

from .exit_codes import ExitCode

if TYPE_CHECKING:
    from certificates.graph import Label
    from robustness.digraph import Digraph
    from robustness.limits import Progress
    from robustness.results import Bounds

__all__ = [
    "ERROR_SCHEMA",
    "Console",
    "ProgressLine",
    "graph_document",
    "pass_console",
    "set_document",
    "set_text",
    "terminal_width",
    "wrapped",
    "write_help",
]

#: With --json, of the document that says why there is no answer.
ERROR_SCHEMA = "robustness/error/1"

#: A set of more labels than this is cut in text; --json and -v print it whole.
_LABELS_SHOWN = 60

#: A verdict or the kind of a message, as ``click.style`` colours it: the one place for sequences that steer a terminal.
_HEAD = re.compile(r"(?:\x1b\[\d{1,2}m)+[\w -]+:\x1b\[0m")

#: What stands before the text of a line, and what the lines it is cut into leave room for.
_FIRST_COLUMN = re.compile(r"\s*(?:\S.{0,20}?\s{2,}|\w+ = \{)(?=\S)")


@dataclass(slots=True)
class Console:
    """The two streams and how much goes to them. Colour is settled by click's context."""

    is_verbose: bool = False
    is_quiet: bool = False
    #: Whether --json stands on the command line, and whether its document has been printed.
    as_json: bool = False
    has_document: bool = False
    #: What has been warned of.
    warned: list[str] = field(default_factory=list)

    def result(self, text: str) -> None:
        """Print a result in words on standard output; on a terminal its lines fit, but with -q a line is a line."""
        shown = _harmless(text)
        _write(shown if self.is_quiet else _fitted(shown, sys.stdout), to_error=False)

    def content(self, text: str) -> None:
        """Print what a file would hold, a graph or a table, as it is."""
        _write(_harmless(text), to_error=False)

    def answer(self, lines: Iterable[str]) -> None:
        """Print an answer whose first line says it all; with -q that line alone."""
        self.result(next(iter(lines), "") if self.is_quiet else "\n".join(lines))

    def document(self, schema: str, content: Mapping[str, Any]) -> None:
        """Print a result as one JSON document whose first key is ``schema``."""
        self.has_document = True
        _write(json.dumps({"schema": schema, **content}, allow_nan=False), to_error=False)

    def error_document(self, code: int, message: str) -> None:
        """With --json and no document so far: print one that says why, so that a program need not read words."""
        if self.as_json and not self.has_document:
            verdict = {"verdict": "undecided"} if code == ExitCode.UNDECIDED else {}
            self.document(ERROR_SCHEMA, {"exit_code": int(code), **verdict, "error": message})

    def talk(self, text: str) -> None:
        """Say something that is no result; -q silences it."""
        if not self.is_quiet:
            _write(_fitted(_harmless(text), sys.stderr), to_error=True)

    def warn(self, text: str) -> None:
        """Say what the user may have to change in the input or the options; -q silences it."""
        self.warned.append(text)
        self.talk(f"{click.style('warning:', fg='yellow')} {text}")

    def note_reading(self, read_as: str) -> None:
        """Say how a file was read where a word is due and no warning has said it; -q silences it."""
        if ";" in read_as and not any(read_as in text for text in self.warned):
            self.talk(f"note: read as: {read_as}")

    def error(self, text: str) -> None:
        """Say why the command ends."""
        kind, colon, rest = text.partition(":")
        shown = click.style(_harmless(kind + colon), fg="red") + _harmless(rest) if colon else _harmless(text)
        _write(shown if "\n" in text else _fitted(shown, sys.stderr), to_error=True)  # a traceback is left as it is


pass_console = click.make_pass_decorator(Console, ensure=True)


class ProgressLine:
    """One line on a terminal's standard error that is redrawn while a search runs, and wiped when it ends.

    Pass the instance as ``progress`` and :attr:`note_bounds` as ``on_bounds``; ``bounds`` and ``note`` hold the latest.
    """

    def __init__(self, console: Console) -> None:
        self.bounds: Bounds | None = None
        is_terminal = sys.stderr is not None and sys.stderr.isatty()  # None when it is closed
        self._shown = is_terminal and not console.is_quiet and os.environ.get("TERM") != "dumb"
        self._started = self._drawn = time.monotonic()
        self._text = ""
        self.note = ""
        self._nodes = 0

    def __enter__(self) -> ProgressLine:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, tb: TracebackType | None) -> None:
        if self._shown and self._text:
            _write("\r\x1b[K", to_error=True, end="")
        self._shown = False  # interrupted work may go on in the background

    def __call__(self, progress: Progress) -> None:
        """Show how far the search is."""
        self._nodes, self.note = progress.nodes, _harmless(progress.note)
        self.tick()

    def note_bounds(self, bounds: Bounds) -> None:
        """Remember the latest proven bounds, for the line and for a report after Ctrl-C."""
        self.bounds = bounds

    def tick(self) -> None:
        """Redraw the line with the present time, ten times a second at most."""
        now = time.monotonic()
        if not self._shown or now - self._drawn < 0.1:
            return
        self._drawn = now
        known = f"{self.bounds.lower.value} <= r* <= {self.bounds.upper.value}" if self.bounds else ""
        visited = f"{self._nodes:,} {plural(self._nodes, 'node')} visited" if self._nodes else ""
        parts = (f"{now - self._started:.0f} s", known, visited, self.note or "starting")
        text = ", ".join(part for part in parts if part)
        self._text = text[: shutil.get_terminal_size().columns - 1]
        _write(f"\r\x1b[K{self._text}", to_error=True, end="")


def terminal_width(stream: TextIO | None = None) -> int | None:
    """Return the columns of the terminal that results, or a stream, go to; None for a file or another program."""
    stream = stream or sys.stdout
    if stream is None or not stream.isatty():
        return None
    try:
        columns = int(os.environ["COLUMNS"])
    except (KeyError, ValueError):
        try:
            columns = os.get_terminal_size(stream.fileno()).columns
        except OSError:
            columns = 80
    return max(columns, 40)


def wrapped(text: str, *, indent: str = "", hanging: str = "") -> str:
    """Return text in lines that fit the terminal that results go to, in one piece where it is none; no word is cut.

    ``indent`` stands before the first line, ``hanging`` before the others.
    """
    columns = terminal_width()
    return indent + text if columns is None else _filled(text, columns, indent, hanging)


def _filled(text: str, columns: int, indent: str = "", hanging: str = "") -> str:
    return textwrap.fill(
        text,
        min(max(columns, 40), 120),
        initial_indent=indent,
        subsequent_indent=hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _fitted(text: str, stream: TextIO | None) -> str:
    """Return text in lines that fit the terminal; as it is where ``stream`` is none, for programs that read lines.

    A line goes on below what it says: past its indentation and the word in its first column.
    """
    columns = None if stream is None else terminal_width(stream)
    if columns is None:
        return text
    return "\n".join(_fitted_line(line, columns) for line in text.split("\n"))


def _fitted_line(line: str, columns: int) -> str:
    plain = click.unstyle(line)
    if len(plain) <= columns:
        return line
    column = _FIRST_COLUMN.match(plain)
    indent = len(plain) - len(plain.lstrip())
    hanging = len(column[0]) if column else max(indent, 2)
    head = _HEAD.match(line)
    styled = head[0] if head else ""
    return styled + _filled(plain, columns, hanging=" " * hanging)[len(click.unstyle(styled)) :]


def graph_document(graph: Digraph) -> dict[str, Any]:
    """Return what every JSON document says about the graph; an undirected edge is two arcs."""
    return graph.as_dict()


def set_document(labels: Iterable[Label]) -> list[Label]:
    """Return a set of labels for JSON: in natural order, ``n2`` before ``n10``, tuples as lists."""
    from robustness.natural_order import in_natural_order

    return in_natural_order(labels)


def set_text(labels: Iterable[Label], nodes: Iterable[Label], *, whole: bool = False) -> str:
    """Return a set of labels as text, in natural order; a long one is cut unless ``whole``.

    ``nodes`` are all of the network: labels are in quotes only where two of them would look alike.
    """
    from robustness.spelled import Spelling, listed_in_words

    return listed_in_words(set_document(labels), None if whole else _LABELS_SHOWN, Spelling(nodes))


def _harmless(text: str) -> str:
    """Return text that cannot steer a terminal, but for the colours of its head."""
    from robustness.printable import printable

    head = _HEAD.match(text)
    begin = head.end() if head else 0
    return text[:begin] + printable(text[begin:], "\n")


def write_help(text: str) -> None:
    """Print what click has to say of a command."""
    _write(text, to_error=False)


def _write(text: str, *, to_error: bool, end: str = "\n") -> None:
    """Write and flush. A reader that has gone away is not an error: the exit code still tells the verdict."""
    try:
        click.echo(text + end, err=to_error, nl=False)
    except BrokenPipeError:
        _discard(sys.stderr if to_error else sys.stdout)
    except OSError as problem:  # a full disk: what was to be said is lost, and the exit code says that it was not done
        stream = sys.stderr if to_error else sys.stdout
        _discard(stream)
        name = "standard error" if to_error else "standard output"
        raise OSError(problem.errno, problem.strerror or str(problem), name) from None


def _discard(stream: TextIO) -> None:
    """Point ``stream`` at the null device, so that Python's flush at exit does not fail again."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)
