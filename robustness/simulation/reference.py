"""The same runs, vehicle by vehicle in plain Python: Algorithm 1 of the source paper, read aloud.

Slow on purpose. Nothing is vectorised or compiled, every vehicle keeps its own records, and the network, the gains, the
weights, the messages and what is measured are prepared and kept here, so that there is little that could be wrong but
the algorithm itself. The engine must give the same states bit for bit; tests compare them, and
``benchmarks/simulation.py`` measures the ratio. Shared with the engine are only what both are given: the adversary, the
schedule and the random numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robustness.digraph import Digraph
from robustness.simulation.adversaries.protocol import Move, Setting, View
from robustness.simulation.draws import Draws
from robustness.simulation.fault_models import FAULT_MODELS
from robustness.simulation.outcome import Outcome
from robustness.simulation.own_rule import called
from robustness.simulation.plain_measures import PlainRecord
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import Past
from robustness.simulation.update_rules import rule_named

__all__ = ["kept_neighbours", "simulate_plainly"]

#: One number for every vehicle, or for every arc, of one run.
_Row = list[float]


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
    """What one vehicle of one run knows; arcs are named by their place in the network's list."""

    #: The arcs kept at the last update, with the positions heard then.
    kept: dict[int, float] = field(default_factory=dict)
    #: The last message on every link that comes and goes, with the step it was sent at.
    remembered: dict[int, tuple[float, int]] = field(default_factory=dict)


