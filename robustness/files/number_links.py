"""Long lists of links between nodes that are whole numbers, read by arrays instead of line by line.

Such a file means here exactly what it means to the readers of every text: nothing is read but two whole numbers a
line with one tab, space or comma between, below comments that begin with ``#``. At anything else, and wherever a line
of them could mean something else than a link, :func:`number_links` returns None, and the other readers have the whole
file.
"""

from __future__ import annotations

import re
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from robustness.files.found import Found, Node, ReadingOptions
from robustness.files.rows import content_of

__all__ = ["number_links"]

#: Fewer lines are read as fast by the others.
_FEWEST_LINES = 1000

#: Digits of a number that is told exactly by an array.
_MOST_DIGITS = 18

_LINE = re.compile(rb"\d+([\t ,])\d+\n")
_NOTHING: MappingProxyType[str, object] = MappingProxyType({})


def number_links(data: bytes, options: ReadingOptions, loss: str, parallel: str) -> Found | None:
    """Return the links of a text of whole numbers, or None for any other text.

    ``loss`` and ``parallel`` are what the reader of edge lists says of its own.

    Raises
    ------
    UnreadableTopology
        When comments contradict one another, as from the other readers.
    """
    if options.rows is not None or options.columns is not None or options.skip_lines is not None:
        return None
    begin = 0
    while data.startswith(b"#", begin):
        begin = data.find(b"\n", begin) + 1
        if not begin:
            return None
    first = _LINE.match(data, begin)
    if first is None or data.count(b"\n", begin) < _FEWEST_LINES or b"\r" in data[:begin]:
        return None
    flat = _numbers(data[begin:], first[1])
    if flat is None:
        return None
    ends = flat.reshape(-1, 2)
    if ends[0, 1] == len(ends) - 1 or 2 * int((ends[:, 0] == ends[:, 1]).sum()) > len(ends):
        return None  # the first line may be counts; a table of nodes names each twice
    content = content_of(data[:begin])
    labels, places = _in_order_of_appearance(flat)
    nodes = [Node(str(label), attributes=_NOTHING) for label in labels.tolist()]
    told = ["links between columns 1 and 2"]
    return Found(nodes, [], content.is_directed, told, loss=loss, parallel=parallel, ends=places.reshape(-1, 2))


def _numbers(text: bytes, separator: bytes) -> npt.NDArray[np.int64] | None:
    """Return all numbers of a text in which every line is two of them; None for any other text."""
    if not text.endswith(b"\n"):
        text += b"\n"
    letters = np.frombuffer(text, np.uint8)
    is_end = (letters == ord("\n")) | (letters == ord(separator))
    if not (is_end | ((letters >= ord("0")) & (letters <= ord("9")))).all():
        return None
    stops = np.flatnonzero(is_end)
    if len(stops) % 2 or (letters[stops[0::2]] != ord(separator)).any() or (letters[stops[1::2]] != ord("\n")).any():
        return None
    starts = np.concatenate([[0], stops[:-1] + 1])
    sizes = stops - starts
    # A number that is not written the shortest way is another label than the one that is.
    if sizes.min() < 1 or sizes.max() > _MOST_DIGITS or ((letters[starts] == ord("0")) & (sizes > 1)).any():
        return None
    del is_end, stops, starts, sizes
    plain = text if separator != b"," else text.replace(b",", b" ")
    return np.fromstring(plain, np.int64, sep=" ")


def _in_order_of_appearance(flat: npt.NDArray[np.int64]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the different numbers, the first that appears first, and the place of each number among them."""
    labels, first, places = np.unique(flat, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return labels[order], rank[places]
