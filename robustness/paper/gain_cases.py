"""What happens outside the gain region: delays alone drive robust networks apart, and on its edge vehicles swap.

The network is K_{m,m} with m = 4f + 1, which is (2f+1)-robust, with weights 1/(m - f), so that the kept weights add up
to 1. When each side stands at one place, every vehicle drops f equal values and is pulled towards the other side by the
rest with the total weight 1: the two sides move like two single vehicles. The delays of :func:`diverging_delays` come
from the impulse response h of one vehicle that follows a target: where h is negative it overshoots, and is shown an
older place of the other side.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

import networkx as nx
import numpy as np

from robustness.errors import InvalidParameter
from robustness.simulation.dynamics import Floats
from robustness.simulation.motion import Push
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import AdversarialDelays, EveryStep, PeriodicDelays, PeriodicUpdates, Schedule
from robustness.spelled import counted

__all__ = ["GainRun", "Orbit", "diverging_delays", "gains_outside", "push_runs", "swap_runs"]

#: As :class:`Scenario` takes them.
Weights = str | Mapping[tuple[Hashable, Hashable], float]

#: The fewest nodes on a side for f = 1.
_SIDE = 5

#: Turns of the delays that are played.
_TURNS = 60


@dataclass(frozen=True)
class Orbit:
    """A motion of two sides that mirrors and multiplies itself every ``len(delays)`` steps.

    Attributes
    ----------
    delays : tuple of int
        The delay of every link at step k is ``delays[k % len(delays)]``.
    growth : float
        The factor of one turn, above 1; signs alternate.
    position, velocity : float
        Of the one side at the start; the other side has their negatives.
    """

    delays: tuple[int, ...]
    growth: float
    position: float
    velocity: float


@dataclass(frozen=True)
class GainRun:
    """One run about gains: what it is, what theory says of it, and how to play it."""

    name: str
    reading: str
    expected: str
    scenario: Scenario
    start: Start


def diverging_delays(T: float, alpha: float, turn: int) -> Orbit | None:
    """Return the orbit of the necessity proof for kept weights that add up to 1, if it grows.

    Parameters
    ----------
    T, alpha : float
        Outside the gain region, with ``T² < alpha T < 2`` (elsewhere a vehicle is unstable by itself).
    turn : int
        How many steps a turn has, at least 2. For long turns an orbit grows.

    Notes
    -----
    In a turn of H steps the one side sees the other where it was at the beginning of the turn (c = 1), and at the steps
    k where ``h[H - k] < 0`` where it was at the beginning of the turn before (c = -1/growth). The growth solves
    ``e_1 (growth I + F^H)^-1 sum_k F^(H-1-k) G c_k = 1``, found by bisection.
    """
    F = np.array([[1 - T * T / 2, T - T * T / 2 * alpha], [-T, 1 - T * alpha]])
    G = np.array([T * T / 2, T])
    response, state = [], G
    for _ in range(turn):
        response.append(float(state[0]))
        state = F @ state
    overshoots = [response[turn - 1 - k] < 0 for k in range(turn)]
    power = np.linalg.matrix_power(F, turn)

    def reached(growth: float) -> Floats:
        x = np.zeros(2)
        for late in overshoots:
            x = F @ x + G * (-1 / growth if late else 1.0)
        return np.asarray(np.linalg.solve(growth * np.eye(2) + power, x))

    if not reached(1.0)[0] > 1:
        return None
    low, high = 1.0, 2.0
    while reached(high)[0] > 1:
        high *= 2
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if reached(middle)[0] > 1 else (low, middle)
    delays = tuple(k + turn if late else k for k, late in enumerate(overshoots))
    return Orbit(delays, low, *map(float, reached(low)))


def _bipartite() -> tuple[nx.Graph, dict[tuple[Hashable, Hashable], float]]:
    graph = nx.complete_bipartite_graph(_SIDE, _SIDE)
    return graph, dict.fromkeys(graph.to_directed().edges, 1 / (_SIDE - 1))


def _two_sides(position: float, velocity: float) -> Start:
    signs = [1.0] * _SIDE + [-1.0] * _SIDE
    return Start((), [sign * position for sign in signs], [sign * velocity for sign in signs])


def gains_outside() -> tuple[GainRun, ...]:
    """Return runs of K_{5,5}, f = 1, nobody malicious, with gains outside the region and, for control, inside."""
    graph, weights = _bipartite()
    runs = []
    for T, alpha, turn in ((0.5, 0.5, 6), (0.5, 1.0, 6), (0.1, 1.0, 40), (0.01, 0.5, 420), (0.01, 1.0, 500)):
        orbit = diverging_delays(T, alpha, turn)
        if orbit is None:
            turns = f"turns of {counted(turn, 'step')}"
            raise InvalidParameter(f"no orbit grows for T = {T}, alpha = {alpha} in {turns}: take more")
        for gain, expected in ((alpha, "divergence"), (2.2 if T < 0.5 else 1.8, "agreement")):
            scenario = Scenario(
                graph, 1, T=T, alpha=gain, weights=weights, steps=_TURNS * turn,
                schedule=Schedule(EveryStep(), PeriodicDelays(orbit.delays)), dwell=10,
            )  # fmt: skip
            side = "outside" if expected == "divergence" else "inside"
            name = f"K_5,5, T = {T:g}, alpha = {gain:g}, delays of the orbit for {alpha:g}"
            reading = f"3-robust, f = 1, nobody malicious, gains {side} the region"
            if expected == "divergence":
                reading += (
                    f": the motion mirrors itself and grows {orbit.growth:.4g}-fold every {counted(turn, 'step')}"
                )
            runs.append(GainRun(name, reading, expected, scenario, _two_sides(orbit.position, orbit.velocity)))
    return tuple(runs)


def swap_runs() -> tuple[GainRun, ...]:
    """Return runs at sigma T² = 1 and alpha T = 3/2, where vehicles that hear each other swap for ever."""
    graph, weights = _bipartite()
    two, even = nx.complete_graph(2), PeriodicUpdates(2, dict.fromkeys(range(10), 0))
    sides, in_turn = _two_sides(50.0, 0.0), Schedule(EveryStep(), PeriodicDelays((0, 1)))
    networks: tuple[tuple[str, nx.Graph, int, Weights, Schedule, float], ...] = (
        ("K_2, defaults, updates at even steps", two, 0, "uniform", Schedule(PeriodicUpdates(2, {0: 0, 1: 0})), 1.0),
        ("K_5,5, weights 1/4, updates at even steps", graph, 1, weights, Schedule(even), 1.0),
        ("K_5,5, weights 1/4, delays 0 and 1 in turn", graph, 1, weights, in_turn, 1.0),
        ("K_5,5, the same with T = 0.9", graph, 1, weights, in_turn, 0.9),
    )
    runs = []
    for name, network, f, table, schedule, T in networks:
        start = Start((), [0, 100], [0, 0]) if network is two else sides
        robust = "1-robust" if network is two else "3-robust"
        expected = "split" if T == 1 else "agreement"
        reading = f"{robust}, f = {f}, nobody malicious, sigma T² = {T * T:g}, alpha T = 1.5"
        scenario = Scenario(network, f, T=T, weights=table, schedule=schedule, steps=2000)
        runs.append(GainRun(name, reading, expected, scenario, start))
    return tuple(runs)


def push_runs() -> tuple[GainRun, ...]:
    """Return runs of K_5, T = 0.01, unit weights, delays 0 or 1: one vehicle pushes the others along as they move.

    What it claims is always dropped, but it chooses which side is trimmed. Theorem 1 of the source paper asks of gains
    only that they are positive; for alpha = 0.3 it is false.
    """
    graph = nx.complete_graph(5)
    places = [51.18, 95.05, 14.42, 94.86, 31.18]
    runs = []
    for alpha, expected in ((0.3, "divergence"), (3.5, "agreement")):
        scenario = Scenario(
            graph, 1, adversary=Push(), T=0.01, alpha=alpha, weights="unit", steps=12_000,
            schedule=Schedule(EveryStep(), AdversarialDelays(1)),
        )  # fmt: skip
        side = "outside" if expected == "divergence" else "inside"
        name, reading = f"K_5, unit weights, T = 0.01, alpha = {alpha:g}", f"3-robust, f = 1, gains {side} the region"
        runs.append(GainRun(name, reading, expected, scenario, Start([4], places, [0.0] * 5)))
    return tuple(runs)
