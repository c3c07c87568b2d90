"""A bound that was proven up to swapping nodes is certified for whoever does not swap."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner

import robustness as rb
from cli.main import robustness
from robustness.digraph import as_digraph
from robustness.errors import InternalError
from robustness.files import write_topology
from robustness.limits import Limits
from robustness.mending import LeastVerdict, certify_mending, completing, confirm_least
from robustness.mending.certification import least_claimed
from robustness.mending.completing import completed

#: Found against brute force: the violations met by the search were fewer than the bound needs.
SYMMETRIC = [
    (nx.empty_graph(4), rb.Goal(survive=1, model="delayed-local"), {"mandatory": [(0, 3), (1, 3)]}),
    (nx.empty_graph(4), rb.Goal(survive=1, model="delayed-local"), {}),
    (nx.empty_graph(6), rb.Goal(survive=1, model="delayed"), {"mandatory": [(0, 1), (2, 3)]}),
    (nx.star_graph(5), rb.Goal(3), {"mandatory": [(1, 2)]}),
    (nx.empty_graph(5), rb.Goal(2, 2), {"mandatory": [(0, 1), (2, 3)]}),
]


@pytest.mark.parametrize(("network", "goal", "constraints"), SYMMETRIC)
@pytest.mark.parametrize("choices", [0, 100_000], ids=["highs", "kernel"])
def test_the_certificate_is_enough_without_swapping(
    network: nx.Graph, goal: rb.Goal, constraints: dict[str, Any], choices: int
) -> None:
    data = certify_mending(rb.mend(network, goal, **constraints))
    assert data is not None
    found = confirm_least(as_digraph(network).canonical_bytes(), data, choices=choices)
    assert found.verdict is LeastVerdict.CONFIRMED, str(found)


def test_what_is_added_is_bounded_and_what_needs_nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    network, goal, constraints = SYMMETRIC[0]
    problem = rb.mend(network, goal, **constraints).problem
    assert problem is not None
    assert problem.is_up_to_swapping
    assert len(completed(problem, Limits.of(None)).pairs) > len(problem.pairs)
    assert completed(problem, Limits.of(1e-9)).pairs == problem.pairs
    monkeypatch.setattr(completing, "_MOST_ADDED", 0)
    less = completed(problem, Limits.of(None))
    assert less.pairs == problem.pairs
    assert less.least == 5  # what these give: the goal takes 6
    monkeypatch.setattr(completing, "_STEP", 0)
    assert completed(problem, Limits.of(None)).least == 0
    costs = {link: 1 + k for k, link in enumerate(combinations(range(4), 2))}
    told_apart = rb.mend(network, goal, cost=costs).problem
    assert told_apart is not None
    assert completed(told_apart, Limits.of(None)) is told_apart


@pytest.mark.parametrize("cut_off", [False, True])
@pytest.mark.parametrize(("network", "goal"), [(nx.empty_graph(9), (1, 1)), (nx.empty_graph(4), (2, 1))])
def test_no_certificate_claims_more_than_its_violations_give(
    network: nx.Graph, goal: tuple[int, int], cut_off: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of nine nodes that nothing tells apart, that eight links are needed to reach all takes very many violations."""
    found = rb.mend(network, goal)
    if cut_off:
        monkeypatch.setattr(completing, "_MOST_ADDED", 0)
    data = certify_mending(found)
    assert data is not None
    least = least_claimed(data)
    assert found.problem is not None
    assert found.problem.least is not None
    assert least is not None
    assert least <= found.problem.least
    for choices in (0, 10_000):
        confirmed = confirm_least(found.before.canonical_bytes(), data, choices=choices, time_limit=10)
        assert confirmed.verdict is not LeastVerdict.REFUTED


def test_a_cheaper_choice_that_reaches_the_goal_is_no_certificate() -> None:
    """The oracle is asked about every choice that evades the demands: a wrong bound does not pass."""
    from dataclasses import replace

    problem = rb.mend(nx.empty_graph(4), 2).problem
    assert problem is not None
    assert problem.least is not None
    wrong = replace(problem, least=problem.least + 1, is_up_to_swapping=True)
    with pytest.raises(InternalError, match="reaches the goal: please report"):
        completed(wrong, Limits.of(None))


def test_the_command_says_what_its_certificate_proves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    network, goal, constraints = SYMMETRIC[0]
    write_topology(network, tmp_path / "four.json")
    (tmp_path / "links.csv").write_text("".join(f"{u},{v}\n" for u, v in constraints["mandatory"]))
    asked = ["mend", "four.json", "--survive", "1", "--model", goal.model, "--mandatory", "links.csv"]
    monkeypatch.chdir(tmp_path)
    whole = CliRunner().invoke(robustness, [*asked, "--certificate", "a.cert"])
    assert "give a bound" not in whole.stderr
    monkeypatch.setattr(completing, "_MOST_ADDED", 0)
    cut_off = CliRunner().invoke(robustness, [*asked, "--certificate", "b.cert"])
    assert "its violations give a bound of 5 only, not 6" in cut_off.stderr
    assert whole.stdout == cut_off.stdout
    for name in ("a.cert", "b.cert"):
        assert CliRunner().invoke(robustness, ["verify", "four.json", name]).exit_code == 0
