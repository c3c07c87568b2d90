"""Every answer against the definitions tried out: all short sequences of small graphs, and drawn ones."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import permutations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

import robustness as rb
from robustness.time_varying import JointResult, TimeVaryingGraph, check_joint_robustness, joint_curve
from robustness.time_varying.unions import RULES
from tests.time_varying.brute_force import (
    Arc,
    Step,
    all_digraphs,
    all_graphs,
    holds,
    is_robust,
    questions,
    smallest,
    starts,
    union,
    violates,
)


def sequence_of(n: int, steps: Sequence[Step], period: int | None) -> TimeVaryingGraph:
    return TimeVaryingGraph.from_arcs(range(n), steps, period)


def assert_smallest(n: int, steps: Sequence[Step], period: int | None, r: int, s: int) -> None:
    found = check_joint_robustness(sequence_of(n, steps, period), r, s)
    expected = smallest(n, steps, period, r, s)
    assert found.window == expected, (steps, period, r, s)
    assert found.verdict is (rb.Verdict.NOT_ROBUST if expected is None else rb.Verdict.ROBUST)


def values(n: int) -> list[tuple[int, int]]:
    return [(r, s) for r in range(1, (n + 1) // 2 + 1) for s in range(1, n + 1)]


def distinct(n: int, graphs: Sequence[Step], period: int) -> Iterator[tuple[Step, ...]]:
    """Yield every periodic sequence up to rotation and renaming of nodes, some of them more than once.

    A sequence can be turned so that no later graph has a lesser canonical form than the first, and then renamed so
    that the first graph is its canonical form.
    """
    form = {graph: canonical_form(n, graph) for graph in graphs}
    for first in sorted(set(form.values())):
        later = [graph for graph in graphs if form[graph] >= first]
        for others in product(later, repeat=period - 1):
            yield frozenset(first), *others


def canonical_form(n: int, graph: Step) -> tuple[Arc, ...]:
    return min(tuple(sorted((name[u], name[v]) for u, v in graph)) for name in permutations(range(n)))


@pytest.mark.parametrize("period", [1, 2, 3])
def test_all_periodic_sequences_on_two_nodes(period: int) -> None:
    for steps in product(all_digraphs(2), repeat=period):
        for r, s in values(2):
            assert_smallest(2, steps, period, r, s)


def test_all_periodic_sequences_of_one_digraph_on_three_nodes_or_graph_on_four() -> None:
    for n, graphs in ((3, all_digraphs(3)), (4, all_graphs(4))):
        for graph in graphs:
            for r, s in values(n):
                assert_smallest(n, [graph], 1, r, s)


@pytest.mark.parametrize(("n", "graphs"), [(3, all_digraphs(3)), (4, all_graphs(4))], ids=["digraphs 3", "graphs 4"])
def test_all_periodic_sequences_of_period_two(n: int, graphs: list[Step]) -> None:
    # Two of the pairs (r, s) for each sequence, by turns; the slow test below takes all of them.
    turns = values(n)
    for k, steps in enumerate(distinct(n, graphs, 2)):
        for r, s in (turns[k % len(turns)], turns[(k + len(turns) // 2) % len(turns)]):
            assert_smallest(n, steps, 2, r, s)


@pytest.mark.slow
@pytest.mark.parametrize("period", [2, 3])
@pytest.mark.parametrize(("n", "graphs"), [(3, all_digraphs(3)), (4, all_graphs(4))], ids=["digraphs 3", "graphs 4"])
def test_all_periodic_sequences_with_all_r_and_s(n: int, graphs: list[Step], period: int) -> None:
    for steps in distinct(n, graphs, period):
        for r, s in values(n):
            assert_smallest(n, steps, period, r, s)


def test_sampled_periodic_sequences_of_digraphs_on_four_nodes() -> None:
    draw = random.Random(6)
    graphs = all_digraphs(4)
    for _ in range(400):
        period = draw.randint(2, 3)
        assert_smallest(4, draw.choices(graphs, k=period), period, draw.randint(1, 2), draw.randint(1, 4))


@given(questions())
def test_smallest_window(question: tuple[int, list[Step], int | None, int, int]) -> None:
    n, steps, period, r, s = question
    found = check_joint_robustness(sequence_of(n, steps, period), r, s)
    assert found.window == smallest(n, steps, period, r, s)
    if found.window is not None:
        assert_covers(found, n, steps, period)
        assert found.at_least == found.window
        assert (found.shorter_fails is None) == (found.window == 1)
        if found.shorter_fails is not None:
            assert found.shorter_fails.length == found.window - 1
            assert_violation(found, found.shorter_fails, n, steps, period)
    else:
        assert found.violation is not None
        assert_violation(found, found.violation, n, steps, period)


@given(questions(), st.integers(1, 8))
def test_given_window(question: tuple[int, list[Step], int | None, int, int], length: int) -> None:
    n, steps, period, r, s = question
    found = check_joint_robustness(sequence_of(n, steps, period), r, s, window=length)
    windows = starts(steps, period, length)
    assert (found.verdict is rb.Verdict.ROBUST) == holds(n, steps, period, r, s, length)
    if found.verdict is rb.Verdict.ROBUST:
        assert found.window == length
        assert_covers(found, n, steps, period)
    elif windows:
        first = next(k for k in windows if not is_robust(n, union(steps, period, k, length), r, s))
        assert (found.violation.start, found.violation.length) == (first, length)
        assert_violation(found, found.violation, n, steps, period)
    else:
        assert found.violation is None
        assert "no window" in found.reason


@given(questions(), st.integers(1, 8))
def test_all_windows(question: tuple[int, list[Step], int | None, int, int], length: int) -> None:
    n, steps, period, r, s = question
    found = check_joint_robustness(sequence_of(n, steps, period), r, s, window=length, all_windows=True)
    windows = range(len(steps)) if period is not None else starts(steps, period, length)
    expected = [is_robust(n, union(steps, period, k, length), r, s) for k in windows]
    assert [found.union_verdicts[u].verdict is rb.Verdict.ROBUST for u in found.window_unions] == expected
    assert found.failing_starts() == tuple(k for k in windows if not expected[k])


@given(questions(), st.frozensets(st.sampled_from(sorted(RULES))))
def test_shortcuts_change_no_answer(
    question: tuple[int, list[Step], int | None, int, int], reuse: frozenset[str]
) -> None:
    n, steps, period, r, s = question
    sequence = sequence_of(n, steps, period)
    fast, slow = (check_joint_robustness(sequence, r, s, reuse=rules) for rules in (reuse, ()))
    assert (fast.verdict, fast.window) == (slow.verdict, slow.window)
    for length in range(1, len(steps) + 1):
        fast, slow = (
            check_joint_robustness(sequence, r, s, window=length, all_windows=True, reuse=rules)
            for rules in (reuse, ())
        )
        assert (fast.verdict, fast.failing_starts()) == (slow.verdict, slow.failing_starts())


@given(questions())
def test_a_longer_window_holds_too_while_it_fits(question: tuple[int, list[Step], int | None, int, int]) -> None:
    n, steps, period, r, s = question
    sequence = sequence_of(n, steps, period)
    verdicts = [check_joint_robustness(sequence, r, s, window=k).verdict for k in range(1, len(steps) + 3)]
    fitting = verdicts[: len(steps)] if period is None else verdicts
    robust = [verdict is rb.Verdict.ROBUST for verdict in fitting]
    assert robust == sorted(robust)
    assert period is not None or verdicts[len(steps) :] == [rb.Verdict.NOT_ROBUST] * 2


@given(questions())
def test_curve(question: tuple[int, list[Step], int | None, int, int]) -> None:
    n, steps, period, _, s = question
    expected = {r: smallest(n, steps, period, r, s) for r in range(1, (n + 1) // 2 + 1)}
    assert dict(joint_curve(sequence_of(n, steps, period), s)) == expected


def assert_violation(found: JointResult, violation: object, n: int, steps: list[Step], period: int | None) -> None:
    pair = violation.witness
    if n < 2:
        assert pair is None
        return
    arcs = union(steps, period, violation.start, violation.length)
    assert violates(n, arcs, set(pair.S1), set(pair.S2), found.r, found.s)


def assert_covers(found: JointResult, n: int, steps: list[Step], period: int | None) -> None:
    """Guarantees that the map from windows to unions is complete and right, with the evidence of every union."""
    windows = range(len(steps)) if period is not None else starts(steps, period, found.window)
    assert found.examined == found.window
    assert len(found.window_unions) == len(windows)
    assert len(found.union_verdicts) == len(found.unions) == len(set(found.window_unions))
    graphs = list(found.unions)
    assert len(set(graphs)) == len(graphs)
    for start, place in zip(windows, found.window_unions, strict=True):
        assert set(graphs[place].arcs()) == union(steps, period, start, found.window)
    for graph, evidence in zip(graphs, found.union_verdicts, strict=True):
        assert evidence.verdict is rb.Verdict.ROBUST
        if evidence.growth is not None:
            assert_growth(evidence.growth, frozenset(graph.arcs()), found.r, found.s)


def assert_growth(growth: object, arcs: Step, r: int, s: int) -> None:
    names = {node: k for k, node in enumerate(growth.seed)}
    seed = frozenset((names[u], names[v]) for u, v in arcs if u in names and v in names)
    assert is_robust(len(names), seed, r, s)
    present = set(growth.seed)
    for node in growth.order.tolist():
        assert node not in present
        assert sum(u in present for u, v in arcs if v == node) >= r + s - 1
        present.add(node)
