"""The paper's experiments end as it reports, and runs and pictures are the same every time."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest

from robustness.digraph import as_digraph
from robustness.errors import InvalidParameter, MissingExtra, Undecided
from robustness.figures.simulation import Run, draw_runs
from robustness.paper.experiments import EXPERIMENTS, CaseResult, experiment_named, run_experiment
from robustness.paper.trajectories import draw_experiment
from robustness.simulation import (
    Scenario,
    Start,
    Topology,
    as_topology,
    random_start,
    simulate,
)
from robustness.simulation.adversaries import Alternating, Constant, Liar, Noise
from robustness.simulation.replay import _KINDS, decode_run, encode_run, read_run, write_run
from robustness.simulation.schedules import ConstantDelays, EveryStep, PeriodicUpdates, RandomDelays, Schedule

pytestmark = pytest.mark.filterwarnings("ignore::robustness.simulation.gains.PromiseWarning")


def play(experiment: str, name: str, reading: str = "transformed") -> CaseResult:
    for case in EXPERIMENTS[experiment].cases():
        if case.name == name and reading in case.reading:
            return CaseResult(case, simulate(case.scenario, [case.start])[0])
    raise AssertionError(f"no case {name} in {experiment}")


def nodes(result: CaseResult) -> list[tuple[int, ...]]:
    return [labels for _, labels in result.outcome.groups]


class TestThePapersSettings:
    @pytest.mark.parametrize(("setting", "gap"), [("setting-1", 176.7478), ("setting-2", 74.3817)])
    def test_the_wheel_is_divided_into_two_groups(self, setting: str, gap: float) -> None:
        """Figures xfail and xfail.active: {1, 5} from {2, 3}, each group moving as one at the target speed."""
        result = play(setting, "figure read as wheel")
        assert result.as_reported
        assert result.outcome.verdict.value == "split"
        assert nodes(result) == [(1, 5), (2, 3)]
        assert result.outcome.speed < 1e-9
        assert result.outcome.spread == pytest.approx(gap, abs=1e-3)

    @pytest.mark.parametrize("setting", ["setting-1", "setting-2"])
    def test_the_complete_graph_agrees(self, setting: str) -> None:
        result = play(setting, "complete graph")
        assert result.as_reported
        assert result.outcome.verdict.value == "agreement"
        assert nodes(result) == [(1, 2, 3, 5)]

    def test_read_as_absolute_positions_the_wheel_agrees(self) -> None:
        result = play("setting-1", "figure read as wheel", "absolute")
        assert result.as_reported is None
        assert result.outcome.verdict.value == "agreement"

    def test_when_the_truth_is_heard_at_even_steps_the_wheel_agrees_in_setting_2(self) -> None:
        """Only the claims of odd steps are given; vehicles 1 and 5 update at even ones."""
        result = play("setting-2", "figure read as wheel", "says where it is")
        assert result.as_reported is None
        assert result.outcome.verdict.value == "agreement"
        assert result.outcome.groups[0][0] == pytest.approx(266.13, abs=0.01)

    def test_their_gains_lie_outside_the_theory(self) -> None:
        for setting in ("setting-1", "setting-2"):
            case = EXPERIMENTS[setting].cases()[0]
            outcome = simulate(Scenario(**_without_steps(case.scenario), steps=20), [case.start])[0]
            assert outcome.safe is None
            assert "alpha T" in str(outcome.promise_gap)

    @pytest.mark.slow
    @pytest.mark.parametrize("setting", ["setting-1", "setting-2"])
    def test_every_reading(self, setting: str) -> None:
        results = run_experiment(EXPERIMENTS[setting])
        assert all(result.as_reported is not False for result in results)
        ends = [result.outcome.verdict.value for result in results]
        assert ends == ["split"] * 3 + ["agreement"] * (len(results) - 3)
        assert len(results) == {"setting-1": 5, "setting-2": 6}[setting]


def _without_steps(scenario: Scenario) -> dict[str, Any]:
    return {field.name: getattr(scenario, field.name) for field in fields(scenario) if field.name != "steps"}


@pytest.mark.parametrize("name", [name for name in EXPERIMENTS if not name.startswith("setting")])
def test_every_other_experiment_ends_as_the_theorems_say(name: str) -> None:
    results = run_experiment(experiment_named(name))
    assert results
    for result in results:
        assert result.as_reported, (result.case.name, result.outcome)
        inside = result.outcome.promise_gap is None
        assert result.outcome.safe is (True if inside else None)
        if name in ("gains-outside", "swap", "push"):
            assert (result.outcome.verdict.value == "agreement") == inside
        json.dumps(result.as_dict(), allow_nan=False)


def test_the_numbers_of_cases() -> None:
    counts = {name: len(experiment.cases()) for name, experiment in EXPERIMENTS.items()}
    assert counts == {
        "setting-1": 5, "setting-2": 6, "proposition-1": 6, "necessity": 12, "sufficiency": 3, "gap": 4,
        "corollary-1": 1, "corollary-2": 6, "gains-outside": 10, "swap": 4, "push": 2,
    }  # fmt: skip


def test_unknown_experiments_are_refused() -> None:
    with pytest.raises(InvalidParameter, match="an experiment is one of setting-1"):
        experiment_named("setting-3")


def test_the_time_limit_is_for_all_cases_together() -> None:
    with pytest.raises(Undecided):
        run_experiment(experiment_named("setting-2"), time_limit=0.05)


class TestReplay:
    GRAPH = as_digraph(nx.relabel_nodes(nx.wheel_graph(6), {0: "hub", 1: (1, "a"), 2: "1", 3: 1}))

    def scenario(self, **changes: Any) -> Scenario:
        standard: dict[str, Any] = {
            "network": Topology((self.GRAPH,)), "f": 2, "rule": "adp-msr", "steps": 30, "T": 0.3,
            "alpha": {label: 5.0 + i / 7 for i, label in enumerate(self.GRAPH.labels)},
            "weights": {(self.GRAPH.labels[u], self.GRAPH.labels[v]): 0.1 for u, v in self.GRAPH.arcs()}
            | {(1, (1, "a")): 0.3},
            "offsets": {"hub": 0.1, (1, "a"): -2.7}, "active": frozenset({"1", 1}),
            "added_links": ((1, (1, "a")),), "adversary": Liar(Noise(0.3), Alternating(1.0, 2.0, ("1",), (1,))),
            "schedule": Schedule(PeriodicUpdates(3, {"hub": 1}), RandomDelays(2), tau=9), "dwell": 7,
            "groups": ((1,), ("1",)),
        }  # fmt: skip
        return Scenario(**(standard | changes))

    def test_every_bit_comes_back(self, tmp_path: Path) -> None:
        start = random_start(self.GRAPH, [1], 2**62 + 1)
        varying = as_topology(lambda k: nx.cycle_graph(4) if k % 3 else nx.path_graph(4), 7)
        for scenario in (
            self.scenario(),
            self.scenario(network=varying, alpha=None,
                          weights="unit", offsets=None, active=frozenset(), added_links=(), groups=None,
                          adversary=Constant(), schedule=Schedule(EveryStep(), ConstantDelays(1, {(0, 1): 2}))),
        ):  # fmt: skip
            if scenario.network.union.n == 4:
                start = random_start(scenario.network.union, [0, 1], 3)
            (outcome,) = simulate(scenario, [start], record=True)
            write_run(tmp_path / "run.json", scenario, start, outcome)
            again = read_run(tmp_path / "run.json")
            assert again == (scenario, start)
            (same,) = simulate(again[0], [again[1]], record=True)
            assert same == outcome
            assert np.array_equal(same.trajectory.p, outcome.trajectory.p)
            write_run(tmp_path / "again.json", *again, same)
            assert (tmp_path / "run.json").read_bytes() == (tmp_path / "again.json").read_bytes()

    def test_every_part_can_be_recorded(self) -> None:
        for name, kind in _KINDS.items():
            assert kind.__name__ == name
        for experiment in EXPERIMENTS.values():
            for case in experiment.cases():
                document = json.loads(json.dumps(encode_run(case.scenario, case.start)))
                assert decode_run(document) == (case.scenario, case.start)

    @pytest.mark.parametrize(
        "spoil",
        [
            lambda d: d.update(schema="robustness/run/9"),
            lambda d: d.update(scenario=None),
            lambda d: d.update(scenario=d["start"]),
            lambda d: d["scenario"].update(kind="Path"),
            lambda d: d["scenario"].update(kind=["Scenario"]),
            lambda d: d["scenario"].update(unknown=1),
            lambda d: d["scenario"].update(f=-1),
            lambda d: d["scenario"].update(steps="many"),
            lambda d: d["scenario"].update(active=[1]),
            lambda d: d["scenario"].update(network={"kind": "Digraph", "labels": [0]}),
            lambda d: d["start"].pop("positions"),
            lambda d: d["start"].update(seed={"kind": "nothing"}),
        ],
    )
    def test_what_is_no_run_is_refused(self, spoil: Any) -> None:
        document = json.loads(json.dumps(encode_run(self.scenario(), random_start(self.GRAPH, [1], 0))))
        spoil(document)
        with pytest.raises(InvalidParameter):
            decode_run(document)

    @pytest.mark.parametrize("content", ["", "[]", "null", "{", "[" * 100_000])
    def test_files_that_are_none_are_refused(self, tmp_path: Path, content: str) -> None:
        (tmp_path / "run.json").write_text(content)
        with pytest.raises(InvalidParameter):
            read_run(tmp_path / "run.json")
        with pytest.raises(InvalidParameter, match="not readable"):
            read_run(tmp_path / "missing.json")

    def test_foreign_parts_cannot_be_recorded(self) -> None:
        with pytest.raises(InvalidParameter, match="only the parts of this package"):
            encode_run(self.scenario(adversary=_Foreign()), random_start(self.GRAPH, [1], 0))
        with pytest.raises(InvalidParameter, match="finite"):
            encode_run(self.scenario(), Start(frozenset(), (float("nan"),) * 6, (0.0,) * 6))


class _Foreign(Constant):
    """A user's own adversary."""


