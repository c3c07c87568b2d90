"""The frontier: what two cores decide of the hardest instances, and the estimate of what they do not.

    python -m benchmarks.frontier --record FILE.jsonl [--seconds 900] [--probe 30] [--seeds 10] [--only TEXT]
    python -m benchmarks.frontier --record FILE.jsonl --show [--picture FILE.svg]
    python -m benchmarks.frontier --estimator

Each instance is determined on fresh seeds. First every seed gets the seconds of the probe; what is open then has the r
that is still to be refuted, and Knuth's estimate of that search with its spread (docs/cluster.md). Second, the seeds
whose spread begins below the limit are determined within it, those that promise to be short first. A seed whose spread
begins above the limit is left open: the estimate is the reason.

Times are seconds of one core (processor time of the process), so that a busy machine does not tell in them; n workers
take about an n-th of it. Every run is a line of the record, and a benchmark that was stopped goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median

import networkx as nx
import numpy as np

import robustness as rb
from benchmarks.suite import Instance, build
from robustness.cubes import Cube
from robustness.cubes.cube import CubeQuestion
from robustness.cubes.estimate import Walker, duration_in_words
from robustness.cubes.solving import solve
from robustness.figures.saving import new_figure, save_figure


@dataclass(frozen=True)
class Outcome:
    """One instance on one seed.

    ``left`` holds the low end, the middle and the high end of the seconds of one core that refuting r = ``upper`` would
    still take, counted from nothing; None where r* is known.
    """

    instance: str
    seed: int
    lower: int
    upper: int
    seconds: float
    limit: float
    workers: int
    left: tuple[float, float, float] | None

    @property
    def may_fit(self) -> bool:
        """Whether the spread of the estimate begins within a limit of so many seconds of every worker."""
        return self.left is not None and self.left[0] <= self.limit * self.workers


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


def outcome(name: str, seed: int, seconds: float, workers: int) -> Outcome:
    """Determine r* within so many seconds; estimate what is left of the first question that is open."""
    graph, started = INSTANCES[name](seed), time.process_time()
    with ThreadPoolExecutor(workers) as pool:
        found = rb.determine_robustness(graph, time_limit=seconds, jobs=workers, executor=pool, s_time_limit=0.01)
    took, bounds = round(time.process_time() - started, 2), found.bounds
    if bounds is None or bounds.are_equal:
        return Outcome(name, seed, found.r, found.r, took, seconds, workers, None)
    question, whole = question_of(graph, bounds.upper.value), Cube.whole(graph.n)
    started = time.process_time()
    nodes = solve(question.as_task(whole, 2.0))["nodes"]
    pace = (time.process_time() - started) / nodes
    about, low, high = Walker(question, seed).nodes_left([whole], 400, seconds=6.0)
    left = tuple(float(f"{pace * x:.3g}") for x in (low, about, high))
    # On a busy machine the limit came before so much work: then it is an open seed of less, and is run again.
    had = seconds if took >= 0.95 * seconds * workers else took / workers
    return Outcome(name, seed, bounds.lower.value, bounds.upper.value, took, had, workers, (left[0], left[1], left[2]))


def read_record(path: Path) -> dict[tuple[str, int], Outcome]:
    """Return the last outcome of each instance and seed in a record."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    found = (Outcome(**{**each, "left": each["left"] and tuple(each["left"])}) for each in map(json.loads, lines))
    return {(each.instance, each.seed): each for each in found}


def measure(path: Path, keys: Sequence[tuple[str, int]], probe: float, seconds: float, workers: int) -> None:
    """Run what the record does not hold yet: the probe of every seed, then the seeds that may be decided in time."""

    def run(key: tuple[str, int], limit: float) -> None:
        found = outcome(*key, limit, workers)
        with path.open("a", encoding="utf-8") as record:
            record.write(json.dumps(asdict(found)) + "\n")
        print(found, flush=True)

    for key in keys:
        if key not in read_record(path):
            run(key, probe)
    outcomes = [each for key, each in read_record(path).items() if key in keys and each.left and each.limit < seconds]
    for each in sorted(outcomes, key=lambda each: each.left or ()):
        if replace(each, limit=seconds).may_fit:
            run((each.instance, each.seed), seconds)


