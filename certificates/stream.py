"""The bytes of a certificate, read forward once: of what has been read nothing is kept."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from certificates.errors import MalformedCertificate, Misuse

__all__ = ["MAX_CERTIFICATE_BYTES", "MAX_HEADER_BYTES", "Blocks", "Stream"]

#: Bytes of a certificate, and of its first line, that are read at most.
MAX_CERTIFICATE_BYTES = 2**30
MAX_HEADER_BYTES = 2**26

#: Bytes of a tree that is listed at least.
_LEAST_TREE = 2**12

#: How a certificate is handed in: whole, or in pieces of any size, which are asked for as they are needed.
Blocks = bytes | Iterable[bytes]


class Stream:
    """A place in a certificate. ``place`` counts from the beginning, and anew from the end of a line that was taken."""

    def __init__(self, data: Blocks) -> None:
        given: object = data
        if isinstance(given, bytes | str) or not isinstance(given, Iterable):
            given = (given,)  # what is no bytes is refused as it comes
        self._blocks: Iterator[object] = iter(given)
        #: For each tree that a share is responsible for, by the place where it begins: its length, and whether that
        #: share is this one. Empty but for :mod:`certificates.shares`.
        self.share: dict[int, tuple[int, bool]] = {}
        #: Tree nodes in the trees of this share, and looks at nodes that they took; ``looks``: of all that it walked.
        self.own_nodes = self.own_looks = self.looks = 0
        #: Beginnings and lengths of trees that were walked through, for those who list them; short ones are left out.
        self.trees: list[tuple[int, int]] | None = None
        self._block = b""
        self._at = self._before = self._total = 0

    @classmethod
    def of(cls, data: Blocks | Stream) -> Stream:
        """Return the stream of a certificate, or the stream itself."""
        return data if isinstance(data, Stream) else cls(data)

    @classmethod
    def whole(cls, data: Blocks | Stream) -> Stream:
        """Return the same, of which no part is left to others."""
        stream = cls.of(data)
        if stream.share:
            raise Misuse("a share of a certificate is verified by certificates.shares alone")
        return stream

    def __iter__(self) -> Iterator[bytes]:
        """Take what is left, in pieces."""
        while not self.is_over():
            yield self._take(len(self._block))

    @property
    def place(self) -> int:
        """How many bytes have been taken."""
        return self._before + self._at

    def peek(self) -> int:
        """Return the byte that comes next, or -1 at the end."""
        try:
            return self._block[self._at]
        except IndexError:
            return -1 if self.is_over() else self._block[self._at]

    def next(self) -> int:
        """Take the byte that comes next, or -1 at the end."""
        byte = self.peek()
        self._at += byte >= 0
        return byte

    def is_over(self) -> bool:
        """Return whether nothing comes any more."""
        while self._at == len(self._block):
            block = next(self._blocks, self)
            if block is self:
                return True
            self._before, self._at, self._block = self.place, 0, self._checked(block)
        return False

    def skip(self, count: int) -> None:
        """Pass over so many bytes, or to the end."""
        while count and not self.is_over():
            count -= len(self._take(self._at + count))

    def note(self, start: int) -> None:
        """List a tree that ends here, if trees are listed."""
        if self.trees is not None and self.place - start >= _LEAST_TREE:
            self.trees.append((start, self.place - start))

    def rest(self) -> bytes:
        """Take all that is left, whole."""
        return b"".join(self)

    def left(self) -> int:
        """Take all that is left, and return how many bytes that was."""
        return sum(map(len, self))

    def line(self, *, take: bool = True) -> bytes:
        """Return the first line without its newline, and take it unless ``take`` is false."""
        parts: list[bytes] = []
        begin = self.place
        while not self.is_over() and self.place - begin < MAX_HEADER_BYTES:
            parts.append(self._take(len(self._block)))
            if b"\n" in parts[-1]:
                break
        self._block = b"".join(parts)
        end = self._block.find(b"\n", 0, MAX_HEADER_BYTES)
        if end < 0:
            raise MalformedCertificate("a certificate begins with one line of JSON that ends with a newline")
        self._at = end + 1 if take else 0
        self._before = -self._at
        return self._block[:end]

    def _take(self, end: int) -> bytes:
        """Take the rest of the block up to ``end``."""
        start, self._at = self._at, min(end, len(self._block))
        return self._block[start : self._at]

    def _checked(self, block: object) -> bytes:
        if not isinstance(block, bytes):
            raise Misuse("a verifier takes two bytes objects (the certificate may be an iterable of such)")
        self._total += len(block)
        if self._total > MAX_CERTIFICATE_BYTES:
            raise MalformedCertificate(f"a certificate has at most {MAX_CERTIFICATE_BYTES} bytes")
        return block
