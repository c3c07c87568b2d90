"""The benchmarks work: a small run end to end, and the parts that a run rarely shows. Nothing here looks at times."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from benchmarks.__main__ import main
from benchmarks.comparing import Comparison, Crew, Settings, Solved, compare, contradiction, geometric_mean
from benchmarks.figures import HEAD
from benchmarks.frontier import INSTANCES, Outcome, read_record, row
from benchmarks.measuring import METHODS, Determination, Measured, ask, determine
from benchmarks.suite import BUILDERS, FAMILIES, Instance, build, instances
from benchmarks.tables import Target, line, means, suite_targets, summary, summary_table, table
from benchmarks.workers import CallFailed, OutOfTime, Worker, WorkerLost

ROOT = Path(__file__).resolve().parent.parent
SMALL = Instance("circulant", "circulant", {"n": 10, "k": 3}, 3)


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "benchmarks", "--output", str(folder), *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a small run wrote."""
    folder = tmp_path_factory.mktemp("benchmarks")
    family = ("--family", "circulant", "--family", "platoon", "--largest", "10")
    done = run(folder, *family, "--cap", "60", "--method", "cp-sat", "--method", "exhaustive")
    assert done.returncode == 0, done.stderr
    (folder / "stdout").write_text(done.stdout, encoding="utf-8")
    return folder


class TestWholeRun:
    def test_prints_each_graph_the_means_and_the_targets(self, folder: Path) -> None:
        text = (folder / "stdout").read_text(encoding="utf-8")
        for expected in ("circulant(n=10, k=3)", "platoon(n=10, k=3)", "geometric mean", "reached", "warm"):
            assert expected in text

    def test_writes_json_with_verdicts_times_nodes_and_ratios(self, folder: Path) -> None:
        document = json.loads((folder / "suite.json").read_text(encoding="utf-8"))
        assert document["schema"] == "robustness/benchmark/1"
        assert [each["instance"]["builder"] for each in document["instances"]] == ["circulant", "platoon"]
        for each in document["instances"]:
            assert each["ours"]["lower"] == each["ours"]["upper"] == 3
            assert len(each["ours"]["runs"]) == 3
            assert each["failures"] == []
            for method in ("cp-sat", "exhaustive"):
                measured = each["methods"][method]
                assert measured["is_solved"]
                assert (measured["refute"]["verdict"], measured["find"]["verdict"]) == ("robust", "not-robust")
                both = measured["refute"]["seconds"] + measured["find"]["seconds"]
                assert measured["seconds"] == pytest.approx(both)
                assert measured["ratio"] == pytest.approx(both / each["ours"]["seconds"])
            assert each["methods"]["exhaustive"]["refute"]["nodes"] > 0
        assert set(document["summary"]) == {"circulant", "platoon", "all"}
        assert document["summary"]["all"]["cp-sat"]["solved"] == 2

    def test_draws_the_picture(self, folder: Path) -> None:
        assert (folder / "time-against-n.png").read_bytes().startswith(b"\x89PNG")


def test_wrong_usage_ends_with_two(tmp_path: Path) -> None:
    for wrong in (("--cap", "-1"), ("--cap", "nan"), ("--jobs", "0"), ("--family", "unheard-of")):
        with pytest.raises(SystemExit) as ended:
            main(["--output", str(tmp_path), *wrong])
        assert ended.value.code == 2


