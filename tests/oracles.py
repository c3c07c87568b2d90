"""A second brute force, written from the definition alone and unlike ``exhaustive``: sets of arcs, every r at once.

``exhaustive`` answers one (r,s) at a time by walking the subsets of a mask. Here every set gets the sorted list of its
members' outside in-neighbour counts, and s_max(r) is the least number of reachable members over all disjoint pairs
in which neither side is fully reachable.
"""

from __future__ import annotations

from collections.abc import Iterator, Set
from functools import cache
from itertools import combinations, permutations, product

import networkx as nx

from robustness import Digraph

#: The largest n for which ``nx.graph_atlas_g`` has all undirected graphs.
ATLAS = 7


def brute_profile(graph: Digraph) -> dict[int, int]:
    """Return ``r -> s_max(r)`` for r = 1 .. ceil(n/2)."""
    n = graph.n
    hears = [frozenset(u for u, v in graph.arcs() if v == i) for i in range(n)]
    outside = {
        members: sorted(len(hears[i] - set(members)) for i in members)
        for size in range(1, n)
        for members in combinations(range(n), size)
    }
    counts = {frozenset(members): found for members, found in outside.items()}
    table = dict.fromkeys(range(1, (n + 1) // 2 + 1), max(n, 1))
    for (first, one), (second, two) in combinations(counts.items(), 2):
        if first.isdisjoint(second):
            for r in range(max(one[0], two[0]) + 1, len(table) + 1):
                table[r] = min(table[r], sum(count >= r for count in one + two))
    return table


def is_violating(graph: Digraph, first: Set[int], second: Set[int], r: int, s: int) -> bool:
    """Return whether the pair shows that the digraph is not (r,s)-robust."""
    reachable = 0
    for side in (first, second):
        heard = {v: {u for u, head in graph.arcs() if head == v and u not in side} for v in side}
        found = sum(len(outside) >= r for outside in heard.values())
        if found == len(side):  # Fully reachable, or empty.
            return False
        reachable += found
    return first.isdisjoint(second) and reachable < s


def labelled_digraphs(n: int) -> Iterator[Digraph]:
    """Yield all ``2^(n(n-1))`` digraphs on 0..n-1."""
    arcs = list(permutations(range(n), 2))
    for chosen in product((False, True), repeat=len(arcs)):
        yield Digraph(range(n), [arc for arc, taken in zip(arcs, chosen, strict=True) if taken])


@cache
def digraphs(n: int) -> tuple[Digraph, ...]:
    """Return one digraph on n nodes for every isomorphism class (1, 3, 16, 218 for n = 1, 2, 3, 4)."""
    seen: set[frozenset[tuple[int, int]]] = set()
    classes = []
    for graph in labelled_digraphs(n):
        arcs = frozenset(graph.arcs())
        if arcs not in seen:
            seen |= {frozenset((p[u], p[v]) for u, v in arcs) for p in permutations(range(n))}
            classes.append(graph)
    return tuple(classes)


@cache
def graphs(n: int) -> tuple[Digraph, ...]:
    """Return one undirected graph on n <= 7 nodes for every isomorphism class (1, 2, 4, 11, 34, 156, 1044)."""
    return tuple(Digraph.from_networkx(G) for G in nx.graph_atlas_g() if len(G) == n)
