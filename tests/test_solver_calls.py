"""Of a call of CP-SAT that was stopped nothing counts but solutions: with a solver that says what the test wants."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import networkx as nx
import pytest
from ortools.sat.python import cp_model

import robustness as rb
from robustness import solver_calls
from robustness.errors import InternalError
from robustness.graph_search.properties import RSRobust
from robustness.graph_search.synthesis import synthesise
from robustness.limits import Limits
from robustness.mending.actions import Actions
from robustness.solver_calls import Outcome, solve_within
from robustness.threat_models.remembered import Remembered, find_in_all
from robustness.traps import cp_sat
from robustness.traps.question import Question

UNKNOWN, INFEASIBLE, FEASIBLE, OPTIMAL = (
    cp_model.UNKNOWN, cp_model.INFEASIBLE, cp_model.FEASIBLE, cp_model.OPTIMAL,
)  # fmt: skip


class FakeSolver:
    """Says ``status`` after ``seconds``; tells the bounds of ``early`` at once and those of ``late`` at the end."""

    status: Any = OPTIMAL
    seconds = 0.0
    early: tuple[float, ...] = ()
    late: tuple[float, ...] = ()
    best_objective_bound = 7.0
    deterministic_time = 0.5
    fails: Exception | None = None
    answers_to_stop = True

    def __init__(self) -> None:
        self.parameters = SimpleNamespace()
        self.best_bound_callback: Callable[[float], None] | None = None
        self.stopped = threading.Event()
        made.append(self)

    def solve(self, model: Any) -> Any:
        assert self.best_bound_callback is not None
        for bound in self.early:
            self.best_bound_callback(bound)
        if self.fails is not None:
            raise self.fails
        end = time.monotonic() + self.seconds
        while time.monotonic() < end and not (self.answers_to_stop and self.stopped.wait(0.01)):
            time.sleep(0.01)
        for bound in self.late:
            self.best_bound_callback(bound)
        return self.status

    def stop_search(self) -> None:
        self.stopped.set()

    @staticmethod
    def status_name(status: Any) -> str:
        return str(status.name)

    @staticmethod
    def value(variable: Any) -> int:
        return 1


made: list[FakeSolver] = []

NO_ACTIONS = Actions((), 1, frozenset(), None, uniform=False, one_way=False)


@pytest.fixture
def says(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Make every new solver say so."""
    made.clear()
    monkeypatch.setattr(cp_model, "CpSolver", FakeSolver)

    def put(**what: Any) -> None:
        for name, value in what.items():
            monkeypatch.setattr(FakeSolver, name, value)

    return put


def within(seconds: float) -> Limits:
    return Limits(deadline=time.monotonic() + seconds)


@pytest.mark.parametrize("status", [UNKNOWN, INFEASIBLE, FEASIBLE, OPTIMAL])
def test_what_returns_in_time_is_believed(says: Callable[..., None], status: Any) -> None:
    says(status=status, early=(3.0,))
    for limits in (Limits(), within(60)):
        outcome = solve_within(object(), limits)
        assert (outcome.is_infeasible, outcome.is_optimal) == (status == INFEASIBLE, status == OPTIMAL)
        assert outcome.has_solution == (status in (FEASIBLE, OPTIMAL))
        assert (outcome.bound, outcome.said) == (7.0, status.name.lower())


@pytest.mark.parametrize("status", [UNKNOWN, INFEASIBLE, FEASIBLE, OPTIMAL])
def test_what_returns_after_the_limit_proves_nothing(says: Callable[..., None], status: Any) -> None:
    says(status=status, seconds=0.15, early=(3.0,), late=(6.0,))
    outcome = solve_within(object(), within(0.1))
    assert not outcome.is_infeasible
    assert not outcome.is_optimal
    assert outcome.has_solution == (status in (FEASIBLE, OPTIMAL)), "solutions are checked by the callers"
    assert outcome.bound == 3.0, "told before the limit; 6 was told after it and 7 at the end"


def test_nothing_was_told_in_time(says: Callable[..., None]) -> None:
    says(status=UNKNOWN, seconds=0.1, late=(6.0,))
    assert solve_within(object(), within(0.05)).bound == -math.inf


def test_an_effort_that_is_spent_is_a_limit(says: Callable[..., None]) -> None:
    says(status=OPTIMAL, early=(3.0,))
    assert solve_within(object(), Limits(), 1.0).is_optimal
    spent = solve_within(object(), Limits(), 0.5)
    assert (spent.is_optimal, spent.has_solution, spent.bound) == (False, True, 3.0)


