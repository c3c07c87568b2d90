"""Where the nodes of a picture stand."""

from __future__ import annotations

import json
import re
from itertools import combinations
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

import robustness as rb
from robustness.errors import InvalidParameter
from robustness.figures.network import draw_to_file
from robustness.figures.placement import moved_apart, positions_in
from robustness.figures.saving import new_figure
from tests.figures.instances import PETERSEN, WHEEL, axes


class TestPlaces:
    @pytest.mark.parametrize(
        "attributes",
        [
            {"pos": (1, 2)}, {"x": "1", "y": 2.0}, {"lon": 1, "lat": 2}, {"Longitude": 1.0, "Latitude": 2.0},
            {"viz": {"position": {"x": 1, "y": 2, "z": 0}}}, {"graphics": {"x": 1, "y": 2, "w": 30}},
        ],
    )  # fmt: skip
    def test_attributes_of_every_kind(self, attributes: dict[str, Any]) -> None:
        graph = nx.path_graph(2)
        graph.nodes[0].update(attributes)
        assert positions_in(graph) is None
        graph.nodes[1].update({"x": 5, "y": 5})
        assert positions_in(graph) == {0: (1.0, 2.0), 1: (5.0, 5.0)}

    @pytest.mark.parametrize(
        "attributes", [{"x": "left", "y": 1}, {"pos": "ab"}, {"x": float("nan"), "y": 0}, {"x": 1}]
    )
    def test_what_is_no_place(self, attributes: dict[str, Any]) -> None:
        graph = nx.path_graph(2)
        for node in graph:
            graph.nodes[node].update(attributes)
        assert positions_in(graph) is None

    def test_given_places_win_and_are_checked(self) -> None:
        ax = rb.draw(WHEEL, pos={i: (i, i * i) for i in range(5)}, ax=axes())
        groups = [np.asarray(group.get_offsets()) for group in ax.collections]
        offsets = np.concatenate([group for group in groups if len(group)])
        assert {tuple(row) for row in offsets.tolist()} >= {(2.0, 4.0), (4.0, 16.0)}
        for wrong in ({0: (0, 0)}, dict.fromkeys(range(5), (0, 0, 0)), dict.fromkeys(range(5), (0, float("inf")))):
            with pytest.raises(InvalidParameter, match="position"):
                rb.draw(WHEEL, pos=wrong, ax=axes())

    def test_sides_stand_apart(self) -> None:
        result = rb.check_rs_robustness(PETERSEN, 2)
        figure = Figure()
        ax = rb.draw(PETERSEN, result, ax=figure.subplots())
        sides = [np.asarray(group.get_offsets()) for group in ax.collections if group.get_label().startswith("S")]
        assert len(sides) == 2
        assert sides[0][:, 0].max() < sides[1][:, 0].min()

    @pytest.mark.filterwarnings("ignore::robustness.GraphWarning")
    @pytest.mark.parametrize("suffix", ["json", "graphml", "gexf", "gml"])
    def test_of_files(self, suffix: str, tmp_path: Path) -> None:
        graph, path = nx.path_graph(3), tmp_path / f"g.{suffix}"
        for node in graph:
            graph.nodes[node].update(x=float(node), y=1.0 + node)
        if suffix == "json":
            path.write_text(json.dumps(nx.node_link_data(graph, edges="edges")), encoding="utf-8")
        else:
            getattr(nx, f"write_{suffix}")(graph, path)
        read = rb.read_topology(path)
        places = positions_in(read)
        assert places is not None
        assert [places[label] for label in read.labels] == [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]

    def test_of_a_collection(self) -> None:
        places = positions_in(rb.read_topology("topohub:sndlib/abilene"))
        assert places is not None
        assert len(set(places.values())) == 12


