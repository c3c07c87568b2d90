"""What is measured while a batch runs: spreads, exact invariants, safety; and the outcomes made of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from robustness.simulation.adversaries.protocol import Setting
from robustness.simulation.contraction import proven_contraction
from robustness.simulation.dynamics import Floats
from robustness.simulation.formation import node_offsets
from robustness.simulation.gains import Fleet
from robustness.simulation.outcome import (
    Outcome,
    Trajectory,
    convergence_rate,
    groups_of,
    settled_since,
    verdict_of,
)
from robustness.simulation.scenario import Scenario, Start

__all__ = ["Observer"]

#: Safety is checked up to rounding: a relative error of this much of the promised range.
_ROUNDING = 1e-9


class Observer:
    """What is seen of B runs while they go on, beside their states.

    Safety: with gains inside the region the hull of all ``p`` and ``p + c q`` of normal vehicles never grows, see
    :mod:`robustness.gain_region` (whatever the filter keeps lies between values of normal vehicles). Before step 0
    everybody stands at its initial position. So no normal position ever leaves the hull of the start, which is checked
    at every step; for first-order rules q = 0.
    """

    def __init__(
        self,
        setting: Setting,
        fleet: Fleet,
        scenario: Scenario,
        starts: Sequence[Start],
        gaps: Sequence[str | None],
        *,
        record: bool,
    ) -> None:
        states, runs, n = scenario.steps + 1, len(starts), setting.graph.n
        self.setting, self.scenario, self.starts, self.gaps = setting, scenario, starts, gaps
        self.low, self.high = np.zeros((states, runs)), np.zeros((states, runs))
        self.speed = np.zeros((states, runs))
        self.normal = ~setting.malicious
        self.final = setting.initial
        self.offsets = node_offsets(setting.graph, scenario.offsets)
        self.watched = np.zeros((runs, n), dtype=bool)
        self.unchanged = np.ones(runs, dtype=bool)
        if scenario.groups is not None:
            self._watch(*(sorted(setting.graph.ids(group)) for group in scenario.groups))
        self.record = [np.zeros((states, runs, n)) for _ in range(3)] if record else None
        velocities = np.array([start.velocities for start in starts]).reshape(runs, n)
        self.ahead = setting.initial + (0.0 if fleet.rule.first_order else fleet.coasting * velocities)
        self.contraction = [
            proven_contraction(setting.graph, fleet, scenario.f, int(row.sum()), scenario.schedule)
            if scenario.network.fixed else None
            for row in self.normal
        ]  # fmt: skip

    def _watch(self, first: list[int], second: list[int]) -> None:
        """Watch the normal nodes of two groups, each of which starts in agreement and apart from the other."""
        self.watched[:, first + second] = True
        self.watched &= self.normal
        ends = []
        for group in (first, second):
            normal, values = self.normal[:, group], self.setting.initial[:, group]
            self.unchanged &= normal.any(axis=1)
            ends.append((np.where(normal, values, np.inf).min(1), np.where(normal, values, -np.inf).max(1)))
        (low_1, high_1), (low_2, high_2) = ends
        self.unchanged &= (high_1 < low_2) | (high_2 < low_1)

    def see(self, step: int, p: Floats, q: Floats, sent: Floats) -> None:
        """Measure the states ``p, q (B, n)`` of one step."""
        from robustness.kernels.steps import extremes

        extremes(p, q, self.normal.view(np.uint8), self.low[step], self.high[step], self.speed[step])
        if self.scenario.groups is not None:
            moved = self.watched & ((p != self.setting.initial) | (q != 0.0))
            self.unchanged &= ~moved.any(axis=1)
        if self.record is not None:
            for store, values in zip(self.record, (p + self.offsets, q, sent + self.offsets), strict=True):
                store[step] = values
        self.final = p

    def so_far(self, step: int, seen: int) -> str:
        """Return a step in words, and the greatest spread of all runs in the last of the ``seen`` states."""
        where = f"step {step} of {self.scenario.steps}"
        if not seen or not self.normal.any():
            return where
        now, first = ((self.high[k] - self.low[k]).max() for k in (seen - 1, 0))
        return f"{where} (spread {now:g}, {first:g} at first)"

    def outcomes(self, diverged: npt.NDArray[np.int64]) -> tuple[Outcome, ...]:
        """Return the outcome of every run, given the steps ``(B,)`` at which they diverged (-1: not)."""
        return tuple(self._outcome(b, int(step)) for b, step in enumerate(diverged))

    def _outcome(self, b: int, diverged: int) -> Outcome:
        scenario, setting, stopped = self.scenario, self.setting, diverged >= 0
        if not self.normal[b].any():
            self.low[:, b] = self.high[:, b] = 0.0
        spread, speed = self.high[:, b] - self.low[:, b], self.speed[:, b]
        limit = scenario.tolerance * (float(spread[0]) or 1.0)
        verdict, exact = verdict_of(
            spread, speed, limit, scenario.dwell_steps,
            watched=scenario.groups is not None, unchanged=bool(self.unchanged[b]), diverged=stopped,
        )  # fmt: skip
        states = None if self.record is None else Trajectory(*(store[:, b].copy() for store in self.record))
        return Outcome(
            verdict=verdict,
            exact=exact,
            diverged_at=diverged if stopped else None,
            spread=float(spread[-1]),
            initial_spread=float(spread[0]),
            speed=float(speed[-1]),
            since=None if stopped else settled_since(spread, limit),
            rate=None if stopped else convergence_rate(spread),
            contraction=self.contraction[b],
            safe=self._safe(b, stopped=stopped),
            promise_gap=self.gaps[b],
            groups=groups_of(self.final[b], self.normal[b], setting.graph.labels, limit),
            trajectory=states,
            scenario=scenario,
            start=self.starts[b],
        )

    def _safe(self, b: int, *, stopped: bool) -> bool | None:
        """Return whether the hull of the start was kept, or None where the theory promises none."""
        if self.gaps[b] is not None:
            return None
        normal = self.normal[b]
        if stopped or not normal.any():
            return not stopped
        ends = np.concatenate([self.setting.initial[b, normal], self.ahead[b, normal]])
        floor, ceiling = float(ends.min()), float(ends.max())
        slack = _ROUNDING * max(ceiling - floor, abs(floor), abs(ceiling), 1e-300)
        return bool((self.low[:, b] >= floor - slack).all() and (self.high[:, b] <= ceiling + slack).all())
