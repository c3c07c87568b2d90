"""Limits: the clock never decides unless the user's own limit did, and what a limit leaves is told truthfully."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.answers import Answer
from robustness.decision import determination
from robustness.decision.determination import PROFILE_NODES
from robustness.decision.ladder import EXACT_S_NODES, TRANSFORM_NODES
from robustness.limits import Limits, Steps
from tests.oracles import brute_profile

ROOT = Path(__file__).resolve().parent.parent


def facts(result: rb.RobustnessResult) -> dict[str, Any]:
    """Return everything that a result says, seconds aside."""
    return {
        name: getattr(result, name)
        for name in ("verdict", "r", "s", "witness", "bounds", "s_bounds", "profile", "algorithm", "stats")
    }


@pytest.mark.parametrize("n", [TRANSFORM_NODES, TRANSFORM_NODES + 1, PROFILE_NODES, PROFILE_NODES + 1])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("directed", [False, True])
def test_r_and_s_are_exact_on_both_sides_of_every_threshold(n: int, seed: int, directed: bool) -> None:
    graph = nx.gnp_random_graph(n, 0.5, seed=seed, directed=directed)
    found = rb.determine_robustness(graph)
    table = rb.robustness_profile(graph, algorithm="transform")
    assert found.verdict is rb.Verdict.DETERMINED
    assert found.s_is_exact
    assert found.r == max((r for r, s in table.items() if s), default=0)
    assert found.s == table.get(found.r, n)
    assert found.profile == (table if n <= PROFILE_NODES else None)
    assert found.witness is not None
    assert rb.check_rs_robustness(graph, found.r + 1).verdict is rb.Verdict.NOT_ROBUST


@pytest.mark.parametrize("n", [EXACT_S_NODES, EXACT_S_NODES + 1])
def test_s_is_exact_up_to_28_nodes_and_told_as_an_interval_beyond(n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robustness.decision.determination._S_STEPS", 1)
    found = rb.determine_robustness(nx.random_regular_graph(4, n + n % 2, seed=1))
    assert found.verdict is rb.Verdict.DETERMINED
    if n <= EXACT_S_NODES:
        assert found.s_is_exact
    assert found.s_bounds is not None
    assert found.s_bounds.lower.value <= found.s <= found.s_bounds.upper.value


def test_a_named_algorithm_finds_s_exactly() -> None:
    graph = nx.gnp_random_graph(9, 0.5, seed=3)
    table = brute_profile(rb.Digraph.from_networkx(graph))
    for algorithm in rb.ALGORITHMS:
        found = rb.determine_robustness(graph, algorithm=algorithm)
        assert found.s_is_exact
        assert found.s == table[found.r]


def test_every_determination_has_the_pair_that_refutes_one_more() -> None:
    for graph in (nx.complete_graph(5), nx.complete_graph(2), nx.complete_graph(12), nx.complete_graph(30)):
        found = rb.determine_robustness(graph)
        assert found.r == -(-len(graph) // 2)
        assert found.witness is not None
        assert found.witness.S1 | found.witness.S2 == set(graph)


class Clock:
    """A clock that runs a thousand times too fast, as on a machine that is hardly ever given the processor."""

    def __init__(self) -> None:
        self.begun = time.perf_counter()

    def __call__(self) -> float:
        return 1000 * (time.perf_counter() - self.begun)


GRAPHS: dict[str, Callable[[], nx.Graph]] = {
    "n = 22": lambda: nx.gnp_random_graph(22, 0.5, seed=1),
    "n = 26": lambda: nx.gnp_random_graph(26, 0.5, seed=1),
    "n = 40": lambda: nx.gnp_random_graph(40, 0.3, seed=2),
    "regular": lambda: nx.random_regular_graph(6, 50, seed=1),
    "directed": lambda: nx.gnp_random_graph(30, 0.3, seed=1, directed=True),
}


@pytest.mark.parametrize("name", GRAPHS)
def test_without_a_limit_the_clock_changes_nothing(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    graph = GRAPHS[name]()
    questions: list[Callable[[], Any]] = [
        lambda: facts(rb.determine_robustness(graph)),
        lambda: facts(rb.check_rs_robustness(graph, 3, 2)),
        lambda: facts(rb.certify(graph, 2)),
        lambda: rb.certify(graph, 2).certificate,
        lambda: [result.as_dict() for result in rb.tolerance(graph).results],
        lambda: [facts_of_joint(rb.check_joint_robustness([graph, nx.complement(graph)], 2))],
    ]
    calm = [ask() for ask in questions]
    monkeypatch.setattr(time, "monotonic", Clock())
    assert [ask() for ask in questions] == calm


def facts_of_joint(found: rb.JointResult) -> dict[str, Any]:
    return {name: getattr(found, name) for name in ("verdict", "window", "violation", "reason", "stats")}


def test_a_limit_that_is_over_at_once_leaves_true_bounds() -> None:
    graph = nx.random_regular_graph(10, 80, seed=1)
    found = rb.determine_robustness(graph, time_limit=1e-9)
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.bounds is not None
    assert found.bounds.lower.value <= 4 <= found.bounds.upper.value
    assert rb.check_rs_robustness(graph, 5, time_limit=1e-9).verdict is not rb.Verdict.ROBUST


def test_undecided_carries_what_is_proven_and_is_no_os_error() -> None:
    graph = nx.gnp_random_graph(40, 0.5, seed=1)
    with pytest.raises(rb.Undecided) as caught:
        rb.robustness_profile(graph, time_limit=0.2)
    assert not isinstance(caught.value, OSError)
    assert caught.value.profile is not None
    assert caught.value.bounds is not None
    assert set(caught.value.profile) <= set(range(1, 21))
    assert all(s == 0 for r, s in caught.value.profile.items() if r > 10)
    with pytest.raises(rb.Undecided) as caught:
        rb.is_r_robust(nx.random_regular_graph(10, 80, seed=1), 4, algorithm="exhaustive", time_limit=0.01)
    assert caught.value.bounds is not None


def test_limits_are_narrowed_and_never_widened() -> None:
    limits = Limits.of(10.0, 2, 3)
    assert limits.within(1000.0).deadline == limits.deadline
    assert limits.within(None) is limits
    assert limits.share(0.5).deadline < limits.deadline  # type: ignore[operator]
    assert Limits().share(0.1) == Limits()
    assert (limits.share(0.5).jobs, limits.counted(7).seed, limits.counted(7).steps) == (2, 3, 7)
    for wrong in (0, -1.0, float("nan"), float("inf"), True):
        with pytest.raises(rb.InvalidParameter, match="time_limit is a positive, finite number of seconds"):
            Limits.of(wrong)
    with pytest.raises(rb.InvalidParameter, match="jobs"):
        Limits.of(None, 0)


def test_a_budget_of_steps_ends_by_itself_or_when_asked_to() -> None:
    steps = Steps(100)
    steps.spend(60)
    assert (steps.over(), steps.part(1000).left, steps.part(7).left) == (False, 40, 7)
    steps.spend(60)
    assert steps.over()
    assert Steps(stop=lambda: True).over()


#: Constants in seconds: the names after a comment that begins so, and names that say it.
_TIMES = re.compile(
    r"^#: Seconds.*\n(?:#.*\n)*([A-Z_, ]+?) =|^(_?[A-Z_]*(?:SECONDS|PATIENCE|GRACE)[A-Z_, ]*?) (?::.*)?=", re.MULTILINE
)


def test_no_file_has_a_number_of_seconds_that_decides() -> None:
    """Seconds that say how often to look at the clock, how near the user's limit, or when a worker is lost."""
    allowed = {
        "_STEP",
        "GRACE",
        "FAR_GRACE",
        "_TELLING, _TELLING_EACH",
        "_GRACE",
        "_ESTIMATE_SECONDS",
        "_FETCH",
        "_LOOK",
        "_STALE",
        "_FIRST_SLICE, _LONGEST_SLICE",
        "_PATIENCE, _GRACE",
        "_ALONE",
        "_SYNC",
        "_PROGRESS_SECONDS",
    }
    found = {
        "".join(names)
        for folder in ("robustness", "cli", "certificates")
        for path in (ROOT / folder).rglob("*.py")
        for names in _TIMES.findall(path.read_text(encoding="utf-8"))
    }
    assert {"GRACE", "_STEP", "_ALONE"} <= found
    assert found <= allowed, found - allowed


