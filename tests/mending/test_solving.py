"""What a stopped solver says never ends a search; the clock is looked at while the master problem is written."""

from __future__ import annotations

import time
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.digraph import as_digraph
from robustness.errors import Undecided
from robustness.limits import Limits
from robustness.mending import MendVerdict, losses, master
from robustness.mending.actions import actions_for
from robustness.mending.covers import rigid_components
from robustness.mending.deepening import Deepening
from robustness.mending.goal import Part
from robustness.solver_calls import Outcome


@pytest.mark.parametrize("said", ["optimal", "infeasible", "abandoned"])
def test_mending_never_ends_by_what_a_stopped_call_said(monkeypatch: pytest.MonkeyPatch, said: str) -> None:
    """Every call is stopped, whatever it says: nothing is impossible, and nothing optimal."""
    monkeypatch.setattr(Deepening, "of", classmethod(lambda *_: None))
    monkeypatch.setattr(master, "solve_within", lambda *_, **__: Outcome(said))
    found = rb.mend(nx.path_graph(9), (2, 2), time_limit=1.0)
    assert found.verdict is MendVerdict.FEASIBLE
    assert found.lower_bound == 1  # by the two ends, which hear one node each
    assert rb.is_rs_robust(found.graph, 2, 2)


def test_a_margin_never_comes_from_a_stopped_call(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(losses, "solve_within", lambda *_: Outcome("infeasible"))
    found = rb.margin(nx.complete_graph(5), 3)
    assert (found.losses, found.lower_bound, found.is_exact) == (None, 0, False)


def test_the_master_problem_looks_at_the_clock_while_it_is_written() -> None:
    graph = as_digraph(nx.path_graph(6))
    actions = actions_for(graph, None, None, forbid=(), require=(), max_in_degree=None, one_way=False)
    written = master.Master(graph, actions, Limits(deadline=time.monotonic() - 1))
    with pytest.raises(Undecided):
        written.add_cover(Part(2, 2), rigid_components(graph.in_masks))


def test_a_call_for_any_choice_says_nothing_about_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    def said(*_: Any, **__: Any) -> Outcome:
        return Outcome("optimal", bound=7.0, is_optimal=True)

    monkeypatch.setattr(master, "solve_within", said)
    graph = as_digraph(nx.path_graph(4))
    actions = actions_for(graph, None, None, forbid=(), require=(), max_in_degree=None, one_way=False)
    written = master.Master(graph, actions)
    assert written.solve(Limits(), None).bound == 7
    assert written.solve(Limits(), None, any_choice=True).bound == 0


def test_what_holds_already_needs_nothing_and_the_whole_network_is_a_choice_at_once() -> None:
    """Before any demand is written: nothing to add where the goal is reached, and of thinning the network itself."""
    dense = nx.gnp_random_graph(60, 0.5, seed=1)
    found = rb.mend(dense, 4)
    assert (found.verdict.value, found.links, found.lower_bound) == ("optimal", (), 0)
    assert found.summary() == "optimal: the network reaches the goal, 4-robust, as it is; no link is needed"
    seen = []
    rb.thin(nx.complete_graph(7), 2, on_improvement=seen.append)
    assert seen[0].cost == 21
    assert seen[0].dropped == ()
    capped = rb.mend(nx.cycle_graph(6), 2, max_in_degree=3)
    assert all(degree <= 3 for _, degree in capped.graph.to_networkx().degree)
