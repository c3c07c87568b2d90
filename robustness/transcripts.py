"""Transcripts of long searches, kept on disk: compressed, in pieces as they come, read in the order of the proof."""

from __future__ import annotations

import os
import tempfile
import threading
import weakref
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

__all__ = ["Branch", "Piece", "Spool", "Transcript"]

#: Bytes that stay in memory before there is a file.
_IN_MEMORY = 2**20

#: Bytes that are unpacked at a time.
_BLOCK = 2**16


class Spool:
    """Where pieces are kept: an unnamed file, in the folder for temporary files (``TMPDIR``), of any number of threads.

    It is gone with the last piece.
    """

    def __init__(self) -> None:
        self._file = tempfile.SpooledTemporaryFile(_IN_MEMORY)  # noqa: SIM115 - closed when nobody needs it
        self._lock = threading.Lock()
        weakref.finalize(self, self._file.close)

    def keep(self, data: bytes) -> Piece:
        """Keep a piece."""
        return self.keep_packed(zlib.compress(data, 1), len(data))

    def keep_packed(self, packed: bytes, size: int) -> Piece:
        """Keep a piece of ``size`` bytes that is compressed by zlib."""
        with self._lock:
            self._file.seek(0, os.SEEK_END)
            place = self._file.tell()
            try:
                self._file.write(packed)
            except OSError as problem:
                raise OSError(problem.errno, f"{problem.strerror} (TMPDIR)", tempfile.gettempdir()) from None
        return Piece(self, place, len(packed), size)

    def read(self, place: int, count: int) -> bytes:
        """Return bytes as they are kept."""
        with self._lock:
            self._file.seek(place)
            return self._file.read(count)


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Some bytes of a transcript: where they are kept, compressed to ``packed`` bytes, and how many they are."""

    spool: Spool
    place: int
    packed: int
    size: int

    def __iter__(self) -> Iterator[bytes]:
        """Yield the bytes, unpacked, in blocks."""
        unpacker = zlib.decompressobj()
        for place in range(self.place, self.place + self.packed, _BLOCK):
            data = self.spool.read(place, min(_BLOCK, self.place + self.packed - place))
            while data:
                yield unpacker.decompress(data, _BLOCK)
                data = unpacker.unconsumed_tail
        yield unpacker.flush()


class Branch(Protocol):
    """A part of a search: its transcript is that of its parts, in this order."""

    @property
    def is_tree(self) -> bool:
        """Whether it is all that one state stands for: one tree of the proof."""

    @property
    def parts(self) -> Sequence[Piece | Branch]:
        """Pieces, and what was handed on."""


class Transcript:
    """The transcript of a complete search, ``root`` being the whole of it: read in blocks, with a length.

    Attributes
    ----------
    trees : list of (int, int)
        Where in it each branch that is one tree begins, and its length.
    """

    def __init__(self, root: Branch) -> None:
        self.pieces: list[Piece] = []
        self.trees: list[tuple[int, int]] = []
        place = 0
        waiting: list[Piece | Branch | int] = [root]
        while waiting:
            part = waiting.pop()
            if isinstance(part, int):  # where a tree began whose parts have all been seen
                self.trees.append((part, place - part))
            elif isinstance(part, Piece):
                self.pieces.append(part)
                place += part.size
            else:
                if part.is_tree:
                    waiting.append(place)
                waiting.extend(reversed(part.parts))

    def __reduce__(self) -> tuple[Callable[[bytes], Transcript], tuple[bytes]]:
        return _restored, (bytes(self),)

    def __len__(self) -> int:
        return sum(piece.size for piece in self.pieces)

    def __iter__(self) -> Iterator[bytes]:
        for piece in self.pieces:
            yield from piece

    def __bytes__(self) -> bytes:
        return b"".join(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Transcript) and len(self) == len(other) and bytes(self) == bytes(other)

    def __hash__(self) -> int:
        return hash(bytes(self))


@dataclass(frozen=True, slots=True)
class _Whole:
    """A search that came in one piece."""

    parts: tuple[Piece]
    is_tree: bool = False


def _restored(data: bytes) -> Transcript:
    return Transcript(_Whole((Spool().keep(data),)))
