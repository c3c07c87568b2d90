"""``robustness certify``: a certificate for either verdict, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from certificates import verify
from cli.interruption import Overrun
from cli.main import robustness
from robustness.files import encode_topology

WHEEL = nx.wheel_graph(5)


def certify(*arguments: object, graph: nx.Graph = WHEEL) -> Result:
    return CliRunner().invoke(robustness, ["certify", "-", *map(str, arguments)], input=encode_topology(graph))


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "wheel.cert"


@pytest.mark.parametrize(
    ("r", "s", "code", "verdict", "evidence"),
    [
        (2, 1, 0, "robust", {"degree", "growth", "refutation"}),
        (2, 5, 0, "robust", {"degree", "growth", "refutation"}),
        (3, 1, 10, "not-robust", {"violation"}),
        (3, 5, 10, "not-robust", {"violation"}),
        (4, 1, 10, "not-robust", {"violation"}),
    ],
)
def test_either_verdict(r: int, s: int, code: int, verdict: str, evidence: set[str], target: Path) -> None:
    outcome = certify("-r", r, "-s", s, "-o", target)
    assert outcome.exit_code == code
    claim = verify(rb.Digraph.from_networkx(WHEEL).canonical_bytes(), target.read_bytes())
    assert (claim.verdict, claim.r, claim.s) == (verdict, r, s)
    assert claim.evidence in evidence
    assert f"{target} ({target.stat().st_size:,} bytes, verified)" in outcome.stderr
    assert [path.name for path in target.parent.iterdir()] == ["wheel.cert"]


@pytest.mark.parametrize(("r", "code"), [(2, 0), (3, 10)])
def test_json_key_by_key(r: int, code: int, target: Path) -> None:
    canonical = target.with_name("wheel.graph")
    outcome = certify("-r", r, "-o", target, "--canonical", canonical, "--json")
    assert outcome.exit_code == code
    assert outcome.stdout.count("\n") == 1
    found = json.loads(outcome.stdout)
    assert 0 <= found.pop("seconds") < 60
    assert isinstance(found.pop("algorithm"), str)
    assert set(found.pop("bounds")) >= {"lower", "upper"}
    graph = rb.Digraph.from_networkx(WHEEL)
    assert found == {
        "schema": "robustness/certify/1",
        "graph": {
            "nodes": 5,
            "arcs": 16,
            "directed": False,
            "sha256": graph.sha256,
            "read_as": "undirected, 5 nodes, 8 links",
        },
        "verdict": "robust" if code == 0 else "not-robust",
        "r": r,
        "s": 1,
        "bytes": target.stat().st_size,
        "files": {"certificate": str(target), "canonical": str(canonical)},
    }
    assert canonical.read_bytes() == graph.canonical_bytes()


def test_an_old_file_is_replaced_by_a_new_verdict_only(target: Path) -> None:
    target.write_bytes(b"old")
    hard = nx.gnp_random_graph(70, 0.5, seed=1)
    assert certify("-r", 17, "-o", target, "--timeout", "0.3", graph=hard).exit_code == 30
    assert target.read_bytes() == b"old"
    assert certify("-r", 2, "-o", target).exit_code == 0
    assert target.read_bytes() != b"old"


@pytest.mark.parametrize("as_json", [False, True])
def test_undecided_writes_nothing(as_json: bool, target: Path) -> None:
    hard = nx.gnp_random_graph(70, 0.5, seed=1)
    options = ["-o", target, "--canonical", target.with_name("graph"), "--timeout", "0.3"]
    outcome = certify("-r", 17, *options, *(["--json"] if as_json else []), graph=hard)
    assert outcome.exit_code == 30
    assert list(target.parent.iterdir()) == []
    if as_json:
        found = json.loads(outcome.stdout)
        assert (found["verdict"], found["bytes"], found["files"]) == ("undecided", 0, {})
    else:
        assert "nothing is certified" in outcome.stdout


def test_an_overrun_is_undecided_and_writes_nothing(monkeypatch: pytest.MonkeyPatch, target: Path) -> None:
    def overrun(*_: object, **__: object) -> None:
        raise Overrun

    monkeypatch.setattr("cli.query.interruptibly", overrun)
    outcome = certify("-r", 2, "-o", target, "--timeout", "1")
    assert outcome.exit_code == 30
    assert "nothing is certified: the time limit was reached" in outcome.stdout
    assert list(target.parent.iterdir()) == []


@pytest.mark.parametrize("place", ["missing/wheel.cert", "file/wheel.cert", "folder"])
def test_a_file_that_cannot_be_written(place: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"here")
    (tmp_path / "folder").mkdir()
    outcome = certify("-r", 2, "-o", tmp_path / place)
    assert outcome.exit_code == 2
    assert outcome.stdout == ""
    assert place in outcome.stderr.splitlines()[-1].lower()
    assert outcome.stderr.count("rror: ") == 1
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "folder"]
    assert (tmp_path / "file").read_bytes() == b"here"


def test_a_failure_half_way_leaves_no_part(monkeypatch: pytest.MonkeyPatch, target: Path) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    outcome = certify("-r", 2, "-o", target)
    assert outcome.exit_code == 2
    assert "No space left" in outcome.stderr
    assert list(target.parent.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "graph", "code"),
    [
        ((), WHEEL, 2),
        (("-r", 0), WHEEL, 2),
        (("-r", 2, "-s", 0), WHEEL, 2),
        (("-r", 2, "-s", 6), WHEEL, 2),
        (("-r", "two"), WHEEL, 2),
        (("-r", 2, "--timeout", "0"), WHEEL, 2),
        (("-r", 2, "--jobs", "0"), WHEEL, 2),
        (("-r", 2, "--proof-format", "drat"), WHEEL, 2),
        (("-r", 1), nx.empty_graph(0), 2),
        (("-r", 2), nx.empty_graph(1), 2),
        (("-r", 1), nx.empty_graph(1), 0),
        (("-r", 1), nx.empty_graph(2), 10),
    ],
)
def test_questions_that_are_refused_or_small(
    arguments: tuple[object, ...], graph: nx.Graph, code: int, target: Path
) -> None:
    assert certify(*arguments, "-o", target, graph=graph).exit_code == code
    assert target.exists() is (code in (0, 10))


def test_an_unreadable_graph(target: Path) -> None:
    outcome = CliRunner().invoke(robustness, ["certify", "-", "-r", "1", "-o", str(target)], input=b"{")
    assert outcome.exit_code == 3
    assert not target.exists()


def test_labels_one_and_one_in_quotes_stay_apart(target: Path) -> None:
    """1 and '1' lie on different sides of the only split."""
    graph = nx.Graph([(1, 2), ("1", "2")])
    assert certify("-r", 1, "-o", target, graph=graph).exit_code == 10
    digraph = rb.Digraph.from_networkx(graph)
    assert verify(digraph.canonical_bytes(), target.read_bytes()).verdict == "not-robust"
    sides = json.loads(target.read_bytes())["evidence"]
    assert sorted(sorted(map(repr, digraph.labels_of(sides[name]))) for name in ("S1", "S2")) == [
        ["'1'", "'2'"],
        ["1", "2"],
    ]


def test_two_threads_and_a_directed_graph(target: Path) -> None:
    graph = nx.gnp_random_graph(16, 0.6, seed=4, directed=True)
    outcome = certify("-r", 3, "-s", 2, "-o", target, "--jobs", 2, "--seed", 5, "--json", graph=graph)
    claim = verify(rb.Digraph.from_networkx(graph).canonical_bytes(), target.read_bytes())
    assert claim.verdict == json.loads(outcome.stdout)["verdict"]
    assert json.loads(outcome.stdout)["graph"]["directed"] is True
