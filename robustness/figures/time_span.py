"""Where a picture of a run ends: once nothing moves any more, further steps only squeeze what did."""

from __future__ import annotations

import math

import numpy as np

from robustness.simulation.outcome import Outcome

__all__ = ["last_step_shown"]

#: A vehicle is at rest once it stays within this part of the whole range of all of them.
_AT_REST = 0.01
#: So many steps are shown at least, and so many times the steps of the motion.
_FEWEST, _LONGER = 20, 1.5


def last_step_shown(outcome: Outcome, asked: int | None = None) -> int:
    """Return the last step of a recorded run that a picture or a film of it shows.

    Parameters
    ----------
    outcome : Outcome
        With a trajectory.
    asked : int, optional
        The step that the user wants to see last. Without it half as many steps again are shown as it takes until every
        normal vehicle's position relative to the target, and its velocity, stays within one per cent of the range of
        all of them; 20 steps at least.

    Returns
    -------
    int
        No later than the run's end and its divergence.
    """
    states, start = outcome.trajectory, outcome.start
    if states is None:
        raise ValueError("the run was not recorded")
    end = len(states.p) - 1
    if outcome.diverged_at is not None:
        end = min(end, outcome.diverged_at)
    if asked is not None:
        return min(end, asked)
    normal = np.ones(states.p.shape[1], dtype=bool)
    if outcome.scenario is not None and start is not None:
        labels = outcome.scenario.network.union.labels
        normal = np.array([label not in start.malicious for label in labels], dtype=bool)
    moving = 0
    for values in (states.p[: end + 1, normal], states.q[: end + 1, normal]):
        if values.size:
            far = (np.abs(values - values[-1]) > _AT_REST * np.ptp(values)).any(axis=1)
            moving = max(moving, *(np.flatnonzero(far) + 1)[-1:], 0)
    return min(end, max(_FEWEST, math.ceil(_LONGER * moving)))
