"""Claims about how vehicles move, hear and filter: exact arithmetic, small enumerations, runs of a few vehicles."""

from __future__ import annotations

import warnings
from fractions import Fraction
from itertools import pairwise, product

import numpy as np

from robustness.constructions.families import complete
from robustness.digraph import as_digraph
from robustness.paper.audit.claims import Claim, Outcome
from robustness.paper.experiments import EXPERIMENTS
from robustness.simulation.adversaries import ADVERSARIES
from robustness.simulation.filters import kept_by_msr
from robustness.simulation.gains import PromiseWarning
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, random_start
from robustness.simulation.schedules import schedule_named
from robustness.simulation.topology import Topology
from robustness.spelled import counted

__all__ = ["CLAIMS"]

#: Positions, speeds, inputs and periods for exact arithmetic.
_NUMBERS = (Fraction(0), Fraction(3), Fraction(-5, 2))
_PERIODS = (Fraction(1), Fraction(1, 100), Fraction(3, 2))


def _moved(x: Fraction, v: Fraction, u: Fraction, T: Fraction) -> tuple[Fraction, Fraction]:
    """Return position and speed one period later, by the discrete form (2)."""
    return x + T * v + T * T / 2 * u, v + T * u


def _discrete_form() -> Outcome:
    """Where the input is constant, two half periods are one period, and small periods approach (1)."""
    for x, v, u, T in product(_NUMBERS, _NUMBERS, _NUMBERS, _PERIODS):
        half = _moved(x, v, u, T / 2)
        if _moved(*half, u, T / 2) != _moved(x, v, u, T):
            return Outcome("fails", "exact arithmetic", f"x = {x}, v = {v}, u = {u}, T = {T}")
    return Outcome("holds", "exact arithmetic", "exact while the input is constant: two half periods make one")


def _change_of_variables() -> Outcome:
    """Moving (x, v) by (2) and (p, q) by (4) commutes with x = p + kTr, v = q + r."""
    for p, q, u, T, r in product(_NUMBERS, _NUMBERS, _NUMBERS, _PERIODS, _NUMBERS):
        for k in (0, 7):
            x, v = _moved(p + k * T * r, q + r, u, T)
            later = _moved(p, q, u, T)
            if (x - (k + 1) * T * r, v - r) != later:
                return Outcome("fails", "exact arithmetic", f"p = {p}, q = {q}, u = {u}, T = {T}, r = {r}")
    return Outcome("holds", "exact arithmetic", "differences of positions at one step are the same in x and in p")


