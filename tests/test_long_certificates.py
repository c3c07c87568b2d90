"""Certificates too long to be held: written in pieces, compressed by name, and verified by several processes."""

from __future__ import annotations

import gzip
import json
import pickle
import random
import subprocess
import sys
import threading
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from certificates import stream, verify
from certificates.file_bytes import certificate_blocks
from certificates.shares import together, verify_share
from cli.main import robustness as program
from robustness import parallel_verification
from robustness.cubes import spreading
from robustness.decision.algorithms import subset_search
from robustness.evidence import Refutation
from robustness.limits import Limits, Progress
from robustness.parallel_verification import cubes_beside, verify_in_parallel
from robustness.transcripts import Piece, Spool, Transcript
from tests.certificates.forging import certificate

FOUND = rb.Digraph.from_networkx(nx.gnp_random_graph(24, 0.5, seed=1))
GRAPH = FOUND.canonical_bytes()
#: 12-robust, by a refutation of 374,370 bytes.
LONGER = rb.Digraph.from_networkx(nx.gnp_random_graph(45, 0.5, seed=2))


@pytest.fixture
def long_already(monkeypatch: pytest.MonkeyPatch) -> None:
    """A refutation of 500 bytes counts as long."""
    monkeypatch.setattr(parallel_verification, "_WORTH_IT", 100)
    monkeypatch.setattr(stream, "_LEAST_TREE", 4)


class Parts:
    def __init__(self, *parts: Any, is_tree: bool = False) -> None:
        self.parts = parts
        self.is_tree = is_tree


def test_a_transcript_is_its_pieces_in_order_wherever_they_are_kept() -> None:
    spool = Spool()
    late, early = spool.keep(b"cd" * 10**6), spool.keep(b"ab")
    found = Transcript(Parts(Parts(early, Parts()), Parts(Parts(late)), early))
    assert len(found) == 2 * 10**6 + 4
    assert bytes(found) == b"ab" + b"cd" * 10**6 + b"ab"
    assert max(map(len, found)) <= 2**16
    restored = pickle.loads(pickle.dumps(found))  # noqa: S301  # our own
    assert bytes(restored) == bytes(found)


def test_where_trees_are_in_a_transcript() -> None:
    spool = Spool()
    inner = Parts(spool.keep(b"cd"), Parts(is_tree=True), spool.keep(b"e"), is_tree=True)
    found = Transcript(Parts(spool.keep(b"ab"), Parts(inner, spool.keep(b"f"), is_tree=True), Parts(spool.keep(b"g"))))
    assert sorted(found.trees) == [(2, 3), (2, 4), (4, 0)]


def test_no_tree_without_a_byte_is_verified_apart() -> None:
    """A state that is contradictory at once leaves none: two trees would begin where one does."""
    index = parallel_verification._chosen([(0, 0), (7, 0), (7, 5), (12, 0), (12, 3), (12, 0)], 2**20)
    assert index == ((7, 5), (12, 3))


