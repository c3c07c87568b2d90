"""The trap search on 50 to 100 nodes: ``python benchmarks/traps.py [--quick] [--seed N] [--markdown FILE]``.

For each graph and f: is there a trap with at most f malicious nodes? ``search`` is ours, ``auto`` as users call it
(lemmas first), ``cp-sat`` the 0-1 programme, ``removals`` the literal condition: one exact (f+1)-robustness check for
every set of f nodes, timed on 30 of them and scaled up. Kernels are compiled before anything is timed.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import networkx as nx

import robustness as rb
from robustness.traps import find_trap

NODES = 50
#: The head of the table in docs/tolerance.md.
HEAD = "| graph | f | trap | search tree | auto | search | CP-SAT | removals |"
SAMPLE = 30


@dataclass(frozen=True)
class Row:
    """One line of the table; seconds, or None where the cap ended it."""

    graph: str
    f: int
    exists: bool | None
    nodes: int
    auto: float | None
    search: float | None
    cp_sat: float | None
    removals: float


def graphs(seed: int) -> dict[str, Callable[[], nx.Graph]]:
    """Return the graphs by name: random, regular, geometric, platoons; around the threshold for f = 1, 2, 3."""
    made: dict[str, Callable[[], nx.Graph]] = {}
    for p in (0.2, 0.3, 0.5, 0.8):
        made[f"G(50,{p})"] = lambda p=p: nx.gnp_random_graph(NODES, p, seed=seed)
    made["directed G(50,.3)"] = lambda: nx.gnp_random_graph(NODES, 0.3, seed=seed, directed=True)
    for d in (5, 7, 8, 10, 12, 14):
        made[f"{d}-regular"] = lambda d=d: nx.random_regular_graph(d, NODES, seed=seed)
    made["unit disk .4"] = lambda: nx.random_geometric_graph(NODES, 0.4, seed=seed)
    made["10-regular, 60"] = lambda: nx.random_regular_graph(10, 60, seed=seed)
    made["unit disk .4, 100"] = lambda: nx.random_geometric_graph(100, 0.4, seed=seed)
    made["platoon 5"] = lambda: nx.Graph((u, v) for u in range(NODES) for v in range(u + 1, min(NODES, u + 6)))
    made["circulant 6"] = lambda: nx.circulant_graph(NODES, range(1, 7))
    return made


def timed(graph: rb.Digraph, f: int, algorithm: str, cap: float) -> tuple[bool | None, float | None, int]:
    """Return the answer, its seconds (None past the cap) and the search's nodes."""
    found = find_trap(graph, f, algorithm=algorithm, time_limit=cap)
    return found.exists, None if found.exists is None else found.seconds, int(found.stats.get("nodes", 0))


def removals(graph: nx.Graph, f: int, seed: int) -> float:
    """Return the seconds that a check for every set of f nodes takes, scaled up from some."""
    draw = random.Random(seed)
    sets = [draw.sample(sorted(graph), f) for _ in range(SAMPLE)]
    started = time.perf_counter()
    for removed in sets:
        rest = graph.subgraph(set(graph) - set(removed))
        rb.check_rs_robustness(rest, f + 1, algorithm="subset-search", time_limit=5)
    return (time.perf_counter() - started) / SAMPLE * math.comb(len(graph), f)


def measure(name: str, make: Callable[[], nx.Graph], f: int, cap: float, peer_cap: float, seed: int) -> Row:
    """Return one row; the methods must agree."""
    graph = make()
    digraph = rb.Digraph.from_networkx(graph)
    auto, auto_seconds, _ = timed(digraph, f, "auto", cap)
    ours, seconds, nodes = timed(digraph, f, "search", cap)
    peer, peer_seconds, _ = timed(digraph, f, "cp-sat", peer_cap)
    answers = {each for each in (auto, ours, peer) if each is not None}
    if len(answers) > 1:
        raise SystemExit(f"{name}, f = {f}: the methods disagree: {auto}, {ours}, {peer}")
    exists = answers.pop() if answers else None
    return Row(name, f, exists, nodes, auto_seconds, seconds, peer_seconds, removals(graph, f, seed))


def shown(seconds: float | None, cap: float) -> str:
    return f"> {cap:g}" if seconds is None else f"{seconds:.3f}"


def told(row: Row, cap: float, peer_cap: float) -> list[str]:
    """Return the cells of a row as text."""
    answer = {True: "yes", False: "none", None: "?"}[row.exists]
    times = (shown(row.auto, cap), shown(row.search, cap), shown(row.cp_sat, peer_cap), f"{row.removals:.1f}")
    return [row.graph, str(row.f), answer, f"{row.nodes:,}", *times]


def put(page: Path, rows: list[Row], cap: float, peer_cap: float) -> None:
    """Replace the rows of the table that follows ``HEAD`` in a page."""
    before, head, after = page.read_text(encoding="utf-8").partition(HEAD)
    if not head:
        raise SystemExit(f"{page} has no table that begins with {HEAD!r}")
    rest = after.lstrip("\n").splitlines()
    while rest and rest[0].startswith("|"):
        rest.pop(0)
    table = ["| " + " | ".join(told(row, cap, peer_cap)) + " |" for row in rows]
    lines = [before + head, "|---|---|---|---|---|---|---|---|", *table, *rest]
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """Print the table, and write it as JSON where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a cap of 5 seconds")
    parser.add_argument("--cap", type=float, default=120.0, metavar="SECONDS", help="of our search")
    parser.add_argument("--peer-cap", type=float, default=20.0, metavar="SECONDS", help="of CP-SAT")
    parser.add_argument("--only", action="append", metavar="GRAPH", help="only this graph; may be repeated")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", metavar="FILE", help="write the table as JSON too")
    parser.add_argument("--markdown", metavar="FILE", help="put the table into this page, in place of the one it has")
    options = parser.parse_args()
    cap, peer_cap = (5.0, 5.0) if options.quick else (options.cap, options.peer_cap)
    find_trap(nx.petersen_graph(), 1, algorithm="search")
    rb.check_rs_robustness(nx.petersen_graph(), 2, algorithm="subset-search")
    print(f"traps in graphs on {NODES} nodes (or as named); seconds, one core, seed {options.seed}")
    print(f"caps {cap:g} and {peer_cap:g} s")
    print(f"{'graph':<18} {'f':>2} {'trap':<6} {'nodes':>9} {'auto':>9} {'search':>9} {'cp-sat':>9} {'removals':>9}")
    rows = []
    for name, make in graphs(options.seed).items():
        if options.only and name not in options.only:
            continue
        for f in (1, 2, 3):
            row = measure(name, make, f, cap, peer_cap, options.seed)
            rows.append(row)
            cells = told(row, cap, peer_cap)
            times = " ".join(f"{each:>9}" for each in cells[4:])
            print(f"{name:<18} {f:>2} {cells[2]:<6} {cells[3]:>9} {times}", flush=True)
    decided = sum(row.auto is not None for row in rows)
    print(f"decided by auto: {decided} of {len(rows)}")
    if options.markdown:
        put(Path(options.markdown), rows, cap, peer_cap)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as stream:
            json.dump({"schema": "robustness/bench-traps/1", "rows": [asdict(row) for row in rows]}, stream, indent=1)


if __name__ == "__main__":
    main()
