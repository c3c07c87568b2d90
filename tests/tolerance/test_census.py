"""The census against a count that shares nothing with it but the graphs: no search, no lemma, sets tried out."""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations

import networkx as nx
import pytest

import robustness as rb
from robustness.constructions.small_graphs import digraph_of_masks, graphs_up_to_isomorphism
from robustness.paper.audit.census import CensusRow, census, one_node_more
from tests.oracles import graphs


def held(masks: tuple[int, ...], inside: int, f: int) -> list[int]:
    """Return every nonempty set within ``inside`` of which every node hears at most f others within ``inside``."""
    found, S = [], inside
    while S:
        if all((masks[i] & inside & ~S).bit_count() <= f for i in range(len(masks)) if S >> i & 1):
            found.append(S)
        S = (S - 1) & inside
    return found


def is_apart(masks: tuple[int, ...], inside: int, f: int) -> bool:
    """Return whether the graph within ``inside`` is not (f+1)-robust."""
    sets = held(masks, inside, f)
    return any(not S1 & S2 for S1, S2 in combinations(sets, 2))


def violates(masks: tuple[int, ...], f: int) -> bool:
    """Return whether the graph is not (f+1,f+1)-robust, by the definition."""
    n = len(masks)
    cost: dict[int, int] = {}
    for S in range(1, 1 << n):
        reached = sum((masks[i] & ~S).bit_count() > f for i in range(n) if S >> i & 1)
        if reached < S.bit_count() and reached <= f:
            cost[S] = reached
    return any(not S1 & S2 and a + b <= f for (S1, a), (S2, b) in combinations(cost.items(), 2))


def counted(masks: tuple[int, ...], f: int) -> str:
    """Return where a connected graph belongs: promised, refuted, trapped or free."""
    n, everybody = len(masks), (1 << len(masks)) - 1
    if not is_apart(masks, everybody, 2 * f):
        return "promised"
    if violates(masks, f):
        return "refuted"
    removals = (sum(1 << i for i in bad) for size in range(min(f, n - 2) + 1) for bad in combinations(range(n), size))
    return "trapped" if any(is_apart(masks, everybody & ~M, f) for M in removals) else "free"


def assert_agrees(row: CensusRow, connected: list[rb.Digraph]) -> None:
    tally: dict[str, int] = defaultdict(int)
    for graph in connected:
        tally[counted(graph.in_masks, row.f)] += 1
    found = {"promised": row.promised, "refuted": row.refuted, "trapped": len(row.trapped), "free": len(row.free)}
    assert {key: value for key, value in found.items() if value} == dict(tally)
    assert row.connected == len(connected) == sum(found.values())


def connected_graphs(n: int) -> list[rb.Digraph]:
    return [graph for graph in graphs(n) if nx.is_connected(graph.to_networkx())]


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_small(n: int) -> None:
    for row in census(n):
        if row.n == n:
            assert_agrees(row, connected_graphs(n))


def test_rows_are_for_every_f_that_some_graph_survives() -> None:
    assert [(row.n, row.f) for row in census(7)] == [
        (3, 1), (4, 1), (5, 1), (5, 2), (6, 1), (6, 2), (7, 1), (7, 2), (7, 3),
    ]  # fmt: skip


def test_the_numbers_of_the_documentation() -> None:
    found = [(row.n, row.f, row.gap, len(row.free)) for row in census(7)]
    assert found[-3:] == [(7, 1, 181, 30), (7, 2, 10, 2), (7, 3, 1, 0)]


@pytest.mark.slow
@pytest.mark.parametrize("f", [1, 2, 3])
def test_seven_nodes(f: int) -> None:
    (row,) = [row for row in census(7) if (row.n, row.f) == (7, f)]
    assert_agrees(row, connected_graphs(7))


@pytest.mark.slow
def test_eight_nodes() -> None:
    masks = one_node_more(graphs_up_to_isomorphism(7))
    assert len(masks) == 12_346
    everybody = [digraph_of_masks(row, directed=False) for row in masks]
    connected = [graph for graph in everybody if nx.is_connected(graph.to_networkx())]
    assert len(connected) == 11_117
    rows = [row for row in census(8) if row.n == 8]
    assert [(row.f, row.gap, len(row.free)) for row in rows] == [(1, 2743, 619), (2, 89, 8), (3, 3, 0)]
    for row in rows:
        assert_agrees(row, connected)
