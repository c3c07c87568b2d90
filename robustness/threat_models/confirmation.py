"""Every attack is carried out before it is believed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries import Alternating
from robustness.simulation.adversaries.protocol import View
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import Flags, LatestDelays, Schedule
from robustness.simulation.topology import as_topology
from robustness.threat_models.remembered import Remembered, idle_steps
from robustness.threat_models.results import AttackSets, ToleranceResult

__all__ = ["confirm"]


def confirm(result: ToleranceResult, steps: int = 12) -> bool | None:
    """Return whether the attack on ``result.refuted``, played by the plain loop, splits the network exactly.

    None without an attack, and over time where updates lie so far apart that the simulator, which uses no value older
    than tau even between updates, cannot play it. *Exactly*: no vehicle of the two groups moves by one bit or gains any
    speed, at any step. An attack repeats after two steps (two periods, over time), so a few are as good as many:
    :mod:`robustness.simulation.attacks` has the induction.

    >>> import networkx as nx
    >>> from robustness.threat_models import tolerance
    >>> confirm(tolerance(nx.wheel_graph(5), "delayed"))
    True
    """
    from robustness.simulation.reference import simulate_plainly

    sets, attack = result.attack_sets, result.attack
    if sets is not None and sets.remembered:
        if (result.gap or 1) - 1 + (result.delay or 0) > (result.tau or 0):
            return None
        scenario, start = _over_time(result, sets)
        return simulate_plainly(scenario, [start])[0].exact
    if attack is None:
        return None
    rules = ("adp-msr", "w-msr") if attack.delayed else ("adp-msr", "dp-msr", "w-msr")
    scenarios = [attack.scenario(steps, rule=rule) for rule in rules]
    return all(simulate_plainly(each, [attack.start()])[0].exact for each in scenarios)


@dataclass(frozen=True, slots=True)
class _Turns:
    """Updates by a table that repeats: row k, shape ``(n,)``, says who updates at step k."""

    rows: tuple[tuple[bool, ...], ...]
    gap: int

    def updates(self, view: View) -> Flags:
        return np.asarray([self.rows[view.step % len(self.rows)]], dtype=np.uint8)


def _over_time(result: ToleranceResult, sets: AttackSets) -> tuple[Scenario, Start]:
    """Return the attack of Theorem C (b): all delays at their bound, and nobody of a side updates while active."""
    sequence, tau, delay, gap = result.sequence, result.tau, result.delay, result.gap
    if sequence is None or tau is None or delay is None or gap is None:
        raise TypeError("only sets about a sequence are remembered")
    graph = result.graph
    remembered = Remembered.of(sequence, tau, delay, gap)
    bad, first, second = (graph.ids(labels) for labels in (sets.M, sets.S1, sets.S2))
    idle = {i: idle_steps(remembered.period, sets.f, side, bad, i) for side in (first, second) for i in sorted(side)}
    period = len(remembered.period)
    steps = len(remembered.before) + 2 * period + tau
    # Window k of the period ends tau - delay steps after it begins. The first windows of a network without a prefix are
    # parts of those that end a period later. Before a period that has a prefix, everybody is idle and may update.
    offset = len(remembered.before) if sequence.prefix else tau - delay
    rows = tuple(
        tuple(i not in idle or k < len(remembered.before) or idle[i][(k - offset) % period] for i in range(graph.n))
        for k in range(steps)
    )
    scenario = Scenario(
        as_topology(sequence, steps),
        f=sets.f,
        model=result.threat.faults,
        steps=steps,
        adversary=Alternating(0.0, 100.0, tuple(sets.S1), tuple(sets.S2)),
        schedule=Schedule(_Turns(rows, gap), LatestDelays(delay), tau=tau),
        groups=(tuple(sets.S1), tuple(sets.S2)),
    )
    places = [0.0 if i in first else 100.0 if i in second else 50.0 for i in range(graph.n)]
    return scenario, Start(sets.M, tuple(places), (0.0,) * graph.n, 0)
