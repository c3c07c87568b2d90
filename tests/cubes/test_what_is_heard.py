"""What workers, journals and executors say that is not so is lost, or not looked at, and no verdict is wrong."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import zlib
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robustness as rb
from robustness.cubes import solve, spreading
from tests.cubes.instances import SMALL

#: (44 nodes, 12): the graph is 11-robust and no more.
REFUTED = SMALL[0], SMALL[1] + 1


@pytest.fixture(autouse=True)
def short_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spreading, "_FIRST_SLICE", 0.01)
    monkeypatch.setattr(spreading, "_LONGEST_SLICE", 0.08)


class Executor:
    """One that solves at once and says what is so."""

    def __init__(self) -> None:
        self.said: deque[tuple[Any, Any]] = deque()

    def width(self) -> int:
        return 3

    def submit(self, number: int, task: dict[str, Any]) -> None:
        self.said.append((number, solve(task)))

    def results(self, seconds: float) -> list[tuple[Any, Any]]:
        return [self.said.popleft() for _ in range(len(self.said))]

    def refuse(self, result: dict[str, Any]) -> bool:
        return False

    def stop(self) -> None:
        pass


class OfAnotherQuestion(Executor):
    """One who answers what an earlier search, for r - 1, has asked of the same cubes."""

    def submit(self, number: int, task: dict[str, Any]) -> None:
        need = np.frombuffer(task["need"], "<i8") + 1
        self.said.append((number, solve({**task, "need": need.astype("<i8").tobytes()})))


def test_what_is_true_of_another_question_is_not_taken_for_this_one() -> None:
    found = rb.check_rs_robustness(*REFUTED, algorithm="subset-search", executor=OfAnotherQuestion())
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.stats["reason"] == "a cube was lost 5 times: a result about another question"


class Repeating(Executor):
    """One who says everything again in every later search."""

    def __init__(self) -> None:
        super().__init__()
        self.ever: list[tuple[Any, Any]] = []

    def results(self, seconds: float) -> list[tuple[Any, Any]]:
        fresh = super().results(seconds)
        self.ever += fresh
        return [*self.ever, *reversed(self.ever)]


def test_what_an_earlier_search_was_told_is_nothing_to_a_later_one() -> None:
    executor = Repeating()
    for graph, r, verdict in ((*SMALL, "robust"), (*REFUTED, "not-robust"), (*SMALL, "robust")):
        found = rb.check_rs_robustness(graph, r, algorithm="subset-search", executor=executor)
        assert (found.verdict.value, found.stats["lost"]) == (verdict, 0)


class Odd:
    """Something that cannot even be looked at."""

    def __getitem__(self, name: str) -> Any:
        raise RuntimeError("no")


GARBAGE: dict[str, Any] = {
    "nothing": None,
    "a list": [],
    "an odd thing": Odd(),
    "no status": {"status": ["closed"]},
    "infinitely many nodes": {"nodes": math.inf},
    "more nodes than there are": {"nodes": 10**400},
    "nodes to be taken away": {"nodes": -3},
    "a part of a probe": {"probes": 0.5},
    "no time": {"seconds": math.nan},
    "time that is given back": {"seconds": -1.0},
    "a number of bytes": {"transcript": 1 << 50},
    "bytes that are not packed": {"transcript": b"torn"},
    "an endless node": {"status": "found", "pair": [[math.inf], [1]]},
    "one side": {"status": "found", "pair": [[1]]},
    "a cube of nothing": {"status": "open", "rest": None},
    "a cube of another size": {"status": "open", "rest": (b"12345678", "1")},
}


@pytest.mark.parametrize("garbage", GARBAGE.values(), ids=GARBAGE)
def test_garbage_is_a_loss_and_leaves_no_trace(garbage: Any, tmp_path: Path) -> None:
    class Once(Executor):
        def submit(self, number: int, task: dict[str, Any]) -> None:
            result = solve(task)
            is_first = "first" not in vars(self)
            self.first = True
            said = {**result, **garbage} if isinstance(garbage, dict) else garbage
            self.said.append((number, said if is_first else result))

    alone = rb.certify(*SMALL, evidence="refutation", state=tmp_path / "alone")
    found = rb.certify(*SMALL, evidence="refutation", state=tmp_path / "state", executor=Once())
    assert (found.verdict, found.stats["lost"]) == (rb.Verdict.ROBUST, 1)
    assert found.certificate == alone.certificate
    assert found.stats["nodes"] == alone.stats["nodes"]
    cubes = [json.loads(line[17:])["cube"] for line in (tmp_path / "state").read_bytes().splitlines()[1:]]
    assert len(cubes) == len(set(cubes))


@pytest.mark.parametrize("number", [None, -1, 10**9, "1", [1]])
def test_results_of_no_task_are_passed_over(number: Any) -> None:
    class Talking(Executor):
        def results(self, seconds: float) -> list[tuple[Any, Any]]:
            return [(number, {"status": "closed"}), *super().results(seconds)]

    assert rb.check_rs_robustness(*SMALL, executor=Talking()).verdict is rb.Verdict.ROBUST


def test_a_cube_of_which_nothing_is_done_is_lost_in_the_end() -> None:
    class Idle(Executor):
        def submit(self, number: int, task: dict[str, Any]) -> None:
            rest = task["states"], task["symmetric"]
            self.said.append((number, {**solve(task), "status": "open", "rest": rest}))

    found = rb.check_rs_robustness(*SMALL, executor=Idle(), time_limit=60)
    assert found.stats["reason"].startswith("a cube was lost 5 times: a result that leaves the cube as it was")
    assert found.stats["estimate"]["nodes_left"][1] > 0  # of the cube that was lost, too


@pytest.mark.parametrize("problem", [OSError("no more processes"), TypeError("cannot pickle"), ValueError()])
def test_an_executor_that_takes_nothing(problem: Exception) -> None:
    class Broken(Executor):
        def submit(self, number: int, task: dict[str, Any]) -> None:
            raise problem

    found = rb.check_rs_robustness(*SMALL, executor=Broken())
    assert found.verdict is rb.Verdict.UNDECIDED
    assert found.stats["reason"] == f"a cube was lost 5 times: {type(problem).__name__}: {problem}"


def test_an_answer_that_comes_after_its_time_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cube was given out again meanwhile, to somebody who never answers."""
    monkeypatch.setattr(spreading, "_GRACE", 0.0)
    monkeypatch.setattr(spreading, "_PATIENCE", 1)

    class Late(Executor):
        def __init__(self) -> None:
            super().__init__()
            self.kept: list[tuple[int, Any]] = []
            self.cube = ""

        def submit(self, number: int, task: dict[str, Any]) -> None:
            self.cube = self.cube or task["cube"]
            if task["cube"] != self.cube:
                super().submit(number, task)
            elif not self.kept:
                self.kept = [(number, solve(task))]
            else:  # the same cube once more: only now comes the answer to the first task
                self.said.extend(self.kept)

    found = rb.certify(*SMALL, evidence="refutation", executor=Late())
    assert (found.verdict, found.stats["lost"]) == (rb.Verdict.ROBUST, 1)


