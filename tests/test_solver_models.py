"""The violation model: its switches, its minima, what every end of a solver means, limits and Ctrl-C."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import networkx as nx
import pytest

from robustness import Digraph, InternalError, InvalidParameter, Undecided, Verdict
from robustness.decision.algorithms import cp_sat, milp, model_solving, transform
from robustness.decision.algorithms.violation_model import ViolationModel, all_pairs, compatible_pairs
from robustness.evidence import Pair
from robustness.limits import Limits
from tests.oracles import brute_profile, digraphs, graphs, is_violating

NO_LIMITS = Limits()
SOLVERS = [
    pytest.param(milp, {"solver": "highs"}, id="highs"),
    pytest.param(milp, {"solver": "scip"}, id="scip"),
    pytest.param(cp_sat, {}, id="cp-sat"),
]
every_solver = pytest.mark.parametrize(("algorithm", "options"), SOLVERS)


def gnp(n: int, p: float, seed: int, directed: bool = False) -> Digraph:
    return Digraph.from_networkx(nx.gnp_random_graph(n, p, seed=seed, directed=directed))


SAMPLE = [
    *graphs(4),
    *digraphs(3)[::2],
    *digraphs(4)[::9],
    *graphs(6)[::13],
    *(gnp(9, p, seed, directed) for seed, (p, directed) in enumerate(product((0.3, 0.5, 0.8), (False, True)))),
]
#: Nobody refutes r = 14 here in a few seconds with these solvers.
HARD = gnp(60, 0.5, 1)


@every_solver
@pytest.mark.parametrize("pair_counting", [True, False])
def test_pair_counting_changes_no_verdict(algorithm, options, pair_counting):
    for graph in SAMPLE:
        for r, s_max in brute_profile(graph).items():
            for s in {max(s_max, 1), min(s_max + 1, graph.n)}:
                answer = algorithm.decide(graph, r, s, NO_LIMITS, pair_counting=pair_counting, **options)
                assert answer.verdict is (Verdict.ROBUST if s <= s_max else Verdict.NOT_ROBUST)
                assert answer.pair is None or is_violating(graph, *answer.pair, r, s)
                assert answer.stats["solver_status"]


@every_solver
@pytest.mark.parametrize("pair_counting", [True, False])
def test_largest_s_is_the_minimum(algorithm, options, pair_counting):
    for graph in SAMPLE[::2]:
        for r, s_max in brute_profile(graph).items():
            bounds = algorithm.largest_s(graph, r, NO_LIMITS, pair_counting=pair_counting, **options)
            assert (bounds.lower.value, bounds.upper.value) == (s_max, s_max)
            if s_max < graph.n:
                first, second = map(graph.ids, bounds.upper.witness)
                assert is_violating(graph, first, second, r, s_max + 1)


@every_solver
def test_largest_r_is_the_minimum(algorithm, options):
    for graph in SAMPLE:
        best = max((r for r, s in brute_profile(graph).items() if s), default=0)
        bounds = algorithm.largest_r(graph, NO_LIMITS, **options)
        assert (bounds.lower.value, bounds.upper.value) == (best, best)
        if bounds.upper.witness is not None:
            first, second = map(graph.ids, bounds.upper.witness)
            assert is_violating(graph, first, second, best + 1, 1)


@every_solver
@pytest.mark.parametrize("n", [0, 1])
def test_largest_r_of_fewer_than_two_nodes(algorithm, options, n):
    bounds = algorithm.largest_r(Digraph(range(n), []), NO_LIMITS, **options)
    assert (bounds.lower.value, bounds.upper.value) == (n, n)


def test_an_unknown_solver_is_refused():
    for call in (
        lambda: milp.decide(HARD, 2, 1, NO_LIMITS, solver="abacus"),
        lambda: milp.largest_s(HARD, 2, NO_LIMITS, solver="abacus"),
        lambda: milp.largest_r(HARD, NO_LIMITS, solver="abacus"),
    ):
        with pytest.raises(InvalidParameter, match=r"highs, scip, not 'abacus'"):
            call()


def test_pair_counting_removes_no_pair_of_a_violation():
    for graph in SAMPLE:
        for r, s_max in brute_profile(graph).items():
            for s in range(s_max + 1, min(s_max + 3, graph.n) + 1):
                goes = compatible_pairs(graph, r, s, NO_LIMITS)
                answer = transform.decide(graph, r, s, NO_LIMITS)
                first, second = answer.pair
                held = [[i for i in side if outside(graph, i, side) < r] for side in (first, second)]
                assert all(goes[i] >> j & 1 and goes[j] >> i & 1 for i, j in product(*held))


def outside(graph: Digraph, node: int, side: frozenset[int]) -> int:
    return len(set(graph.in_neighbours(node).tolist()) - side)


def test_pair_counting_alone_refutes_dense_graphs():
    # Node by node: K_n has no two nodes whose needs fit beside each other.
    for n in range(3, 12):
        graph = Digraph.from_networkx(nx.complete_graph(n))
        assert not any(compatible_pairs(graph, (n + 1) // 2, 1, NO_LIMITS))
    graph = gnp(30, 0.7, 1)
    assert not any(compatible_pairs(graph, 10, 1, NO_LIMITS))
    answer = cp_sat.decide(graph, 10, 1, NO_LIMITS)
    assert answer.verdict is Verdict.ROBUST
    assert "pair counting" in answer.stats["solver_status"]


def test_pair_counting_only_ever_shrinks_the_relation():
    for graph in SAMPLE:
        for r in range(1, (graph.n + 1) // 2 + 1):
            before = [0] * graph.n
            for s in range(1, graph.n + 1):
                goes = compatible_pairs(graph, r, s, NO_LIMITS)
                assert all(small & large == small for small, large in zip(before, goes, strict=True))
                assert all(small & large == small for small, large in zip(goes, all_pairs(graph.n), strict=True))
                before = goes


def test_every_termination_reason_is_mapped():
    from ortools.math_opt.python.mathopt import TerminationReason as Reason

    verdicts = {reason: model_solving.verdict_of(reason) for reason in Reason}
    assert {reason.name for reason, verdict in verdicts.items() if verdict is Verdict.NOT_ROBUST} == {
        "OPTIMAL",
        "FEASIBLE",
    }
    assert {reason.name for reason, verdict in verdicts.items() if verdict is Verdict.ROBUST} == {
        "INFEASIBLE",
        "INFEASIBLE_OR_UNBOUNDED",
    }
    assert set(verdicts.values()) == {Verdict.ROBUST, Verdict.NOT_ROBUST, Verdict.UNDECIDED}
    assert model_solving.verdict_of("a reason of the future") is Verdict.UNDECIDED


@every_solver
def test_a_false_pair_is_no_verdict(algorithm, options, monkeypatch):
    # What a solver's tolerances could do: a "solution" that is no violating pair once it is rounded.
    monkeypatch.setattr(ViolationModel, "pair", lambda *_: Pair(frozenset({0}), frozenset({1})))
    graph = Digraph.from_networkx(nx.cycle_graph(7))
    answer = algorithm.decide(graph, 2, 1, NO_LIMITS, **options)
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.pair is None
    assert "tolerances" in answer.stats["reason"]


def test_a_solution_without_values_is_no_verdict(monkeypatch):
    monkeypatch.setattr(model_solving, "_best_pair", lambda *_: None)
    graph = Digraph.from_networkx(nx.cycle_graph(7))
    answer = cp_sat.decide(graph, 2, 1, NO_LIMITS)
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.stats["reason"]
    bounds = cp_sat.largest_s(graph, 2, NO_LIMITS)
    assert bounds.lower.value == 0
    assert bounds.upper.value == 7


def test_a_failing_solver_is_an_internal_error(monkeypatch):
    from ortools.math_opt.python import mathopt

    def fail(*_args: object, **_options: object) -> None:
        raise RuntimeError("out of order")

    monkeypatch.setattr(mathopt, "solve", fail)
    with pytest.raises(InternalError, match="out of order"):
        cp_sat.decide(Digraph.from_networkx(nx.cycle_graph(7)), 2, 1, NO_LIMITS)


@every_solver
def test_a_time_limit_leaves_bounds_that_hold(algorithm, options):
    answer = algorithm.decide(HARD, 14, 1, Limits(deadline=time.monotonic() + 0.5), **options)
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.stats["reason"]
    r_bounds = algorithm.largest_r(HARD, Limits(deadline=time.monotonic() + 0.5), **options)
    assert 0 <= r_bounds.lower.value <= 14 <= r_bounds.upper.value
    s_bounds = algorithm.largest_s(HARD, 14, Limits(deadline=time.monotonic() + 0.5), **options)
    assert 0 <= s_bounds.lower.value <= s_bounds.upper.value <= 60


@every_solver
def test_a_passed_deadline_starts_no_solver(algorithm, options):
    past = Limits(deadline=time.monotonic() - 1)
    assert algorithm.decide(HARD, 14, 1, past, **options).verdict is Verdict.UNDECIDED
    assert algorithm.decide(HARD, 14, 1, past, pair_counting=False, **options).verdict is Verdict.UNDECIDED
    bounds = algorithm.largest_s(HARD, 14, past, **options)
    assert (bounds.lower.value, bounds.upper.value) == (0, 60)
    bounds = algorithm.largest_r(HARD, past, **options)
    assert (bounds.lower.value, bounds.upper.value) == (0, 30)
    with pytest.raises(Undecided):
        compatible_pairs(HARD, 14, 1, past)


def test_a_solver_that_overruns_its_limit_is_left_alone(monkeypatch):
    monkeypatch.setattr(model_solving, "GRACE", 0.1)
    monkeypatch.setattr(model_solving, "_parameters", lambda kind, limits: five_seconds())
    answer = cp_sat.decide(HARD, 14, 1, Limits(deadline=time.monotonic() + 0.3))
    assert answer.verdict is Verdict.UNDECIDED
    assert "did not stop" in answer.stats["reason"]


def test_what_cp_sat_says_after_its_limit_proves_nothing(monkeypatch):
    from ortools.math_opt.python import mathopt

    bounds = SimpleNamespace(dual_bound=5.0)
    termination = SimpleNamespace(reason=mathopt.TerminationReason.INFEASIBLE, objective_bounds=bounds)
    result = SimpleNamespace(termination=termination, solve_stats=SimpleNamespace(node_count=0), solutions=[])

    def late(*_args: object, params: mathopt.SolveParameters, **_options: object) -> object:
        if params.time_limit is not None:
            time.sleep(params.time_limit.total_seconds() + 0.05)
        return result

    monkeypatch.setattr(mathopt, "solve", late)
    assert cp_sat.decide(HARD, 14, 1, NO_LIMITS, pair_counting=False).verdict is Verdict.ROBUST
    answer = cp_sat.decide(HARD, 14, 1, Limits(deadline=time.monotonic() + 0.1), pair_counting=False)
    assert answer.verdict is Verdict.UNDECIDED
    assert "after its limit" in answer.stats["reason"]
    for bound_of in (cp_sat.largest_r, lambda graph, limits: cp_sat.largest_s(graph, 14, limits)):
        assert bound_of(HARD, NO_LIMITS).lower.value > 0
        assert bound_of(HARD, Limits(deadline=time.monotonic() + 0.5)).lower.value == 0


def five_seconds() -> object:
    from datetime import timedelta

    from ortools.math_opt.python import mathopt

    return mathopt.SolveParameters(time_limit=timedelta(seconds=5))


@every_solver
def test_progress_is_reported_and_nothing_is_printed(algorithm, options, capfd):
    seen = []
    algorithm.decide(HARD, 14, 1, Limits(deadline=time.monotonic() + 0.4, progress=seen.append), **options)
    assert seen
    assert seen[0].note
    assert capfd.readouterr() == ("", "")


def test_threads_seed_and_time_reach_the_solver():
    from ortools.math_opt.python.mathopt import SolverType

    limits = Limits(deadline=time.monotonic() + 50, jobs=3, seed=7)
    parameters = model_solving._parameters(SolverType.CP_SAT, limits)
    assert (parameters.threads, parameters.random_seed) == (3, 7)
    assert 40 < parameters.time_limit.total_seconds() <= 50
    assert model_solving._parameters(SolverType.HIGHS, limits).threads is None
    assert model_solving._parameters(SolverType.GSCIP, NO_LIMITS).time_limit is None
    endless = model_solving._parameters(SolverType.CP_SAT, Limits(deadline=time.monotonic() + 1e300, seed=-1))
    assert endless.time_limit.days > 365
    assert endless.random_seed >= 0


WAIT_FOR_CTRL_C = """
import sys, time
import networkx as nx
from robustness import Digraph
from robustness.decision.algorithms import {module}
from robustness.limits import Limits
graph = Digraph.from_networkx(nx.gnp_random_graph(60, 0.5, seed=1))
begun = lambda progress: print("begun", flush=True)
try:
    {module}.decide(graph, 14, 1, Limits(progress=begun), **{options!r})
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
@every_solver
def test_ctrl_c_stops_a_solver(algorithm, options):
    script = WAIT_FOR_CTRL_C.format(module=algorithm.__name__.rpartition(".")[2], options=options)
    root = Path(__file__).parent.parent
    with subprocess.Popen([sys.executable, "-c", script], cwd=root, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "begun\n"
        child.send_signal(signal.SIGINT)
        assert child.wait(timeout=120) == 130  # without the signal: hours


def test_solvers_load_without_warnings_and_without_highspy():
    script = (
        "import sys, networkx as nx, robustness as rb\n"
        "G = nx.cycle_graph(6)\n"
        "for name in ('milp', 'cp-sat'):\n"
        "    assert not rb.is_r_robust(G, 2, algorithm=name)\n"
        "assert 'highspy' not in sys.modules\n"
    )
    root = Path(__file__).parent.parent
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script], cwd=root, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
