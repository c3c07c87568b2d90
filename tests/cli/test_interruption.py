"""Work that can be stopped whatever it does, and a process that ends although the work does not."""

from __future__ import annotations

import itertools
import json
import os
import pkgutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner

import robustness as rb
from cli import interruption
from cli.interruption import Overrun, end_process, interruptibly
from cli.main import robustness
from robustness.files import decode_topology

ROOT = Path(__file__).parents[2]
SQUARE = str(ROOT / "tests" / "data" / "square.json")

#: Work that swallows every exception, as a compiler's callback does, and then waits in C for ever.
STUBBORN = """
import threading, time
import robustness.decision.front
from cli.main import main

def stubborn(*arguments, **options):
    print("working", file=__import__("sys").stderr, flush=True)
    while True:
        try:
            time.sleep(60)
        except BaseException:
            pass

robustness.decision.front.determine_robustness = stubborn
main()
"""


def test_results_and_errors_pass_through() -> None:
    assert interruptibly(lambda: 7) == 7
    assert interruptibly(lambda: 7, limit=0.0) == 7
    with pytest.raises(ZeroDivisionError):
        interruptibly(lambda: 1 // 0)
    with pytest.raises(KeyboardInterrupt):
        interruptibly(lambda: (_ for _ in ()).throw(KeyboardInterrupt))


def test_the_work_runs_beside_the_main_thread() -> None:
    assert interruptibly(threading.current_thread) is not threading.current_thread()


def test_work_that_does_not_keep_its_limit_is_left_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interruption, "GRACE", 0.05)
    release, ticks = threading.Event(), []
    with pytest.raises(Overrun):
        interruptibly(lambda: release.wait(60), 0.7, lambda: ticks.append(1))
    assert ticks == [1]
    release.set()


def test_an_overrun_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interruption, "GRACE", 0.0)
    release = threading.Event()
    for name, question in ("determine_robustness", []), ("check_rs_robustness", ["-r", "2"]):
        monkeypatch.setattr(f"robustness.decision.front.{name}", lambda *_, **__: release.wait(60))
        outcome = CliRunner().invoke(robustness, ["check", SQUARE, "--json", "--timeout", "0.1", *question])
        assert outcome.exit_code == 30
        found = json.loads(outcome.stdout)
        assert (found["verdict"], found["bounds"]["lower"], found["bounds"]["upper"]) == ("undecided", 1, 2)
    release.set()


def test_a_profile_that_overruns_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interruption, "GRACE", 0.0)
    release = threading.Event()
    monkeypatch.setattr("robustness.decision.front.robustness_profile", lambda *_, **__: release.wait(60))
    outcome = CliRunner().invoke(robustness, ["check", SQUARE, "--json", "--timeout", "2", "--algorithm", "exhaustive"])
    release.set()
    assert outcome.exit_code == 0
    found = json.loads(outcome.stdout)
    assert (found["verdict"], found["r"], found["profile"]) == ("determined", 1, None)


def test_ctrl_c_ends_the_process_although_the_work_goes_on() -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", STUBBORN, "check", SQUARE, "--json"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    with process:
        assert process.stderr is not None
        assert process.stderr.readline() == b"working\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert json.loads(out)["bounds"]["upper"] == 2
    assert err.startswith(b"interrupted: ")


def test_the_process_ends_in_the_code_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interruption, "_abandoned", [])  # of tests before in this process
    with pytest.raises(SystemExit) as end:
        end_process(10)
    assert end.value.code == 10
    ends: list[int] = []
    monkeypatch.setattr(os, "_exit", ends.append)
    release = threading.Event()
    with pytest.raises(Overrun):
        interruptibly(lambda: release.wait(60), -1.0)
    with pytest.raises(SystemExit):
        end_process(30)
    release.set()
    assert ends == [30]


def test_ctrl_c_in_a_run_tells_how_far_it_came(monkeypatch: pytest.MonkeyPatch) -> None:
    from robustness.simulation.engine import Batch

    act = Batch.act

    def stopped(self: Batch, step: int) -> None:
        if step == 7:
            raise KeyboardInterrupt
        act(self, step)

    monkeypatch.setattr(Batch, "act", stopped)
    outcome = CliRunner().invoke(robustness, ["simulate", SQUARE, "-f", "0", "--steps", "20", "--adversary", "sine"])
    assert outcome.exit_code == 130
    assert "interrupted at step 7 of 20 (spread " in outcome.stderr


