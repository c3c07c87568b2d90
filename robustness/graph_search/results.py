"""What a search for a graph is answered with."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from robustness.showing import Shown
from robustness.spelled import counted

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["FindResult", "FindVerdict"]


class FindVerdict(enum.Enum):
    """The answer of a search for a graph."""

    FOUND = "found"
    #: No graph on any of the numbers of nodes asked for fits.
    IMPOSSIBLE = "impossible"
    #: A limit was reached; nothing is claimed beyond ``impossible_for`` and ``edges_at_least``.
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, repr=False)
class FindResult(Shown):
    """What :func:`find_graph` returns.

    Attributes
    ----------
    verdict : FindVerdict
    graph : networkx Graph or DiGraph, or None
        FOUND: a graph on ``0..n-1`` that fits, re-checked by the exact algorithms. With UNDECIDED it may hold a graph
        that fits but for which it is not known whether one with fewer edges does.
    n : int or None
        Its number of nodes, or the number that was undecided.
    edges : int or None
        Its number of edges (arcs, when directed).
    has_fewest_edges : bool
        Whether it is proven that no graph on n nodes with fewer edges fits.
    impossible_for : tuple of int
        The numbers of nodes for which it is proven that none fits.
    edges_at_least : int
        A proven lower bound on the edges of a graph on n nodes that fits, when edges are minimised.
    method : str
        ``"enumeration"`` of all graphs up to isomorphism, or ``"cp-sat"``, whose answer "impossible" rests on the
        solver.
    stats : mapping
        Counters, and the reason of an UNDECIDED.
    seconds : float
        Wall-clock time.
    """

    verdict: FindVerdict
    graph: nx.Graph | None = None
    n: int | None = None
    edges: int | None = None
    has_fewest_edges: bool = False
    impossible_for: tuple[int, ...] = ()
    edges_at_least: int = 0
    method: str = ""
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}), compare=False)
    seconds: float = field(default=0.0, compare=False)

    def __bool__(self) -> bool:
        raise TypeError("a FindResult has three values, so it has no truth value: compare .verdict")

    def summary(self) -> str:
        """Return the answer in one line."""
        *others, last = self.impossible_for or (0,)
        none = f"none on {''.join(f'{n}, ' for n in others)}{counted(last, 'node')}" if self.impossible_for else ""
        if self.verdict is FindVerdict.FOUND:
            fewest = ", the fewest possible" if self.has_fewest_edges else ""
            return f"found: {counted(self.n or 0, 'node')}, {counted(self.edges or 0, 'edge')}{fewest}" + (
                f"; {none}" if none else ""
            )
        known = [each for each in (self._open_edges(), none) if each]
        return f"{self.verdict.value}: {'; '.join(known) or 'a limit was reached'}"

    def _open_edges(self) -> str:
        """Return what is known of the fewest edges when it is not known which they are."""
        if self.verdict is not FindVerdict.UNDECIDED:
            return ""
        at_least = f"at least {counted(self.edges_at_least, 'edge')} needed" if self.edges_at_least else ""
        if self.graph is None:
            return at_least and f"on {counted(self.n or 0, 'node')} {at_least}"
        fits = f"a graph on {counted(self.n or 0, 'node')} with {counted(self.edges or 0, 'edge')} fits"
        return f"{fits}, {at_least}" if at_least else f"{fits}; whether one with fewer does is open"

    def evidence(self) -> list[tuple[str, str]]:
        """Return what the answer rests on, as rows of a name and a text."""
        rows = [("method", self.method), ("seconds", f"{self.seconds:.3f}")]
        return [*rows, *((str(name), str(value)) for name, value in self.stats.items())]

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values; the graph as its list of edges."""
        return {
            "verdict": self.verdict.value,
            "n": self.n,
            "edges": None if self.graph is None else [list(edge) for edge in self.graph.edges],
            "has_fewest_edges": self.has_fewest_edges,
            "impossible_for": list(self.impossible_for),
            "edges_at_least": self.edges_at_least,
            "method": self.method,
            "seconds": self.seconds,
        }
