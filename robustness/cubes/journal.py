"""The journal of cubes: what is closed, one checksummed line each, so that a killed run loses only the slices in hand.

A line is 16 hexadecimal digits of the SHA-256 of what follows, a blank, and a JSON object. The first line names the
format. Every other line has the ``question`` it belongs to (a digest of the graph, r, s, the switches and the version
of the search), the ``cube`` it is about, and what came of it: the cubes that are ``rest`` (none: it is closed) with the
``transcript`` before them, or the violating ``pair``. A cube is named by a digest of what it is, so a line is
true wherever it stands, on whatever machine it is read, and in whatever order lines were written.

A last line that was cut off is what a kill leaves behind, and is dropped; a damaged line before it is refused.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import time
import zlib
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from robustness.cubes.cube import Cube
from robustness.cubes.heard import MOST
from robustness.errors import InvalidParameter
from robustness.transcripts import Spool

__all__ = ["CubeJournal", "Entry"]

_FORMAT = "robustness/cubes/1"

#: Seconds between two times at which the disk itself is waited for.
_SYNC = 1.0

#: What is known of a cube: as :func:`robustness.cubes.solving.solve` returns it, with ``rest`` a list of cubes,
#: and with ``piece``, where its transcript is kept, for ``transcript``.
Entry = dict[str, Any]


class CubeJournal:
    """Entries of one question by the keys of their cubes, read when it is opened and appended as they come.

    Parameters
    ----------
    path : path or None
        None: nothing is remembered.
    question : str
        The digest of what is asked.
    words : int
        Of a row of a state.

    Raises
    ------
    InvalidParameter
        When the file is no journal of cubes, or no regular file, a line before the last is damaged, or another run
        writes to it.
    OSError
        When it cannot be read or written.
    """

    def __init__(self, path: Path | None, question: str, words: int) -> None:
        self.entries: dict[str, Entry] = {}
        self.spool = Spool()
        self._question, self._words = question, words
        self._stream: IO[bytes] | None = None
        self._path = path
        self._synced = time.monotonic()
        if path is None:
            return
        if path.exists() and not path.is_file():
            raise InvalidParameter(f"{path} is no regular file, and a journal is one: name another file")
        self._stream = open(path, "a+b")  # noqa: SIM115 - closed by __exit__
        try:
            _lock(self._stream, path)
            self._stream.truncate(self._read(path))
            if not self._stream.tell():
                self._append({"format": _FORMAT})
        except BaseException:
            with suppress(OSError):
                self._stream.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, tb: TracebackType | None) -> None:
        if self._stream is not None:
            with suppress(OSError):  # of a full disk it has been told
                self._stream.flush()
                os.fsync(self._stream.fileno())
            with suppress(OSError):
                self._stream.close()

    def remember(self, cube: Cube, entry: Entry, transcript: bytes) -> None:
        """Append what came of a cube; it is in the hands of the system when this returns."""
        if self._stream is None:
            return
        line: dict[str, Any] = {
            "question": self._question,
            "cube": cube.key,
            "nodes": entry["nodes"],
            "transcript": base64.b64encode(transcript).decode("ascii"),
            "rest": [
                (base64.b64encode(data).decode("ascii"), flags) for data, flags in map(Cube.to_wire, entry["rest"])
            ],
        }
        if "pair" in entry:
            line["pair"] = entry["pair"]
        self._append(line)

    def _append(self, content: dict[str, Any]) -> None:
        if self._stream is None:
            return
        text = json.dumps(content, separators=(",", ":")).encode("ascii")
        try:
            self._stream.write(_checksum(text) + b" " + text + b"\n")
            self._stream.flush()
            if time.monotonic() - self._synced > _SYNC:
                os.fsync(self._stream.fileno())
                self._synced = time.monotonic()
        except OSError as problem:  # which does not say of which file
            raise OSError(problem.errno, problem.strerror or str(problem), str(self._path)) from None

    def _read(self, path: Path) -> int:
        """Read all whole lines; return where they end."""
        if self._stream is None:
            return 0
        self._stream.seek(0)
        ends, number = 0, 0
        for number, line in enumerate(self._stream, 1):
            checksum, _, text = line.rstrip(b"\n").partition(b" ")
            is_whole = line.endswith(b"\n") and checksum == _checksum(text)
            if not is_whole and not line.endswith(b"\n") and number > 1:
                break
            content = _object(text) if is_whole else None
            if number == 1 and (content or {}).get("format") != _FORMAT:
                raise InvalidParameter(
                    f"{path} is no journal of cubes: name another file, or one that is not there yet"
                )
            if content is None or not self._is_taken(content):
                raise InvalidParameter(
                    f"{path}, line {number}: damaged; delete this line to go on without what it says"
                )
            ends += len(line)
        return ends

    def _is_taken(self, content: dict[str, Any]) -> bool:
        """Take what a line says if it is about the question; return False for a line that makes no sense."""
        if content.get("question") == self._question:
            try:
                self._take(content)
            except (KeyError, TypeError, ValueError, OverflowError, zlib.error):
                return False
        return True

    def _take(self, content: dict[str, Any]) -> None:
        rest = [Cube.from_wire((base64.b64decode(data), flags), self._words) for data, flags in content["rest"]]
        packed = base64.b64decode(content["transcript"])
        nodes = int(content["nodes"])
        if not 0 <= nodes < MOST:
            raise ValueError(f"nodes are counted, not {nodes}")
        piece = self.spool.keep_packed(packed, len(zlib.decompress(packed))) if packed else None
        entry: Entry = {"nodes": nodes, "piece": piece, "rest": rest}
        if "pair" in content:
            first, second = content["pair"]
            entry["pair"] = [int(i) for i in first], [int(i) for i in second]
        self.entries.setdefault(str(content["cube"]), entry)


def _object(text: bytes) -> dict[str, Any] | None:
    """Return a JSON object, or None for anything else."""
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return content if isinstance(content, dict) else None


def _checksum(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest()[:16].encode("ascii")


def _lock(stream: IO[bytes], path: Path) -> None:
    """Keep a second run from writing to the same file, where the system can."""
    try:
        import fcntl
    except ImportError:  # not on this system
        return
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as taken:
        raise InvalidParameter(f"{path} is in use by another run: wait for it, or name another file") from taken
