"""Where cubes are solved: one narrow protocol, and what fulfils it.

A :class:`CubeExecutor` takes tasks, gives results in whatever order they come, and has a stop flag. A pool of threads,
any other ``concurrent.futures`` executor and a Dask client are made into one by :func:`cube_executor`. None of
them is trusted: :mod:`robustness.cubes.spreading` checks what comes back, asks again for what is lost, and ignores what
comes twice.
"""

from __future__ import annotations

import concurrent.futures
import importlib
import os
import queue
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from multiprocessing import resource_tracker
from typing import Any, Protocol, TypeVar, runtime_checkable

from robustness.cubes.solving import solve
from robustness.errors import InvalidParameter, MissingExtra, Undecided
from robustness.waiting import in_a_thread

__all__ = ["CubeExecutor", "cube_executor", "mapped", "opened_cluster", "require_executor"]

_Item = TypeVar("_Item")
_Value = TypeVar("_Value")

#: Seconds that a cluster may take to say how many workers it has before the last number is used again.
_STALE = 2.0

#: Seconds that fetching a finished result may take; one whose worker has died meanwhile is made again.
_FETCH = 30.0


#: How often the workers of this machine are started before that is given up.
_STARTS = 3


@runtime_checkable
class CubeExecutor(Protocol):
    """Somebody who solves cubes."""

    def width(self) -> int:
        """Return how many cubes can be worked on at the same time now; 0 while there is no worker."""

    def submit(self, number: int, task: dict[str, Any]) -> None:
        """Take a task, as :func:`robustness.cubes.solving.solve` does; its result is to come under this number.

        What it raises counts as the loss of the task.
        """

    def results(self, seconds: float) -> list[tuple[int, Any]]:
        """Wait at most so long for results; return each with its number, an exception in the place of one lost."""

    def refuse(self, result: dict[str, Any]) -> bool:
        """Return whether no more tasks will go to the worker of this result, which has another version."""

    def stop(self) -> None:
        """Raise the stop flag: nothing that was submitted is wanted any more."""


def cube_executor(executor: Any) -> CubeExecutor:
    """Return an executor of cubes for one search.

    Parameters
    ----------
    executor : concurrent.futures.Executor, distributed.Client or CubeExecutor
        It stays open: whoever made it closes it.

    Raises
    ------
    InvalidParameter
        For anything else.
    """
    if isinstance(executor, concurrent.futures.Executor):
        return _Pool(executor)
    if type(executor).__module__.startswith("distributed.") and hasattr(executor, "scheduler_info"):
        return _Dask(executor)
    if isinstance(executor, CubeExecutor):
        return executor
    raise InvalidParameter(
        "executor is a concurrent.futures.Executor, a distributed.Client or a CubeExecutor, "
        f"not a {type(executor).__name__}"
    )


def mapped(executor: Any, function: Callable[[_Item], _Value], items: Sequence[_Item]) -> list[_Value]:
    """Return ``function(item)`` of each item, in order, worked out by an executor; None is this process.

    What a worker raises is raised here. ``function`` is one of a module, and values are plain.

    Raises
    ------
    InvalidParameter
        For an executor that is neither of ``concurrent.futures`` nor a ``distributed.Client``.
    """
    if executor is None:
        return [function(item) for item in items]
    if isinstance(executor, concurrent.futures.Executor):
        return list(executor.map(function, items))
    if isinstance(cube_executor(executor), _Dask):
        return list(executor.gather(executor.map(function, items, pure=False)))
    raise InvalidParameter("executor is a concurrent.futures.Executor or a distributed.Client here")


def require_executor(executor: Any) -> None:
    """Raise InvalidParameter for what :func:`cube_executor` does not take; None, which means this process, is fine."""
    if executor is not None:
        cube_executor(executor)


class _Futures:
    """What executors whose futures call back have in common."""

    def __init__(self) -> None:
        self._done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        self._pending: dict[int, Any] = {}
        self._stopped = threading.Event()

    def _watch(self, number: int, future: Any) -> None:
        self._pending[number] = future
        future.add_done_callback(lambda done: self._done.put((number, done)))

    def results(self, seconds: float) -> list[tuple[int, Any]]:
        found: list[tuple[int, Any]] = []
        with suppress(queue.Empty):
            number, future = self._done.get(timeout=seconds) if seconds > 0 else self._done.get_nowait()
            while True:
                if self._pending.pop(number, None) is not None:
                    found.append((number, self._outcome(future)))
                number, future = self._done.get_nowait()
        return found

    def _outcome(self, future: Any) -> Any:
        """Return the result of a future that is done, or why there is none."""
        try:
            return future.result(timeout=_FETCH)
        except (Exception, concurrent.futures.CancelledError) as problem:  # noqa: BLE001 - whatever a worker died of
            return problem

    def refuse(self, result: dict[str, Any]) -> bool:
        """Return False: all workers of a pool have the same version."""
        return False

    def stop(self) -> None:
        self._stopped.set()
        for future in list(self._pending.values()):
            with suppress(Exception):  # the scheduler may be gone
                future.cancel()
        self._pending.clear()


