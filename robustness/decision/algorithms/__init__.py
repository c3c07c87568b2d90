"""One technique, one file, one signature: exact algorithms that look for a violating pair.

Every algorithm is a function ``decide(graph, r, s, limits, **options) -> Answer`` that either finds a
violating pair of (r,s)-robustness, or proves that none exists, or says UNDECIDED. It may assume what the front
(:mod:`robustness.decision.front`) has settled: ``n >= 2``, ``1 <= r <= ceil(n/2)``, ``1 <= s <= n``.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, cast

from robustness.digraph import Digraph
from robustness.results import Verdict

__all__ = ["ALGORITHMS", "Algorithm", "Answer", "Limits", "Pair", "Progress"]


class Pair(NamedTuple):
    """A violating pair as id sets."""

    first: frozenset[int]
    second: frozenset[int]


@dataclass(frozen=True, slots=True)
class Progress:
    """What a long search reports now and then: counters, and what it is doing in a few words."""

    nodes: int
    note: str


@dataclass(frozen=True, slots=True)
class Limits:
    """How long and how hard an algorithm may work.

    Attributes
    ----------
    deadline : float or None
        A value of ``time.monotonic()``; past it the answer is UNDECIDED.
    jobs : int
        Threads.
    seed : int
        Of every random choice.
    progress : callable or None
        Called with a :class:`Progress` a few times a second.
    """

    deadline: float | None = None
    jobs: int = 1
    seed: int = 0
    progress: Callable[[Progress], None] | None = None

    def seconds_left(self) -> float:
        """Return the seconds until the deadline (``inf`` without one, never negative)."""
        return float("inf") if self.deadline is None else max(0.0, self.deadline - time.monotonic())

    def expired(self) -> bool:
        """Return whether the deadline has passed."""
        return self.deadline is not None and time.monotonic() >= self.deadline


@dataclass(frozen=True, slots=True)
class Answer:
    """What an algorithm returns: ROBUST, NOT_ROBUST with a pair, or UNDECIDED with a reason in ``stats``."""

    verdict: Verdict
    pair: Pair | None = None
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    #: The transcript of a refutation (see docs/certificate-format.md), when one was asked for.
    transcript: bytes | None = None


class Algorithm(Protocol):
    """The contract of the registry."""

    def __call__(self, graph: Digraph, r: int, s: int, limits: Limits, **options: Any) -> Answer:
        """Decide (r,s)-robustness of ``graph``."""


def _lazily(module: str) -> Algorithm:
    """Return an algorithm whose module, and with it its solver, is imported at the first call."""

    def decide(graph: Digraph, r: int, s: int, limits: Limits, **options: Any) -> Answer:
        found = importlib.import_module(f"robustness.decision.algorithms.{module}")
        return cast(Answer, found.decide(graph, r, s, limits, **options))

    decide.__name__ = module
    return decide


#: Every exact algorithm by the name users type.
ALGORITHMS: Mapping[str, Algorithm] = MappingProxyType(
    {
        "exhaustive": _lazily("exhaustive"),
        "transform": _lazily("transform"),
        "subset-search": _lazily("subset_search"),
        "milp": _lazily("milp"),
        "cp-sat": _lazily("cp_sat"),
    }
)
