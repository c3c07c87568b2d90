"""Mending tried out: every set of links, from the cheapest on, against the definitions alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import combinations

import networkx as nx

from robustness import Digraph
from robustness.threat_models import THREAT_MODELS
from tests.oracles import brute_profile
from tests.tolerance.brute_force import has_standing_attack, has_trap

Link = tuple[int, int]
Condition = Callable[[Digraph], bool]


def is_robust(r: int, s: int = 1) -> Condition:
    """Return the condition (r,s)-robust."""
    return lambda graph: brute_profile(graph).get(r, 0) >= s


def survives(f: int, model: str) -> Condition:
    """Return the condition that f malicious nodes of a model are survived, by the sets that would not be."""
    threat = THREAT_MODELS[model]
    has_attack = has_trap if threat.two_faces else has_standing_attack
    return lambda graph: not has_attack(graph.in_masks, f, threat.local)


def candidates(graph: nx.Graph) -> list[Link]:
    """Return every link that is not there."""
    nodes = sorted(graph)
    pairs = ((u, v) for u in nodes for v in nodes if u != v and (graph.is_directed() or u < v))
    return [pair for pair in pairs if not graph.has_edge(*pair)]


def least_cost(
    graph: nx.Graph, condition: Condition, links: Iterable[Link], cost: Callable[[Link], int] = lambda _: 1
) -> int | None:
    """Return the least cost of added links that reach the condition, or None when all of them do not."""
    pool = list(links)
    best: int | None = None
    for count in range(len(pool) + 1):
        for chosen in combinations(pool, count):
            price = sum(map(cost, chosen))
            if best is not None and price >= best:
                continue
            mended = graph.copy()
            mended.add_edges_from(chosen)
            if condition(Digraph.from_networkx(mended)):
                best = price
    return best