def test_threads_keep_pieces_at_the_same_time() -> None:
    spool = Spool()
    pieces: dict[int, Piece] = {}

    def keep(number: int) -> None:
        for k in range(50):
            pieces[100 * number + k] = spool.keep(b"%d," % (100 * number + k) * 1000)

    threads = [threading.Thread(target=keep, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(b"".join(piece) == b"%d," % number * 1000 for number, piece in pieces.items())


def test_a_long_transcript_is_not_in_memory() -> None:
    """40 MB of what does not compress: none of it stays in memory when kept, and none when read again."""
    draw = __import__("random").Random(1)
    block = draw.randbytes(2**20)
    tracemalloc.start()
    spool = Spool()
    found = Transcript(Parts(*(spool.keep(bytes([k]) + block) for k in range(40))))
    assert sum(map(len, found)) == len(found) == 40 * (2**20 + 1)
    assert tracemalloc.get_traced_memory()[1] < 8 * 2**20
    tracemalloc.stop()


@pytest.mark.parametrize("jobs", [1, 3])
def test_what_a_search_records_is_what_the_kernel_replays(jobs: int) -> None:
    answer = subset_search.decide(FOUND, 7, 1, Limits.of(None, jobs), transcript=True)
    assert isinstance(answer.evidence, Refutation)
    assert bytes(answer.evidence.transcript) == answer.transcript


@pytest.mark.parametrize("name", ["proof.cert", "proof.cert.gz"])
def test_written_and_read_by_name(name: str, tmp_path: Path, long_already: None) -> None:
    held = rb.certify(FOUND, 7, evidence="refutation").certificate
    result = rb.certify(FOUND, 7, evidence="refutation", output=tmp_path / name)
    assert (result.verdict.value, result.certificate) == ("robust", None)
    data = (tmp_path / name).read_bytes()
    assert (gzip.decompress(data) if name.endswith(".gz") else data) == held
    assert result.stats["written"] == {
        "certificate": str(tmp_path / name),
        "bytes": len(held or b""),
        "cubes": str(tmp_path / f"{name}.cubes"),
    }
    again = rb.certify(FOUND, 7, evidence="refutation", output=tmp_path / f"again-{name}")
    assert again.verdict == result.verdict
    assert (tmp_path / f"again-{name}").read_bytes() == data
    refuted = rb.certify(FOUND, 8, output=tmp_path / "pair.cert")
    assert verify(GRAPH, certificate_blocks(tmp_path / "pair.cert")).verdict == "not-robust"
    assert refuted.witness is not None
    assert "cubes" not in refuted.stats["written"]
    assert "written" not in rb.certify(FOUND, 7, evidence="refutation", time_limit=1e-9, output=tmp_path / "no").stats
    assert not (tmp_path / "no").exists()


def test_several_processes_prove_what_one_does(tmp_path: Path, long_already: None) -> None:
    path = tmp_path / "proof.cert.gz"
    rb.certify(FOUND, 7, evidence="refutation", output=path)
    cubes = cubes_beside(path)
    assert len(cubes) > 5
    told: list[str] = []
    found = verify_in_parallel(GRAPH, path, cubes, 2, told.append)
    assert found == verify(GRAPH, certificate_blocks(path))
    assert told[-1] == "100 % of the certificate verified, by 2 processes"
    other = rb.Digraph.from_networkx(nx.gnp_random_graph(24, 0.5, seed=2)).canonical_bytes()
    assert verify_in_parallel(other, path, cubes, 2, told.append) is None
    assert verify_in_parallel(GRAPH, tmp_path / "none", cubes, 2, told.append) is None
    start, length = cubes[1]
    assert verify_in_parallel(GRAPH, path, (cubes[0], (start, length - 1)), 2, told.append) is None


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "robustness/cubes-index/2", "cubes": [[0, 1]]}', '{"format": 1, "cubes": 2}']
)
def test_a_file_of_cubes_that_is_none_is_not_there(text: str, tmp_path: Path) -> None:
    assert cubes_beside(tmp_path / "proof") == ()
    (tmp_path / "proof.cubes").write_text(text)
    assert cubes_beside(tmp_path / "proof") == ()


def run(arguments: list[str]) -> Result:
    return CliRunner().invoke(program, arguments)


def test_the_command(tmp_path: Path, long_already: None) -> None:
    graph, path = tmp_path / "graph.json", tmp_path / "proof.cert.gz"
    graph.write_text(json.dumps(nx.node_link_data(FOUND.to_networkx(), edges="edges")))
    written = run(["certify", str(graph), "-r", "7", "-o", str(path), "--json"])
    document = json.loads(written.stdout)
    assert written.exit_code == 0
    assert set(document["files"]) <= {"certificate", "cubes"}
    rb.certify(FOUND, 7, evidence="refutation", output=path)
    expected = ["--expect", "robust", "-r", "7"]
    alone = run(["verify", str(graph), str(path), *expected])
    assert alone.exit_code == 0
    assert run(["verify", str(graph), str(path), *expected, "--jobs", "2"]).stdout == alone.stdout
    index = path.with_name(path.name + ".cubes")
    start, length = cubes_beside(path)[1]
    index.write_text(json.dumps({"format": "robustness/cubes-index/1", "cubes": [[start, length - 1]]}))
    lied = run(["verify", str(graph), str(path), *expected, "--jobs", "2"])
    assert (lied.exit_code, lied.stdout) == (0, alone.stdout)
    assert "one process verifies the whole" in lied.stderr
    index.unlink()
    missing = run(["verify", str(graph), str(path), *expected, "--jobs", "2"])
    assert (missing.exit_code, missing.stdout) == (0, alone.stdout)
    assert "there is no proof.cert.gz.cubes" in missing.stderr
    path.write_bytes(gzip.compress(gzip.decompress(path.read_bytes())[:-1]))
    assert run(["verify", str(graph), str(path), *expected, "--jobs", "2"]).exit_code == 10
    path.write_bytes(path.read_bytes()[:-1])
    damaged = run(["verify", str(graph), str(path), *expected])
    assert (damaged.exit_code, damaged.stderr.count("\n")) == (3, 1)


