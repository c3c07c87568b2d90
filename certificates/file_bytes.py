"""Reading a file that a user names, without waiting for what may never come, and unpacking it when it is compressed."""

from __future__ import annotations

import errno
import os
import stat
import zlib
from collections.abc import Callable, Iterator

from certificates.errors import MalformedCertificate
from certificates.stream import MAX_CERTIFICATE_BYTES

__all__ = ["certificate_blocks", "file_blocks", "read_at_most"]

#: Bytes that are read, and unpacked, at a time.
_BLOCK = 2**16

_GZIP = b"\x1f\x8b"


def file_blocks(path: str | os.PathLike[str], told: Callable[[int, int], object] | None = None) -> Iterator[bytes]:
    """Yield the bytes of a file, none of them empty.

    A pipe is read to its end, as after ``<(command)`` in a shell; a named pipe that nobody writes to is not waited for.

    Parameters
    ----------
    path : path
    told : callable, optional
        Called before every block with the bytes read so far, and those of the file (0 for a pipe).

    Raises
    ------
    OSError
        When it cannot be read, or is such a pipe, a terminal or another device.
    """
    at_once = getattr(os, "O_NONBLOCK", 0)  # a named pipe is opened although nobody writes
    with open(path, "rb", buffering=0, opener=lambda name, flags: os.open(name, flags | at_once)) as stream:
        found = os.fstat(stream.fileno())
        if stat.S_ISCHR(found.st_mode) or stat.S_ISBLK(found.st_mode):
            raise OSError(errno.EINVAL, "is a device, not a file", os.fspath(path))
        if at_once:
            os.set_blocking(stream.fileno(), True)
        count = 0
        while block := stream.read(_BLOCK):
            if told is not None:
                told(count, found.st_size)
            count += len(block)
            yield block
    if not count and stat.S_ISFIFO(found.st_mode):
        raise OSError(errno.EINVAL, "is a pipe that nobody writes to", os.fspath(path))


def read_at_most(path: str | os.PathLike[str], limit: int) -> bytes:
    """Return the bytes of a file, or somewhat more than ``limit`` of them: enough for the reader to refuse it.

    Raises
    ------
    OSError
        As :func:`file_blocks` does.
    """
    data = bytearray()
    for block in file_blocks(path):
        data += block
        if len(data) > limit:
            break
    return bytes(data)


def certificate_blocks(
    path: str | os.PathLike[str], told: Callable[[int, int], object] | None = None
) -> Iterator[bytes]:
    """Yield the bytes of a certificate in a file, unpacked when the file is compressed by gzip, whatever its name.

    Never more than 64 KiB are unpacked at a time, so that the limits of the verifiers, who ask for what they read, hold
    for what is unpacked; the packed bytes have the same limit.

    Raises
    ------
    OSError
        As :func:`file_blocks` does.
    MalformedCertificate
        When what is compressed is damaged, incomplete or too long.
    """
    blocks = file_blocks(path, told)
    first = next(blocks, b"")
    while len(first) == 1 and (more := next(blocks, b"")):
        first += more
    if not first.startswith(_GZIP):
        yield first
        yield from blocks
        return
    unpacker = zlib.decompressobj(16 + zlib.MAX_WBITS)  # of gzip, with its check sums
    count, packed = 0, first
    while packed:
        count += len(packed)
        if count > MAX_CERTIFICATE_BYTES:
            raise MalformedCertificate(f"a compressed certificate has at most {MAX_CERTIFICATE_BYTES} bytes")
        while packed:
            if unpacker.eof:  # one file after the other is one file, for gzip
                unpacker = zlib.decompressobj(16 + zlib.MAX_WBITS)
            try:
                yield unpacker.decompress(packed, _BLOCK)
            except zlib.error as problem:
                raise MalformedCertificate(f"the compressed certificate is damaged: {problem}") from None
            packed = unpacker.unused_data if unpacker.eof else unpacker.unconsumed_tail
        packed = next(blocks, b"")
    if not unpacker.eof:
        raise MalformedCertificate("the compressed certificate ends too soon")
