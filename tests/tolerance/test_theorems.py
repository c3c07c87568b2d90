"""The lemmas of docs/theorems.md with random and extreme numbers: constants, signs, and the filter by brute force."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness.gain_region import gain_region, hull_velocity_factor, in_gain_region


def region_points(count: int) -> Iterator[tuple[float, float]]:
    """Yield (a, s) of the gain region: both ends, both cases, s next to 0 and to 1, and random ones."""
    rng = random.Random(1)
    for k in range(count):
        s = rng.choice([1e-9, 1e-4, rng.random(), 1 - 1e-6]) if k % 3 else rng.random() * 0.999 + 1e-6
        low, high = 2 * math.sqrt(s) - s / 2, 2 - s / 2
        a = rng.choice([low, high, 1 + math.sqrt(s) / 2, rng.uniform(low, high)])
        yield min(max(a, low), high), s


def coefficients(a: float, s: float, kept: float) -> dict[str, float]:
    """Return the coefficients of Lemma 1, computed from the motion itself by linearity (T = 1)."""
    gamma = hull_velocity_factor(1.0, a, s)
    rows = {}
    for name, p, z, heard in (("p", 1.0, 0.0, 0.0), ("z", 0.0, 1.0, 0.0), ("P", 0.0, 0.0, 1.0)):
        q = (z - p) / gamma
        u = kept * heard - kept * p - a * q
        rows[name] = (p + q + u / 2, p + q + u / 2 + gamma * (q + u))
    return {f"{row}{name}": value for name, pair in rows.items() for row, value in zip("pz", pair, strict=True)}


class TestLemma1:
    def test_coefficients_are_a_mean_and_large_enough(self) -> None:
        tiny = 1e-7
        for a, s in region_points(4000):
            eta = 1 - math.sqrt(s)
            types = []
            for kept in (0.0, s / 3, s):
                w = coefficients(a, s, kept)
                assert all(value >= -tiny for value in w.values()), (a, s, kept, w)
                assert math.isclose(w["pp"] + w["pz"] + w["pP"], 1, abs_tol=tiny)
                assert math.isclose(w["zp"] + w["zz"] + w["zP"], 1, abs_tol=tiny)
                assert w["pp"] + w["pz"] >= eta - tiny
                assert w["zp"] + w["zz"] >= eta - tiny
                assert w["pz"] >= math.sqrt(s) / 2 - tiny
                types.append((w["zz"] >= eta / 2 - tiny, w["zp"] >= eta / 2 - tiny))
                if kept == 0:
                    assert w["pp"] >= s / 2 - tiny
                    assert w["zp"] >= math.sqrt(s) - tiny
            assert all(first for first, _ in types) or all(second for _, second in types), (a, s)

    def test_outside_the_region_no_hull_does_it(self) -> None:
        rng = random.Random(2)
        seen = 0
        while seen < 400:
            a, s = rng.uniform(0.01, 2.5), rng.uniform(0.01, 1.3)
            if in_gain_region(1.0, a, s) or min(abs(a - (2 * math.sqrt(s) - s / 2)), abs(a - (2 - s / 2))) < 1e-3:
                continue
            seen += 1
            for gamma in np.geomspace(1e-3, 1e3, 300):
                pz = (1 - a / 2) / gamma
                zz = pz + 1 - a
                assert min(pz, 1 - pz - s / 2, zz, 1 - zz - (0.5 + gamma) * s) < 0, (a, s, gamma)


def drop(own: float, heard: list[float], most: int) -> list[float]:
    """Return what H4 keeps, ties broken by place."""
    order = sorted(range(len(heard)), key=lambda k: (heard[k], k))
    low = [k for k in order if heard[k] <= own][:most]
    high = [k for k in reversed(order) if heard[k] >= own][:most]
    return [heard[k] for k in order if k not in low and k not in high]


class TestFilter:
    @given(
        st.integers(0, 3),
        st.integers(-3, 3),
        st.lists(st.integers(-4, 4), max_size=7),
        st.lists(st.integers(-9, 9), max_size=3),
    )
    def test_kept_values_lie_in_the_hull_of_normal_ones(
        self, f: int, own: int, normal: list[int], lies: list[int]
    ) -> None:
        lies = lies[:f]
        hull = [own, *normal]
        for value in drop(own, [*normal, *lies], f):
            assert min(hull) <= value <= max(hull)

    def test_enough_values_on_one_side_leave_one_there(self) -> None:
        for f, count in itertools.product((0, 1, 2), range(6)):
            for heard in itertools.combinations_with_replacement(range(5), count):
                for own, C in itertools.product(range(5), range(5)):
                    if sum(value <= C for value in heard) >= f + 1:
                        kept = drop(own, list(heard), f)
                        assert any(value <= C for value in kept) or (not kept and own <= C)


class TestMotion:
    @pytest.mark.parametrize("case", ["B", "A", "low end", "high end"])
    def test_nobody_is_near_both_ends_of_the_hull(self, case: str) -> None:
        """Lemma 6: a vehicle with a low and a high event inside tau + 1 steps would need a hull smaller than it is."""
        rng = random.Random(case)
        tau, worst = 2, math.inf
        for _ in range(3000):
            s = rng.uniform(0.05, 0.95)
            low, high = gain_region(1.0, s) or (0.0, 0.0)
            middle = 1 + math.sqrt(s) / 2
            a = {"B": rng.uniform(low, middle), "A": rng.uniform(middle, high), "low end": low, "high end": high}[case]
            gamma, beta = hull_velocity_factor(1.0, a, s), s / 2
            eta = 1 - math.sqrt(s)
            mu, kappa = math.sqrt(s) * eta / 2, beta / 2
            theta = kappa * mu ** (tau + 1) / 2
            # A vehicle in the hull [0, 1]; what it keeps jumps between the ends, or nothing is kept.
            p, z = rng.choice([0.0, 1.0, rng.random()]), rng.choice([0.0, 1.0, rng.random()])
            near_low = near_high = math.inf
            for step in range(tau + 2):
                kept = rng.choice([0.0, beta, s])
                heard = rng.choice([0.0, 1.0])
                w = coefficients(a, s, kept)
                p, z = w["pp"] * p + w["pz"] * z + w["pP"] * heard, w["zp"] * p + w["zz"] * z + w["zP"] * heard
                if step >= 1:
                    near_low, near_high = min(near_low, p), min(near_high, 1 - p)
            near_low, near_high = min(near_low, z), min(near_high, 1 - z)
            assert gamma > 0
            worst = min(worst, max(near_low, near_high) / theta)
        assert worst >= 1

    def test_the_hull_of_p_and_z_never_grows(self) -> None:
        rng = random.Random(5)
        for a, s in region_points(300):
            places = [(rng.random(), rng.random()) for _ in range(4)]
            for _ in range(20):
                low = min(min(place) for place in places)
                high = max(max(place) for place in places)
                moved = []
                for p, z in places:
                    kept, heard = rng.choice([0.0, s / 2, s]), rng.uniform(low, high)
                    w = coefficients(a, s, kept)
                    moved.append(
                        (w["pp"] * p + w["pz"] * z + w["pP"] * heard, w["zp"] * p + w["zz"] * z + w["zP"] * heard)
                    )
                places = moved
                assert low - 1e-6 <= min(min(place) for place in places)
                assert max(max(place) for place in places) <= high + 1e-6


def test_the_two_sides_of_theorem_d_diverge_just_outside() -> None:
    """Case 2: the switching of docs/theorems.md by the sign of the impulse response, and its predicted growth."""
    for a, s in ((0.5, 0.12), (1.97, 0.12)):
        assert not in_gain_region(1.0, a, s)
        F, G = np.array([[1 - s / 2, 1 - a / 2], [-s, 1 - a]]), np.array([s / 2, s])
        H = 200
        response = [float((np.linalg.matrix_power(F, m - 1) @ G)[0]) for m in range(1, H + 1)]
        assert min(response) < 0
        assert math.isclose(sum(response), 1, abs_tol=1e-4)
        gain = sum(max(h, 0) for h in response)
        loss = sum(max(-h, 0) for h in response)
        # psi(rho) = (gain + loss / rho) / rho = 1 has a root above 1.
        rho = (gain + math.sqrt(gain**2 + 4 * loss)) / 2
        assert rho > 1
    for a, s in ((2 * math.sqrt(0.12) - 0.06, 0.12), (1.94, 0.12)):
        F, G = np.array([[1 - s / 2, 1 - a / 2], [-s, 1 - a]]), np.array([s / 2, s])
        assert min(float((np.linalg.matrix_power(F, m - 1) @ G)[0]) for m in range(1, 300)) >= -1e-12
