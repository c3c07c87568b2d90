"""How long and how hard to work: the user's limits, and budgets that are counted instead of timed.

A time limit is the user's own; nothing else here is measured in seconds. Heuristics and short searches have budgets of
*steps*, elementary operations such as looking at one arc, so that the same input, seed and version give the same
answer on an idle machine and on a busy one. One step takes about a nanosecond.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from robustness.errors import InvalidParameter

__all__ = ["UNBOUNDED", "UNLIMITED", "Limits", "Progress", "Steps"]

#: The shortest time limit.
_MOMENT = 1e-9

#: More steps than any machine makes.
UNLIMITED = 1 << 62


@dataclass(frozen=True, slots=True)
class Progress:
    """What a long search reports now and then: counters, and what it is doing in a few words."""

    nodes: int
    note: str


@dataclass(frozen=True, slots=True)
class Limits:
    """How long and how hard an algorithm may work.

    Attributes
    ----------
    deadline : float or None
        A value of ``time.monotonic()``; past it the answer is UNDECIDED.
    jobs : int
        Threads.
    seed : int
        Of every random choice.
    progress : callable or None
        Called with a :class:`Progress` a few times a second.
    steps : int or None
        A budget for one exact search, counted and not timed; past it the answer is UNDECIDED. Only searches that can
        count their work keep to it.
    executor : concurrent.futures.Executor, distributed.Client or robustness.cubes.CubeExecutor, optional
        Who solves the cubes of an exact search that has no budget of steps; else the threads of this process do.
    state : path, optional
        A journal of closed cubes, with which a search that is asked again goes on where it was.
    """

    deadline: float | None = None
    jobs: int = 1
    seed: int = 0
    progress: Callable[[Progress], None] | None = None
    steps: int | None = None
    executor: Any = None
    state: str | Path | None = None

    @classmethod
    def of(
        cls,
        time_limit: float | None,
        jobs: int = 1,
        seed: int = 0,
        progress: Callable[[Progress], None] | None = None,
    ) -> Limits:
        """Return what the user asked for, with the clock started now.

        Raises
        ------
        InvalidParameter
            For a time that is no positive, finite number of seconds, and for less than one thread.
        """
        if type(jobs) is not int or jobs < 1:
            raise InvalidParameter(f"jobs is an integer of at least 1, not {jobs!r}")
        return cls(None, jobs, seed, progress).within(time_limit, "time_limit")

    def within(self, seconds: float | None, name: str = "seconds") -> Limits:
        """Return these limits, over at most so many seconds from now; None changes nothing."""
        if seconds is None:
            return self
        if isinstance(seconds, bool) or not (math.isfinite(seconds) and seconds > 0):
            raise InvalidParameter(f"{name} is a positive, finite number of seconds, not {seconds!r}")
        ends = time.monotonic() + seconds
        return replace(self, deadline=ends if self.deadline is None else min(ends, self.deadline))

    def share(self, part: float) -> Limits:
        """Return these limits with this part of the time that is left; without a deadline, the same limits."""
        if self.deadline is None:
            return self
        now = time.monotonic()
        return replace(self, deadline=now + part * max(0.0, self.deadline - now))

    def counted(self, steps: int | None) -> Limits:
        """Return these limits with another budget of steps."""
        return replace(self, steps=steps)

    def keywords(self) -> dict[str, Any]:
        """Return these limits, whole, as the keywords that every public front takes.

        Once the deadline has passed a moment is left, in which a front settles what needs no search.
        """
        left = None if self.deadline is None else max(_MOMENT, self.deadline - time.monotonic())
        effort = {"time_limit": left, "jobs": self.jobs, "seed": self.seed, "progress": self.progress}
        return effort | self._cubes()

    def _cubes(self) -> dict[str, Any]:
        """Return where cubes are solved and written down, for the fronts that were asked to: others do not take it."""
        found = {"executor": self.executor, "state": self.state}
        return {name: value for name, value in found.items() if value is not None}

    def spread_over(self, executor: Any = None, state: str | Path | None = None) -> Limits:
        """Return these limits with another executor and journal of cubes."""
        return replace(self, executor=executor, state=state)

    def nodes_allowed(self, n: int) -> int:
        """Return how many nodes a tree search on n graph nodes may visit: the whole budget of steps, or no end.

        One costs 10,000 steps and two for each pair of graph nodes. Measured: 9 to 20 microseconds a node on 25 to 100
        graph nodes, look-ahead included.
        """
        words = -(-n // 64)
        return UNLIMITED if self.steps is None else max(1, self.steps // (10_000 + 2 * n * n * words))

    def seconds_left(self) -> float:
        """Return the seconds until the deadline (``inf`` without one, never negative)."""
        return float("inf") if self.deadline is None else max(0.0, self.deadline - time.monotonic())

    def expired(self) -> bool:
        """Return whether the deadline has passed."""
        return self.deadline is not None and time.monotonic() >= self.deadline


#: One thread, for as long as it takes.
UNBOUNDED = Limits()


@dataclass(slots=True)
class Steps:
    """A budget of steps that heuristics draw on, and the user's wish to stop.

    Attributes
    ----------
    left : int
        Steps that may still be made; below zero when the last work cost more than was left.
    stop : callable or None
        Asked between pieces of work (every few milliseconds) whether to give up.
    """

    left: int = UNLIMITED
    stop: Callable[[], bool] | None = None

    def spend(self, steps: int) -> None:
        """Take note of work that was done."""
        self.left -= steps

    def over(self) -> bool:
        """Return whether to give up: the budget is spent or the user wants to stop."""
        return self.left <= 0 or (self.stop is not None and self.stop())

    def part(self, most: int) -> Steps:
        """Return a separate budget, of at most ``most`` steps and no more than are left here, with the same stop."""
        return Steps(min(most, self.left), self.stop)
