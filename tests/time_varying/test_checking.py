"""The questions and their corners: limits, tau, traces that are too short, evidence, how results read."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.limits import Progress
from robustness.results import RobustnessResult
from robustness.time_varying import JointResult, TimeVaryingGraph, check_joint_robustness, joint_curve, unions


def rotating_star(n: int = 5, period: int | None = None) -> TimeVaryingGraph:
    """Return the sequence in which node k is heard by all others at step k: the union of all steps is complete."""
    return TimeVaryingGraph.from_arcs(range(n), [[(k, v) for v in range(n) if v != k] for k in range(n)], period)


def test_smallest_window_of_a_rotating_star() -> None:
    found = check_joint_robustness(rotating_star(period=5), 2)
    assert (found.verdict, found.window, found.at_least) == (rb.Verdict.ROBUST, 3, 3)
    assert found.shorter_fails.length == 2
    assert dict(joint_curve(rotating_star(period=5))) == {1: 1, 2: 3, 3: 5}


def test_a_constant_sequence_is_its_graph() -> None:
    wheel = nx.wheel_graph(6)
    for sequence in (TimeVaryingGraph([wheel]), TimeVaryingGraph([wheel], 1), [wheel] * 3):
        assert check_joint_robustness(sequence, 2).window == 1
        assert check_joint_robustness(sequence, 3).verdict is rb.Verdict.NOT_ROBUST
        assert dict(joint_curve(sequence)) == {1: 1, 2: 1, 3: None}


def test_empty_steps_count_as_steps() -> None:
    empty, full = nx.empty_graph(4), nx.complete_graph(4)
    assert check_joint_robustness([full, empty, empty, full], 2).window == 3
    assert check_joint_robustness(TimeVaryingGraph([full, empty, empty], 3), 2).window == 3
    assert check_joint_robustness([empty], 1).verdict is rb.Verdict.NOT_ROBUST
    assert check_joint_robustness([empty], 0).window == 1


def test_a_dead_end_in_a_trace_needs_windows_that_reach_back() -> None:
    empty, full = nx.empty_graph(3), nx.complete_graph(3)
    found = check_joint_robustness([full, full, empty, empty], 2)
    assert found.window == 3
    assert (found.shorter_fails.start, found.shorter_fails.length) == (2, 2)
    assert found.window_unions == (0, 0)


def test_the_period_decides_what_a_prefix_can_only_delay() -> None:
    empty, full = nx.empty_graph(3), nx.complete_graph(3)
    assert check_joint_robustness(TimeVaryingGraph([empty, empty, full], 1), 2).window == 3
    never = check_joint_robustness(TimeVaryingGraph([full, full, empty], 1), 2)
    assert never.verdict is rb.Verdict.NOT_ROBUST
    assert (never.violation.start, never.violation.length) == (2, 1)
    assert never.reason.startswith("no window of any length will do, as even the union of one whole period")
    trace = check_joint_robustness([full, full, empty], 3)
    assert trace.reason.startswith("no window up to the horizon will do, as even the union of the whole trace")


def test_a_window_longer_than_the_trace_is_not_robust_up_to_the_horizon() -> None:
    found = check_joint_robustness([nx.complete_graph(4)] * 3, 2, window=4)
    assert (found.verdict, found.window, found.violation) == (rb.Verdict.NOT_ROBUST, None, None)
    assert found.reason == "no window of 4 steps fits in a trace of 3 steps"
    assert found.within_tau is None
    periodic = TimeVaryingGraph([nx.complete_graph(4)] * 3, 3)
    assert check_joint_robustness(periodic, 2, window=10**15).verdict is rb.Verdict.ROBUST


@pytest.mark.parametrize("n", [0, 1])
def test_fewer_than_two_nodes_follow_the_convention(n: int) -> None:
    sequence = TimeVaryingGraph([nx.empty_graph(n)] * 2)
    for r in range(3):
        expected = rb.check_rs_robustness(nx.empty_graph(n), r).verdict
        for window in (None, 1, 2):
            found = check_joint_robustness(sequence, r, window=window)
            assert found.verdict is expected
            assert found.verdict is rb.Verdict.ROBUST or found.violation.witness is None
    assert dict(joint_curve(sequence)) == {1: 1} if n else not joint_curve(sequence)


@pytest.mark.parametrize(("tau", "within"), [(2, False), (3, True), (11, True), (0, False)])
def test_tau(tau: int, within: bool) -> None:
    found = check_joint_robustness(rotating_star(period=5), 2, tau=tau)
    assert (found.window, found.tau, found.within_tau) == (3, tau, within)


def test_tau_of_a_given_window_and_of_none() -> None:
    sequence = rotating_star(period=5)
    assert check_joint_robustness(sequence, 2, window=5, tau=4).within_tau is False
    assert check_joint_robustness(sequence, 2, window=2, tau=4).within_tau is False
    assert check_joint_robustness(sequence, 4, tau=100).within_tau is False
    assert check_joint_robustness(sequence, 2).within_tau is None
    assert check_joint_robustness(sequence, 2, tau=9, time_limit=1e-9).within_tau is None


@pytest.mark.parametrize("window", [None, 2])
def test_a_limit_is_undecided(window: int | None) -> None:
    found = check_joint_robustness(rotating_star(), 2, window=window, time_limit=1e-9)
    assert (found.verdict, found.window, found.violation) == (rb.Verdict.UNDECIDED, None, None)
    assert found.reason == "the time limit was reached"
    with pytest.raises(rb.Undecided, match="time limit"):
        found.decided()
    with pytest.raises(rb.Undecided):
        joint_curve(rotating_star(), time_limit=1e-9)


Front = Callable[..., RobustnessResult]


def undecided_when(condition: Callable[[rb.Digraph], bool], monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the search give up on the graphs that meet a condition."""
    front: Front = unions.check_within

    def stubborn(graph: rb.Digraph, r: int, s: int, *options: Any) -> RobustnessResult:
        if condition(graph):
            return RobustnessResult(rb.Verdict.UNDECIDED, r, s, stats={"reason": "too hard"})
        return front(graph, r, s, *options)

    monkeypatch.setattr(unions, "check_within", stubborn)


