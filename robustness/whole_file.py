"""Reading the whole of a small file that a user names, without waiting for what may never come."""

from __future__ import annotations

import errno
import os
import stat

__all__ = ["read_at_most", "read_text"]

#: Bytes; no file of text that the toolkit writes beside graphs and certificates comes near it.
_MOST_TEXT = 256 * 2**20


def read_at_most(path: str | os.PathLike[str], limit: int) -> bytes:
    """Return the bytes of a file, or somewhat more than ``limit`` of them: enough for the reader to refuse it.

    A pipe is read to its end, as after ``<(command)`` in a shell; a named pipe that nobody writes to is not waited for.

    Raises
    ------
    OSError
        When it cannot be read, or is such a pipe, a terminal or another device.
    """
    at_once = getattr(os, "O_NONBLOCK", 0)  # a named pipe is opened although nobody writes
    data = bytearray()
    with open(path, "rb", buffering=0, opener=lambda name, flags: os.open(name, flags | at_once)) as stream:
        kind = os.fstat(stream.fileno()).st_mode
        if stat.S_ISCHR(kind) or stat.S_ISBLK(kind):
            raise OSError(errno.EINVAL, "is a device, not a file", os.fspath(path))
        if at_once:
            os.set_blocking(stream.fileno(), True)
        while len(data) <= limit and (block := stream.read(2**20)):
            data += block
    if not data and stat.S_ISFIFO(kind):
        raise OSError(errno.EINVAL, "is a pipe that nobody writes to", os.fspath(path))
    return bytes(data)


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a UTF-8 file; see :func:`read_at_most`.

    Raises
    ------
    OSError
        When it cannot be read, or has more than 256 MiB.
    UnicodeDecodeError
        When it is no UTF-8.
    """
    data = read_at_most(path, _MOST_TEXT)
    if len(data) > _MOST_TEXT:
        raise OSError(errno.EFBIG, f"is larger than {_MOST_TEXT} bytes, the most that is read", os.fspath(path))
    return data.decode("utf-8")
