"""The lists of small graphs are complete and free of repetition, and the batch profiles follow the definition."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from robustness.constructions.small_graphs import (
    batch_profiles,
    digraph_of_masks,
    digraphs_up_to_isomorphism,
    each_graph,
    graphs_up_to_isomorphism,
)
from robustness.errors import InvalidParameter


def test_numbers_of_classes_are_the_known_ones():
    assert [len(graphs_up_to_isomorphism(n)) for n in range(8)] == [1, 1, 2, 4, 11, 34, 156, 1044]
    assert [len(digraphs_up_to_isomorphism(n)) for n in range(6)] == [1, 1, 3, 16, 218, 9608]


def test_no_two_digraphs_on_three_nodes_are_isomorphic():
    listed = [digraph_of_masks(masks).to_networkx() for masks in digraphs_up_to_isomorphism(3)]
    assert not any(nx.is_isomorphic(one, two) for one, two in combinations(listed, 2))


@pytest.mark.parametrize("lists", [graphs_up_to_isomorphism, digraphs_up_to_isomorphism])
def test_fewest_arcs_come_first(lists):
    arcs = np.bitwise_count(lists(5)).sum(axis=1)
    assert (np.diff(arcs) >= 0).all()


@pytest.mark.parametrize(("directed", "largest"), [(False, 5), (True, 3)])
def test_batch_profiles_follow_the_definition(holds, directed, largest):
    for graph in each_graph(largest, directed=directed):
        (row,) = batch_profiles(np.array([graph.in_masks], dtype=np.int64).reshape(1, graph.n)).tolist()
        for r, s_max in enumerate(row):
            for s in range(1, graph.n + 1):
                assert holds(graph, r, s) == (s <= s_max), (graph.in_masks, r, s)


def test_numbers_of_graphs_with_each_r():
    def counts(n):
        return np.bincount((batch_profiles(graphs_up_to_isomorphism(n))[:, 1:] > 0).sum(axis=1)).tolist()

    assert counts(5) == [13, 13, 6, 2]
    assert counts(6) == [44, 67, 37, 8]


@pytest.mark.parametrize(("lists", "n"), [(graphs_up_to_isomorphism, 8), (digraphs_up_to_isomorphism, 6)])
def test_longer_lists_are_refused(lists, n):
    with pytest.raises(InvalidParameter, match="up to isomorphism"):
        lists(n)
