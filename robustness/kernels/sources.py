"""The digest of the kernels' sources, which ties machine code to what it was made from."""

from __future__ import annotations

import hashlib
from pathlib import Path

__all__ = ["digest"]


def digest(folder: Path) -> str:
    """Return the SHA-256 of every source in ``folder``, names and contents, in hexadecimal.

    All of them, not one by one: a kernel holds the machine code of those it calls.
    """
    total = hashlib.sha256()
    for path in sorted([*folder.glob("*.py"), *folder.glob("*.pxd")]):
        content = path.read_bytes()
        total.update(f"{path.name} {len(content)}\n".encode())
        total.update(content)
    return total.hexdigest()
