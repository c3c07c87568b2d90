"""Reading the whole of a file that a user names, without waiting for what may never come."""

from __future__ import annotations

import errno
import os
import stat

__all__ = ["read_at_most"]


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
