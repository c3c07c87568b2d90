"""How fast the simulator is: 1,000 runs of 50 nodes for 1,000 steps, against the plain per-node loop.

``python -m benchmarks.simulation [--quick] [--jobs N] [--seed N] [--output FILE]``. The plain loop is measured on a few
runs and steps of the same scenario and its time scaled up, since all of it would take an hour; every ratio is printed.
Imports happen in a warm-up that is not counted. Both give the same outcomes, which
is checked on the part that both run.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path

import networkx as nx

from robustness.simulation import ADVERSARIES, Scenario, as_topology, random_start, schedule_named, simulate
from robustness.simulation.reference import simulate_plainly

#: What is run: rule, schedule, tau, adversary.
CASES = (
    ("w-msr", "synchronous", 0, "constant"),
    ("dp-msr", "synchronous", 0, "sine"),
    ("adp-msr", "periodic", 11, "sine"),
    ("adp-msr", "random", 4, "constant"),
    ("adp-msr", "delayed", 3, "two-face"),
)
NODES, DENSITY, FAULTS = 50, 0.2, 2
PLAIN_RUNS, PLAIN_STEPS = 2, 15


def measure(case: tuple[str, str, int, str], runs: int, steps: int, jobs: int, seed: int) -> dict[str, object]:
    """Return the times of one case."""
    rule, schedule, tau, adversary = case
    network = as_topology(nx.gnp_random_graph(NODES, DENSITY, seed=seed), 1)
    starts = [random_start(network.union, [b % NODES, (b + 7) % NODES], seed + b) for b in range(runs)]
    scenario = Scenario(
        network, FAULTS, rule, adversary=ADVERSARIES[adversary](), schedule=schedule_named(schedule, tau), steps=steps
    )
    small = replace(scenario, steps=PLAIN_STEPS)
    fast = simulate(small, starts[:PLAIN_RUNS])  # the warm-up
    started = time.perf_counter()
    plain = simulate_plainly(small, starts[:PLAIN_RUNS])
    plain_seconds = (time.perf_counter() - started) * (runs * steps) / (PLAIN_RUNS * PLAIN_STEPS)
    if fast != plain:
        raise RuntimeError("the engine and the plain loop differ: please report")
    started = time.perf_counter()
    outcomes = simulate(scenario, starts, jobs=jobs)
    seconds = time.perf_counter() - started
    return {
        "rule": rule,
        "schedule": schedule,
        "adversary": adversary,
        "arcs": network.union.arc_count,
        "runs": runs,
        "steps": steps,
        "seconds": seconds,
        "plain_seconds_scaled": plain_seconds,
        "ratio": plain_seconds / seconds,
        "agreed": sum(outcome.verdict.value == "agreement" for outcome in outcomes),
    }


def main() -> None:
    """Measure every case and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the runs and of the steps")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, help="write the numbers as JSON")
    options = parser.parse_args()
    runs, steps = (100, 100) if options.quick else (1000, 1000)
    print(f"{runs} runs of {NODES} nodes, {steps} steps, f = {FAULTS}, {options.jobs} threads; warm-up not counted")
    print(f"{'rule':<8} {'schedule':<12} {'adversary':<9}  arcs  seconds  plain loop  ratio agreed")
    rows = []
    for case in CASES:
        row = measure(case, runs, steps, options.jobs, options.seed)
        rows.append(row)
        print(
            f"{row['rule']:<8} {row['schedule']:<12} {row['adversary']:<9} {row['arcs']:>5} {row['seconds']:>8.2f} "
            f"{row['plain_seconds_scaled']:>9.0f} s {row['ratio']:>6.0f} {row['agreed']:>6}"
        )
    if options.output is not None:
        document = {"schema": "robustness/bench-simulation/1", "rows": rows}
        options.output.write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
