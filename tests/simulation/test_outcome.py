"""Verdicts on trajectories, without running any."""

from __future__ import annotations

import hashlib

import networkx as nx
import numpy as np
import pytest

from robustness.simulation import RunVerdict, Scenario, Start, as_topology, simulate
from robustness.simulation.draws import Draws
from robustness.simulation.outcome import convergence_rate, groups_of, settled_since, verdict_of
from robustness.simulation.scenario import random_start

STILL = np.zeros(20)


def verdict(spread: np.ndarray, speed: np.ndarray = STILL, **watching: bool) -> tuple[RunVerdict, bool]:
    flags = {"watched": False, "unchanged": True} | watching
    return verdict_of(spread, speed, 0.1, 5, **flags)


class TestVerdict:
    def test_agreement_needs_the_whole_dwell(self) -> None:
        late = np.ones(20)
        late[-5:] = 0.05
        assert verdict(late) == (RunVerdict.AGREEMENT, False)
        late[-5] = 0.2
        assert verdict(late)[0] is RunVerdict.UNDECIDED

    def test_agreement_needs_the_target_speed(self) -> None:
        fast = np.zeros(20)
        fast[-3] = 1.0
        assert verdict(np.zeros(20), fast)[0] is RunVerdict.UNDECIDED

    def test_a_split_is_constant_to_the_last_bit(self) -> None:
        gap = np.linspace(9, 8, 20)
        assert verdict(gap)[0] is RunVerdict.UNDECIDED
        gap[-5:] = 8.0
        assert verdict(gap) == (RunVerdict.SPLIT, False)
        gap[-1] = np.nextafter(8.0, 9.0)
        assert verdict(gap)[0] is RunVerdict.UNDECIDED

    def test_a_gap_that_repeats_to_the_last_bit_is_a_split_too(self) -> None:
        """Vehicles that swap places: 100, 0, 100, 0, ...; half of the dwell time shows whether it repeats."""
        gap = np.tile([8.0, 0.0], 10)
        assert verdict(gap) == (RunVerdict.SPLIT, False)
        gap[-1] += 1e-9
        assert verdict(gap)[0] is RunVerdict.UNDECIDED
        assert verdict(np.tile([8.0, 0.0, 3.0], 7)[:20])[0] is RunVerdict.UNDECIDED  # a turn of 3 in 5 states
        assert verdict(np.tile([0.05, 0.0], 10))[0] is RunVerdict.AGREEMENT

    def test_watched_groups_decide_alone(self) -> None:
        gap = np.full(20, 8.0)
        assert verdict(gap, watched=True, unchanged=True) == (RunVerdict.SPLIT, True)
        assert verdict(gap, watched=True, unchanged=False)[0] is RunVerdict.UNDECIDED

    def test_not_a_number_is_no_agreement(self) -> None:
        assert verdict(np.full(20, np.nan))[0] is RunVerdict.UNDECIDED


def test_settled_since() -> None:
    assert settled_since(np.array([3.0, 0.1, 2.0, 0.1, 0.1]), 0.5) == 3
    assert settled_since(np.array([0.1, 0.1]), 0.5) == 0
    assert settled_since(np.array([0.1, 0.9]), 0.5) is None


def test_rates() -> None:
    assert convergence_rate(3 * 0.9 ** np.arange(500.0)) == pytest.approx(0.9)
    assert convergence_rate(np.ones(9)) is None
    assert convergence_rate(np.zeros(9)) is None
    assert convergence_rate(np.array([1.0, 0.0, 0.0])) is None


def test_groups() -> None:
    normal = np.array([True, True, False, True, True])
    found = groups_of(np.array([5.0, 1.0, 3.0, 1.25, 9.0]), normal, tuple("abcde"), 0.5)
    assert found == ((1.125, ("b", "d")), (5.0, ("a",)), (9.0, ("e",)))


def test_watched_groups_must_start_apart_and_have_somebody() -> None:
    network = as_topology(nx.empty_graph(4), 1)
    scenario = Scenario(network, 1, groups=((0, 1), (2, 3)), steps=10)
    apart, mixed, nobody = (0.0, 0.0, 5.0, 5.0), (0.0, 5.0, 0.0, 5.0), (0.0, 0.0, 5.0, 5.0)
    starts = [Start(frozenset(), apart, (0.0,) * 4), Start(frozenset(), mixed, (0.0,) * 4)]
    assert [outcome.exact for outcome in simulate(scenario, starts)] == [True, False]
    alone = Scenario(network, 2, groups=((0, 1), (2, 3)), steps=10)
    assert not simulate(alone, [Start(frozenset({0, 1}), nobody, (0.0,) * 4)])[0].exact
    moving = Start(frozenset(), apart, (0.0, 0.0, 0.0, 1e-300))
    assert not simulate(scenario, [moving])[0].exact


def test_outcomes_are_json_ready() -> None:
    network = as_topology(nx.complete_graph(4), 1)
    (outcome,) = simulate(Scenario(network, 1, steps=100), [random_start(network.union, [3], 0)])
    said = outcome.as_dict()
    assert said["outcome"] == "agreement"
    assert said["groups"] == [{"value": pytest.approx(said["groups"][0]["value"]), "nodes": [0, 1, 2]}]
    assert 0 < said["rate"] < 1


class TestDraws:
    def test_are_uniform_and_differ(self) -> None:
        values = Draws(range(50)).uniform("x", 3, 400)
        assert values.shape == (50, 400)
        assert 0 <= values.min()
        assert values.max() < 1
        assert len(np.unique(values)) == values.size
        assert values.mean() == pytest.approx(0.5, abs=0.01)
        assert values.var() == pytest.approx(1 / 12, abs=0.002)

    def test_depend_on_seed_purpose_and_step(self) -> None:
        base = Draws([1]).uniform("noise: nodes", 3, 4).tolist()
        assert Draws([2]).uniform("noise: nodes", 3, 4).tolist() != base
        assert Draws([1]).uniform("noise: arcs", 3, 4).tolist() != base
        assert Draws([1]).uniform("noise: nodes", -3, 4).tolist() != base

    def test_are_those_of_the_definition(self) -> None:
        """SplitMix64 of the counters, in integers of any size."""

        def mix(word: int) -> int:
            word = (word ^ word >> 30) * 0xBF58476D1CE4E5B9 % 2**64
            word = (word ^ word >> 27) * 0x94D049BB133111EB % 2**64
            return word ^ word >> 31

        golden = 0x9E3779B97F4A7C15
        salt = int.from_bytes(hashlib.sha256(b"delays").digest()[:8], "little")
        for seed, step in ((0, 0), (7, 12), (2**63 - 1, -3)):
            stream = mix(mix((seed + golden) % 2**64) ^ mix((salt + step * golden) % 2**64))
            expected = [(mix((stream + j * golden) % 2**64) >> 11) * 2.0**-53 for j in range(1, 6)]
            assert Draws([seed]).uniform("delays", step, 5).tolist() == [expected]

    def test_integers_reach_both_ends(self) -> None:
        assert set(Draws([5]).integers("d", 0, 500, 2, 4)[0].tolist()) == {2, 3, 4}

    @pytest.mark.parametrize("seed", [-1, 2**63])
    def test_seeds_out_of_range_are_refused(self, seed: int) -> None:
        with pytest.raises(ValueError, match="a seed is"):
            Draws([seed])
