"""Reading the whole of a small file that a user names, without waiting for what may never come."""

from __future__ import annotations

import errno
import os

from certificates.file_bytes import read_at_most

__all__ = ["read_at_most", "read_text"]

#: Bytes; no file of text that the toolkit writes beside graphs and certificates comes near it.
_MOST_TEXT = 256 * 2**20


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
