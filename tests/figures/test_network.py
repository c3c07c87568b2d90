"""Pictures of networks: what is marked, where nodes stand, and that no answer and no label breaks them."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

import robustness as rb
from cli.main import robustness
from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter
from robustness.figures.marking import marks_of
from robustness.figures.network import draw_to_file
from robustness.figures.saving import new_figure
from robustness.simulation import find_attack
from robustness.traps import find_trap
from tests.figures.instances import PETERSEN, WHEEL, axes


class TestMarks:
    def test_a_violating_pair(self) -> None:
        graph = as_digraph(PETERSEN)
        result = rb.check_rs_robustness(PETERSEN, 2)
        marks = marks_of(graph, result)
        assert result.witness is not None
        assert (graph.labels_of(marks.S1), graph.labels_of(marks.S2)) == tuple(result.witness)
        for i in range(10):
            side = next(group for group in (marks.S1, marks.S2) if i in group)
            assert sum(arc[1] == i for arc in marks.counted) == len(set(PETERSEN[i]) - side) < 2
        assert marks.title == "not 2-robust"
        assert marks_of(graph, tuple(result.witness)).counted == marks.counted

    def test_a_trap_and_its_attack(self) -> None:
        graph = as_digraph(WHEEL)
        attack = find_attack(WHEEL, 1, "delayed").attack
        found = find_trap(WHEEL, 1)
        for answer in (attack, found, (found.M, found.S1, found.S2), {"M": [0], "S1": found.S1, "S2": found.S2}):
            marks = marks_of(graph, answer)
            assert marks.M == {0}
            assert {u for u, _ in marks.silenced} == {0}
            assert len(marks.silenced) == 4
            for i in marks.S1 | marks.S2:
                assert sum(arc[1] == i for arc in marks.counted) <= 1

    def test_liars_of_a_violation_are_members_of_the_sides(self) -> None:
        ring = nx.cycle_graph(6)
        attack = find_attack(ring, 1, "malicious").attack
        assert attack is not None
        marks = marks_of(as_digraph(ring), attack)
        assert marks.M <= marks.S1 | marks.S2
        assert not marks.silenced

    def test_what_marks_nothing_and_what_is_no_answer(self) -> None:
        graph = as_digraph(nx.complete_graph(5))
        assert not marks_of(graph, rb.check_rs_robustness(nx.complete_graph(5), 2)).S1
        assert marks_of(graph, None).title == ""
        for wrong in ("S1", 3, ({0}, {1}, {2}, {3}), ({0}, "x")):
            with pytest.raises(InvalidParameter, match="a picture marks"):
                marks_of(graph, wrong)
        with pytest.raises(rb.RobustnessError):
            marks_of(graph, ({0}, {17}))

    def test_links_added_and_dropped(self) -> None:
        class Mended:
            links = ((0, 2),)
            dropped = ((0, 1),)

        marks = marks_of(as_digraph(nx.cycle_graph(4)), Mended())
        assert marks.added == {(0, 2), (2, 0)}
        assert marks.dropped == {(0, 1), (1, 0)}

    def test_one_way_links_of_an_undirected_network_go_one_way(self) -> None:
        path = nx.path_graph(4)
        mended = rb.mend(path, 2, one_way=True)
        for graph in (path, mended.graph):
            assert marks_of(as_digraph(graph), mended).added == set(mended.links)


class TestDraw:
    def test_every_answer_is_drawn_and_returns_its_axes(self) -> None:
        sequence = rb.TimeVaryingGraph([nx.path_graph(4), nx.cycle_graph(4)], period=2)
        answers = [
            (PETERSEN, rb.check_rs_robustness(PETERSEN, 2)), (PETERSEN, rb.determine_robustness(PETERSEN)),
            (WHEEL, rb.tolerance(WHEEL, model="delayed")), (WHEEL, find_attack(WHEEL, 1, "byzantine").attack),
            (WHEEL, find_trap(WHEEL, 1)), (WHEEL, None), (nx.empty_graph(1), None), (nx.empty_graph(0), None),
            (nx.empty_graph(2), None), (sequence.union(0, 2), rb.check_joint_robustness(sequence, 3)),
        ]  # fmt: skip
        for graph, answer in answers:
            ax = axes()
            assert rb.draw(graph, answer, ax=ax) is ax

    def test_a_link_both_ways_has_no_head_beside_arcs_that_have_one(self) -> None:
        class Mended:
            links = ((0, 2), (2, 0), (1, 3), (1, 0))

        arcs: list[tuple[tuple[int, int], ...]] = []
        heads: list[str] = []
        with pytest.MonkeyPatch.context() as patched:

            def note(graph: object, pos: object, edgelist: Any, **options: Any) -> list[object]:
                arcs.append(tuple(edgelist))
                heads.append(str(options.get("arrowstyle")))
                return []

            patched.setattr(nx, "draw_networkx_edges", note)
            rb.draw(nx.DiGraph([(0, 1), (1, 2), (0, 2), (2, 0), (1, 3), (1, 0)]), Mended(), ax=axes())
        drawn = dict(zip(arcs, heads, strict=True))
        assert drawn[(0, 2),] == "-"
        assert drawn[(1, 0), (1, 3)] == "-|>"
        assert drawn[(0, 1), (1, 2)] == "-|>"  # what was there stays to be seen

    def test_answers_draw_themselves(self) -> None:
        for answer in (
            rb.check_rs_robustness(PETERSEN, 2), rb.determine_robustness(PETERSEN), rb.tolerance(WHEEL),
            rb.tolerance(WHEEL, model="delayed"), find_attack(WHEEL, 1, "delayed").attack,
            rb.check_joint_robustness(rb.TimeVaryingGraph([nx.path_graph(4)], period=1), 2),
            rb.check_rs_robustness(nx.complete_graph(3), 2),
        ):  # fmt: skip
            ax = axes()
            assert answer.plot(ax=ax) is ax
        with pytest.raises(InvalidParameter, match="carries no graph"):
            rb.Witness(frozenset({0}), frozenset({1})).plot()
        assert find_trap(WHEEL, 1).plot(WHEEL, ax=axes()) is not None
        assert rb.check_rs_robustness(PETERSEN, 4).witness.plot(PETERSEN, ax=axes()) is not None

    def test_the_legend_names_what_is_there_and_covers_no_node(self, tmp_path: Path) -> None:
        figure = Figure(figsize=(8, 6), layout="constrained")
        ax = rb.draw(WHEEL, find_attack(WHEEL, 1, "delayed").attack, ax=figure.subplots())
        legend = ax.get_legend()
        told = [text.get_text() for text in legend.get_texts()]
        assert told[:3] == ["S1: 2 nodes", "S2: 2 nodes", "M, malicious: 1 node"]
        figure.savefig(tmp_path / "x.png")
        box, plot = legend.get_window_extent(), ax.get_window_extent()
        assert box.x0 >= plot.x1 - 1
        assert box.x1 <= figure.bbox.x1 + 1

    @pytest.mark.parametrize("label", ["$x_1$", "$", r"\frac", "a\nb", "<b>&", "ü€", "x" * 60])
    def test_labels_are_data(self, label: str, tmp_path: Path) -> None:
        graph = nx.relabel_nodes(WHEEL, {0: label})
        for suffix in ("svg", "png", "pdf"):
            draw_to_file(graph, find_attack(graph, 1, "delayed").attack, tmp_path / f"x.{suffix}")

    def test_the_same_picture_is_the_same_bytes(self, tmp_path: Path) -> None:
        result = rb.check_rs_robustness(PETERSEN, 2)
        for name in ("a.svg", "b.svg"):
            draw_to_file(PETERSEN, result, tmp_path / name)
        assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


class TestNames:
    @pytest.mark.parametrize(
        "graph",
        [
            nx.relabel_nodes(nx.cycle_graph(9), lambda k: f"Truck {k}"),
            nx.relabel_nodes(nx.star_graph(12), lambda k: f"station {k}"),
            nx.relabel_nodes(nx.grid_graph((4, 3)), lambda place: f"row {place[0]} {place[1]}"),
            nx.path_graph(["a", "a very long name of a node"]),
            nx.path_graph(["nobody else"]),
        ],
    )
    def test_no_name_covers_a_node_or_a_name(self, graph: nx.Graph) -> None:
        figure = new_figure(8, 6)
        ax = rb.draw(graph, ax=figure.subplots())
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in ax.texts]
        assert sorted(text.get_text() for text in ax.texts) == sorted(map(str, graph))
        assert [(one.bounds, two.bounds) for one, two in combinations(boxes, 2) if one.overlaps(two)] == []
        nodes = next(each for each in ax.collections if isinstance(each, PathCollection))
        centres = ax.transData.transform(nodes.get_offsets())
        radius = nodes.get_sizes()[0] ** 0.5 / 2 * figure.dpi / 72
        for box in boxes:
            for x, y in centres:
                across = max(box.x0 - x, 0, x - box.x1)
                up = max(box.y0 - y, 0, y - box.y1)
                assert (across**2 + up**2) ** 0.5 > 0.9 * radius

    @pytest.mark.parametrize(
        "graph",
        [
            nx.DiGraph([(f"Truck {k}", f"Truck {(k + step) % 9}") for k in range(9) for step in (1, 2)]),
            nx.DiGraph([(f"leaf {k}", "the hub") for k in range(6)]),
            nx.DiGraph([("left end", "middle"), ("middle", "right end"), ("below it", "middle")]),
        ],
    )
    def test_no_name_covers_the_head_of_an_arc(self, graph: nx.DiGraph) -> None:
        figure = new_figure(9, 7)
        ax = rb.draw(graph, ax=figure.subplots())
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in ax.texts]
        heads = [ax.transData.transform(arrow.get_path().vertices[3:6]) for arrow in ax.patches]
        assert len(heads) == graph.number_of_edges()
        covered = [box.bounds for box in boxes for head in heads if any(box.contains(*corner) for corner in head)]
        assert covered == []

    def test_names_of_a_crowd_are_left_out_where_they_find_no_place(self) -> None:
        crowd = nx.relabel_nodes(nx.empty_graph(900), lambda k: f"station {k}")
        few = {"station 7", "station 9"}
        figure = new_figure(10, 8)
        pos = {f"station {k}": (k % 30, k // 30) for k in range(900)}
        ax = rb.draw(crowd, (few, set(crowd) - few), pos=pos, ax=figure.subplots())
        figure.draw_without_rendering()
        assert few == {text.get_text() for text in ax.texts}
        sizes = [group.get_sizes()[0] ** 0.5 for group in ax.collections if isinstance(group, PathCollection)]
        assert max(sizes) < 13
        last = [group for group in ax.collections if isinstance(group, PathCollection)][-1]
        assert len(last.get_offsets()) == 2

    def test_short_names_stand_on_their_nodes(self) -> None:
        ax = rb.draw(PETERSEN, ax=axes())
        assert {tuple(text.get_position()) for text in ax.texts} == {tuple(text.xy) for text in ax.texts}


class TestNotebooks:
    def test_every_answer_has_a_page_with_a_picture_and_evidence(self) -> None:
        answers = [
            rb.check_rs_robustness(PETERSEN, 2), rb.determine_robustness(PETERSEN), rb.tolerance(WHEEL),
            rb.tolerance(WHEEL, model="delayed"), find_attack(WHEEL, 1, "delayed").attack,
            rb.check_joint_robustness(rb.TimeVaryingGraph([nx.path_graph(4)], period=1), 2),
        ]  # fmt: skip
        for answer in answers:
            page = answer._repr_mimebundle_()["text/html"]
            assert page.count("<img") == 1
            assert "<details>" in page
            assert str(answer) == answer.summary()
            assert repr(answer).startswith(f"<{type(answer).__name__}: ")
            assert "\n" not in repr(answer)
            assert len(repr(answer)) < 140
            json.dumps(answer.as_dict(), allow_nan=False)
        assert "<img" not in rb.check_rs_robustness(PETERSEN, 4).witness._repr_html_()

    def test_labels_are_escaped_and_in_natural_order(self) -> None:
        names = {i: f"<i>{i}" for i in range(11)}
        path = nx.relabel_nodes(nx.path_graph(11), names)
        page = rb.check_rs_robustness(path, 2)._repr_html_()
        assert "<i>" not in page
        long = rb.check_rs_robustness(nx.relabel_nodes(nx.path_graph(12), {i: f"n{i}" for i in range(12)}), 2)
        text = dict(long.evidence())
        shown = [name for side in ("S1", "S2") for name in text[side].strip("{}").split(", ")]
        for side in ("S1", "S2"):
            numbers = [int(name.strip("'n")) for name in text[side].strip("{}").split(", ")]
            assert numbers == sorted(numbers)
        assert shown

    def test_large_networks_are_not_drawn_unasked(self) -> None:
        assert "<img" not in rb.check_rs_robustness(nx.path_graph(200), 2)._repr_html_()


class TestCommand:
    def run(self, *arguments: str) -> Any:
        return CliRunner().invoke(robustness, ["draw", *arguments])

    def test_pictures_of_every_kind(self, tmp_path: Path) -> None:
        graph = tmp_path / "wheel.json"
        graph.write_text(json.dumps(nx.node_link_data(WHEEL, edges="edges")), encoding="utf-8")
        attack = tmp_path / "attack.json"
        CliRunner().invoke(robustness, ["attack", str(graph), "--model", "delayed", "-o", str(attack)])
        for k, options in enumerate(([], ["-r", "3"], ["-r", "2", "-s", "2"], ["--attack", str(attack)])):
            for suffix in ("svg", "png", "pdf"):
                picture = tmp_path / f"{k}.{suffix}"
                done = self.run(str(graph), *options, "-o", str(picture))
                assert done.exit_code == 0, done.output
                assert picture.stat().st_size > 1000
        assert self.run(str(graph), "-r", "3", "-o", str(tmp_path / "x.svg")).stdout == "not 3-robust\n"

    def test_wrong_use(self, tmp_path: Path) -> None:
        graph = tmp_path / "g.json"
        graph.write_text(json.dumps(nx.node_link_data(nx.path_graph(4), edges="edges")), encoding="utf-8")
        target = str(tmp_path / "x.svg")
        assert self.run(str(graph), "-s", "2", "-o", target).exit_code == 2
        assert self.run(str(graph), "-r", "2", "--attack", str(graph), "-o", target).exit_code == 2
        done = self.run(str(graph), "-o", str(tmp_path / "x.doc"))
        assert done.exit_code == 2
        assert "suffix" in done.stderr
        done = self.run(str(graph), "--attack", str(graph), "-o", target)
        assert done.exit_code == 3
        assert done.stderr.count("\n") == 1
        assert not Path(target).exists()


def test_no_node_of_a_flat_picture_is_cut_off() -> None:
    figure = new_figure(7.2, 4.2)
    axes = rb.draw(nx.cycle_graph(5), ({0, 1}, {3, 4}), ax=figure.subplots())
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    assert box.height > figure.bbox.height / 2
    for group in (each for each in axes.collections if isinstance(each, PathCollection)):
        radius = (group.get_sizes()[0] ** 0.5) / 2 * figure.dpi / 72
        for _, y in axes.transData.transform(group.get_offsets()):
            assert box.y0 + radius <= y <= box.y1 - radius


def test_places_of_a_network_stay_with_what_is_made_of_it() -> None:
    map_of_four = nx.path_graph(4)
    nx.set_node_attributes(map_of_four, {k: (float(k), float(k * k)) for k in range(4)}, "pos")
    map_of_four.add_node(2, colour="red", secret=object())
    mended = rb.mend(map_of_four, 2)
    axes = rb.draw(mended.graph, mended)
    texts = {text.get_text(): text.get_position() for text in axes.texts}
    assert {name: texts[name] for name in "0123"} == {str(k): (float(k), float(k * k)) for k in range(4)}
    assert mended.graph.to_networkx().nodes[2] == {"pos": (2.0, 4.0)}


def test_a_sequence_is_drawn_as_the_union_that_the_answer_is_about() -> None:
    swarm = rb.TimeVaryingGraph.from_arcs(range(4), [[(0, 1), (1, 0)], [(1, 2), (2, 1)], [(2, 3), (3, 2)]], 3)
    shorter = rb.check_joint_robustness(swarm, 1, window=2)
    assert shorter.violation is not None
    assert rb.draw(swarm, shorter).get_title()
    assert {text.get_text() for text in rb.draw(swarm).texts} >= set("0123")


def test_nodes_are_as_large_as_the_axes_leave_room_for() -> None:
    sizes = []
    for cells in (1, 6):
        figure = new_figure(6.0, 6.0)
        drawn = rb.draw(PETERSEN, ax=np.atleast_2d(figure.subplots(cells, cells))[0][0])
        sizes.append(next(c for c in drawn.collections if isinstance(c, PathCollection)).get_sizes()[0])
    assert sizes[1] < sizes[0] / 2


def test_endless_names_are_cut() -> None:
    drawn = rb.draw(nx.relabel_nodes(WHEEL, {0: "a" * 120}), ax=axes())
    assert max((text.get_text() for text in drawn.texts), key=len) == "a" * 31 + "…"


@pytest.mark.parametrize("network", [nx.wheel_graph(5), nx.petersen_graph(), nx.random_regular_graph(4, 40, seed=2)])
def test_a_flat_layout_fills_its_picture(network: nx.Graph) -> None:
    from matplotlib import pyplot as plt

    drawn = rb.draw(network, rb.check_rs_robustness(network, 3))
    drawn.figure.draw_without_rendering()
    heights = drawn.transData.transform(np.vstack([c.get_offsets() for c in drawn.collections]))[:, 1]
    assert np.ptp(heights) > 0.4 * drawn.figure.bbox.height
    plt.close(drawn.figure)


ALIKE = nx.Graph([(1, "1"), ("1", 2), (2, "2"), (1, 2), ("2", 1), ("b" * 40 + "1", 1), ("b" * 40 + "2", 1)])


def test_no_two_nodes_of_a_picture_look_alike() -> None:
    drawn = rb.draw(ALIKE, ax=axes())
    names = [text.get_text() for text in drawn.texts]
    assert len(set(names)) == len(ALIKE)
    assert {"1", "'1'", "2", "'2'"} < set(names)
    attack = find_attack(nx.Graph([(1, "1"), ("1", 2)]), 1).attack
    assert attack is not None
    assert rb.draw(attack.graph, attack, ax=axes()).get_title().count("'1'") == ("1" in attack.malicious)
    run = rb.simulate(ALIKE, f=1, malicious=["1"], steps=6, seed=1).plot()
    told = " ".join(
        text.get_text()
        for ax in np.atleast_1d(run)
        for text in (ax.get_legend().get_texts() if ax.get_legend() else [])
    )
    assert "'1'" in told
