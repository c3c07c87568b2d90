"""What runs in a child process: one timed question about one graph.

Building the graph is not timed, and every run gets a new one, so that nothing computed for an earlier run is at hand.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import robustness as rb
from benchmarks.suite import Instance, build
from robustness.results import Bounds

__all__ = ["METHODS", "Determination", "Measured", "Method", "ask", "determine", "profile", "warm_up"]


@dataclass(frozen=True)
class Method:
    """A way to decide one (r,s): an algorithm of the registry with options, and the largest n it is asked for."""

    name: str
    algorithm: str
    options: dict[str, Any] = field(default_factory=dict)
    most_nodes: int = 10**6
    is_peer: bool = True


#: Side by side in every run. The direct models are those of the literature, without our pair-counting rows.
METHODS = {
    method.name: method
    for method in (
        Method("subset-search", "subset-search", is_peer=False),
        Method("cp-sat", "cp-sat"),
        Method("cp-sat-direct", "cp-sat", {"pair_counting": False}),
        Method("milp", "milp"),
        Method("milp-direct", "milp", {"pair_counting": False}),
        Method("transform", "transform", most_nodes=20),
        Method("exhaustive", "exhaustive", most_nodes=12),
    )
}


@dataclass(frozen=True)
class Measured:
    """One decision: wall-clock and process CPU seconds (all threads), and the size of its search tree."""

    verdict: str
    seconds: float
    cpu: float | None = None
    nodes: int | None = None
    reason: str = ""
    #: The wall-clock seconds of all runs of which this is the median.
    runs: tuple[float, ...] = ()

    @property
    def is_decided(self) -> bool:
        """Whether a verdict was reached."""
        return self.verdict in ("robust", "not-robust")


@dataclass(frozen=True)
class Determination:
    """One ``determine_robustness``: what is proven about r*, when r* was known, and when the call returned.

    ``seconds`` and ``cpu`` are until both bounds on r* met, or until the end when they did not; ``whole`` is until
    the call returned with s_max(r*), or with what its own time limit allowed. ``nodes`` are those of the whole call.
    """

    lower: int
    upper: int
    s: int
    s_is_exact: bool
    algorithm: str
    seconds: float
    cpu: float
    whole: float | None
    nodes: int
    #: The seconds until r* of all runs of which this is the median.
    runs: tuple[float, ...] = ()

    @property
    def is_exact(self) -> bool:
        """Whether r* is known."""
        return self.lower == self.upper


def determine(instance: Instance, cap: float, s_cap: float, jobs: int, seed: int) -> Determination:
    """Time ``determine_robustness``; r* is known when ``on_bounds`` says so."""
    graph = build(instance)
    met: list[tuple[float, float]] = []

    def on_bounds(bounds: Bounds) -> None:
        if bounds.lower.value == bounds.upper.value and not met:
            met.append((time.perf_counter() - began, time.process_time() - cpu_began))

    began, cpu_began = time.perf_counter(), time.process_time()
    result = rb.determine_robustness(
        graph, time_limit=cap, s_time_limit=s_cap, jobs=jobs, seed=seed, on_bounds=on_bounds
    )
    whole, whole_cpu = time.perf_counter() - began, time.process_time() - cpu_began
    seconds, cpu = met[0] if met else (whole, whole_cpu)
    lower, upper = (result.bounds.lower.value, result.bounds.upper.value) if result.bounds else (result.r, result.r)
    return Determination(
        lower, upper, result.s, result.s_is_exact, result.algorithm, seconds, cpu, whole,
        int(result.stats.get("nodes", 0)),
    )  # fmt: skip


def ask(instance: Instance, r: int, s: int, method: str, cap: float, jobs: int, seed: int) -> Measured:
    """Time one decision of (r,s)-robustness; ``method`` is a name in METHODS or ``auto``."""
    graph = build(instance)
    chosen = METHODS[method] if method in METHODS else Method(method, method)
    decide = partial(rb.check_rs_robustness, graph, r, s, algorithm=chosen.algorithm, **chosen.options)
    began, cpu_began = time.perf_counter(), time.process_time()
    result = decide(time_limit=cap, jobs=jobs, seed=seed)
    seconds, cpu = time.perf_counter() - began, time.process_time() - cpu_began
    size = next((result.stats[key] for key in ("nodes", "sets", "pairs") if key in result.stats), None)
    return Measured(result.verdict.value, seconds, cpu, size, str(result.stats.get("reason", "")))


def profile(instance: Instance, cap: float) -> tuple[dict[int, int], float, float]:
    """Time the whole robustness profile; return it with the wall-clock and CPU seconds."""
    graph = build(instance)
    began, cpu_began = time.perf_counter(), time.process_time()
    table = dict(rb.robustness_profile(graph, time_limit=cap))
    return table, time.perf_counter() - began, time.process_time() - cpu_began


def warm_up(method: str, jobs: int) -> None:
    """Import everything ``method`` needs, load or compile every kernel, and decide a few small graphs.

    Kernels are compiled for each width of node sets: one word of 64 bits, two, and more.
    """
    tiny, *wider = (Instance("warm-up", "circulant", {"n": n, "k": 2}) for n in (8, 20, 70, 140))
    others = [Instance("warm-up", "gnp", {"n": 20, "p": 0.5, "seed": 1})]
    others.append(Instance("warm-up", "directed_gnp", {"n": 20, "p": 0.5, "seed": 1}))
    tasks: list[Callable[[], object]]
    if method == "auto":
        tasks = [partial(determine, graph, 600.0, 0.05, jobs, 0) for graph in (tiny, *wider, *others)]
        tasks += [partial(ask, graph, 2, s, "subset-search", 600.0, jobs, 0) for graph in wider for s in (1, 2)]
        tasks.append(partial(profile, tiny, 60.0))
    else:
        graphs = [tiny, *wider] if METHODS[method].most_nodes > 20 else [tiny]
        tasks = [partial(ask, graph, r, 1, method, 600.0, jobs, 0) for graph in graphs for r in (2, 3)]
    for task in tasks:
        task()
