"""Writing files whole or not at all, and only where a file may be written."""

from __future__ import annotations

import errno
import os
import re
import stat
import tempfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from robustness.errors import InvalidParameter

__all__ = ["forget_unfinished", "replace_file", "require_different_files", "write_certificate"]


#: Temporary files of writing that goes on.
_unfinished: set[str] = set()


def write_certificate(path: str | os.PathLike[str], data: bytes | Iterable[bytes]) -> None:
    """Do what :func:`replace_file` does, and compress the data by gzip when the name ends in ``.gz``."""
    replace_file(path, _packed(data) if os.fspath(path).endswith(".gz") else data)


def _packed(data: bytes | Iterable[bytes]) -> Iterator[bytes]:
    """Yield data compressed by gzip, without a name and a time: the same data make the same bytes."""
    packer = zlib.compressobj(6, zlib.DEFLATED, 16 + zlib.MAX_WBITS)
    for block in _blocks(data):
        yield packer.compress(block)
    yield packer.flush()


def _blocks(data: bytes | Iterable[bytes]) -> Iterable[bytes]:
    return (data,) if isinstance(data, bytes) else data


def replace_file(path: str | os.PathLike[str], data: bytes | Iterable[bytes]) -> None:
    """Write ``data``, which may come in blocks, to ``path`` whole or not at all.

    A regular file, or none yet: the bytes go to a new file in the same folder, reach the disk, and take the place of
    ``path``. A symbolic link stays, and the file that it leads to is replaced. A device, a pipe or a socket is written
    into and never replaced.

    Raises
    ------
    OSError
        Naming ``path``, when it cannot be written; it is then as it was.
    """
    target = Path(os.path.realpath(path))
    try:
        if _is_special(target):
            with open(target, "wb") as stream:
                stream.writelines(_blocks(data))
        else:
            _replace(target, data)
    except OSError as problem:  # which may name the temporary file
        raise OSError(problem.errno, problem.strerror or str(problem), str(path)) from None


def require_different_files(
    inputs: Iterable[str | os.PathLike[str] | None],
    outputs: Iterable[str | os.PathLike[str] | None],
    *,
    makes_folders: bool = False,
) -> None:
    """Guarantees that no output is an input or another output, before any work is done; None names no file.

    An input ``FILE#3``, one graph of many in a file, is that file. Where an output is to go there is a folder that can
    be written into, or with ``makes_folders`` one can be made.

    Raises
    ------
    InvalidParameter
        When two of them are one file, by whatever names. Devices and pipes may be named twice.
    OSError
        Naming the output, when there is no such folder: work that takes long would be lost.
    """
    seen: dict[str, str] = {}
    for path in inputs:
        if path is not None:
            seen[os.path.realpath(_whole(os.fspath(path)))] = f"the input {os.fspath(path)}"
    for path in outputs:
        if path is None:
            continue
        real = os.path.realpath(path)
        if real in seen and not _is_special(Path(real)):
            raise InvalidParameter(f"the output {os.fspath(path)} is the same file as {seen[real]}: name another file")
        seen[real] = f"the output {os.fspath(path)}"
        if not _is_special(Path(real)):
            _require_folder(path, os.path.dirname(real), makes_folders=makes_folders)


def _require_folder(path: str | os.PathLike[str], folder: str, *, makes_folders: bool) -> None:
    while makes_folders and not os.path.lexists(folder):
        folder = os.path.dirname(folder)
    missing = errno.ENOENT if not os.path.lexists(folder) else errno.ENOTDIR if not os.path.isdir(folder) else 0
    problem = missing or (0 if os.access(folder, os.W_OK | os.X_OK) else errno.EACCES)
    if problem:
        raise OSError(problem, os.strerror(problem), os.fspath(path))


def _whole(source: str) -> str:
    match = re.fullmatch(r"(.+)#\d+", source, re.DOTALL)
    return source if match is None or os.path.lexists(source) else match[1]


def _is_special(target: Path) -> bool:
    """Return whether there is something at ``target`` that is neither a regular file nor a folder."""
    try:
        mode = os.stat(target).st_mode
    except OSError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _replace(target: Path, data: bytes | Iterable[bytes]) -> None:
    if target.is_dir():
        raise IsADirectoryError(21, "Is a directory")
    handle, temporary = tempfile.mkstemp(prefix=f".{target.name[:64]}.", dir=target.parent)
    _unfinished.add(temporary)
    try:
        with open(handle, "wb") as stream:
            stream.writelines(_blocks(data))
            os.fchmod(stream.fileno(), _permissions(target))
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(temporary, target)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise
    finally:
        _unfinished.discard(temporary)


def forget_unfinished() -> None:
    """Remove what other threads have begun to write: for a process that ends while they work."""
    for temporary in list(_unfinished):
        with suppress(OSError):
            os.unlink(temporary)


def _permissions(target: Path) -> int:
    """Return the permissions of the file that is replaced, or those that a new file would get."""
    with suppress(OSError):
        return stat.S_IMODE(os.stat(target).st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
