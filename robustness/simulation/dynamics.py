"""How vehicles move: double integrators, sampled, and the change of variables that makes the target stand still.

Everything is simulated in the *transformed* coordinates ``p, q`` of the source paper (equation 3): with the target
speed r and the sampling period T,

    x[k] = p[k] + k T r,        v[k] = q[k] + r,

a formation that moves at speed r is at rest in ``p, q``, and the equations keep their form (equation 4).
All functions are pure; arrays broadcast, usually with shape ``(B, n)``: B runs of n vehicles.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["Floats", "double_integrator", "to_absolute", "to_transformed"]

#: An array of double-precision numbers.
Floats = npt.NDArray[np.float64]


def double_integrator(position: Floats, velocity: Floats, control: Floats, T: float) -> tuple[Floats, Floats]:
    """Return positions and velocities one sampling period later (equation 2 of the source paper).

    ``x[k+1] = x[k] + T v[k] + T²/2 u[k]`` and ``v[k+1] = v[k] + T u[k]``: exact for a control held constant.

    Parameters
    ----------
    position, velocity, control : arrays of one shape
        In any consistent units; ``control`` is the acceleration.
    T : float
        The sampling period.

    Notes
    -----
    At rest (``velocity == 0`` and ``control == 0``) the position is returned unchanged bit for bit, whatever T.

    >>> x, v = double_integrator(np.array([1.0]), np.array([2.0]), np.array([4.0]), 0.5)
    >>> float(x[0]), float(v[0])
    (2.5, 4.0)
    """
    return (position + T * velocity) + (T * T / 2) * control, velocity + T * control


def to_absolute(
    p: Floats, q: Floats, step: int | npt.NDArray[np.int64], T: float, speed: float
) -> tuple[Floats, Floats]:
    """Return ``x = p + k T r`` and ``v = q + r``; ``step`` is k, or an array of k that broadcasts against p."""
    return p + np.asarray(step) * (T * speed), q + speed


def to_transformed(
    x: Floats, v: Floats, step: int | npt.NDArray[np.int64], T: float, speed: float
) -> tuple[Floats, Floats]:
    """Return ``p = x - k T r`` and ``q = v - r``, the inverse of :func:`to_absolute`."""
    return x - np.asarray(step) * (T * speed), v - speed
