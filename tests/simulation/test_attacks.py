"""Attacks made from evidence split exactly, on every small graph and under every rule."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from itertools import combinations
from typing import Any

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness.constructions.counterexamples import FIVE_NODE_READINGS, five_node_figure, two_f_robust_counterexample
from robustness.constructions.small_graphs import each_graph
from robustness.definitions import is_violation
from robustness.digraph import Digraph, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits
from robustness.results import RobustnessResult, Verdict
from robustness.simulation import (
    RULES,
    Attack,
    attack_from_trap,
    attack_from_violation,
    find_attack,
    finding,
)
from robustness.simulation.finding import ATTACK_MODELS
from robustness.simulation.schedules import AdversarialDelays, AdversarialUpdates, RandomDelays, RandomUpdates, Schedule
from robustness.threat_models import THREAT_MODELS
from robustness.traps import exhaustive, is_trap
from robustness.traps.question import Question, TrapAnswer

LIGHT_SCHEDULES = [
    Schedule(RandomUpdates(0.4, 3), RandomDelays(2)),
    Schedule(AdversarialUpdates(3), AdversarialDelays(2)),
]


def disjoint_pairs(n: int) -> Iterator[tuple[frozenset[int], frozenset[int]]]:
    """Yield every pair of nonempty disjoint id sets once."""
    for code in range(3**n):
        places = [code // 3**i % 3 for i in range(n)]
        first, second = (frozenset(i for i in range(n) if places[i] == side) for side in (1, 2))
        if first and second and min(first) < min(second):
            yield first, second


def traps(graph: Digraph, f: int) -> Iterator[tuple[frozenset[int], frozenset[int], frozenset[int]]]:
    """Yield every trap for f, by the definition."""
    for size in range(f + 1):
        for chosen in combinations(range(graph.n), size):
            for first, second in disjoint_pairs(graph.n):
                if is_trap(graph, f, *(graph.labels_of(ids) for ids in (chosen, first, second))):
                    yield frozenset(chosen), first, second


def assert_splits(attack: Attack, steps: int = 25, **changes: Any) -> None:
    outcome = attack.run(steps, **changes)
    assert outcome.exact, (attack.story(), changes)
    assert outcome.verdict.value == "split"


class TestEverySmallGraph:
    def test_what_is_not_robust_is_split_by_its_own_attack(self) -> None:
        """n <= 5, f = 1, every graph that is not (2,2)-robust; every rule."""
        refuted = 0
        for graph in each_graph(5, directed=False):
            if graph.n < 2:
                continue
            result = rb.check_rs_robustness(graph, 2, 2)
            if result.witness is not None:
                refuted += 1
                for rule in RULES:
                    assert_splits(attack_from_violation(graph, 1, result.witness), rule=rule)
        assert refuted == 42  # of 51; the other 9 are (2,2)-robust and meet the battery

    def test_every_violation_of_a_few(self) -> None:
        """All violating pairs, not only the one that is found, on graphs and digraphs of up to 4 nodes, f = 1."""
        count = 0
        for graph in each_graph(3, directed=True):
            for first, second in disjoint_pairs(graph.n):
                if is_violation(graph, first, second, 2, 2):
                    count += 1
                    assert_splits(attack_from_violation(graph, 1, (graph.labels_of(first), graph.labels_of(second))), 8)
        assert count > 50

    def test_every_trap_of_graphs_on_four_nodes(self) -> None:
        assert self.play_traps(range(2, 5)) > 300

    @pytest.mark.slow
    def test_every_trap_of_graphs_on_five_nodes(self) -> None:
        assert self.play_traps([5]) == 2380

    @staticmethod
    def play_traps(sizes: Any) -> int:
        """Every trap (M, S1, S2) for f = 1 is an attack with delays; one in seven is played by Byzantine nodes too."""
        count = 0
        for graph in each_graph(max(sizes), directed=False):
            for evidence in traps(graph, 1) if graph.n in sizes else ():
                sets = [graph.labels_of(ids) for ids in evidence]
                assert_splits(attack_from_trap(graph, 1, *sets), 12)
                count += 1
                if count % 7 == 0:
                    assert_splits(attack_from_trap(graph, 1, *sets, "byzantine"), 12, rule="w-msr")
        return count


class TestTheSplitDependsOnNothingElse:
    WHEEL = five_node_figure()

    def attacks(self) -> list[Attack]:
        trap = self.WHEEL.graph["trap"]
        ring = nx.cycle_graph(8)
        return [
            attack_from_trap(self.WHEEL, 1, trap["M"], trap["S1"], trap["S2"]),
            attack_from_trap(self.WHEEL, 1, trap["M"], trap["S1"], trap["S2"], "byzantine"),
            attack_from_violation(ring, 1, rb.check_rs_robustness(ring, 2, 2).witness),
        ]

    @pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")
    @given(
        st.floats(0.001, 3),
        st.floats(0.01, 30),
        st.sampled_from(["unit", "uniform"]),
        st.sampled_from(["adp-msr", "w-msr"]),
    )
    @settings(max_examples=30)
    def test_period_gains_weights_and_rule(self, T: float, alpha: float, weights: str, rule: str) -> None:
        """Also where everybody else oscillates or diverges: exactly, as the module argues."""
        for attack in self.attacks():
            assert_splits(attack, 40, T=T, alpha=alpha, weights=weights, rule=rule, target_speed=17.3)

    def test_schedules(self) -> None:
        for attack in self.attacks():
            for schedule in LIGHT_SCHEDULES:
                if not attack.delayed or schedule.delay_rule.adversarial:
                    assert_splits(attack, 60, schedule=schedule)

    @given(st.lists(st.floats(-1e6, 1e6), min_size=8, max_size=8))
    @settings(max_examples=20)
    def test_formations(self, places: list[float]) -> None:
        """Exactly, also where no floating-point number is the sum of a position and an offset."""
        for attack in self.attacks():
            assert_splits(attack, 20, offsets=dict(zip(attack.graph.labels, places, strict=False)))

    def test_sensing(self) -> None:
        for attack in self.attacks():
            if attack.model == "malicious":
                assert_splits(attack, 40, active=frozenset(attack.graph.labels))

    def test_gains_outside_the_theory_are_said_and_not_warned_of(self) -> None:
        """The split is proven for all gains; only agreement would need the theory."""
        for attack in self.attacks():
            outcome = attack.run(20, T=0.01, alpha=1.0)
            assert outcome.exact
            assert "nothing is promised" in str(outcome.promise_gap)


class TestPropositionOne:
    @pytest.mark.parametrize("f", [1, 2, 3])
    @pytest.mark.parametrize("variant", ["paper", "corrected"])
    def test_is_a_trap(self, f: int, variant: str) -> None:
        graph = two_f_robust_counterexample(f, variant)
        trap = graph.graph["trap"]
        assert_splits(attack_from_trap(graph, f, trap["M"], trap["S1"], trap["S2"]), 100)

    @pytest.mark.parametrize("reading", FIVE_NODE_READINGS)
    def test_the_five_node_figure(self, reading: str) -> None:
        graph = five_node_figure(reading)
        trap = graph.graph["trap"]
        assert_splits(attack_from_trap(graph, 1, trap["M"], trap["S1"], trap["S2"]), 100)
        assert rb.is_rs_robust(graph, 2, 2)

    def test_without_delays_the_same_adversary_fails(self) -> None:
        """The wheel is (2,2)-robust: two faces need delays."""
        graph = five_node_figure()
        trap = graph.graph["trap"]
        attack = attack_from_trap(graph, 1, trap["M"], trap["S1"], trap["S2"])
        assert attack.run(300, schedule=Schedule(), groups=None).verdict.value == "agreement"

    def test_more_malicious_nodes_than_f_locally(self) -> None:
        """f-local: two wheels far apart, each with its own hub; f-total would refuse two malicious nodes."""
        graph = nx.disjoint_union(nx.wheel_graph(5), nx.wheel_graph(5))
        sets = ([0, 5], [1, 2], [3, 4])
        assert_splits(attack_from_trap(graph, 1, *sets, "malicious-local"))
        with pytest.raises(InvalidParameter, match="f-total"):
            attack_from_trap(graph, 1, *sets)


class TestEvidenceIsChecked:
    CYCLE, WHEEL = nx.cycle_graph(6), nx.wheel_graph(5)

    @pytest.mark.parametrize(
        ("graph", "f", "pair"),
        [
            (CYCLE, 0, ({0, 1, 2}, {3, 4, 5})),
            (CYCLE, 1, (set(), {3})),
            (CYCLE, 1, ({0, 1}, {1, 2})),
            (WHEEL, 1, ({1, 2}, {3, 4})),
            (CYCLE, -1, ({0, 1, 2}, {3, 4, 5})),
            (CYCLE, 1.0, ({0, 1, 2}, {3, 4, 5})),
        ],
    )
    def test_no_violation_no_attack(self, graph: nx.Graph, f: Any, pair: Any) -> None:
        with pytest.raises(InvalidParameter):
            attack_from_violation(graph, f, pair)

    @pytest.mark.parametrize(
        ("f", "M", "S1", "S2"),
        [
            (1, {0}, {1, 2}, {2, 3}),
            (1, {1}, {1, 2}, {3, 4}),
            (1, {0}, set(), {3, 4}),
            (1, {0, 1}, {2}, {3}),
            (0, set(), {1, 2}, {3, 4}),
            (1, {3}, {0, 1}, {2}),
            (-1, set(), {1}, {3}),
        ],
    )
    def test_no_trap_no_attack(self, f: int, M: set[int], S1: set[int], S2: set[int]) -> None:
        with pytest.raises(InvalidParameter):
            attack_from_trap(self.WHEEL, f, M, S1, S2)

    def test_a_malicious_set_of_ones_own(self) -> None:
        """Three cliques in a chain, each joint doubled: f = 1 local, with two malicious nodes far apart."""
        chain = nx.Graph()
        for block in range(3):
            chain.add_edges_from(combinations(range(4 * block, 4 * block + 4), 2))
        chain.add_edges_from([(3, 4), (3, 5), (7, 8), (7, 9)])
        pair = (set(range(4)), set(range(8, 12)))
        assert_splits(attack_from_violation(chain, 1, pair, malicious={3}))
        local = attack_from_violation(chain, 1, pair, malicious={3, 11}, model="malicious-local")
        assert_splits(local, 60)
        assert Attack.from_dict(chain, json.loads(json.dumps(local.as_dict()))) == local
        for bad, model in (({3, 11}, "malicious"), (set(), "malicious"), ({3, 4}, "malicious-local"), ({3}, "evil")):
            with pytest.raises(InvalidParameter):
                attack_from_violation(chain, 1, pair, malicious=bad, model=model)
        with pytest.raises(InvalidParameter, match="normal node in each"):
            attack_from_violation(nx.empty_graph(2), 2, ({0}, {1}), malicious={0})

    def test_unknown_nodes_and_models(self) -> None:
        with pytest.raises(ValueError, match="'x' is none"):
            attack_from_violation(self.CYCLE, 1, ({"x"}, {0}))
        with pytest.raises(InvalidParameter, match="a fault model is one of"):
            attack_from_trap(self.WHEEL, 1, {0}, {1, 2}, {3, 4}, "evil")


class TestFiles:
    TUPLES = nx.grid_2d_graph(2, 3)

    def attacks(self) -> list[Attack]:
        wheel = nx.relabel_nodes(nx.wheel_graph(5), {0: "hub", 1: 1, 2: "1"})
        return [
            attack_from_violation(self.TUPLES, 1, rb.check_rs_robustness(self.TUPLES, 2, 2).witness),
            attack_from_trap(wheel, 1, {"hub"}, {1, "1"}, {3, 4}),
            attack_from_trap(wheel, 1, {"hub"}, {1, "1"}, {3, 4}, "byzantine"),
        ]

    def test_round_trip(self) -> None:
        for attack in self.attacks():
            document = json.loads(json.dumps(attack.as_dict()))
            assert Attack.from_dict(attack.graph, document) == attack

    def test_changing_anything_is_noticed(self) -> None:
        changes = {
            "schema": "robustness/attack/2", "kind": "trick", "graph": {}, "f": 0, "model": "byzantine",
            "malicious": [], "S1": [1], "S2": [], "delayed": False, "positions": {}, "story": "",
        }  # fmt: skip
        attack = self.attacks()[1]
        original = json.loads(json.dumps(attack.as_dict()))
        assert set(changes) == set(original)
        for key, value in changes.items():
            changed = copy.deepcopy(original)
            changed[key] = value
            with pytest.raises(ValueError, match=r"attack|trap|f-total"):
                Attack.from_dict(attack.graph, changed)
        for document in (None, [], {}, {**original, "extra": 1}, {**original, "f": "1"}):
            with pytest.raises(InvalidParameter):
                Attack.from_dict(attack.graph, document)

    def test_another_graph_is_refused(self) -> None:
        attack = self.attacks()[1]
        with pytest.raises(InvalidParameter, match="another graph"):
            Attack.from_dict(nx.wheel_graph(6), attack.as_dict())


class TestFinding:
    @pytest.mark.parametrize(
        ("graph", "f", "model", "outcome"),
        [
            (nx.cycle_graph(6), 1, "malicious", "split"),
            (nx.wheel_graph(5), 1, "malicious", "agreement"),
            (nx.wheel_graph(5), 1, "delayed", "split"),
            (nx.wheel_graph(5), 1, "byzantine", "split"),
            (nx.complete_graph(5), 1, "delayed", "agreement"),
            (nx.complete_graph(5), 1, "byzantine", "agreement"),
            (nx.complete_graph(4), 1, "byzantine", "agreement"),
            (nx.complete_graph(4), 1, "delayed", "agreement"),
            (nx.complete_graph(4), 1, "delayed-local", "agreement"),
            (nx.complete_graph(4), 1, "malicious-local", "agreement"),
            (nx.complete_graph(5), 1, "malicious-local", "agreement"),
            (nx.cycle_graph(6), 1, "malicious-local", "split"),
            (nx.wheel_graph(5), 1, "delayed-local", "split"),
            (nx.complete_graph(4), 2, "malicious", "split"),
            (nx.complete_graph(2), 1, "delayed", "split"),
            (nx.complete_graph(3), 5, "malicious", "split"),
            (nx.complete_graph(2), 0, "byzantine", "agreement"),
            (nx.empty_graph(1), 0, "malicious", "agreement"),
            (nx.empty_graph(0), 0, "malicious", "agreement"),
            (nx.path_graph(3), 0, "delayed", "agreement"),
            (nx.empty_graph(3), 0, "malicious", "split"),
        ],
    )
    def test_every_answer(self, graph: nx.Graph, f: int, model: str, outcome: str) -> None:
        found = find_attack(graph, f, model)
        assert found.outcome == outcome, found.reason
        assert (found.attack is not None) == (outcome == "split")
        if found.attack is not None:
            assert_splits(found.attack)

    def test_every_answer_is_that_of_the_definition(self) -> None:
        """Every graph on up to 4 nodes and digraph on up to 3, f = 0, 1, 2, against all sets M, S1, S2."""
        self.compare_with_the_definition([*each_graph(4, directed=False), *each_graph(3, directed=True)])

    @pytest.mark.slow
    def test_every_answer_is_that_of_the_definition_on_more_nodes(self) -> None:
        self.compare_with_the_definition([*each_graph(5, directed=False), *each_graph(4, directed=True)])

    @staticmethod
    def compare_with_the_definition(graphs: list[Digraph]) -> None:
        for graph in graphs:
            for f in range(3) if graph.n >= 2 else ():
                for model, question in {name: threat.question(f) for name, threat in THREAT_MODELS.items()}.items():
                    found = find_attack(graph, f, model)
                    exists = exhaustive.decide(graph, question, Limits())[0]
                    assert (found.attack is not None) == exists, (list(graph.arcs()), f, model)
                    if found.attack is not None:
                        assert found.outcome == "split"
                        assert found.attack.model == THREAT_MODELS[model].faults
                        assert_splits(found.attack, 4)
                    else:
                        assert found.outcome == "agreement"
                        assert "alpha T" in found.reason

    @pytest.mark.parametrize("model", ["delayed", "delayed-local", "malicious-local"])
    def test_the_time_limit_is_for_everything_together(self, model: str, monkeypatch: pytest.MonkeyPatch) -> None:
        """A clock of our own: the check of robustness uses all it was given, and the search gets the rest."""
        clock, given = [100.0], []

        def check(graph: Digraph, r: int, s: int, limits: Limits, *_: Any) -> RobustnessResult:
            given.append(limits.seconds_left())
            clock[0] += limits.seconds_left()
            return RobustnessResult(Verdict.UNDECIDED, 11, 1, None)

        def search(graph: Digraph, question: Question, limits: Limits) -> TrapAnswer:
            given.append(limits.seconds_left())
            return TrapAnswer(None)

        monkeypatch.setattr("robustness.limits.time.monotonic", lambda: clock[0])
        monkeypatch.setattr(finding, "check_within", check)
        monkeypatch.setattr(finding, "decide_trap", search)
        found = find_attack(nx.complete_graph(20), 5, model, time_limit=8.0)
        assert given == [4.0, 4.0]
        assert (found.outcome, found.attack) == ("undecided", None)
        assert "raise the time limit" in found.reason

    @pytest.mark.parametrize("model", ATTACK_MODELS)
    def test_no_time_at_all_claims_nothing(self, model: str, monkeypatch: pytest.MonkeyPatch) -> None:
        """Whatever each search answers when it is stopped at once, that is not mistaken for a proof."""
        undecided = RobustnessResult(Verdict.UNDECIDED, 3, 1, None)
        monkeypatch.setattr(finding, "check_within", lambda *_: undecided)
        monkeypatch.setattr(finding, "decide_trap", lambda *_: TrapAnswer(None))
        assert find_attack(nx.complete_graph(9), 1, model, time_limit=1e-9).outcome == "undecided"

    def test_one_search_for_all_sets(self) -> None:
        """200 nodes, f = 4: 66 million sets M, and one search."""
        assert find_attack(nx.circulant_graph(200, range(1, 9)), 4, "byzantine").outcome == "agreement"
        found = find_attack(nx.circulant_graph(200, range(1, 6)), 4, "delayed")
        assert found.attack is not None
        assert_splits(found.attack, 20)

    @pytest.mark.parametrize("model", ATTACK_MODELS)
    def test_agreement_is_promised_for_the_gains_of_the_theory(self, model: str) -> None:
        graph = nx.complete_graph(5)
        assert "2 sqrt(s) - s/2 <= alpha T <= 2 - s/2" in find_attack(graph, 1, model).reason
        for inside in ({"T": 1.0}, {"T": 0.01, "alpha": 2.0}, {"sigma": 0.9}, {"T": 0.01, "alpha": 10.0, "sigma": 3.0}):
            assert find_attack(graph, 1, model, **inside).outcome == "agreement"
        for outside in ({"alpha": 4.0}, {"T": 0.01, "alpha": 0.3}, {"sigma": 1.0}, {"T": 1.2}):
            found = find_attack(graph, 1, model, **outside)
            assert (found.outcome, found.attack) == ("undecided", None)
            assert "nothing is promised" in found.reason
        split = find_attack(nx.cycle_graph(6), 1, model, T=0.01, alpha=0.3)
        assert split.attack is not None

    def test_bad_questions(self) -> None:
        with pytest.raises(InvalidParameter, match="positive number"):
            find_attack(nx.complete_graph(5), 1, "delayed", alpha=-1.0)
        with pytest.raises(InvalidParameter, match="model"):
            find_attack(nx.cycle_graph(4), 1, "evil")
        with pytest.raises(InvalidParameter, match="f is"):
            find_attack(nx.cycle_graph(4), -1)

    def test_the_graph_may_be_ours(self) -> None:
        assert find_attack(as_digraph(nx.cycle_graph(6)), 1).outcome == "split"
