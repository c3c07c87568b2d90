"""The constants of docs/theorems.md as linear programmes: the worst case over all that a vehicle may hear, exactly.

For one vehicle in the hull [0, 1] the weights kept at each step are fixed, and all else is a variable: where it
begins (y and z of Lemma 1) and one mean heard value a step. What a lemma bounds from below is minimised by a solver.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import linprog

from robustness.gain_region import gain_region, hull_velocity_factor

Row = npt.NDArray[np.float64]

#: s, and where a lies between the ends of its region: both ends, inside, and s next to 0 and 1.
POINTS = [(s, at) for s in (0.01, 0.25, 0.6, 0.95) for at in (0.0, 0.5, 1.0)]


def motion(s: float, at: float, kept: Sequence[float]) -> tuple[list[Row], list[Row]]:
    """Return p and z at every step as rows over the variables p[0], z[0], heard[0], heard[1], ..."""
    low, high = gain_region(1.0, s) or (0.0, 0.0)
    a = low + at * (high - low)
    gamma = hull_velocity_factor(1.0, a, s)
    unit = np.eye(2 + len(kept))
    p, z = [unit[0]], [unit[1]]
    for step, weight in enumerate(kept):
        q = (z[-1] - p[-1]) / gamma
        u = weight * (unit[2 + step] - p[-1]) - a * q
        p.append(p[-1] + q + u / 2)
        z.append(p[-1] + gamma * (q + u))
    return p, z


def least(rows: Sequence[tuple[Row, float]], bounds: Sequence[tuple[float, float]]) -> float:
    """Return the least epsilon for which all ``row x + constant <= epsilon`` have a solution within the bounds."""
    A = [[*row, -1.0] for row, _ in rows]
    b = [-constant for _, constant in rows]
    cost = [0.0] * len(bounds) + [1.0]
    found = linprog(cost, A_ub=A, b_ub=b, bounds=[*bounds, (None, None)], method="highs")
    assert found.status == 0, found.message
    return float(found.fun)


@pytest.mark.parametrize(("s", "at"), POINTS)
def test_lemma_1_the_hull_is_kept_and_left_by_no_more(s: float, at: float) -> None:
    """From the hull [0, 1] no step leaves it, at either end; one step keeps at least eta of a distance (Lemma 5)."""
    for kept in itertools.product((0.0, s / 3, s), repeat=2):
        p, z = motion(s, at, kept)
        for row in (*p, *z):
            assert least([(row, 0.0)], [(0, 1)] * len(row)) >= -1e-9
            assert least([(-row, 1.0)], [(0, 1)] * len(row)) >= -1e-9
        away = [(0.3, 1), (0.3, 1), (0, 1), (0, 1)]
        for m in (1, 2):
            assert min(least([(p[m], 0.0)], away), least([(z[m], 0.0)], away)) >= 0.3 * (1 - math.sqrt(s)) ** m - 1e-9


@pytest.mark.parametrize(("s", "at"), POINTS)
def test_lemma_6_nobody_is_near_both_ends(s: float, at: float) -> None:
    assert_disjoint(s, at, 1)


@pytest.mark.slow
@pytest.mark.parametrize(("s", "at"), POINTS)
def test_lemma_6_with_a_longer_memory(s: float, at: float) -> None:
    assert_disjoint(s, at, 3)


def assert_disjoint(s: float, at: float, tau: int) -> None:
    """All high and low events within tau + 1 steps, for all kept sums of 0, beta and s: never both below theta."""
    beta = s / 2
    root, kappa = math.sqrt(s), beta / 2
    theta = kappa * (root * (1 - root) / 2) ** (tau + 1) / 2
    for kept in itertools.product((0.0, beta, s), repeat=tau + 1):
        p, z = motion(s, at, kept)
        events = [*p[1:], z[-1]]
        for high, low in itertools.product(events, events):
            assert least([(high, 0.0), (-low, 1.0)], [(0, 1)] * len(high)) >= theta


@pytest.mark.parametrize(("s", "at"), POINTS)
def test_lemma_7_who_keeps_a_value_from_outside_leaves(s: float, at: float) -> None:
    """A kept value of at least epsilon moves p and z away by kappa epsilon; so does an own one when nothing is kept."""
    beta, epsilon = s / 2, 0.2
    kappa = beta / 2
    for weight in (beta, 0.7 * s, s):
        p, z = motion(s, at, [weight])
        # Of the kept weight at least beta is on a value of at least epsilon: the mean is at least this.
        bounds = [(0, 1), (0, 1), (epsilon * beta / weight, 1)]
        assert min(least([(p[1], 0.0)], bounds), least([(z[1], 0.0)], bounds)) >= kappa * epsilon - 1e-12
    p, z = motion(s, at, [0.0])
    bounds = [(epsilon, 1), (0, 1), (0, 1)]
    assert min(least([(p[1], 0.0)], bounds), least([(z[1], 0.0)], bounds)) >= kappa * epsilon - 1e-12


def test_outside_the_region_the_hull_is_left() -> None:
    """Just outside either end no factor c keeps the hull: some programme reaches below 0."""
    s = 0.25
    low, high = gain_region(1.0, s) or (0.0, 0.0)
    for a in (low - 0.02, high + 0.02):
        for gamma in np.geomspace(0.01, 100, 60):
            worst = 0.0
            for weight in (0.0, s):
                u = np.array([-weight + a / gamma, -a / gamma, weight])
                q = np.array([-1 / gamma, 1 / gamma, 0.0])
                p = np.array([1.0, 0.0, 0.0]) + q + u / 2
                worst = min(worst, *(least([(row, 0.0)], [(0, 1)] * 3) for row in (p, p + gamma * (q + u))))
            assert worst < -1e-4
