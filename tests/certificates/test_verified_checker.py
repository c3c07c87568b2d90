"""The checker that is proved correct agrees with the Python kernel; its theorem is printed as it stands, and closed."""

from __future__ import annotations

import json
import re
import subprocess
from collections import Counter
from itertools import islice, product
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner

from certificates import verify_tolerance
from certificates.tolerance import FORMAT_WITH_REFUTATIONS
from cli.main import robustness
from cli.verified import find_checker, verify_with
from robustness import Digraph
from robustness.limits import Limits
from robustness.traps import searching
from robustness.traps.question import Question
from tests.certificates.differential import Stream, by_the_kernel, cases, differs
from tests.certificates.forging import certificate, searched
from tests.certificates.make_samples import HERE

ROOT = Path(__file__).parents[2]
FORMAL = ROOT / "certificates" / "formal"
SAMPLES = sorted(
    path
    for place in (HERE, HERE / "tolerance")
    for folder in ("accepted", "rejected", "malformed")
    for path in (place / folder).glob("*.cert")
)
WHEEL = Digraph.from_networkx(nx.wheel_graph(5))


@pytest.fixture(scope="module")
def checker() -> Path:
    found = find_checker()
    if found is None:
        pytest.skip(
            "the checker that is proved correct is not built, so not compared: apt-get install coq; make formal"
        )
    return found


