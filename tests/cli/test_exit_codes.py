"""Every exit code, and every way into it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import NoReturn

import networkx as nx
import pytest
from click.testing import CliRunner

import certificates
from cli.exit_codes import ExitCode
from cli.main import COMMANDS, robustness
from robustness import errors
from robustness.__main__ import main as entry
from robustness.files import write_topology

ROOT = Path(__file__).parents[2]
SQUARE = str(ROOT / "tests" / "data" / "square.json")


def start(*arguments: str, **options: object) -> subprocess.Popen[bytes]:
    """Start the command line; Ctrl-C reaches it even where the tests run in the background, which ignores it."""
    heard = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **heard, **options}
    return subprocess.Popen([sys.executable, "-m", "cli", *arguments], cwd=ROOT, **pipes)


@pytest.fixture
def hard(tmp_path: Path) -> str:
    """A graph that no algorithm settles in the time a test takes."""
    path = tmp_path / "hard.json"
    write_topology(nx.gnp_random_graph(60, 0.5, seed=1), path)
    return str(path)


def test_the_table_is_the_contract() -> None:
    assert {code.name: int(code) for code in ExitCode} == {
        "DONE": 0,
        "INTERNAL_ERROR": 1,
        "USAGE": 2,
        "BAD_INPUT": 3,
        "REFUTED": 10,
        "UNDECIDED": 30,
        "INTERRUPTED": 130,
    }


def test_only_known_verdicts_have_a_code() -> None:
    codes = {word: int(ExitCode.of_verdict(word)) for word in ("robust", "determined", "not-robust", "undecided")}
    assert codes == {"robust": 0, "determined": 0, "not-robust": 10, "undecided": 30}
    with pytest.raises(KeyError):
        ExitCode.of_verdict("safe")


@pytest.mark.parametrize(
    ("problem", "code"),
    [
        (errors.InvalidGraph("x"), 3),
        (errors.InvalidParameter("x"), 2),
        (errors.UnreadableTopology("x"), 3),
        (errors.MissingTopology("x"), 3),
        (errors.MissingExtra("x"), 2),
        (errors.Undecided("x"), 30),
        (errors.InternalError("x"), 1),
        (certificates.RejectedCertificate("x"), 10),
        (certificates.MalformedCertificate("x"), 3),
        (certificates.MalformedGraph("x"), 3),
        (certificates.Misuse("x"), 1),
        (KeyboardInterrupt(), 130),
        (PermissionError(13, "Permission denied", "out.json"), 2),
        (OSError(5, "Input/output error"), 1),
        (TimeoutError("of somebody else"), 1),
        (MemoryError(), 30),
        (ZeroDivisionError("x"), 1),
    ],
    ids=lambda value: type(value).__name__,
)
def test_exceptions_end_in_one_line_and_their_code(
    problem: BaseException, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: str) -> None:
        raise problem

    monkeypatch.setattr("cli.check.load_graph", fail)
    quiet = CliRunner().invoke(robustness, ["check", SQUARE])
    assert quiet.exit_code == code == ExitCode.of_exception(problem)
    assert quiet.stdout == ""
    assert quiet.stderr.count("\n") == 1
    assert "Traceback" not in quiet.stderr
    told = CliRunner().invoke(robustness, ["check", SQUARE, "-v"])
    assert told.exit_code == code
    assert "Traceback (most recent call last)" in told.stderr


def test_every_error_class_is_covered_above() -> None:
    kinds = errors.RobustnessError.__subclasses__()
    ours = {errors.RobustnessError, *kinds, *(kind for each in kinds for kind in each.__subclasses__())}
    assert {getattr(errors, name) for name in errors.__all__} == ours


def test_done() -> None:
    assert CliRunner().invoke(robustness, ["check", SQUARE]).exit_code == 0
    assert CliRunner().invoke(robustness, ["check", SQUARE, "-r", "1"]).exit_code == 0


def test_refuted() -> None:
    assert CliRunner().invoke(robustness, ["check", SQUARE, "-r", "2"]).exit_code == 10


def test_undecided(hard: str) -> None:
    for question in ([], ["-r", "14"]):
        arguments = ["check", hard, "--algorithm", "exhaustive", "--timeout", "0.01", "--json", *question]
        outcome = CliRunner().invoke(robustness, arguments)
        assert outcome.exit_code == 30
        assert json.loads(outcome.stdout)["verdict"] == "undecided"


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["no-such-command"],
        ["check"],
        ["check", SQUARE, SQUARE],
        ["check", SQUARE, "--no-such-option"],
        ["check", SQUARE, "-s", "1"],
        ["check", SQUARE, "-r", "-1"],
        ["check", SQUARE, "-r", "1.5"],
        ["check", SQUARE, "-r", "1", "-s", "0"],
        ["check", SQUARE, "-r", "1", "-s", "5"],
        ["check", SQUARE, "--algorithm", "guess"],
        ["check", SQUARE, "--jobs", "0"],
        ["check", SQUARE, "--seed", "-1"],
        *(["check", SQUARE, "--timeout", value] for value in ("0", "-1", "nan", "inf", "soon")),
        ["--color", "blue", "check", SQUARE],
    ],
    ids=" ".join,
)
def test_usage(arguments: list[str]) -> None:
    outcome = CliRunner().invoke(robustness, arguments)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert outcome.stderr


@pytest.mark.parametrize("name", ["gone.json", "gone.xyz", "topohub:topozoo/Gone", str(ROOT)])
def test_bad_input(name: str) -> None:
    outcome = CliRunner().invoke(robustness, ["check", name])
    assert outcome.exit_code == 3
    assert outcome.stderr.startswith(f"error: {name}: ")
    assert outcome.stderr.count("\n") == 1


def test_an_internal_error_says_that_it_is_no_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robustness.decision.front.determine_robustness", lambda *_, **__: 1 / 0)
    outcome = CliRunner().invoke(robustness, ["check", SQUARE])
    assert outcome.exit_code == 1
    assert outcome.stderr.startswith("internal error, not a verdict: ZeroDivisionError")


def test_a_contradiction_between_profile_and_r_is_an_internal_error(monkeypatch: pytest.MonkeyPatch) -> None:
    for profile in ({1: 3, 2: 0}, {1: 4, 2: 1}):
        monkeypatch.setattr("robustness.decision.front.robustness_profile", lambda *_, table=profile, **__: table)
        outcome = CliRunner().invoke(robustness, ["check", SQUARE, "--algorithm", "exhaustive"])
        assert outcome.exit_code == 1
        assert "contradicts" in outcome.stderr


@pytest.mark.parametrize("question", [[], ["-r", "14"]], ids=["determine", "decide"])
def test_ctrl_c_prints_the_bounds_and_ends_soon(hard: str, question: list[str]) -> None:
    for patience in (2, 8, 32):
        with start("check", hard, "--json", "--algorithm", "exhaustive", *question) as process:
            time.sleep(patience)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120)  # without the signal: years
        assert (process.returncode, err[:12]) == (130, b"interrupted:")
        document = json.loads(
            out or b'{"schema": "none yet"}'
        )  # on a busy machine the command may not have been imported
        if document["schema"] not in ("robustness/error/1", "none yet"):  # nor the search begun
            break
    assert document["verdict"] == "undecided"
    assert 0 <= document["bounds"]["lower"] <= document["bounds"]["upper"] <= 30
    assert err.decode().startswith("interrupted:")
    assert b"Traceback" not in err


def test_ctrl_c_before_the_command_is_there_is_told_in_a_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*_: object, **__: object) -> NoReturn:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("importlib.import_module", interrupt)
        with pytest.raises(SystemExit) as end:
            entry()
    assert end.value.code == 130
    assert capsys.readouterr().err == "interrupted: nothing is claimed\n"
    monkeypatch.setattr("click.Group.parse_args", interrupt)
    outcome = CliRunner().invoke(robustness, ["check", SQUARE])
    assert (outcome.exit_code, outcome.stderr) == (130, "interrupted: nothing is claimed\n")


def test_a_reader_that_goes_away_changes_no_code() -> None:
    for question, code in ([], 0), (["-r", "2"], 10):
        with start("check", SQUARE, *question) as process:
            assert process.stdout is not None
            process.stdout.close()
            assert process.stderr is not None
            assert process.stderr.read() == b""
        assert process.returncode == code


def test_a_result_that_cannot_be_written_is_no_success() -> None:
    with open(os.devnull, "rb") as unwritable, start("check", SQUARE, stdout=unwritable) as process:
        _, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert b"Bad file descriptor" in err
    assert b"Traceback" not in err


@pytest.mark.parametrize("closed", [0, 1, 2])
def test_a_closed_stream_is_no_crash(closed: int) -> None:
    with start("check", SQUARE, preexec_fn=lambda: os.close(closed)) as process:
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert err == b""
    assert out.startswith(b"determined:") == (closed != 1)


def test_a_pipe_that_nobody_writes_to_is_not_waited_for(tmp_path: Path) -> None:
    for suffix, command in ((".json", ["check"]), (".csv", ["joint", "-r", "2"])):
        pipe = tmp_path / f"pipe{suffix}"
        os.mkfifo(pipe)
        outcome = CliRunner().invoke(robustness, [command[0], str(pipe), *command[1:]])
        assert (outcome.exit_code, "pipe it into - instead" in outcome.stderr) == (3, True)


@pytest.mark.parametrize(
    "arguments", [["check", "-"], ["joint", "-", "-r", "2"], ["tolerance", "-"], ["survey", "--from", "-"]]
)
def test_a_closed_input_is_bad_input(arguments: list[str]) -> None:
    line = " ".join([sys.executable, "-m", "cli", *arguments, "<&-"])
    done = subprocess.run(["sh", "-c", line], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (3, "", 1)
    assert "standard input" in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only where the system has a full device")
@pytest.mark.parametrize("arguments", [["check", SQUARE], ["check", SQUARE, "--json"], ["tolerance", SQUARE], ["-h"]])
def test_a_full_disk_at_standard_output_is_told(arguments: list[str]) -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "cli", *arguments], cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True,
            timeout=60, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert "internal error" not in done.stderr


def test_a_command_that_is_mistyped_is_guessed() -> None:
    outcome = CliRunner().invoke(robustness, ["chek", SQUARE])
    assert outcome.exit_code == 2
    assert "did you mean check" in outcome.stderr


def test_certify_says_not_robust_where_check_does(tmp_path: Path) -> None:
    for r in (3, 2**31 + 1, 10**20):
        code = CliRunner().invoke(robustness, ["check", SQUARE, "-r", str(r)]).exit_code
        outcome = CliRunner().invoke(robustness, ["certify", SQUARE, "-r", str(r), "-o", str(tmp_path / "c")])
        assert outcome.exit_code == code == 10


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
@pytest.mark.parametrize("command", ["--help", "--version", *(f"{name} --help" for name in COMMANDS), "build --list"])
def test_help_on_a_full_disk(command: str) -> None:
    with open("/dev/full", "wb") as full:
        process = start(*command.split(), stdout=full)
        _, said = process.communicate(timeout=60)
    assert process.returncode == ExitCode.USAGE
    assert said == b"error: cannot write standard output: No space left on device\n"


def test_more_threads_than_the_system_has(hard: str, monkeypatch: pytest.MonkeyPatch) -> None:
    begin, begun = threading.Thread.start, []

    def refuse_the_fifth(thread: threading.Thread) -> None:
        if len(begun) == 4:
            raise RuntimeError("can't start new thread")
        begun.append(thread)
        begin(thread)

    monkeypatch.setattr(threading.Thread, "start", refuse_the_fifth)
    outcome = CliRunner().invoke(robustness, ["check", hard, "-r", "14", "--jobs", "3000", "--timeout", "1"])
    # With the threads there are, it is decided in time or not: it is no error.
    assert outcome.exit_code in (ExitCode.UNDECIDED, ExitCode.DONE), outcome.output
    refused = CliRunner().invoke(robustness, ["check", hard, "-r", "14", "--jobs", "2"])
    assert refused.exit_code == ExitCode.USAGE
    assert refused.stderr == "error: can't start new thread: give fewer --jobs\n"


def test_a_number_that_no_graph_has_is_refused_before_work() -> None:
    for number in ("10000001", "9" * 30):
        outcome = CliRunner().invoke(robustness, ["build", "wheel", "--n", number])
        assert outcome.exit_code == ExitCode.USAGE
        assert "n is at most 10000000" in outcome.stderr


def test_an_attack_is_played_within_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cli.attack._carry_out", lambda *_: time.sleep(5))
    outcome = CliRunner().invoke(robustness, ["attack", SQUARE, "-f", "1", "--timeout", "0.1"])
    assert outcome.exit_code == ExitCode.UNDECIDED


@pytest.mark.parametrize(
    ("asked", "code"),
    [
        (["check", "missing.json", "--json"], 3),
        (["check", "--json", "--no-such-option"], 2),
        (["chek", "--json"], 2),
        (["tolerance", "--json", SQUARE, "--period", "2"], 2),
        (["survey", "--json"], 2),
    ],
)
def test_with_json_an_error_is_a_document_on_standard_output(asked: list[str], code: int) -> None:
    outcome = CliRunner().invoke(robustness, asked)
    assert outcome.exit_code == code
    document = json.loads(outcome.stdout)
    assert list(document) == ["schema", "exit_code", "error"]
    assert (document["schema"], document["exit_code"]) == ("robustness/error/1", code)
    assert document["error"] in outcome.stderr
    without = [word for word in asked if word != "--json"]
    assert CliRunner().invoke(robustness, without).stdout == ""


@pytest.mark.parametrize("arguments", [["simulate", SQUARE], ["simulate", "--experiment", "setting-1"]])
def test_a_limit_before_any_answer_is_undecided_and_no_error(arguments: list[str]) -> None:
    """The first word, and the verdict in JSON, are as where a limit leaves an answer."""
    asked = [*arguments, "--timeout", "1e-9"]
    outcome = CliRunner().invoke(robustness, asked)
    assert (outcome.exit_code, outcome.stdout) == (30, "")
    assert outcome.stderr.splitlines()[-1].startswith("undecided: the time limit came")
    assert "error: " not in outcome.stderr
    document = json.loads(CliRunner().invoke(robustness, [*asked, "--json"]).stdout)
    assert (document["exit_code"], document["verdict"]) == (30, "undecided")
    assert document["error"].startswith("the time limit came")


@pytest.mark.parametrize("asked", [["check", SQUARE], ["tolerance", SQUARE], ["mend", SQUARE, "-r", "2"]])
def test_q_is_one_line(asked: list[str]) -> None:
    assert CliRunner().invoke(robustness, [*asked, "-q"]).stdout.count("\n") == 1


def test_one_spelling_for_one_thing() -> None:
    """What several commands have has one name, and no help shows markup."""
    for name in COMMANDS:
        text = CliRunner().invoke(robustness, [name, "--help"]).stdout
        assert "--picture" not in text
        assert "--time-limit" not in text
        assert re.findall(r"``|:\w+:`|\\b|\*\*", text) == []
