"""One search spread over many workers by cubes, none of whom is trusted with more than the cube in its hands.

Cubes that outlast their slice of time come back and are cut where workers would run dry; the next slice is twice as
long. A result counts once, for the question and the cube it names, and only after it has been looked at: a violating
pair is checked against the definition, a cube that is left must be one. A cube that is lost is given out again a few
times, and then the verdict is UNDECIDED; so it is when no worker is left. What is closed goes into the journal first.

Whoever solves what, the verdict is the same. With transcripts these are joined in the order of the proof and whoever
verifies the certificate trusts no worker; without, the answer says how many cubes rest on the word of workers.
"""

from __future__ import annotations

import concurrent.futures
import hashlib
import itertools
import json
import time
import warnings
from collections import deque
from collections.abc import Hashable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from robustness.answers import Answer
from robustness.cubes.cube import Cube, CubeQuestion, software
from robustness.cubes.estimate import Estimate, Walker
from robustness.cubes.executors import CubeExecutor, cube_executor
from robustness.cubes.heard import Heard, WrongResult, heard
from robustness.cubes.journal import CubeJournal, Entry
from robustness.cubes.solving import PAIR_FOUND, solve
from robustness.definitions import is_violation
from robustness.digraph import Digraph, GraphWarning
from robustness.evidence import Exhausted, Pair, Refutation
from robustness.limits import Limits, Progress
from robustness.spelled import counted
from robustness.transcripts import Branch, Piece, Transcript

__all__ = ["search_by_cubes"]

#: Seconds of the first slice of a cube, and of the longest. Each has twice as long as the one before.
_FIRST_SLICE, _LONGEST_SLICE = 0.1, 5.0
#: For each worker: cubes that are kept open at least, so that it does not run dry, and cubes given out ahead of time.
_OPEN_EACH, _AHEAD = 8, 2
#: How often a cube is given out again when it was lost.
_TRIES = 5
#: A cube is given out once more when nothing was heard of it for so many of its slices, and seconds.
_PATIENCE, _GRACE = 20, 60.0
#: Seconds without any worker after which nobody is waited for any more.
_ALONE = 60.0
#: Walks of an estimate; the seconds before the first and between two; the part of the time that they may take.
_WALKS, _ESTIMATE_EVERY, _ESTIMATE_SHARE = 100, 2.0, 0.05
#: Seconds that an estimate may take: the last one is made when the time limit has passed.
_ESTIMATE_SECONDS = 0.5

#: No two tasks of this process have the same number: what an earlier search is told late is not taken for a later one.
_NUMBERS = itertools.count(1)


@dataclass(eq=False)
class _Piece:
    """A cube in its place in the proof: its transcript, then what was left of it."""

    cube: Cube
    slices: int = 0
    tries: int = 0
    is_done: bool = False
    transcript: Piece | None = None
    rest: list[_Piece] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        return min(_FIRST_SLICE * 2.0**self.slices, _LONGEST_SLICE)

    @property
    def is_tree(self) -> bool:
        """Whether the cube is one state."""
        return len(self.cube.symmetric) == 1

    @property
    def parts(self) -> list[Piece | Branch]:
        """Its transcript, and what was left of it."""
        own: list[Piece | Branch] = [] if self.transcript is None else [self.transcript]
        return own + list(self.rest)


def search_by_cubes(
    graph: Digraph, r: int, s: int, limits: Limits, *, transcript: bool, blockers: int, look_ahead: bool, sharing: bool
) -> Answer:
    """Decide (r,s)-robustness with the executor and the journal of ``limits``; switches as for ``subset-search``."""
    need = np.maximum(graph.in_degrees - r + 1, 0).astype(np.int64)
    question = CubeQuestion(graph.in_words, need, s - 1, transcript, blockers, look_ahead, sharing)
    asked = json.dumps([graph.sha256, r, s, transcript, blockers, look_ahead, sharing, software()])
    key = hashlib.sha256(asked.encode()).hexdigest()[:32]
    with ExitStack() as stack:
        executor = limits.executor
        if executor is None:
            executor = stack.enter_context(concurrent.futures.ThreadPoolExecutor(limits.jobs, "cubes"))
        workers = cube_executor(executor)
        journal = stack.enter_context(
            CubeJournal(None if limits.state is None else Path(limits.state), key, question.hears.shape[1])
        )
        stack.callback(workers.stop)
        return _Spread(graph, r, s, question, limits, workers, journal).run()


