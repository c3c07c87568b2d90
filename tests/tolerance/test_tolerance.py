"""What is guaranteed and refuted is what the definitions say, for every model, and every attack splits exactly."""

from __future__ import annotations

import random

import networkx as nx
import pytest

import robustness as rb
from robustness.answers import Answer, Question
from robustness.decision.ladder import settle_quickly
from robustness.errors import InvalidGraph, InvalidParameter
from robustness.limits import Limits
from robustness.threat_models import THREAT_MODELS, Standing, tolerance
from robustness.threat_models.confirmation import confirm
from robustness.threat_models.decisions import Decisions, certain_attack
from robustness.threat_models.verdicts import judge
from robustness.traps.question import TrapAnswer
from tests.oracles import digraphs, graphs
from tests.tolerance.brute_force import expected, has_standing_attack, has_trap

SMALL = [graph for n in range(2, 6) for graph in graphs(n)] + [graph for n in (2, 3) for graph in digraphs(n)]


def samples(count: int, seed: int) -> list[rb.Digraph]:
    """Return random graphs and digraphs on 4 to 7 nodes, of all densities."""
    draw = random.Random(seed)
    return [
        rb.Digraph.from_networkx(
            nx.gnp_random_graph(
                draw.choice((4, 5, 6, 7)),
                draw.uniform(0.3, 1),
                seed=draw.randrange(2**31),
                directed=draw.random() < 0.6,
            )
        )
        for _ in range(count)
    ]


def assert_as_defined(graph: rb.Digraph) -> None:
    table = tolerance(graph)
    assert {model: (r.guaranteed, r.refuted) for model, r in table.items()} == expected(graph), graph.in_masks
    assert table.is_decided
    for result in table.results:
        assert result.between == ()
        assert [reason.standing for reason in result.reasons][-1] is Standing.REFUTED


@pytest.mark.parametrize("part", range(4))
def test_every_model_on_all_small_graphs(part: int) -> None:
    for graph in SMALL[part::4]:
        assert_as_defined(graph)


@pytest.mark.parametrize("seed", [1, 2])
def test_every_model_on_random_graphs(seed: int) -> None:
    for graph in samples(12, seed):
        assert_as_defined(graph)


def test_every_refuted_f_is_split_exactly_by_the_simulator() -> None:
    for graph in [*SMALL[::3], *samples(6, 3)]:
        for result in tolerance(graph).results:
            assert confirm(result, steps=4) is True, (graph.in_masks, result.model)
            attack = result.attack
            assert attack is not None
            assert attack.f == result.refuted
            assert attack.model == THREAT_MODELS[result.model].faults


def test_the_engine_confirms_what_the_plain_loop_confirms() -> None:
    for result in tolerance(nx.wheel_graph(6)).results:
        assert result.attack is not None
        assert result.attack.run(50).exact


class TestTheTwoConditionsUnderDelays:
    """The trap is the sharper necessary condition, and a (2f+1)-robust graph has none."""

    @pytest.mark.parametrize("f", [0, 1, 2])
    def test_promise_excludes_traps_and_violations_contain_them(self, f: int) -> None:
        between = 0
        for graph in [*graphs(5), *digraphs(3), *samples(10, f)]:
            masks = graph.in_masks
            local, total = has_trap(masks, f, True), has_trap(masks, f, False)
            violated = has_standing_attack(masks, f, False)
            if rb.is_r_robust(graph, 2 * f + 1):
                assert not local
            assert local or not total
            assert total or not violated
            if f < graph.n:
                assert violated == (not rb.is_rs_robust(graph, f + 1, f + 1))
            between += total and not violated
        assert between > 0 or f != 1, "no graph shows that the trap is sharper"

    def test_the_wheel_is_2_2_robust_and_trapped(self) -> None:
        table = tolerance(nx.wheel_graph(5))
        assert table.guaranteed == {
            "malicious": 1,
            "malicious-local": 1,
            "byzantine": 0,
            "byzantine-local": 0,
            "delayed": 0,
            "delayed-local": 0,
        }
        assert table["delayed"].attack_sets is not None
        assert table["delayed"].attack_sets.kind == "trap"


