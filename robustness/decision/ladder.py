"""THE ladder: what settles a question about (r,s)-robustness, from conventions to exact search.

Each rung is a function ``(question, limits) -> Answer | None``, and the first that answers settles. ``auto`` has four:
the conventions for the corners; the subset-minimum transform on small graphs (milliseconds); cheap bounds with their
evidence; the subset search, which on graphs of middle size gives way to the transform where it would take longer. A
named algorithm has two, the conventions and itself. Certification climbs a ladder of the same rungs and takes the first
evidence that the kernel knows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from robustness.answers import Answer, Question, Rung, Verdict, answers_in_turn
from robustness.decision.algorithms import ALGORITHMS
from robustness.decision.bounds import settle
from robustness.definitions import half_split, largest_conceivable_r
from robustness.evidence import Convention, ViolatingPair
from robustness.limits import Limits

__all__ = [
    "EXACT_S_NODES",
    "TRANSFORM_NODES",
    "algorithm_rung",
    "by_convention",
    "decide",
    "rungs_of",
    "settle_quickly",
]

#: Up to this many nodes ``auto`` decides by the subset-minimum transform: at most a fiftieth of a second, whatever the
#: graph, compiled or not.
TRANSFORM_NODES = 20

#: Up to this many nodes s_max(r) is found by one transform where the search does not find it sooner: some seconds.
EXACT_S_NODES = 28

_NO_OPTIONS: Mapping[str, Any] = MappingProxyType({})


def decide(
    question: Question, limits: Limits, algorithm: str = "auto", options: Mapping[str, Any] = _NO_OPTIONS
) -> Answer:
    """Return the answer of the first rung that has one; its pair was checked against the definition."""
    return next(answers_in_turn(rungs_of(algorithm, options), question, limits))


def rungs_of(algorithm: str, options: Mapping[str, Any] = _NO_OPTIONS) -> tuple[Rung, ...]:
    """Return the ladder of an algorithm, lowest rung first; the last one always answers.

    Options are for the subset search, so with them ``auto`` does without the transform.
    """
    if algorithm != "auto":
        return by_convention, algorithm_rung(algorithm, options)
    below = settle if options else settle_quickly
    return by_convention, below, algorithm_rung("subset-search", options) if options else _search_or_transform


def by_convention(question: Question, limits: Limits) -> Answer | None:
    """Settle the corners that need no search: r = 0, r > ceil(n/2), fewer than two nodes."""
    graph, r, _ = question
    if r == 0:
        return _conventional(True, "every graph is (0,s)-robust: X_S^0 = S")
    if r > largest_conceivable_r(graph.n):
        rule = "r* <= ceil(n/2)"
        if graph.n < 2:
            return _conventional(False, rule)
        return Answer(ViolatingPair(half_split(graph)), {"rule": rule}, "definition")
    return _conventional(True, "one node is (1,1)-robust by convention") if graph.n < 2 else None


def _conventional(holds: bool, rule: str) -> Answer:
    return Answer(Convention(holds, rule), {"rule": rule}, "definition")


def algorithm_rung(name: str, options: Mapping[str, Any] = _NO_OPTIONS) -> Callable[[Question, Limits], Answer]:
    """Return the rung that runs one algorithm of the registry."""

    def run(question: Question, limits: Limits) -> Answer:
        return replace(ALGORITHMS[name](*question, limits, **options), decided_by=name)

    return run


def _search_or_transform(question: Question, limits: Limits) -> Answer:
    """Search; on a graph of middle size, and for s > 1, no longer than the transform would take, and then transform.

    The search for s > 1 can take minutes on dense graphs of 24 nodes, where one transform takes a fifth of a second.
    What is spread over cubes or has a budget of steps stays with the search.
    """
    n, search = question.graph.n, algorithm_rung("subset-search")
    is_bound = limits.steps is not None or limits.executor is not None or limits.state is not None
    if question.s == 1 or n > EXACT_S_NODES or is_bound:
        return search(question, limits)
    from robustness.decision.algorithms.transform import memory_suffices

    if not memory_suffices(n):
        return search(question, limits)
    answer = search(question, limits.counted(n << n))  # a step is about a nanosecond, and so is a set of the transform
    if answer.verdict is not Verdict.UNDECIDED or limits.expired():
        return answer
    return algorithm_rung("transform")(question, limits)


def settle_quickly(question: Question, limits: Limits) -> Answer | None:
    """Settle what takes at most a fraction of a second: small graphs by the transform, others as far as bounds tell.

    With n >= 2 and r >= 1.
    """
    if question.graph.n <= TRANSFORM_NODES:
        return algorithm_rung("transform")(question, limits)
    return settle(question, limits)
