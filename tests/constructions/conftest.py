"""The oracle of these tests: the definition itself, every pair tried."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from robustness.decision.algorithms.exhaustive import decide
from robustness.definitions import largest_conceivable_r
from robustness.digraph import as_digraph
from robustness.limits import Limits
from robustness.results import Verdict


def is_robust_by_definition(G: Any, r: int, s: int = 1) -> bool:
    graph = as_digraph(G)
    if r == 0:
        return True
    if r > largest_conceivable_r(graph.n):
        return False
    return graph.n == 1 or decide(graph, r, min(s, graph.n), Limits()).verdict is Verdict.ROBUST


@pytest.fixture(scope="session")
def holds() -> Callable[..., bool]:
    return is_robust_by_definition