def test_ctrl_c_after_the_answer_keeps_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    trace = tmp_path / "trace.csv"
    trace.write_text("time,source,target\n0,a,b\n0,b,a\n1,b,c\n1,c,b\n")
    monkeypatch.setattr("robustness.time_varying.joint_curve", stopped)
    outcome = CliRunner().invoke(robustness, ["joint", str(trace), "-r", "1", "--curve", "--json"])
    assert outcome.exit_code == 130
    assert json.loads(outcome.stdout)["verdict"] == "robust"

    monkeypatch.setattr("robustness.graph_search.find_graph", stopped)
    outcome = CliRunner().invoke(robustness, ["find", "-n", "6", "-p", "2-robust", "--json"])
    assert outcome.exit_code == 130
    assert json.loads(outcome.stdout)["stats"]["reason"] == "interrupted"


def stop(where: str, when: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the call number ``when`` of the function that ``where`` names stop as Ctrl-C stops it."""
    asked = pkgutil.resolve_name(where)
    calls = itertools.count(1)

    def stopped(*arguments: object, **options: object) -> object:
        if next(calls) == when:
            raise KeyboardInterrupt
        return asked(*arguments, **options)

    monkeypatch.setattr(where, stopped)


def test_ctrl_c_in_find_keeps_the_sizes_that_do_not_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    stop("robustness.graph_search.front._find_on", 4, monkeypatch)
    outcome = CliRunner().invoke(robustness, ["find", "-n", "3..9", "-p", "4-robust"])
    assert outcome.exit_code == 130
    assert outcome.stdout == "undecided: interrupted; none on 3..5 nodes\n"
    assert "nothing else is claimed" in outcome.stderr


def test_ctrl_c_in_find_keeps_the_graph_that_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    stop("robustness.graph_search.synthesis._propose_until_it_fits", 2, monkeypatch)
    outcome = CliRunner().invoke(robustness, ["find", "-n", "8", "-p", "2-robust", "--fewest-edges", "--json"])
    found = json.loads(outcome.stdout)
    assert (outcome.exit_code, found["verdict"], found["has_fewest_edges"]) == (130, "undecided", False)
    graph = decode_topology(json.dumps(found["topology"]).encode())
    assert (graph.n, rb.is_r_robust(graph, 2)) == (8, True)


def test_ctrl_c_in_joint_keeps_the_lengths_that_fail(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    sequence = tmp_path / "sequence.json"
    ring = [[[k, (k + 1) % 5], [(k + 1) % 5, k]] for k in range(5)]
    sequence.write_text(json.dumps({"nodes": list(range(5)), "period": 5, "steps": ring}))
    arguments = ["joint", str(sequence), "-r", "1", "--json"]
    whole = json.loads(CliRunner().invoke(robustness, arguments).stdout)
    kept = []
    for when in range(1, whole["stats"]["windows"] + 1):
        with monkeypatch.context() as patch:
            stop("robustness.time_varying.unions.UnionDecider.decide", when, patch)
            outcome = CliRunner().invoke(robustness, arguments)
        assert outcome.exit_code == 130
        found = json.loads(outcome.stdout)
        assert (found["verdict"], found["reason"]) == ("undecided", "interrupted")
        kept.append(found["at_least"])
    assert kept == sorted(kept)
    assert (kept[0], kept[-1]) == (1, whole["window"])


def test_ctrl_c_in_joint_keeps_the_window_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    sequence = str(ROOT / "examples" / "round-robin.json")
    stop("robustness.time_varying.unions.UnionDecider.decide", 3, monkeypatch)
    outcome = CliRunner().invoke(robustness, ["joint", sequence, "-r", "2", "--window", "1", "--all-windows"])
    assert outcome.exit_code == 130
    assert "not all windows after it were decided" in outcome.stdout
    assert "violating window: step 0" in outcome.stdout


def test_ctrl_c_in_a_curve_keeps_what_is_known_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = ["joint", str(ROOT / "examples" / "round-robin.json"), "-r", "2", "--curve", "--json"]
    whole = json.loads(CliRunner().invoke(robustness, arguments).stdout)["curve"]
    stop("robustness.time_varying.front.UnionDecider", 4, monkeypatch)
    outcome = CliRunner().invoke(robustness, arguments)
    assert outcome.exit_code == 130
    part = json.loads(outcome.stdout)["curve"]
    assert 0 < len(part) < len(whole)
    assert part.items() < whole.items()