def test_an_undecided_union_leaves_what_is_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    undecided_when(lambda graph: graph.n == 5 and graph.arc_count == 12, monkeypatch)
    found = check_joint_robustness(rotating_star(), 2)
    assert (found.verdict, found.at_least, found.reason) == (rb.Verdict.UNDECIDED, 3, "too hard")
    assert found.summary() == "undecided: whether jointly 2-robust; no window shorter than 3 will do"
    assert check_joint_robustness(rotating_star(), 2, window=3).reason == "too hard"
    assert check_joint_robustness(rotating_star(), 2, window=2).verdict is rb.Verdict.NOT_ROBUST
    assert check_joint_robustness(rotating_star(), 2, window=4).verdict is rb.Verdict.ROBUST


def test_an_undecided_whole_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    undecided_when(lambda graph: graph.arc_count == 20, monkeypatch)
    found = check_joint_robustness(rotating_star(), 2)
    assert (found.verdict, found.at_least) == (rb.Verdict.UNDECIDED, 1)


def test_a_violation_after_an_undecided_window_still_refutes(monkeypatch: pytest.MonkeyPatch) -> None:
    full, empty = nx.complete_graph(4), nx.empty_graph(4)
    undecided_when(lambda graph: graph.arc_count == 12, monkeypatch)
    found = check_joint_robustness([full, empty], 2, window=1)
    assert (found.verdict, found.violation.start) == (rb.Verdict.NOT_ROBUST, 1)
    assert found.reason == "a window before it was not decided (too hard)"


