"""The same runs, vehicle by vehicle in plain Python: Algorithm 1 of the source paper, read aloud.

Slow on purpose. Nothing is vectorised or compiled and every vehicle keeps its own records, so that there is little
that could be wrong but the algorithm itself. The engine must give the same states bit for bit; tests compare them,
and ``benchmarks/simulation.py`` measures the ratio. Only the adversary, the schedule and the board with the
messages are shared with the engine: they are what both are given.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robustness.simulation.adversaries.protocol import View
from robustness.simulation.gains import PromiseWarning
from robustness.simulation.observer import Observer
from robustness.simulation.outcome import Outcome
from robustness.simulation.run import Batch
from robustness.simulation.scenario import Scenario, Start

__all__ = ["kept_neighbours", "simulate_plainly"]


def kept_neighbours(relative: dict[int, float], f: int, *, strict: bool) -> list[int]:
    """Return the in-neighbours a vehicle keeps, ascending, given ``p_j - p_i`` for each it heard.

    >>> kept_neighbours({0: 3.0, 1: -1.0, 2: 0.0, 3: 5.0}, 1, strict=False)
    [0, 2]
    """
    # "Vehicle i sorts the calculated values from the largest to the smallest."
    largest_first = sorted(relative, key=lambda j: (-relative[j], j))
    above = [j for j in largest_first if relative[j] > 0 or (relative[j] == 0 and not strict)]
    below = [j for j in largest_first if relative[j] < 0 or (relative[j] == 0 and not strict)]
    # "If there are less than f vehicles [on that side], it ignores those; else the f largest (smallest)."
    ignored = set(above) if len(above) < f else set(largest_first[:f])
    ignored |= set(below) if len(below) < f else set(largest_first[len(largest_first) - f :])
    return sorted(j for j in relative if j not in ignored)


@dataclass
class _Vehicle:
    """What one vehicle of one run knows."""

    #: The neighbours kept at the last update, with the positions heard then.
    kept: dict[int, float] = field(default_factory=dict)
    #: Every neighbour's last message on a link that comes and goes, with the step it was sent at.
    remembered: dict[int, tuple[float, int]] = field(default_factory=dict)


class _PlainBatch(Batch):
    """A batch whose vehicles are advanced one by one."""

    def __init__(self, scenario: Scenario, starts: Sequence[Start]) -> None:
        super().__init__(scenario, starts)
        runs, n = self.p.shape
        self.vehicles = [[_Vehicle() for _ in range(n)] for _ in range(runs)]

    def advance_plainly(self, step: int) -> None:
        view = View(self.setting, step, self.p, self.q, self.previous, self.last_update)
        runs, n = self.p.shape
        update = np.broadcast_to(self.scenario.schedule.update_times.updates(view), (runs, n))
        delays = np.broadcast_to(self._delays(view), (runs, len(self.weight)))
        status = np.broadcast_to(self._status(step), (runs, len(self.weight)))
        new_p, new_q = self.p.copy(), self.q.copy()
        for b in range(runs):
            for i in range(n):
                heard, missing = self._hear(step, b, i, delays, status)
                new_p[b, i], new_q[b, i] = self._drive(b, i, heard, missing, bool(update[b, i]))
        self.last_update = np.where(update, step, self.last_update)
        self.previous, self.p, self.q = self.p, new_p, new_q

    def _arcs(self, i: int) -> range:
        indptr = self.topology.union.in_indptr
        return range(int(indptr[i]), int(indptr[i + 1]))

    def _hear(
        self, step: int, b: int, i: int, delays: np.ndarray, status: np.ndarray
    ) -> tuple[dict[int, float], int]:
        """Return the position heard on each arc of vehicle i, and how many neighbours withheld theirs."""
        heard: dict[int, float] = {}
        missing = 0
        remembered = self.vehicles[b][i].remembered
        for e in self._arcs(i):
            if status[b, e] == 1:
                sent_at = step - int(delays[b, e])
                heard[e] = float(self.ring[sent_at % self.slots, b, self.board.channel[e]])
                remembered[e] = (heard[e], sent_at)
            elif status[b, e] == 2:
                missing += 1
            elif e in remembered and step - remembered[e][1] <= self.scenario.schedule.oldest:
                heard[e] = remembered[e][0]
        return heard, missing

    def _drive(self, b: int, i: int, heard: dict[int, float], missing: int, updates: bool) -> tuple[float, float]:
        """Return the next position and velocity of vehicle i."""
        vehicle, T = self.vehicles[b][i], self.scenario.T
        own, speed = float(self.p[b, i]), float(self.q[b, i])
        if updates:
            relative = {e: heard[e] - own for e in heard}
            drop = max(self.scenario.f - missing, 0)
            vehicle.kept = {e: heard[e] for e in kept_neighbours(relative, drop, strict=self.rule.strict)}
        elif self.rule.first_order:
            return own, 0.0
        total = mass = 0.0
        for e, position in sorted(vehicle.kept.items()):
            total += float(self.weight[e]) * (position - own)
            mass += float(self.weight[e])
        if self.rule.first_order:
            return own + total / (1.0 + mass), 0.0
        control = total - float(self.alpha[i]) * speed
        return (own + T * speed) + T * T / 2 * control, speed + T * control


def simulate_plainly(scenario: Scenario, starts: Sequence[Start], *, record: bool = False) -> tuple[Outcome, ...]:
    """Return what :func:`robustness.simulation.run.simulate` returns, by the plain loop.

    Same parameters, errors and warnings; time ``O(K sum_i d_i log d_i)`` Python operations per run.
    """
    if not starts:
        return ()
    batch = _PlainBatch(scenario, starts)
    if batch.promise is not None:
        warnings.warn(batch.promise, PromiseWarning, stacklevel=2)
    observer = Observer(batch.setting, scenario, starts, batch.promise, record=record)
    batch.play_history()
    for step in range(scenario.steps):
        batch.act(step)
        observer.see(step, batch.p, batch.q, batch.sent)
        batch.advance_plainly(step)
    batch.act(scenario.steps)
    observer.see(scenario.steps, batch.p, batch.q, batch.sent)
    return observer.outcomes()
