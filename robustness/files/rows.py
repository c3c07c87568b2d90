"""Lines of text as rows of cells: which separator, which comments, and what the comments say about direction.

Shared by edge lists and matrices in text. A file has one shape: all its lines have the same separator and, but for
trailing separators, the same number of cells; a file that has not is refused with the line that differs.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass

from robustness.errors import UnreadableTopology
from robustness.files.text import decode_utf8

__all__ = ["Rows", "arrows_of", "is_number", "rows_of"]

_COMMENTS = ("#", "%", "//")
_ARROW = re.compile(r"^(?P<u>\S.*?)\s*(?P<kind>->|--|<->)\s*(?P<v>\S.*?)\s*[;,]?$")
_TUPLE = re.compile(r"^[(\[]\s*(?P<u>[^,()\[\]]+?)\s*,\s*(?P<v>[^,()\[\]]+?)\s*[)\]]\s*,?$")
_DICT = re.compile(r"\s*\{[^{}]*\}\s*$")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(inf|infinity|nan)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Rows:
    """The rows of a file.

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
    """

    cells: list[list[str]]
    lines: list[int]
    is_directed: bool | None
    separator: str


def is_number(cell: str) -> bool:
    """Return whether a cell is a number as people and programs write it: no underscores, no other alphabets."""
    return cell.isascii() and _NUMBER.fullmatch(cell) is not None


def _content(data: bytes) -> tuple[list[tuple[int, str]], bool | None]:
    """Return the lines that are no comments, and what the comments say about direction."""
    lines: list[tuple[int, str]] = []
    said: dict[bool, int] = {}
    for number, line in enumerate(re.split(r"\r\n|\r|\n", decode_utf8(data)), 1):
        text = line.strip()
        if text.startswith(_COMMENTS):
            words = re.findall(r"[a-z]+", text.lower())
            for word, directed in (("directed", True), ("digraph", True), ("undirected", False)):
                if word in words and not {"not", "non", "un"} & set(words):
                    said.setdefault(directed, number)
            continue
        if '"' not in text:
            text = re.split(r"\s#", text)[0].strip()
        if text:
            lines.append((number, text))
    if len(said) == 2:
        raise UnreadableTopology(
            f"line {max(said.values())}: one comment says directed and another undirected: keep the one that is true"
        )
    return lines, next(iter(said), None)


def arrows_of(data: bytes) -> tuple[list[tuple[str, str]], bool] | None:
    """Return the links of ``u -> v`` or ``u -- v`` lines and whether they are directed; None: no such lines."""
    lines, said = _content(data)
    if any("\t" in text and not re.search(r"\t(->|--|<->)\t", text) for _, text in lines):
        return None  # tabs separate, so an arrow is part of a name
    matches = [(number, None if text.startswith('"') else _ARROW.match(text)) for number, text in lines]
    if not any(match for _, match in matches):
        return None
    links: list[tuple[str, str]] = []
    kinds: set[str] = set()
    for number, match in matches:
        if match is None:
            raise UnreadableTopology(f"line {number}: has no arrow, which other lines have: write 'u -> v' in each")
        ends = (_bare(match["u"]), _bare(match["v"]))
        kinds.add(match["kind"])
        links += [ends, ends[::-1]] if match["kind"] == "<->" else [ends]
    if "--" in kinds and len(kinds) > 1:
        raise UnreadableTopology("some lines have '->' and some '--': write one kind")
    directed = "--" not in kinds
    if said is not None and said != directed:
        raise UnreadableTopology("a comment says one direction and the arrows another: mend one of them")
    return links, directed


def _bare(name: str) -> str:
    quoted = len(name) > 1 and name[0] == name[-1] and name[0] in "\"'"
    return name[1:-1] if quoted else name


def rows_of(data: bytes) -> Rows:
    """Return the rows of a file of text.

    Raises
    ------
    UnreadableTopology
        When lines differ in their number of cells.
    """
    lines, said = _content(data)
    texts = [text if '"' in text else _DICT.sub("", text) for _, text in lines]
    if texts and all(_TUPLE.match(text) for text in texts):
        cells = [[match["u"], match["v"]] for text in texts if (match := _TUPLE.match(text))]
        return Rows([[_bare(cell) for cell in row] for row in cells], [n for n, _ in lines], said, "tuples")
    separator, cells = _split(texts)
    while cells and all(len(row) > 1 and not row[-1] for row in cells):
        cells = [row[:-1] for row in cells]
    for (number, _), row in zip(lines, cells, strict=True):
        if len(row) != len(cells[0]):
            raise UnreadableTopology(
                f"line {number}: has {len(row)} columns, but line {lines[0][0]} has {len(cells[0])}: every line has "
                "the same shape, a link or a row of a matrix; node-link JSON (.json) leaves no such doubts"
            )
    return Rows(cells, [number for number, _ in lines], said, separator)


def _split(texts: list[str]) -> tuple[str, list[list[str]]]:
    """Split all lines at the first separator that most lines have; white space where there is none."""
    for name, separator in (("tabs", "\t"), ("semicolons", ";"), ("commas", ",")):
        inside = [text.rstrip(separator) if separator == ";" else text for text in texts]
        if texts and 2 * sum(separator in text for text in inside) >= len(texts):
            return name, [_cells(text, separator) for text in inside]
    trimmed = [text.rstrip(";,").rstrip() for text in texts]
    if any('"' in text for text in trimmed):
        return "spaces", [_cells(re.sub(r"\s+", " ", text), " ") for text in trimmed]
    return "spaces", [text.split() for text in trimmed]


def _cells(text: str, separator: str) -> list[str]:
    try:
        (row,) = csv.reader([text], delimiter=separator, skipinitialspace=True, strict=True)
    except (csv.Error, ValueError) as problem:
        raise UnreadableTopology(f"a line cannot be split at its separators: {problem}") from None
    return [cell.strip() for cell in row]
