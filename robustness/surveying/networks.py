"""Which networks a survey is about: files, folders, patterns and groups of topohub, in natural order, each once."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from robustness.errors import UnreadableTopology
from robustness.files import FORMATS, names_of_graphs, topohub_names
from robustness.files.front import format_suffix
from robustness.files.text import one_line
from robustness.natural_order import natural_key
from robustness.spelled import counted

__all__ = ["Sources", "expand", "note_of_twice"]


@dataclass(frozen=True, slots=True)
class Sources:
    """The names of networks that :func:`robustness.read_topology` takes, and what was passed over on the way.

    Attributes
    ----------
    names : tuple of str
        In the order asked for; inside a folder, a pattern or a group in natural order (``net2`` before ``net10``).
    notes : tuple of str
        One line for each thing that was passed over: files of other kinds in a folder, names given twice.
    """

    names: tuple[str, ...]
    notes: tuple[str, ...]


def expand(paths: Iterable[str | os.PathLike[str]]) -> Sources:
    """Return the networks that ``paths`` mean.

    Parameters
    ----------
    paths : iterable of str or path
        Each a file; a folder, of which every file with a suffix of :data:`robustness.files.FORMATS` is taken, folders
        in it included, hidden ones not (a file of many graph6 lines is a network a line); a pattern with ``*``, ``?``
        or ``[``; ``topohub:GROUP/NAME``; or a pattern of such names, for example ``topohub:sndlib/*``.

    Raises
    ------
    UnreadableTopology
        When a pattern or a folder holds no network: asking about nothing is more likely a slip than a wish.
    MissingExtra
        For a pattern of topohub names when the package topohub is not installed.
    """
    names: dict[str, str] = {}  # by where they are
    notes: list[str] = []
    for path in paths:
        text = os.fspath(path)
        for name in _matches(text, notes):
            place = name if name.startswith(topohub_names.PREFIX) or name == "-" else os.path.abspath(name)
            if place in names:
                notes.append(note_of_twice(name))
            names.setdefault(place, name)
    return Sources(tuple(names.values()), tuple(notes))


def note_of_twice(name: str) -> str:
    """Return what is said of a network that two sources name."""
    return f"{one_line(name)}: asked for twice, surveyed once"


def _matches(text: str, notes: list[str]) -> Iterator[str]:
    if text.startswith(topohub_names.PREFIX):
        yield from _topohub(text)
    elif os.path.isdir(text):
        yield from _folder(Path(text), notes)
    elif _is_pattern(text) and not os.path.lexists(text):
        found = sorted(glob.glob(text, recursive=True), key=natural_key)
        if not found:
            raise UnreadableTopology(f"{one_line(text)}: no file matches this pattern")
        for each in found:
            if os.path.isdir(each):
                yield from _folder(Path(each), notes)
            else:
                yield from names_of_graphs(each)
    else:
        yield from names_of_graphs(text)


def _is_pattern(text: str) -> bool:
    return any(letter in text for letter in "*?[")


def _topohub(text: str) -> Iterator[str]:
    if not _is_pattern(text):
        yield text
        return
    pattern = text.removeprefix(topohub_names.PREFIX).lower()
    found = [name for name in topohub_names.list_names() if fnmatchcase(name.lower(), pattern)]
    if not found:
        groups = sorted({name.partition("/")[0] for name in topohub_names.list_names()})
        raise UnreadableTopology(f"{one_line(text)}: no network matches; the groups are {', '.join(groups)}")
    yield from (topohub_names.PREFIX + name for name in sorted(found, key=natural_key))


def _folder(folder: Path, notes: list[str]) -> Iterator[str]:
    found: list[str] = []
    passed_over = 0
    for where, folders, files in os.walk(folder):
        folders[:] = [each for each in folders if not each.startswith(".")]
        for file in files:
            if file.startswith("."):
                continue
            if format_suffix(file) in FORMATS:
                found += names_of_graphs(str(Path(where, file)))
            else:
                passed_over += 1
    if passed_over:
        notes.append(
            f"{one_line(str(folder))}: {counted(passed_over, 'file')} passed over, whose suffix names no format"
        )
    if not found:
        raise UnreadableTopology(f"{one_line(str(folder))}: holds no file of a known format ({', '.join(FORMATS)})")
    yield from sorted(found, key=natural_key)
