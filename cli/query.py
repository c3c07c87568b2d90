"""What every command that decides something is asked beside its own options: how to answer, and how hard to work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .interruption import interruptibly, is_left_behind
from .named import FILE
from .options import algorithm_option, jobs_option, json_option, seed_option, talk_options, timeout_option
from .output import ProgressLine, pass_console

if TYPE_CHECKING:
    from robustness.limits import Progress

__all__ = ["Query", "cluster_option", "joined_cluster", "query_options", "speaking"]

_Command = TypeVar("_Command", bound=Callable[..., Any])
_Result = TypeVar("_Result")


cluster_option = click.option(
    "--cluster",
    metavar="ADDRESS",
    help="Spread the exact search over a Dask cluster: tcp://HOST:PORT, or local:N for N processes here.",
)

cubes_option = click.option(
    "--state",
    "cubes",
    type=FILE,
    metavar="FILE",
    help="A journal of what is refuted: the same command goes on where it was stopped or killed.",
)


_left_open: list[Any] = []


def joined_cluster(address: str) -> Any:
    """Return a client of the cluster, which is left when the command ends.

    Ctrl-C ends the wait for it to start. Where work is left behind nobody waits for the workers to end, either: those
    of this machine end with this process, and a scheduler drops what a client wanted that is gone.
    """
    from robustness.cubes import opened_cluster

    cluster = opened_cluster(address)
    client = interruptibly(cluster.__enter__)

    def leave() -> None:
        if is_left_behind():
            _left_open.append(cluster)  # a generator that nobody has any more would be closed
        else:
            cluster.__exit__(None, None, None)

    click.get_current_context().call_on_close(leave)
    return client


def _processes_here(cluster: str | None) -> int:
    """Return how many processors of this machine were given to a cluster that is open: the N of local:N."""
    return int(cluster.removeprefix("local:")) if cluster is not None and cluster.startswith("local:") else 0


@dataclass(frozen=True, slots=True)
class Query:
    """The values of the common options.

    Attributes
    ----------
    as_json : bool
        Answer in one JSON document.
    algorithm : str
        A name in ``choices.ALGORITHM_NAMES``.
    timeout : float or None
        Seconds; what is not decided by then is undecided.
    jobs, seed : int
        Threads, and processes that verify a long proof; the seed of every random choice.
    executor : distributed.Client or None
        Who solves the cubes of an exact search, for the commands with --cluster.
    state : Path or None
        The journal of closed cubes, for the same.
    """

    as_json: bool = False
    algorithm: str = "auto"
    timeout: float | None = None
    jobs: int = 1
    seed: int = 0
    executor: Any = None
    state: Path | None = None

    def within(self, seconds: float | None) -> Query:
        """Return the same query with another time limit: what is left for the next part of a command."""
        return replace(self, timeout=seconds)

    def effort(self, progress: Callable[[Progress], None] | None = None) -> dict[str, Any]:
        """Return what every front of the library takes about how hard to work: the whole of it, by its keywords."""
        effort = {"time_limit": self.timeout, "jobs": self.jobs, "seed": self.seed, "progress": progress}
        cubes = {"executor": self.executor, "state": self.state}
        return effort | {name: value for name, value in cubes.items() if value is not None}

    def wait_for(self, work: Callable[[], _Result], line: ProgressLine | None = None) -> _Result:
        """Return what ``work()`` returns; Ctrl-C and the time limit end the wait, as ``interruptibly`` says."""
        tick = (lambda: None) if line is None else line.tick
        return interruptibly(work, self.timeout, tick, is_far=self.executor is not None)


def speaking(command: _Command) -> _Command:
    """Add -q, -v and --color, and pass the context and the console as the first two arguments."""
    return talk_options(pass_console(click.pass_context(command)))  # type: ignore[return-value]


def query_options(
    *, algorithm: bool = False, cluster: bool = False, state: bool = True, verifies: bool = False
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Add the common options to a command, which gets the context, the console and a :class:`Query`.

    Parameters
    ----------
    algorithm, cluster, state : bool
        Whether the command has --algorithm, --cluster, and with it --state.
    verifies : bool
        Whether it verifies long proofs, with as many processes as a cluster of this machine has. Others do with their
        executor what they would do with threads, and a solver with more threads proposes other graphs.
    """

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(command)
        def with_query(
            *arguments: Any,
            timeout: float | None,
            jobs: int,
            seed: int,
            as_json: bool = False,
            algorithm: str = "auto",
            cluster: str | None = None,
            cubes: Path | None = None,
            **own: Any,
        ) -> Any:
            executor = None if cluster is None else joined_cluster(cluster)
            jobs = max(jobs, _processes_here(cluster) if verifies else 1)
            return command(*arguments, Query(as_json, algorithm, timeout, jobs, seed, executor, cubes), **own)

        wrapped: Callable[..., Any] = speaking(with_query)
        for option in (seed_option, jobs_option, timeout_option):
            wrapped = option(wrapped)
        wrapped = cubes_option(wrapped) if cluster and state else wrapped
        wrapped = cluster_option(wrapped) if cluster else wrapped
        wrapped = algorithm_option(wrapped) if algorithm else wrapped
        return json_option(wrapped)

    return add
