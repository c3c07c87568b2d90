"""The registry of exact algorithms, by the names users type.

Every algorithm is a function ``decide(graph, r, s, limits, **options) -> Answer`` that either finds a
violating pair of (r,s)-robustness, or proves that none exists, or says UNDECIDED. It may assume what the front
(:mod:`robustness.decision.front`) has settled: ``n >= 2``, ``1 <= r <= ceil(n/2)``, ``1 <= s <= n``.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Protocol, cast

from robustness.answers import Answer
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits

__all__ = ["ALGORITHMS", "OPTIONS", "Algorithm", "require_algorithm", "require_options"]


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


#: The switches of each algorithm, by its name; ``auto`` takes those of the search that it ends in.
OPTIONS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "auto": frozenset({"transcript", "blockers", "look_ahead", "sharing"}),
        "exhaustive": frozenset(),
        "transform": frozenset(),
        "subset-search": frozenset({"transcript", "blockers", "look_ahead", "sharing"}),
        "milp": frozenset({"solver", "pair_counting"}),
        "cp-sat": frozenset({"pair_counting"}),
    }
)


def require_algorithm(name: str) -> None:
    """Raise InvalidParameter unless ``name`` is ``"auto"`` or in :data:`ALGORITHMS`."""
    if name not in OPTIONS:
        raise InvalidParameter(f"algorithm is 'auto' or one of {', '.join(ALGORITHMS)}, not {name!r}")


def require_options(function: str, algorithm: str, options: Mapping[str, Any]) -> None:
    """Raise the TypeError of a function that is called with a keyword it does not have.

    It is raised before anything is decided, so that a slip such as ``timeout=`` for ``time_limit=`` is told on every
    graph, and never mistaken for a fault inside an algorithm.
    """
    for name in options:
        if name not in OPTIONS[algorithm]:
            known = ", ".join(sorted(OPTIONS[algorithm])) or "none"
            raise TypeError(
                f"{function}() got an unexpected keyword argument {name!r}; "
                f"the switches of algorithm {algorithm!r}: {known}"
            )


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