class _Spread:
    """The coordinator of one search."""

    def __init__(
        self,
        graph: Digraph,
        r: int,
        s: int,
        question: CubeQuestion,
        limits: Limits,
        workers: CubeExecutor,
        journal: CubeJournal,
    ) -> None:
        self.graph, self.r, self.s, self.question, self.limits = graph, r, s, question, limits
        self.workers, self.journal = workers, journal
        self.root = _Piece(Cube.whole(graph.n))
        self.waiting: deque[_Piece] = deque([self.root])
        self.running: dict[int, tuple[_Piece, float]] = {}
        self.overdue: dict[int, _Piece] = {}
        self.pair: Pair | None = None
        self.reason = self.refusal = ""
        self.stats: dict[str, Any] = {"nodes": 0, "failed_literals": 0, "probes": 0, "cubes": 0}
        self.told = {"by workers": 0, "by the journal": 0}
        self.lost = 0
        self.busy_seconds = 0.0
        self.fresh_nodes = 0
        self.walker = Walker(question, limits.seed)
        self.estimate: Estimate | None = None
        self.started = self.peopled = time.monotonic()
        self.next_estimate = self.started + _ESTIMATE_EVERY
        self.reported = self.started

    def run(self) -> Answer:
        """Search to the end, a pair, a limit or the loss of what cannot be replaced."""
        self._replay()
        if self.waiting and self.pair is None:
            # What is over in a moment needs no worker.
            piece = self.waiting.popleft()
            self._hear(piece, solve(self.question.as_task(piece.cube, piece.seconds)))
        while self._is_open() and self.pair is None and not self.reason:
            self._give_out()
            for number, outcome in self.workers.results(0.05):
                self._note(number, outcome)
            self._look_around()
        return self._answer()

    def _pieces(self) -> Iterator[_Piece]:
        """Return what waits, and what somebody works on; one that was overdue may be closed, or both."""
        yield from self.waiting
        yield from (piece for piece, _ in self.running.values())

    def _is_open(self) -> bool:
        return not all(piece.is_done for piece in self._pieces())

    def _note(self, number: Any, outcome: Any) -> None:
        """Take a result to the cube it was asked for; nothing when it comes twice, or is about another search."""
        if not isinstance(number, Hashable):
            return
        if number in self.running:
            piece, _ = self.running.pop(number)
        elif number in self.overdue and not isinstance(outcome, BaseException):
            piece = self.overdue.pop(number)  # given out again meanwhile: the answer that comes first counts
        else:
            return
        if not piece.is_done and self.pair is None:
            self._hear(piece, outcome)

    def _answer(self) -> Answer:
        self.stats |= {"trusted": self._trusted(), "lost": self.lost}
        if self.pair is not None:
            return Answer.violated_by(self.pair, self.stats)
        if self.reason:
            self._estimate()
            if self.estimate is not None:
                self.stats["estimate"] = self.estimate.as_dict()
            return Answer.undecided(self.reason, self.stats)
        if self.question.transcript:
            return Answer(Refutation(Transcript(self.root)), self.stats)
        return Answer(Exhausted(), self.stats)

    def _trusted(self) -> str:
        if self.question.transcript:
            return "nobody: every cube has its transcript"
        told = " and ".join(f"{count} {who}" for who, count in self.told.items() if count)
        return f"that cubes are closed, told {told or '0 by workers'}"

    def _replay(self) -> None:
        """Take from the journal all that it knows."""
        known, self.waiting = self.waiting, deque()
        met: set[str] = set()
        while known:
            piece = known.popleft()
            # No cube is left of itself. A journal that says so is not followed round and round.
            entry = None if piece.cube.key in met else self.journal.entries.get(piece.cube.key)
            met.add(piece.cube.key)
            if entry is None:
                self.waiting.append(piece)
            elif "pair" in entry:
                if self._take_pair(entry["pair"]):
                    return
                self.waiting.append(piece)
            else:
                self.told["by the journal"] += not entry["rest"]
                known.extend(self._settle(piece, entry))

    def _settle(self, piece: _Piece, entry: Entry) -> list[_Piece]:
        """Write down what came of a cube; return the pieces that are left of it."""
        piece.is_done, piece.transcript = True, entry["piece"]
        piece.rest = [_Piece(cube, piece.slices + 1) for cube in entry["rest"]]
        self.stats["nodes"] += entry["nodes"]
        self.stats["cubes"] += 1
        return piece.rest

    def _give_out(self) -> None:
        width = self.workers.width()
        while self.waiting and len(self.running) < _AHEAD * width and not self.reason:
            piece = self.waiting.popleft()
            if piece.is_done:
                continue
            seconds = max(min(piece.seconds, self.limits.seconds_left()), 0.01)
            number = next(_NUMBERS)
            self.running[number] = piece, time.monotonic() + _GRACE + _PATIENCE * seconds
            try:
                self.workers.submit(number, self.question.as_task(piece.cube, seconds))
            except Exception as problem:  # noqa: BLE001 - whatever somebody has who takes nothing any more
                self._note(number, problem)

    def _hear(self, piece: _Piece, outcome: Any) -> None:
        """Act on a result; anything that is not in order is a loss."""
        if isinstance(outcome, BaseException):
            self._lose(piece, f"{type(outcome).__name__}: {outcome}".splitlines()[0][:200])
            return
        try:
            result = heard(outcome, self.question, piece.cube)
        except WrongResult as wrong:
            self._lose(piece, str(wrong))
            return
        if result.version is not None:
            self._refuse(piece, result, outcome)
        elif result.status == PAIR_FOUND:
            if self._take_pair(result.pair):
                self.journal.remember(piece.cube, {"nodes": 0, "rest": [], "pair": result.pair}, b"")
            else:
                self._lose(piece, "a pair that violates nothing")
        else:
            self._take(piece, result)

    def _refuse(self, piece: _Piece, result: Heard, outcome: dict[str, Any]) -> None:
        """Give no more to a worker of another version, where its executor can tell it from the others."""
        who = f"worker {result.worker}" if result.worker else "a worker"
        word = f"{who} has version {result.version}, not {software()}: install the same on all machines"
        warnings.warn(f"refused: {word}", GraphWarning, stacklevel=2)
        self.refusal = f" ({word})"
        if self.workers.refuse(outcome):
            self.waiting.append(piece)
        else:
            self._lose(piece, word)

    def _take(self, piece: _Piece, result: Heard) -> None:
        """Write down what is closed, and what is left."""
        rest: list[Cube] = []
        if result.rest is not None:
            short = _OPEN_EACH * max(self.workers.width(), 1) - len(self.waiting) - len(self.running)
            rest = result.rest.cut(max(1, short + 1))
        entry: Entry = {"nodes": result.nodes, "piece": None, "rest": rest}
        if self.question.transcript:
            entry["piece"] = self.journal.spool.keep_packed(result.packed, result.size)
        self.journal.remember(piece.cube, entry, result.packed)
        self.told["by workers"] += not rest
        self.stats["failed_literals"] += result.failed
        self.stats["probes"] += result.probes
        self.fresh_nodes += result.nodes
        self.busy_seconds += result.seconds
        self.waiting.extend(reversed(self._settle(piece, entry)))

    def _take_pair(self, sides: Any) -> bool:
        """Take a violating pair after checking it against the definition."""
        first, second = map(frozenset, sides)
        is_pair = all(0 <= i < self.graph.n for i in first | second)
        if is_pair and is_violation(self.graph, first, second, self.r, self.s):
            self.pair = Pair(first, second)
            return True
        return False

    def _lose(self, piece: _Piece, why: str) -> None:
        self.lost += 1
        piece.tries += 1
        self.waiting.append(piece)
        if piece.tries >= _TRIES:
            self.reason = f"a cube was lost {piece.tries} times: {why}"

    def _look_around(self) -> None:
        """See to the clock, to workers that are gone or silent, to the estimate and to progress."""
        now = time.monotonic()
        if self.limits.expired():
            self.reason = self.reason or "the time limit was reached"
            return
        if self.workers.width():
            self.peopled = now
        elif now - self.peopled > _ALONE:
            self.reason = f"there was no worker for {_ALONE:.0f} seconds{self.refusal}"
        for number, (piece, due) in list(self.running.items()):
            if now > due:
                del self.running[number]
                if not piece.is_done:
                    self.overdue[number] = piece
                    self._lose(piece, f"nothing was heard of it for {_GRACE:.0f} seconds and {_PATIENCE} slices")
        if now >= self.next_estimate and self.limits.progress is not None:
            self._estimate()
            self.next_estimate = now + max(_ESTIMATE_EVERY, (time.monotonic() - now) / _ESTIMATE_SHARE)
        if self.limits.progress is not None and now - self.reported > 0.2:
            self.reported = now
            cubes = f"{counted(len(self.waiting) + len(self.running), 'cube')} open"
            note = cubes if self.estimate is None else f"{self.estimate.in_words()}, {cubes}"
            self.limits.progress(Progress(self.stats["nodes"], note))

    def _estimate(self) -> None:
        """Estimate what is left of the cubes that are open."""
        pieces = list(dict.fromkeys(piece for piece in self._pieces() if not piece.is_done))
        if not pieces:
            return
        left, low, high = self.walker.nodes_left([piece.cube for piece in pieces], _WALKS, _ESTIMATE_SECONDS)
        rate = self.fresh_nodes / self.busy_seconds if self.busy_seconds else 0.0
        self.estimate = Estimate(self.stats["nodes"], left, low, high, self.workers.width(), rate)
