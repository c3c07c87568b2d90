"""Motion, the change of variables, formations, gains and weights."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness.digraph import Digraph, as_digraph
from robustness.errors import InvalidParameter
from robustness.simulation import PromiseWarning, Scenario, Start, Topology, simulate
from robustness.simulation.dynamics import double_integrator, to_absolute, to_transformed
from robustness.simulation.formation import node_offsets, offsets_from_deltas
from robustness.simulation.gains import arc_weights, fleet_of, kept_weight_bound, node_gains
from robustness.simulation.update_rules import DP_MSR, W_MSR

SMALL = st.floats(-100, 100)


class TestMotion:
    @given(SMALL, SMALL, st.floats(0.001, 3))
    def test_at_rest_nothing_is_rounded(self, x: float, extra: float, T: float) -> None:
        place, still = np.array([x]), np.zeros(1)
        position, velocity = double_integrator(place, still, still, T)
        assert position[0] == x
        assert velocity[0] == 0

    @given(SMALL, SMALL, SMALL, st.floats(0.01, 2), st.floats(-50, 50), st.integers(0, 1000))
    def test_transformed_vehicles_move_by_the_same_equations(
        self, x: float, v: float, u: float, T: float, speed: float, k: int
    ) -> None:
        """Equation 4 of the source paper: transform then move, or move then transform."""
        xs, vs, us = np.array([x]), np.array([v]), np.array([u])
        moved = to_transformed(*double_integrator(xs, vs, us, T), k + 1, T, speed)
        transformed = double_integrator(*to_transformed(xs, vs, k, T, speed), us, T)
        assert np.allclose(moved, transformed, atol=1e-8 * (1 + abs(k * T * speed)))

    def test_the_change_of_variables_is_undone(self) -> None:
        p, q = np.arange(6.0).reshape(3, 2), np.ones((3, 2))
        steps = np.arange(3)[:, None]
        back = to_transformed(*to_absolute(p, q, steps, 0.5, 8.0), steps, 0.5, 8.0)
        assert np.array_equal(back[0], p)
        assert np.array_equal(back[1], q)


class TestFormation:
    GRAPH = as_digraph(nx.path_graph(3))

    def test_delta_is_where_i_wants_j(self) -> None:
        """Equation 5 of the source paper, on the recorded positions: u = sum a (p_j - p_i - delta_ij) - alpha q."""
        offsets = {1: 2.3, 2: 5.1}
        deltas = {(i, j): offsets.get(j, 0.0) - offsets.get(i, 0.0) for i in range(3) for j in range(3)}
        scenario = Scenario(Topology((self.GRAPH,)), 0, offsets=offsets, steps=30, T=0.5, alpha=3.0, weights="unit")
        start = Start(frozenset(), (3.0, -1.0, 4.0), (1.0, -1.0, 0.5))
        (outcome,) = simulate(scenario, [start], record=True)
        states = outcome.trajectory
        assert states.p[0].tolist() == [3.0, -1.0 + 2.3, 4.0 + 5.1]
        for k in range(30):
            p, q = states.p[k], states.q[k]
            u = np.array([sum(p[j] - p[i] - deltas[i, j] for j in nx.path_graph(3)[i]) - 3.0 * q[i] for i in range(3)])
            assert np.allclose(double_integrator(p, q, u, 0.5), (states.p[k + 1], states.q[k + 1]), atol=1e-12)

    def test_consistent_deltas_become_offsets(self) -> None:
        deltas = {(0, 1): 2.0, (1, 0): -2.0, (1, 2): 3.0, (2, 0): -5.0}
        assert offsets_from_deltas(self.GRAPH, deltas) == {0: 0.0, 1: 2.0, 2: 5.0}

    @pytest.mark.parametrize(
        "deltas",
        [{(0, 1): 1.0, (1, 0): 1.0}, {(0, 1): 1.0, (1, 2): 1.0, (0, 2): 1.0}, {(0, 1): float("nan"), (1, 0): 0.0}],
    )
    def test_inconsistent_deltas_are_refused(self, deltas: dict[tuple[int, int], float]) -> None:
        with pytest.raises(InvalidParameter, match="around every cycle"):
            offsets_from_deltas(self.GRAPH, deltas)

    def test_an_infinite_offset_is_refused(self) -> None:
        with pytest.raises(InvalidParameter, match="finite"):
            node_offsets(self.GRAPH, {0: float("inf")})

    def test_vehicles_take_their_places(self) -> None:
        """p_j - p_i -> delta_ij = d_j - d_i, for every pair of normal vehicles."""
        graph = as_digraph(nx.complete_graph(5))
        offsets = {0: 0.0, 1: 10.0, 2: -4.0, 3: 7.5, 4: 1.0}
        scenario = Scenario(Topology((graph,)), 1, offsets=offsets, steps=400)
        start = Start(frozenset({4}), (3.0, 1.0, 4.0, 1.0, 5.0), (1.0, -1.0, 0.5, 0.0, 0.0))
        (outcome,) = simulate(scenario, [start], record=True)
        assert outcome.verdict.value == "agreement"
        p = outcome.trajectory.p[-1]
        for i in range(4):
            for j in range(4):
                assert p[j] - p[i] == pytest.approx(offsets[j] - offsets[i], abs=1e-6)


class TestGains:
    def test_the_defaults_and_the_papers_example(self) -> None:
        graph = as_digraph(nx.complete_graph(5))
        everybody = range(5)
        assert fleet_of(graph, DP_MSR, 1, 1.0, None, "uniform").gap(everybody) is None
        for alpha, is_inside in ((2.0, False), (3.0, False), (10.0, True)):
            said = fleet_of(graph, DP_MSR, 1, 0.01, alpha, "unit").gap(everybody)
            assert (said is None) == is_inside
            assert is_inside or "nothing is promised" in str(said)
            assert fleet_of(graph, DP_MSR, 1, 0.01, alpha, "uniform").gap(everybody) is None
        assert fleet_of(graph, W_MSR, 1, 0.01, 2.0, "unit").gap(everybody) is None

    def test_only_normal_vehicles_count(self) -> None:
        graph = as_digraph(nx.complete_graph(5))
        fleet = fleet_of(graph, DP_MSR, 1, 0.01, {0: 2.0, 1: 2.0, 2: 2.0, 3: 2.0, 4: 1.0}, "uniform")
        assert fleet.gap([0, 1, 2, 3]) is None
        assert "node 4" in str(fleet.gap(range(5)))

    def test_with_the_defaults_nothing_is_promised_when_nothing_is_dropped(self) -> None:
        """T = 1 and kept weights that add up to 1: vehicles can swap for ever."""
        for n in (3, 7, 50):
            graph = as_digraph(nx.complete_graph(n))
            assert "not below 1" in str(fleet_of(graph, DP_MSR, 0, 1.0, None, "uniform").gap([0]))
            assert fleet_of(graph, DP_MSR, 1, 1.0, None, "uniform").gap([0]) is None

    def test_a_run_outside_warns_and_claims_no_safety(self) -> None:
        graph = as_digraph(nx.complete_graph(4))
        scenario = Scenario(Topology((graph,)), 0, alpha=0.1, steps=20)
        with pytest.warns(PromiseWarning, match="nothing is promised"):
            (outcome,) = simulate(scenario, [Start(frozenset(), (0.0, 1.0, 2.0, 3.0), (0.0,) * 4)])
        assert outcome.safe is None
        assert outcome.promise_gap is not None

    @pytest.mark.parametrize("alpha", [0.0, -1.0, float("nan"), {0: 1.0}])
    def test_bad_gains_are_refused(self, alpha: object) -> None:
        with pytest.raises(InvalidParameter, match="alpha_i > 0"):
            node_gains(Digraph([0, 1], []), alpha, 1.0)

    def test_the_bound_on_kept_weight_is_reached_by_no_run(self) -> None:
        graph = Digraph(range(4), [(1, 0), (2, 0), (3, 0)])
        weights = arc_weights(graph, {(1, 0): 0.5, (2, 0): 1.0, (3, 0): 2.0})
        assert kept_weight_bound(graph, weights, 1).tolist() == [3.0, 0.0, 0.0, 0.0]
        assert kept_weight_bound(graph, weights, 5).tolist() == [0.0] * 4


class TestWeights:
    GRAPH = Digraph("abc", [("a", "b"), ("c", "b"), ("b", "a")])

    def test_by_name(self) -> None:
        assert arc_weights(self.GRAPH, "unit").tolist() == [1.0, 1.0, 1.0]
        assert arc_weights(self.GRAPH, "uniform").tolist() == [1.0, 0.5, 0.5]

    def test_custom(self) -> None:
        table = {("a", "b"): 0.25, ("c", "b"): 0.5, ("b", "a"): 2.0}
        assert arc_weights(self.GRAPH, table).tolist() == [2.0, 0.25, 0.5]

    @pytest.mark.parametrize(
        "weights",
        [
            "equal",
            {},
            {("a", "b"): 1.0, ("c", "b"): 1.0, ("b", "a"): 0.0},
            {("a", "b"): 1.0, ("c", "b"): 1.0, ("b", "a"): 1.0, ("a", "c"): 1.0},
        ],
    )
    def test_refused(self, weights: object) -> None:
        with pytest.raises(InvalidParameter, match="weights"):
            arc_weights(self.GRAPH, weights)
