"""Every error this package raises on purpose.

::

    RobustnessError (Exception)
    ├── InvalidGraph (also ValueError)       the input is not a graph the definitions speak about
    ├── InvalidParameter (also ValueError)   r, s, f, a limit or an option is out of range
    ├── UnreadableTopology (also ValueError) a file or a name does not yield a graph
    │   ├── AmbiguousTopology                a text may be a matrix, and may be a list of links
    │   └── MissingTopology (also FileNotFoundError) there is no file of this name
    ├── MissingExtra (also ImportError)      an optional package is not installed
    ├── Undecided                            a limit stopped the search; nothing is claimed
    └── InternalError (also RuntimeError)    an algorithm contradicted itself; a bug, never a verdict

A message names the rule, the value and the fix, in one line. A network that is not robust is an
answer, not an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = [
    "AmbiguousTopology",
    "InternalError",
    "InvalidGraph",
    "InvalidParameter",
    "MissingExtra",
    "MissingTopology",
    "RobustnessError",
    "Undecided",
    "UnreadableTopology",
]


class RobustnessError(Exception):
    """Base of every error in this package."""


class InvalidGraph(RobustnessError, ValueError):
    """The input is not a graph the definitions speak about."""


class InvalidParameter(RobustnessError, ValueError):
    """A parameter is out of its range."""


class UnreadableTopology(RobustnessError, ValueError):
    """A file, a stream or a name does not yield a graph."""


class AmbiguousTopology(UnreadableTopology):
    """A text may be a matrix, and may be a list of links."""


class MissingTopology(UnreadableTopology, FileNotFoundError):
    """There is no file of this name."""

    def __str__(self) -> str:
        return str(self.args[0])


class MissingExtra(RobustnessError, ImportError):
    """An optional package that this call needs is not installed."""


class Undecided(RobustnessError):
    """A limit stopped the search before the question was decided; nothing is claimed beyond what is proven here.

    It is no TimeoutError, which is an OSError, so that nobody who catches trouble with files catches it.

    Attributes
    ----------
    bounds : robustness.results.Bounds or None
        What is proven about the number that was asked for.
    profile : mapping or None
        The part of a robustness profile that is proven.
    """

    def __init__(self, message: str, *, bounds: Any = None, profile: Mapping[int, int] | None = None) -> None:
        super().__init__(message)
        self.bounds = bounds
        self.profile = profile


class InternalError(RobustnessError, RuntimeError):
    """An algorithm contradicted itself. This is a bug; no verdict was produced."""
