"""Side by side: our whole determination of r*, and what each method needs for the two questions behind it.

A method without bounds would climb or descend through every r, which says nothing about its strength. So the others are
told r*: they are asked to refute every pair for r* and to decide r* + 1, and their time is the sum of the two. Ours
is told nothing. Every verdict that any of them reaches is checked against all others about the same graph.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from benchmarks.measuring import METHODS, Determination, Measured, ask, determine, warm_up
from benchmarks.suite import Instance, build
from benchmarks.workers import CallFailed, OutOfTime, Worker, WorkerLost

__all__ = ["Comparison", "Crew", "Settings", "Solved", "Statement", "compare", "contradiction", "geometric_mean"]

#: Seconds beyond a cap until a process that has not stopped by itself is killed.
_GRACE = 15.0
#: Runs shorter than this many seconds are made three times, with three seeds of the heuristics; the median counts.
_SHORT = 1.0
#: A limit that ends the search for s at once.
_NO_TIME = 1e-6

#: Who says that the graph is r-robust (True) or not (False).
Statement = tuple[str, int, bool]


@dataclass(frozen=True)
class Settings:
    """What all measurements of a run share."""

    cap: float = 60.0
    jobs: int = 1
    methods: tuple[str, ...] = tuple(METHODS)
    #: The limit on the search for s in one more run, by default that of determine_robustness; None: no such run.
    s_cap: float | None = 2.0


@dataclass(frozen=True)
class Solved:
    """What one method made of the two questions, with the seconds of both: the cap at least, when it was reached."""

    refute: Measured
    find: Measured | None
    seconds: float
    is_solved: bool


@dataclass
class Comparison:
    """One line of the table."""

    instance: Instance
    n: int
    arcs: int
    directed: bool
    ours: Determination | None = None
    methods: dict[str, Solved] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    def ratio(self, method: str) -> float | None:
        """Return how many times longer than ours the method took; at least that, when it was capped."""
        if self.ours is None or not self.ours.is_exact or method not in self.methods:
            return None
        return self.methods[method].seconds / self.ours.seconds

    def best_peer(self) -> tuple[str, float] | None:
        """Return the fastest peer that solved the instance, with its seconds."""
        solved = {name: each.seconds for name, each in self.methods.items() if each.is_solved and METHODS[name].is_peer}
        return min(solved.items(), key=lambda item: item[1]) if solved else None


class Crew:
    """One warm worker for each method, and the rule of three for short runs."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._workers: dict[str, Worker] = {}

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers.values():
            worker.discard()

    def run(self, method: str, function: Callable[..., Any], *arguments: Any, seconds: float) -> Any:
        """Return ``function(*arguments)`` from the method's worker, or raise as :meth:`Worker.call` does."""
        if method not in self._workers:
            self._workers[method] = Worker(partial(warm_up, method, self._jobs))
        return self._workers[method].call(function, *arguments, seconds=seconds + _GRACE)

    def ask(self, instance: Instance, r: int, s: int, method: str, cap: float) -> tuple[Measured, list[Measured]]:
        """Return the median of one or three runs of a decision, and all of them; never raises for a limit."""
        runs = [self._ask_once(instance, r, s, method, cap, 0)]
        if runs[0].is_decided and runs[0].seconds < _SHORT:
            runs += [self._ask_once(instance, r, s, method, cap, seed) for seed in (1, 2)]
        middle = sorted(runs, key=lambda each: (not each.is_decided, each.seconds))[len(runs) // 2]
        return replace(middle, runs=tuple(each.seconds for each in runs)), runs

    def _ask_once(self, instance: Instance, r: int, s: int, method: str, cap: float, seed: int) -> Measured:
        try:
            found: Measured = self.run(method, ask, instance, r, s, method, cap, self._jobs, seed, seconds=cap)
        except (OutOfTime, WorkerLost) as problem:
            return Measured("undecided", cap, reason=str(problem))
        except CallFailed as problem:
            return Measured("failed", cap, reason=str(problem))
        if not found.is_decided:
            # HiGHS and SCIP cannot be stopped from outside: their thread may still be at work in that process.
            self._workers[method].discard()
        return found

    def determine(
        self, instance: Instance, cap: float, s_cap: float | None
    ) -> tuple[Determination, list[Determination]]:
        """Return the median of one or three determinations of r*, and all of them; raises as :meth:`run` does.

        The search for s has a limit of its own and says nothing about r*: it is kept out of these runs, and measured in
        one more, with ``s_cap`` seconds, where r* was quick.
        """
        runs: list[Determination] = []
        for seed in range(3):
            runs.append(self._determine_once(instance, cap, _NO_TIME, seed))
            if not runs[0].is_exact or runs[0].seconds >= _SHORT:
                break
        shown = sorted(runs, key=lambda each: (not each.is_exact, each.seconds))[len(runs) // 2]
        shown = replace(shown, runs=tuple(each.seconds for each in runs), whole=None)
        if s_cap is not None and len(runs) > 1:
            runs.append(self._determine_once(instance, cap, s_cap, 0))
            shown = replace(shown, whole=runs[-1].whole, s=runs[-1].s, s_is_exact=runs[-1].s_is_exact)
        return shown, runs

    def _determine_once(self, instance: Instance, cap: float, s_cap: float, seed: int) -> Determination:
        arguments = (instance, cap, s_cap, self._jobs, seed)
        found: Determination = self.run("auto", determine, *arguments, seconds=cap + s_cap)
        return found


def compare(instance: Instance, crew: Crew, settings: Settings) -> Comparison:
    """Measure one instance with ours and with every method that takes its size."""
    graph = build(instance)
    line = Comparison(instance, graph.n, graph.arc_count, graph.directed)
    statements: list[Statement] = []
    if instance.known_r is not None:
        statements += [("closed form", instance.known_r, True), ("closed form", instance.known_r + 1, False)]
    try:
        line.ours, runs = crew.determine(instance, settings.cap, settings.s_cap)
        for run in runs:
            statements += [("ours", run.lower, True), ("ours", run.upper + 1, False)]
    except (OutOfTime, WorkerLost, CallFailed) as problem:
        line.failures.append(f"ours on {instance.name}: {problem}")
    r = line.ours.upper if line.ours else instance.known_r
    for method in settings.methods if r is not None else ():
        if graph.n <= METHODS[method].most_nodes:
            _measure(line, method, r or 0, crew, settings, statements)
    wrong = contradiction(statements)
    if wrong:
        line.failures.append(f"DISAGREEMENT on {instance.name}: {wrong}")
    return line


def _measure(
    line: Comparison, method: str, r: int, crew: Crew, settings: Settings, statements: list[Statement]
) -> None:
    """Ask ``method`` to refute all pairs for r and then, in what is left of the cap, to decide r + 1."""
    refute, asked = crew.ask(line.instance, r, 1, method, settings.cap)
    answers = [(r, each) for each in asked]
    find, left = None, settings.cap - refute.seconds
    if refute.is_decided and left > 0:
        find, asked = crew.ask(line.instance, r + 1, 1, method, left)
        answers += [(r + 1, each) for each in asked]
    seconds = refute.seconds + (find.seconds if find else 0.0)
    is_solved = find is not None and find.is_decided and seconds <= settings.cap
    line.methods[method] = Solved(refute, find, seconds if is_solved else max(seconds, settings.cap), is_solved)
    statements += [(method, at, each.verdict == "robust") for at, each in answers if each.is_decided]
    failed = {each.reason for _, each in answers if each.verdict == "failed"}
    line.failures += [f"{method} on {line.instance.name}: {reason}" for reason in failed]


def contradiction(statements: Iterable[Statement]) -> str | None:
    """Return who contradicts whom: r-robust and not r'-robust cannot both hold for r' <= r.

    >>> contradiction([("ours", 3, True), ("ours", 4, False), ("milp", 3, True)])
    >>> contradiction([("ours", 3, True), ("milp", 2, False)])
    'ours says 3-robust, milp says not 2-robust'
    """
    told = list(statements)
    robust = max((each for each in told if each[2]), key=lambda each: each[1], default=None)
    refuted = min((each for each in told if not each[2]), key=lambda each: each[1], default=None)
    if robust is None or refuted is None or robust[1] < refuted[1]:
        return None
    return f"{robust[0]} says {robust[1]}-robust, {refuted[0]} says not {refuted[1]}-robust"


def geometric_mean(values: Iterable[float]) -> float | None:
    """Return the geometric mean, or None of nothing.

    >>> round(geometric_mean([1, 100]), 9)
    10.0
    """
    logarithms = [math.log(value) for value in values]
    return math.exp(sum(logarithms) / len(logarithms)) if logarithms else None