def test_a_solver_that_does_not_stop_is_left_alone(says: Callable[..., None]) -> None:
    says(status=OPTIMAL, seconds=5.0, early=(3.0,), answers_to_stop=False)
    outcome = solve_within(object(), within(0.1))
    assert any(thread.name == "robustness-cp-sat" for thread in threading.enumerate()), "it is still at work"
    assert outcome == Outcome("abandoned", bound=3.0)
    assert made[0].stopped.is_set(), "it was asked to stop"


def test_ctrl_c_asks_the_solver_to_stop(says: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    says(status=OPTIMAL, seconds=20.0)

    def interrupted(*_: Any) -> bool:
        raise KeyboardInterrupt

    monkeypatch.setattr(solver_calls, "has_passed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        solve_within(object(), Limits())
    assert made[0].stopped.is_set()


def test_a_failing_solver_tells_its_own_error(says: Callable[..., None]) -> None:
    says(fails=RuntimeError("out of luck"))
    with pytest.raises(InternalError, match="the solver failed: out of luck") as told:
        solve_within(object(), within(5))
    assert isinstance(told.value.__cause__, RuntimeError)


def test_a_model_that_is_refused_is_an_error_of_ours(says: Callable[..., None]) -> None:
    says(status=cp_model.MODEL_INVALID)
    with pytest.raises(InternalError, match="refused a model"):
        solve_within(object(), Limits())


def test_limits_reach_the_solver(says: Callable[..., None]) -> None:
    says(status=UNKNOWN)
    solve_within(object(), Limits(deadline=time.monotonic() + 50, jobs=3, seed=-1), 2.0, relaxed=True)
    parameters = made[0].parameters
    assert (parameters.num_workers, parameters.catch_sigint_signal) == (3, False)
    assert (parameters.max_deterministic_time, parameters.linearization_level) == (2.0, 2)
    assert parameters.random_seed >= 0
    assert 40 < parameters.max_time_in_seconds <= 50


class TestEveryCaller:
    """Each is told, too late, that there is nothing or that what there is is best."""

    graph = rb.Digraph.from_networkx(nx.complete_graph(4))

    def test_traps(self, says: Callable[..., None]) -> None:
        says(status=INFEASIBLE)
        assert cp_sat.decide(self.graph, Question(1), within(50)).exists is False
        says(seconds=0.1)
        answer = cp_sat.decide(self.graph, Question(1), within(0.05))
        assert answer.exists is None
        assert answer.stats["solver_status"] == "infeasible"

    def test_remembered(self, says: Callable[..., None]) -> None:
        sequence = rb.TimeVaryingGraph([nx.complete_graph(4), nx.path_graph(4)], period=2)
        remembered = Remembered.of(sequence, delay=0, gap=1, tau=1)
        says(status=INFEASIBLE)
        assert find_in_all(remembered, Question(1), within(50))[0] is False
        says(seconds=0.1)
        assert find_in_all(remembered, Question(1), within(0.05))[0] is None

    def test_graph_search(self, says: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
        demands = [RSRobust(2, 1)]
        says(status=INFEASIBLE)
        assert synthesise(4, demands, [], directed=False, limits=within(50)).is_complete
        says(seconds=0.1)
        found = synthesise(4, demands, [], directed=False, limits=within(0.05))
        assert (found.graph, found.is_complete) == (None, False)
        assert "limit" in found.stats["reason"]

    @pytest.mark.parametrize("status", [INFEASIBLE, OPTIMAL])
    def test_mending(self, says: Callable[..., None], status: Any) -> None:
        from robustness.mending.master import Master

        says(status=status)
        assert Master(self.graph, NO_ACTIONS).solve(within(50), None).is_optimal == (status == OPTIMAL)
        says(seconds=0.1)
        proposal = Master(self.graph, NO_ACTIONS).solve(within(0.05), None)
        assert (proposal.bound, proposal.is_optimal) == (0, False)


def test_the_true_solver_tells_its_bounds_in_time() -> None:
    """With the true one: a cover that is not proven least, its bound told on the way."""
    graph = nx.gnp_random_graph(120, 0.2, seed=1)
    model = cp_model.CpModel()
    chosen = [model.new_bool_var("") for _ in graph]
    for u, v in graph.edges:
        model.add_bool_or([chosen[u], chosen[v]])
    model.minimize(sum(chosen))
    outcome = solve_within(model, Limits(), 0.3)
    assert outcome.has_solution
    assert not outcome.is_optimal
    assert 0 < outcome.bound <= sum(outcome.value(each) for each in chosen)