def test_a_wrong_pair_is_an_internal_error(monkeypatch: pytest.MonkeyPatch) -> None:
    lie = RobustnessResult(rb.Verdict.NOT_ROBUST, 2, 1, rb.Witness(frozenset({0}), frozenset({1})))
    monkeypatch.setattr(unions, "check_within", lambda *_, **__: lie)
    with pytest.raises(rb.InternalError, match="violates nothing at step 0"):
        check_joint_robustness([nx.complete_graph(4)], 2, window=1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"r": -1}, "r is an integer"),
        ({"s": 6}, r"s is an integer in 1\.\.n"),
        ({"s": 0}, r"s is an integer in 1\.\.n"),
        ({"window": 0}, "a window has"),
        ({"window": 2.0}, "a window has"),
        ({"window": True}, "a window has"),
        ({"tau": -1}, "tau is an integer"),
        ({"tau": 1.5}, "tau is an integer"),
        ({"time_limit": 0}, "time_limit"),
        ({"time_limit": float("nan")}, "time_limit"),
        ({"reuse": {"magic"}}, "reuse holds some of"),
        ({"algorithm": "magic"}, "algorithm is"),
        ({"jobs": 0}, "jobs is"),
    ],
)
def test_parameters_out_of_range(options: dict[str, Any], message: str) -> None:
    with pytest.raises(rb.InvalidParameter, match=message):
        check_joint_robustness(rotating_star(), **{"r": 2, **options})


@pytest.mark.parametrize("algorithm", ["exhaustive", "transform"])
def test_the_algorithm_is_the_one_asked_for(algorithm: str) -> None:
    found = check_joint_robustness(rotating_star(), 2, algorithm=algorithm, reuse=())
    assert found.window == 3
    exact = [union for union in found.union_verdicts if union.rule == "exact"]
    assert {union.algorithm for union in exact} <= {algorithm}


def test_progress_is_told_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robustness.time_varying.front._PROGRESS_SECONDS", 0.0)
    told: list[Progress] = []
    check_joint_robustness(rotating_star(), 2, progress=told.append)
    assert told[-1].nodes > told[0].nodes
    assert "window of" in told[0].note


def test_unions_are_a_sequence_of_digraphs() -> None:
    found = check_joint_robustness(rotating_star(period=5), 2)
    assert len(found.unions) == 5
    assert found.unions[1:3][0] == found.unions[1] == rotating_star(period=5).union(1, 3)
    assert found.unions[-1] == list(found.unions)[4]
    with pytest.raises(IndexError):
        found.unions[5]


def test_results_read_well() -> None:
    robust = check_joint_robustness(rotating_star(period=5), 2, tau=4)
    assert robust.summary() == "jointly 2-robust; smallest window: every 3 consecutive steps"
    given = check_joint_robustness(rotating_star(), 1, 2, window=4)
    assert given.summary() == "jointly (1,2)-robust; every 4 consecutive steps"
    refuted = check_joint_robustness(rotating_star(), 2, window=2)
    assert refuted.summary() == "not jointly 2-robust over 2 steps"
    assert check_joint_robustness(rotating_star(), 4).summary() == "not jointly 4-robust"
    undecided = check_joint_robustness(rotating_star(), 2, time_limit=1e-9)
    assert undecided.summary() == "undecided: whether jointly 2-robust"
    for found in (robust, given, refuted, undecided):
        page = found._repr_mimebundle_()
        assert found.summary() in page["text/html"]
        assert page["text/plain"] == f"<JointResult: {found.summary()}>"
    assert "S1" in refuted._repr_mimebundle_()["text/html"]


def test_results_have_no_truth_value_and_are_frozen() -> None:
    found: JointResult = check_joint_robustness(rotating_star(), 2)
    with pytest.raises(TypeError, match="three values"):
        bool(found)
    with pytest.raises(AttributeError):
        found.window = 1
    assert found.decided() is True
    assert check_joint_robustness(rotating_star(), 4).decided() is False
    assert copy.copy(found) == found
