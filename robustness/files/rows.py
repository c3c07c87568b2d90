"""Lines of text as rows of cells: which separator, which comments, and what the comments say about direction.

Shared by edge lists, adjacency lists, matrices and contact traces. A file has one shape: all its lines have the same
separator and, but for trailing separators, the same number of cells; a file that has not is refused with the line that
differs.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

from robustness.errors import UnreadableTopology
from robustness.files.text import decode_utf8
from robustness.spelled import counted

__all__ = ["Content", "Rows", "bare", "content_of", "is_number", "rows_of", "split_lines"]

_COMMENTS = ("#", "%", "//")
_TUPLE = re.compile(r"^[(\[]\s*(?P<u>[^,()\[\]]+?)\s*,\s*(?P<v>[^,()\[\]]+?)\s*[)\]]\s*,?$")
_DICT = re.compile(r"\s*\{[^{}]*\}\s*$")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf|infinity|nan)", re.IGNORECASE)

#: What comments say of direction; ``sym`` and ``asym`` are words of the KONECT collection.
_WORDS = {"directed": True, "digraph": True, "asym": True, "undirected": False, "sym": False}


@dataclass(frozen=True, slots=True)
class Content:
    """The lines of a text that are no comments.

    Attributes
    ----------
    lines : list of (int, str)
        Each with its number, from 1.
    is_directed : bool or None
        What a comment says; None: nothing.
    comment : str
        The last comment before the first line: sometimes the names of the columns.
    skipped : int
        How many lines at the beginning were left out, as asked.
    """

    lines: list[tuple[int, str]]
    is_directed: bool | None
    comment: str = ""
    skipped: int = 0


@dataclass(frozen=True, slots=True)
class Rows:
    """The rows of a text.

    Attributes
    ----------
    cells : list of list of str
        As many in every row.
    lines : list of int
        The line of each row, from 1.
    is_directed : bool or None
        What a comment says; None: nothing.
    separator : str
        In words.
    comment : str
        As in :class:`Content`.
    may_have_head : bool
        Whether the first row may name the columns; not when the user said how many lines are no links.
    """

    cells: list[list[str]]
    lines: list[int]
    is_directed: bool | None
    separator: str
    comment: str = ""
    may_have_head: bool = True


def is_number(cell: str) -> bool:
    """Return whether a cell is a number as people and programs write it: no underscores, no other alphabets."""
    return cell.isascii() and _NUMBER.fullmatch(cell) is not None


def bare(name: str) -> str:
    """Return a name without the quotes around it."""
    quoted = len(name) > 1 and name[0] == name[-1] and name[0] in "\"'"
    return name[1:-1] if quoted else name


def content_of(data: bytes, skip_lines: int | None = None) -> Content:
    """Return the lines that are no comments, and what the comments say about direction.

    Raises
    ------
    UnreadableTopology
        When comments contradict one another, or say that the two columns number different nodes.
    """
    lines: list[tuple[int, str]] = []
    said: dict[bool, int] = {}
    comment = ""
    for number, line in enumerate(re.split(r"\r\n|\r|\n", decode_utf8(data)), 1):
        text = line.strip(" \f\v")
        if not text.strip():
            continue
        if text.lstrip().startswith(_COMMENTS):
            _listen(text, number, said)
            comment = comment if lines else text.strip().lstrip("#%/ \t")
            continue
        if "#" in text and '"' not in text:
            text = re.split(r"\s#", text)[0].rstrip(" ")
        if not lines and re.fullmatch(r"sep=.", text):
            continue  # a spreadsheet names its separator, which is found anyway
        if text.strip():
            lines.append((number, text))
    if len(said) == 2:
        raise UnreadableTopology(
            f"line {max(said.values())}: one comment says directed and another undirected: keep the one that is true"
        )
    skipped = skip_lines or 0
    return Content(lines[skipped:], next(iter(said), None), comment, -1 if skip_lines is None else skipped)


def _listen(comment: str, number: int, said: dict[bool, int]) -> None:
    """Note what a comment says of direction."""
    words = set(re.findall(r"[a-z]+", comment.lower()))
    if "bip" in words or "bipartite" in words:
        raise UnreadableTopology(
            f"line {number}: a comment says bipartite, where one number in both columns is two nodes: give every "
            "node a "
            "name of its own and remove the comment"
        )
    for word, directed in _WORDS.items():
        if word in words and not {"not", "non", "un"} & words:
            said.setdefault(directed, number)


def rows_of(content: Content) -> Rows:
    """Return the rows of a text.

    Raises
    ------
    UnreadableTopology
        When lines differ in their number of cells.
    """
    numbers = [number for number, _ in content.lines]
    texts = [_DICT.sub("", text) if "{" in text and '"' not in text else text for _, text in content.lines]
    if texts and texts[0][:1] in ("(", "[") and all(_TUPLE.match(text) for text in texts):
        cells = [[match["u"], match["v"]] for text in texts if (match := _TUPLE.match(text))]
        cells = [[bare(cell) for cell in row] for row in cells]
        return Rows(cells, numbers, content.is_directed, "tuples", content.comment, content.skipped < 0)
    separator, cells = split_lines(texts, numbers)
    while cells and all(len(row) > 1 and not row[-1] for row in cells):
        cells = [row[:-1] for row in cells]
    if _is_headed_by_names(cells):
        cells[0].insert(0, "")
    for number, row in zip(numbers, cells, strict=True):
        if len(row) != len(cells[0]):
            raise UnreadableTopology(
                f"line {number}: has {counted(len(row), 'column')}, but line {numbers[0]} has {len(cells[0])}: "
                "every line has the same shape, a link or a row of a matrix; --format adjacency-list for lists of "
                "neighbours, --skip-lines for lines at the beginning that are something else"
            )
    return Rows(cells, numbers, content.is_directed, separator, content.comment, content.skipped < 0)


def _is_headed_by_names(cells: list[list[str]]) -> bool:
    """Return whether the first line lacks the corner above the names of the rows, as R writes tables."""
    if len(cells) < 3 or len({len(row) for row in cells[1:]}) > 1 or len(cells[0]) != len(cells[1]) - 1:
        return False
    first = [row[0] for row in cells[1:]]
    return cells[0] == first or first == [str(k) for k in range(1, len(cells))]


def split_lines(texts: Sequence[str], numbers: Sequence[int] = ()) -> tuple[str, list[list[str]]]:
    """Split all lines at the first separator that most lines have; white space where there is none.

    ``numbers`` are those of the lines, for complaints.
    """
    places = numbers or range(1, len(texts) + 1)
    for name, separator in (("tabs", "\t"), ("semicolons", ";"), ("commas", ",")):
        inside = [text.rstrip(separator) if separator == ";" else text for text in texts]
        if texts and 2 * sum(separator in text for text in inside) >= len(texts):
            return name, [_cells(*line, separator) for line in zip(places, inside, strict=True)]
    trimmed = [text.rstrip(";,").rstrip() for text in texts]
    if any('"' in text for text in trimmed):
        return "spaces", [
            _cells(number, re.sub(r"\s+", " ", text.strip()), " ") for number, text in zip(places, trimmed, strict=True)
        ]
    return "spaces", [text.split() or [""] for text in trimmed]


def _cells(number: int, text: str, separator: str) -> list[str]:
    try:
        (row,) = csv.reader([text], delimiter=separator, skipinitialspace=True, strict=True)
    except (csv.Error, ValueError) as problem:
        raise UnreadableTopology(f"line {number}: cannot be split at its separators: {problem}") from None
    return [cell.strip() for cell in row]
