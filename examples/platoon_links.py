"""Two lanes of vehicles that slide past each other: links between the lanes come and go with the distance.

Run it with ``python examples/platoon_links.py [--save DIRECTORY]``. Within its lane every vehicle hears all others.
Across the lanes a short-range radio reaches only whoever is beside, so at any step a vehicle hears at most one
vehicle of the other lane, and no single step is 3-robust. One lane shuttles to and fro over three places.

* ``fast``: 10 m a step. The union over every 8 steps is 3-robust, and 8 <= tau = 11: that is what the paper's corollary
  on time-varying networks asks for one malicious vehicle (2f + 1 = 3). The simulator plays every adversary it has
  in every vehicle, with values up to tau steps old in use: all runs agree.
* ``slow``: 0.5 m a step. The union over a whole shuttle is the same, so it is jointly 3-robust as well, but over many
  more steps than tau: nothing is promised. Indeed nobody need lie: at any step a vehicle remembers at most one voice
  from the other lane, the filter drops it, and the lanes stay apart for ever, to the last bit.

The vehicles speak of formation coordinates (positions less their place in the formation), so to agree is to keep it.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import networkx as nx

from robustness.simulation import (
    ADVERSARIES,
    RunVerdict,
    Scenario,
    Schedule,
    Start,
    as_topology,
    random_start,
    simulate,
)
from robustness.simulation.schedules import EveryStep, RandomDelays
from robustness.time_varying import JointResult, TimeVaryingGraph, check_joint_robustness, encode_sequence, joint_curve

LANE = 5
SPACING = 20.0
RANGE = 5.0
PLACES = 3
TAU = 11
F = 1


def shuttle(speed: float) -> TimeVaryingGraph:
    """Return the links of one shuttle, for ever: ``A0 .. A4`` slide past ``B0 .. B4`` at ``speed`` metres a step."""
    way = round(PLACES * SPACING / speed)
    return TimeVaryingGraph.from_function(lambda k: links(speed * min(k, 2 * way - k)), 2 * way, period=2 * way)


def links(shift: float) -> nx.Graph:
    """Return who is in reach when lane A is ``shift`` metres ahead of its place beside lane B."""
    graph = nx.Graph()
    for lane in "AB":
        nx.add_path(graph, (f"{lane}{i}" for i in range(LANE)))
        graph.add_edges_from((f"{lane}{i}", f"{lane}{j}") for i in range(LANE) for j in range(i))
    graph.add_edges_from(
        (f"A{i}", f"B{j}") for i in range(LANE) for j in range(LANE) if abs((i - j) * SPACING + shift) < RANGE
    )
    return graph


def decide(name: str, sequence: TimeVaryingGraph) -> JointResult:
    """Decide joint robustness for f malicious vehicles and say what the corollary makes of it."""
    r = 2 * F + 1
    single = check_joint_robustness(sequence, r, window=1, all_windows=True)
    found = check_joint_robustness(sequence, r, tau=TAU)
    verdict = "l <= tau, so the corollary applies" if found.within_tau else "l > tau, so nothing is promised"
    print(
        f"{name}: {len(sequence) - len(single.failing_starts())} of {len(sequence)} steps are {r}-robust by themselves"
    )
    print(f"  smallest window l for each r: {dict(joint_curve(sequence))}")
    print(f"  jointly {r}-robust over every l = {found.window} steps; tau = {TAU}: {verdict}")
    return found


def play_battery(sequence: TimeVaryingGraph, steps: int = 400) -> int:
    """Run every adversary in every vehicle; return how many of the runs agree, after checking that all do."""
    network = as_topology(sequence, steps)
    starts = [random_start(network.union, [label], seed) for seed, label in enumerate(sequence.labels)]
    agreed = 0
    for schedule in (Schedule(tau=TAU), Schedule(EveryStep(), RandomDelays(2), tau=TAU)):
        for name, adversary in ADVERSARIES.items():
            scenario = Scenario(network, F, adversary=adversary(), schedule=schedule, steps=steps, dwell=50)
            for outcome in simulate(scenario, starts):
                if outcome.verdict is not RunVerdict.AGREEMENT:
                    raise SystemExit(f"the promise is broken by {name}: {outcome}")
                agreed += 1
    return agreed


def play_without_a_liar(sequence: TimeVaryingGraph, steps: int = 2000) -> RunVerdict:
    """Run the network with nobody malicious, one lane at 0 and the other at 100; return the verdict."""
    network = as_topology(sequence, steps)
    lanes = tuple(f"A{i}" for i in range(LANE)), tuple(f"B{i}" for i in range(LANE))
    positions = tuple(0.0 if label in lanes[0] else 100.0 for label in sequence.labels)
    start = Start(frozenset(), positions, (0.0,) * sequence.n)
    (outcome,) = simulate(
        Scenario(network, F, schedule=Schedule(tau=TAU), steps=steps, groups=lanes, dwell=50), [start]
    )
    print(f"  spread {outcome.initial_spread:g} at step 0, {outcome.spread:g} at step {steps}, exact: {outcome.exact}")
    return outcome.verdict


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--save", type=Path, metavar="DIRECTORY", help="write both sequences for robustness joint")
    folder = parser.parse_args().save
    fast, slow = shuttle(10.0), shuttle(0.5)
    decide("fast", fast)
    print(f"  simulated: {play_battery(fast)} runs, every adversary in every vehicle: all agree")
    decide("slow", slow)
    print(f"  simulated without any liar: {play_without_a_liar(slow).value}")
    print(f"  the fast shuttle from the same start: {play_without_a_liar(fast).value}")
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for name, sequence in (("fast", fast), ("slow", slow)):
            path = folder / f"{name}.json"
            path.write_bytes(encode_sequence(sequence))
            print(f"wrote {path}: robustness joint {path} -r 3 --tau {TAU}")


if __name__ == "__main__":
    main()
