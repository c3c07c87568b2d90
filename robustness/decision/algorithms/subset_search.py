"""Pruned search over node sets with pair counting and look-ahead; the workhorse of the toolkit.

Non-r-reachable sets are closed under union, so inside any candidate set there is one largest, found by peeling; the
search keeps such candidate sets for both sides of a violating pair and shrinks them by the rules of
:mod:`robustness.kernels.search_rules` (disjoint, peel, force, share, count) and look-ahead. The swap symmetry of
pairs is broken by roots: refute every pair that has v as a satisfied node of S1; then v is satisfied in neither set. A
percolating seed of roots empties the candidates, and the refutation is complete.

Every step is recorded on demand in the transcript that ``certificates`` replays, and every rule has a switch:
``blockers=0`` turns counting off, ``blockers=1`` leaves pair counting only, ``sharing=False``
turns off *share*, ``look_ahead=False`` branches blindly. (*disjoint*, *peel* and *force* are what a state means.)

Threads share the work by cubes: a thread that runs dry takes the shallowest pending subproblem of a busy one. The
verdict does not depend on who solves what; which violating pair is found first may.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.answers import Answer
from robustness.cubes.cube import ids_of, whole_state
from robustness.digraph import Digraph
from robustness.errors import InternalError, InvalidParameter
from robustness.evidence import Exhausted, Pair, Refutation
from robustness.kernels.layout import (
    CLOSED,
    DONATED,
    FAILED,
    FLUSH,
    FOUND,
    GIVEN,
    GROW,
    NODES,
    PAUSED,
    PENDING,
    PROBES,
    SYMMETRIC,
)
from robustness.limits import Limits, Progress
from robustness.spelled import counted
from robustness.transcripts import Branch, Piece, Spool, Transcript

__all__ = ["MOST_NODES", "decide"]

_Words = npt.NDArray[np.uint64]

#: A slice of the search aims at this many seconds between two looks at the clock, the stop flag and idle threads.
_SLICE = 0.02

#: Trees that are noted at most in each slice, when they are recorded.
_NOTED = 4

#: Masks take n * n / 8 bytes; beyond this many nodes the search is not the right tool.
MOST_NODES = 20_000


@dataclass(slots=True)
class Tree:
    """What refutes one state, in the order of the proof: pieces of the transcript, and trees within."""

    parts: list[Piece | Branch] = field(default_factory=list, kw_only=True)
    is_tree: bool = field(default=True, kw_only=True)


@dataclass(slots=True)
class Cube(Tree):
    """A subproblem: a state that has not been propagated, and whether it is still symmetric in the two sides."""

    state: _Words
    symmetric: bool


def decide(
    graph: Digraph,
    r: int,
    s: int,
    limits: Limits,
    *,
    transcript: bool = False,
    blockers: int = 2,
    look_ahead: bool = True,
    sharing: bool = True,
) -> Answer:
    """Decide (r,s)-robustness by pruned search; exponential in the worst case, honours every limit.

    Parameters
    ----------
    transcript : bool
        Record the refutation, for a certificate.
    blockers : 0, 1 or 2
        How many satisfied nodes the counting rule may combine; 0 switches it off.
    look_ahead : bool
        Whether branching first tries a few nodes as satisfied ones: those that cannot be are settled at once.
    sharing : bool
        Whether exempt nodes that one side cannot do without are not left for the other; a transcript needs it, since
        whoever verifies it applies that rule by itself.
    """
    if blockers not in (0, 1, 2):
        raise InvalidParameter(f"blockers is 0, 1 or 2, not {blockers!r}")
    if transcript and not sharing:
        raise InvalidParameter("a transcript is recorded with the rule share on: leave sharing out")
    if graph.n > MOST_NODES:
        return Answer.undecided(f"subset-search takes at most {MOST_NODES} nodes")
    if limits.steps is None and (limits.executor is not None or limits.state is not None):
        from robustness.cubes.spreading import search_by_cubes

        switches: dict[str, Any] = {"blockers": blockers, "look_ahead": look_ahead, "sharing": sharing}
        return search_by_cubes(graph, r, s, limits, transcript=transcript, **switches)
    return _Search(graph, r, s, limits, transcript, blockers, look_ahead, sharing).run()


class _Search:
    """One question, its queue of cubes, and the threads that empty it."""

    def __init__(
        self,
        graph: Digraph,
        r: int,
        s: int,
        limits: Limits,
        transcript: bool,
        blockers: int,
        look_ahead: bool,
        sharing: bool,
    ) -> None:
        self.hears = graph.in_words
        self.need = np.maximum(graph.in_degrees - r + 1, 0).astype(np.int64)
        self.spare = s - 1
        self.limits = limits
        self.nodes_left = limits.nodes_allowed(graph.n)
        self.transcript = transcript
        self.spool = Spool()
        self.blockers = blockers
        self.look_ahead, self.sharing = look_ahead, sharing
        self.root = Cube(whole_state(graph.n), symmetric=True)
        self.lock = threading.Condition()
        self.queue: deque[Cube] = deque([self.root])
        self.busy = 0
        self.stopped = False
        self.reason = ""
        self.pair: Pair | None = None
        self.failure: BaseException | None = None
        self.counters = np.zeros((max(1, limits.jobs), 3), np.int64)
        self.cubes = 1
        self._given: dict[tuple[int, int], Cube] = {}
        self.reported = time.monotonic()

    def run(self) -> Answer:
        """Search to the end, a pair or a limit; Ctrl-C stops all threads and is passed on."""
        helpers: list[threading.Thread] = []
        try:
            for k in range(1, self.limits.jobs):
                helper = threading.Thread(target=self._work, args=(k,), daemon=True)
                try:
                    helper.start()
                except RuntimeError:  # the system has no more threads to give: those that run are enough
                    break
                helpers.append(helper)
            self._work(0)
        finally:
            with self.lock:
                self.stopped = True
                self.lock.notify_all()
            for helper in helpers:
                helper.join()
        if self.failure is not None:
            raise self.failure
        total = self.counters.sum(axis=0)
        stats: dict[str, Any] = {
            "nodes": int(total[NODES]),
            "failed_literals": int(total[FAILED]),
            "probes": int(total[PROBES]),
            "cubes": self.cubes,
        }
        if self.pair is not None:
            return Answer.violated_by(self.pair, stats)
        if self.reason:
            return Answer.undecided(self.reason, stats)
        return Answer(Refutation(Transcript(self.root)) if self.transcript else Exhausted(), stats)

    def _work(self, number: int) -> None:
        try:
            while (cube := self._next_cube()) is not None:
                self._solve(cube, number)
                with self.lock:
                    self.busy -= 1
                    self.lock.notify_all()
        except BaseException as problem:
            with self.lock:
                self.failure, self.stopped = problem, True
                self.lock.notify_all()
            if number == 0:
                raise

    def _next_cube(self) -> Cube | None:
        """Wait for a cube; None when the search is over (every thread idle and the queue empty, or stopped)."""
        with self.lock:
            while not self.queue and self.busy and not self.stopped:
                self.lock.wait(0.05)
            if self.stopped or not self.queue:
                return None
            self.busy += 1
            return self.queue.popleft()

    def _solve(self, cube: Cube, number: int) -> None:
        from robustness.kernels.search_loop import Search
        from robustness.kernels.search_rules import Rules

        n = self.hears.shape[0]
        rules = Rules(self.hears, self.need, self.spare, self.blockers, self.sharing)
        if self.transcript:
            rules.buffer, rules.place = np.empty(32 * n * n + 4096 + 2**16, np.uint8), 0
        search = Search(rules, self.look_ahead)
        search.counters = self.counters[number]
        open_trees: list[tuple[int, Tree]] = [(-1, cube)]
        np.asarray(search.stack)[0] = cube.state
        np.asarray(search.table)[0] = (1, cube.symmetric, 0)
        quota = 1
        while granted := self._granted(quota):
            begun, before = time.monotonic(), int(self.counters[number, NODES])
            status = search.run(granted)
            self._return(granted - (int(self.counters[number, NODES]) - before))
            if status in (CLOSED, FLUSH, DONATED):
                self._take_transcript(open_trees[-1][1], rules)
            if status == PAUSED:
                quota = _adjusted(quota, time.monotonic() - begun)
            if self._is_over(status, cube, search, number, open_trees):
                return

    def _is_over(self, status: int, cube: Cube, search: Any, number: int, open_trees: list[tuple[int, Tree]]) -> bool:
        """Act on why the kernel returned; return whether the cube is done with."""
        if status == CLOSED:
            return True
        if status == FOUND:
            self._stop(pair=Pair(*(ids_of(side) for side in np.asarray(search.pair))))
            return True
        if status == GROW:
            stack, table = np.asarray(search.stack), np.asarray(search.table)
            search.stack = np.concatenate([stack, np.zeros_like(stack)])
            search.table = np.concatenate([table, np.zeros_like(table)])
        elif status == DONATED:
            return self._come_back(cube, search, open_trees)
        elif status == PAUSED:
            if self._must_stop(number):
                return True
            if self.limits.jobs > 1:
                self._donate(cube, np.asarray(search.stack), np.asarray(search.table), search.level)
                self._note(np.asarray(search.table), search.level)
        elif status != FLUSH:
            raise InternalError(f"the search kernel stopped with status {status}: please report")
        return False

    def _come_back(self, cube: Cube, search: Any, open_trees: list[tuple[int, Tree]]) -> bool:
        """Go on from a level that was handed on or noted, which ends all trees above it; return whether all is done."""
        level = int(search.level)
        np.asarray(search.table)[level, GIVEN] = 0
        while open_trees[-1][0] > level:
            open_trees.pop()
        given = self._given.pop((id(cube), level), None)
        tree = given or Tree()
        open_trees[-1][1].parts.append(tree)
        if given is None:
            open_trees.append((level, tree))
            return False
        search.level -= 1
        return level == 0

    def _take_transcript(self, tree: Tree, rules: Any) -> None:
        """Move what the kernel has written to the tree that it is about."""
        if self.transcript:
            tree.parts.append(self.spool.keep(np.asarray(rules.buffer)[: rules.place].tobytes()))
            rules.place = 0

    def _granted(self, quota: int) -> int:
        """Return how many of ``quota`` nodes may be visited now; 0 ends the search, which the budget has stopped.

        With one thread the search ends after exactly as many nodes as the budget allows, however fast the machine is.
        """
        with self.lock:
            granted = min(quota, self.nodes_left)
            self.nodes_left -= granted
        if not granted:
            self._stop(reason="the budget of steps was spent")
        return granted

    def _return(self, unused: int) -> None:
        with self.lock:
            self.nodes_left += unused

    def _donate(self, cube: Cube, stack: _Words, table: npt.NDArray[np.int64], level: int) -> None:
        """Hand the shallowest pending subproblem to an idle thread, if there is one."""
        with self.lock:
            if self.queue or self.busy >= self.limits.jobs:
                return
            for k in range(level):
                if table[k, PENDING] and (id(cube), k) not in self._given:
                    given = Cube(stack[k].copy(), bool(table[k, SYMMETRIC]))
                    table[k, GIVEN] = 1
                    self._given[id(cube), k] = given
                    self.queue.append(given)
                    self.cubes += 1
                    self.lock.notify_all()
                    return

    def _note(self, table: npt.NDArray[np.int64], level: int) -> None:
        """Stop at a few more of the shallowest levels when they are come to: trees that can be verified apart."""
        if self.transcript:
            fresh = np.flatnonzero(table[:level, PENDING] & ~table[:level, GIVEN] & 1)
            table[fresh[:_NOTED], GIVEN] = 1

    def _stop(self, *, pair: Pair | None = None, reason: str = "") -> None:
        with self.lock:
            if not self.stopped:
                self.stopped, self.pair, self.reason = True, pair, reason
            self.lock.notify_all()

    def _must_stop(self, number: int) -> bool:
        if self.limits.expired():
            self._stop(reason="the time limit was reached")
        now = time.monotonic()
        if number == 0 and self.limits.progress is not None and now - self.reported > 0.2:
            self.reported = now
            nodes = int(self.counters[:, NODES].sum())
            self.limits.progress(Progress(nodes, f"{counted(len(self.queue) + self.busy, 'cube')} open"))
        return self.stopped


def _adjusted(quota: int, took: float) -> int:
    """Return the quota of the next slice after one that took so many seconds."""
    return int(min(max(quota * min(4.0, _SLICE / max(took, 1e-6)), 1), 1 << 30))
