"""Every way to search for a trap agrees with the definition, each rule can be switched off, limits are kept."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import threading
from itertools import product
from pathlib import Path

import networkx as nx
import pytest

import robustness as rb
from certificates.graph import decode_graph
from certificates.separation import check_separation
from robustness.constructions import two_f_robust_counterexample
from robustness.errors import InternalError, InvalidParameter, Undecided
from robustness.limits import Limits, Progress
from robustness.traps import TRAP_ALGORITHMS, find_trap, searching
from robustness.traps.ladder import decide_trap
from robustness.traps.question import Question, Sets, TrapAnswer, obeys_bound, solves
from robustness.traps.shortcuts import settle_trap
from tests.oracles import digraphs, graphs
from tests.tolerance.brute_force import has_standing_attack, has_trap

KINDS = list(product((1, 2), (False, True)))


def exists(graph: rb.Digraph, f: int, faces: int, local: bool) -> bool:
    return (has_trap if faces == 2 else has_standing_attack)(graph.in_masks, f, local)


def drawn(count: int, seed: int, *, nodes: tuple[int, ...] = (5, 6)) -> list[rb.Digraph]:
    draw = random.Random(seed)
    return [
        rb.Digraph.from_networkx(
            nx.gnp_random_graph(
                draw.choice(nodes), draw.uniform(0.3, 1), seed=draw.randrange(2**31), directed=draw.random() < 0.7
            )
        )
        for _ in range(count)
    ]


SMALL = [*graphs(4), *graphs(5)[::2], *digraphs(3), *drawn(12, 1)]


@pytest.mark.parametrize(("faces", "local"), KINDS)
@pytest.mark.parametrize("options", [{}, {"counting": False}, {"look_ahead": False}], ids=str)
def test_search_agrees_with_the_definition_with_every_rule_on_and_off(
    faces: int, local: bool, options: dict[str, bool]
) -> None:
    for graph in SMALL:
        for f in range(3):
            found = find_trap(graph, f, faces=faces, local=local, algorithm="search", **options)
            assert found.exists == exists(graph, f, faces, local), (graph.in_masks, f)
            assert found.algorithm == "search"


@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_the_answer_does_not_depend_on_threads(jobs: int, monkeypatch: pytest.MonkeyPatch) -> None:
    graph = rb.Digraph.from_networkx(nx.random_regular_graph(7, 24, seed=1))
    advance, turns = searching._Run.advance, []

    def note(run: searching._Run) -> None:
        turns.append(threading.current_thread().name)
        run._quota = 40
        advance(run)

    monkeypatch.setattr(searching._Run, "advance", note)
    found = searching.decide(graph, Question(2), Limits(jobs=jobs), transcript=True)
    assert found.exists is False
    assert check_separation(decode_graph(graph.canonical_bytes()), 2, 2, "total", found.transcript or b"") > 40
    assert any(name.startswith("robustness-traps") for name in turns) == (jobs > 1)


def test_looking_ahead_saves_what_it_is_for() -> None:
    for d, n, f in ((6, 24, 1), (8, 30, 2), (7, 24, 2)):
        graph = nx.random_regular_graph(d, n, seed=1)
        with_it, without = (find_trap(graph, f, algorithm="search", look_ahead=each) for each in (True, False))
        assert with_it.exists == without.exists
        assert with_it.stats["nodes"] < without.stats["nodes"]


@pytest.mark.parametrize(("faces", "local"), KINDS)
def test_auto_agrees_with_the_definition(faces: int, local: bool) -> None:
    for graph in SMALL:
        for f in range(4):
            found = find_trap(graph, f, faces=faces, local=local)
            assert found.decided() == exists(graph, f, faces, local), (graph.in_masks, f)


@pytest.mark.parametrize(("faces", "local"), KINDS)
def test_cp_sat_agrees_with_the_definition(faces: int, local: bool) -> None:
    for graph in SMALL[::2]:
        for f in (0, 1, 2):
            found = find_trap(graph, f, faces=faces, local=local, algorithm="cp-sat")
            assert found.exists == exists(graph, f, faces, local), (graph.in_masks, f)


@pytest.mark.parametrize(("faces", "local"), KINDS)
def test_exhaustive_agrees_with_the_other_brute_force(faces: int, local: bool) -> None:
    for graph in [*graphs(4), *digraphs(3)]:
        for f in (0, 1):
            assert find_trap(graph, f, faces=faces, local=local, algorithm="exhaustive").exists == exists(
                graph, f, faces, local
            )


@pytest.mark.parametrize(("faces", "local"), KINDS)
def test_search_and_cp_sat_agree_where_the_definition_is_out_of_reach(faces: int, local: bool) -> None:
    for graph in drawn(6, 5, nodes=(12, 14, 16)):
        for f in (1, 2):
            answers = {
                find_trap(graph, f, faces=faces, local=local, algorithm=name).decided() for name in ("search", "cp-sat")
            }
            assert len(answers) == 1, (graph.in_masks, f)


@pytest.mark.slow
@pytest.mark.parametrize(("faces", "local"), KINDS)
def test_search_on_all_graphs_on_six_nodes(faces: int, local: bool) -> None:
    for graph in graphs(6):
        for f in (1, 2):
            assert find_trap(graph, f, faces=faces, local=local, algorithm="search").exists == exists(
                graph, f, faces, local
            )


class TestShortcuts:
    @pytest.mark.parametrize(("faces", "local"), KINDS)
    def test_every_lemma_tells_the_truth(self, faces: int, local: bool) -> None:
        rules = set()
        for graph in [*SMALL, *graphs(1), rb.Digraph.from_networkx(nx.complete_graph(6))]:
            for f in range(4):
                question = Question(f, faces == 2, local)
                settled = settle_trap(graph, question, Limits())
                if settled is None:
                    continue
                rules.add(settled.stats["rule"].split(",")[0])
                assert settled.exists == exists(graph, f, faces, local), (graph.in_masks, f)
                assert settled.sets is None or solves(graph, question, settled.sets)
        assert {"n <= 3f", "a node of in-degree at most 2f"} <= rules or faces == 1
        assert {"n <= 2f"} <= rules or faces == 2
        assert any(rule.startswith("in-degrees of at least") for rule in rules)
        assert "fewer than two nodes: nobody to hold apart" in rules
        assert "not 1-robust: nobody need be malicious" in rules

    def test_without_a_trap_in_degrees_exceed_2f(self) -> None:
        for graph in graphs(6):
            for f in (1, 2):
                if not has_trap(graph.in_masks, f, False):
                    assert int(graph.in_degrees.min()) > 2 * f

    def test_robustness_settles_larger_graphs(self) -> None:
        ring = rb.Digraph.from_networkx(nx.circulant_graph(30, (1, 2, 3)))
        assert settle_trap(ring, Question(1), Limits()) == TrapAnswer.by_lemma(None, "3-robust, so no trap for f = 1")
        assert find_trap(ring, 1, algorithm="search").exists is False

    def test_complete_graphs_need_no_search(self) -> None:
        for n in range(2, 40):
            for f in range(n):
                two, one = (find_trap(nx.complete_graph(n), f, faces=faces) for faces in (2, 1))
                assert (two.exists, one.exists) == (n <= 3 * f, n <= 2 * f)
                assert two.algorithm == one.algorithm == "lemma"


class TestLargerGraphs:
    @pytest.mark.parametrize("f", [1, 2, 3])
    @pytest.mark.parametrize("variant", ["paper", "corrected"])
    def test_proposition_1_is_trapped(self, f: int, variant: str) -> None:
        graph = two_f_robust_counterexample(f, variant=variant)
        assert find_trap(graph, f, algorithm="search").decided()
        assert not find_trap(graph, f - 1, algorithm="search").decided()

    @pytest.mark.parametrize("n", [63, 64, 65, 130])
    def test_more_nodes_than_bits_of_a_word(self, n: int) -> None:
        ring = nx.circulant_graph(n, (1, 2, 3))
        assert find_trap(ring, 1, algorithm="search").exists is False
        assert find_trap(ring, 2, algorithm="search").exists is True
        assert not find_trap(nx.complete_graph(n), 5, algorithm="search").decided()

    def test_a_deep_search_grows_its_stack(self, monkeypatch: pytest.MonkeyPatch) -> None:
        graphs = [nx.random_regular_graph(6, 30, seed=seed) for seed in range(3)]
        before = [find_trap(graph, 2, algorithm="search", look_ahead=False).stats["nodes"] for graph in graphs]
        monkeypatch.setattr("robustness.traps.searching._LEVELS", 2)
        assert [find_trap(graph, 2, algorithm="search", look_ahead=False).stats["nodes"] for graph in graphs] == before

    @pytest.mark.parametrize(("d", "f", "expected"), [(8, 2, False), (5, 1, False), (6, 2, True), (8, 3, True)])
    def test_fifty_nodes(self, d: int, f: int, expected: bool) -> None:
        assert find_trap(nx.random_regular_graph(d, 50, seed=1), f, time_limit=60).exists is expected

    def test_removing_every_pair_of_nodes_says_the_same(self) -> None:
        for seed in range(3):
            graph = nx.random_regular_graph(6, 14, seed=seed)
            slow = any(
                not rb.is_r_robust(graph.subgraph(set(graph) - {u, v}), 3) for u in graph for v in graph if u < v
            )
            assert find_trap(graph, 2).decided() == slow


class TestLimits:
    @pytest.mark.parametrize("algorithm", TRAP_ALGORITHMS)
    def test_the_time_is_kept_and_nothing_claimed(self, algorithm: str) -> None:
        graph = nx.random_regular_graph(10, 60, seed=1)
        find_trap(nx.petersen_graph(), 1, algorithm="search")  # compiled
        found = find_trap(graph, 3, algorithm=algorithm, time_limit=0.3)
        assert (found.exists, found.M, found.S1, found.S2) == (None, frozenset(), frozenset(), frozenset())
        with pytest.raises(Undecided, match="raise the time limit"):
            found.decided()

    def test_progress_is_told(self) -> None:
        told: list[Progress] = []

        def note(progress: Progress) -> None:
            told.append(progress)
            if len(told) == 2:
                raise StopIteration

        with pytest.raises(StopIteration):
            find_trap(nx.random_regular_graph(10, 60, seed=1), 3, algorithm="search", progress=note)
        assert all(each.nodes >= 0 and "f = 3" in each.note for each in told)

    @pytest.mark.parametrize("algorithm", ["search", "cp-sat"])
    def test_ctrl_c(self, algorithm: str) -> None:
        find_trap(nx.petersen_graph(), 1, algorithm=algorithm)
        threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            find_trap(nx.random_regular_graph(10, 60, seed=1), 3, algorithm=algorithm, time_limit=30)


class TestDefinition:
    wheel = rb.Digraph.from_networkx(nx.wheel_graph(5))

    @pytest.mark.parametrize(
        ("question", "sets", "holds"),
        [
            (Question(1), ({0}, {1, 2}, {3, 4}), True),
            (Question(1), ({0}, {1, 3}, {2, 4}), False),  # 1 hears 2 and 4
            (Question(1), (set(), {1, 2}, {3, 4}), False),  # 1 hears 0 and 4
            (Question(0), ({0}, {1, 2}, {3, 4}), False),  # M is too large
            (Question(1), ({0}, set(), {3, 4}), False),
            (Question(1), ({0}, {1, 2}, set()), False),
            (Question(1), ({1}, {1, 2}, {3, 4}), False),  # M inside S1
            (Question(1), ({0}, {1, 2, 3}, {3, 4}), False),
            (Question(2, False), ({0}, {0, 1, 2}, {3, 4}), True),
            (Question(2, False), ({0}, {1, 2}, {3, 4}), False),  # M outside both
            (Question(2, False), ({0}, {0}, {1, 2, 3, 4}), False),  # nobody normal in S1
            (Question(1, False), ({0}, {0, 1, 2}, {3, 4}), False),  # 3 hears 0 and 2
        ],
    )
    def test_every_clause_counts(self, question: Question, sets: tuple[set[int], ...], holds: bool) -> None:
        assert solves(self.wheel, question, Sets(*map(frozenset, sets))) is holds

    def test_local_bound_is_about_everybody_outside(self) -> None:
        star = rb.Digraph.from_networkx(nx.star_graph(3))
        assert obeys_bound(star, frozenset({1, 2, 3, 0}), 0, local=True)
        assert not obeys_bound(star, frozenset({1, 2}), 1, local=True), "the hub hears two"
        assert obeys_bound(star, frozenset({0}), 1, local=True)
        assert not obeys_bound(star, frozenset({0}), 0, local=False)


class TestMisuse:
    graph = nx.path_graph(4)

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"f": -1}, "f is an integer"),
            ({"f": True}, "f is an integer"),
            ({"f": 1, "faces": 3}, "1 or 2 faces"),
            ({"f": 1, "algorithm": "magic"}, "algorithm is 'auto'"),
            ({"f": 1, "counting": False, "algorithm": "cp-sat"}, "does not take counting"),
            ({"f": 1, "magic": 1}, "does not take magic"),
            ({"f": 1, "time_limit": 0}, "time_limit"),
        ],
    )
    def test_messages(self, options: dict[str, object], message: str) -> None:
        with pytest.raises(InvalidParameter, match=message):
            find_trap(self.graph, **options)  # type: ignore[arg-type]

    def test_no_truth_value(self) -> None:
        with pytest.raises(TypeError, match="no truth value"):
            bool(find_trap(self.graph, 1))

    def test_a_wrong_solution_is_an_internal_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        wrong = TrapAnswer(True, Sets(frozenset(), frozenset({0}), frozenset({1})))
        monkeypatch.setattr("robustness.traps.cp_sat.decide", lambda *_: wrong)
        with pytest.raises(InternalError, match="please report"):
            find_trap(nx.complete_graph(5), 1, algorithm="cp-sat")


@pytest.mark.parametrize("n", [0, 1])
@pytest.mark.parametrize("algorithm", ["auto", *TRAP_ALGORITHMS])
def test_nobody_to_hold_apart(n: int, algorithm: str) -> None:
    assert find_trap(nx.empty_graph(n), 1, algorithm=algorithm).exists is False


def test_f_beyond_n() -> None:
    for faces, local in KINDS:
        graph = rb.Digraph.from_networkx(nx.complete_graph(3))
        assert decide_trap(graph, Question(10**9, faces == 2, local), Limits(), "search")[0]
        assert decide_trap(graph, Question(10**9, faces == 2, local), Limits())[0]


def test_the_solver_is_not_imported_before_it_is_asked_for() -> None:
    program = (
        "import sys, networkx as nx; from robustness.traps import find_trap; "
        "find_trap(nx.path_graph(3), 1); print({'ortools', 'matplotlib'} & set(sys.modules))"
    )
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run([sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
