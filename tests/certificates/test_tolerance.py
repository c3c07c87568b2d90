"""Tolerance certificates: true claims are accepted, false ones rejected, everything else is malformed."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from certificates import MalformedCertificate, Misuse, RejectedCertificate, verify_tolerance
from certificates.__main__ import main
from certificates.tolerance import FORMAT
from tests.oracles import graphs
from tests.tolerance.brute_force import has_trap

WHEEL = rb.Digraph.from_networkx(nx.wheel_graph(5))
COMPLETE = rb.Digraph.from_networkx(nx.complete_graph(6))
TRAP = {"kind": "sets", "M": [0], "S1": [1, 2], "S2": [3, 4]}


def make(about: rb.Digraph, claim: dict[str, Any], evidence: Any, body: bytes = b"", **changes: Any) -> bytes:
    header = {"format": FORMAT, "graph": about.sha256, "claim": claim, "evidence": evidence} | changes
    return json.dumps({key: value for key, value in header.items() if value is not ...}).encode() + b"\n" + body


def claim(f: int = 1, faces: int = 2, bound: str = "total", verdict: str = "apart", **more: Any) -> dict[str, Any]:
    return {"f": f, "faces": faces, "bound": bound, "verdict": verdict} | more


def ordinary(graph: rb.Digraph, r: int) -> bytes:
    certificate = rb.certify(graph, r).certificate
    assert certificate is not None
    return certificate


class TestAccepted:
    @pytest.mark.parametrize("bound", ["total", "local"])
    def test_a_trap(self, bound: str) -> None:
        proved = verify_tolerance(WHEEL.canonical_bytes(), make(WHEEL, claim(bound=bound), TRAP))
        assert (proved.verdict, proved.f, proved.faces, proved.bound) == ("apart", 1, 2, bound)
        assert (proved.certificates, proved.tree_nodes, proved.evidence) == (0, 0, "sets")
        where = "in total" if bound == "total" else "locally"
        assert f"has a trap for f = 1 {where} (evidence: sets)" in str(proved)

    @pytest.mark.parametrize("bound", ["total", "local"])
    def test_a_violation(self, bound: str) -> None:
        sets = {"kind": "sets", "M": [0], "S1": [0, 1, 2], "S2": [3, 4]}
        proved = verify_tolerance(WHEEL.canonical_bytes(), make(WHEEL, claim(2, 1, bound), sets))
        assert "has a violation for f = 2" in str(proved)

    @pytest.mark.parametrize("faces", [1, 2])
    @pytest.mark.parametrize("bound", ["total", "local"])
    def test_robust(self, faces: int, bound: str) -> None:
        data = make(COMPLETE, claim(1, faces, bound, "together"), {"kind": "robust"}, ordinary(COMPLETE, 3))
        proved = verify_tolerance(COMPLETE.canonical_bytes(), data)
        assert (proved.verdict, proved.certificates) == ("together", 1)
        assert "has no" in str(proved)


def test_sets_are_accepted_exactly_when_they_are_a_trap() -> None:
    """Every way to give the nodes of every graph on four nodes a role: one is accepted iff there is a trap."""
    for graph in graphs(4):
        for f, bound in product((0, 1), ("total", "local")):
            accepted = False
            for roles in product("-M12", repeat=4):
                sets = {name: [i for i in range(4) if roles[i] == name[-1]] for name in ("M", "S1", "S2")}
                data = make(graph, claim(f, bound=bound), {"kind": "sets", **sets})
                try:
                    verify_tolerance(graph.canonical_bytes(), data)
                except RejectedCertificate:
                    continue
                accepted = True
            assert accepted == has_trap(graph.in_masks, f, bound == "local")


class TestRejected:
    @pytest.mark.parametrize(
        ("what", "sets", "message"),
        [
            (claim(0), TRAP, "M has 1 nodes"),
            (claim(), TRAP | {"S1": []}, "normal node in each"),
            (claim(), TRAP | {"S1": [1, 2, 3]}, "disjoint"),
            (claim(), TRAP | {"M": [1]}, "outside S1 and S2"),
            (claim(), TRAP | {"M": []}, "outside its side"),
            (claim(), TRAP | {"S1": [1, 3], "S2": [2, 4]}, "outside its side"),
            (claim(faces=1), TRAP, "inside S1 and S2"),
            (claim(faces=1), TRAP | {"S1": [0, 1, 2]}, "outside its side"),
            (claim(1, 1), TRAP | {"M": [1, 2]}, "normal node in each"),
            (claim(1, 2, "local"), TRAP | {"M": [2, 4], "S1": [1], "S2": [3]}, "hears more than f = 1 nodes of M"),
        ],
    )
    def test_sets(self, what: dict[str, Any], sets: dict[str, Any], message: str) -> None:
        with pytest.raises(RejectedCertificate, match=message):
            verify_tolerance(WHEEL.canonical_bytes(), make(WHEEL, what, sets))

    def test_another_graph(self) -> None:
        with pytest.raises(RejectedCertificate, match="another graph"):
            verify_tolerance(COMPLETE.canonical_bytes(), make(WHEEL, claim(), TRAP))

    @pytest.mark.parametrize("r", [1, 2])
    def test_not_robust_enough(self, r: int) -> None:
        data = make(COMPLETE, claim(verdict="together"), {"kind": "robust"}, ordinary(COMPLETE, r))
        with pytest.raises(RejectedCertificate, match="another claim than 3-robustness"):
            verify_tolerance(COMPLETE.canonical_bytes(), data)

    def test_the_other_verdict(self) -> None:
        data = make(WHEEL, claim(verdict="together"), {"kind": "robust"}, ordinary(WHEEL, 3))
        with pytest.raises(RejectedCertificate, match="another claim"):
            verify_tolerance(WHEEL.canonical_bytes(), data)


class TestMalformed:
    @pytest.mark.parametrize(
        ("what", "evidence", "body", "changes", "message"),
        [
            (claim(), TRAP, b"", {"format": "robustness/certificate/1"}, "the format is"),
            (claim(), TRAP, b"", {"graph": ...}, "exactly the keys"),
            (claim(), TRAP, b"", {"note": 1}, "exactly the keys"),
            (claim(extra=1), TRAP, b"", {}, "exactly the keys"),
            (claim(-1), TRAP, b"", {}, "f is an integer"),
            (claim(2**31 + 1), TRAP, b"", {}, "f is an integer"),
            (claim(True), TRAP, b"", {}, "f is an integer"),
            (claim(faces=3), TRAP, b"", {}, "faces is 1 or 2"),
            (claim(faces=True), TRAP, b"", {}, "faces is 1 or 2"),
            (claim(bound="some"), TRAP, b"", {}, "a bound is"),
            (claim(bound=[]), TRAP, b"", {}, "a bound is"),
            (claim(verdict="robust"), TRAP, b"", {}, "a verdict is"),
            (claim(), TRAP, b"x", {}, "'sets' has no body"),
            (claim(), {"kind": "robust"}, b"", {}, "no evidence of kind 'robust'"),
            (claim(verdict="together"), TRAP, b"", {}, "no evidence of kind 'sets'"),
            (claim(), [], b"", {}, "'kind'"),
            (claim(), TRAP | {"M": [0, 0]}, b"", {}, "strictly ascending"),
            (claim(), TRAP | {"M": [5]}, b"", {}, "ids in 0..4"),
            (claim(), TRAP | {"S3": []}, b"", {}, "exactly the keys"),
            (claim(verdict="together"), {"kind": "robust"}, b"", {}, "one line of JSON"),
        ],
    )
    def test_one_thing_wrong(
        self, what: dict[str, Any], evidence: Any, body: bytes, changes: dict[str, Any], message: str
    ) -> None:
        with pytest.raises(MalformedCertificate, match=message):
            verify_tolerance(WHEEL.canonical_bytes(), make(WHEEL, what, evidence, body, **changes))

    def test_no_line(self) -> None:
        with pytest.raises(MalformedCertificate, match="one line of JSON"):
            verify_tolerance(WHEEL.canonical_bytes(), b"{}")

    def test_too_long(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("certificates.stream.MAX_CERTIFICATE_BYTES", 10)
        with pytest.raises(MalformedCertificate, match="at most 10 bytes"):
            verify_tolerance(WHEEL.canonical_bytes(), make(WHEEL, claim(), TRAP))

    @pytest.mark.parametrize("arguments", [("", b""), (b"", None)])
    def test_misuse(self, arguments: tuple[Any, Any]) -> None:
        with pytest.raises(Misuse, match="two bytes objects"):
            verify_tolerance(*arguments)


class TestCommand:
    @pytest.mark.parametrize(
        ("options", "code"),
        [
            ([], 0),
            (["--expect", "apart", "-f", "1", "--faces", "2", "--bound", "total"], 0),
            (["--expect", "apart", "-f", "2", "--faces", "2", "--bound", "total"], 0),
            (["--expect", "apart", "-f", "0", "--faces", "2", "--bound", "total"], 10),
            (["--expect", "apart", "-f", "1", "--faces", "1", "--bound", "total"], 10),
            (["--expect", "apart", "-f", "1", "--faces", "2", "--bound", "local"], 10),
            (["--expect", "together", "-f", "1", "--faces", "2", "--bound", "total"], 10),
        ],
    )
    def test_exit_codes(
        self, tmp_path: Path, options: list[str], code: int, capsys: pytest.CaptureFixture[str]
    ) -> None:
        (tmp_path / "graph").write_bytes(WHEEL.canonical_bytes())
        (tmp_path / "cert").write_bytes(make(WHEEL, claim(), TRAP))
        assert main(["verify-tolerance", str(tmp_path / "graph"), str(tmp_path / "cert"), *options]) == code
        assert ("verified: the graph with 5 nodes" in capsys.readouterr().out) is (code == 0)
