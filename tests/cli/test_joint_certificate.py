"""``robustness joint --certificate``: what it writes, the bare kernel verifies."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from certificates import __main__ as kernel
from certificates import verify_joint
from cli.main import robustness
from robustness.time_varying import TimeVaryingGraph, canonical_sequence, certification, encode_sequence

STARS = [[(k, v) for v in range(5) if v != k] for k in range(5)]
STAR = TimeVaryingGraph.from_arcs(range(5), STARS, period=5)


def joint(folder: Path, *arguments: str, sequence: TimeVaryingGraph = STAR) -> Result:
    files = ["-o", str(folder / "proof"), "--canonical", str(folder / "sequence")]
    return CliRunner().invoke(robustness, ["joint", "-", *files, *arguments], input=encode_sequence(sequence))


@pytest.mark.parametrize(
    ("arguments", "code", "verdict", "window"),
    [
        (["-r", "2", "--window", "3"], 0, "robust", 3),
        (["-r", "2"], 0, "robust", 3),
        (["-r", "2", "--window", "2"], 10, "not-robust", 2),
        (["-r", "2", "--window", "2", "--all-windows"], 10, "not-robust", 2),
        (["-r", "4"], 10, "not-robust", 5),
        (["-r", "2", "-s", "2", "--window", "5", "--jobs", "2", "--seed", "7"], 0, "robust", 5),
    ],
)
def test_either_verdict(arguments: list[str], code: int, verdict: str, window: int, tmp_path: Path) -> None:
    outcome = joint(tmp_path, *arguments)
    assert outcome.exit_code == code, outcome.output
    assert (tmp_path / "sequence").read_bytes() == canonical_sequence(STAR)
    claim = verify_joint((tmp_path / "sequence").read_bytes(), (tmp_path / "proof").read_bytes())
    assert (claim.verdict, claim.window) == (verdict, window)
    names = [str(tmp_path / name) for name in ("sequence", "proof")]
    assert kernel.main(["verify-joint", *names, "--expect", verdict]) == 0
    assert outcome.stderr == f"wrote {names[0]}\nwrote {names[1]}\n"


def test_a_trace_without_a_window(tmp_path: Path) -> None:
    trace = TimeVaryingGraph.from_arcs(range(5), STARS)
    assert joint(tmp_path, "-r", "1", "--window", "6", sequence=trace).exit_code == 10
    claim = verify_joint((tmp_path / "sequence").read_bytes(), (tmp_path / "proof").read_bytes())
    assert (claim.verdict, claim.evidence) == ("not-robust", "no-window")


def test_json_names_the_files(tmp_path: Path) -> None:
    files = {name: str(tmp_path / path) for name, path in (("canonical", "sequence"), ("certificate", "proof"))}
    assert json.loads(joint(tmp_path, "-r", "2", "--json").stdout)["files"] == files
    without = CliRunner().invoke(robustness, ["joint", "-", "-r", "2", "--json"], input=encode_sequence(STAR))
    assert "files" not in json.loads(without.stdout)


def test_undecided_writes_no_certificate(tmp_path: Path) -> None:
    outcome = joint(tmp_path, "-r", "2", "--timeout", "1e-9")
    assert outcome.exit_code == 30
    assert sorted(path.name for path in tmp_path.iterdir()) == ["sequence"]
    assert "no certificate" in outcome.stderr


def test_decided_but_no_time_for_the_certificate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object, **__: object) -> None:
        return None

    monkeypatch.setattr(certification, "joint_certificate", never)
    outcome = joint(tmp_path, "-r", "2")
    assert outcome.exit_code == 30
    assert outcome.stdout.startswith("robust:")
    assert "no certificate: the time limit was reached" in outcome.stderr


def test_nothing_to_certify_and_nowhere_to_write(tmp_path: Path) -> None:
    assert joint(tmp_path, "-r", "0").exit_code == 2
    assert joint(tmp_path / "absent", "-r", "2").exit_code == 2
