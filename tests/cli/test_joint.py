"""``robustness joint``: exit codes, what it prints, key by key, and the picture."""

from __future__ import annotations

import json
import re
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.interruption import Overrun
from cli.main import robustness
from robustness.definitions import is_violation
from robustness.files import write_topology
from robustness.results import RobustnessResult
from robustness.time_varying import JointResult, TimeVaryingGraph, encode_sequence, read_sequence, unions

#: Node k is heard by all others at step k; 2-robust over every 3 steps, 3-robust over every 5.
STAR = TimeVaryingGraph.from_arcs(range(5), [[(k, v) for v in range(5) if v != k] for k in range(5)], period=5)


def joint(*arguments: str, sequence: TimeVaryingGraph = STAR) -> Result:
    return CliRunner().invoke(robustness, ["joint", "-", *arguments], input=encode_sequence(sequence))


def document(*arguments: str) -> dict[str, object]:
    outcome = joint("--json", *arguments)
    assert outcome.stdout.count("\n") == 1
    return json.loads(outcome.stdout)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["-r", "2"], 0),
        (["-r", "4"], 10),
        (["-r", "2", "--window", "3"], 0),
        (["-r", "2", "--window", "2"], 10),
        (["-r", "2", "--jobs", "2", "--seed", "7"], 0),
        (["-r", "2", "--jobs", "0"], 2),
        (["-r", "2", "--timeout", "1e-9"], 30),
        (["-r", "2", "-s", "6"], 2),
        (["-r", "-1"], 2),
        ([], 2),
        (["-r", "2", "--window", "0"], 2),
        (["-r", "2", "--period", "6"], 2),
        (["-r", "2", "--step", "3"], 2),
        (["-r", "2", "--both-ways"], 2),
        (["-r", "2", "--all-windows"], 2),
        (["-r", "2", "--plot", "joint.nonsense"], 2),
    ],
)
def test_exit_codes(arguments: list[str], code: int) -> None:
    assert joint(*arguments).exit_code == code


def test_a_bad_sequence_is_one_line_and_exit_3(tmp_path: Path) -> None:
    path = tmp_path / "steps.jsonl"
    path.write_text('{"nodes": [0, 1]}\n[[0, 1]]\n[[0, 5]]\n')
    outcome = CliRunner().invoke(robustness, ["joint", str(path), "-r", "1"])
    assert (outcome.exit_code, outcome.stdout) == (3, "")
    assert re.fullmatch(r"error: .*steps\.jsonl: step 1 \(line 3\): .* 5 is none.*\n", outcome.stderr)


def test_json_key_by_key() -> None:
    found = document("-r", "2", "--tau", "3", "--curve")
    seconds, stats, shorter = (found.pop(key) for key in ("seconds", "stats", "shorter_fails"))
    assert found == {
        "schema": "robustness/joint/1",
        "sequence": {"nodes": 5, "steps": 5, "period": 5, "arcs": 20, "directed": True, "read_as": None},
        "verdict": "robust",
        "r": 2,
        "s": 1,
        "asked_window": None,
        "window": 3,
        "at_least": 3,
        "tau": 3,
        "within_tau": True,
        "violation": None,
        "windows": {"length": 3, "decided": 5, "unions": 5, "failing": []},
        "curve": {"1": 1, "2": 3, "3": 5},
        "reason": "",
    }
    assert 0 <= seconds < 60
    assert stats["windows"] > 5
    assert shorter["length"] == 2
    assert_violation(shorter, 2)


def assert_violation(found: dict[str, object], r: int) -> None:
    graph = STAR.union(found["start"], found["length"])
    assert is_violation(graph, *(graph.ids(found["witness"][side]) for side in ("S1", "S2")), r, 1)


def test_json_of_a_refutation() -> None:
    found = document("-r", "2", "--window", "2", "--all-windows")
    assert (found["verdict"], found["window"], found["asked_window"]) == ("not-robust", None, 2)
    assert (found["violation"]["start"], found["violation"]["length"]) == (0, 2)
    assert_violation(found["violation"], 2)
    assert found["windows"] == {"length": 2, "decided": 5, "unions": 5, "failing": [0, 1, 2, 3, 4]}
    never = document("-r", "3", "--period", "1")
    assert (never["violation"]["start"], never["violation"]["length"], never["curve"]) == (4, 1, None)
    assert_violation(never["violation"], 3)