class TestSOnSparseGraphs:
    def test_cp_sat_says_what_the_definition_says(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """With a search that never decides an s above 1, on graphs small enough for the oracle."""
        monkeypatch.setattr(determination, "EXACT_S_NODES", 0)
        monkeypatch.setattr(determination, "PROFILE_NODES", 0)
        search = determination._Work.search

        def giving_up(self: Any, r: int, s: int, limits: Limits) -> Answer:
            return search(self, r, s, limits) if s == 1 else Answer.undecided("given up")

        monkeypatch.setattr(determination._Work, "search", giving_up)
        by_solver = 0
        for seed in range(12):
            graph = nx.gnp_random_graph(8, 0.5, seed=seed, directed=seed % 2 == 1)
            found = rb.determine_robustness(graph, time_limit=60)
            table = brute_profile(rb.Digraph.from_networkx(graph))
            assert found.r == max((r for r, s in table.items() if s), default=0)
            if found.r:
                assert found.s_is_exact
                assert found.s == table[found.r]
                assert found.s_bounds is not None
                by_solver += "cp-sat" in found.s_bounds.lower.reason
        assert by_solver > 1

    def test_both_share_a_limit(self) -> None:
        found = rb.determine_robustness(nx.random_regular_graph(5, 40, seed=1), time_limit=60)
        assert (found.r, found.s, found.s_is_exact) == (2, 4, True)

    @pytest.mark.slow
    def test_what_the_search_alone_leaves_open(self) -> None:
        """The search alone has no end on this graph in a minute."""
        found = rb.determine_robustness(nx.random_regular_graph(5, 60, seed=1), time_limit=400)
        assert (found.r, found.s, found.s_is_exact) == (2, 4, True)
        assert found.s_bounds is not None
        assert "cp-sat" in found.s_bounds.lower.reason

    def test_dense_and_large_graphs_are_left_to_the_search(self, monkeypatch: pytest.MonkeyPatch) -> None:
        asked: list[str] = []
        searched = determination._searched

        def noting(graph: rb.Digraph, r: int, s: int, name: str, limits: Limits) -> Answer:
            asked.append(name)
            return searched(graph, r, s, name, limits)

        monkeypatch.setattr(determination, "_searched", noting)
        for graph in (nx.gnp_random_graph(40, 0.5, seed=1), nx.random_regular_graph(4, 120, seed=1)):
            rb.determine_robustness(graph, time_limit=2)
        rb.determine_robustness(nx.circulant_graph(60, [1, 2]))
        assert asked
        assert "cp-sat" not in asked
