"""Mending beside its peers: the same model without the oracle, and a greedy loop over violating pairs.

    python benchmarks/mending.py            # small graphs: all three
    python benchmarks/mending.py --topohub 24 --timeout 60   # every topohub graph up to 24 nodes to (2,2)

*All pairs*: the master problem with every violating pair of the network before mending written out (n <= 8). *Greedy*:
break the pair that the exact search returns by its cheapest unit, until none is left; nothing is given up.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from itertools import product

import networkx as nx

import robustness as rb
from robustness.definitions import is_violation
from robustness.limits import Limits
from robustness.mending.actions import actions_for
from robustness.mending.demands import Side, Unit, masks_of, units
from robustness.mending.goal import Part
from robustness.mending.hitting_set import with_actions
from robustness.mending.master import Master


def all_pairs(graph: rb.Digraph, r: int, s: int) -> tuple[int | None, float]:
    """Return the optimum of the whole model, and the seconds."""
    started = time.perf_counter()
    part, n = Part(r, s), graph.n
    actions = actions_for(graph, None, None, forbid=(), require=(), max_in_degree=None, one_way=False)
    master = Master(graph, actions)
    for roles in product((0, 1, 2), repeat=n):
        S1, S2 = (frozenset(i for i in range(n) if roles[i] == k) for k in (1, 2))
        if S1 and S2 and min(S1) < min(S2) and is_violation(graph, S1, S2, r, s):
            master.add(*(Side(part, 0, sum(1 << i for i in side)) for side in (S1, S2)))
    proposal = master.solve(Limits(), None)
    return proposal.bound, time.perf_counter() - started


def greedy(graph: rb.Digraph, r: int, s: int) -> tuple[int | None, float]:
    """Return what the loop adds, and the seconds."""
    started = time.perf_counter()
    actions = actions_for(graph, None, None, forbid=(), require=(), max_in_degree=None, one_way=False)
    chosen: set[int] = set()
    while True:
        mended = with_actions(graph, actions, chosen)
        witness = rb.check_rs_robustness(mended, r, s).witness
        if witness is None:
            return len(chosen), time.perf_counter() - started
        heard, options = masks_of(mended), []
        for labels in witness:
            side = Side(Part(r, s), 0, sum(1 << i for i in mended.ids(labels)))
            options += [(missing, take) for missing, take in _ways(side, heard, actions, chosen)]
        if not options:
            return None, time.perf_counter() - started
        chosen.update(min(options)[1])


def _ways(side: Side, heard: list[int], actions: object, chosen: set[int]) -> Iterator[tuple[int, list[int]]]:
    for unit in units(side, len(heard)):
        missing = unit.enough - (heard[unit.node] & unit.outside).bit_count()
        supplies = [a for a in _suppliers(unit, actions) if a not in chosen]
        if 0 < missing <= len(supplies):
            yield missing, supplies[:missing]


def _suppliers(unit: Unit, actions: object) -> list[int]:
    items = actions.items  # type: ignore[attr-defined]
    return [
        a
        for a, item in enumerate(items)
        if any(head == unit.node and unit.outside >> tail & 1 for tail, head in item.arcs)
    ]


def small() -> None:
    """Print cost and time of the three on the same small graphs."""
    print("| graph | goal | mend | s | all pairs | s | ratio | greedy | s |")
    print("|---|---|---|---|---|---|---|---|---|")
    graphs = {
        "path 6": nx.path_graph(6),
        "path 7": nx.path_graph(7),
        "cycle 8": nx.cycle_graph(8),
        "star 7": nx.star_graph(6),
        "tree 8": nx.random_labeled_tree(8, seed=1),
        "G(8,.3)": nx.gnp_random_graph(8, 0.3, seed=2),
    }
    for name, network in graphs.items():
        graph = rb.Digraph.from_networkx(network)
        for r, s in ((2, 1), (2, 2), (3, 1)):
            started = time.perf_counter()
            found = rb.mend(graph, (r, s))
            seconds = time.perf_counter() - started
            (whole, slow), (added, quick) = all_pairs(graph, r, s), greedy(graph, r, s)
            print(
                f"| {name} | ({r},{s}) | {found.cost} | {seconds:.2f} | {whole} | {slow:.2f} | {slow / seconds:.1f} "
                f"| {added} | {quick:.2f} |",
                flush=True,
            )


def backbones(most: int, timeout: float, every: int) -> None:
    """Print links found for (2,2), the bound and the time for every topohub graph of up to ``most`` nodes.

    ``every``: of these only each so manieth, in the order of their numbers of nodes.
    """
    from robustness.files.topohub_names import list_names

    proven = total = 0
    print("| network | nodes | links found | at least | s |")
    print("|---|---|---|---|---|")
    networks = [(name, rb.read_topology(f"topohub:{name}")) for name in list_names()]
    networks = sorted((pair for pair in networks if 4 <= pair[1].n <= most), key=lambda pair: pair[1].n)
    for name, graph in networks[::every]:
        started = time.perf_counter()
        found = rb.mend(graph, (2, 2), time_limit=timeout)
        seconds = time.perf_counter() - started
        total += 1
        proven += found.verdict.value == "optimal"
        print(f"| {name} | {graph.n} | {found.cost} | {found.lower_bound} | {seconds:.1f} |", flush=True)
    print(f"{proven} of {total} proven optimal within {timeout:g} s each")


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--topohub", type=int, metavar="N", help="topohub graphs of up to N nodes")
    parser.add_argument("--timeout", type=float, default=60.0, metavar="SECONDS")
    parser.add_argument("--every", type=int, default=1, metavar="K", help="each K-th of them only")
    asked = parser.parse_args(sys.argv[1:])
    if asked.topohub is None:
        small()
    else:
        backbones(asked.topohub, asked.timeout, asked.every)


if __name__ == "__main__":
    main()