def _pair_apart(shift: float, deltas: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return where ``p_2 - p_1`` ends when vehicle 2 hears vehicle 1 five steps late, ``shift`` added to what it hears.

    Two vehicles, input (5), T = 1/2, alpha T = 3/2, weights 1/2.
    """
    T, alpha, late, steps = 0.5, 3.0, 5, 4000
    p, q, past = np.array([0.0, 10.0]), np.zeros(2), [0.0] * late
    for _ in range(steps):
        past.append(float(p[0]))
        relative = np.array([p[1] - p[0] - deltas[0], past.pop(0) + shift - p[1] - deltas[1]])
        u = 0.5 * relative - alpha * q
        p, q = p + T * q + T * T / 2 * u, q + T * u
    return float(p[1] - p[0])


def _age_of_values() -> Outcome:
    """Positions as they were sent, x_j[k - tau] - x_i[k], differ from the p's by tau T r."""
    speed, T, late = 20.0, 0.5, 5
    stamped, raw = _pair_apart(0.0), _pair_apart(-late * T * speed)
    agrees, parts = abs(stamped) < 1e-6, abs(raw) > 1.0
    note = (
        "what is received is x_j of an earlier step: vehicles must know how old it is, and add that age times T r. "
        f"Two vehicles, one link 5 steps late, r = 20: with the age they meet, without it they end {abs(raw):.1f} apart"
    )
    return Outcome("holds corrected" if agrees and parts else "fails", "two vehicles, input (5)", note)


def _signs() -> Outcome:
    """Two vehicles that follow the control input with delta_12 = 7: which difference tends to 7?"""
    apart = _pair_apart(0.0, (7.0, -7.0))
    note = "the control input drives x_j - x_i to delta_ij; with the sign of the problem set-up it would be x_i - x_j"
    result = "contradicts itself" if abs(apart - 7) < 1e-6 else "holds"
    return Outcome(result, "two vehicles, input (5), delta_12 = 7", note)


def _distances_of_ones_own() -> Outcome:
    """Three vehicles around a circle, each wanting the next one ahead by 1."""
    ahead = np.array([[0.0, 1.0, -1.0], [-1.0, 0.0, 1.0], [1.0, -1.0, 0.0]])
    p, q = np.array([0.0, 1.0, 2.0]), np.zeros(3)
    for _ in range(2000):
        u = 0.3 * (p[None, :] - p[:, None] - ahead).sum(axis=1) - 1.5 * q
        p, q = p + q + 0.5 * u, q + u
    kept = np.abs(p[None, :] - p[:, None] - ahead).max() < 1e-6
    note = (
        "only if the distances fit: delta_ij + delta_jk = delta_ik, so each vehicle has a place of its own. "
        "With delta_12 = delta_23 = delta_31 = 1 three vehicles end in one point"
    )
    return Outcome("fails" if kept else "holds corrected", "three vehicles, input (5)", note)


def _once_in_tau_steps() -> Outcome:
    """Enumerate schedules: the value in use grows older by one step, or is fresh; it is never older than tau."""
    longest = {}
    for tau in range(5):
        steps = 2 * tau + 3
        waits = []
        for fresh in product((False, True), repeat=steps):
            age, wait, most = 0, 0, 0
            for new in fresh:
                age, wait = (0, 0) if new else (age + 1, wait + 1)
                most = max(most, wait)
                if age > tau:
                    break
            else:
                waits.append(most + 1)
        longest[tau] = max(waits)
    right = all(wait == tau + 1 for tau, wait in longest.items())
    oldest = max((k - 6) % 12 for k in range(12))
    note = f"(6) allows tau + 1 steps from one value to the next, as in the example: every 12 steps, tau = {oldest}"
    return Outcome("holds corrected" if right else "fails", "all schedules of values, tau = 0 to 4", note)


def _tau_unknown() -> Outcome:
    graph = as_digraph(complete(5))
    starts = [random_start(graph, [v], seed) for v in graph.labels for seed in range(2)]
    agreed = 0
    taus = (1, 2, 4, 8)
    for tau in taus:
        schedule = schedule_named("adversarial", tau)
        scenario = Scenario(Topology((graph,)), 1, "adp-msr", "malicious", ADVERSARIES["greedy"](), schedule, 500)
        agreed += sum(outcome.verdict.value == "agreement" for outcome in simulate(scenario, starts))
    runs = len(starts) * len(taus)
    how = "simulation: K_5, f = 1, greedy, delays to 1, 2, 4, 8, one and the same rule"
    return Outcome("holds" if agreed == runs else "fails", how, f"{agreed} of {counted(runs, 'run')} agree")


def _rows(longest: int) -> list[tuple[int, ...]]:
    return [values for length in range(longest + 1) for values in product((-2, -1, 0, 1, 2), repeat=length)]


def _kept(values: tuple[int, ...], f: int, *, strict: bool) -> np.ndarray:
    heard = np.ones(len(values), dtype=bool)
    return kept_by_msr(np.array(values, dtype=float), heard, np.array(f), strict=strict)


def _ties() -> Outcome:
    """Algorithm 1 drops among values >= 0, other texts among those > 0: is the input the same, then and later?"""
    for values, f in product(_rows(5), (1, 2)):
        weights = np.array([1.0, 2.0, 4.0, 8.0, 16.0][: len(values)]) * np.array(values, dtype=float)
        one, other = (float(weights[_kept(values, f, strict=strict)].sum()) for strict in (False, True))
        if one != other:
            return Outcome("fails", "enumeration", f"f = {f}, relative positions {values}")
    dropped, kept = _after_a_tie(keeps=False), _after_a_tie(keeps=True)
    how = "all lists of up to 5 relative positions from -2 to 2, f = 1, 2; exact arithmetic"
    note = (
        "at the update a value equal to one's own adds nothing to (5), so dropping it changes nothing then. Between "
        "updates "
        "it does: the vehicle moves on and steers back to what it kept. T = alpha = a = 1, q = 5/2, one neighbour at "
        "one's "
        f"own place, one update: two steps later p = {float(dropped)} when it was dropped, {float(kept)} when it was "
        f"kept"
    )
    return Outcome("holds corrected" if dropped != kept else "holds", how, note)


def _after_a_tie(*, keeps: bool) -> Fraction:
    """Return where a vehicle is two steps after an update at which its one neighbour stood where it stood."""
    p, q, T, alpha, weight = Fraction(0), Fraction(5, 2), Fraction(1), Fraction(1), Fraction(1)
    heard = Fraction(0)
    for _ in range(2):
        u = (weight * (heard - p) if keeps else 0) - alpha * q
        p, q = _moved(p, q, u, T)
    return p


def _two_f_neighbours() -> Outcome:
    stays = moves = 0
    for f in (1, 2):
        for values in product((-2, -1, 0, 1, 2), repeat=2 * f):
            kept = np.array(values)[_kept(values, f, strict=False)].any()
            split = sum(each > 0 for each in values) <= f and sum(each < 0 for each in values) <= f
            if kept == split:
                return Outcome("fails", "enumeration", f"f = {f}, relative positions {values}")
            stays, moves = stays + (not kept), moves + bool(kept)
    note = (
        "it may: it ignores all exactly when at most f lie above it and at most f below; when more lie on one side, it "
        "follows them. A trap arranges the former"
    )
    return Outcome("holds corrected" if moves else "holds", "all lists of 2f positions from -2 to 2, f = 1, 2", note)


def _jumping_to_and_fro() -> Outcome:
    """A vehicle that alternates between two points: its speed after m turns, by the dynamics and nothing else."""
    T, gap, falls = Fraction(1), Fraction(100), 0
    for first in map(Fraction, (0, 37, 1000, -1000, 10**6)):
        x, v, speeds = Fraction(0), first, [abs(first)]
        steps = int(abs(first) * T / (2 * gap)) + 40
        for k in range(steps):
            target = gap if k % 2 == 0 else Fraction(0)
            u = 2 * (target - x - T * v) / (T * T)
            x, v = _moved(x, v, u, T)
            speeds.append(abs(v))
        if any(speed < 2 * k * gap / T - abs(first) for k, speed in enumerate(speeds)):
            return Outcome("fails", "exact arithmetic", f"v = {first}")
        if first == 1000:
            falls = sum(after < before for before, after in pairwise(speeds))
    note = (
        "as values sent it is no effort; as a motion by (2) the speed after m steps is at least 2m(b-a)/T less its "
        "first "
        f"value, so it grows without bound (at first it may fall: b - a = 100, T = 1, v = 1000 falls for "
        f"{counted(falls, 'step')}). "
        "Against active sensing it takes unbounded inputs, which the paper allows"
    )
    return Outcome("holds corrected", "exact arithmetic, five first speeds", note)


def _input_in_x() -> Outcome:
    """Two vehicles with the unnumbered input, x and v in place of p and q, and a target speed of 20."""
    T, alpha, speed = 0.5, 3.0, 20.0
    x, v = np.array([0.0, 10.0]), np.array([speed, speed])
    for _ in range(4000):
        u = 0.5 * (x[::-1] - x) - alpha * v
        x, v = x + T * v + T * T / 2 * u, v + T * u
    rests = abs(x[0] - x[1]) < 1e-6 and float(np.abs(v).max()) < 1e-6
    note = (
        "it brings positions together, but its last term brakes to speed 0, not r: two vehicles at r = 20 end at "
        "rest. It is "
        "equivalent to (5) only with v - r in place of v, and with delays only if the age times T r is added (see "
        "above)"
    )
    return Outcome("holds corrected" if rests else "holds", "two vehicles, the input in x, no delays", note)


def _keeps_close() -> Outcome:
    """Setting 2, vehicle 4 read in either coordinate: how near is it to vehicles 2 and 3, and how long?"""
    cases = EXPERIMENTS["setting-2"].cases()
    # The third reads the claims otherwise, not the motion.
    chosen = [case for case in cases if case.name == "figure read as wheel"][:2]
    notes, most = [], 0.0
    for case, coordinate in zip(chosen, ("p", "x"), strict=True):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PromiseWarning)
            trajectory = simulate(case.scenario, [case.start], record=True)[0].trajectory
        assert trajectory is not None  # noqa: S101 - it was asked for
        away = np.abs(trajectory.p[:, [1, 2]] - trajectory.p[:, [3]]).max(axis=1)
        share = float((away <= 100).mean())
        most = max(most, share)
        notes.append(
            f"read in {coordinate}: within 100 of both at {share:.1%} of the steps, at the end {away[-1]:,.0f} away"
        )
    how = f"simulation: experiment setting-2, {chosen[0].scenario.steps:,} steps"
    return Outcome("fails" if most < 0.5 else "holds", how, "; ".join(notes))


