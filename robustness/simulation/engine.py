"""The states of a batch of runs, and one step of all of them.

A step: the adversary sees the states and moves; claims and true positions go on the board; the schedule says who
updates with what delays; the compiled kernel lets every vehicle listen, filter and move. The ``tau`` steps before
step 0 are played with everybody at the initial position, so that delayed values exist from the start.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import Move, Setting, View
from robustness.simulation.divergence import LARGEST_START, Divergence
from robustness.simulation.draws import Draws
from robustness.simulation.dynamics import Floats
from robustness.simulation.fault_models import fault_model_named, require_fault_model
from robustness.simulation.gains import Fleet, fleet_of
from robustness.simulation.hearing import Hearing, Law, States, Stores, stores_for
from robustness.simulation.lawful import require_lawful
from robustness.simulation.own_rule import advance_by
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import Past
from robustness.simulation.sensing import board_for
from robustness.simulation.topology import Topology, extended_by
from robustness.simulation.update_rules import rule_named
from robustness.spelled import counted

__all__ = ["Batch"]

#: Below this many arc updates per step a second thread costs more than it saves.
_WORTH_A_THREAD = 200_000


class Batch:
    """The states of B runs and what is needed to advance them.

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
    previous : array, shape ``(B, n)``
        The positions one step earlier.
    sent : array, shape ``(B, n)``
        The claims of the current step.
    last_update : integer array, shape ``(B, n)``
        The step of everybody's last update, -1 before the first.
    """

    def __init__(self, scenario: Scenario, starts: Sequence[Start], jobs: int = 1) -> None:
        everybody = set.union(*(set(start.malicious) for start in starts))
        always = frozenset.intersection(*(start.malicious for start in starts))
        base = scenario.network.graphs[0]
        base.ids(everybody)
        self.topology: Topology = extended_by(scenario.network, scenario.added_links, base.ids(always))
        graph, rule, runs = self.topology.union, rule_named(scenario.rule), len(starts)
        self.fleet: Fleet = fleet_of(graph, rule, scenario.f, scenario.T, scenario.alpha, scenario.weights)
        self.law = Law(
            min(scenario.f, graph.n), rule.first_order, rule.strict, scenario.T, graph.in_indptr, self.fleet.weight,
            self.fleet.alpha,
        )  # fmt: skip
        malicious = np.zeros((runs, graph.n), dtype=bool)
        for b, start in enumerate(starts):
            malicious[b, list(graph.ids(start.malicious))] = True
        model = fault_model_named(scenario.model)
        require_fault_model(graph, malicious, scenario.f, model)
        self.p = _states([start.positions for start in starts], malicious.shape, "position")
        self.q = _states([start.velocities for start in starts], malicious.shape, "velocity")
        if rule.first_order:
            self.q[:] = 0.0
        self.previous, self.sent = self.p.copy(), self.p.copy()
        self.last_update = np.full(malicious.shape, -1, dtype=np.int64)
        self.scenario = scenario
        self.board = board_for(graph, graph.ids(scenario.active), byzantine=model.byzantine)
        delays, gap = scenario.schedule.delay_rule, scenario.schedule.update_times.gap
        self.ring = np.zeros((delays.bound + 1, runs, self.board.width))
        self.stores = stores_for(
            runs, graph.arc_count, hold=not rule.first_order and gap > 1, remember=not self.topology.fixed
        )
        self.setting = Setting(
            graph, malicious, scenario.f, model, scenario.T, self.p.copy(),
            Draws([start.seed for start in starts]), delays.bound, delays.adversarial, self._trial,
        )  # fmt: skip
        self.divergence = Divergence(~malicious, self.p, self.q, self.fleet, scenario.growth)
        busy = runs * (graph.arc_count + graph.n) >= _WORTH_A_THREAD and rule.update is None
        self.jobs = max(1, min(jobs, runs)) if busy else 1
        self._move = Move()

    def promise_gaps(self) -> tuple[str | None, ...]:
        """Return, for every run, why the theory promises nothing about it, or None."""
        return tuple(self.fleet.gap(np.flatnonzero(~row).tolist()) for row in self.setting.malicious)

    def view(self, step: int) -> View:
        """Return what there is to see at this step."""
        return View(self.setting, step, self.p, self.q, self.previous, self.last_update)

    def play_history(self, before_each: Callable[[int], None] = lambda step: None) -> None:
        """Let the adversary speak during the steps before 0; nobody moves and nothing is recorded."""
        start = self.p.copy()
        for step in range(1 - len(self.ring), 0):
            before_each(step)
            self.act(step)
            self.p = start.copy()
        self.previous = start

    def act(self, step: int) -> None:
        """Let the adversary move, check what it does, and put claims and true positions on the board."""
        self._move = move = self.scenario.adversary.play(self.view(step))
        require_lawful(move, self.setting)
        if move.positions is not None:
            placed = ~np.isnan(move.positions)
            positions = np.where(placed, move.positions, self.p)
            if not self.fleet.rule.first_order and step > 0:
                with np.errstate(over="ignore"):
                    moved = (positions - self.previous) / self.scenario.T
                self.q = np.ascontiguousarray(np.where(placed, moved, self.q))
            self.p = np.ascontiguousarray(positions)
        self.sent = self.p if move.sent is None else np.where(np.isnan(move.sent), self.p, move.sent)
        self.board.write(self.ring[step % len(self.ring)], self.sent, self.p, move.told)

    def advance(self, step: int, pool: Executor | None = None) -> None:
        """Advance every run by one step; those that diverge are stopped."""
        view = self.view(step)
        update = np.ascontiguousarray(self.scenario.schedule.update_times.updates(view))
        hearing = Hearing(self.ring, self.board.channel, self.delays(view), self._status(step), update)
        new_p, new_q = self._moved(step, hearing, pool)
        if self.scenario.schedule.update_times.gap > 1:
            self.last_update = np.where(update, step, self.last_update)
        self.divergence.stop(step + 1, self.p, self.q, new_p, new_q)
        self.previous, self.p, self.q = self.p, new_p, new_q

    def delays(self, view: View) -> npt.NDArray[np.int64]:
        """Return the delays of a step, ``(1 or B, A)``, within their bound."""
        delays = self.scenario.schedule.delay_rule.delays(view, Past(self.ring, self.board.channel))
        chosen = self._move.delays
        return np.ascontiguousarray(delays if chosen is None else np.where(chosen >= 0, chosen, delays))

    def _status(self, step: int) -> npt.NDArray[np.uint8]:
        """Return, for every arc, whether it is absent (0), delivers (1) or is withheld (2), ``(1 or B, A)``."""
        arcs = len(self.board.channel)
        present = self.topology.present(step)[None] if self.stores.remember else np.ones((1, arcs), np.uint8)
        if self._move.withheld is None:
            return present
        # Whoever looks for itself sees a silent neighbour as well.
        silent = self._move.withheld & ~self.board.active & (present == 1)
        return np.ascontiguousarray(np.where(silent, np.uint8(2), present))

    def _moved(self, step: int, hearing: Hearing, pool: Executor | None) -> tuple[Floats, Floats]:
        """Return positions and velocities one step later."""
        states = States.after(self.p, self.q)
        if self.fleet.rule.update is not None:
            advance_by(self.fleet.rule.update, self.topology.union, step, self.scenario.schedule.oldest, hearing,
                       self.stores, states)  # fmt: skip
        else:
            runs = len(self.p)
            bounds = [runs * part // self.jobs for part in range(self.jobs + 1)]
            oldest = self.scenario.schedule.oldest
            _run_in_parts(pool, bounds, partial(_advance, step, oldest, self.law, hearing, self.stores, states))
        return states.new_p, states.new_q

    def _trial(self, p: Floats, q: Floats, sent: Floats) -> Floats:
        """Return the positions one step later if everybody updated now and heard ``sent`` at once."""
        graph = self.topology.union
        arcs = graph.arc_count
        at_once = Hearing(
            sent[None], self.board.tails, np.zeros((1, arcs), np.int64), np.ones((1, arcs), np.uint8),
            np.ones((1, graph.n), np.uint8),
        )  # fmt: skip
        nothing = stores_for(1, 1, hold=False, remember=False)
        states = States.after(p, q)
        if self.fleet.rule.update is not None:
            advance_by(self.fleet.rule.update, graph, 0, 0, at_once, nothing, states)
        else:
            _advance(0, 0, self.law, at_once, nothing, states, 0, len(p))
        return states.new_p


def _run_in_parts(pool: Executor | None, bounds: list[int], advance: Callable[[int, int], None]) -> None:
    """Advance the runs between consecutive bounds, each part in its own thread; runs are independent."""
    parts = list(pairwise(bounds))
    if pool is None or len(parts) == 1:
        for part in parts:
            advance(*part)
        return
    for done in [pool.submit(advance, *part) for part in parts]:
        done.result()


def _advance(step: int, tau: int, law: Law, hearing: Hearing, stores: Stores, states: States, lo: int, hi: int) -> None:
    """Advance the runs ``lo .. hi - 1`` by the kernel.

    Where it runs as plain Python, it reads the arrays through memory views, whose numbers are Python's own: the same
    arithmetic, in two thirds of the time. numpy would warn of an overflow, which is found afterwards.
    """
    from robustness.kernels import IS_COMPILED
    from robustness.kernels.steps import Turn

    arrays: tuple[Any, ...] = (law, hearing, stores, states)
    if not IS_COMPILED:
        arrays = tuple(
            each._make(part.data if isinstance(part, np.ndarray) else part for part in each) for each in arrays
        )
    with np.errstate(over="ignore", invalid="ignore"):
        Turn(step, tau, *arrays).advance(lo, hi)


def _states(rows: list[tuple[float, ...]], shape: tuple[int, int], what: str) -> Floats:
    if any(len(row) != shape[1] for row in rows):
        raise InvalidParameter(f"a start has one {what} for each of the {counted(shape[1], 'node')}, in id order")
    values = np.array(rows, dtype=np.float64).reshape(shape)
    if not (np.abs(values) <= LARGEST_START).all():
        raise InvalidParameter(f"a start has finite numbers of at most {LARGEST_START:g}: some {what} is not")
    return values
