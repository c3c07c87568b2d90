"""A value equal to one's own: nothing at the update, but not nothing between updates."""

from __future__ import annotations

import networkx as nx
import pytest

from robustness.simulation import Scenario, Start, simulate
from robustness.simulation.reference import simulate_plainly
from robustness.simulation.schedules import PeriodicUpdates, Schedule

PAIR = nx.complete_graph(2)


@pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")
@pytest.mark.parametrize(("f", "place"), [(1, 1.25), (0, 0.625)])
def test_whether_a_tie_is_dropped_shows_one_step_after_the_update(f: int, place: float) -> None:
    """T = alpha = a = 1, q = 5/2: with f = 1 the one value heard, equal to the own one, is dropped; with f = 0 kept."""
    scenario = Scenario(
        PAIR, f, "adp-msr", adversary="constant", schedule=Schedule(PeriodicUpdates(3, {0: 0, 1: 0})), steps=2, T=1.0,
        alpha=1.0, weights="unit",
    )  # fmt: skip
    start = Start([1] if f else [], [0.0, 0.0], [2.5, 0.0])
    for run in (simulate, simulate_plainly):
        (outcome,) = run(scenario, [start], record=True)
        # In both cases nothing is added at the update itself.
        assert outcome.trajectory.p[:, 0].tolist() == [0.0, 1.25, place]
