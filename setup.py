"""Compile the kernels in robustness/kernels to machine code, where the machine has a C compiler.

The packages are named here, and everything else about the distribution is in pyproject.toml. An extension is optional:
without a compiler the same sources run as plain Python, slower.
"""

from __future__ import annotations

import runpy
import shutil
from pathlib import Path
from typing import Any

from Cython.Build import cythonize
from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

FOLDER = Path("robustness/kernels")
#: The digest of all sources; robustness.kernels compares it with the sources that lie beside the machine code.
DIGEST = runpy.run_path(str(FOLDER / "sources.py"))["digest"](FOLDER)

DIRECTIVES = {
    "language_level": "3",
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
    "nonecheck": False,
    "embedsignature": True,
}


class BuildKernels(build_ext):
    """Choose the flags by the compiler: fast integers, and floating point exactly as written."""

    def build_extension(self, ext: Any) -> None:
        """Compile one kernel."""
        if self.compiler.compiler_type == "msvc":
            ext.extra_compile_args = ["/O2", "/fp:precise"]
        else:
            ext.extra_compile_args = ["-O3", "-ffp-contract=off", "-fno-math-errno"]
            if self.plat_name.endswith(("x86_64", "amd64")):
                ext.extra_compile_args.append("-mpopcnt")
        super().build_extension(ext)


class BuildSources(build_py):
    """Begin with an empty folder, so that no module that is gone comes back from the build before."""

    def run(self) -> None:
        """Copy the sources."""
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()


KERNELS = [
    Extension(
        f"robustness.kernels.{source.stem}",
        [str(source.with_suffix(".py"))],
        define_macros=[("ROBUSTNESS_SOURCES", f'"{DIGEST}"')],
        # Each holds the digest of all, and code of those it calls.
        depends=[str(path) for path in sorted([*FOLDER.glob("*.py"), *FOLDER.glob("*.pxd")])],
        optional=True,
    )
    for source in sorted(FOLDER.glob("*.pxd"))
    if source.with_suffix(".py").stem != "words"
]

# docs/adr/0005: the folder cli is installed under a name that nobody else's package can take.
setup(
    packages=[*find_packages(include=["robustness*", "certificates*"]), "robustness.cli"],
    package_dir={"robustness.cli": "cli"},
    ext_modules=cythonize(KERNELS, build_dir="build/cython", compiler_directives=DIRECTIVES, quiet=True),
    cmdclass={"build_ext": BuildKernels, "build_py": BuildSources},
)
