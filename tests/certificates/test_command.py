"""``python -m certificates verify``: its exit codes, on a Python with nothing installed, and what it prints."""

from __future__ import annotations

import json
import os
import runpy
import subprocess
import sys
from pathlib import Path

import networkx as nx
import pytest

from certificates import Question, VerifiedJointClaim, VerifiedToleranceClaim, comparison
from certificates import __main__ as program
from robustness import Digraph
from tests.certificates.forging import certificate, searched

ROOT = Path(__file__).resolve().parents[2]
WHEEL = Digraph.from_networkx(nx.wheel_graph(5))
ABOUT_LIARS = ["--expect", "apart", "-f", "1", "--faces", "2", "--bound", "total"]
PAIR = {"kind": "violation", "S1": [1, 2], "S2": [3, 4]}


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """A folder with a graph, two true certificates, and some that are not."""
    node_link = nx.node_link_data(nx.wheel_graph(5), edges="edges")
    proof = certificate(WHEEL, 2, 1, body=searched(WHEEL, 2, 1))
    for name, data in {
        "graph": WHEEL.canonical_bytes(),
        "graph.json": json.dumps(node_link).encode(),
        "other": Digraph.from_networkx(nx.cycle_graph(5)).canonical_bytes(),
        "robust": proof,
        "split": certificate(WHEEL, 3, 1, "not-robust", PAIR),
        "false": certificate(WHEEL, 3, 1, body=searched(WHEEL, 2, 1)),
        "cut": proof[:-1],
        "headless": proof[:40],
        "empty": b"",
        "nameless": b"[]\n",
    }.items():
        (tmp_path / name).write_bytes(data)
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "code", "out", "err"),
    [
        (("graph", "robust"), 0, "is (2,1)-robust (evidence: refutation)", ""),
        (("graph.json", "robust"), 0, "is (2,1)-robust", ""),
        (("graph", "split"), 0, "is not (3,1)-robust (evidence: violation)", ""),
        (("graph", "robust", "--expect", "robust", "-r", "2", "-s", "1"), 0, "verified", ""),
        (("graph", "robust"), 0, "compared with no question", ""),
        (("graph", "robust", "--expect", "robust", "-r", "1"), 0, "implies the one asked for (r 1)", ""),
        (("graph", "robust", "--expect", "robust", "-r", "1", "-s", "2"), 0, "implies", ""),
        (("graph", "robust", "--expect", "robust", "-r", "1", "-s", "3"), 10, "", "(r 1, s 3)"),
        (("graph", "robust", "--expect", "robust", "-r", "-1"), 10, "", "(r -1)"),
        (("graph", "split", "--expect", "not-robust", "-r", "4"), 0, "implies", ""),
        (("graph", "split", "--expect", "not-robust", "-r", "2", "-s", "2"), 10, "", "(r 2, s 2)"),
        (("graph", "robust", "--expect", "not-robust"), 10, "", "not the one asked for (verdict not-robust)"),
        (("graph", "robust", "-r", "3", "-s", "2"), 10, "", "not the one asked for (r 3, s 2)"),
        (("graph", "robust", "-r", "0"), 10, "", "(r 0)"),
        (("graph", "robust", "--window", "2"), 10, "", "says nothing about window"),
        (("graph", "robust", *ABOUT_LIARS), 10, "", "says nothing about f"),
        (("graph", "nameless"), 3, "", "the format of a certificate is one of"),
        (("graph", "false"), 10, "", "rejected: refutation, byte"),
        (("other", "robust"), 10, "", "rejected: the certificate is about another graph"),
        (("graph", "cut"), 10, "", "rejected: refutation"),
        (("graph", "headless"), 3, "", "malformed: a certificate begins"),
        (("graph", "empty"), 3, "", "malformed"),
        (("robust", "robust"), 3, "", "malformed: the graph"),
        (("graph", "absent"), 3, "", "error: cannot read"),
        (("graph", "."), 3, "", "error: cannot read"),
        (("graph/below", "robust"), 3, "", "error: cannot read"),
    ],
)
def test_exit_codes(
    arguments: tuple[str, ...],
    code: int,
    out: str,
    err: str,
    files: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(files)
    assert program.main(["verify", *arguments]) == code
    said = capsys.readouterr()
    assert out in said.out
    assert bool(said.out) is bool(out)
    assert err in said.err
    assert said.err.count("\n") == bool(err)


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("prove",),
        ("verify", "graph"),
        ("verify", "a", "b", "-r", "two"),
        ("verify", "a", "b", "-f", "1"),
        ("verify-tolerance", "a", "b", "--expect", "together", "-f", "1"),
        ("verify-tolerance", "a", "b", "--faces", "1"),
    ],
)
def test_usage(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        program.main(list(arguments))
    assert ended.value.code == 2
    assert "usage:" in capsys.readouterr().err


def test_questions_that_the_programs_do_not_ask() -> None:
    """A window apart from the one proven, and a threat without its f: neither is answered by what is proven."""
    joint = VerifiedJointClaim("robust", 2, 1, 3, "windows", "", 5, 3, 3, None, 1, 0)
    assert comparison(joint, Question("robust", 1, 1))[0]
    assert not comparison(joint, Question("robust", 1, 1, 2))[0]
    apart = VerifiedToleranceClaim("apart", 1, 2, "total", "sets", "", 5, 8)
    assert not comparison(apart, Question("apart", s=2))[0]
    assert not comparison(apart, Question("together", faces=2, bound="total"))[0]
    assert comparison(apart, Question("apart", faces=2, bound="total")) == (True, "the claim is the one asked for")


def test_no_more_than_the_limits_is_read(
    files: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("certificates.stream.MAX_CERTIFICATE_BYTES", 10)
    assert program.main(["verify", str(files / "graph"), str(files / "robust")]) == 3
    assert "at most 10 bytes" in capsys.readouterr().err


def test_as_a_program(files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "certificates.__main__")
    monkeypatch.setattr(sys, "argv", ["certificates", "verify", str(files / "graph"), str(files / "robust")])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module("certificates", run_name="__main__")
    assert ended.value.code == 0


#: Runs the program as it is, then says on stderr what it imported beside the standard library and itself.
WATCHED = """
import sys, runpy
sys.path.insert(0, sys.argv.pop(1))
try:
    runpy.run_module("certificates", run_name="__main__")
finally:
    roots = {name.split(".")[0] for name in sys.modules} - sys.stdlib_module_names - {"certificates", "__main__"}
    sys.stderr.write(f"imported: {sorted(roots)}")
"""


@pytest.mark.parametrize(("name", "code"), [("robust", 0), ("split", 0), ("false", 10), ("headless", 3)])
def test_on_a_bare_python(name: str, code: int, files: Path) -> None:
    """Isolated (-I), without site-packages (-S), in optimised mode (-O), warnings as errors, nothing but the stdlib."""
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-O", "-W", "error", "-c", WATCHED, str(ROOT), "verify", "graph", name],
        cwd=files,
        env={"PYTHONHASHSEED": "1", "PATH": os.defpath},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, bool(done.stdout)) == (code, code == 0), done.stderr
    assert done.stderr.endswith("imported: []")


@pytest.mark.skipif(sys.platform != "linux", reason="a limit on memory")
@pytest.mark.parametrize("text", ["[" + "[]," * 4_000_000 + "[]]", '{"a":"' + "x" * 80_000_000 + '"}'])
def test_a_file_that_does_not_fit_into_memory_is_malformed(text: str, tmp_path: Path) -> None:
    """Whatever has no room, the words are few and the code is promised."""
    (tmp_path / "graph.json").write_text(text)
    (tmp_path / "proof.cert").write_bytes(certificate(WHEEL, 2, 1, evidence={"kind": "degree"}))
    limited = (
        "import resource, sys; from certificates.__main__ import main;"
        "resource.setrlimit(resource.RLIMIT_AS, (150 * 2**20,) * 2); sys.exit(main(sys.argv[1:]))"
    )
    arguments = ["verify", str(tmp_path / "graph.json"), str(tmp_path / "proof.cert")]
    done = subprocess.run(
        [sys.executable, "-c", limited, *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == "malformed: the files do not fit into memory\n"
