"""Sequences of graphs: what is stored, which windows there are, and errors that name the step."""

from __future__ import annotations

from collections.abc import Iterator

import networkx as nx
import numpy as np
import pytest

import robustness as rb
from robustness.time_varying import TimeVaryingGraph
from robustness.time_varying.sequence import SlidingUnion, as_time_varying


def path_steps() -> list[nx.Graph]:
    """Return one link of the path 0-1-2-3 per step."""
    steps = []
    for u in range(3):
        graph = nx.empty_graph(4)
        graph.add_edge(u, u + 1)
        steps.append(graph)
    return steps


def test_steps_are_the_graphs_given() -> None:
    steps = path_steps()
    sequence = TimeVaryingGraph(steps)
    assert len(sequence) == 3
    assert (sequence.n, sequence.prefix, sequence.directed) == (4, 3, False)
    assert [sequence.graph_at(k) for k in range(3)] == [rb.Digraph.from_networkx(graph) for graph in steps]


def test_windows_of_a_trace_do_not_wrap() -> None:
    sequence = TimeVaryingGraph(path_steps())
    assert [list(sequence.window_starts(k)) for k in (1, 2, 3, 4)] == [[0, 1, 2], [0, 1], [0], []]
    with pytest.raises(rb.InvalidParameter, match=r"trace of 3 steps has steps 0\.\.2, not 3"):
        sequence.union(2, 2)


def test_windows_of_a_periodic_sequence_wrap() -> None:
    sequence = TimeVaryingGraph(path_steps(), period=3)
    assert list(sequence.window_starts(7)) == [0, 1, 2]
    assert sequence.union(2, 2) == rb.Digraph(range(4), [(2, 3), (3, 2), (0, 1), (1, 0)])
    assert sequence.graph_at(100) == sequence.graph_at(1)


def test_windows_of_a_prefix_and_a_period() -> None:
    sequence = TimeVaryingGraph(path_steps(), period=2)
    assert (sequence.prefix, [sequence.stored_step(k) for k in range(8)]) == (1, [0, 1, 2, 1, 2, 1, 2, 1])
    assert list(sequence.window_starts(2)) == [0, 1, 2]
    assert sequence.union(2, 3) == sequence.union(1, 2) != sequence.union(0, 2)


def test_a_window_longer_than_everything_is_the_union_of_everything() -> None:
    sequence = TimeVaryingGraph(path_steps(), period=3)
    assert sequence.union(1, 10**12) == sequence.union(0, 3)


def test_sliding_back_and_jumping_ahead() -> None:
    draw = np.random.default_rng(0)
    sequence = TimeVaryingGraph(path_steps(), period=2)
    window = SlidingUnion(sequence)
    for start, length in draw.integers(1, 6, size=(60, 2)).tolist():
        window.move(start, length)
        assert sequence.digraph(window.present) == sequence.union(start, length)
        assert window.counts.sum() == 2 * min(length, 3)


def test_arcs_in_common_with_the_next_windows() -> None:
    sequence = TimeVaryingGraph.from_arcs(range(3), [[(0, 1), (1, 2)], [(0, 1)], [(0, 1), (2, 0)], [(2, 0)]])
    window = SlidingUnion(sequence)
    window.move(0, 2)
    commons = [sequence.digraph(window.lasting(ahead)) for ahead in range(5)]
    assert [set(common.arcs()) for common in commons] == [{(0, 1), (1, 2)}, {(0, 1)}, {(0, 1)}, {(0, 1)}, {(0, 1)}]
    assert sequence.digraph(window.present) == sequence.union(0, 2)


def test_digraphs_multigraphs_and_networkx_mix() -> None:
    multi = nx.MultiGraph([(0, 1)])
    steps = [rb.Digraph([0, 1], [(0, 1)]), multi, nx.DiGraph([(1, 0)])]
    sequence = TimeVaryingGraph(steps)
    assert [set(sequence.graph_at(k).arcs()) for k in range(3)] == [{(0, 1)}, {(0, 1), (1, 0)}, {(1, 0)}]
    assert sequence.directed


def test_the_graphs_are_not_changed() -> None:
    steps = path_steps()
    before = [(list(graph.nodes(data=True)), list(graph.edges(data=True))) for graph in steps]
    TimeVaryingGraph(steps, period=1).union(0, 5)
    assert [(list(graph.nodes(data=True)), list(graph.edges(data=True))) for graph in steps] == before


def test_a_graph_given_twice_in_a_list_is_two_steps() -> None:
    once, other = path_steps()[:2]
    sequence = TimeVaryingGraph([once, other, once])
    assert sequence.graph_at(2) == sequence.graph_at(0) != sequence.graph_at(1)


def test_labels_one_and_text_one_are_two_nodes() -> None:
    graph = nx.DiGraph([(1, "1"), ((0, 1), 1)])
    sequence = TimeVaryingGraph([graph])
    assert sequence.labels == (1, "1", (0, 1))
    assert sequence.graph_at(0) == rb.Digraph.from_networkx(graph)


def test_numpy_integers_as_labels() -> None:
    graph = nx.DiGraph([(np.int64(0), np.int64(1))])
    sequence = TimeVaryingGraph([nx.DiGraph([(0, 1)]), graph])
    assert sequence.labels == (0, 1)
    assert sequence.graph_at(0) == sequence.graph_at(1)