@pytest.mark.parametrize("forged", [b"", bytes(50), b"not a proof, whatever it says"])
def test_a_forged_proof_is_undecided_by_worker_and_by_journal(forged: bytes, tmp_path: Path) -> None:
    class Forging(Executor):
        def submit(self, number: int, task: dict[str, Any]) -> None:
            result = solve(task)
            is_closed = result["status"] == "closed"
            self.said.append((number, {**result, "transcript": zlib.compress(forged)} if is_closed else result))

    state = tmp_path / "state"
    found = rb.certify(*SMALL, evidence="refutation", executor=Forging(), state=state)
    assert (found.verdict, found.certificate) == (rb.Verdict.UNDECIDED, None)
    assert found.stats["reason"].startswith("what workers or the journal told is no proof")
    again = rb.certify(*SMALL, evidence="refutation", state=state)
    assert (again.verdict, again.certificate) == (rb.Verdict.UNDECIDED, None)


def test_a_journal_that_goes_round_in_a_circle_is_left(tmp_path: Path) -> None:
    state = tmp_path / "state"
    rb.check_rs_robustness(*SMALL, state=state)
    head, *lines = state.read_bytes().splitlines()
    told = [json.loads(line[17:]) for line in lines]
    whole = spreading.Cube.whole(SMALL[0].n)
    for each in told:
        if not each["rest"]:  # it is closed; this says that all is left of it
            data, flags = whole.to_wire()
            each["rest"] = [(base64.b64encode(data).decode(), flags)]
    texts = [json.dumps(each).encode() for each in told]
    sums = [hashlib.sha256(text).hexdigest()[:16].encode() for text in texts]
    state.write_bytes(b"\n".join([head, *(a + b" " + b for a, b in zip(sums, texts, strict=True))]) + b"\n")
    found = rb.check_rs_robustness(*SMALL, state=state, time_limit=60)
    assert found.verdict is rb.Verdict.ROBUST
