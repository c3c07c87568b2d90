"""What a graph can be asked for: small frozen properties, each with an exact test and a textual form.

A property is about an unlabelled graph: relabelling the nodes never changes the answer. ``holds`` is the definition;
the searches never say FOUND before ``holds`` has agreed for every property asked for.

==================  ========================================  =================================================
class               text                                      holds when
==================  ========================================  =================================================
``RRobust(r)``      ``2-robust``                              r-robust
``RSRobust(r, s)``  ``(2,2)-robust``                          (r,s)-robust
``Connected(k)``    ``3-connected``                           vertex connectivity at least k (digraphs: strong)
``HasTrap(f)``      ``trap(1)``                               a trap for f exists
``InDegree(...)``   ``min-degree>=3``, ``max-degree<=4``      every in-degree lies in the range
``Edges(...)``      ``edges<=12``, ``edges>=8``, ``edges=9``  the number of edges (digraphs: arcs) does
==================  ========================================  =================================================

``regular(k)``, text ``4-regular``, is ``InDegree(k, k)``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from robustness.connectivity import smallest_separation
from robustness.decision.front import check_rs_robustness
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.limits import UNBOUNDED, Limits
from robustness.results import Verdict
from robustness.spelled import robust
from robustness.traps.smallest import smallest_trap

__all__ = [
    "Connected",
    "Edges",
    "HasTrap",
    "InDegree",
    "Property",
    "RRobust",
    "RSRobust",
    "parse_property",
    "regular",
]


@runtime_checkable
class Property(Protocol):
    """Something that a graph has or has not, whatever its labels."""

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Return whether ``graph`` has it; raise :class:`Undecided` when ``limits`` come first."""


@dataclass(frozen=True, slots=True)
class RSRobust:
    """(r,s)-robust. A graph with fewer than s nodes is not: s lies in 1..n."""

    r: int
    s: int = 1

    def __post_init__(self) -> None:
        _require_at_least("r", self.r, 0)
        _require_at_least("s", self.s, 1)

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Decide it by the exact algorithms."""
        if self.s > max(graph.n, 1):
            return False
        result = check_rs_robustness(graph, self.r, self.s, **_started(limits).keywords())
        if result.verdict is Verdict.UNDECIDED:
            raise Undecided(f"whether a graph is {self} was not decided: raise the time limit")
        return result.verdict is Verdict.ROBUST

    def __str__(self) -> str:
        return robust(self.r, self.s)


def RRobust(r: int) -> RSRobust:
    """Return the property r-robust, which is (r,1)-robust.

    >>> str(RRobust(2))
    '2-robust'
    """
    return RSRobust(r, 1)


@dataclass(frozen=True, slots=True)
class HasTrap:
    """A trap for f exists; see :mod:`robustness.traps.question`."""

    f: int

    def __post_init__(self) -> None:
        _require_at_least("f", self.f, 0)

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Decide it by removing every set of at most f nodes."""
        return smallest_trap(graph, self.f, **_started(limits).spread_over().keywords()) is not None

    def __str__(self) -> str:
        return f"trap({self.f})"


@dataclass(frozen=True, slots=True)
class Connected:
    """Vertex connectivity at least k: more than k nodes, and connected (digraphs: strongly) without any k - 1 of them.

    K_n is (n-1)-connected and no more. Every graph is 0-connected.
    """

    k: int

    def __post_init__(self) -> None:
        _require_at_least("k", self.k, 0)

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Decide it by removing every set of fewer than k nodes."""
        return self.k == 0 or (graph.n > self.k and smallest_separation(graph, self.k) is None)

    def __str__(self) -> str:
        return f"{self.k}-connected"


@dataclass(frozen=True, slots=True)
class _Range:
    """Numbers of at least ``least`` and at most ``most`` (None: no limit)."""

    least: int = 0
    most: int | None = None

    def __post_init__(self) -> None:
        _require_at_least("least", self.least, 0)
        if self.most is not None:
            _require_at_least("most", self.most, self.least)

    def has(self, number: int) -> bool:
        """Return whether the number is in the range."""
        return self.least <= number and (self.most is None or number <= self.most)

    def told(self, low: str, high: str) -> str:
        """Return the bounds in text, each after its own word."""
        parts = [f"{low}>={self.least}"] if self.least > 0 or self.most is None else []
        return " and ".join([*parts, f"{high}<={self.most}"] if self.most is not None else parts)


@dataclass(frozen=True, slots=True)
class InDegree(_Range):
    """Every in-degree is at least ``least`` and at most ``most`` (None: no limit)."""

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Look at every in-degree."""
        return all(map(self.has, graph.in_degrees.tolist()))

    def __str__(self) -> str:
        if self.most == self.least:
            return f"{self.least}-regular"
        return self.told("min-degree", "max-degree")


def regular(k: int) -> InDegree:
    """Return the property that every in-degree is k.

    >>> str(regular(4))
    '4-regular'
    """
    return InDegree(k, k)


@dataclass(frozen=True, slots=True)
class Edges(_Range):
    """At least ``least`` and at most ``most`` edges (None: no limit); arcs, for a directed graph."""

    def holds(self, graph: Digraph, limits: Limits = UNBOUNDED) -> bool:
        """Decide it by counting the edges (arcs)."""
        return self.has(graph.arc_count if graph.directed else graph.arc_count // 2)

    def __str__(self) -> str:
        if self.most == self.least:
            return f"edges={self.least}"
        return self.told("edges", "edges")


def parse_property(text: str) -> Property:
    """Return the property that ``text`` spells; see the table of this module.

    Raises
    ------
    InvalidParameter
        When it spells none.

    >>> parse_property("(2,2)-robust")
    RSRobust(r=2, s=2)
    """
    compact = text.replace(" ", "").lower()
    patterns: dict[str, Callable[..., Property]] = {
        r"(\d+)-robust": lambda r: RSRobust(r),
        r"\((\d+),(\d+)\)-robust": RSRobust,
        r"(\d+)-connected": Connected,
        r"(\d+)-regular": regular,
        r"trap\((\d+)\)": HasTrap,
        r"min-degree>=(\d+)": InDegree,
        r"max-degree<=(\d+)": lambda most: InDegree(0, most),
        r"edges>=(\d+)": Edges,
        r"edges<=(\d+)": lambda most: Edges(0, most),
        r"edges=(\d+)": lambda count: Edges(count, count),
    }
    for pattern, make in patterns.items():
        if (match := re.fullmatch(pattern, compact)) is not None:
            return make(*map(int, match.groups()))
    raise InvalidParameter(
        "a property is written 2-robust, (2,2)-robust, 3-connected, 4-regular, trap(1), min-degree>=3, "
        f"max-degree<=4, edges<=12, edges>=8 or edges=9, not {text!r}"
    )


def _require_at_least(name: str, value: int, least: int) -> None:
    if type(value) is not int or value < least:
        raise InvalidParameter(f"{name} is an integer of at least {least}, not {value!r}")


def _started(limits: Limits) -> Limits:
    """Return the limits unless they are over already; then nothing is decided."""
    if limits.expired():
        raise Undecided("the time limit was reached")
    return limits