def test_json_of_no_answer() -> None:
    found = document("-r", "2", "--timeout", "1e-9", "--curve", "--tau", "9")
    assert (found["verdict"], found["window"], found["curve"]) == ("undecided", None, None)
    assert (found["within_tau"], found["reason"]) == (None, "the time limit was reached")


def test_text_of_the_smallest_window() -> None:
    lines = joint("-r", "2", "--tau", "2", "--curve").stdout.splitlines()
    assert lines[0] == "robust: the network is jointly 2-robust over every 3 steps; no smaller number will do"
    assert lines[1].startswith("one step shorter fails: steps ")
    assert [line.split(" = ")[0].strip() for line in lines[2:4]] == ["S1", "S2"]
    assert lines[4] == "tau        3 > 2: the window is longer than the delay bound"
    assert lines[5] == "sequence   -: 5 nodes, a period of 5 steps: its windows wrap"
    assert lines[7:9] == ["r          1 2 3", "smallest L 1 3 5"]


def test_text_of_a_refutation() -> None:
    lines = joint("-r", "2", "--window", "2").stdout.splitlines()
    assert lines[0] == "not robust: the network is not jointly 2-robust over every 2 steps"
    assert lines[1] == "violating window: steps 0 to 1"
    lines = joint("-r", "4", "--tau", "9").stdout.splitlines()
    assert lines[0].endswith(
        "4-robust: no window of any length will do, as even the union of one whole period is not robust enough"
    )
    assert "tau        no window, so none within the delay bound" in lines


def test_text_of_other_corners() -> None:
    trace = TimeVaryingGraph.from_arcs(range(2), [[(0, 1)]])
    short = joint("-r", "1", "-s", "1", "--window", "2", sequence=trace).stdout
    assert "no window of 2 steps fits in a trace of 1 step" in short
    empty = TimeVaryingGraph.from_arcs(range(2), [[]])
    single = joint("-r", "1", "-s", "2", "--window", "1", "--tau", "1", sequence=empty).stdout.splitlines()
    assert single[:2] == [
        "not robust: the network is not jointly (1,2)-robust over every step",
        "violating window: step 0",
    ]
    assert (
        "tau        1 <= 1: the window is within the delay bound"
        in joint("-r", "1", "--tau", "1", sequence=trace).stdout
    )
    assert "smallest L none" in joint("-r", "1", "--curve", sequence=empty).stdout
    at_once = joint("-r", "1", sequence=trace).stdout.splitlines()
    assert at_once[0] == "robust: the network is jointly 1-robust over every step"
    assert "curve      not known" in joint("-r", "2", "--timeout", "1e-9", "--curve").stdout
    undecided = joint("-r", "2", "--timeout", "1e-9").stdout
    first = "undecided: whether the network is jointly 2-robust is not known (the time limit was reached)"
    assert undecided.splitlines()[0] == first
    prefix = joint("-r", "1", "--period", "1").stdout
    assert "4 steps, then a period of 1 step: its windows wrap" in prefix


def test_directory_and_contact_trace(tmp_path: Path) -> None:
    folder = tmp_path / "steps"
    folder.mkdir()
    for k in range(3):
        write_topology(nx.complete_graph(4), folder / f"k{k}.json")
    outcome = CliRunner().invoke(robustness, ["joint", str(folder), "-r", "2"])
    assert outcome.exit_code == 0
    assert "a finite trace of 3 steps: its windows do not wrap" in outcome.stdout
    contacts = tmp_path / "contacts.csv"
    contacts.write_text("time,source,target\n0,a,b\n0.5,b,c\n1.0,c,a\n")
    outcome = CliRunner().invoke(
        robustness,
        ["joint", str(contacts), "-r", "2", "--step", "0.5", "--both-ways", "--period", "3", "--json"],
    )
    assert outcome.exit_code == 0
    assert json.loads(outcome.stdout)["window"] == 3


@pytest.mark.parametrize("arguments", [["-r", "2"], ["-r", "2", "--window", "2"], ["-r", "4"], ["-r", "1"]])
def test_picture(tmp_path: Path, arguments: list[str]) -> None:
    path = tmp_path / "joint.svg"
    outcome = joint(*arguments, "--plot", str(path))
    assert outcome.exit_code in (0, 10)
    assert outcome.stderr == f"wrote {path}\n"
    first = path.read_bytes()
    assert b"<svg" in first
    joint(*arguments, "--plot", str(path), "-q")
    assert path.read_bytes() == first, "the same question gives the same file"