class TestPictures:
    def recorded(self, title: str = "") -> Run:
        network = as_topology(nx.complete_graph(4), 1)
        scenario, start = Scenario(network, 1, steps=40, target_speed=3.0), random_start(network.union, [3], 0)
        return Run(scenario, start, simulate(scenario, [start], record=True)[0], title)

    @pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
    def test_the_same_run_gives_the_same_file(self, tmp_path: Path, suffix: str) -> None:
        pytest.importorskip("matplotlib")
        first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
        for path in (first, second):
            draw_runs([self.recorded("a run")], path, quantities=("position",))
        assert first.read_bytes() == second.read_bytes()
        assert first.stat().st_size > 5000

    def test_normal_vehicles_are_drawn(self, tmp_path: Path) -> None:
        draw_runs([self.recorded()], tmp_path / "run.svg", quantities=("velocity",))
        picture = (tmp_path / "run.svg").read_text()
        assert picture.count("<!-- velocity v -->") == 1
        assert "<!-- {0, 1, 2} at" in picture

    def test_refusals(self, tmp_path: Path) -> None:
        run = self.recorded()
        with pytest.raises(InvalidParameter, match="suffix"):
            draw_runs([run], tmp_path / "run.xyz")
        with pytest.raises(InvalidParameter, match="quantity"):
            draw_runs([run], tmp_path / "run.png", quantities=("speed",))
        unrecorded = run._replace(outcome=simulate(run.scenario, [run.start])[0])
        for runs in ([unrecorded], [run, unrecorded], []):
            with pytest.raises(InvalidParameter, match="recorded"):
                draw_runs(runs, tmp_path / "run.png")

    def test_without_matplotlib(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        recorded = self.recorded()
        monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
        with pytest.raises(MissingExtra, match="needs matplotlib"):
            draw_runs([recorded], tmp_path / "run.png")

    def test_an_experiment_is_a_folder_of_pictures(self, tmp_path: Path) -> None:
        results = run_experiment(experiment_named("gap"), record=True)
        written = draw_experiment("gap", results, tmp_path / "new")
        assert {path.name for path in written} == {path.name for path in (tmp_path / "new").iterdir()}
        assert len(written) == 4

    def test_or_one_picture_of_all_cases(self, tmp_path: Path) -> None:
        results = run_experiment(experiment_named("gap"), record=True)
        assert draw_experiment("gap", results, tmp_path / "gap.svg") == [tmp_path / "gap.svg"]
        assert (tmp_path / "gap.svg").read_text().count("<!-- gap, corrected graph") == 4
