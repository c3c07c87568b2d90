"""The journal of a survey: finished rows, one checksummed line each, so that a killed run loses only the row in hand.

A line is 16 hexadecimal digits of the SHA-256 of what follows, a blank, and a JSON object ``{"key": ..., "row": ...}``,
and for a page ``"shown"``, what it shows beside the row. Of two lines with one key the later holds. The key is the
SHA-256 of the network's name, its canonical graph and the question, so a changed file, another gate or another limit is
asked anew. A last line that was cut off is what a kill leaves behind, and is dropped; a damaged line before it is not,
and is refused.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from robustness.digraph import Digraph
from robustness.errors import UnreadableTopology
from robustness.files.text import one_line
from robustness.limits import UNLIMITED
from robustness.surveying.row import Question, Row
from robustness.whole_file import read_at_most

__all__ = ["Journal", "key_of"]

#: What a kill leaves of a journal's first line. A file of other content is never overwritten.
_BEGINNING = re.compile(rb'[0-9a-f]{1,16}|[0-9a-f]{16} (\{("(k(e(y(".*)?)?)?)?)?)?')


def key_of(name: str, graph: Digraph, question: Question) -> str:
    """Return what a row answers, as one digest."""
    asked = json.dumps([name, graph.sha256, question.as_dict()], sort_keys=True)
    return hashlib.sha256(asked.encode()).hexdigest()


class Journal:
    """Rows by key, read from a file when it is opened and appended to it as they are finished.

    Parameters
    ----------
    path : path or None
        None: nothing is remembered.

    Raises
    ------
    UnreadableTopology
        When the file is no journal, or a line before the last is damaged.
    OSError
        When it cannot be read or written.
    """

    def __init__(self, path: Path | None) -> None:
        self._rows: dict[str, tuple[Row, Any]] = {}
        self._stream: IO[bytes] | None = None
        if path is None:
            return
        whole = self._read(path)
        self._stream = open(path, "ab")  # noqa: SIM115 - closed by __exit__
        if whole < self._stream.tell():
            self._stream.truncate(whole)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, tb: TracebackType | None) -> None:
        if self._stream is not None:
            self._stream.close()

    def get(self, key: str) -> tuple[Row | None, Any]:
        """Return the row of an earlier run, and what was to be shown beside it; None for what is not there."""
        return self._rows.get(key, (None, None))

    def add(self, key: str, row: Row, shown: Any = None) -> None:
        """Remember a finished row, and JSON-ready values beside it; they are on the disk when this returns."""
        if self._stream is None:
            return
        content = {"key": key, "row": row.as_dict()} | ({} if shown is None else {"shown": shown})
        text = json.dumps(content, allow_nan=False).encode()
        self._stream.write(_checksum(text) + b" " + text + b"\n")
        self._stream.flush()
        os.fsync(self._stream.fileno())

    def _read(self, path: Path) -> int:
        """Take over what ``path`` holds; return the length of its whole lines."""
        try:
            data = read_at_most(path, UNLIMITED)
        except FileNotFoundError:
            return 0
        whole = 0
        lines = data.splitlines(keepends=True)
        for number, line in enumerate(lines, start=1):
            try:
                if not line.endswith(b"\n"):
                    raise ValueError("cut off")
                checksum, _, text = line[:-1].partition(b" ")
                if checksum != _checksum(text):
                    raise ValueError("its checksum is wrong")
                content = json.loads(text)
                self._rows[content["key"]] = Row.of_dict(content["row"]), content.get("shown")
            except (ValueError, KeyError, TypeError) as problem:
                if number == len(lines) and (number > 1 or _BEGINNING.fullmatch(line)):
                    break
                raise UnreadableTopology(
                    f"{one_line(str(path))}, line {number}: not a line of a survey's journal ({problem}): "
                    "name a new file, or remove the damaged line"
                ) from None
            whole += len(line)
        return whole


def _checksum(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest()[:16].encode()
