"""One call from a network to a run, and the pictures and films of runs."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import networkx as nx
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from PIL import Image

import robustness as rb
from cli.main import robustness
from robustness.errors import InvalidParameter, MissingExtra
from robustness.figures.animation import animate
from robustness.figures.simulation import LIAR_COLOR, Run, draw_outcome, draw_runs
from robustness.figures.time_span import last_step_shown
from robustness.files import write_topology
from robustness.simulation import ADVERSARIES, find_attack, random_start
from robustness.simulation import simulate as simulate_batch
from robustness.simulation.scenario import Scenario

mpl.use("agg")

K5, WHEEL = nx.complete_graph(5), nx.wheel_graph(5)


def run_of(outcome: Any) -> Run:
    return Run(outcome.scenario, outcome.start, outcome)


def axes() -> Any:
    return Figure(figsize=(8, 4), layout="constrained").subplots()


class TestOneCall:
    def test_the_call_of_the_issue(self) -> None:
        outcome = rb.simulate(K5, rule="w-msr", f=1, malicious=[4], adversary="sine", steps=100, seed=0)
        assert outcome.verdict.value == "agreement"
        assert outcome.positions.shape == outcome.velocities.shape == (101, 5)
        assert outcome.labels == (0, 1, 2, 3, 4)
        scenario = Scenario(K5, 1, "w-msr", adversary="sine", steps=100)
        assert simulate_batch(scenario, random_start(K5, [4], 0))[0] == outcome

    def test_positions_are_absolute(self) -> None:
        outcome = rb.simulate(K5, target_speed=3.0, T=0.5, steps=10, offsets={0: 7.0})
        assert np.allclose(outcome.positions, outcome.trajectory.p + 1.5 * np.arange(11)[:, None])
        assert np.allclose(outcome.velocities, outcome.trajectory.q + 3.0)

    def test_starts_in_order_and_by_node(self) -> None:
        by_order = rb.simulate(K5, positions=[1, 2, 3, 4, 5], velocities=[0, 0, 0, 0, 1], steps=5)
        by_node = rb.simulate(K5, positions={0: 1, 1: 2, 2: 3, 3: 4, 4: 5}, velocities={4: 1}, steps=5)
        assert np.array_equal(by_order.positions, by_node.positions)

    def test_a_network_over_time_remembers_for_a_turn(self) -> None:
        parts = [nx.Graph([(0, 1), (2, 3), (4, 0)]), nx.Graph([(1, 2), (3, 4), (0, 2), (1, 3)])]
        for part in parts:
            part.add_nodes_from(range(5))
        sequence = rb.TimeVaryingGraph(parts, period=2)
        assert rb.simulate(sequence, f=0, T=0.9, steps=50).scenario.schedule.oldest == 1
        assert rb.simulate(sequence, f=0, T=0.9, schedule="delayed", tau=2, steps=50).scenario.schedule.oldest == 3

    def test_a_rule_of_ones_own_against_every_adversary(self) -> None:
        def median(own: float, heard: tuple[float, ...]) -> float:
            return sorted([own, *heard])[(len(heard) + 1) // 2]

        for name in ADVERSARIES:
            outcome = rb.simulate(nx.complete_graph(7), median, adversary=name, steps=40)
            normal = [i for i, label in enumerate(outcome.labels) if label not in outcome.start.malicious]
            assert outcome.positions[:, normal].min() >= 0
            assert outcome.positions[:, normal].max() <= 100

    @pytest.mark.parametrize(
        ("arguments", "rule"),
        [
            ({"horizon": 5}, "unexpected keyword argument 'horizon': there are T, active"),
            ({"network": K5}, "unexpected keyword argument 'network'"),
            ({"tau": -1}, "tau is an integer of at least 0"),
            ({"malicious": 4}, "malicious nodes is a collection"),
            ({"malicious": [0, 1]}, "f-total"),
            ({"malicious": [17]}, "17"),
            ({"adversary": "evil"}, "an adversary is one of"),
            ({"rule": "msr"}, "an update rule is one of"),
            ({"positions": {17: 1.0}}, "17"),
            ({"positions": [1, 2]}, "one position for each"),
        ],
    )
    def test_bad_arguments_fail_at_once(self, arguments: dict[str, Any], rule: str) -> None:
        with pytest.raises((rb.RobustnessError, TypeError), match=rule):
            rb.simulate(K5, **arguments)

    def test_public_names(self) -> None:
        assert {"simulate", "draw", "__version__", "tolerance", "constructions"} <= set(dir(rb))
        for name in dir(rb):
            assert getattr(rb, name) is not None
        assert rb.__version__.count(".") >= 1


class TestFrames:
    def test_where_pandas_is_installed(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """A stand-in with the three names that are used: pandas itself is no dependency."""

        class Pandas:
            Index = staticmethod(lambda values, **names: (tuple(values), names))
            RangeIndex = staticmethod(lambda stop, **names: (stop, names))
            DataFrame = staticmethod(lambda values, **parts: (values, parts))

        monkeypatch.setitem(sys.modules, "pandas", Pandas)
        outcome = rb.simulate(K5, steps=3)
        values, parts = outcome.to_frame()
        assert np.array_equal(values, outcome.positions)
        assert parts["columns"][0] == (0, 1, 2, 3, 4)
        assert parts["index"] == (4, {"name": "step"})

    def test_where_it_is_not(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "pandas", None)
        with pytest.raises(MissingExtra, match="pip install pandas"):
            rb.simulate(K5, steps=3).to_frame()

    def test_only_recorded_runs_have_positions(self) -> None:
        (outcome,) = simulate_batch(Scenario(K5, 1, steps=3), random_start(K5, [4]))
        for ask in (lambda: outcome.positions, outcome.to_frame, outcome.plot):
            with pytest.raises(InvalidParameter, match="record"):
                ask()
        assert "<img" not in outcome._repr_html_()


class TestPlot:
    def test_groups_are_coloured_and_the_liar_is_dashed_with_a_line_for_each_face(self) -> None:
        outcome = find_attack(WHEEL, 1, "delayed").attack.run(30, record=True)
        ax = outcome.plot(ax=axes())
        told = [text.get_text() for text in ax.get_legend().get_texts()]
        assert told == ["{1, 4} at 0", "{2, 3} at 100", "0 shows {1, 4}", "0 shows {2, 3}"]
        colors = {line.get_label(): line.get_color() for line in ax.lines}
        assert len({colors[name] for name in told[:2]}) == 2
        liars = [line for line in ax.lines if line.get_label().startswith("0 shows")]
        assert all(line.is_dashed() for line in liars)
        assert [set(line.get_ydata()) for line in liars] == [{0.0}, {100.0}]
        assert ax.get_title(loc="left") == "adp-msr, f = 1, malicious, values up to 1 step old: split, exactly"

    @pytest.mark.parametrize("vehicles", [5, 19, 40])
    def test_the_legend_covers_no_curve_and_stays_in_the_picture(self, vehicles: int, tmp_path: Path) -> None:
        outcome = rb.simulate(nx.path_graph(vehicles), "w-msr", adversary="two-face", steps=30)
        figure = Figure(figsize=(8, 4.2), layout="constrained")
        ax = draw_outcome(outcome, figure.subplots())
        figure.savefig(tmp_path / "x.png")
        legend, plot = ax.get_legend().get_window_extent(), ax.get_window_extent()
        assert legend.x0 >= plot.x1 - 1
        assert legend.x1 <= figure.bbox.x1 + 1
        assert legend.y0 >= -1

    def test_velocities_only_where_there_are_any(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        drawn: list[int] = []
        original = Figure.subplots

        def counted(self: Figure, rows: int = 1, columns: int = 1, **more: Any) -> Any:
            drawn.append(columns)
            return original(self, rows, columns, **more)

        monkeypatch.setattr(Figure, "subplots", counted)
        for rule in ("w-msr", "dp-msr"):
            draw_runs([run_of(rb.simulate(K5, rule, steps=20))], tmp_path / "x.png")
        assert drawn == [1, 2]

    @pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")
    def test_a_divergence_is_drawn_up_to_its_step(self) -> None:
        outcome = rb.simulate(K5, alpha=4.0, steps=200)
        ax = outcome.plot(ax=axes())
        assert max(line.get_xdata()[-1] for line in ax.lines if len(line.get_xdata())) <= outcome.diverged_at
        assert "divergence at step" in ax.get_title(loc="left")

    def test_a_network_instead(self) -> None:
        outcome = find_attack(WHEEL, 1, "delayed").attack.run(5, record=True)
        labels = [group.get_label() for group in outcome.plot(WHEEL, ax=axes()).collections]
        assert "S1: 2 nodes" in labels

    def test_labels_are_data(self, tmp_path: Path) -> None:
        graph = nx.relabel_nodes(WHEEL, {0: "$x", 1: "$y$"})
        outcome = find_attack(graph, 1, "delayed").attack.run(9, record=True)
        draw_runs([run_of(outcome)], tmp_path / "x.svg")
        animate(run_of(outcome), tmp_path / "x.gif")


class TestWhereItEnds:
    """Every picture and film ends a while after the motion, and where the user says."""

    @staticmethod
    def last_step(ax: Any) -> float:
        return max(line.get_xdata()[-1] for line in ax.lines if len(line.get_xdata()))

    @pytest.mark.parametrize("rule", ["w-msr", "dp-msr"])
    def test_after_the_motion(self, rule: str) -> None:
        short, long = (rb.simulate(K5, rule, steps=steps, seed=1) for steps in (200, 2000))
        shown = [last_step_shown(each) for each in (short, long)]
        assert shown[0] == shown[1] < 150
        p = long.trajectory.p
        normal = [i for i, label in enumerate(long.scenario.network.union.labels) if label not in long.start.malicious]
        assert np.ptp(p[shown[1], normal]) <= 0.02 * np.ptp(p[0, normal])
        ax = long.plot(ax=axes())
        assert self.last_step(ax) == shown[1]
        assert ax.get_xlabel() == "step k (the run has 2000 steps)"

    def test_what_never_rests_is_shown_whole(self) -> None:
        outcome = rb.simulate(K5, lambda own, heard: own + 1.0, steps=90)
        ax = outcome.plot(ax=axes())
        assert self.last_step(ax) == 90
        assert ax.get_xlabel() == "step k"

    def test_what_never_moves_is_short(self) -> None:
        assert last_step_shown(find_attack(WHEEL, 1, "delayed").attack.run(500, record=True)) == 20

    def test_what_is_asked_for(self, tmp_path: Path) -> None:
        outcome = rb.simulate(K5, steps=300)
        assert self.last_step(outcome.plot(ax=axes(), last_step=7)) == 7
        assert self.last_step(outcome.plot(ax=axes(), last_step=10**6)) == 300
        animate(run_of(outcome), tmp_path / "film.gif", last_step=7)
        with Image.open(tmp_path / "film.gif") as film:
            assert film.n_frames == 8

    def test_on_the_command_line(self, tmp_path: Path) -> None:
        graph, film = str(tmp_path / "g.json"), str(tmp_path / "film.gif")
        write_topology(K5, graph)
        run = CliRunner().invoke
        assert run(robustness, ["simulate", graph, "--animate", film, "--last-step", "7"]).exit_code == 0
        with Image.open(film) as made:
            assert made.n_frames == 8
        refused = run(robustness, ["simulate", graph, "--last-step", "7"])
        assert refused.exit_code == 2
        assert "--last-step says where --plot or --animate ends" in refused.output


class TestToldApart:
    def test_groups_that_are_near_have_labels_of_their_own(self) -> None:
        outcome = find_attack(WHEEL, 1, "delayed").attack.run(5, record=True)
        near = replace(outcome, groups=((46.94471, (1, 4)), (46.94472, (2, 3))))
        told = [text.get_text() for text in near.plot(ax=axes()).get_legend().get_texts()]
        assert told[:2] == ["{1, 4} at 46.94471", "{2, 3} at 46.94472"]

    def test_what_a_liar_says_lies_behind_the_curves(self) -> None:
        ax = rb.simulate(K5, malicious=[4], adversary="sine", steps=60).plot(ax=axes())
        claims = [line for line in ax.lines if "says" in str(line.get_label())]
        assert claims
        assert max(line.get_zorder() for line in claims) < min(
            line.get_zorder() for line in ax.lines if line.get_label() == "_"
        )

    def test_liars_who_say_the_same_have_one_line_and_others_marks_of_their_own(self) -> None:
        graph = nx.complete_graph(7)
        same = rb.simulate(graph, f=2, malicious=[5, 6], adversary="sine", steps=60).plot(ax=axes())
        assert [text.get_text() for text in same.get_legend().get_texts()][-1] == "{5, 6} say"
        other = rb.simulate(graph, f=2, malicious=[5, 6], adversary="random", steps=60).plot(ax=axes())
        claims = [line for line in other.lines if "say" in str(line.get_label())]
        assert len(claims) >= 2
        assert len({line.get_marker() for line in claims}) == len(claims)

    def test_a_claim_that_is_a_curve_as_well_is_seen(self) -> None:
        ax = find_attack(WHEEL, 1, "delayed").attack.run(30, record=True).plot(ax=axes())
        claims = [line for line in ax.lines if line.get_color() == LIAR_COLOR]
        assert claims
        assert all(line.get_marker() not in ("None", "", None) for line in claims)

    def test_long_names_leave_room_for_the_curves(self) -> None:
        figure = Figure(figsize=(8, 4.2), layout="constrained")
        graph = nx.relabel_nodes(nx.complete_graph(9), lambda k: f"a station with a long name {k}")
        ax = rb.simulate(graph, steps=20).plot(ax=figure.subplots())
        figure.draw_without_rendering()
        assert ax.get_window_extent().width > 0.55 * figure.bbox.width
        assert figure.bbox.contains(*ax.get_legend().get_window_extent().max)

    def test_lanes_of_a_film_are_in_natural_order_from_the_top(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        drawn: list[Figure] = []

        def kept(width: float, height: float) -> Figure:
            drawn.append(Figure(figsize=(width, height), layout="constrained"))
            return drawn[-1]

        monkeypatch.setattr("robustness.figures.animation.new_figure", kept)
        graph = nx.relabel_nodes(nx.complete_graph(12), lambda k: f"n{k}")
        outcome = rb.simulate(graph, malicious=["n11"], steps=10)
        animate(run_of(outcome), tmp_path / "film.gif")
        (ax,) = drawn[0].axes
        assert [text.get_text() for text in ax.get_yticklabels()] == [f"n{k}" for k in range(12)]
        assert ax.yaxis_inverted()
        dots, crosses = ax.collections
        assert [y for _, y in crosses.get_offsets()] == [11]
        assert sorted(y for _, y in dots.get_offsets()) == list(range(11))
        assert ax.get_xlabel().splitlines()[0] == outcome.plot(ax=axes()).get_ylabel() == "position p"
        assert "cross: what {n11} claims" in ax.get_xlabel()
        drawn[0].draw_without_rendering()
        (clock,) = ax.texts
        assert clock.get_text().startswith("step")
        low = ax.transData.transform((0, 11))[1]
        assert clock.get_window_extent().y1 < low - 46**0.5 / 2 * drawn[0].dpi / 72


class TestFilms:
    @pytest.mark.parametrize("kind", ["split", "agreement"])
    def test_of_a_split_and_of_an_agreement(self, kind: str, tmp_path: Path) -> None:
        attack = find_attack(WHEEL, 1, "delayed").attack
        outcome = attack.run(20, record=True) if kind == "split" else rb.simulate(K5, steps=40)
        assert outcome.verdict.value == kind
        animate(run_of(outcome), tmp_path / "film.gif")
        with Image.open(tmp_path / "film.gif") as film:
            assert film.n_frames > 5
        animate(run_of(outcome), tmp_path / "film.html")
        page = (tmp_path / "film.html").read_text(encoding="utf-8")
        assert page.startswith("<!DOCTYPE html>")
        shell = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
        assert re.findall(r"https?:|@import|url\(", shell) == []
        assert 'class="fa' not in page
        assert "data:image/png;base64" in page

    def test_what_cannot_be_filmed(self, tmp_path: Path) -> None:
        outcome = rb.simulate(K5, steps=5)
        with pytest.raises(InvalidParameter, match=r"\.gif or \.html"):
            animate(run_of(outcome), tmp_path / "film.mp4")
        (bare,) = simulate_batch(Scenario(K5, 1, steps=3), random_start(K5, [4]))
        with pytest.raises(InvalidParameter, match="record"):
            animate(run_of(bare), tmp_path / "film.gif")

    def test_on_the_command_line(self, tmp_path: Path) -> None:
        film = tmp_path / "film.gif"
        graph = tmp_path / "g.json"
        rb.write_topology(WHEEL, graph)
        arguments = ["simulate", str(graph), "--steps", "20", "--animate", str(film)]
        done = CliRunner().invoke(robustness, arguments)
        assert done.exit_code in (0, 30), done.output
        assert film.stat().st_size > 1000
        arguments = ["simulate", "--experiment", "gap", "--animate", str(film)]
        assert CliRunner().invoke(robustness, arguments).exit_code == 2


@pytest.mark.parametrize("nodes", [0, 1])
def test_films_of_next_to_nothing(nodes: int, tmp_path: Path) -> None:
    film = tmp_path / "film.html"
    animate(run_of(rb.simulate(nx.empty_graph(nodes), f=0, steps=3)), film)
    assert "<img" in film.read_text(encoding="utf-8")
