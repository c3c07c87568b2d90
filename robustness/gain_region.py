"""The gains of second-order vehicles for which the theory of MSR rules holds: one exact region.

With T the sampling period, sigma a bound on the sum of the weights a vehicle keeps and alpha its gain, write
``s = sigma T²`` and ``a = alpha T``. The *gain region* is

    s < 1   and   2 sqrt(s) - s/2 <= a <= 2 - s/2.

Inside it there is a ``c > 0`` for which the next ``p`` and the next ``z = p + c q`` of a vehicle are convex
combinations of its present p, its present z and the positions it keeps; agreement then follows on every network without
a trap, for all delays and update gaps. Outside it, and on the line s = 1, delays alone drive (2f+1)-robust networks
apart, with nobody lying. In words: a vehicle tied to a standing target by the greatest weight it may use does not
overshoot, not even between samples. The interval ``1 + s/2 <= a <= 2 - s/2`` of the literature (Dibaji and Ishii 2017)
lies inside, except for its corner s = 1.
"""

from __future__ import annotations

import math

from robustness.errors import InvalidParameter

__all__ = ["STRICTLY_BELOW_ONE", "gain_gap", "gain_region", "hull_velocity_factor", "in_gain_region"]

#: The region is open at s = 1, where vehicles can swap places for ever. Sums of weights such as ten times 0.1 are
#: rounded to just below 1, so that s counts as below 1 only by more than this.
STRICTLY_BELOW_ONE = 1e-9

#: At the two closed ends rounding may not exclude: a relative error of this much is let pass.
_ROUNDING = 1e-12


def gain_region(T: float, sigma: float = 1.0) -> tuple[float, float] | None:
    """Return the least and the greatest ``alpha T`` of the gain region; None when it is empty.

    Parameters
    ----------
    T : float
        The sampling period, positive.
    sigma : float
        A bound on the sum of the weights that a vehicle keeps, at least 0.

    Returns
    -------
    tuple of float, or None
        ``(2 sqrt(s) - s/2, 2 - s/2)`` for ``s = sigma T² < 1``, and None for ``s >= 1``. With sigma = 0 (a vehicle
        that keeps nothing) the upper end 2 is not inside: there the velocity changes its sign for ever.

    Raises
    ------
    InvalidParameter
        When T or sigma is no number of its range.

    >>> gain_region(0.5)
    (0.875, 1.875)
    >>> gain_region(1.0) is None
    True
    """
    if not (math.isfinite(T) and T > 0):
        raise InvalidParameter(f"the sampling period T is a positive number, not {T!r}")
    if not (math.isfinite(sigma) and sigma >= 0):
        raise InvalidParameter(f"the bound sigma on the kept weights is a number of at least 0, not {sigma!r}")
    s = sigma * T * T
    if s >= 1 - STRICTLY_BELOW_ONE:
        return None
    return 2 * math.sqrt(s) - s / 2, 2 - s / 2


def in_gain_region(T: float, alpha: float, sigma: float = 1.0) -> bool:
    """Return whether the gain ``alpha`` lies in the region; parameters and errors as for :func:`gain_gap`.

    >>> in_gain_region(0.01, 2.0), in_gain_region(0.01, 1.99), in_gain_region(1.0, 1.5)
    (True, False, False)
    """
    return gain_gap(T, alpha, sigma) is None


def gain_gap(T: float, alpha: float, sigma: float = 1.0) -> str | None:
    """Return why the gain lies outside the region and what would bring it inside, in one line; None when it is inside.

    Parameters
    ----------
    T, sigma
        As for :func:`gain_region`.
    alpha : float
        The gain, positive.

    >>> gain_gap(1.0, 1.5)
    'sigma T² = 1 is not below 1: take T < 1, or kept weights that add up to less than 1'
    >>> gain_gap(0.01, 0.3)
    'alpha T = 0.003 is not in 0.01995 .. 1.99995: take alpha in 1.995 .. 199.995'
    """
    region = gain_region(T, sigma)
    if not (math.isfinite(alpha) and alpha > 0):
        raise InvalidParameter(f"a gain alpha is a positive number, not {alpha!r}")
    if region is None:
        return (
            f"sigma T² = {sigma * T * T:.6g} is not below 1: take T < {1 / math.sqrt(sigma):.6g}, or kept weights that "
            f"add up to less than {1 / T / T:.6g}"
        )
    low, high = region
    product = alpha * T
    if low * (1 - _ROUNDING) <= product <= high * (1 + _ROUNDING) and product < 2:
        return None
    return f"alpha T = {product:.6g} is not in {low:.6g} .. {high:.6g}: take alpha in {low / T:.6g} .. {high / T:.6g}"


def hull_velocity_factor(T: float, alpha: float, sigma: float = 1.0) -> float:
    """Return the ``c`` for which the hull of all ``p`` and ``p + c q`` of normal vehicles never grows.

    Parameters
    ----------
    T, alpha, sigma
        A point of the gain region, with sigma > 0.

    Returns
    -------
    float
        ``1 / sqrt(sigma) - T/2`` when ``alpha T <= 1 + sqrt(s)/2``, else ``T (1 - alpha T/2) / (alpha T - 1)``. For
        sigma = 0 the least one: ``1/alpha - T/2`` when ``alpha T <= 1``, else ``T (1 - alpha T/2)``.

    Raises
    ------
    InvalidParameter
        Outside the gain region, where no such c exists.

    >>> hull_velocity_factor(0.5, 3.0)
    0.25
    """
    gap = gain_gap(T, alpha, sigma)
    if gap is not None:
        raise InvalidParameter(f"only in the gain region does a hull stay: {gap}")
    a, s = alpha * T, sigma * T * T
    if s == 0:
        return 1 / alpha - T / 2 if a <= 1 else T * (1 - a / 2)
    if a <= 1 + math.sqrt(s) / 2:
        return 1 / math.sqrt(sigma) - T / 2
    return T * (1 - a / 2) / (a - 1)