def test_empty_steps_and_empty_graphs() -> None:
    sequence = TimeVaryingGraph([nx.empty_graph(3), nx.complete_graph(3), nx.empty_graph(3)])
    assert [sequence.graph_at(k).arc_count for k in range(3)] == [0, 6, 0]
    assert TimeVaryingGraph([nx.empty_graph(0)] * 2).union(0, 2) == rb.Digraph([], [])


@pytest.mark.parametrize("kind", [list, iter])
def test_a_changed_node_set_names_the_step(kind: type) -> None:
    steps = path_steps()
    steps[2].add_node("new")
    with pytest.raises(rb.InvalidGraph, match=r"^step 2: .* node 'new' is new"):
        TimeVaryingGraph(kind(steps))
    steps[2].remove_nodes_from(["new", 3])
    with pytest.raises(rb.InvalidGraph, match=r"^step 2: .* node 3 is missing"):
        TimeVaryingGraph(kind(steps))
    with pytest.raises(rb.InvalidGraph, match=r"^step 1: .* node 2 is new"):
        TimeVaryingGraph([rb.Digraph(range(2), []), rb.Digraph(range(3), [])])


def test_a_step_that_is_no_graph_names_the_step() -> None:
    with pytest.raises(rb.InvalidGraph, match=r"^step 1: a graph is .* not int"):
        TimeVaryingGraph([nx.empty_graph(2), 7])
    with pytest.raises(rb.InvalidGraph, match=r"^step 0: a graph is .* not str"):
        TimeVaryingGraph("ab")


def test_self_loops_are_dropped_with_a_word_once_a_step() -> None:
    with pytest.warns(rb.GraphWarning, match=r"^step 0: 1 self-loop") as caught:
        sequence = TimeVaryingGraph([nx.Graph([(0, 0), (0, 1)])])
    assert len(caught) == 1
    assert set(sequence.graph_at(0).arcs()) == {(0, 1), (1, 0)}


def test_from_arcs() -> None:
    sequence = TimeVaryingGraph.from_arcs("ab", [[("a", "b"), ("a", "b")], []], directed=False)
    assert [sequence.graph_at(k).arc_count for k in range(2)] == [2, 0]
    with pytest.raises(rb.InvalidGraph, match=r"^step 1: an arc joins two nodes .* 'c'"):
        TimeVaryingGraph.from_arcs("ab", [[], [("a", "c")]])
    with pytest.raises(rb.InvalidGraph, match=r"^step 0: an arc is a pair"):
        TimeVaryingGraph.from_arcs("abc", [[("a", "b", "c")]])


def test_from_function_reads_each_graph_before_the_next_call() -> None:
    graph = nx.empty_graph(3)

    def grow(k: int) -> nx.Graph:
        if k:
            graph.add_edge(k - 1, k)
        return graph

    sequence = TimeVaryingGraph.from_function(grow, 3, period=1)
    assert [sequence.graph_at(k).arc_count for k in range(4)] == [0, 2, 4, 4]


@pytest.mark.parametrize("horizon", [0, -1, 2.0, True, None])
def test_a_horizon_is_a_positive_integer(horizon: object) -> None:
    with pytest.raises(rb.InvalidParameter, match="horizon"):
        TimeVaryingGraph.from_function(nx.empty_graph, horizon)


@pytest.mark.parametrize("period", [0, 4, -1, 1.0, True, "3"])
def test_a_period_lies_in_the_steps(period: object) -> None:
    with pytest.raises(rb.InvalidParameter, match=r"period is an integer in 1\.\.number of steps = 1\.\.3"):
        TimeVaryingGraph(path_steps(), period=period)


@pytest.mark.parametrize("steps", [[], iter(())])
def test_there_is_at_least_one_step(steps: Iterator[nx.Graph]) -> None:
    with pytest.raises(rb.InvalidParameter, match="at least one step"):
        TimeVaryingGraph(steps)


@pytest.mark.parametrize("length", [0, -1, 1.5, True, None])
def test_a_window_has_at_least_one_step(length: object) -> None:
    with pytest.raises(rb.InvalidParameter, match="a window has an integer number of steps"):
        TimeVaryingGraph(path_steps()).window_starts(length)


def test_a_function_needs_a_horizon() -> None:
    with pytest.raises(rb.InvalidParameter, match=r"not function; a function of the step goes to .*from_function"):
        TimeVaryingGraph(lambda k: nx.empty_graph(3))


def test_a_list_of_graphs_is_a_finite_trace() -> None:
    assert as_time_varying(path_steps()).period is None
    with pytest.raises(rb.InvalidParameter, match="not Graph"):
        as_time_varying(nx.path_graph(3))


def test_repr_says_what_kind_it_is() -> None:
    assert repr(TimeVaryingGraph(path_steps())) == "<TimeVaryingGraph: finite trace, 4 nodes, 3 steps, 6 arcs in all>"
    assert "periodic" in repr(TimeVaryingGraph(path_steps(), period=3))
    assert "prefix + period 2" in repr(TimeVaryingGraph(path_steps(), period=2))
