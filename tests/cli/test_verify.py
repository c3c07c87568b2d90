"""``robustness verify``: the kernel's answer, and whether it is the one that was asked for."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.choices import FACES
from cli.main import robustness
from robustness.decision.certification import certify
from robustness.files import encode_topology, write_topology
from robustness.threat_models import THREAT_MODELS

WHEEL = nx.wheel_graph(5)
TESTS = Path(__file__).resolve().parents[1]


def verify(*arguments: object, graph: nx.Graph = WHEEL) -> Result:
    return CliRunner().invoke(robustness, ["verify", "-", *map(str, arguments)], input=encode_topology(graph))


@pytest.fixture
def robust(tmp_path: Path) -> Path:
    path = tmp_path / "robust.cert"
    path.write_bytes(certify(WHEEL, 2, 2, evidence="refutation").certificate)
    return path


@pytest.fixture
def split(tmp_path: Path) -> Path:
    path = tmp_path / "split.cert"
    path.write_bytes(certify(WHEEL, 3).certificate)
    return path


@pytest.mark.parametrize(
    ("question", "code"),
    [
        ((), 0),
        (("--expect", "robust"), 0),
        (("-r", 2), 0),
        (("-s", 2), 0),
        (("--expect", "robust", "-r", 2, "-s", 2), 0),
        (("--expect", "not-robust"), 10),
        (("-r", 1), 10),
        (("--expect", "robust", "-r", 1), 0),
        (("--expect", "robust", "-r", 1, "-s", 3), 0),
        (("--expect", "robust", "-r", 1, "-s", 4), 10),
        (("--expect", "robust", "-r", 0, "-s", 1), 0),
        (("--expect", "robust", "-r", 3), 10),
        (("-r", 3), 10),
        (("-r", 0), 10),
        (("-s", 1), 10),
        (("-f", 1), 2),
        (("--expect", "together"), 2),
        (("--expect", "together", "-f", 1, "--model", "delayed"), 10),
        (("--window", 2), 10),
        (("--expect", "robust", "-r", 2, "-s", 3), 10),
        (("--expect", "maybe"), 2),
        (("-r", "two"), 2),
    ],
)
def test_the_question_asked(question: tuple[object, ...], code: int, robust: Path) -> None:
    outcome = verify(robust, *question)
    assert outcome.exit_code == code
    assert bool(outcome.stdout) is (code == 0)
    if code == 0:
        assert outcome.stdout.startswith("verified: ")
        assert "is (2,2)-robust (evidence: refutation)" in outcome.stdout
        assert ("compared with no question" in outcome.stdout) is (not question)
    if code == 10:
        assert outcome.stderr.startswith("rejected: ")
        assert outcome.stderr.count("\n") == 1


def test_the_other_verdict(split: Path) -> None:
    outcome = verify(split, "--expect", "not-robust", "-r", 3)
    assert outcome.exit_code == 0
    assert "is not (3,1)-robust (evidence: violation)" in outcome.stdout
    assert verify(split, "--expect", "robust").exit_code == 10


@pytest.mark.parametrize(("r", "code"), [(2, 0), (3, 10)])
def test_json_key_by_key(r: int, code: int, robust: Path) -> None:
    outcome = verify(robust, "--json", "-r", r)
    assert outcome.stderr.count("\n") == (code == 10)
    assert outcome.exit_code == code
    assert outcome.stdout.count("\n") == 1
    found = json.loads(outcome.stdout)
    assert found.pop("tree_nodes") >= 3
    assert found == {
        "schema": "robustness/verify/1",
        "verdict": "robust",
        "r": 2,
        "s": 2,
        "evidence": "refutation",
        "sha256": rb.Digraph.from_networkx(WHEEL).sha256,
        "as_asked": code == 0,
        "comparison": "the claim is the one asked for"
        if code == 0
        else "the claim proved is not the one asked for (r 3)",
        "checker": "python",
    }


def test_one_command_verifies_whatever_the_toolkit_writes(tmp_path: Path) -> None:
    """Each certificate of tolerance and joint, about the files written beside it; only its own question is answered."""
    write_topology(WHEEL, tmp_path / "wheel.json")
    run = CliRunner().invoke
    assert run(robustness, ["tolerance", str(tmp_path / "wheel.json"), "-o", str(tmp_path / "out")]).exit_code == 0
    graph, found = str(tmp_path / "out" / "graph.json"), sorted((tmp_path / "out").glob("*.cert"))
    assert len(found) == 12
    for path in found:
        outcome = run(robustness, ["verify", graph, str(path)])
        assert (outcome.exit_code, outcome.stderr) == (0, ""), path
        assert "compared with no question" in outcome.stdout
    apart = str(tmp_path / "out" / "delayed-refuted-1.cert")
    asked = ["verify", graph, apart, "--expect", "apart", "--model"]
    assert run(robustness, [*asked, "delayed", "-f", "1"]).exit_code == 0
    assert "implies" in run(robustness, [*asked, "delayed", "-f", "2"]).stdout
    for model, f in (("delayed", "0"), ("delayed-local", "1"), ("malicious", "1")):
        outcome = run(robustness, [*asked, model, "-f", f])
        assert (outcome.exit_code, outcome.stdout) == (10, ""), model
    steps = tmp_path / "steps.json"
    steps.write_text(json.dumps({"nodes": [0, 1, 2], "steps": [[[0, 1]], [[1, 2]]], "period": 2}), encoding="utf-8")
    written = ["--canonical", str(tmp_path / "steps.seq"), "--certificate", str(tmp_path / "steps.cert")]
    assert run(robustness, ["joint", str(steps), "-r", "1", *written]).exit_code == 0
    for sequence in (steps, tmp_path / "steps.seq"):
        asked = ["verify", str(sequence), str(tmp_path / "steps.cert"), "--expect", "robust", "-r", "1"]
        assert run(robustness, [*asked, "--window", "2"]).exit_code == 0
        assert run(robustness, [*asked, "--window", "1"]).exit_code == 10


def test_the_canonical_graph_is_read_by_every_command(tmp_path: Path) -> None:
    path = tmp_path / "canonical.json"
    path.write_bytes(rb.Digraph.from_networkx(WHEEL).canonical_bytes())
    outcome = CliRunner().invoke(robustness, ["check", str(path), "--json"])
    assert json.loads(outcome.stdout)["graph"]["sha256"] == rb.Digraph.from_networkx(WHEEL).sha256
    assert not json.loads(outcome.stdout)["graph"]["directed"]


def test_the_models_are_those_of_the_library() -> None:
    bounds = {False: "total", True: "local"}
    assert {name: (1 + each.two_faces, bounds[each.local]) for name, each in THREAT_MODELS.items()} == FACES


def test_another_graph(robust: Path) -> None:
    outcome = verify(robust, graph=nx.cycle_graph(5))
    assert outcome.exit_code == 10
    assert outcome.stdout == ""
    assert "another graph" in outcome.stderr


def test_a_certificate_cut_off_anywhere(robust: Path) -> None:
    whole = robust.read_bytes()
    header = whole.index(b"\n")
    for end in (0, 1, header // 2, header, header + 1, header + 2, len(whole) - 1):
        robust.write_bytes(whole[:end])
        outcome = verify(robust)
        assert outcome.exit_code == (10 if end > header else 3)
        assert (outcome.stdout, outcome.stderr.count("\n")) == ("", 1)


@pytest.mark.parametrize("name", ["absent.cert", ".", "robust.cert/below"])
def test_a_certificate_that_cannot_be_read(name: str, robust: Path) -> None:
    outcome = verify(robust.parent / name)
    assert outcome.exit_code == 3
    assert (outcome.stdout, outcome.stderr.count("\n")) == ("", 1)
    assert "cannot be read" in outcome.stderr


def test_an_unreadable_graph(robust: Path) -> None:
    assert CliRunner().invoke(robustness, ["verify", "-", str(robust)], input=b"{").exit_code == 3
    assert CliRunner().invoke(robustness, ["verify", "absent.json", str(robust)]).exit_code == 3
    assert CliRunner().invoke(robustness, ["verify", "-"], input=b"{}").exit_code == 2


def test_the_graph_may_be_stored_in_any_format(robust: Path, tmp_path: Path) -> None:
    """A certificate is bound to labels and arcs, not to a file: the order and the format do not matter."""
    shuffled = nx.Graph()
    shuffled.add_nodes_from([4, 2, 0, 1, 3])
    shuffled.add_edges_from((v, u) for u, v in list(WHEEL.edges)[::-1])
    path = tmp_path / "wheel.json"
    write_topology(shuffled, path)
    assert CliRunner().invoke(robustness, ["verify", str(path), str(robust)]).exit_code == 0
    assert verify(robust, graph=nx.relabel_nodes(WHEEL, {0: "0"})).exit_code == 10


@pytest.mark.parametrize(("folder", "code"), [("accepted", 0), ("rejected", 10), ("malformed", 3)])
def test_the_samples_of_the_kernel(folder: str, code: int, tmp_path: Path) -> None:
    """Those whose graph is a wheel, read here from a node-link document."""
    wheel = rb.Digraph.from_networkx(WHEEL).canonical_bytes()
    samples = [
        path
        for path in sorted((TESTS / "certificates" / folder).glob("*.cert"))
        if path.with_suffix(".graph").read_bytes() == wheel
    ]
    assert samples
    for sample in samples:
        assert verify(sample).exit_code == code, sample
