"""Child processes: whatever is measured runs in one, so that a cap is hard and no memory is shared.

A worker serves one call at a time and stays warm between calls (imports done). A call that is not
back in time is killed with its process, whatever it is doing, and the next call gets a fresh one.
"""

from __future__ import annotations

import multiprocessing
import signal
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any

__all__ = ["CallFailed", "OutOfTime", "Worker", "WorkerLost"]

#: Seconds for imports.
_WARM_UP_SECONDS = 600.0


class OutOfTime(Exception):
    """The call did not return in time; its process was killed."""


class WorkerLost(Exception):
    """The process died during the call (a crash, or no memory); nothing is known about the question."""


class CallFailed(Exception):
    """The call raised; the message is its traceback."""


class Worker:
    """A child process, started when it is first needed, that calls importable functions.

    >>> with Worker() as worker:
    ...     worker.call(max, 1, 2, seconds=60)
    2
    """

    def __init__(self, warm_up: Callable[[], object] | None = None) -> None:
        self._warm_up = warm_up
        self._process: multiprocessing.process.BaseProcess | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.discard()

    def call(self, function: Callable[..., Any], *arguments: Any, seconds: float) -> Any:
        """Return ``function(*arguments)``, called in the child; its start and its warm-up are not counted.

        Raises
        ------
        OutOfTime, WorkerLost, CallFailed
        """
        connection = self._connection or self._start()
        connection.send((function, arguments))
        succeeded, value = self._receive(connection, seconds)
        if not succeeded:
            raise CallFailed(value)
        return value

    def discard(self) -> None:
        """Kill the process, if there is one; the next call starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
        if self._connection is not None:
            self._connection.close()
        self._process = self._connection = None

    def _start(self) -> Connection:
        # Spawned, not forked: the child has no threads, caches or memory of this process.
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, self._warm_up), daemon=True)
        self._connection = ours
        self._process.start()
        theirs.close()
        succeeded, value = self._receive(ours, _WARM_UP_SECONDS)
        if not succeeded:
            raise CallFailed(value)
        return ours

    def _receive(self, connection: Connection, seconds: float) -> tuple[bool, Any]:
        if not connection.poll(seconds):
            self.discard()
            raise OutOfTime(f"killed after {seconds:.1f} s")
        try:
            succeeded, value = connection.recv()
        except (EOFError, ConnectionResetError):
            process = self._process
            if process is not None:
                process.join()
            code = None if process is None else process.exitcode
            self.discard()
            raise WorkerLost(f"the process ended with exit code {code}") from None
        return succeeded, value


def _serve(connection: Connection, warm_up: Callable[[], object] | None) -> None:
    """Warm up, then answer calls until the parent closes the pipe. Ctrl-C is the parent's to serve: it kills us."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection.send(_outcome(warm_up or (lambda: None), ()))
    while True:
        try:
            function, arguments = connection.recv()
        except EOFError:
            return
        connection.send(_outcome(function, arguments))


def _outcome(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, function(*arguments)
    except Exception:  # noqa: BLE001  # whatever it is, the parent fails the run with it
        return False, traceback.format_exc()
