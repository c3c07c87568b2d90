"""What the plain loop knows and measures about its runs: gains and weights, divergence, spreads, what was kept."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robustness.digraph import Digraph
from robustness.gain_region import gain_gap, hull_velocity_factor
from robustness.simulation.contraction import proven_contraction
from robustness.simulation.gains import fleet_of
from robustness.simulation.outcome import (
    Outcome,
    Trajectory,
    convergence_rate,
    groups_of,
    settled_since,
    verdict_of,
)
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.update_rules import Rule
from robustness.spelled import Spelling

__all__ = ["PlainRecord"]


class PlainRecord:
    """Gains and weights of the vehicles, and all states of B runs, as lists.

    Attributes
    ----------
    gains : list
        ``alpha_i`` by id.
    weights : list
        ``a_ij`` by place in the list of arcs.
    """

    def __init__(
        self,
        scenario: Scenario,
        rule: Rule,
        union: Digraph,
        arcs: list[tuple[int, int]],
        starts: Sequence[Start],
        bad: list[set[int]],
    ) -> None:
        self.scenario, self.rule, self.union, self.starts, self.bad = scenario, rule, union, starts, bad
        labels, alpha, weights = union.labels, scenario.alpha, scenario.weights
        self.gains: list[float] = [
            1.5 / scenario.T if alpha is None else alpha if isinstance(alpha, float) else alpha[label]
            for label in labels
        ]
        heard = [sum(v == i for _, v in arcs) for i in range(union.n)]
        even = weights == "unit" or (rule.first_order and weights == "uniform")
        self.weights: list[float] = [
            weights[labels[u], labels[v]] if not isinstance(weights, str) else 1.0 if even else 1.0 / heard[v]
            for u, v in arcs
        ]
        self.into = [[self.weights[e] for e, (_, v) in enumerate(arcs) if v == i] for i in range(union.n)]
        self.stopped: list[int | None] = [None] * len(starts)
        #: p, q and claims by run and step.
        self.seen: list[list[tuple[list[float], list[float], list[float]]]] = [[] for _ in starts]

    def normal(self, b: int) -> list[int]:
        """Return the ids of the normal vehicles of a run."""
        return [i for i in range(self.union.n) if i not in self.bad[b]]

    def _reach(self, i: int) -> float:
        coasting = 0.0 if self.rule.first_order else 1 / self.gains[i]
        return min(max(self.scenario.T, coasting), 1e100)

    def stop(
        self, step: int, p: list[list[float]], q: list[list[float]], new_p: list[list[float]], new_q: list[list[float]]
    ) -> None:
        """Stop the runs that diverge at this step; a malicious vehicle that does stays where it was."""
        for b in range(len(p)):
            for i in self.bad[b]:
                if not (math.isfinite(new_p[b][i]) and math.isfinite(new_q[b][i])):
                    new_p[b][i], new_q[b][i] = p[b][i], 0.0
            states = [(new_p[b][i], new_q[b][i]) for i in self.normal(b)]
            lost = any(not (math.isfinite(x) and math.isfinite(v)) for x, v in states)
            if self.stopped[b] is not None or lost:
                new_p[b], new_q[b] = list(p[b]), list(q[b])
            if self.stopped[b] is None and (lost or self._beyond(b, new_p[b], new_q[b])):
                self.stopped[b] = step

    def _beyond(self, b: int, p: list[float], q: list[float]) -> bool:
        """Return whether a normal vehicle has grown past the scenario's factor."""
        first, speeds = self.starts[b].positions, self.starts[b].velocities
        normal = self.normal(b)
        if not normal:
            return False
        low, high = min(first[i] for i in normal), max(first[i] for i in normal)
        quick = 0.0 if self.rule.first_order else max(self._reach(i) * abs(speeds[i]) for i in normal)
        limit = self.scenario.growth * (max(high - low, quick) or 1.0)
        middle = low / 2 + high / 2
        return any(abs(p[i] - middle) > limit or self._reach(i) * abs(q[i]) > limit for i in normal)

    def see(self, p: list[list[float]], q: list[list[float]], sent: list[list[float]]) -> None:
        """Note the states of a step."""
        for b, rows in enumerate(zip(p, q, sent, strict=True)):
            self.seen[b].append((list(rows[0]), list(rows[1]), list(rows[2])))

    def outcomes(self, *, keep: bool) -> tuple[Outcome, ...]:
        """Return the outcome of every run, with all states when asked to keep them."""
        return tuple(self._outcome(b, keep=keep) for b in range(len(self.seen)))

    def _outcome(self, b: int, *, keep: bool) -> Outcome:
        scenario, normal, stopped = self.scenario, self.normal(b), self.stopped[b]
        places = [[p[i] for i in normal] or [0.0] for p, _, _ in self.seen[b]]
        spread = np.array([max(row) - min(row) for row in places])
        speed = np.array([max((abs(q[i]) for i in normal), default=0.0) for _, q, _ in self.seen[b]])
        limit = scenario.tolerance * (float(spread[0]) or 1.0)
        verdict, exact = verdict_of(
            spread, speed, limit, scenario.dwell_steps, watched=scenario.groups is not None,
            unchanged=self._unchanged(b), diverged=stopped is not None,
        )  # fmt: skip
        nothing_promised = next((gap for gap in map(self._gap, normal) if gap is not None), None)
        fleet = fleet_of(self.union, self.rule, scenario.f, scenario.T, scenario.alpha, scenario.weights)
        final = np.array(self.seen[b][-1][0])
        is_normal = np.array([i in normal for i in range(self.union.n)], dtype=bool)
        return Outcome(
            verdict, exact, stopped, float(spread[-1]), float(spread[0]), float(speed[-1]),
            None if stopped is not None else settled_since(spread, limit),
            None if stopped is not None else convergence_rate(spread),
            proven_contraction(self.union, fleet, scenario.f, len(normal), scenario.schedule)
            if scenario.network.fixed else None,
            None if nothing_promised is not None else stopped is None and self._safe(b, places),
            nothing_promised, groups_of(final, is_normal, self.union.labels, limit),
            self._trajectory(b) if keep else None,
        )  # fmt: skip

    def _sigma(self, i: int) -> float:
        """Return the most that the kept weights of a vehicle add up to: all but the f smallest."""
        return float(np.sort(np.array(self.into[i]))[self.scenario.f :].sum())

    def _gap(self, i: int) -> str | None:
        """Return why nothing is promised about a vehicle."""
        if self.rule.update is not None:
            return "no theorem is about an update rule of one's own: nothing is promised about this run"
        if self.rule.first_order:
            return None
        gap = gain_gap(self.scenario.T, self.gains[i], self._sigma(i))
        if gap is None:
            return None
        node = Spelling(self.union.labels)(self.union.labels[i])
        return f"outside the gains of the theory at node {node}, nothing is promised: {gap}"

    def _safe(self, b: int, places: list[list[float]]) -> bool:
        """Return whether every normal position stayed in the hull of all p and p + c q of the start."""
        start, normal = self.starts[b], self.normal(b)
        ends = [start.positions[i] for i in normal]
        if not self.rule.first_order:
            for i in normal:
                c = hull_velocity_factor(self.scenario.T, self.gains[i], self._sigma(i))
                ends.append(start.positions[i] + c * start.velocities[i])
        if not ends:
            return True
        low, high = min(ends), max(ends)
        slack = 1e-9 * max(high - low, abs(low), abs(high), 1e-300)
        return all(min(row) >= low - slack and max(row) <= high + slack for row in places)

    def _unchanged(self, b: int) -> bool:
        """Return whether two watched groups start apart, each in agreement, and never move."""
        if self.scenario.groups is None:
            return True
        sides = [[self.union.labels.index(label) for label in group] for group in self.scenario.groups]
        first, second = ([i for i in side if i not in self.bad[b]] for side in sides)
        places = self.starts[b].positions
        if not first or not second:
            return False
        apart = max(places[i] for i in first) < min(places[i] for i in second)
        apart |= max(places[i] for i in second) < min(places[i] for i in first)
        return apart and all(p[i] == places[i] and q[i] == 0 for p, q, _ in self.seen[b] for i in (*first, *second))

    def _trajectory(self, b: int) -> Trajectory:
        """Return all states, with every vehicle's place in the formation added."""
        offsets = self.scenario.offsets or {}
        shift = np.array([offsets.get(label, 0.0) for label in self.union.labels])
        p, q, sent = (np.array(rows) for rows in zip(*self.seen[b], strict=True))
        return Trajectory(p + shift, q, sent + shift)
