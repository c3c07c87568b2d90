"""Mean-subsequence-reduced filtering: which of the heard values a vehicle drops.

One order for ties: the heard values are sorted from the largest to the smallest relative position, equal ones by
node id; the *front* of that order is dropped above, its *back* below. So of equal values the smaller ids go first
above and the larger ids first below. A value equal to the own one can be dropped on either side, or by both.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robustness.simulation.dynamics import Floats

__all__ = ["kept_by_msr"]

Mask = npt.NDArray[np.bool_]


def kept_by_msr(relative: Floats, heard: Mask, drop: npt.NDArray[np.int64], *, strict: bool) -> Mask:
    """Return which values survive the filter.

    Above, the ``drop`` largest relative values are dropped, or all that are ``>= 0`` if those are fewer; below
    likewise with the smallest and ``<= 0`` (Algorithm 1 of the source paper). With ``strict`` the comparisons are
    ``> 0`` and ``< 0`` (W-MSR of LeBlanc et al. 2013).

    Parameters
    ----------
    relative : array, shape ``(..., d)``
        ``p_j - p_i - delta_ij`` for the in-neighbours j of one node i, ascending by id.
    heard : boolean array, shape ``(..., d)``
        Where False nothing was received, and nothing is kept.
    drop : integer array, shape ``(...)``
        How many to drop on each side: f, or ``f - m_i`` when m_i neighbours withheld their value.
    strict : bool
        See above.

    Returns
    -------
    boolean array, shape ``(..., d)``

    Notes
    -----
    ``O(d log d)`` per row. The compiled kernel does the same in ``O(d f)``; tests compare the two and a
    plain-Python reading of the algorithm.

    >>> kept_by_msr(np.array([3.0, -1.0, 0.0, 5.0]), np.ones(4, bool), np.array(1), strict=False).tolist()
    [True, False, True, False]
    """
    count = relative.shape[-1]
    amount = np.asarray(drop)[..., None]
    rising = np.argsort(np.where(heard, -relative, np.inf), axis=-1, kind="stable")
    rank = np.empty(relative.shape, dtype=np.int64)
    np.put_along_axis(rank, rising, np.broadcast_to(np.arange(count), relative.shape), axis=-1)
    last = heard.sum(axis=-1, keepdims=True) - 1
    above = relative > 0 if strict else relative >= 0
    below = relative < 0 if strict else relative <= 0
    dropped = (above & (rank < amount)) | (below & (last - rank < amount))
    return np.asarray(heard & ~dropped)
