"""The compiled loops of the toolkit: one rule, one source, two ways to run it.

The modules here are plain Python with types beside them (``.pxd``). ``setup.py`` compiles them ahead of time to machine
code that releases the interpreter's lock; nothing is compiled where the toolkit is used. Where no machine code lies
beside a source, or other machine code than that source gives (a ``git pull`` without ``make``, half an upgrade, a
processor it was not made for), the sources run as they are: some hundred times slower, with the same answers.

:data:`IS_COMPILED` tells which it is and :data:`WHY_NOT` the reason. With the environment variable
``ROBUSTNESS_KERNELS=interpreted`` the sources are run in any case.

A machine without a compiler can install a wheel that was made on another (docs/deploying.md).
"""

from __future__ import annotations

import importlib
import importlib.machinery
import importlib.util
import os
import platform
import sys
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from types import ModuleType

from robustness.kernels import sources

__all__ = ["IS_COMPILED", "WHY_NOT"]

_FOLDER = Path(__file__).parent


class _SourcesOnly:
    """A finder that gives the sources of this folder, whatever else lies beside them."""

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the source of a kernel, or None for every other module."""
        package, _, last = name.rpartition(".")
        source = _FOLDER / f"{last}.py"
        if package != __name__ or not source.is_file():
            return None
        loader = importlib.machinery.SourceFileLoader(name, str(source))
        return importlib.util.spec_from_file_location(name, source, loader=loader)


def _why_not() -> str:
    """Import the machine code of every kernel; return why it may not be used, or nothing."""
    if os.environ.get("ROBUSTNESS_KERNELS") == "interpreted":
        return "ROBUSTNESS_KERNELS=interpreted"
    if platform.machine().lower() in ("x86_64", "amd64") and not _counts_bits():
        return "this processor has no instruction that counts bits"
    digest = sources.digest(_FOLDER)
    for path in sorted(_FOLDER.glob("*.pxd")):
        if path.stem == "words":
            continue
        try:
            module = importlib.import_module(f"{__name__}.{path.stem}")
        except (ImportError, TypeError, ValueError) as problem:
            # TypeError and ValueError: half an upgrade, in which the types of two files do not fit each other.
            return f"the machine code of {path.stem} cannot be loaded ({problem})"
        if str(module.__file__).endswith(".py"):
            return f"{path.stem} has no machine code: it was installed without a C compiler"
        if getattr(module, "built_from", None) != digest:
            return f"the machine code of {path.stem} was made from other sources: run 'make' or 'pip install .' again"
    return ""


def _counts_bits() -> bool:
    with suppress(OSError):
        return "popcnt" in Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    return True


#: Why the kernels run as plain Python; empty when they do not.
WHY_NOT: str = _why_not()

#: Whether the kernels are machine code.
IS_COMPILED: bool = not WHY_NOT

if "cannot be loaded" in WHY_NOT or "other sources" in WHY_NOT:
    # What was installed for speed is not what runs. Without a compiler, or as asked for, nothing is amiss.
    warnings.warn(f"slow: {WHY_NOT}; the kernels run as plain Python, with the same answers", stacklevel=2)

if WHY_NOT:
    for _name in [name for name in sys.modules if name.startswith(f"{__name__}.") and name != sources.__name__]:
        del sys.modules[_name]
    sys.meta_path.insert(0, _SourcesOnly)