@pytest.mark.parametrize(
    ("arguments", "length", "failing"),
    [(["-r", "2"], 2, 5), (["-r", "2", "--window", "2"], 2, 5), (["-r", "4"], 5, 5), (["-r", "1"], 1, 0)],
)
def test_what_the_picture_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], length: int, failing: int
) -> None:
    drawn: list[JointResult] = []
    monkeypatch.setattr("robustness.figures.joint.draw_joint", lambda *_, shown: drawn.append(shown))
    joint(*arguments, "--plot", str(tmp_path / "joint.svg"))
    (shown,) = drawn
    assert (shown.examined, len(shown.failing_starts()), len(shown.window_unions)) == (length, failing, 5)


def test_picture_of_every_verdict_a_prefix_and_a_wrapped_window(tmp_path: Path) -> None:
    wheel, empty = nx.wheel_graph(5), nx.empty_graph(5)
    sequence = TimeVaryingGraph([wheel, empty, wheel, wheel, empty], period=3)
    path = tmp_path / "joint.png"
    outcome = joint("-r", "2", "--window", "1", "--plot", str(path), sequence=sequence)
    assert outcome.exit_code == 10
    assert path.read_bytes().startswith(b"\x89PNG")
    assert joint("-r", "2", "--timeout", "1e-9", "--plot", str(path)).exit_code == 30
    wrapped = TimeVaryingGraph([empty, wheel, empty], period=3)
    outcome = joint("-r", "2", "--window", "2", "--plot", str(path), sequence=wrapped)
    assert "violating window: steps 2 to 3" in outcome.stdout


@pytest.mark.parametrize(
    ("name", "message"), [("nowhere/joint.png", "error: cannot write"), ("joint.odd", "error: a picture's suffix is")]
)
def test_a_picture_that_cannot_be_written_is_a_usage_error(tmp_path: Path, name: str, message: str) -> None:
    outcome = joint("-r", "2", "--plot", str(tmp_path / name))
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith(message)
    assert outcome.stdout == "", "no work is done for it"


def test_without_matplotlib_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    outcome = joint("-r", "2", "--plot", str(tmp_path / "joint.png"))
    assert outcome.exit_code == 2
    assert "graph-robustness[plot]" in outcome.stderr


def test_an_interrupt_is_130(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("robustness.time_varying.unions.check_within", interrupted)
    outcome = joint("-r", "2")
    assert outcome.exit_code == 130
    assert outcome.stdout.startswith("undecided: ")
    assert "nothing else is claimed" in outcome.stderr


def test_a_compiler_that_does_not_stop_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    def endless(*_: object, **__: object) -> None:
        raise Overrun

    monkeypatch.setattr("cli.query.interruptibly", endless)
    outcome = joint("-r", "2", "--window", "3", "--timeout", "1", "--tau", "4", "--json")
    found = json.loads(outcome.stdout)
    assert (outcome.exit_code, found["verdict"], found["asked_window"]) == (30, "undecided", 3)
    assert (found["within_tau"], found["curve"], found["stats"]) == (None, None, {})
    assert joint("-r", "2").stdout.startswith("undecided: ")


def test_an_undecided_union_keeps_what_is_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    front = unions.check_within

    def stubborn(graph: rb.Digraph, r: int, s: int, *options: object) -> RobustnessResult:
        if graph.arc_count == 12:
            return RobustnessResult(rb.Verdict.UNDECIDED, r, s, stats={"reason": "too hard"})
        return front(graph, r, s, *options)

    monkeypatch.setattr(unions, "check_within", stubborn)
    outcome = joint("-r", "2")
    assert outcome.exit_code == 30
    assert "is not known (too hard); fewer than 3 steps will not do" in outcome.stdout


def test_what_the_command_reads_the_library_reads(tmp_path: Path) -> None:
    path = tmp_path / "star.json"
    path.write_bytes(encode_sequence(STAR))
    sequence = read_sequence(path)
    assert rb.Verdict.ROBUST.value == document("-r", "3")["verdict"]
    assert sequence.union(0, 5) == STAR.union(0, 5)
