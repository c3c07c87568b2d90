"""Driving the compiled search: slices between two looks at the clock, a growing stack, a solution as id sets."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InternalError
from robustness.kernels.layout import CLOSED, FLUSH, FOUND, GROW, NODES, PAUSED, PROBES, TRAP_P, TRAP_Q, TRAP_ROWS
from robustness.limits import Limits, Progress
from robustness.traps.question import Question, Sets, TrapAnswer

__all__ = ["decide"]

#: Levels that a stack has at first; it doubles when they do not suffice.
_LEVELS = 64


def decide(
    graph: Digraph,
    question: Question,
    limits: Limits,
    *,
    counting: bool = True,
    look_ahead: bool = True,
    transcript: bool = False,
) -> TrapAnswer:
    """Return whether a solution exists (None past the deadline or the budget of steps), one, and counters.

    Exponential in the worst case. ``counting`` and ``look_ahead`` are switches for what they are named after; the
    answer does not depend on them. With ``transcript`` the answer that there is no solution carries the refutation that
    :func:`certificates.verify_tolerance` replays; it needs ``counting``. Two searches that differ in when M is drawn
    (:mod:`robustness.kernels.trap_loop`) take turns, with more than one job at the same time; the first to end decides.
    """
    hears = graph.in_words
    need = np.maximum(graph.in_degrees - question.f, 0).astype(np.int64)
    runs = [
        _Run(hears, need, question, counting, look_ahead, eager, transcript)
        for eager in (False, True)[: 1 + look_ahead]
    ]
    told, allowed = time.monotonic(), limits.nodes_allowed(graph.n)
    for run in _turns(runs, limits.jobs):
        stats = {"nodes": sum(each.nodes for each in runs), "probes": sum(each.probes for each in runs)}
        if run.is_closed:
            return TrapAnswer(False, stats=stats, transcript=b"".join(run.transcript) if transcript else None)
        if run.solution is not None:
            return TrapAnswer(True, run.solution, stats=stats)
        if limits.expired():
            return TrapAnswer.undecided("the time limit was reached", stats)
        if stats["nodes"] >= allowed:
            return TrapAnswer.undecided("the budget of steps was spent", stats)
        if limits.progress is not None and time.monotonic() - told > 0.2:
            told = time.monotonic()
            limits.progress(Progress(stats["nodes"], f"traps for f = {question.f}"))
    raise AssertionError("turns are taken without end")


def _turns(runs: list[_Run], jobs: int) -> Iterator[_Run]:
    """Advance the runs in turns for ever; yield each after its turn.

    After the first, which settles most questions, the turns are taken at the same time where there are two threads.
    """
    for turn in itertools.count():
        together = turn > 0 and jobs > 1
        if together:
            # Turns are short, so Ctrl-C waits for their end.
            with ThreadPoolExecutor(len(runs), "robustness-traps") as pool:
                for done in [pool.submit(run.advance) for run in runs]:
                    done.result()
        for run in runs:
            if not together:
                run.advance()
            yield run


class _Run:
    """One search under one strategy, advanced a turn at a time."""

    def __init__(
        self,
        hears: npt.NDArray[np.uint64],
        need: npt.NDArray[np.int64],
        question: Question,
        counting: bool,
        look_ahead: bool,
        eager: bool,
        transcript: bool,
    ) -> None:
        from robustness.kernels.trap_loop import TrapSearch
        from robustness.kernels.trap_rules import TrapRules

        n, words = hears.shape
        self._question = question
        rules = TrapRules(hears, need, min(question.f, n), question.two_faces, question.local, counting)
        if transcript:
            rules.buffer, rules.place = np.empty(32 * n * n + 4096 + 2**16, np.uint8), 0
        self._search = TrapSearch(rules, look_ahead, eager)
        self._search.stack = np.zeros((_LEVELS, TRAP_ROWS, words), np.uint64)
        self._search.symmetric = np.zeros(_LEVELS, np.int64)
        np.asarray(self._search.stack)[0] = _whole_state(n, words)
        np.asarray(self._search.symmetric)[0] = 1
        # Counted, not timed: the two strategies take turns of equal length on every machine, so that the same one ends
        # first. About a fiftieth of a second.
        self._quota = max(1, 20_000_000 // (20_000 + 4 * n * n * words))
        self.is_closed = False
        #: The pieces of the transcript, if one is kept.
        self.transcript: list[bytes] = []
        self.solution: Sets | None = None

    @property
    def nodes(self) -> int:
        """States that were propagated."""
        return int(self._search.counters[NODES])

    @property
    def probes(self) -> int:
        """Literals that the look-ahead tried."""
        return int(self._search.counters[PROBES])

    def advance(self) -> None:
        """Search for one turn; ``is_closed`` or ``solution`` tells when it is over."""
        search = self._search
        why = search.run(self._quota)
        if search.rules.place >= 0 and why in (CLOSED, FLUSH):
            self.transcript.append(np.asarray(search.rules.buffer)[: search.rules.place].tobytes())
            search.rules.place = 0
        if why == CLOSED:
            self.is_closed = True
        elif why == FOUND:
            self.solution = _sets(np.asarray(search.found), self._question.two_faces)
        elif why == GROW:
            stack, symmetric = np.asarray(search.stack), np.asarray(search.symmetric)
            search.stack = np.concatenate([stack, np.zeros_like(stack)])
            search.symmetric = np.concatenate([symmetric, np.zeros_like(symmetric)])
        elif why not in (PAUSED, FLUSH):
            raise InternalError(f"the trap search stopped with status {why}: please report")


def _whole_state(n: int, words: int) -> npt.NDArray[np.uint64]:
    """Return the state in which every node may have every role."""
    state = np.zeros((TRAP_ROWS, words), np.uint64)
    for node in range(n):
        state[[TRAP_P, TRAP_P + 1, TRAP_Q, TRAP_Q + 1], node // 64] |= np.uint64(1) << np.uint64(node % 64)
    return state


def _sets(found: npt.NDArray[np.uint64], two_faces: bool) -> Sets:
    bits = [frozenset(np.flatnonzero(np.unpackbits(row.view(np.uint8), bitorder="little")).tolist()) for row in found]
    if two_faces:
        return Sets(bits[0], bits[2], bits[3])
    return Sets(bits[0] | bits[1], bits[2] | bits[0], bits[3] | bits[1])
