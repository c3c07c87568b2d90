"""The engine: all runs of a batch, one step at a time.

A step: the adversary sees the states and moves; claims and true positions go on the board; the schedule says who
updates with what delays; the compiled kernel lets every vehicle listen, filter and move. The ``tau`` steps before
step 0 are played with everybody at the initial position, so that delayed values exist from the start.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.errors import InvalidParameter, Undecided
from robustness.simulation.adversaries.protocol import Move, Setting, View
from robustness.simulation.draws import Draws
from robustness.simulation.dynamics import Floats
from robustness.simulation.gains import PromiseWarning, arc_weights, node_gains, promise_gap
from robustness.simulation.models import fault_model_named, require_fault_model
from robustness.simulation.observer import Observer
from robustness.simulation.outcome import Outcome
from robustness.simulation.rules import rule_named
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import Past
from robustness.simulation.sensing import board_for
from robustness.simulation.topology import extended_by

__all__ = ["Batch", "simulate"]

#: Below this many arc updates per step a second thread costs more than it saves.
_WORTH_A_THREAD = 200_000


def simulate(
    scenario: Scenario,
    starts: Sequence[Start],
    *,
    record: bool = False,
    jobs: int = 1,
    time_limit: float | None = None,
) -> tuple[Outcome, ...]:
    """Run a scenario from every start, all at once.

    Parameters
    ----------
    scenario : Scenario
    starts : sequence of Start
        One per run; B of them.
    record : bool
        Whether to keep all states: ``3 (K + 1) n B`` numbers.
    jobs : int
        Threads for large batches; the result does not depend on it.
    time_limit : float, optional
        Wall-clock seconds.

    Returns
    -------
    tuple of Outcome
        One per start. The same scenario and start give the same outcome bit for bit, in any batch.

    Raises
    ------
    InvalidParameter
        When a start does not fit the network, or the adversary breaks its fault model or the schedule.
    Undecided
        When the time limit came before the horizon.

    Warns
    -----
    PromiseWarning
        When the gains lie outside the theory.

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
    if not starts:
        return ()
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    batch = Batch(scenario, starts, jobs)
    if batch.promise is not None:
        warnings.warn(batch.promise, PromiseWarning, stacklevel=2)
    try:
        observer = Observer(batch.setting, scenario, starts, batch.promise, record=record)
    except MemoryError:
        raise InvalidParameter(
            f"{scenario.steps} steps of {len(starts)} runs do not fit into memory: run fewer at once"
        ) from None
    with ThreadPoolExecutor(batch.jobs) as pool:
        batch.play_history()
        for step in range(scenario.steps):
            if time.monotonic() > deadline:
                raise Undecided(f"the time limit came at step {step} of {scenario.steps}: raise it, or run fewer steps")
            batch.act(step)
            observer.see(step, batch.p, batch.q, batch.sent)
            batch.advance(step, pool)
        batch.act(scenario.steps)
    observer.see(scenario.steps, batch.p, batch.q, batch.sent)
    return observer.outcomes()


