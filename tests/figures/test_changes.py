"""Pictures of links that are added, that stay, can go or are lost, and of answers without any."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from matplotlib.patches import FancyArrowPatch

import robustness as rb
from robustness.digraph import as_digraph
from robustness.figures.joint import draw_joint
from robustness.figures.marking import marks_of
from robustness.figures.saving import new_figure
from robustness.mending.budget import best_within

COMPLETE, PATH = nx.complete_graph(5), nx.path_graph(4)

THINNED, COSTLY = rb.thin(COMPLETE, 2), rb.mend(PATH, 2, budget=0)
WITHIN_REACH = rb.mend(PATH, 2, candidates=[(0, 2)])


@pytest.mark.parametrize(
    ("graph", "answer", "told"),
    [
        (COMPLETE, THINNED, ["link that stays", "link that can go"]),
        (COMPLETE, rb.margin(COMPLETE, 2), ["link lost"]),
        (COMPLETE, rb.margin(COMPLETE, 3, of="nodes"), ["lost: 1 node", "other: 4 nodes", "link lost"]),
        (COMPLETE, rb.mend(COMPLETE, 2), None),
        (PATH, rb.mend(PATH, 2), ["link added"]),
        (PATH, best_within(PATH, 9), ["link added"]),
        (PATH, best_within(PATH, 0), None),
        (PATH, rb.margin(PATH, 2), None),
    ],
)
def test_the_legend_says_what_becomes_of_links(graph: nx.Graph, answer: Any, told: list[str] | None) -> None:
    legend = rb.draw(graph, answer, ax=new_figure(6, 4).subplots()).get_legend()
    assert (legend and [text.get_text() for text in legend.get_texts()]) == told


def test_what_no_candidate_breaks_is_drawn() -> None:
    assert WITHIN_REACH.verdict.value == "impossible"
    assert WITHIN_REACH.witness is not None
    marks = marks_of(as_digraph(PATH), WITHIN_REACH)
    assert (marks.S1, marks.S2) == (WITHIN_REACH.witness.S1, WITHIN_REACH.witness.S2)
    assert marks.counted


def test_a_single_arc_stays_one_in_a_network_without_directions() -> None:
    found = rb.mend(PATH, 2, one_way=True)
    marks = marks_of(as_digraph(PATH), found)
    assert found.links
    assert marks.added == frozenset(found.links)


def test_what_goes_both_ways_has_no_head_and_single_arcs_have_one() -> None:
    found = rb.mend(PATH, 2, one_way=True)
    both = {link for link in found.links if link[::-1] in found.links}
    assert 0 < len(both) < len(found.links)
    ax = rb.draw(found.graph, found, ax=new_figure(6, 4).subplots())
    thick = [patch for patch in ax.patches if isinstance(patch, FancyArrowPatch) and patch.get_linewidth() > 3]
    kinds = sorted(type(patch.get_arrowstyle()).__name__ for patch in thick)
    assert kinds == ["Curve"] * (len(both) // 2) + ["CurveFilledB"] * (len(found.links) - len(both))


@pytest.mark.parametrize(
    ("r", "told", "untold"), [(9, "not robust: 2 windows", "of 2 steps"), (2, "not robust: 1 window of 1 step", "9")]
)
def test_where_no_window_will_do_the_longest_ones_are_the_answer(
    tmp_path: Path, r: int, told: str, untold: str
) -> None:
    sequence = rb.TimeVaryingGraph([nx.path_graph(4), nx.complete_graph(4)], period=2)
    result = rb.check_joint_robustness(sequence, r)
    failing = result.violation or result.shorter_fails
    assert failing is not None
    shown = rb.check_joint_robustness(sequence, r, window=failing.length, all_windows=True)
    draw_joint(sequence, result, None, tmp_path / "joint.svg", shown=shown)
    drawn = (tmp_path / "joint.svg").read_text()
    assert f"<!-- {told} -->" in drawn
    assert f"{untold}" not in " ".join(line for line in drawn.splitlines() if "<!-- not robust" in line)
