"""Driving the compiled search: slices between two looks at the clock, a growing stack, a solution as id sets."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InternalError
from robustness.limits import Limits, Progress
from robustness.traps.kernel import ROWS, P, Q
from robustness.traps.loop import CLOSED, FOUND, GROW, NODES, PAUSED, PROBES, search
from robustness.traps.question import Question, Sets

__all__ = ["decide"]

#: A slice of a search aims at this many seconds between two looks at the clock.
_SLICE = 0.02


#: Levels that a stack has at first; it doubles when they do not suffice.
_LEVELS = 64

#: Strategies for M, see :mod:`robustness.traps.loop`.
_LAZY, _EAGER = 0, 1


def decide(
    graph: Digraph, question: Question, limits: Limits, *, counting: bool = True, look_ahead: bool = True
) -> tuple[bool | None, Sets | None, Mapping[str, Any]]:
    """Return whether a solution exists (None past the deadline), one, and counters.

    Exponential in the worst case. ``counting`` and ``look_ahead`` are switches for what they are named after; the
    answer does not depend on them. Two searches that differ in when M is drawn take turns; the first to end decides.
    """
    hears = graph.in_words
    need = np.maximum(graph.in_degrees - question.f, 0).astype(np.int64)
    runs = [_Run(hears, need, question, counting, look_ahead, eager) for eager in (_LAZY, _EAGER)[: 1 + look_ahead]]
    told = time.monotonic()
    while True:
        for run in runs:
            run.advance()
            stats = {"nodes": sum(each.nodes for each in runs), "probes": sum(each.probes for each in runs)}
            if run.is_closed:
                return False, None, stats
            if run.solution is not None:
                return True, run.solution, stats
            if limits.expired():
                return None, None, stats | {"reason": "the time limit was reached"}
        if limits.progress is not None and time.monotonic() - told > 0.2:
            told = time.monotonic()
            limits.progress(Progress(stats["nodes"], f"traps for f = {question.f}"))


class _Run:
    """One search under one strategy, advanced a slice at a time."""

    def __init__(
        self,
        hears: npt.NDArray[np.uint64],
        need: npt.NDArray[np.int64],
        question: Question,
        counting: bool,
        look_ahead: bool,
        eager: int,
    ) -> None:
        n, words = hears.shape
        self._question = question
        self._fixed = (
            hears, need, min(question.f, n), int(question.two_faces), int(question.local), int(counting),
            int(look_ahead), eager,
        )  # fmt: skip
        self._stack = np.zeros((_LEVELS, ROWS, words), np.uint64)
        self._stack[0] = _whole_state(n, words)
        self._symmetric = np.zeros(_LEVELS, np.int64)
        self._symmetric[0] = 1
        self._counters = np.zeros(3, np.int64)
        self._found = np.zeros((4, words), np.uint64)
        self._level = 0
        # Counted, not timed: the two strategies take turns of equal length on every machine, so that the same one ends
        # first. About a fiftieth of a second.
        self._quota = max(1, 20_000_000 // (20_000 + 4 * n * n * words))
        self.is_closed = False
        self.solution: Sets | None = None

    @property
    def nodes(self) -> int:
        """States that were propagated."""
        return int(self._counters[NODES])

    @property
    def probes(self) -> int:
        """Literals that the look-ahead tried."""
        return int(self._counters[PROBES])

    def advance(self) -> None:
        """Search for one turn; ``is_closed`` or ``solution`` tells when it is over."""
        why, self._level = search(
            self._stack, self._symmetric, self._level, *self._fixed, self._quota, self._counters, self._found
        )
        if why == CLOSED:
            self.is_closed = True
        elif why == FOUND:
            self.solution = _sets(self._found, self._question.two_faces)
        elif why == GROW:
            self._stack = np.concatenate([self._stack, np.zeros_like(self._stack)])
            self._symmetric = np.concatenate([self._symmetric, np.zeros_like(self._symmetric)])
        elif why != PAUSED:
            raise InternalError(f"the trap search stopped with status {why}: please report")


def _whole_state(n: int, words: int) -> npt.NDArray[np.uint64]:
    """Return the state in which every node may have every role."""
    state = np.zeros((ROWS, words), np.uint64)
    for node in range(n):
        state[[P, P + 1, Q, Q + 1], node // 64] |= np.uint64(1) << np.uint64(node % 64)
    return state


def _sets(found: npt.NDArray[np.uint64], two_faces: bool) -> Sets:
    bits = [frozenset(np.flatnonzero(np.unpackbits(row.view(np.uint8), bitorder="little")).tolist()) for row in found]
    if two_faces:
        return Sets(bits[0], bits[2], bits[3])
    return Sets(bits[0] | bits[1], bits[2] | bits[0], bits[3] | bits[1])