class TestRoom:
    @pytest.mark.parametrize("name", ["sndlib/germany50", "topozoo/Geant2012", "one place", "in a row"])
    def test_nodes_hide_no_node(self, name: str) -> None:
        if name == "one place":
            graph: Any = nx.relabel_nodes(nx.path_graph(9), str)
            nx.set_node_attributes(graph, {str(k): (0, 0) if k < 5 else (k, 1) for k in range(9)}, "pos")
        elif name == "in a row":
            graph = nx.path_graph(12)
            nx.set_node_attributes(graph, {k: (k**3, 0) for k in range(12)}, "pos")
        else:
            graph = rb.read_topology(f"topohub:{name}")
        figure = new_figure(10, 8)
        ax = rb.draw(graph, ax=figure.subplots())
        figure.draw_without_rendering()
        (nodes,) = [each for each in ax.collections if isinstance(each, PathCollection)]
        centres = ax.transData.transform(nodes.get_offsets())
        wide = nodes.get_sizes()[0] ** 0.5 * figure.dpi / 72
        apart = min(float(np.hypot(*(one - two))) for one, two in combinations(centres, 2))
        assert apart > 0.9 * wide

    def test_nodes_that_have_room_keep_their_place(self) -> None:
        places = {0: (0.0, 0.0), 1: (1.0, 0.0), 2: (1.0, 0.001), 3: (0.5, 1.0)}
        moved = moved_apart(places, np.array([300.0, 300.0]), 20.0)
        assert (moved[0], moved[3]) == (places[0], places[3])
        assert 20 <= 300 * float(np.hypot(*(np.array(moved[1]) - moved[2]))) < 25

    def test_nobody_stands_between_the_sides(self) -> None:
        graph = nx.DiGraph([(1, 3), (3, 1), (2, 5), (5, 2), (1, 5), (2, 3), (4, 1), (4, 3)])
        ax = rb.draw(graph, ({1, 2}, {3, 5}), ax=axes())
        groups = {each.get_label(): each.get_offsets() for each in ax.collections if isinstance(each, PathCollection)}
        lowest = min(offsets[:, 1].min() for name, offsets in groups.items() if name.startswith("S"))
        assert groups["other: 1 node"][:, 1].max() < lowest

    @pytest.mark.parametrize(
        "graph",
        [nx.disjoint_union(nx.path_graph(2), nx.empty_graph(1)), nx.disjoint_union(nx.cycle_graph(5), nx.path_graph(4)),
         nx.empty_graph(7), nx.disjoint_union_all([nx.cycle_graph(4)] * 3)],
    )  # fmt: skip
    def test_what_no_link_joins_stands_side_by_side(self, graph: nx.Graph) -> None:
        ax = rb.draw(graph, ax=axes())
        (nodes,) = [each for each in ax.collections if isinstance(each, PathCollection)]
        near = [sorted(float(np.hypot(*(one - two))) for two in nodes.get_offsets())[1] for one in nodes.get_offsets()]
        assert max(near) < 4 * min(near)

    def test_no_node_is_cut_off(self) -> None:
        ax = new_figure(8, 3).subplots()
        rb.draw(nx.empty_graph(7), ax=ax)
        assert [each.get_clip_on() for each in ax.collections if isinstance(each, PathCollection)] == [False]

    def test_a_network_without_nodes_says_so(self) -> None:
        assert [text.get_text() for text in rb.draw(nx.empty_graph(0), ax=axes()).texts] == ["a network without nodes"]


class TestShape:
    @pytest.mark.parametrize(("wide", "tall"), [(1800, 30), (700, 100), (300, 100), (100, 100), (100, 400), (5, 0)])
    def test_a_map_has_the_shape_of_the_map_within_reason(self, wide: float, tall: float, tmp_path: Path) -> None:
        corners = {0: (0, 0), 1: (wide, 0), 2: (wide, tall), 3: (0, tall)}
        path = tmp_path / "map.svg"
        draw_to_file(nx.cycle_graph(4), None, path, pos=corners)
        sides = [re.findall(rf'<svg [^>]*?{side}="([\d.]+)pt"', path.read_text()) for side in ("width", "height")]
        width, height = (float(found[0]) for found in sides)
        asked = min(max(wide / tall if tall else 99, 0.6), 3.0)
        assert 0.4 < width / height / asked < 2.5
        assert width / height > 0.9

    def test_nobody_is_told_apart_where_no_set_is_marked(self) -> None:
        assert rb.draw(PETERSEN, ax=axes()).get_legend() is None
        mended = rb.mend(nx.cycle_graph(5), 2)
        told = [text.get_text() for text in rb.draw(mended.graph, mended, ax=axes()).get_legend().get_texts()]
        assert told == ["link added"]
