"""Long work that Python cannot interrupt, in a thread that the caller waits for in short steps.

Python runs signal handlers in the main thread, between byte codes; inside a solver's call there are none. So the solver
works in a thread of its own, and Ctrl-C, or whatever else is raised while the caller waits, asks it to stop.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TypeVar

__all__ = ["GRACE", "in_a_thread"]

_Result = TypeVar("_Result")

#: Seconds between two looks.
_STEP = 0.1

#: Seconds that work is given to end after it was asked to stop; then it is left to itself.
GRACE = 0.25


def in_a_thread(
    name: str,
    work: Callable[[], _Result],
    stop: Callable[[], None] | None = None,
    while_waiting: Callable[[], None] = lambda: None,
) -> _Result:
    """Return what ``work()`` returns, or raise what it raises, a crash of the solver included.

    Parameters
    ----------
    name : str
        Of the thread.
    work : callable
        What takes long.
    stop : callable or None
        Makes ``work`` end soon; called when the wait is broken off, which then lasts for ``GRACE`` seconds at most.
        None: it cannot be stopped. What does not end is left to itself; the process does not wait for it.
    while_waiting : callable
        Called ten times a second; what it raises breaks the wait off.
    """
    outcome: Future[_Result] = Future()

    def run() -> None:
        try:
            outcome.set_result(work())
        except BaseException as problem:  # noqa: BLE001  # the waiting thread raises it
            outcome.set_exception(problem)

    worker = threading.Thread(target=run, name=name, daemon=True)
    try:
        worker.start()
        while not wait([outcome], timeout=_STEP).done:
            while_waiting()
    except BaseException:
        if stop is not None:
            stop()
            worker.join(GRACE)
        raise
    return outcome.result()