class TestFewNodes:
    @pytest.mark.parametrize("n", [0, 1])
    def test_nobody_disagrees(self, n: int) -> None:
        for result in tolerance(nx.empty_graph(n)).results:
            assert (result.guaranteed, result.refuted, result.attack) == (0, None, None)
            assert result.standing(5) is Standing.GUARANTEED
            assert result.is_decided
            assert result.between == ()
            assert confirm(result) is None
            assert "fewer than two" in result.summary()

    def test_two_nodes(self) -> None:
        assert set(tolerance(nx.empty_graph(2)).refuted.values()) == {0}
        assert set(tolerance(nx.empty_graph(2)).guaranteed.values()) == {-1}
        assert set(tolerance(nx.path_graph(2)).refuted.values()) == {1}
        assert set(tolerance(nx.DiGraph([(0, 1)])).guaranteed.values()) == {0}

    @pytest.mark.parametrize("n", range(2, 8))
    def test_with_a_third_malicious_even_a_complete_graph_is_trapped(self, n: int) -> None:
        table = tolerance(nx.complete_graph(n))
        assert table.refuted["byzantine"] == certain_attack(n, two_faces=True) == -(-n // 3)
        assert table.refuted["malicious"] == certain_attack(n, two_faces=False) == -(-n // 2)


class TestLimits:
    def test_a_limit_never_becomes_a_claim(self) -> None:
        graph = nx.random_regular_graph(8, 60, seed=4)
        whole = tolerance(graph, "malicious")
        for result in tolerance(graph, time_limit=1e-6).results:
            for f in range(6):
                standing = result.standing(f)
                if result.model == "malicious" and standing in (Standing.GUARANTEED, Standing.REFUTED):
                    assert whole.standing(f) is standing
            if not result.is_decided:
                assert any(reason.standing is Standing.UNDECIDED for reason in result.reasons)
                assert "limit" in result.summary()

    def test_what_settles_one_model_is_asked_once_for_all(self, monkeypatch: pytest.MonkeyPatch) -> None:
        asked: list[tuple[int, int]] = []

        def note(question: Question, limits: Limits) -> Answer | None:
            asked.append((question.r, question.s))
            return settle_quickly(question, limits)

        monkeypatch.setattr("robustness.threat_models.decisions.settle_quickly", note)
        rb.tolerance(nx.random_regular_graph(5, 24, seed=1))
        assert asked
        assert len(set(asked)) == len(asked)

    def test_nothing_decided_promises_nothing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        undecided = rb.RobustnessResult(rb.Verdict.UNDECIDED, 1, 1)
        monkeypatch.setattr("robustness.threat_models.decisions.check_within", lambda *_, **__: undecided)
        monkeypatch.setattr("robustness.threat_models.decisions.settle_trap", lambda *_: None)
        stopped = TrapAnswer.undecided("stopped")
        monkeypatch.setattr("robustness.threat_models.decisions.decide_trap", lambda *_, **__: stopped)
        decisions = Decisions(rb.Digraph.from_networkx(nx.complete_graph(4)), Limits())
        for threat in THREAT_MODELS.values():
            result = judge(decisions, threat)
            assert (result.guaranteed, result.refuted, result.attack_sets) == (-1, None, None)
            assert [result.standing(f) for f in range(3)] == [Standing.UNDECIDED] * 3
            assert not result.is_decided
            assert "nothing is guaranteed within the limit" in result.summary()


class TestMisuse:
    def test_unknown_model(self) -> None:
        with pytest.raises(InvalidParameter, match="a threat model is one of"):
            tolerance(nx.path_graph(3), "friendly")

    def test_not_a_graph(self) -> None:
        with pytest.raises(InvalidGraph):
            tolerance([1, 2, 3])

    @pytest.mark.parametrize("limit", [0, -1, float("nan"), float("inf")])
    def test_limit(self, limit: float) -> None:
        with pytest.raises(InvalidParameter, match="time_limit"):
            tolerance(nx.path_graph(3), time_limit=limit)

    @pytest.mark.parametrize("f", [-1, 1.0, "1", True])
    def test_standing(self, f: object) -> None:
        with pytest.raises(InvalidParameter, match="f is an integer"):
            tolerance(nx.path_graph(3), "delayed").standing(f)  # type: ignore[arg-type]

    def test_no_truth_value(self) -> None:
        with pytest.raises(TypeError, match="no truth value"):
            bool(tolerance(nx.path_graph(3), "delayed"))


def test_labels_that_look_alike_stay_apart() -> None:
    graph = nx.relabel_nodes(nx.wheel_graph(5), {1: "0"})
    sets = tolerance(graph, "delayed").attack_sets
    assert sets is not None
    assert sets.M == {0}
    assert "0" in sets.S1 | sets.S2


def test_the_graph_is_left_alone() -> None:
    graph = nx.wheel_graph(5)
    before = (dict(graph.nodes(data=True)), sorted(graph.edges()))
    tolerance(graph)
    assert before == (dict(graph.nodes(data=True)), sorted(graph.edges()))


class TestWording:
    def test_paragraph_says_what_the_table_says(self) -> None:
        for graph in SMALL[::5]:
            for result in tolerance(graph).results:
                text = result.summary()
                if result.guaranteed > 0:
                    assert f"guaranteed for f = {result.guaranteed}" in text
                if result.guaranteed < 0:
                    assert "guaranteed" not in text
                assert (f"f = {result.refuted}" if result.refuted else "even though nobody lies") in text

    def test_between_the_two_conditions_of_the_literature_the_network_agrees(self) -> None:
        """K_8 is 4-robust only, so f = 2 is out of reach of (2f+1)-robustness; K_4 with f = 1 likewise."""
        for n, f in ((8, 2), (4, 1)):
            for model in ("delayed", "delayed-local", "byzantine", "byzantine-local"):
                result = tolerance(nx.complete_graph(n), model)
                assert (result.guaranteed, result.refuted) == (f, f + 1), model
            assert "there is no local trap" in tolerance(nx.complete_graph(n), "delayed-local").reasons[0].statement

    def test_notebook(self) -> None:
        table = tolerance(nx.wheel_graph(5))
        assert "<table>" in table._repr_mimebundle_()["text/html"]
        assert "malicious" in table["malicious"]._repr_mimebundle_()["text/html"]

    def test_table_is_a_mapping(self) -> None:
        table = tolerance(nx.wheel_graph(5))
        assert list(table) == list(THREAT_MODELS)
        assert len(table) == 6
        with pytest.raises(KeyError):
            table["friendly"]
        assert set(table.reasons) == set(THREAT_MODELS)
