"""The frontier: what two cores decide of the hardest instances, and the estimate of what they do not.

    python -m benchmarks.frontier [--seconds 900] [--seeds 10] [--only TEXT] [--picture FILE.svg]
    python -m benchmarks.frontier --estimator

Each instance is determined on fresh seeds; what the limit leaves open has the r that is still to be refuted, and
Knuth's estimate of that search with its spread (docs/cluster.md). Median and worst of the seeds are told, as a table.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from statistics import median

import networkx as nx
import numpy as np

import robustness as rb
from benchmarks.suite import Instance, build
from robustness.cubes import Cube
from robustness.cubes.cube import CubeQuestion
from robustness.cubes.estimate import Estimate, Walker, duration_in_words
from robustness.cubes.solving import solve


@dataclass(frozen=True)
class Outcome:
    """One instance on one seed; ``estimate`` is of the refutation of the greatest r that is not refuted."""

    seed: int
    lower: int
    upper: int
    seconds: float
    estimate: Estimate | None


def in_regular(n: int, k: int, seed: int) -> nx.DiGraph:
    """Return a digraph in which every node hears k others, drawn anew for each node."""
    draws = np.random.default_rng(seed)
    graph = nx.empty_graph(n, create_using=nx.DiGraph)
    for node in range(n):
        others = np.delete(np.arange(n), node)
        graph.add_edges_from((int(other), node) for other in draws.choice(others, k, replace=False))
    return graph


def _suite(builder: str, **arguments: float) -> Callable[[int], rb.Digraph]:
    return lambda seed: build(Instance("frontier", builder, {**arguments, "seed": seed}))


INSTANCES: dict[str, Callable[[int], rb.Digraph]] = {
    "G(60,.5)": _suite("gnp", n=60, p=0.5),
    "G(70,.5)": _suite("gnp", n=70, p=0.5),
    "G(70,.3)": _suite("gnp", n=70, p=0.3),
    "10-regular 80": _suite("regular", n=80, k=10),
    "10-regular 120": _suite("regular", n=120, k=10),
    "10-regular 160": _suite("regular", n=160, k=10),
    "6-regular 200": _suite("regular", n=200, k=6),
    "directed G(50,.5)": _suite("directed_gnp", n=50, p=0.5),
    "directed G(80,.2)": _suite("directed_gnp", n=80, p=0.2),
    "10-in-regular 100": lambda seed: rb.Digraph.from_networkx(in_regular(100, 10, seed)),
    "10-in-regular 120": lambda seed: rb.Digraph.from_networkx(in_regular(120, 10, seed)),
    "G(80,.5)": _suite("gnp", n=80, p=0.5),
}


def question_of(graph: rb.Digraph, r: int) -> CubeQuestion:
    need = np.maximum(graph.in_degrees - r + 1, 0).astype(np.int64)
    return CubeQuestion(graph.in_words, need, 0, False, 2, True)


def outcome(graph: rb.Digraph, seed: int, seconds: float, workers: int) -> Outcome:
    """Determine r* within so many seconds; estimate what is left of the first question that is open."""
    started = time.monotonic()
    with ThreadPoolExecutor(workers) as pool:
        found = rb.determine_robustness(graph, time_limit=seconds, jobs=workers, executor=pool, s_time_limit=0.01)
    took = time.monotonic() - started
    bounds = found.bounds
    if bounds is None or bounds.are_equal:
        return Outcome(seed, found.r, found.r, took, None)
    question, whole = question_of(graph, bounds.upper.value), Cube.whole(graph.n)
    slice_ = solve(question.as_task(whole, 2.0))
    left, low, high = Walker(question, seed).nodes_left([whole], 400, seconds=20.0)
    estimate = Estimate(0, left, low, high, workers, slice_["nodes"] / slice_["seconds"])
    return Outcome(seed, bounds.lower.value, bounds.upper.value, took, estimate)


def row(name: str, outcomes: list[Outcome], limit: float) -> str:
    """Return the line of the table for one instance."""
    decided = [each for each in outcomes if each.estimate is None]
    times = sorted(each.seconds for each in outcomes)
    middle, worst = (f"{x:.1f} s" if x < limit else f"> {limit:.0f} s" for x in (median(times), times[-1]))
    line = f"| {name} | {len(decided)} of {len(outcomes)} | {middle} | {worst} |"
    open_ = [each for each in outcomes if each.estimate is not None]
    if not open_:
        return f"{line} |"
    hardest = max(open_, key=lambda each: each.estimate.left if each.estimate else 0.0)
    told = [f"seed {hardest.seed}: {hardest.lower}..{hardest.upper}"]
    if hardest.estimate is not None:
        about, low, high = (
            hardest.estimate.seconds(nodes) or 0.0
            for nodes in (hardest.estimate.left, hardest.estimate.low, hardest.estimate.high)
        )
        cores = duration_in_words(about * hardest.estimate.workers / 1000)
        told += [f"r = {hardest.upper} needs about {hardest.estimate.left:.2g} nodes, {duration_in_words(about)}"]
        told += [f"({duration_in_words(low)} to {duration_in_words(high)}); {cores} on 1,000 cores"]
    return f"{line} {', '.join(told[:2])} {' '.join(told[2:])} |"


def picture(measured: dict[str, list[Outcome]], limit: float, path: str) -> None:
    """Draw every seed of every instance: the seconds it took, or the limit as a hollow mark."""
    import matplotlib as mpl

    mpl.use("svg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(8, 0.45 * len(measured) + 1.2))
    for place, outcomes in enumerate(measured.values()):
        for each in outcomes:
            is_open = each.estimate is not None
            axes.plot(
                min(each.seconds, limit), place, "o", color="C1" if is_open else "C0", mfc="none" if is_open else "C0"
            )
    axes.set(
        xscale="log", xlabel=f"seconds on two cores (hollow: open after {limit:.0f} s)", yticks=range(len(measured))
    )
    axes.set_yticklabels(list(measured))
    axes.invert_yaxis()
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def measure_estimator() -> None:
    """Print how the walks scatter and how often the spread holds the truth, on trees whose size is known."""
    graphs = [
        (_suite("gnp", n=n, p=0.5)(seed), r) for n, seed, r in ((44, 2, 11), (48, 1, 12), (50, 3, 13), (52, 1, 13))
    ]
    graphs.append((_suite("regular", n=60, k=10)(1), 5))
    print(
        "| n | r | nodes | mean of 6,000 walks | held by the spread of 100 walks | factor |\n|---|---|---|---|---|---|"
    )
    for graph, r in graphs:
        question, whole = question_of(graph, r), Cube.whole(graph.n)
        result = solve(question.as_task(whole, 3600.0))
        truth = result["nodes"]
        found = [Walker(question, seed).nodes_left([whole], 100) for seed in range(60)]
        held = sum(low <= truth <= high for _, low, high in found)
        mean = np.mean([left for left, _, _ in found])
        factor = median(high / left for left, _, high in found)
        print(f"| {graph.n} | {r} | {truth:,} | {mean:,.0f} | {held} of 60 | {factor:.2f} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=900.0)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="", help="instances whose name holds this text")
    parser.add_argument("--picture", metavar="FILE.svg")
    parser.add_argument("--estimator", action="store_true", help="measure the estimator instead")
    asked = parser.parse_args()
    if asked.estimator:
        measure_estimator()
        return
    print("| instance | decided | median | worst | what is open |\n|---|---|---|---|---|", flush=True)
    measured: dict[str, list[Outcome]] = {}
    for name, make in INSTANCES.items():
        if asked.only in name:
            seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
            measured[name] = [outcome(make(seed), seed, asked.seconds, asked.workers) for seed in seeds]
            print(row(name, measured[name], asked.seconds), flush=True)
    if asked.picture:
        picture(measured, asked.seconds, asked.picture)


if __name__ == "__main__":
    main()