class Batch:
    """The states of B runs and everything needed to advance them.

    Parameters
    ----------
    scenario : Scenario
    starts : sequence of Start
    jobs : int
        Threads.

    Attributes
    ----------
    p, q : arrays, shape ``(B, n)``
        Aligned positions and velocities, see :mod:`robustness.simulation.formation`.
    sent : array, shape ``(B, n)``
        The claims of the current step.
    promise : str or None
        Why the theory does not apply.
    """

    def __init__(self, scenario: Scenario, starts: Sequence[Start], jobs: int = 1) -> None:
        everybody = set.union(*(set(start.malicious) for start in starts))
        always = frozenset.intersection(*(start.malicious for start in starts))
        base = scenario.network.graphs[0]
        base.ids(everybody)
        self.scenario = scenario
        self.rule = rule_named(scenario.rule)
        self.topology = extended_by(scenario.network, scenario.added_links, base.ids(always))
        graph = self.topology.union
        shape = (len(starts), graph.n)
        malicious = np.zeros(shape, dtype=bool)
        for b, start in enumerate(starts):
            malicious[b, list(graph.ids(start.malicious))] = True
        model = fault_model_named(scenario.model)
        require_fault_model(graph, malicious, scenario.f, model)
        self.p = _states([start.positions for start in starts], shape, "position")
        self.q = _states([start.velocities for start in starts], shape, "velocity")
        if self.rule.first_order:
            self.q[:] = 0.0
        self.previous = self.p.copy()
        self.sent = self.p.copy()
        self.last_update = np.full(shape, -1, dtype=np.int64)
        self._prepare_arcs()
        delays = scenario.schedule.delay_rule
        self.setting = Setting(
            graph, malicious, scenario.f, model, scenario.T, self.p.copy(),
            Draws([start.seed for start in starts]), delays.bound, delays.adversarial, self._trial,
        )  # fmt: skip
        busy = len(starts) * (graph.arc_count + graph.n) >= _WORTH_A_THREAD
        self.jobs = max(1, min(jobs, len(starts))) if busy else 1

    def _prepare_arcs(self) -> None:
        """Lay out the arcs, their gains and weights, and the buffers of the kernel."""
        scenario, graph, runs = self.scenario, self.topology.union, self.p.shape[0]
        self.alpha = node_gains(graph, scenario.alpha, scenario.T)
        weights = scenario.weights
        if self.rule.first_order and weights == "uniform":
            weights = "unit"
        self.weight = arc_weights(graph, weights)
        self.promise = promise_gap(graph, self.rule, scenario.f, scenario.T, self.alpha, self.weight)
        self.board = board_for(
            graph, graph.ids(scenario.active), byzantine=fault_model_named(scenario.model).byzantine
        )
        self.slots = scenario.schedule.delay_rule.bound + 1
        self.ring = np.zeros((self.slots, runs, self.board.width))
        self.hold = not self.rule.first_order and scenario.schedule.update_times.gap > 1
        self.remember = not self.topology.fixed
        arcs = graph.arc_count
        self.held = np.zeros((runs, arcs) if self.hold else (1, 1))
        self.kept = np.zeros((runs, arcs) if self.hold else (1, 1), dtype=np.uint8)
        self.memory = np.zeros((runs, arcs) if self.remember else (1, 1))
        self._own = np.ones(graph.n)
        # What a trial hears: no delays, every arc delivers, everybody updates, nothing held or remembered.
        self._at_once = (
            np.zeros((1, arcs), np.int64), np.ones((1, arcs), np.uint8), np.ones((1, graph.n), np.uint8),
            np.zeros((1, 1)), np.zeros((1, 1), np.uint8), np.zeros((1, 1)), np.zeros((1, 1), np.int64),
        )  # fmt: skip
        never = -(1 << 62)
        self.stamp = np.full((runs, arcs) if self.remember else (1, 1), never, dtype=np.int64)

    def play_history(self) -> None:
        """Let the adversary speak during the steps before 0; nobody moves and nothing is recorded."""
        start = self.p.copy()
        for step in range(1 - self.slots, 0):
            self.act(step)
            self.p = start.copy()
        self.previous = start

    def act(self, step: int) -> None:
        """Let the adversary move, check what it does, and put claims and true positions on the board."""
        view = View(self.setting, step, self.p, self.q, self.previous, self.last_update)
        self.move = move = self.scenario.adversary.play(view)
        self._require_lawful(move)
        if move.positions is not None:
            placed = ~np.isnan(move.positions)
            positions = np.where(placed, move.positions, self.p)
            if not self.rule.first_order and step > 0:
                moved = (positions - self.previous) / self.scenario.T
                self.q = np.ascontiguousarray(np.where(placed, moved, self.q))
            self.p = np.ascontiguousarray(positions)
        self.sent = self.p if move.sent is None else np.where(np.isnan(move.sent), self.p, move.sent)
        self.board.write(self.ring[step % self.slots], self.sent, self.p, move.told)

    def advance(self, step: int, pool: ThreadPoolExecutor) -> None:
        """Advance every run by one step."""
        view = View(self.setting, step, self.p, self.q, self.previous, self.last_update)
        update = np.ascontiguousarray(self.scenario.schedule.update_times.updates(view))
        new_p, new_q = np.empty_like(self.p), np.empty_like(self.q)
        runs = self.p.shape[0]
        bounds = [runs * part // self.jobs for part in range(self.jobs + 1)]
        arguments = self._kernel_arguments(
            step, self.ring, self.board.channel, self._delays(view), self._status(step), update, new_p, new_q
        )
        _run_in_parts(pool, bounds, arguments)
        if self.scenario.schedule.update_times.gap > 1:
            self.last_update = np.where(update, step, self.last_update)
        self.previous, self.p, self.q = self.p, new_p, new_q

    def _kernel_arguments(
        self,
        step: int,
        ring: Floats,
        channel: npt.NDArray[np.int64],
        delay: npt.NDArray[np.int64],
        status: npt.NDArray[np.uint8],
        update: npt.NDArray[np.uint8],
        new_p: Floats,
        new_q: Floats,
    ) -> tuple[Any, ...]:
        scenario, rule, graph = self.scenario, self.rule, self.topology.union
        return (
            step, scenario.schedule.oldest, scenario.f, rule.first_order, rule.strict, self.hold, self.remember,
            scenario.T, self.p, self.q, ring, channel, delay, status, update, self.held, self.kept, self.memory,
            self.stamp, graph.in_indptr, self.weight, self._own, self.alpha, new_p, new_q,
        )  # fmt: skip

    def _delays(self, view: View) -> npt.NDArray[np.int64]:
        """Return the delays of this step, ``(1 or B, A)``, within their bound."""
        delays = self.scenario.schedule.delay_rule.delays(view, Past(self.ring, self.board.channel))
        chosen = self.move.delays
        return np.ascontiguousarray(delays if chosen is None else np.where(chosen >= 0, chosen, delays))

    def _status(self, step: int) -> npt.NDArray[np.uint8]:
        """Return, for every arc, whether it is absent (0), delivers (1) or is withheld (2), ``(1 or B, A)``."""
        present = self.topology.present(step)[None] if self.remember else np.ones((1, len(self.weight)), np.uint8)
        if self.move.withheld is None:
            return present
        # Whoever looks for itself sees a silent neighbour as well.
        silent = self.move.withheld & ~self.board.active & (present == 1)
        return np.ascontiguousarray(np.where(silent, np.uint8(2), present))

    def _trial(self, p: Floats, q: Floats, sent: Floats) -> Floats:
        """Return the positions one step later if everybody updated now and heard ``sent`` at once."""
        from robustness.kernels.steps import advance

        new_p, new_q = np.empty_like(p), np.empty_like(q)
        graph, rule, scenario = self.topology.union, self.rule, self.scenario
        advance(
            0, p.shape[0], 0, 0, scenario.f, rule.first_order, rule.strict, False, False, scenario.T, p, q, sent[None],
            self.board.tails, *self._at_once, graph.in_indptr, self.weight, self._own, self.alpha,
            new_p, new_q,
        )  # fmt: skip
        return new_p

    def _require_lawful(self, move: Move) -> None:
        """Guarantees that a move stays within the fault model and the schedule, or raises InvalidParameter."""
        setting = self.setting
        for name, values in (("claims", move.sent), ("positions", move.positions)):
            if values is None:
                continue
            if (~np.isnan(values) & ~setting.malicious).any():
                raise InvalidParameter(f"an adversary decides for malicious nodes, but it set {name} of normal ones")
            if np.isinf(values).any():
                raise InvalidParameter(f"an adversary sends finite numbers, but some of its {name} are infinite")
        if move.withheld is not None and (move.withheld & ~setting.from_malicious).any():
            raise InvalidParameter("only malicious nodes withhold messages, but the adversary silenced a normal one")
        if move.told is not None:
            self._require_lawful_claims(move.told)
        if move.delays is not None:
            if not setting.chooses_delays and (move.delays >= 0).any():
                raise InvalidParameter("this schedule sets the delays itself: give the adversary adversarial delays")
            if move.delays.max(initial=0) > setting.longest_delay:
                raise InvalidParameter(
                    f"delays are at most {setting.longest_delay} steps, but the adversary chose {move.delays.max()}"
                )

    def _require_lawful_claims(self, told: Floats) -> None:
        """Guarantees that claims on single arcs come from Byzantine nodes, and are finite."""
        setting = self.setting
        if not setting.model.byzantine:
            raise InvalidParameter(
                f"under the model {setting.model.name!r} a node tells all its neighbours the same: "
                "claims on single arcs need a Byzantine model"
            )
        if (~np.isnan(told) & ~setting.from_malicious).any():
            raise InvalidParameter("an adversary speaks for malicious nodes only, but it spoke on a normal node's arc")
        if np.isinf(told).any():
            raise InvalidParameter("an adversary sends finite numbers, but some of its claims are infinite")


def _run_in_parts(pool: ThreadPoolExecutor, bounds: list[int], arguments: tuple[Any, ...]) -> None:
    """Advance the runs between consecutive bounds, each part in its own thread; runs are independent."""
    from robustness.kernels.steps import advance

    parts = list(pairwise(bounds))
    if len(parts) == 1:
        advance(*parts[0], *arguments)
        return
    for done in [pool.submit(advance, *part, *arguments) for part in parts]:
        done.result()


def _states(rows: list[tuple[float, ...]], shape: tuple[int, int], what: str) -> Floats:
    if any(len(row) != shape[1] for row in rows):
        raise InvalidParameter(f"a start has one {what} for each of the {shape[1]} nodes, in id order")
    values = np.array(rows, dtype=np.float64).reshape(shape)
    if not np.isfinite(values).all():
        raise InvalidParameter(f"a start has finite numbers: some {what} is not")
    return values
