"""One search by cubes: whoever solves them, and whatever is lost, forged, late or said twice, no verdict is wrong."""

from __future__ import annotations

import concurrent.futures
import os
import random
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from certificates import verify
from robustness.cubes import Cube, CubeExecutor, solve, spreading
from robustness.cubes.executors import cube_executor
from robustness.limits import Progress
from tests.cubes.instances import ENDLESS, LONG, MIDDLE, SMALL, question_of


@pytest.fixture(autouse=True)
def short_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spreading, "_FIRST_SLICE", 0.01)


class Faulty:
    """An executor that does to every result what it is told to."""

    def __init__(self, meddle: Callable[[int, dict[str, Any]], list[Any]]) -> None:
        self.meddle = meddle
        self.said: deque[tuple[int, Any]] = deque()
        self.stopped = False
        self.refused = 0

    def width(self) -> int:
        return 3

    def submit(self, number: int, task: dict[str, Any]) -> None:
        self.said.extend((number, each) for each in self.meddle(number, solve(task)))

    def results(self, seconds: float) -> list[tuple[int, Any]]:
        return [self.said.popleft() for _ in range(len(self.said))]

    def refuse(self, result: dict[str, Any]) -> bool:
        self.refused += 1
        return False

    def stop(self) -> None:
        self.stopped = True


def test_the_protocol_is_what_it_says() -> None:
    faulty = Faulty(lambda _, result: [result])
    assert isinstance(faulty, CubeExecutor)
    assert cube_executor(faulty) is faulty
    with pytest.raises(rb.InvalidParameter, match="executor is a concurrent"):
        rb.check_rs_robustness(SMALL[0], 11, executor="two")
    with pytest.raises(rb.InvalidParameter, match="executor is a concurrent"):
        rb.determine_robustness(nx.path_graph(3), executor=2)


@pytest.mark.parametrize("pool", [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor])
def test_any_pool_gives_the_certificate_of_one_thread(pool: Any) -> None:
    graph, r = SMALL
    alone = rb.certify(graph, r, evidence="refutation")
    with pool(2) as executor:
        spread = rb.certify(graph, r, evidence="refutation", executor=executor)
    assert spread.stats["cubes"] > 3
    assert spread.certificate == alone.certificate
    assert spread.stats["nodes"] == alone.stats["nodes"]
    assert spread.stats["trusted"].startswith("nobody")
    assert verify(graph.canonical_bytes(), spread.certificate or b"").verdict == "robust"


def test_without_transcripts_it_says_whom_it_trusts() -> None:
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        found = rb.check_rs_robustness(*SMALL, executor=executor)
    assert found.verdict is rb.Verdict.ROBUST
    assert "by workers" in found.stats["trusted"]


@pytest.mark.parametrize("seed", range(6))
def test_small_graphs_have_the_verdict_of_the_definition(seed: int) -> None:
    draws = random.Random(seed)
    graph = nx.gnp_random_graph(11, draws.choice([0.4, 0.6, 0.8]), seed=seed, directed=seed % 2 == 1)
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        for r in range(1, 6):
            for s in (1, 2, 4):
                spread = rb.check_rs_robustness(graph, r, s, algorithm="subset-search", executor=executor)
                assert spread.verdict is rb.check_rs_robustness(graph, r, s, algorithm="exhaustive").verdict


def meddling(seed: int) -> Callable[[int, dict[str, Any]], list[Any]]:
    """Lose the first result, and lose, delay, repeat and forge others now and then."""
    draws, kept = random.Random(seed), []

    def meddle(number: int, result: dict[str, Any]) -> list[Any]:
        kept.append(result)
        match draws.randrange(14) if kept[1:] else 0:
            case 0:
                return [MemoryError("out of memory")]
            case 1:
                return [concurrent.futures.CancelledError()]
            case 2:
                return [result, result]
            case 3:
                return [draws.choice(kept), result]
            case 4:
                return [None]
            case 5:
                return [{"status": "found", "software": result["software"], "cube": result["cube"], "pair": [[0], [1]]}]
            case 6:
                return [{**result, "status": "open", "rest": (b"12345678", "1")}]
            case 7:
                return [{**result, "transcript": b"torn"}]
            case 8:
                return [{**result, "status": "well"}]
        return [result]

    return meddle