def run(checker: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([checker, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_every_committed_sample(checker: Path) -> None:
    """The same exit code, but for derivations, which it does not know and calls malformed."""
    codes = {"accepted": 0, "rejected": 10, "malformed": 3}
    for path in SAMPLES:
        expected = 3 if path.stem.startswith("derivation") else codes[path.parent.name]
        outcome = run(checker, "verify", path.with_suffix(".graph"), path)
        assert outcome.returncode == expected, (path, outcome)
        assert outcome.stderr.count("\n") == (expected != 0)


@pytest.mark.parametrize("seed", [1, 2])
def test_generated_certificates_and_mutants(seed: int, checker: Path) -> None:
    """``python -m tests.certificates.differential --count 100000`` compares as many as you like."""
    accepted = compare(seed, 1000, checker)
    assert accepted["robustness"] > 50
    assert accepted["tolerance"] > 50
    assert sum(accepted.values()) < 500


@pytest.mark.slow
def test_many_generated_certificates_and_mutants(checker: Path) -> None:
    assert sum(compare(3, 20_000, checker).values()) > 4_000


def compare(seed: int, count: int, checker: Path) -> Counter[str]:
    """Compare so many certificates, and return how many of each format were accepted."""
    accepted = Counter[str]()
    with Stream(checker) as stream:
        for case in islice(cases(seed), count):
            assert differs(stream, case) is None
            if by_the_kernel(*case[1:])[0] == 0:
                accepted["tolerance" if case[0].startswith("apart") else "robustness"] += 1
    return accepted


def test_long_input_does_not_exhaust_the_stack(checker: Path, tmp_path: Path) -> None:
    """A stack of 128 KB is enough for lists of 20,000 nodes and for what follows a proof: nothing recurses on them."""
    n = 20_000
    path = Digraph.from_networkx(nx.path_graph(n))
    halves = {"kind": "violation", "S1": list(range(n // 2)), "S2": list(range(n // 2, n))}
    grown = {"kind": "growth", "seed": [0, 1], "order": list(range(2, n)), "proof": {"kind": "degree"}}
    long = searched(WHEEL, 2, 1) + bytes(10**7)
    for graph, data, code in (
        (path, certificate(path, 2, 1, "not-robust", halves), 0),
        (path, certificate(path, 1, 1, evidence=grown), 0),
        (WHEEL, certificate(WHEEL, 2, 1, body=long), 10),
    ):
        (tmp_path / "graph").write_bytes(graph.canonical_bytes())
        (tmp_path / "cert").write_bytes(data)
        command = [
            "bash",
            "-c",
            'ulimit -s 128; exec "$@"',
            "-",
            checker,
            "verify",
            tmp_path / "graph",
            tmp_path / "cert",
        ]
        assert subprocess.run(command, capture_output=True, check=False).returncode == code


def test_the_question_is_compared_as_the_kernel_compares_it(checker: Path, tmp_path: Path) -> None:
    (tmp_path / "graph").write_bytes(WHEEL.canonical_bytes())
    (tmp_path / "cert").write_bytes(certificate(WHEEL, 2, 2, body=searched(WHEEL, 2, 2)))
    from certificates.__main__ import main

    for question in (
        [], ["--expect", "robust"], ["--expect", "not-robust"], ["-r", "2"], ["-r", "3"], ["-s", "1"], ["-s", "3"],
        ["--expect", "robust", "-r", "1", "-s", "3"], ["--expect", "robust", "-r", "1", "-s", "4"],
    ):  # fmt: skip
        paths = [str(tmp_path / "graph"), str(tmp_path / "cert")]
        assert run(checker, "verify", *paths, *question).returncode == main(["verify", *paths, *question]), question
    assert run(checker, "verify", tmp_path / "graph").returncode == 2
    assert run(checker, "verify", tmp_path / "graph", tmp_path / "none").returncode == 3


def test_robustness_verify_uses_it(checker: Path, tmp_path: Path) -> None:
    (tmp_path / "wheel.json").write_bytes(WHEEL.canonical_bytes())
    good, bad = tmp_path / "good.cert", tmp_path / "bad.cert"
    good.write_bytes(certificate(WHEEL, 2, 2, body=searched(WHEEL, 2, 2)))
    bad.write_bytes(certificate(WHEEL, 2, 2, body=searched(WHEEL, 2, 2)[:-1]))
    arguments = ["verify", str(tmp_path / "wheel.json"), "--checker", "verified"]
    outcome = CliRunner().invoke(robustness, [*arguments, str(good), "-r", "2"])
    assert outcome.exit_code == 0, outcome.output
    assert "by the checker that is proved correct" in outcome.stdout
    assert CliRunner().invoke(robustness, [*arguments, str(good), "-r", "3"]).exit_code == 10
    assert CliRunner().invoke(robustness, [*arguments, str(bad)]).exit_code == 10


APART = [
    ("no trap", nx.complete_graph(6), Question(1, two_faces=True), "together"),
    ("no violation", nx.wheel_graph(5), Question(1, two_faces=False, local=True), "together"),
    ("a trap", nx.wheel_graph(5), Question(1, two_faces=True), "apart"),
]


@pytest.mark.parametrize(("made", "question", "verdict"), [case[1:] for case in APART], ids=[case[0] for case in APART])
def test_what_malicious_nodes_can_do(
    made: nx.Graph, question: Question, verdict: str, checker: Path, tmp_path: Path
) -> None:
    """Traps and violations: both checkers give the same claim, and compare it with a question in the same way."""
    from certificates.__main__ import main

    graph = Digraph.from_networkx(made)
    answer = searching.decide(graph, question, Limits(), transcript=True)
    assert answer.exists is (verdict == "apart")
    evidence: dict[str, object] = {"kind": "refutation"}
    if answer.sets is not None:
        evidence = {"kind": "sets"} | {
            name: sorted(ids) for name, ids in zip(("M", "S1", "S2"), answer.sets, strict=True)
        }
    faces, bound = 2 if question.two_faces else 1, "local" if question.local else "total"
    claim = {"f": question.f, "faces": faces, "bound": bound, "verdict": verdict}
    header = {"format": FORMAT_WITH_REFUTATIONS, "graph": graph.sha256, "claim": claim, "evidence": evidence}
    data = json.dumps(header).encode() + b"\n" + (answer.transcript or b"")
    (tmp_path / "graph.json").write_bytes(graph.canonical_bytes())
    (tmp_path / "cert").write_bytes(data)
    paths = [str(tmp_path / "graph.json"), str(tmp_path / "cert")]
    assert str(verify_with(checker, graph.canonical_bytes(), data)) == str(
        verify_tolerance(graph.canonical_bytes(), data)
    )
    for f, asked_faces, asked_bound in product((0, 1, 2), (1, 2), ("total", "local")):
        asked = ["--expect", verdict, "-f", str(f), "--faces", str(asked_faces), "--bound", asked_bound]
        assert run(checker, "verify", *paths, *asked).returncode == main(["verify", *paths, *asked]), asked
    for foreign in (["-r", "1"], ["--window", "2"], ["--expect", "robust"]):
        assert run(checker, "verify", *paths, *foreign).returncode == main(["verify", *paths, *foreign]) == 10
    assert run(checker, "verify", *paths, "--expect", verdict).returncode == 2
    outcome = CliRunner().invoke(robustness, ["verify", *paths, "--checker", "verified"])
    assert outcome.exit_code == 0, outcome.output


@pytest.mark.parametrize("form", ["robustness/joint-certificate/1", "robustness/mending-certificate/2"])
def test_a_format_that_it_does_not_know_is_told(form: str, tmp_path: Path) -> None:
    (tmp_path / "c.cert").write_bytes(json.dumps({"format": form}).encode() + b"\n")
    paths = [str(tmp_path / "wheel.json"), str(tmp_path / "c.cert")]
    outcome = CliRunner().invoke(robustness, ["verify", *paths, "--checker", "verified"])
    assert outcome.exit_code == 3
    assert "--checker python" in outcome.stderr


def test_the_proofs_are_closed(checker: Path) -> None:
    """``Print Assumptions`` of every theorem answers that nothing is assumed; ``make formal`` keeps the answer."""
    asked = len(re.findall(r"^Print Assumptions", (FORMAL / "Assumptions.v").read_text(), re.MULTILINE))
    built = ROOT / "build" / "formal" / "Assumptions.out"
    if not built.is_file() or built.stat().st_mtime < max(path.stat().st_mtime for path in FORMAL.iterdir()):
        pytest.skip("the checker was not built from these sources in this checkout: make formal")
    assert built.read_text() == "Closed under the global context\n" * asked


def test_no_axiom_and_nothing_admitted() -> None:
    for path in FORMAL.glob("*.v"):
        assert not re.search(r"\b(Admitted|admit|Axiom|Parameter|Conjecture)\b", path.read_text()), path


def test_make_builds_every_proof() -> None:
    listed = re.search(r"^PROOFS := (.*?)\n\n", (ROOT / "Makefile").read_text(), re.DOTALL | re.MULTILINE)
    assert listed is not None
    assert set(listed[1].replace("\\", "").split()) == {path.stem for path in FORMAL.glob("*.v")}


def test_without_the_checker_the_command_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("cli.verified.find_checker", lambda: None)
    (tmp_path / "c.cert").write_bytes(certificate(WHEEL, 2, 2, body=searched(WHEEL, 2, 2)))
    (tmp_path / "wheel.json").write_bytes(WHEEL.canonical_bytes())
    paths = [str(tmp_path / "wheel.json"), str(tmp_path / "c.cert")]
    outcome = CliRunner().invoke(robustness, ["verify", *paths, "--checker", "verified"])
    assert outcome.exit_code == 2
    assert "make formal" in outcome.stderr


@pytest.mark.parametrize(
    ("script", "code"),
    [
        ("#!/bin/sh\necho 'Fatal error: exception Not_found' >&2\nexit 2\n", 1),
        ("#!/bin/sh\nkill -9 $$\n", 1),
        ("#!/bin/sh\necho 'verified: whatever you like'\n", 1),
        ("#!/nowhere/sh\n", 2),
    ],
    ids=["crashed", "killed", "another program", "cannot be started"],
)
def test_a_checker_without_an_answer_is_no_verdict(
    script: str, code: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A checker that ends without an answer is an internal error; one that cannot be started is not to be had."""
    program = tmp_path / "robustness-verified"
    program.write_text(script)
    program.chmod(0o755)
    monkeypatch.setattr("cli.verified.find_checker", lambda: program)
    (tmp_path / "c.cert").write_bytes(certificate(WHEEL, 2, 2, body=searched(WHEEL, 2, 2)))
    (tmp_path / "wheel.json").write_bytes(WHEEL.canonical_bytes())
    paths = [str(tmp_path / "wheel.json"), str(tmp_path / "c.cert")]
    outcome = CliRunner().invoke(robustness, ["verify", *paths, "--checker", "verified"])
    assert outcome.exit_code == code
    assert "verified:" not in outcome.stdout
    assert str(program) in outcome.stderr


@pytest.mark.parametrize("page", ["formal.md", "trust.md"])
def test_the_statement_on_the_page_is_the_one_in_the_source(page: str) -> None:
    """Every block of Coq on the page stands in a source file, word for word."""
    blocks = re.findall(r"^```text\n(.*?)^```", (ROOT / "docs" / page).read_text(), re.DOTALL | re.MULTILINE)
    sources = [path.read_text() for path in FORMAL.glob("*.v")]
    parts = [
        part
        for block in blocks
        for part in re.split(r"\n\n", block.strip())
        if "Definition" in part or "Theorem" in part
    ]
    assert len(parts) >= (10 if page == "formal.md" else 1)
    for part in parts:
        assert any(part in source for source in sources), part


def test_every_theorem_on_the_page_is_asked_what_it_assumes() -> None:
    asked = set(re.findall(r"^Print Assumptions (\w+)\.", (FORMAL / "Assumptions.v").read_text(), re.MULTILINE))
    named = {name for row in re.findall(r"^\| (`.*?) \|", (ROOT / "docs" / "formal.md").read_text(), re.MULTILINE)
             for name in re.findall(r"`(\w+)`", row)}  # fmt: skip
    assert asked - {"verify_sound"} == named
