"""What users pass is checked or converted at the door: nothing fails later with AttributeError or TypeError."""

from __future__ import annotations

from typing import Any

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter, RobustnessError
from robustness.simulation import ADVERSARIES, SCHEDULES, Scenario, Start, as_topology, random_start, simulate
from robustness.simulation.adversaries import Alternating, Sine
from robustness.simulation.reference import simulate_plainly
from robustness.simulation.replay import decode_run, encode_run
from robustness.simulation.schedules import Schedule
from robustness.simulation.topology import Topology
from robustness.time_varying import TimeVaryingGraph

K5 = nx.complete_graph(5)
REST = [0.0] * 5
PLACES = [0, 25, 50, 75, 100]


def scenario(**changes: Any) -> Scenario:
    return Scenario(**({"network": K5, "f": 1, "steps": 60} | changes))


class TestConverted:
    def test_every_kind_of_network(self) -> None:
        fixed, varying = as_topology(K5, 1), TimeVaryingGraph([K5], period=1)
        networks = [K5, nx.DiGraph(K5), as_digraph(K5), fixed, varying, lambda k: K5]
        start = Start([4], PLACES, REST)
        assert len({simulate(Scenario(network, 1, steps=60), start)[0].spread for network in networks}) == 1

    def test_the_calls_of_the_issue(self) -> None:
        start = random_start(K5, [4])
        assert start == random_start(as_topology(K5, 1), {4}, seed=0)
        (outcome,) = simulate(Scenario(K5, 1, adversary="sine"), start)
        assert outcome.verdict.value == "agreement"
        assert Start({4}, PLACES, REST) == Start(frozenset({4}), tuple(map(float, PLACES)), tuple(REST), 0)

    @pytest.mark.parametrize("name", ADVERSARIES)
    def test_adversaries_by_name_class_and_instance(self, name: str) -> None:
        made = ADVERSARIES[name]()
        assert scenario(adversary=name) == scenario(adversary=type(made)) == scenario(adversary=made)

    @pytest.mark.parametrize("name", SCHEDULES)
    def test_schedules_by_name(self, name: str) -> None:
        assert scenario(schedule=name).schedule.oldest == (0 if name == "synchronous" else 3)

    def test_numpy_numbers_and_arrays(self) -> None:
        start = Start(np.array([4]), np.linspace(0, 1, 5), np.zeros(5), np.int64(7))
        assert start == Start({4}, (0, 0.25, 0.5, 0.75, 1), REST, 7)
        assert scenario(f=np.int64(1), T=np.float32(0.5), alpha=np.int32(3)) == scenario(f=1, T=0.5, alpha=3.0)

    def test_collections_of_nodes(self) -> None:
        made = scenario(active=[1, 2], added_links=[[4, 0]], groups=[{0}, [1, 2]])
        assert (made.active, made.added_links, made.groups) == (frozenset({1, 2}), ((4, 0),), ((0,), (1, 2)))

    def test_what_was_converted_is_recorded_and_read_back(self) -> None:
        made, start = scenario(adversary="sine", schedule="delayed", active=[1]), random_start(K5, [4])
        assert decode_run(encode_run(made, start)) == (made, start)


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"network": "k5.json"}, "a network is a graph"),
        ({"network": None}, "a network is a graph"),
        ({"f": 1.0}, "f is an integer"),
        ({"f": "1"}, "f is an integer"),
        ({"f": None}, "f is an integer"),
        ({"steps": 10.5}, "the number of steps is an integer"),
        ({"rule": 3}, "an update rule is one of"),
        ({"rule": Sine}, "an update rule is one of"),
        ({"rule": lambda own: own}, r"is called as <lambda>\(own, heard\), and this one takes other arguments"),
        ({"model": 3}, "a fault model is one of"),
        ({"model": ["malicious"]}, "a fault model is one of"),
        ({"adversary": "sinus"}, "an adversary is one of constant"),
        ({"adversary": 3}, "an adversary is a name"),
        ({"adversary": None}, "an adversary is a name"),
        ({"adversary": Alternating}, "an adversary is an instance"),
        ({"schedule": "late"}, "a schedule is one of"),
        ({"schedule": 3}, "a schedule is a Schedule or one of"),
        ({"T": "1"}, "the sampling period T is a positive number"),
        ({"T": True}, "the sampling period T is a positive number"),
        ({"T": 10**400}, "the sampling period T is a positive number"),
        ({"alpha": "1"}, "alpha is a positive number"),
        ({"alpha": -1}, "alpha is a positive number"),
        ({"target_speed": None}, "the target speed is a finite number"),
        ({"weights": 1.0}, "weights is a mapping"),
        ({"offsets": [1, 2]}, "offsets is a mapping"),
        ({"active": "a"}, "active is a collection of nodes"),
        ({"active": 4}, "active is a collection of nodes"),
        ({"active": [[4]]}, "cannot be one"),
        ({"active": [17]}, "17"),
        ({"added_links": [4]}, "an added link"),
        ({"added_links": [(1, 2, 3)]}, "an added link is a pair"),
        ({"added_links": 4}, "the set of added links"),
        ({"groups": [{0}]}, "groups are two collections"),
        ({"groups": (0, 1)}, "each of the two groups"),
        ({"groups": ({0}, {17})}, "17"),
        ({"tolerance": "small"}, "the tolerance is a positive number"),
        ({"dwell": 1.5}, "the dwell time is an integer"),
        ({"growth": 0}, "the growth limit is a positive number"),
        ({"growth": 1e300}, "at most 1e"),
    ],
)
def test_refused_scenarios(changes: dict[str, Any], rule: str) -> None:
    with pytest.raises(RobustnessError, match=rule):
        scenario(**changes)


