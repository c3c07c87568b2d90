"""Joint robustness of long sequences, against the naive loop: ``python benchmarks/joint.py [--quick] [--seed N]``.

The naive loop builds the union of every window with networkx and asks the same front about it; it is timed on evenly
spread windows and scaled to all. Compiled kernels are warmed up before anything is timed. Reading the sequence
is not timed, as both need it; it is printed beside.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass

import networkx as nx
import numpy as np

import robustness as rb
from robustness.time_varying import JointResult, TimeVaryingGraph, check_joint_robustness

R = 3


@dataclass(frozen=True)
class Case:
    """A way to make steps, and the window whose joint 3-robustness is decided."""

    name: str
    steps: Callable[[int, int, np.random.Generator], list[nx.Graph]]
    window: int


@dataclass(frozen=True)
class Row:
    """One line of the table; seconds."""

    case: str
    nodes: int
    steps: int
    question: str
    verdict: str
    window: int | None
    windows: int
    unions: int
    searches: int
    reading: float
    seconds: float
    naive: float
    ratio: float


def repeating(n: int, steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    """Return 100 random subgraphs of a platoon with 5 neighbours ahead and behind, over and over."""
    links = platoon_links(n, 5)
    pattern = [graph_of(n, [link for link in links if draw.random() < 0.4]) for _ in range(100)]
    return [pattern[k % 100] for k in range(steps)]


def on_off(n: int, steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    """Return a platoon with 8 neighbours ahead and behind whose links fail and come back, each at its own times."""
    return switching(n, platoon_links(n, 8), steps, draw)


def on_off_regular(n: int, steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    """Return the same for a random 10-regular graph: no small part of it is robust, so nothing grows from a seed."""
    graph = nx.random_regular_graph(10, n, seed=int(draw.integers(2**31)))
    return switching(n, list(graph.edges()), steps, draw)


def random_waypoint(n: int, steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    """Return vehicles on the unit square, each on its way to one random place after another, in reach up to 0.3."""
    places, goals = draw.random((n, 2)), draw.random((n, 2))
    graphs = []
    for _ in range(steps):
        way = goals - places
        length = np.linalg.norm(way, axis=1)
        arrived = length < 0.004
        places = np.where(arrived[:, None], goals, places + 0.004 * way / np.maximum(length, 1e-9)[:, None])
        goals[arrived] = draw.random((int(arrived.sum()), 2))
        near = np.linalg.norm(places[:, None] - places[None], axis=2) < 0.3
        graphs.append(graph_of(n, np.argwhere(np.triu(near, 1)).tolist()))
    return graphs


def independent(n: int, steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    """Return random graphs that have nothing to do with each other: what the shortcuts cost where they save little."""
    pairs = np.argwhere(np.triu(np.ones((n, n), dtype=bool), 1))
    return [graph_of(n, pairs[draw.random(len(pairs)) < 0.03].tolist()) for _ in range(steps)]


def switching(n: int, links: list[tuple[int, int]], steps: int, draw: np.random.Generator) -> list[nx.Graph]:
    up = draw.random(len(links)) < 0.75
    graphs = []
    for _ in range(steps):
        change = draw.random(len(links))
        up = np.where(up, change >= 0.01, change < 0.03)
        graphs.append(graph_of(n, [links[k] for k in np.flatnonzero(up)]))
    return graphs


def platoon_links(n: int, reach: int) -> list[tuple[int, int]]:
    return [(u, v) for u in range(n) for v in range(u + 1, min(n, u + reach + 1))]


def graph_of(n: int, links: Iterable[Sequence[int]]) -> nx.Graph:
    graph = nx.empty_graph(n)
    graph.add_edges_from(links)
    return graph


CASES = (
    Case("repeating", repeating, 10),
    Case("on-off platoon", on_off, 10),
    Case("on-off 10-regular", on_off_regular, 50),
    Case("random waypoint", random_waypoint, 80),
    Case("independent", independent, 10),
)


def naive_seconds(graphs: list[nx.Graph], window: int, sample: int) -> float:
    """Return the seconds that the naive loop needs for all windows, scaled up from ``sample`` of them."""
    count = len(graphs) - window + 1
    starts = np.unique(np.linspace(0, count - 1, min(sample, count)).astype(int))
    began = time.perf_counter()
    for start in starts.tolist():
        rb.check_rs_robustness(nx.compose_all(graphs[start : start + window]), R)
    return (time.perf_counter() - began) * count / len(starts)


def measure(case: Case, n: int, steps: int, seed: int, sample: int) -> list[Row]:
    graphs = case.steps(n, steps, np.random.default_rng(seed))
    began = time.perf_counter()
    sequence = TimeVaryingGraph(graphs)
    reading = time.perf_counter() - began
    rows = []
    for question, window in (("all windows", case.window), ("smallest", None)):
        found = check_joint_robustness(sequence, R, window=window, all_windows=window is not None)
        # The naive way to the smallest window is bisection: at least one whole pass at the answer and one below it.
        naive = (1 if window else 2) * naive_seconds(graphs, found.window or case.window, sample)
        rows.append(row_of(case, n, steps, question, found, reading, naive))
        print_row(rows[-1])
    return rows


def row_of(case: Case, n: int, steps: int, question: str, found: JointResult, reading: float, naive: float) -> Row:
    return Row(
        case.name, n, steps, question, found.verdict.value, found.window, found.stats["windows"], len(found.unions),
        found.stats["searches"], reading, found.seconds, naive, naive / found.seconds,
    )  # fmt: skip


def print_row(row: Row) -> None:
    print(
        f"{row.case:<18} {row.question:<12} {row.verdict:<11} {row.window or '-':>6} {row.windows:>8} {row.unions:>7} "
        f"{row.searches:>8} {row.reading:>8.2f} {row.seconds:>8.2f} {row.naive:>9.1f} {row.ratio:>8.0f}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="1,000 steps, not 10,000")
    parser.add_argument("--seed", type=int, default=6)
    parser.add_argument("--nodes", type=int, default=50)
    parser.add_argument("--json", metavar="FILE", help="write the table as JSON too")
    options = parser.parse_args()
    steps, sample = (1_000, 30) if options.quick else (10_000, 100)
    rb.check_rs_robustness(nx.random_regular_graph(6, 20, seed=1), R)
    print(f"{R}-robust over windows; {options.nodes} nodes, {steps} steps, seed {options.seed}; seconds on one core")
    print(
        f"{'case':<18} {'question':<12} {'verdict':<11} {'window':>6} {'windows':>8} {'unions':>7} {'searches':>8} "
        f"{'reading':>8} {'seconds':>8} {'naive':>9} {'ratio':>8}"
    )
    rows = [row for case in CASES for row in measure(case, options.nodes, steps, options.seed, sample)]
    mean = math.exp(sum(math.log(row.ratio) for row in rows) / len(rows))
    print(f"geometric mean of the ratios: {mean:.0f}; slowest: {max(row.seconds for row in rows):.2f} s")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as stream:
            json.dump({"schema": "robustness/bench-joint/1", "rows": [asdict(row) for row in rows]}, stream, indent=1)


if __name__ == "__main__":
    main()