CLAIMS: tuple[Claim, ...] = (
    Claim("Section 2.2", "the discrete form of the dynamics with sampling period T", _discrete_form),
    Claim("Section 2.3", "x_i - x_j tends to delta_ij; Definition 5: x_j - x_i tends to delta_ij", _signs),
    Claim("Section 2.3", "each vehicle can set the distances delta_ij itself", _distances_of_ones_own),
    Claim("Section 3.1", "in p and q the dynamics have the same form, and agreement is the same", _change_of_variables),
    Claim("Section 3.1", "the unnumbered input in x and v is equivalent to (5)", _input_in_x),
    Claim("Section 3.1", "vehicles form p_j[k - tau_ij] - p_i[k] from the positions they receive", _age_of_values),
    Claim("Section 3.1", "every neighbour's position is received at least once in tau steps", _once_in_tau_steps),
    Claim("Section 3.1", "vehicles need not know tau", _tau_unknown),
    Claim("Algorithm 1", "values equal to one's own count as extreme on both sides (others: on none)", _ties),
    Claim("before Proposition 1", "a vehicle with 2f neighbours keeps its state", _two_f_neighbours),
    Claim("Proposition 1, proof", "malicious vehicles alternate between two positions", _jumping_to_and_fro),
    Claim("Section 4, Setting 2", "vehicle 4 keeps close to vehicles 2 and 3 most of the time", _keeps_close),
)