class _Plain:
    """B runs, advanced vehicle by vehicle."""

    def __init__(self, scenario: Scenario, starts: Sequence[Start]) -> None:
        self.scenario, self.rule = scenario, rule_named(scenario.rule)
        labels = scenario.network.graphs[0].labels
        everywhere = {(labels[u], labels[v]) for graph in scenario.network.graphs for u, v in graph.arcs()}
        self.union = Digraph(labels, [*everywhere, *(link for link in scenario.added_links if link not in everywhere)])
        #: (sender, receiver) of every arc, by receiver and then by sender: the order in which adversaries see them.
        self.arcs = sorted(self.union.arcs(), key=lambda arc: (arc[1], arc[0]))
        self.bad = [{labels.index(label) for label in start.malicious} for start in starts]
        self.p: list[_Row] = [list(start.positions) for start in starts]
        self.q = [[0.0] * len(labels) if self.rule.first_order else list(start.velocities) for start in starts]
        self.previous = [list(row) for row in self.p]
        self.sent = [list(row) for row in self.p]
        self.updated = [[-1] * len(labels) for _ in starts]
        self.vehicles = [[_Vehicle() for _ in labels] for _ in starts]
        #: What every arc announced, by step and run.
        self.announced: dict[int, list[_Row]] = {}
        self.move = Move()
        malicious = np.array([[i in bad for i in range(len(labels))] for bad in self.bad])
        delays = scenario.schedule.delay_rule
        self.setting = Setting(
            self.union, malicious, scenario.f, FAULT_MODELS[scenario.model], scenario.T, np.array(self.p),
            Draws([start.seed for start in starts]), delays.bound, delays.adversarial, self.trial,
        )  # fmt: skip
        self.record = PlainRecord(scenario, self.rule, self.union, self.arcs, starts, self.bad)

    def view(self, step: int) -> View:
        states = np.array(self.p), np.array(self.q), np.array(self.previous)
        return View(self.setting, step, *states, np.array(self.updated))

    def act(self, step: int, *, moving: bool = True) -> None:
        """Let the malicious vehicles move and speak; before step 0 nobody moves."""
        self.move = self.scenario.adversary.play(self.view(step))
        here = [list(row) for row in self.p]
        for b, bad in enumerate(self.bad):
            for i in bad:
                if self.move.positions is not None and not math.isnan(self.move.positions[b, i]):
                    here[b][i] = float(self.move.positions[b, i])
                    if step > 0 and not self.rule.first_order:
                        self.q[b][i] = (here[b][i] - self.previous[b][i]) / self.scenario.T
        self.sent = [list(row) for row in here]
        for b, bad in enumerate(self.bad):
            for i in bad:
                if self.move.sent is not None and not math.isnan(self.move.sent[b, i]):
                    self.sent[b][i] = float(self.move.sent[b, i])
        active = {self.union.labels.index(label) for label in self.scenario.active}
        self.announced[step] = [
            [self._said(b, e, here[b][u] if v in active else None) for e, (u, v) in enumerate(self.arcs)]
            for b in range(len(self.p))
        ]
        if moving:
            self.p = here

    def _said(self, b: int, e: int, seen: float | None) -> float:
        """Return what arc e tells: what is seen, or what its sender claims on it, or to all."""
        if seen is not None:
            return seen
        told = self.move.told
        if told is not None and not math.isnan(told[b, e]):
            return float(told[b, e])
        return self.sent[b][self.arcs[e][0]]

    def advance(self, step: int) -> None:
        view = self.view(step)
        shape = (len(self.p), len(self.arcs))
        update = np.broadcast_to(self.scenario.schedule.update_times.updates(view), view.p.shape)
        delay = np.broadcast_to(self.scenario.schedule.delay_rule.delays(view, self._past(step)), shape)
        states = []
        for b in range(len(self.p)):
            for i in range(self.union.n):
                heard, missing = self._heard(step, b, i, delay)
                states.append(self._driven(b, i, heard, missing, bool(update[b, i])))
                if update[b, i]:
                    self.updated[b][i] = step
        rows = [states[b * self.union.n : (b + 1) * self.union.n] for b in range(len(self.p))]
        new_p, new_q = [[p for p, _ in row] for row in rows], [[q for _, q in row] for row in rows]
        self.record.stop(step + 1, self.p, self.q, new_p, new_q)
        self.previous, self.p, self.q = self.p, new_p, new_q

    def _past(self, step: int) -> Past:
        """Return the announcements as schedules see them: here every arc is a channel of its own."""
        depth = self.scenario.schedule.delay_rule.bound + 1
        ring = np.zeros((depth, len(self.p), len(self.arcs)))
        for k in range(step - depth + 1, step + 1):
            ring[k % depth] = self.announced[k]
        return Past(ring, np.arange(len(self.arcs)))

    def _heard(self, step: int, b: int, i: int, delay: Any) -> tuple[dict[int, float], int]:
        """Return the position heard on each arc into vehicle i, and how many neighbours withheld theirs."""
        scenario, move = self.scenario, self.move
        heard: dict[int, float] = {}
        missing, remembered = 0, self.vehicles[b][i].remembered
        graph = scenario.network.graphs[scenario.network.sequence[step % len(scenario.network.sequence)]]
        looks = self.union.labels[i] in scenario.active
        for e in (e for e, (_, v) in enumerate(self.arcs) if v == i):
            u = self.arcs[e][0]
            link = (self.union.labels[u], self.union.labels[i])
            if u in graph.in_neighbours(i).tolist() or link in scenario.added_links:
                if move.withheld is not None and move.withheld[b, e] and not looks:
                    missing += 1
                    continue
                chosen = -1 if move.delays is None else int(move.delays[b, e])
                sent_at = step - (chosen if chosen >= 0 else int(delay[b, e]))
                heard[e] = self.announced[sent_at][b][e]
                remembered[e] = (heard[e], sent_at)
            elif e in remembered and step - remembered[e][1] <= scenario.schedule.oldest:
                heard[e] = remembered[e][0]
        return heard, missing

    def _driven(self, b: int, i: int, heard: dict[int, float], missing: int, updates: bool) -> tuple[float, float]:
        """Return the next position and velocity of vehicle i."""
        vehicle, T, own, speed = self.vehicles[b][i], self.scenario.T, self.p[b][i], self.q[b][i]
        if self.rule.update is not None:
            return (called(self.rule.update, own, tuple(heard.values())) if updates else own), 0.0
        if updates:
            drop = max(self.scenario.f - missing, 0)
            kept = kept_neighbours({e: heard[e] - own for e in heard}, drop, strict=self.rule.strict)
            vehicle.kept = {e: heard[e] for e in kept}
        elif self.rule.first_order:
            return own, 0.0
        total = mass = 0.0
        for e, position in sorted(vehicle.kept.items()):
            total += self.record.weights[e] * (position - own)
            mass += self.record.weights[e]
        if self.rule.first_order:
            return own + total / (1.0 + mass), 0.0
        control = total - self.record.gains[i] * speed
        return own + T * speed + T * T / 2 * control, speed + T * control

    def trial(self, p: Any, q: Any, sent: Any) -> Any:
        """Return the positions one step later if everybody updated now and heard ``sent`` at once."""
        rows = []
        kept_states = self.p, self.q, self.vehicles
        self.p, self.q = p.tolist(), q.tolist()
        self.vehicles = [[_Vehicle() for _ in row] for row in self.p]
        for b in range(len(self.p)):
            heard: list[dict[int, float]] = [{} for _ in range(self.union.n)]
            for e, (u, v) in enumerate(self.arcs):
                heard[v][e] = float(sent[b, u])
            rows.append([self._driven(b, i, heard[i], 0, True)[0] for i in range(self.union.n)])
        self.p, self.q, self.vehicles = kept_states
        return np.array(rows)


def simulate_plainly(scenario: Scenario, starts: Sequence[Start], *, record: bool = False) -> tuple[Outcome, ...]:
    """Return what :func:`robustness.simulation.run.simulate` returns, by the plain loop.

    Unlike that it neither checks that the adversary keeps to its model nor warns where nothing is promised; its time is
    ``O(K sum_i d_i log d_i)`` Python operations per run.
    """
    if not starts:
        return ()
    runs = _Plain(scenario, starts)
    for step in range(-scenario.schedule.delay_rule.bound, 0):
        runs.act(step, moving=False)
    for step in range(scenario.steps):
        runs.act(step)
        runs.record.see(runs.p, runs.q, runs.sent)
        runs.advance(step)
    runs.act(scenario.steps)
    runs.record.see(runs.p, runs.q, runs.sent)
    return runs.record.outcomes(keep=record)
