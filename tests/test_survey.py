"""Many networks at once: rows, gates, resumption after a kill, and tables that cannot be injected into."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli import many_networks
from cli.main import robustness
from cli.output import Console
from robustness.files import write_topology
from robustness.reporting.page import _values
from robustness.surveying import Survey
from robustness.surveying.networks import expand
from robustness.surveying.row import Row
from robustness.surveying.state import Journal
from robustness.surveying.tables import TABLES, cells

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    nets = tmp_path / "nets"
    (nets / "deep").mkdir(parents=True)
    write_topology(nx.wheel_graph(5), nets / "net10.json")
    write_topology(nx.complete_graph(7), nets / "net2.json")
    write_topology(nx.path_graph(4), nets / "deep" / "path.json")
    (nets / "notes.pdf").write_bytes(b"")
    (nets / ".hidden.json").write_bytes(b"")
    return nets


def run(*arguments: object) -> Result:
    return CliRunner().invoke(robustness, ["survey", *map(str, arguments)])


def test_rows_are_what_the_single_questions_answer(folder: Path) -> None:
    found = rb.survey([folder])
    assert [Path(row.network).name for row in found] == ["path.json", "net2.json", "net10.json"]
    assert [note.split(": ")[1] for note in found.notes] == ["1 file passed over, whose suffix names no format"]
    for row in found:
        graph = rb.read_topology(row.network)
        known, table = rb.determine_robustness(graph), rb.tolerance(graph)
        assert (row.r, row.r_at_most, row.s, row.s_at_most) == (known.r, known.r, known.s, known.s)
        assert row.guaranteed == {result.model: result.guaranteed for result in table.results}
        assert row.refuted == {result.model: result.refuted for result in table.results}
        assert (row.nodes, row.arcs, row.sha256, row.error) == (graph.n, graph.arc_count, graph.sha256, "")


def test_graphs_by_name_in_pairs_and_bare() -> None:
    wheel = nx.wheel_graph(5)
    for graphs, name in (({"w": wheel}, "w"), ([("w", wheel)], "w"), ([wheel], "0")):
        (row,) = rb.survey(graphs, models=[])
        assert (row.network, row.r, row.guaranteed) == (name, 2, {})


def test_names_are_text_and_each_network_has_its_own(folder: Path) -> None:
    path = folder / "net2.json"
    found = rb.survey({1: nx.path_graph(3), ("a", 2): nx.path_graph(4), "file": path}, models=[])  # type: ignore[dict-item]
    assert [(row.network, row.nodes) for row in found] == [("1", 3), ("('a', 2)", 4), ("file", 7)]
    assert "('a', 2)" in str(found)
    for same in ([("a", nx.path_graph(3)), ("a", nx.path_graph(4))], {1: nx.path_graph(3), "1": nx.path_graph(4)}):
        with pytest.raises(rb.InvalidParameter, match="two networks are named"):
            rb.survey(same)
    twice = rb.survey([path, str(path), path.parent], models=[])
    assert [Path(row.network).name for row in twice] == ["net2.json", "path.json", "net10.json"]
    assert sum("asked for twice, surveyed once" in note for note in twice.notes) == 2


@pytest.mark.parametrize("one", [nx.wheel_graph(5), rb.from_edges([(0, 1)], directed=False), 5, None])
def test_one_graph_is_not_many(one: object) -> None:
    with pytest.raises(rb.InvalidParameter, match="a survey is about many networks, not "):
        rb.survey(one)  # type: ignore[arg-type]


def test_what_is_no_graph_is_never_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_topology(nx.path_graph(3), "0.json")
    (row,) = rb.survey([None], reading=rb.files.ReadingOptions(format=".json"))
    assert "not NoneType" in row.error


@pytest.mark.parametrize(
    ("gate", "standings", "code"),
    [
        ([], ["", "", ""], 0),
        (["-r", 1], ["passed"] * 3, 0),
        (["-r", 2, "-s", 2], ["refuted", "passed", "passed"], 10),
        (["-r", 2, "-s", 6], ["refuted", "passed", "refuted"], 10),
        (["--require", 1, "--model", "malicious"], ["refuted", "passed", "passed"], 10),
        (["--require", 0], ["passed"] * 3, 0),
    ],
)
def test_the_exit_code_is_that_of_the_worst_gate(
    gate: list[object], standings: list[str], code: int, folder: Path
) -> None:
    outcome = run(folder, *gate, "--json")
    assert outcome.exit_code == code
    assert [row["gate"] for row in json.loads(outcome.stdout)["rows"]] == standings


def test_a_file_that_cannot_be_read_has_a_row_and_holds_nobody_up(folder: Path) -> None:
    (folder / "bad.json").write_text("{", encoding="utf-8")
    outcome = run(folder, "-r", 1, "--json")
    assert outcome.exit_code == 3
    rows = {Path(row["network"]).name: row for row in json.loads(outcome.stdout)["rows"]}
    assert rows["bad.json"]["gate"] == "error"
    assert "bad.json" in rows["bad.json"]["error"]
    assert rows["net2.json"]["gate"] == "passed"
    (folder / "cut.g6.gz").write_bytes(b"\x1f\x8b")
    (folder / "empty.s6").write_bytes(b"")
    many = run(folder, "-r", 1, "-o", folder.parent / "rows.csv")
    assert many.exit_code == 3
    assert many.stderr.count("warning: ") == 1 + 3  # a file is passed over, and three cannot be read
    assert f"warning: {folder / 'empty.s6'}: is empty" in many.stderr
    for k in range(2):
        (folder / f"gone{k}.json").write_text("", encoding="utf-8")
    assert "2 more could not be read" in run(folder, "-r", 1, "-o", folder.parent / "rows.csv").stderr
    assert run("gone.json").exit_code == 3
    assert run(folder / "deep" / "*.gml").exit_code == 3
    assert run().exit_code == 2


def test_undecided_within_the_limit_is_30_and_nobody_is_forgotten(tmp_path: Path) -> None:
    for k in range(3):
        write_topology(nx.random_regular_graph(10, 60, seed=k), tmp_path / f"{k}.json")
    outcome = run(tmp_path, "--no-models", "-r", 4, "--timeout", 1e-9, "--json")
    found = json.loads(outcome.stdout)
    assert (outcome.exit_code, len(found["rows"])) == (30, 3)
    assert all(row["gate"] == "undecided" for row in found["rows"])
    assert all(row["r"] <= 4 <= row["r_at_most"] for row in found["rows"])
    outcome = run(tmp_path, "--no-models", "--total-timeout", 1e-9, "--json")
    found = json.loads(outcome.stdout)
    assert (outcome.exit_code, len(found["rows"]) + len(found["missing"]), found["is_complete"]) == (30, 3, False)


def test_sources(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("topohub")
    monkeypatch.chdir(folder)
    assert expand(["*.json"]).names == ("net2.json", "net10.json")
    assert expand(["net2.json", "net2.json"]).notes == ("net2.json: asked for twice, surveyed once",)
    spellings = ["net2.json", "./net2.json", "deep/../net2.json", str(folder / "net2.json")]
    assert expand(spellings).names == ("net2.json",)
    assert expand(spellings).notes == tuple(f"{each}: asked for twice, surveyed once" for each in spellings[1:])
    assert len(expand(["topohub:sndlib/polska", "topohub:sndlib/geant", "net2.json"]).names) == 3
    assert "topohub:sndlib/geant" in expand(["topohub:sndlib/*"]).names
    with pytest.raises(rb.UnreadableTopology, match="the groups are"):
        expand(["topohub:nothing/*"])
    (folder / "empty").mkdir()
    with pytest.raises(rb.UnreadableTopology, match="holds no file of a known format"):
        expand(["empty"])
    (folder / "list").write_text("# two\nnet2.json\n\nnet10.json\n", encoding="utf-8")
    outcome = run("--from", "list", "--no-models", "--as", "csv")
    assert [row["network"] for row in csv.DictReader(io.StringIO(outcome.stdout))] == ["net2.json", "net10.json"]


def test_certificates_are_verified_by_the_kernel(folder: Path, tmp_path: Path) -> None:
    from certificates import verify

    for row in rb.survey([folder], models=[], certificates=tmp_path / "certs"):
        path = Path(row.certificate)
        graph = path.with_name(path.name.rpartition(f"-{row.r}-robust")[0] + ".graph")
        claim = verify(graph.read_bytes(), path.read_bytes())
        assert (claim.verdict, claim.r, claim.sha256) == ("robust", row.r, row.sha256)


class TestState:
    def test_rows_of_an_earlier_run_are_not_computed_again(
        self, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        state = tmp_path / "state"
        first = rb.survey([folder], state=state)
        monkeypatch.setattr("robustness.surveying.front.measure", lambda *_: 1 / 0)
        assert rb.survey([folder], state=state).rows == first.rows
        monkeypatch.undo()
        write_topology(nx.complete_graph(5), folder / "net2.json")
        again = {Path(row.network).name: row.r for row in rb.survey([folder], state=state)}
        assert again["net2.json"] == 3
        asked = rb.survey([folder], state=state, gate=rb.Gate(r=1))
        assert {row.gate for row in asked} == {"passed"}

    def test_a_cut_line_is_dropped_and_a_damaged_one_refused(self, folder: Path, tmp_path: Path) -> None:
        state = tmp_path / "state"
        rb.survey([folder], models=[], state=state)
        whole = state.read_bytes()
        state.write_bytes(whole[:-7])
        assert len(rb.survey([folder], models=[], state=state)) == 3
        assert state.read_bytes().count(b"\n") == 3
        first = whole.splitlines()[0]
        for kept in (0, 1, 16, 17, 18, 22, len(first) // 2, len(first)):
            state.write_bytes(first[:kept])
            assert len(rb.survey([folder], models=[], state=state)) == 3
            assert state.read_bytes().count(b"\n") == 3
        state.write_bytes(whole.replace(b'"r": ', b'"r": 1', 1))
        with pytest.raises(rb.UnreadableTopology, match="line 1: not a line of a survey's journal"):
            Journal(state)
        for other in ("something else\n", "some words", "cafe au lait", "0123456789abcdef {}"):
            state.write_text(other, encoding="utf-8")
            with pytest.raises(rb.UnreadableTopology, match="line 1"):
                Journal(state)
            assert state.read_text(encoding="utf-8") == other

    @pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGINT])
    def test_a_killed_run_goes_on_where_it_was(self, ending: signal.Signals, tmp_path: Path) -> None:
        nets, state = tmp_path / "nets", tmp_path / "state"
        nets.mkdir()
        for k in range(4):
            write_topology(nx.gnp_random_graph(12, 0.6, seed=k), nets / f"{k}.json")
        write_topology(nx.random_regular_graph(20, 90, seed=1), nets / "9.json")
        command = [sys.executable, "-m", "cli", "survey", str(nets), "--no-models", "--state", str(state), "--json"]
        with subprocess.Popen(
            command,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        ) as process:
            while not state.exists() or state.read_bytes().count(b"\n") < 4:
                assert process.poll() is None
                time.sleep(0.05)
            process.send_signal(ending)
            out, _ = process.communicate(timeout=60)
        if ending is signal.SIGINT:
            assert process.returncode == 130
            told = json.loads(out)
            assert [Path(row["network"]).stem for row in told["rows"]] == ["0", "1", "2", "3"]
            assert [Path(name).stem for name in told["missing"]] == ["9"]
        os.unlink(nets / "9.json")
        before = state.read_bytes()
        assert len(rb.survey([nets], models=[], state=state)) == 4
        assert state.read_bytes() == before


@pytest.mark.parametrize("command", ["survey", "report"])
@pytest.mark.parametrize("asked", [["."], ["*.json"], ["b.json"], ["--from", "list.txt"], ["sub/.."]])
def test_no_output_over_a_network_wherever_it_was_named(
    command: str, asked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("a.json", "b.json"):
        write_topology(nx.path_graph(3), name)
    (tmp_path / "list.txt").write_text("b.json\n", encoding="utf-8")
    before = (tmp_path / "b.json").read_bytes()
    arguments = [command, *asked, "-o", "b.json", "--no-models"]
    assert CliRunner().invoke(robustness, arguments).exit_code == 2
    assert (tmp_path / "b.json").read_bytes() == before
    assert CliRunner().invoke(robustness, [command, "a.json", "--from", "list.txt", "-o", "list.txt"]).exit_code == 2
    assert (tmp_path / "list.txt").read_text(encoding="utf-8") == "b.json\n"


def test_no_output_over_the_file_that_an_input_is_a_part_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    many = nx.to_graph6_bytes(nx.cycle_graph(5), header=False) + nx.to_graph6_bytes(nx.path_graph(4), header=False)
    (tmp_path / "many.g6").write_bytes(many)
    for arguments in (["mend", "many.g6#1", "-r", "2"], ["thin", "many.g6#1", "-r", "1"], ["survey", "many.g6#2"]):
        assert CliRunner().invoke(robustness, [*arguments, "-o", "many.g6"]).exit_code == 2
        assert (tmp_path / "many.g6").read_bytes() == many


def test_misuse() -> None:
    with pytest.raises(rb.InvalidParameter, match="jobs"):
        rb.survey([], jobs=0)
    with pytest.raises(rb.InvalidParameter, match="threat model"):
        rb.survey([], models=["friendly"])
    with pytest.raises(rb.InvalidParameter, match="r of a gate"):
        rb.Gate(r=-1)
    assert run("x.json", "-s", 2).exit_code == 2
    assert run("x.json", "--no-models", "--require", 1).exit_code == 2


def test_links_that_mend_are_told_where_asked() -> None:
    networks = {"ring": nx.cycle_graph(6), "complete": nx.complete_graph(6), "ends": nx.path_graph(4)}
    gate = rb.Gate(r=2)
    plain = rb.survey(networks, models=[], gate=gate)
    assert [(row.links, row.links_at_least) for row in plain.rows] == [(None, None)] * 3
    found = rb.survey(networks, models=[], gate=gate, mending=20.0)
    assert [(row.links, row.links_at_least) for row in found.rows] == [
        (len(rb.mend(networks["ring"], 2).links),) * 2,
        (0, 0),
        (len(rb.mend(networks["ends"], 2).links),) * 2,
    ]
    assert "  links  " in str(found)
    without = rb.survey({"ring": nx.cycle_graph(6)}, models=[], mending=20.0).rows[0]
    assert without.links == len(rb.mend(nx.cycle_graph(6), 2).links)
    for wrong in (-1.0, float("nan"), float("inf")):
        with pytest.raises(rb.InvalidParameter, match="mending is a number of seconds"):
            rb.survey(networks, mending=wrong)


def test_the_verdict_in_words_follows_the_table(folder: Path, tmp_path: Path) -> None:
    for more in ([], ["-o", tmp_path / "rows.csv"]):
        assert (
            "2 of 3 networks are 2-robust; 1 fails, with a counterexample."
            in run(folder, "--no-models", "-r", 2, *more).stderr
        )
    assert run(folder, "--no-models", "-r", 2, "--json").stderr.count("\n") == 1  # what was passed over


@pytest.mark.parametrize("columns", [20, 80])
def test_progress_stays_on_one_line_of_the_terminal(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", str(columns))
    line = many_networks._Line(Console())
    line.note(Row("a/long/" * 30), 1, 2)
    line.tick()
    shown = capsys.readouterr().err.rpartition("\x1b[K")[2]
    assert 15 < len(shown) < columns


def test_quiet_is_one_line(folder: Path) -> None:
    quiet = run(folder, "--no-models", "-r", 1, "-q")
    assert quiet.stdout.count("\n") == 1
    assert "networks" in quiet.stdout
    assert run(folder, "--no-models", "--as", "csv", "-q").stdout.startswith("network,")


def test_the_limit_for_the_whole_bounds_mending_too(monkeypatch: pytest.MonkeyPatch) -> None:
    from robustness.surveying import mended

    asked: list[float] = []

    def noted(*_: object, time_limit: float, **__: object) -> rb.MendResult:
        asked.append(time_limit)
        raise rb.InvalidParameter("not now")

    monkeypatch.setattr(mended, "mend", noted)
    rb.survey({"ring": nx.cycle_graph(6)}, models=[], mending=1000.0, total_time_limit=50.0)
    assert asked
    assert asked[0] <= 50.0


def test_a_bug_in_mending_is_no_missing_proposal(monkeypatch: pytest.MonkeyPatch) -> None:
    from robustness.surveying import mended

    def broken(*_: object, **__: object) -> None:
        raise rb.InternalError("please report")

    monkeypatch.setattr(mended, "mend", broken)
    with pytest.raises(rb.InternalError):
        rb.survey({"ring": nx.cycle_graph(6)}, models=[], mending=1.0)


def test_no_table_for_people_tells_of_less_than_nobody() -> None:
    apart = Row("apart", nodes=4, arcs=0, directed=False, r=0, r_at_most=0, s=4, s_at_most=4)
    survived = {"promised": (-1, 0), "open": (-1, 3), "unknown": (-1, None), "some": (0, 1)}
    row = replace(
        apart,
        guaranteed={name: low for name, (low, _) in survived.items()},
        refuted={name: refuted for name, (_, refuted) in survived.items()},
    )
    assert cells([row], list(survived))[1][5:9] == ["none", "none..2", "?", "0"]
    assert [_values(cell) for cell in ("none", "none..2", "?", "0")] == [
        " data-value='-1'", " data-upper='2' data-value='-1'", " data-value=''", " data-value='0'",
    ]  # fmt: skip
    for name in ("table", "markdown"):
        assert "-1" not in TABLES[name]([row], list(survived))


@pytest.mark.parametrize(
    ("gates", "shown"),
    [(["", ""], "2 networks"), (["passed"], "1 network, passed"), (["", "refuted"], "2 networks, refuted")],
)
def test_nothing_has_passed_where_nothing_was_asked(gates: list[str], shown: str) -> None:
    assert repr(Survey(tuple(Row(str(k), gate=gate) for k, gate in enumerate(gates)), ())) == f"<Survey: {shown}>"


def test_the_suffix_tells_the_kind(folder: Path, tmp_path: Path) -> None:
    for suffix, start in ((".csv", "network,"), (".jsonl", "{"), (".xml", "<testsuite"), (".md", "| network")):
        target = tmp_path / f"rows{suffix}"
        assert run(folder, "--no-models", "-o", target).exit_code == 0
        assert target.read_text(encoding="utf-8").startswith(start)
