"""The journal of cubes: a run that was killed goes on where it was, and nothing that is damaged is believed."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.cubes import journal, spreading
from robustness.cubes.journal import CubeJournal
from tests.cubes.instances import LONG, MIDDLE, SMALL


@pytest.fixture(autouse=True)
def short_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spreading, "_FIRST_SLICE", 0.01)
    monkeypatch.setattr(spreading, "_LONGEST_SLICE", 0.01)


@pytest.fixture
def half(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A journal that was torn off in the middle, as a kill does."""
    path, lines = tmp_path / "half", list[bytes]()
    while len(lines) <= 6:  # on a busy machine fewer cubes are split
        path.unlink(missing_ok=True)
        rb.certify(*SMALL, evidence="refutation", state=path)
        lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[: len(lines) // 2]) + lines[len(lines) // 2][:40])
    return path


def test_it_goes_on_where_it_was_on_another_machine_too(half: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    shutil.copy(half, elsewhere)
    whole = rb.certify(*SMALL, evidence="refutation")
    found = rb.certify(*SMALL, evidence="refutation", state=elsewhere)
    assert found.certificate == whole.certificate
    assert found.stats["nodes"] == whole.stats["nodes"]
    assert 0 < found.stats["probes"] < whole.stats["probes"]
    again = rb.certify(*SMALL, evidence="refutation", state=elsewhere)
    assert again.certificate == whole.certificate
    assert again.stats["probes"] == 0


def test_the_order_of_lines_does_not_matter_and_a_line_may_be_missing(half: Path) -> None:
    head, *lines = half.read_bytes().splitlines(keepends=True)[:-1]
    half.write_bytes(head + b"".join(reversed(lines[:1] + lines[2:])) + lines[-1])
    found = rb.certify(*SMALL, evidence="refutation", state=half)
    assert found.certificate == rb.certify(*SMALL, evidence="refutation").certificate


def test_a_damaged_line_is_refused(half: Path) -> None:
    lines = half.read_bytes().splitlines(keepends=True)
    lines[2] = lines[2].replace(b'"nodes":', b'"nodes":1', 1)
    half.write_bytes(b"".join(lines))
    with pytest.raises(rb.InvalidParameter, match="line 3: damaged; delete this line"):
        rb.check_rs_robustness(*SMALL, state=half)


def checked(content: str) -> bytes:
    return hashlib.sha256(content.encode()).hexdigest()[:16].encode() + b" " + content.encode() + b"\n"


SENSELESS = {
    "rest": {"rest": [["AAAA", "1"]]},
    "flags": {"rest": [["", ""]]},
    "what is left": {"rest": 5},
    "nodes": {"nodes": "many"},
    "transcript": {"transcript": "AAAA"},
    "alphabet": {"transcript": "é"},
    "pair": {"pair": [[1], "x"]},
    "one side": {"pair": [[1]]},
}


@pytest.mark.parametrize("change", SENSELESS.values(), ids=SENSELESS)
def test_a_line_that_makes_no_sense_is_refused_though_its_checksum_is_right(change: dict[str, Any], half: Path) -> None:
    lines = half.read_bytes().splitlines(keepends=True)[:-1]
    content = json.loads(lines[2].partition(b" ")[2]) | change
    half.write_bytes(b"".join([*lines[:2], checked(json.dumps(content)), *lines[3:]]))
    with pytest.raises(rb.InvalidParameter, match="line 3: damaged; delete this line"):
        rb.certify(*SMALL, evidence="refutation", state=half)


@pytest.mark.parametrize("text", ["[]", "3", "{", "null", "[" * 100_000])
def test_a_line_that_is_no_object_is_refused(text: str, half: Path) -> None:
    whole = half.read_bytes()
    half.write_bytes(whole[: whole.rindex(b"\n") + 1] + checked(text))
    with pytest.raises(rb.InvalidParameter, match="damaged; delete this line"):
        rb.check_rs_robustness(*SMALL, state=half)
    half.write_bytes(checked(text))
    with pytest.raises(rb.InvalidParameter, match="is no journal of cubes"):
        rb.check_rs_robustness(*SMALL, state=half)


@pytest.mark.parametrize("name", ["/dev/null", "/dev/zero", "/dev/full", "pipe"])
def test_a_device_or_a_pipe_is_no_journal(name: str, tmp_path: Path) -> None:
    """It is not read, which might never end."""
    path = tmp_path / name  # a name that begins with a slash stays what it is
    if name == "pipe":
        os.mkfifo(path)
    with pytest.raises(rb.InvalidParameter, match="is no regular file"):
        rb.check_rs_robustness(*SMALL, state=path)


def test_a_full_disk_is_told_by_the_name_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    monkeypatch.setattr(journal, "_SYNC", 0.0)
    with pytest.raises(OSError, match="No space left on device") as raised:
        rb.check_rs_robustness(*SMALL, state=tmp_path / "state")
    assert raised.value.filename == str(tmp_path / "state")


def test_what_is_no_journal_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "graph.txt"
    path.write_text("a b\nb c\n")
    with pytest.raises(rb.InvalidParameter, match="is no journal of cubes"):
        rb.check_rs_robustness(*SMALL, state=path)
    assert path.read_text() == "a b\nb c\n"


def test_another_question_is_not_answered_by_it(half: Path) -> None:
    other = nx.relabel_nodes(SMALL[0].to_networkx(), {0: 1, 1: 0})
    found = rb.check_rs_robustness(other, SMALL[1], state=half)
    assert "journal" not in found.stats["trusted"]
    found = rb.check_rs_robustness(*SMALL, state=half)  # without transcripts
    assert "journal" not in found.stats["trusted"]
    assert rb.certify(*SMALL, evidence="refutation", state=half).stats["probes"] > 0


def test_a_pair_is_remembered_and_checked_again(tmp_path: Path) -> None:
    path = tmp_path / "state"
    first = rb.check_rs_robustness(MIDDLE[0], 13, algorithm="subset-search", state=path)
    again = rb.check_rs_robustness(MIDDLE[0], 13, algorithm="subset-search", state=path)
    assert first.verdict is again.verdict is rb.Verdict.NOT_ROBUST
    assert first.witness == again.witness
    assert again.stats["probes"] == 0


def test_two_runs_do_not_write_to_one_file(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    path = tmp_path / "state"
    with CubeJournal(path, "q", 1), pytest.raises(rb.InvalidParameter, match="in use by another run"):
        CubeJournal(path, "q", 1)
    CubeJournal(path, "q", 1).__exit__(None, None, None)


def test_an_interrupted_run_keeps_what_it_had(tmp_path: Path) -> None:
    path = tmp_path / "state"
    interrupted = []

    def stop(_: object) -> None:
        interrupted.append(1)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rb.check_rs_robustness(*LONG, state=path, progress=stop)
    assert interrupted
    found = rb.check_rs_robustness(*LONG, state=path)
    assert found.verdict is rb.Verdict.ROBUST
    assert "by the journal" in found.stats["trusted"] or path.stat().st_size > 1000


def test_the_command_is_killed_and_goes_on(tmp_path: Path) -> None:
    graph, r = LONG
    source, state = tmp_path / "net.json", tmp_path / "state"
    source.write_bytes(graph.canonical_bytes())
    command = [sys.executable, "-m", "robustness", "check", str(source), "-r", str(r), "--state", str(state)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        ends = time.monotonic() + 60
        while time.monotonic() < ends and (not state.exists() or state.read_bytes().count(b"\n") < 6):
            time.sleep(0.02)
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert "by the journal" in done.stdout
