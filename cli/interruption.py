"""Ctrl-C and time limits at any moment, also while a solver is at work.

Python raises KeyboardInterrupt in the main thread, wherever that happens to be. Inside a library's callback it may be
swallowed and turn up as another error; inside compiled code it waits. So the main thread does nothing but wait, long
work has a thread of its own, and after Ctrl-C that thread is left behind with the process. The library keeps time
limits itself, but it cannot stop what is not its own, a solver for instance.
"""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

__all__ = ["FAR_GRACE", "GRACE", "Overrun", "end_process", "interruptibly", "is_left_behind"]

#: Seconds that work may take beyond its time limit to come back with what it knows.
GRACE = 0.5

#: The same for work that other machines do, whose last words have to be collected.
FAR_GRACE = 5.0

_Result = TypeVar("_Result")

_abandoned: list[threading.Thread] = []


class Overrun(Exception):
    """The work did not keep its time limit."""

    def __str__(self) -> str:
        return "the time limit was reached: raise --timeout"


def interruptibly(
    work: Callable[[], _Result],
    limit: float | None = None,
    while_waiting: Callable[[], None] = lambda: None,
    *,
    is_far: bool = False,
) -> _Result:
    """Return what ``work()`` returns, or raise what it raises; Ctrl-C raises KeyboardInterrupt here at once.

    When ``limit`` seconds and the :data:`GRACE` (:data:`FAR_GRACE` when ``is_far``) are over, :class:`Overrun` is
    raised. In both cases the work goes on in the background until :func:`end_process`, so it must not print.
    ``while_waiting`` is called twice a second.
    """
    deadline = math.inf if limit is None else time.monotonic() + limit + (FAR_GRACE if is_far else GRACE)
    results: list[_Result] = []
    problems: list[BaseException] = []
    is_done = threading.Event()

    def run() -> None:
        try:
            results.append(work())
        except BaseException as problem:  # noqa: BLE001 - handed to the main thread, which raises it
            problems.append(problem)
        finally:
            is_done.set()

    thread = threading.Thread(target=run, daemon=True, name="search")
    thread.start()
    try:
        while not is_done.wait(max(0.0, min(0.5, deadline - time.monotonic()))):
            if time.monotonic() >= deadline:
                raise Overrun
            while_waiting()
    except (KeyboardInterrupt, Overrun):
        _abandoned.append(thread)
        raise
    if problems:
        raise problems[0]
    return results[0]


def is_left_behind() -> bool:
    """Return whether there is work that nobody waits for any more; then the process will end at once."""
    return any(thread.is_alive() for thread in _abandoned)


def end_process(code: int) -> None:
    """End the process with ``code``; at once, without waiting for other threads, when work was left behind."""
    if is_left_behind():
        from robustness.files.writing import forget_unfinished

        forget_unfinished()
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):  # closed, or nobody reads any more
                stream.flush()
        os._exit(code)
    sys.exit(code)