def row(name: str, outcomes: Sequence[Outcome], limit: float) -> str:
    """Return the line of the table for one instance; an open seed counts as longer than every other."""
    decided = [each for each in outcomes if each.left is None]
    times = sorted(each.seconds if each.left is None else math.inf for each in outcomes)
    middle, worst = (
        f"{x:.2g} s" if x < 10 else f"{x:,.0f} s" if x < math.inf else "open" for x in (median(times), times[-1])
    )
    line = f"| {name} | {len(decided)} of {len(outcomes)} | {middle} | {worst} |"
    open_ = sorted((each.left, each) for each in outcomes if each.left)
    if not open_:
        return f"{line} |"
    (low, about, high), each = open_[len(open_) // 2]
    unfinished = sum(replace(each, limit=limit).may_fit and each.limit < limit for _, each in open_)
    told = f"r* is {each.lower} to {each.upper}; r = {each.upper}: {duration_in_words(about)} of one core"
    told += f" ({duration_in_words(low)} to {duration_in_words(high)}), {duration_in_words(about / 1000)} of 1,000"
    return f"{line} {told}{f'; {unfinished} not run to the limit' if unfinished else ''} |"


def picture(by_name: dict[str, list[Outcome]], path: str) -> None:
    """Draw every seed of every instance: the seconds it took, or what the estimate says, as a hollow mark."""
    figure = new_figure(8, 0.45 * len(by_name) + 1.2)
    axes = figure.subplots()
    for place, outcomes in enumerate(by_name.values()):
        for each in outcomes:
            if each.left is None:
                axes.plot(max(each.seconds, 0.01), place, "o", color="C0", alpha=0.6)
            else:
                axes.plot(each.left[::2], (place, place), color="C1", linewidth=1, alpha=0.5)
                axes.plot(each.left[1], place, "o", color="C1", mfc="none")
    axes.set(xscale="log")
    right = axes.get_xlim()[1]
    for seconds, words in ((60, "1 min"), (3600, "1 h"), (86_400, "1 day"), (31_557_600, "1 year")):
        if seconds > right:
            break
        axes.axvline(seconds, color="0.8", linewidth=0.8, zorder=0)
        axes.text(seconds, -0.7, words, color="0.4", ha="center", va="bottom", fontsize=8)
    axes.set(yticks=range(len(by_name)), ylim=(len(by_name) - 0.5, -0.6))
    axes.set_xlabel("seconds of one core: decided (filled), or estimated with its spread (hollow)")
    axes.set_yticklabels(list(by_name))
    save_figure(figure, path)


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
    parser.add_argument("--record", metavar="FILE.jsonl", type=Path)
    parser.add_argument("--seconds", type=float, default=900.0)
    parser.add_argument("--probe", type=float, default=30.0)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", default="", help="instances whose name holds this text")
    parser.add_argument("--show", action="store_true", help="measure nothing, tell what the record holds")
    parser.add_argument("--picture", metavar="FILE.svg")
    parser.add_argument("--estimator", action="store_true", help="measure the estimator instead")
    asked = parser.parse_args()
    if asked.estimator:
        measure_estimator()
        return
    if asked.record is None:
        parser.error("name the record: --record FILE.jsonl")
    seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
    keys = [(name, seed) for seed in seeds for name in INSTANCES if asked.only in name]
    if not asked.show:
        measure(asked.record, keys, asked.probe, asked.seconds, asked.workers)
    by_name: dict[str, list[Outcome]] = {}
    for (name, _), each in read_record(asked.record).items():
        by_name.setdefault(name, []).append(each)
    print("| instance | decided | median | worst | the middle one of what is open |\n|---|---|---|---|---|")
    for name, outcomes in by_name.items():
        print(row(name, outcomes, asked.seconds))
    if asked.picture:
        picture(by_name, asked.picture)


if __name__ == "__main__":
    main()