class TestSuite:
    def test_holds_every_family_at_sizes_from_10_to_200(self) -> None:
        suite = instances()
        assert {each.family for each in suite} == set(FAMILIES)
        sizes = {build(each).n for each in suite if each.builder not in ("topohub", "paley")}
        assert min(sizes) == 10
        assert max(sizes) == 200

    def test_a_recipe_fixes_the_graph(self) -> None:
        for instance in instances(largest=40):
            assert build(instance).sha256 == build(instance).sha256

    def test_another_seed_draws_other_graphs(self) -> None:
        families = ("gnp-.5", "directed-gnp", "regular", "unit-disk", "preferential-attachment", "topohub")
        for family in families:
            first, other = (instances(seed, (family,), 20) for seed in (1, 2))
            assert {build(each).sha256 for each in first} != {build(each).sha256 for each in other}

    @pytest.mark.parametrize("q", [11, 13])
    def test_paley_nodes_hear_half_of_the_others(self, q: int) -> None:
        graph = build(Instance("paley", "paley", {"q": q}))
        assert set(graph.in_degrees.tolist()) == {(q - 1) // 2}
        assert graph.is_symmetric == (q % 4 == 1)

    def test_large_graphs_have_the_arcs_they_promise(self) -> None:
        assert set(build(Instance("", "hearing_earlier", {"n": 50, "k": 5, "seed": 1})).in_degrees.tolist()) == {5}
        clumps = build(Instance("", "regular_with_clumps", {"n": 52, "k": 5, "seed": 1}))
        assert (clumps.n, sorted(set(clumps.in_degrees.tolist()))[0]) == (52, 5)
        assert set(clumps.in_degrees[-12:].tolist()) == {6}

    def test_every_builder_is_used_by_name(self) -> None:
        used = {each.builder for each in instances()}
        assert used <= set(BUILDERS)
        assert set(BUILDERS) - used == {"hearing_earlier", "regular_with_clumps", "gnm"}


class TestMeasuring:
    @pytest.mark.parametrize("method", sorted(METHODS))
    def test_every_method_refutes_r_and_decides_the_next(self, method: str) -> None:
        verdicts = [ask(SMALL, r, 1, method, 60.0, 1, 0).verdict for r in (3, 4)]
        assert verdicts == ["robust", "not-robust"]

    def test_ours_is_told_nothing(self) -> None:
        found = determine(SMALL, 60.0, 1e-6, 1, 0)
        assert (found.lower, found.upper, found.is_exact) == (3, 3, True)
        assert found.whole is not None
        assert 0 < found.seconds <= found.whole


class TestWorker:
    """Called with importable functions of the standard library, as a child process imports no test."""

    def test_a_call_beyond_its_time_is_killed_and_the_next_gets_a_new_process(self) -> None:
        with Worker() as worker:
            first = worker.call(os.getpid, seconds=60)
            assert worker.call(os.getpid, seconds=60) == first
            with pytest.raises(OutOfTime):
                worker.call(time.sleep, 60, seconds=0.2)
            assert worker.call(os.getpid, seconds=60) not in (first, os.getpid())

    def test_a_crash_is_told_from_an_error(self) -> None:
        with Worker() as worker:
            with pytest.raises(WorkerLost, match="exit code 7"):
                worker.call(os._exit, 7, seconds=60)
            with pytest.raises(CallFailed, match="ZeroDivisionError"):
                worker.call(divmod, 1, 0, seconds=60)

    def test_a_failing_warm_up_is_an_error(self) -> None:
        with Worker(os.abort) as worker, pytest.raises(WorkerLost):
            worker.call(max, 1, 2, seconds=60)


def solved(refute: float, find: float | None, *, is_solved: bool = True) -> Solved:
    second = None if find is None else Measured("not-robust", find, find)
    return Solved(Measured("robust", refute, refute), second, refute + (find or 0.0), is_solved)


def comparison(seconds: float, methods: dict[str, Solved], upper: int = 3) -> Comparison:
    ours = Determination(3, upper, 1, True, "bounds", seconds, seconds, None, 5)
    return Comparison(SMALL, 10, 60, False, ours, methods)


class InProcess(Crew):
    """Measures right here."""

    def run(self, method: str, function: Callable[..., Any], *arguments: Any, seconds: float) -> Any:
        return function(*arguments)


class Raising(InProcess):
    """Measures ours; everything else raises."""

    def __init__(self, problem: Exception) -> None:
        super().__init__(1)
        self.problem = problem

    def run(self, method: str, function: Callable[..., Any], *arguments: Any, seconds: float) -> Any:
        if method != "auto":
            raise self.problem
        return super().run(method, function, *arguments, seconds=seconds)


class TestComparing:
    def test_a_disagreement_is_told(self) -> None:
        wrong = Instance("circulant", "circulant", {"n": 10, "k": 3}, known_r=2)
        told = compare(wrong, InProcess(1), Settings(methods=("exhaustive",)))
        assert told.methods["exhaustive"].is_solved
        assert told.failures == [
            "DISAGREEMENT on circulant(n=10, k=3): ours says 3-robust, closed form says not 3-robust"
        ]

    def test_and_fails_the_run(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        def disagreeing(instance: Instance, crew: Crew, settings: Settings) -> Comparison:
            return Comparison(instance, 10, 60, False, failures=["DISAGREEMENT"])

        monkeypatch.setattr("benchmarks.__main__.compare", disagreeing)
        arguments = ["--output", str(tmp_path), "--family", "circulant", "--largest", "10"]
        assert main(arguments) == 1
        (told,) = json.loads((tmp_path / "suite.json").read_text(encoding="utf-8"))["instances"]
        assert told["failures"] == ["DISAGREEMENT"]

    def test_a_method_out_of_time_is_undecided_and_one_that_raises_fails(self) -> None:
        settings = Settings(3.0, methods=("milp",))
        slow, broken = (compare(SMALL, Raising(each), settings) for each in (OutOfTime("killed"), CallFailed("trace")))
        assert slow.failures == []
        assert (slow.methods["milp"].is_solved, slow.methods["milp"].seconds) == (False, 3.0)
        assert slow.methods["milp"].find is None
        assert broken.failures == ["milp on circulant(n=10, k=3): trace"]

    def test_a_capped_method_counts_as_a_bound_only(self) -> None:
        lines = [
            comparison(0.1, {"cp-sat": solved(0.5, 0.5)}),
            comparison(0.1, {"cp-sat": solved(60, None, is_solved=False)}),
        ]
        mean = means(lines, "cp-sat")
        assert (mean["asked"], mean["solved"]) == (2, 1)
        assert mean["geometric_mean"] == pytest.approx(10)
        assert mean["geometric_mean_cpu"] == pytest.approx(10)
        assert mean["at_least_over_all"] == pytest.approx((10 * 600) ** 0.5)

    def test_an_undetermined_graph_has_no_ratio(self) -> None:
        open_one = comparison(60, {"cp-sat": solved(1, 1)}, upper=4)
        assert open_one.ratio("cp-sat") is None
        assert means([open_one], "cp-sat")["geometric_mean"] is None

    def test_slower_than_the_best_peer_is_told(self) -> None:
        settings = Settings(methods=("subset-search", "cp-sat"))
        # The subset search is ours: its speed alone is no reproach.
        fast, slow = (
            comparison(1, {"subset-search": solved(0.1, 0.1), "cp-sat": solved(1, 1)}),
            comparison(9, {"cp-sat": solved(1, 2)}),
        )
        assert suite_targets([fast], settings)[-1].reached
        told = suite_targets([fast, slow], settings)[-1]
        assert told.reached is False
        assert "3x (cp-sat)" in told.note

    def test_the_targets_over_the_suite(self) -> None:
        settings = Settings(methods=("cp-sat-direct", "milp-direct"))
        lines = [comparison(0.01, {"cp-sat-direct": solved(0.2, 0.2), "milp-direct": solved(1, 1)})]
        cp_sat, milp, _ = suite_targets(lines, settings)
        assert (cp_sat.measured, cp_sat.reached, milp.measured, milp.reached) == ("40x", True, "200x", False)

    def test_contradictions(self) -> None:
        assert contradiction([]) is None
        assert contradiction([("a", 2, True), ("b", 3, False), ("c", 3, False)]) is None
        assert contradiction([("a", 2, True), ("b", 2, False)]) == "a says 2-robust, b says not 2-robust"
        assert contradiction([("a", 3, True), ("b", 2, False), ("c", 4, False)]) is not None

    def test_geometric_mean_of_nothing(self) -> None:
        assert geometric_mean([]) is None


class TestTables:
    def test_a_line_says_what_the_cap_ended(self) -> None:
        settings = Settings(methods=("cp-sat", "milp"))
        capped = comparison(0.1, {"cp-sat": solved(60, None, is_solved=False)})
        assert ">60 (>600x)" in line(capped, settings)
        assert "3..4" in line(comparison(60, {}, upper=4), settings)
        assert "failed" in line(Comparison(SMALL, 10, 60, False), settings)

    def test_the_summary_has_a_row_for_each_family_and_all(self) -> None:
        settings = Settings(methods=("cp-sat", "milp"))
        text = summary_table(summary([comparison(0.1, {"cp-sat": solved(1, 1)})], settings), settings)
        rows: list[Any] = text.splitlines()
        assert [row.split()[0] for row in rows] == ["family", "circulant", "all", "all,"]
        assert "20x (1/1; >=20x)" in rows[1]

    def test_a_figure_has_a_cell_under_every_head(self) -> None:
        figure = Target("name", "< 2 s", "1 s", True, 1.0, 0.9)
        assert len(figure.row()) == len(HEAD)
        assert "yes" in table([HEAD, figure.row()])


def test_the_frontier_of_the_documents_is_that_of_its_record() -> None:
    record = read_record(ROOT / "docs" / "frontier.jsonl")
    rows = [row(name, [each for (of, _), each in record.items() if of == name], 1800.0) for name in INSTANCES]
    assert all(len([key for key in record if key[0] == name]) == 10 for name in INSTANCES)
    table = (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
    assert "\n".join(rows) in table
    shown = (ROOT / "README.md").read_text(encoding="utf-8").partition("## How large")[2].partition("\n## ")[0]
    told = [each for each in shown.splitlines() if each.startswith("| ") and " of 10 |" in each]
    assert len(told) > 5
    assert set(told) <= {"|".join(each.split("|")[:5]) + "|" for each in rows}


def test_a_seed_whose_limit_came_early_is_run_again() -> None:
    """On a busy machine a limit of wall-clock time comes before so much work of one core."""
    early = Outcome("G(70,.5)", 1, 16, 18, 900.0, 900.0, 1, (500.0, 800.0, 1500.0))
    assert "1 not run to the limit" in row("G(70,.5)", [early], 1800.0)
    assert "not run" not in row("G(70,.5)", [replace(early, seconds=1790.0, limit=1800.0)], 1800.0)