@pytest.mark.parametrize(
    ("arguments", "rule"),
    [
        ((4, PLACES, REST), "malicious nodes is a collection"),
        (("4", PLACES, REST), "malicious nodes is a collection"),
        (({4}, "abcde", REST), "positions are a sequence of numbers"),
        (({4}, 5, REST), "positions are a sequence of numbers"),
        (({4}, [None] * 5, REST), "positions are finite numbers"),
        (({4}, [True] * 5, REST), "positions are finite numbers"),
        (({4}, [float("nan")] * 5, REST), "each of the positions is a finite number"),
        (({4}, PLACES, {0: 1}), "velocities are a sequence of numbers"),
        (({4}, PLACES, [float("inf")] * 5), "each of the velocities is a finite number"),
        (({4}, PLACES, REST, -1), "a seed is an integer"),
        (({4}, PLACES, REST, "7"), "a seed is an integer"),
    ],
)
def test_refused_starts(arguments: tuple[Any, ...], rule: str) -> None:
    with pytest.raises(InvalidParameter, match=rule):
        Start(*arguments)


@pytest.mark.parametrize(
    ("first", "second", "rule"),
    [
        (K5, random_start(K5, [4]), "a run needs a Scenario"),
        (scenario(), K5, "starts are Start objects"),
        (scenario(), [random_start(K5, [4]), 3], "starts are Start objects"),
        (scenario(), random_start(nx.complete_graph(6), [4]), "one position for each of the 5 nodes"),
        (scenario(steps=10**18), random_start(K5, [4]), "memory"),
        (scenario(steps=10**30), random_start(K5, [4]), "memory"),
    ],
)
def test_refused_runs(first: Any, second: Any, rule: str) -> None:
    with pytest.raises(InvalidParameter, match=rule):
        simulate(first, second)


@pytest.mark.parametrize("graph", ["K5", None, 5])
def test_refused_graphs_of_random_starts(graph: Any) -> None:
    with pytest.raises(RobustnessError):
        random_start(graph, [4])


class TestRulesOfOnesOwn:
    def test_a_median_is_played_against_every_adversary_as_the_plain_loop_plays_it(self) -> None:
        def median(own: float, heard: tuple[float, ...]) -> float:
            return sorted([own, *heard])[(len(heard) + 1) // 2]

        for name in ADVERSARIES:
            for schedule in ("synchronous", "adversarial", "delayed"):
                made = scenario(rule=median, adversary=name, schedule=schedule, steps=30)
                start = random_start(K5, [4])
                (one,), (other,) = simulate(made, start, record=True), simulate_plainly(made, [start], record=True)
                assert one == other
                assert np.array_equal(one.trajectory.p, other.trajectory.p)
                assert "no theorem" in one.promise_gap

    def test_the_mean_of_all_is_dragged_away_and_the_trimmed_mean_is_not(self) -> None:
        def mean(own: float, heard: tuple[float, ...]) -> float:
            return (own + sum(heard)) / (1 + len(heard))

        def trimmed(own: float, heard: tuple[float, ...]) -> float:
            kept = [own, *sorted(heard)[1:-1]]
            return sum(kept) / len(kept)

        start = Start([4], [0, 1, 2, 3, 1000], REST)
        scenarios = [scenario(rule=rule, adversary="constant", steps=200) for rule in (mean, trimmed)]
        ends = [simulate(each, start)[0].groups[0][0] for each in scenarios]
        assert ends[0] > 900
        assert 0 <= ends[1] <= 3

    def test_on_links_that_come_and_go(self) -> None:
        parts = [nx.Graph([(0, 1), (2, 3)]), nx.Graph([(1, 2), (3, 0)])]
        for part in parts:
            part.add_nodes_from(range(4))
        made = scenario(network=TimeVaryingGraph(parts, period=2), rule=lambda own, heard: min([own, *heard]), f=0)
        start = Start([], [3, 2, 1, 0], [0] * 4)
        (one,), (other,) = simulate(made, start), simulate_plainly(made, [start])
        assert one == other
        assert one.verdict.value == "agreement"
        assert one.groups == ((0.0, (0, 1, 2, 3)),)

    def test_one_that_returns_no_number_is_told_so_and_one_that_explodes_diverges(self) -> None:
        start = random_start(K5, [4])
        for wrong in (None, "3", True, [1.0]):
            with pytest.raises(InvalidParameter, match="returns the next value, a number"):
                simulate(scenario(rule=lambda own, heard, wrong=wrong: wrong), start)
        for worse in (float("nan"), float("inf"), 1e300):
            (outcome,) = simulate(scenario(rule=lambda own, heard, worse=worse: worse), start)
            assert outcome.verdict.value == "divergence"
            assert outcome.diverged_at == 1

    def test_errors_of_the_rule_itself_are_the_users_to_see(self) -> None:
        with pytest.raises(ZeroDivisionError):
            simulate(scenario(rule=lambda own, heard: 1 / 0), random_start(K5, [4]))

    def test_cannot_be_recorded(self) -> None:
        with pytest.raises(InvalidParameter, match="only the parts of this package"):
            encode_run(scenario(rule=lambda own, heard: own), random_start(K5, [4]))


@pytest.mark.parametrize("tau", [0.0, -1, True, "3", float("nan")])
def test_the_age_of_values_is_a_whole_number(tau: Any) -> None:
    with pytest.raises(InvalidParameter, match="tau is an integer of at least 0, not"):
        Schedule(tau=tau)


@pytest.mark.parametrize("place", [0.0, -1, 1, True, "0", None])
def test_a_step_names_one_of_the_graphs(place: Any) -> None:
    with pytest.raises(InvalidParameter, match="the graph of a step is a number from 0 to 0, not"):
        Topology((as_digraph(K5),), (0, place))
