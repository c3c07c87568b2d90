"""A trap by its definition, against the search by removing every small set."""

from __future__ import annotations

from itertools import product

import networkx as nx
import pytest

from robustness.constructions.small_graphs import each_graph
from robustness.errors import InvalidGraph, InvalidParameter, Undecided
from robustness.traps import is_trap, smallest_trap


def traps_by_definition(graph, f):
    """Every way to put each node into M, S1, S2 or nowhere that is a trap."""
    for roles in product("M12-", repeat=graph.n):
        sets = {role: {graph.labels[i] for i in range(graph.n) if roles[i] == role} for role in "M12"}
        if is_trap(graph, f, sets["M"], sets["1"], sets["2"]):
            yield sets


@pytest.mark.parametrize(("directed", "largest"), [(False, 5), (True, 3)])
@pytest.mark.parametrize("f", [0, 1, 2])
def test_found_exactly_where_the_definition_has_one(directed, largest, f):
    for graph in each_graph(largest, directed=directed):
        found = smallest_trap(graph, f)
        exists = next(traps_by_definition(graph, f), None) is not None
        assert (found is not None) == exists, graph.in_masks
        if found is not None:
            assert is_trap(graph, f, found.M, found.S1, found.S2)


def test_every_clause_of_the_definition_counts():
    wheel = nx.wheel_graph(5)
    assert is_trap(wheel, 1, {0}, {1, 2}, {3, 4})
    assert not is_trap(wheel, 1, {0}, {1, 3}, {2, 4}), "1 hears 2 and 4"
    assert not is_trap(wheel, 1, set(), {1, 2}, {3, 4}), "1 hears 0 and 4"
    assert not is_trap(wheel, 0, {0}, {1, 2}, {3, 4}), "M is too large"
    assert not is_trap(wheel, 1, {0}, set(), {3, 4})
    assert not is_trap(wheel, 1, {0}, {1, 2}, set())
    assert not is_trap(wheel, 1, {1}, {1, 2}, {3, 4})
    assert not is_trap(wheel, 1, {3}, {1, 2}, {3, 4})
    assert not is_trap(wheel, 2, {0}, {1, 2, 3}, {3, 4})


def test_a_smallest_malicious_set_is_found_first():
    trap = smallest_trap(nx.path_graph(4), 1)
    assert trap is not None
    assert trap.M == frozenset()
    assert set(trap.as_dict()) == {"M", "S1", "S2"}


def test_misuse():
    with pytest.raises(InvalidParameter, match="f is"):
        is_trap(nx.path_graph(3), -1, [], [0], [1])
    with pytest.raises(InvalidGraph):
        is_trap(nx.path_graph(3), 1, [], [0], [7])
    with pytest.raises(Undecided):
        smallest_trap(nx.random_regular_graph(20, 60, seed=1), 8, time_limit=1e-3)