@pytest.mark.parametrize("seed", range(8))
def test_whatever_happens_to_results_the_proof_is_whole(seed: int) -> None:
    graph, r = SMALL
    found = rb.certify(graph, r, evidence="refutation", executor=Faulty(meddling(seed)))
    assert found.verdict in (rb.Verdict.ROBUST, rb.Verdict.UNDECIDED)
    assert found.stats["lost"] > 0
    if found.verdict is rb.Verdict.ROBUST:
        assert found.certificate == rb.certify(graph, r, evidence="refutation").certificate
    refuted = rb.check_rs_robustness(graph, r + 1, algorithm="subset-search", executor=Faulty(meddling(seed)))
    assert refuted.verdict in (rb.Verdict.NOT_ROBUST, rb.Verdict.UNDECIDED)


def test_what_is_lost_again_and_again_is_undecided() -> None:
    executor = Faulty(lambda *_: [MemoryError("out of memory")])
    found = rb.check_rs_robustness(*SMALL, executor=executor)
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.stats["reason"] == "a cube was lost 5 times: MemoryError: out of memory"
    assert executor.stopped


def test_another_version_is_refused_with_a_word() -> None:
    executor = Faulty(lambda _, result: [{"status": "refused", "software": "0.0/1/f", "cube": result["cube"]}])
    with pytest.warns(rb.GraphWarning, match="has version 0.0/1/f, not .*: install the same"):
        found = rb.check_rs_robustness(*SMALL, executor=executor)
    assert found.verdict is rb.Verdict.UNDECIDED
    assert "install the same" in found.stats["reason"]
    assert executor.refused >= 5
    graph, r = SMALL
    task = question_of(graph, r).as_task(Cube.whole(graph.n), 0.1)
    assert solve({**task, "software": "older"})["status"] == "refused"


def silent_at_first() -> Callable[[int, dict[str, Any]], list[Any]]:
    kept: list[dict[str, Any]] = []

    def meddle(_: int, result: dict[str, Any]) -> list[Any]:
        kept.append(result)
        return [] if len(kept) == 1 else [result]

    return meddle


class Silent(Faulty):
    """An executor that loses its first task without a word, and has no workers after a while."""

    def width(self) -> int:
        return 0


def test_silence_is_not_waited_for_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spreading, "_GRACE", 0.0)
    monkeypatch.setattr(spreading, "_PATIENCE", 1)
    found = rb.certify(*SMALL, evidence="refutation", executor=Faulty(silent_at_first()))
    assert found.verdict is rb.Verdict.ROBUST
    assert found.stats["lost"] >= 1
    monkeypatch.setattr(spreading, "_ALONE", 0.1)
    found = rb.check_rs_robustness(*SMALL, executor=Silent(lambda _, result: [result]))
    assert found.stats["reason"].startswith("there was no worker")


def kill_one(pool: concurrent.futures.ProcessPoolExecutor) -> None:
    os.kill(random.Random(1).choice(sorted(pool._processes)), signal.SIGKILL)


def test_a_process_pool_whose_worker_is_killed() -> None:
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        pool.submit(int).result()
        timer = threading.Timer(0.5, kill_one, [pool])
        timer.start()
        found = rb.check_rs_robustness(*LONG, executor=pool)
        timer.join()
    assert found.verdict in (rb.Verdict.UNDECIDED, rb.Verdict.ROBUST)
    if found.verdict is rb.Verdict.UNDECIDED:
        assert "BrokenProcessPool" in found.stats["reason"]


def notes_of(graph: rb.Digraph, r: int, **options: Any) -> Iterator[str]:
    notes: list[Progress] = []
    found = rb.check_rs_robustness(graph, r, progress=notes.append, **options)
    assert found.verdict is rb.Verdict.UNDECIDED
    yield from (progress.note for progress in notes)


def test_the_time_limit_stops_all_and_an_estimate_is_told() -> None:
    graph, r = ENDLESS
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        notes = list(notes_of(graph, r, executor=executor, time_limit=15))
        found = rb.check_rs_robustness(graph, r, executor=executor, time_limit=1)
    assert any(note.startswith("closed 0 %, about ") and "left on 2 workers" in note for note in notes)
    estimate = found.stats["estimate"]
    low, about, high = estimate["nodes_left"]
    assert 0 < low <= about <= high
    assert estimate["workers"] == 2
    assert estimate["closed"] < 0.2
    assert found.stats["reason"] == "the time limit was reached"


def test_a_pair_stops_the_others() -> None:
    graph, r = MIDDLE
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        found = rb.check_rs_robustness(graph, r + 1, algorithm="subset-search", executor=executor)
    assert found.verdict is rb.Verdict.NOT_ROBUST
    assert found.witness is not None
    assert "estimate" not in found.stats


def test_determination_uses_the_executor() -> None:
    graph, r = MIDDLE
    executor = Faulty(lambda _, result: [result])
    found = rb.determine_robustness(graph, executor=executor, algorithm="subset-search", s_time_limit=0.5)
    assert found.r == r
    assert executor.stopped
