"""Finding r*: the bounds on the way only improve, and the climb from below stops where it must."""

from __future__ import annotations

from itertools import pairwise

import networkx as nx
import pytest

import robustness as rb
from robustness.decision import determination
from robustness.decision.determination import _climb, _Work
from robustness.definitions import is_violation
from robustness.limits import Limits
from robustness.results import Bound, Bounds


def test_bounds_only_improve(monkeypatch: pytest.MonkeyPatch) -> None:
    """With hardly any steps for the first search, every phase has its turn; none starts again from nothing."""
    monkeypatch.setattr(determination, "_SHORT_STEPS", 1)
    graph = rb.Digraph.from_networkx(nx.random_regular_graph(8, 40, seed=1))
    seen: list[Bounds] = []
    result = rb.determine_robustness(graph, on_bounds=seen.append)
    assert len(seen) > 3
    for before, after in pairwise(seen):
        assert before.lower.value <= after.lower.value <= after.upper.value <= before.upper.value
    assert seen[-1].lower.value == seen[-1].upper.value == result.r


@pytest.mark.parametrize("directed", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_the_climb_ends_below_the_upper_bound_or_at_a_pair(directed: bool, seed: int) -> None:
    graph = rb.Digraph.from_networkx(nx.gnp_random_graph(23, 0.5, seed=seed, directed=directed))
    exact = rb.determine_robustness(graph).r
    for upper in (exact, exact + 1, exact + 3):
        start = Bounds(Bound(0, "every graph is 0-robust"), Bound(upper, "assumed here"))
        found = _climb(_Work(graph, "subset-search", Limits()), start, Limits(), lambda _: None)
        if upper > exact + 1:
            assert found.lower.value == found.upper.value == exact
            assert found.upper.witness is not None
            first, second = (graph.ids(side) for side in (found.upper.witness.S1, found.upper.witness.S2))
            assert is_violation(graph, first, second, exact + 1, 1)
        else:
            assert (found.lower.value, found.upper.value) == (max(upper - 1, 0), upper)


def test_a_graph_too_large_for_the_search_is_left_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a time limit, too, the work ends, and the bounds hold."""
    monkeypatch.setattr("robustness.decision.algorithms.subset_search.MOST_NODES", 30)
    result = rb.determine_robustness(nx.random_regular_graph(10, 60, seed=1))
    assert result.verdict is rb.Verdict.UNDECIDED
    assert result.bounds is not None
    assert result.bounds.lower.value < result.bounds.upper.value
    assert "at most 30 nodes" in result.stats["reason"]


@pytest.mark.parametrize("steps", [1, 10**6, 10**8])
@pytest.mark.parametrize("n", [18, 23, 26])
def test_a_budget_of_steps_leaves_bounds_that_hold_and_are_the_same_again(n: int, steps: int) -> None:
    graph = rb.Digraph.from_networkx(nx.gnp_random_graph(n, 0.5, seed=n))
    whole = rb.determine_robustness(graph)
    found = determination.determine(graph, "auto", Limits(steps=steps), None, None)
    assert found.bounds is not None
    assert found.bounds.lower.value <= whole.r <= found.bounds.upper.value
    if found.verdict is rb.Verdict.DETERMINED and found.s_bounds is not None:
        assert found.s_bounds.lower.value <= whole.s <= found.s_bounds.upper.value
    again = determination.determine(graph, "auto", Limits(steps=steps), None, None)
    assert (found.verdict, found.bounds, found.s_bounds) == (again.verdict, again.bounds, again.s_bounds)