@pytest.fixture(scope="module")
def by_one(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The certificate that one process has verified."""
    path = tmp_path_factory.mktemp("one") / "proof.cert"
    rb.certify(LONGER, 12, output=path)
    return path


def by_two(path: Path, told: list[str] | None = None, executor: Any = None) -> rb.RobustnessResult:
    def tell(progress: Progress) -> None:
        if told is not None:
            told.append(progress.note)

    return rb.certify(LONGER, 12, jobs=2, output=path, progress=tell, executor=executor)


def files(path: Path) -> list[bytes]:
    return [path.read_bytes(), path.with_name(path.name + ".cubes").read_bytes()]


@pytest.fixture
def in_small_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search of a second is cut as one of minutes is."""
    monkeypatch.setattr(subset_search, "_SLICE", 1e-3)
    monkeypatch.setattr(spreading, "_FIRST_SLICE", 1e-2)
    monkeypatch.setattr(spreading, "_LONGEST_SLICE", 2e-2)


@pytest.mark.parametrize("is_spread", [False, True])
def test_certify_verifies_by_several_processes(
    is_spread: bool, by_one: Path, tmp_path: Path, in_small_slices: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same files, byte for byte, without one process that verifies the whole."""
    monkeypatch.setattr(parallel_verification, "verify", None)
    told: list[str] = []
    with ThreadPoolExecutor(2) as pool:
        result = by_two(tmp_path / "proof.cert", told, pool if is_spread else None)
    assert result.verdict is rb.Verdict.ROBUST
    assert files(tmp_path / "proof.cert") == files(by_one)
    assert "100 % of the certificate verified, by 2 processes" in told


@pytest.mark.parametrize("jobs", [2, 3])
def test_trees_that_a_search_notes_are_trees_of_the_proof(jobs: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever of them are taken for an index, the shares are accepted."""
    monkeypatch.setattr(subset_search, "_SLICE", 1e-6)
    draw, seen = random.Random(jobs), 0
    for _ in range(30):
        answer = subset_search.decide(FOUND, 7, 1, Limits.of(None, jobs), transcript=True)
        assert isinstance(answer.evidence, Refutation)
        transcript = answer.evidence.transcript
        assert isinstance(transcript, Transcript)
        trees = [tree for tree in transcript.trees if tree[1]]
        index = parallel_verification._chosen(draw.sample(trees, draw.randint(1, len(trees))), 2**24)
        data = certificate(FOUND, 7, 1, body=bytes(transcript))
        shares = [verify_share(GRAPH, data, index, number, 2) for number in range(2)]
        assert together(shares) == verify(GRAPH, data)
        seen += len(index)
    assert seen > 30  # more than one each


def test_most_of_a_proof_is_in_trees_that_are_noted(in_small_slices: None) -> None:
    answer = subset_search.decide(LONGER, 12, 1, Limits.of(None, 2), transcript=True)
    assert isinstance(answer.evidence, Refutation)
    transcript = answer.evidence.transcript
    assert isinstance(transcript, Transcript)
    chosen = parallel_verification._chosen(transcript.trees, len(transcript))
    assert sum(length for _, length in chosen) > len(transcript) / 2


CHILDREN = {
    "it fails": "raise SystemExit(1)",
    "it says something else": "print('hello')",
    "it dies": "import os; os.abort()",
}


@pytest.mark.parametrize("child", CHILDREN.values(), ids=CHILDREN)
def test_when_processes_prove_nothing_one_verifies_the_whole(
    child: str, by_one: Path, tmp_path: Path, in_small_slices: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parallel_verification, "_CHILD", child)
    assert by_two(tmp_path / "proof.cert").verdict is rb.Verdict.ROBUST
    assert files(tmp_path / "proof.cert") == files(by_one)


def no_process(*arguments: Any, **options: Any) -> Any:
    raise BlockingIOError(11, "Resource temporarily unavailable")


@pytest.mark.parametrize("what", ["no program", "no process", "no tree"])
def test_where_no_process_helps(
    what: str, by_one: Path, tmp_path: Path, in_small_slices: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    if what == "no program":
        monkeypatch.setattr(sys, "executable", None)
    elif what == "no process":
        monkeypatch.setattr(subprocess, "Popen", no_process)
    else:
        lie = property(lambda transcript: [(5, 5000), (9000, 5000)], lambda transcript, trees: None)
        monkeypatch.setattr(Transcript, "trees", lie, raising=False)
    assert by_two(tmp_path / "proof.cert").verdict is rb.Verdict.ROBUST
    assert files(tmp_path / "proof.cert") == files(by_one)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_time_limit_holds_while_a_proof_is_verified(
    jobs: int, tmp_path: Path, in_small_slices: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(Limits, "expired", lambda limits: any("verified" in note for note in told))
    path = tmp_path / "proof.cert"
    found = rb.certify(LONGER, 12, jobs=jobs, time_limit=600, output=path, progress=lambda each: told.append(each.note))
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.stats["reason"] == "the time limit was reached before the proof was verified"
    assert not path.exists()


def test_certify_tells_how_much_is_verified() -> None:
    told: list[str] = []

    def tell(progress: Progress) -> None:
        told.append(progress.note)

    rb.certify(FOUND, 7, evidence="refutation", progress=tell)
    assert "0 % of the certificate verified" in told
