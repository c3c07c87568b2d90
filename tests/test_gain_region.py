"""The gain region: its ends, its line s = 1, and that it is exactly where the convex combinations exist."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness.errors import InvalidParameter
from robustness.gain_region import gain_gap, gain_region, hull_velocity_factor, in_gain_region


def coefficients(T: float, alpha: float, c: float, kept: float) -> list[float]:
    """Return the weights of p, of z and of the kept positions in the next p and in the next z, worked out by hand.

    With the kept weights adding up to ``kept``: ``p' = p + T q + T²/2 u``, ``q' = q + T u``, ``z = p + c q``,
    ``u = sum of a_j P_j - kept p - alpha q`` and ``q = (z - p) / c``.
    """
    half = T * T / 2
    p_of_q, q_of_q = T - half * alpha, 1 - T * alpha
    p_of_p, q_of_p = 1 - half * kept, -T * kept
    z_of_q, z_of_p = p_of_q + c * q_of_q, p_of_p + c * q_of_p
    return [p_of_p - p_of_q / c, p_of_q / c, half, z_of_p - z_of_q / c, z_of_q / c, half + c * T]


@pytest.mark.parametrize(
    ("T", "sigma", "region"),
    [(0.5, 1.0, (0.875, 1.875)), (0.5, 0.0, (0.0, 2.0)), (1.0, 0.25, (0.875, 1.875)), (2.0, 0.0625, (0.875, 1.875))],
)
def test_the_ends(T: float, sigma: float, region: tuple[float, float]) -> None:
    assert gain_region(T, sigma) == region


@pytest.mark.parametrize("sigma", [1.0, sum([0.1] * 10), sum([1 / 3] * 3), sum([1 / 49] * 49), 1.5, 100.0])
def test_the_line_where_vehicles_swap_is_outside_however_the_weights_are_rounded(sigma: float) -> None:
    assert gain_region(1.0, sigma) is None
    assert "not below 1" in str(gain_gap(1.0, 1.5, sigma))


def test_the_example_of_the_source_paper() -> None:
    """T = 0.01: alpha = 2, 3, 10 are inside for kept weights up to 1; on K_5 with unit weights only 10 is."""
    assert [in_gain_region(0.01, alpha) for alpha in (1.99, 1.995, 2, 3, 10)] == [False, True, True, True, True]
    assert [in_gain_region(0.01, alpha, 3.0) for alpha in (2, 3, 10)] == [False, False, True]
    assert [in_gain_region(0.01, alpha, 2.0) for alpha in (2, 3, 10)] == [False, True, True]
    assert not in_gain_region(0.01, 0.3, 3.0)


def test_a_vehicle_that_hears_nothing_has_to_stop() -> None:
    assert in_gain_region(1.0, 1.999, 0.0)
    assert not in_gain_region(1.0, 2.0, 0.0)


@pytest.mark.parametrize(
    "wrong",
    [
        *((T, 1.0, 1.0) for T in (0.0, -1.0, math.nan, math.inf)),
        *((1.0, alpha, 0.1) for alpha in (0.0, -1.0, math.nan, math.inf)),
        *((1.0, 1.0, sigma) for sigma in (-1.0, math.nan, math.inf)),
    ],
)
def test_numbers_out_of_range_are_refused(wrong: tuple[float, float, float]) -> None:
    with pytest.raises(InvalidParameter, match="number"):
        gain_gap(*wrong)
    with pytest.raises(InvalidParameter):
        hull_velocity_factor(*wrong)


@given(T=st.floats(0.01, 10), root=st.floats(0, 0.999), place=st.floats(0, 1), share=st.floats(0, 1))
def test_inside_every_new_value_is_a_convex_combination(T: float, root: float, place: float, share: float) -> None:
    sigma = (root / T) ** 2
    region = gain_region(T, sigma)
    assert region is not None
    a = region[0] + place * (min(region[1], 1.99) - region[0])
    if a < 0.01:
        return
    alpha = a / T
    c = hull_velocity_factor(T, alpha, sigma)
    assert c > 0
    assert min(coefficients(T, alpha, c, share * sigma)) >= -1e-7


@given(root=st.floats(0.05, 0.99), a=st.floats(0.01, 2.5), c=st.floats(0.01, 100))
def test_outside_no_c_gives_one(root: float, a: float, c: float) -> None:
    region = gain_region(1.0, root * root)
    assert region is not None
    if region[0] - 1e-3 <= a <= region[1] + 1e-3:
        return
    worst = min(min(coefficients(1.0, a, c, kept)) for kept in (0.0, root * root))
    assert worst < 0
    with pytest.raises(InvalidParameter, match="only in the gain region"):
        hull_velocity_factor(1.0, a, root * root)


@given(T=st.floats(0.01, 3), sigma=st.floats(0.01, 20))
def test_what_the_gap_advises_is_inside(T: float, sigma: float) -> None:
    """The advice is printed to six digits, so it is tried a little inside."""
    region = gain_region(T, sigma)
    if region is not None:
        middle = (region[0] + region[1]) / 2
        assert in_gain_region(T, middle / T, sigma)
        return
    assert gain_region(0.999 / math.sqrt(sigma), sigma) is not None
    assert gain_region(T, 0.999 / T / T) is not None
