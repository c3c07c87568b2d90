"""Running a scenario: all runs of a batch, one step at a time."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

from robustness.errors import InvalidParameter, Undecided
from robustness.limits import Progress
from robustness.simulation.engine import Batch
from robustness.simulation.gains import Fleet, PromiseWarning
from robustness.simulation.observer import Observer
from robustness.simulation.outcome import Outcome
from robustness.simulation.scenario import Scenario, Start
from robustness.spelled import counted

__all__ = ["simulate"]

#: More numbers than this in one array are not even asked for.
_NUMBERS = 1 << 40


def simulate(
    scenario: Scenario,
    starts: Start | Sequence[Start],
    *,
    record: bool = False,
    jobs: int = 1,
    time_limit: float | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> tuple[Outcome, ...]:
    """Run a scenario from every start, all at once.

    Parameters
    ----------
    scenario : Scenario
    starts : Start or sequence of Start
        One per run; B of them.
    record : bool
        Whether to keep all states: ``3 (K + 1) n B`` numbers.
    jobs : int
        Threads for large batches; the result does not depend on it.
    time_limit : float, optional
        Wall-clock seconds.
    progress : callable, optional
        Called at every step with a :class:`~robustness.limits.Progress`, whose note tells step and spread.

    Returns
    -------
    tuple of Outcome
        One per start. The same scenario and start give the same outcome bit for bit, in any batch.

    Raises
    ------
    InvalidParameter
        When a start does not fit the network, or the adversary breaks its fault model or the schedule.
    Undecided
        When the time limit came before the horizon; the message tells the step and the spread so far.

    Warns
    -----
    PromiseWarning
        When the gains lie outside the theory, and no evidence says that the run is split.

    Notes
    -----
    ``O(K (n + A f))`` per run for n nodes and A arcs.

    >>> import networkx as nx
    >>> from robustness.simulation import as_topology, random_start
    >>> graph = as_topology(nx.complete_graph(5), steps=1)
    >>> outcome, = simulate(Scenario(graph, f=1, steps=200), [random_start(graph.union, [4], seed=0)])
    >>> outcome.verdict.value
    'agreement'
    """
    if not isinstance(scenario, Scenario):
        raise InvalidParameter(
            f"a run needs a Scenario, not {type(scenario).__name__}: Scenario(G, f=...), or robustness.simulate(G, ...)"
        )
    starts = _several(starts)
    if not starts:
        return ()
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    try:
        if max(scenario.steps, scenario.schedule.delay_rule.bound) * len(starts) > _NUMBERS:
            raise MemoryError
        batch = Batch(scenario, starts, jobs)
        gaps = batch.promise_gaps()
        # Evidence that two groups never move holds for all gains: then there is nothing to warn of.
        if scenario.groups is None:
            _warn_of(batch.fleet, gaps, stacklevel=3)
        observer = Observer(batch.setting, batch.fleet, scenario, starts, gaps, record=record)
    except MemoryError:
        raise InvalidParameter(
            f"{counted(scenario.steps, 'step')} of {counted(len(starts), 'run')} with delays "
            f"up to {scenario.schedule.delay_rule.bound} do "
            "not fit into memory: run fewer at once"
        ) from None

    def watch_the_time(step: int, seen: int = 0) -> None:
        if progress is not None:
            progress(Progress(0, observer.so_far(step, seen)))
        if time.monotonic() > deadline:
            told = observer.so_far(step, seen)
            raise Undecided(f"the time limit came at {told}: raise it, or run fewer steps")

    with ThreadPoolExecutor(batch.jobs) as pool:
        batch.play_history(watch_the_time)
        for step in range(scenario.steps):
            watch_the_time(step, step)
            batch.act(step)
            observer.see(step, batch.p, batch.q, batch.sent)
            batch.advance(step, pool)
        batch.act(scenario.steps)
    observer.see(scenario.steps, batch.p, batch.q, batch.sent)
    return observer.outcomes(batch.divergence.since)


def _several(starts: object) -> list[Start]:
    """Return starts as a list, or raise :class:`InvalidParameter`."""
    given = [starts] if isinstance(starts, Start) else list(starts) if isinstance(starts, Sequence) else [starts]
    found = [start for start in given if isinstance(start, Start)]
    if len(found) < len(given):
        raise InvalidParameter("starts are Start objects, one or a sequence: Start(...) or random_start(G, ...)")
    return found


def _warn_of(fleet: Fleet, gaps: Sequence[str | None], *, stacklevel: int) -> None:
    """Warn once where the gains of some run lie outside the theory; about a rule of one's own there is none."""
    said = next((gap for gap in gaps if gap is not None), None)
    if said is not None and fleet.rule.update is None:
        warnings.warn(said, PromiseWarning, stacklevel=stacklevel)