class _Pool(_Futures):
    """Any ``concurrent.futures`` executor. Threads share the stop flag; processes end their slice."""

    def __init__(self, pool: concurrent.futures.Executor) -> None:
        super().__init__()
        self._pool = pool
        self._shares_memory = isinstance(pool, concurrent.futures.ThreadPoolExecutor)

    def width(self) -> int:
        return int(getattr(self._pool, "_max_workers", 0) or 1)

    def submit(self, number: int, task: dict[str, Any]) -> None:
        flag: tuple[Callable[[], bool], ...] = (self._stopped.is_set,) if self._shares_memory else ()
        self._watch(number, self._pool.submit(solve, task, *flag))


def solve_on_worker(task: dict[str, Any]) -> dict[str, Any]:
    """Do what :func:`solve` does on a Dask worker, and say which one it is."""
    worker = importlib.import_module("distributed").get_worker()
    return {**solve(task), "worker": worker.address}


class _Dask(_Futures):
    """The workers of a Dask cluster. What waits is cancelled by a stop; what runs ends its slice and is not looked at.

    Dask itself starts a task again that was on a worker which died, so often as its configuration says
    (``distributed.scheduler.allowed-failures``); then the loss is reported here.
    """

    def __init__(self, client: Any) -> None:
        super().__init__()
        self._client = client
        self._refused: set[str] = set()
        self._workers: dict[str, int] = {}
        self._asked = -_STALE

    def width(self) -> int:
        now = time.monotonic()
        if now - self._asked >= _STALE:
            self._asked = now
            with suppress(Exception):  # the scheduler is gone or comes back
                known = self._client.scheduler_info(n_workers=-1)["workers"]
                self._workers = {address: int(worker["nthreads"]) for address, worker in known.items()}
        return sum(threads for address, threads in self._workers.items() if address not in self._refused)

    def submit(self, number: int, task: dict[str, Any]) -> None:
        wanted = {} if not self._refused else {"workers": sorted(self._workers.keys() - self._refused)}
        self._watch(number, self._client.submit(solve_on_worker, task, pure=False, **wanted))

    def _outcome(self, future: Any) -> Any:
        # A result that never was must not be fetched: Dask would log that as an error of its own.
        if getattr(future, "status", "finished") in ("cancelled", "lost"):
            return concurrent.futures.CancelledError(f"the scheduler has {future.status} it")
        return super()._outcome(future)

    def refuse(self, result: dict[str, Any]) -> bool:
        self._refused.add(str(result.get("worker")))
        return "worker" in result


@contextmanager
def opened_cluster(address: str) -> Iterator[Any]:
    """Yield a Dask client for ``tcp://HOST:PORT``, or for ``local:N``: N worker processes on this machine.

    Raises
    ------
    InvalidParameter
        For an address of another form, and for one where no scheduler answers.
    MissingExtra
        When ``distributed`` is not installed.
    Undecided
        When the processes of this machine cannot be started.
    """
    kind, _, rest = address.partition(":")
    is_local = kind == "local" and rest.isascii() and rest.isdigit() and int(rest) > 0
    if not is_local and not (kind in ("tcp", "tls") and rest.startswith("//") and rest[2:]):
        raise InvalidParameter(
            f"a cluster is tcp://HOST:PORT, tls://HOST:PORT or local:N with N >= 1 workers, not {address!r}"
        )
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as missing:
        raise MissingExtra("a cluster needs Dask: pip install 'graph-robustness[cluster]'") from missing
    if not is_local:
        try:
            client = distributed.Client(address, timeout=10)
        except (OSError, ValueError) as problem:
            raise InvalidParameter(f"no scheduler answers at {address}: start one with 'dask scheduler'") from problem
        with closing(client):  # which may be another thread's, as its own context may not
            yield client
        return
    with closing(_local_cluster(distributed, int(rest))) as local, closing(distributed.Client(local)) as client:
        yield client


def _leave_ctrl_c_to_others() -> None:
    """Let Ctrl-C, which a terminal sends to all processes of a command, end none that this thread starts.

    Threads and processes inherit what is blocked. So workers do not cry out one by one: they end with their parent.
    """
    if not hasattr(signal, "pthread_sigmask"):  # on Windows
        return
    # Python's process that clears away what others leave would unblock it when it is started later, and complain of
    # all that it clears when the command ends at once.
    warned = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = ",".join(
        filter(None, (warned, "ignore::UserWarning:multiprocessing.resource_tracker"))
    )
    try:
        resource_tracker.ensure_running()
    finally:
        if warned is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = warned
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _local_cluster(distributed: Any, count: int) -> Any:
    """Return a cluster of processes on this machine; a start that fails, for a process was killed, is tried again."""
    # Dask starts a server for its status even where none is wanted: at a port that is free, and for this machine alone.
    status = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}

    def start() -> Any:
        _leave_ctrl_c_to_others()
        return distributed.LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, silence_logs=50, scheduler_kwargs=status
        )

    why: Exception | None = None
    for _ in range(_STARTS):
        try:
            return in_a_thread("cluster", start)
        except (RuntimeError, OSError) as problem:
            why = problem
    raise Undecided(f"nothing is decided: local:{count} did not start ({why})")
