"""A budget buys what brute force says it buys, and no more."""

from __future__ import annotations

import random

import networkx as nx
import pytest

import robustness as rb
from certificates import verify_mending
from robustness.errors import InvalidParameter
from robustness.mending import BudgetResult, LeastVerdict, MendVerdict, best_within, certify_mending, confirm_least
from tests.mending.brute_force import candidates, is_robust, least_cost


def test_a_goal_is_reached_within_a_budget_exactly_when_its_least_cost_is() -> None:
    rng = random.Random(2)
    for _ in range(4):
        network = nx.gnp_random_graph(5, 0.4, seed=rng.randrange(1000))
        for goal in ((2, 1), (2, 2)):
            least = least_cost(network, is_robust(*goal), candidates(network))
            assert least is not None
            for budget in range(max(0, least - 1), least + 2):
                found = rb.mend(network, goal, budget=budget)
                assert (found.cost == least) is (budget >= least)
                assert found.verdict is (MendVerdict.OPTIMAL if budget >= least else MendVerdict.IMPOSSIBLE)


def test_required_links_that_cost_more_than_the_budget() -> None:
    """Whether they reach the goal alone, with others, or not at all, and for every way to ask."""
    for network, mandatory in ((nx.complete_graph(5), [(0, 2)]), (nx.path_graph(5), [(0, 2), (1, 3)])):
        base = nx.Graph(network)
        base.remove_edges_from(mandatory)
        for one_way, goal in ((False, (2, 1)), (True, (2, 1)), (False, (2, 2)), (False, rb.Goal(survive=1))):
            for any_choice in (False, True):
                found = rb.mend(base, goal, mandatory=mandatory, one_way=one_way, budget=0.5, any_choice=any_choice)
                assert found.verdict is MendVerdict.IMPOSSIBLE
                assert "within the budget" in found.summary()
                data = certify_mending(found)
                assert data is not None
                confirmed = confirm_least(found.before.canonical_bytes(), data)
                assert confirmed.verdict is LeastVerdict.CONFIRMED
                assert confirmed.claim.cost is None
        assert best_within(base, 0.5, mandatory=mandatory).is_exact
        assert best_within(base, 0.5, mandatory=mandatory).best is None


def test_the_most_a_budget_buys() -> None:
    rng = random.Random(3)
    for _ in range(3):
        network = nx.gnp_random_graph(5, 0.4, seed=rng.randrange(1000))
        for budget in (0, 2, 4):
            affordable = [
                (r, s)
                for r in (1, 2, 3)
                for s in range(1, 6)
                if (least := least_cost(network, is_robust(r, s), candidates(network))) is not None and least <= budget
            ]
            found = best_within(network, budget)
            assert found.is_exact
            goal = None if found.best is None else found.best.goals[0]
            assert (None if goal is None else (goal.r, goal.s)) == max(affordable, default=None)
            assert goal is None or rb.is_rs_robust(found.best.graph, goal.r, goal.s)  # type: ignore[union-attr]
            assert "the budget buys" in found.summary()


def test_models_and_costs() -> None:
    found = best_within(nx.path_graph(5), 100, model="delayed")
    assert found.best is not None
    assert found.best.goals[0].survive == 1
    assert found.is_exact
    priced = rb.mend(nx.path_graph(4), 2, cost=lambda u, v: 0.5 * abs(u - v), budget=2.25)
    assert priced.cost is not None
    assert priced.cost <= 2.25


def test_a_bound_beyond_a_budget_is_certified() -> None:
    path = rb.Digraph.from_networkx(nx.path_graph(6))
    data = certify_mending(rb.mend(path, (2, 2), budget=3))
    assert data is not None
    assert (
        verify_mending(path.canonical_bytes(), data).cost,
        confirm_least(path.canonical_bytes(), data).claim.least,
    ) == (
        None,
        4,
    )
    assert confirm_least(path.canonical_bytes(), data).verdict is LeastVerdict.CONFIRMED


def test_misuse() -> None:
    for wrong in (-1, "much", float("nan"), True):
        with pytest.raises(InvalidParameter, match="a budget is"):
            rb.mend(nx.path_graph(4), 2, budget=wrong)  # type: ignore[arg-type]
    with pytest.raises(InvalidParameter, match="a budget is"):
        best_within(nx.path_graph(4), None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="no truth value"):
        bool(best_within(nx.path_graph(4), 1))


def test_what_is_bought_is_told_as_it_grows() -> None:
    told: list[BudgetResult] = []
    bought = best_within(nx.path_graph(5), 3, on_improvement=told.append)
    assert [getattr(each.best, "goal", None) for each in told] == ["1-robust", "2-robust", "(2,2)-robust"]
    assert all(not each.is_exact and each.missed is None for each in told)
    assert told[-1].best == bought.best
    assert told[-1].summary() == "the budget buys (2,2)-robust, for 3; whether it buys more was not decided"
