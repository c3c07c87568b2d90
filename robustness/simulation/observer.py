"""What is measured while a batch runs: spreads, exact invariants, safety; and the outcomes made of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robustness.simulation.adversaries.protocol import Setting
from robustness.simulation.dynamics import Floats
from robustness.simulation.formation import node_offsets
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
    """Watches B runs.

    The safety interval: with gains inside the theory every new position of a normal vehicle is a convex combination
    of positions of normal vehicles at earlier steps (see :mod:`robustness.simulation.gains`; whatever the filter keeps
    lies between values of normal vehicles). So all of them stay in the hull of the normal positions at steps 0 and 1,
    which is checked at every step. For first-order rules step 0 alone would do.
    """

    def __init__(
        self, setting: Setting, scenario: Scenario, starts: Sequence[Start], promise: str | None, *, record: bool
    ) -> None:
        states, runs, n = scenario.steps + 1, len(starts), setting.graph.n
        self.setting, self.scenario, self.promise = setting, scenario, promise
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

    def outcomes(self) -> tuple[Outcome, ...]:
        """Return the outcome of every run."""
        return tuple(self._outcome(b) for b in range(self.low.shape[1]))

    def _outcome(self, b: int) -> Outcome:
        scenario, setting = self.scenario, self.setting
        if not self.normal[b].any():
            self.low[:, b] = self.high[:, b] = 0.0
        spread, speed = self.high[:, b] - self.low[:, b], self.speed[:, b]
        limit = scenario.tolerance * (float(spread[0]) or 1.0)
        verdict, exact = verdict_of(
            spread, speed, limit, scenario.dwell_steps,
            watched=scenario.groups is not None, unchanged=bool(self.unchanged[b]),
        )  # fmt: skip
        states = None if self.record is None else Trajectory(*(store[:, b].copy() for store in self.record))
        return Outcome(
            verdict=verdict,
            exact=exact,
            spread=float(spread[-1]),
            initial_spread=float(spread[0]),
            speed=float(speed[-1]),
            since=settled_since(spread, limit),
            rate=convergence_rate(spread),
            safe=self._safe(b),
            promise=self.promise,
            groups=groups_of(self.final[b], self.normal[b], setting.graph.labels, limit),
            trajectory=states,
        )

    def _safe(self, b: int) -> bool | None:
        """Return whether the safety interval was kept, or None where the theory promises none."""
        if self.promise is not None:
            return None
        low, high = self.low[:, b], self.high[:, b]
        floor, ceiling = low[:2].min(), high[:2].max()
        slack = _ROUNDING * max(ceiling - floor, abs(floor), abs(ceiling), 1e-300)
        return bool((low >= floor - slack).all() and (high <= ceiling + slack).all())
