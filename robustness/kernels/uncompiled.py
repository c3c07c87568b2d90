"""What a kernel's source needs of Cython when it runs as plain Python on a machine without Cython."""

from __future__ import annotations

import contextlib

__all__ = ["compiled", "nogil"]

#: Whether this is machine code.
compiled = False

#: Where machine code lets other threads run.
nogil = contextlib.nullcontext()
