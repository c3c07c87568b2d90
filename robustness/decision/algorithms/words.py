"""Node sets as 64-bit words inside compiled kernels: counting and finding bits, and how kernels are compiled."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numba.extending import intrinsic

__all__ = ["ONE", "ZERO", "bit_of", "count", "first", "jit", "out_of_line"]

ONE = np.uint64(1)
ZERO = np.uint64(0)

#: Kernels are cached on disk and release the GIL; they divide by nothing that can be zero.
jit = numba.njit(cache=True, nogil=True, error_model="numpy")


def _popcount_code(typing_context: Any, word: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.ctpop(arguments[0])

    return numba.types.uint64(numba.types.uint64), codegen


def _trailing_zeros_code(typing_context: Any, word: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], context.get_constant(numba.types.boolean, 0))

    return numba.types.uint64(numba.types.uint64), codegen


def _out_of_line_code(typing_context: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.function.attributes.add("noinline")
        return context.get_dummy_value()

    return numba.types.void(), codegen


_popcount: Any = intrinsic(_popcount_code)
_trailing_zeros: Any = intrinsic(_trailing_zeros_code)

#: Called in a kernel, it keeps the compiler from copying that kernel into every caller: less to compile.
out_of_line: Any = intrinsic(_out_of_line_code)


@jit
def count(word):  # type: ignore[no-untyped-def]
    """Return the number of bits that are set."""
    return np.int64(_popcount(word))


@jit
def first(word):  # type: ignore[no-untyped-def]
    """Return the place of the lowest bit that is set."""
    return np.int64(_trailing_zeros(word))


@jit
def bit_of(node):  # type: ignore[no-untyped-def]
    """Return the word with the one bit that ``node`` has in its word."""
    return ONE << np.uint64(node & 63)
