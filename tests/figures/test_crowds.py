"""Pictures of more than 300 nodes: nothing hides what the picture is about, and it says what it leaves out."""

from __future__ import annotations

import sys
from typing import Any

import networkx as nx
import numpy as np
import pytest
from matplotlib.collections import PathCollection

import robustness as rb
from robustness.figures.marking import Marks
from robustness.figures.placement import positions_for
from robustness.figures.saving import new_figure


def drawn(graph: nx.Graph, answer: Any = None) -> tuple[Any, Any]:
    figure = new_figure(12, 9)
    ax = rb.draw(graph, answer, ax=figure.subplots())
    figure.draw_without_rendering()
    return figure, ax


@pytest.mark.parametrize(
    ("graph", "few"),
    [
        (nx.random_labeled_tree(500, seed=1), None),
        (nx.grid_2d_graph(20, 30), None),
        (nx.barbell_graph(200, 0), 200),
        (nx.barabasi_albert_graph(600, 2, seed=1), 1),
        (nx.star_graph(700), None),
    ],
)
def test_nodes_hide_no_node(graph: nx.Graph, few: int | None) -> None:
    nodes = list(graph)
    figure, ax = drawn(graph, None if few is None else (nodes[:few], nodes[few:]))
    groups = [each for each in ax.collections if isinstance(each, PathCollection)]
    centres = np.vstack([ax.transData.transform(each.get_offsets()) for each in groups])
    assert len(centres) == len(graph)
    wide = min(each.get_sizes()[0] for each in groups) ** 0.5 * figure.dpi / 72
    distances = np.hypot(*(centres[:, None] - centres[None]).T)
    assert distances[~np.eye(len(centres), dtype=bool)].min() > 0.9 * wide


def test_names_that_are_left_out_are_counted() -> None:
    graph = nx.relabel_nodes(nx.barabasi_albert_graph(600, 2, seed=1), lambda k: f"bus {k}")
    _, ax = drawn(graph, ({"bus 599"}, set(graph) - {"bus 599"}))
    names = {text.get_text() for text in ax.texts}
    assert names == {"bus 599", *graph["bus 599"]}
    told = [text.get_text() for text in ax.get_legend().get_texts()]
    assert f"{600 - len(names)} names left out" in told


def test_many_arcs_have_no_heads_and_the_legend_says_so() -> None:
    sparse, dense = (nx.gnp_random_graph(n, p, seed=1, directed=True) for n, p in ((40, 0.3), (400, 0.02)))
    for graph, has_heads in ((sparse, True), (dense, False)):
        _, ax = drawn(graph)
        legend = ax.get_legend()
        told = [text.get_text() for text in legend.get_texts()] if legend else []
        assert bool(ax.patches) is has_heads
        assert ("grey arcs drawn without heads" in told) is not has_heads


def test_no_other_library_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    drawn(nx.cycle_graph(520))


def test_the_same_network_has_the_same_places() -> None:
    graph = rb.Digraph.from_networkx(nx.random_labeled_tree(900, seed=4))
    assert positions_for(graph, Marks(), None, None) == positions_for(graph, Marks(), None, None)
