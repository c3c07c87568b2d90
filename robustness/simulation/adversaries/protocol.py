"""What an adversary sees and what it may do: one small protocol.

Adversaries are omniscient (Definition 2 of the source paper): they see every state, the network, the update times
and the delays. They are frozen dataclasses without hidden state, so that a run can be replayed from its record:
everything they do is a function of the view.

All positions that they see and set are *aligned*: relative to each vehicle's place in the formation, so that
agreement means equal numbers; see :mod:`robustness.simulation.formation`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.simulation.draws import Draws
from robustness.simulation.dynamics import Floats
from robustness.simulation.fault_models import FaultModel

__all__ = ["Adversary", "Mask", "Move", "Setting", "View"]

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Setting:
    """What does not change during a batch of B runs on n nodes and A arcs.

    Attributes
    ----------
    graph : Digraph
        All links that ever exist. Arcs are numbered receiver-major, as in ``graph.in_indices``.
    malicious : boolean array, shape ``(B, n)``
    f : int
    model : FaultModel
    T : float
        The sampling period.
    initial : array, shape ``(B, n)``
        The positions at step 0 and before.
    draws : Draws
        The random numbers of the runs.
    longest_delay : int
        The greatest delay the schedule permits.
    chooses_delays : bool
        Whether the schedule leaves the delays to the adversary.
    trial : callable
        ``trial(p, q, sent) -> positions (B, n)`` one step later, if everybody updated now and heard ``sent (B, n)``.
    """

    graph: Digraph
    malicious: Mask
    f: int
    model: FaultModel
    T: float
    initial: Floats
    draws: Draws
    longest_delay: int
    chooses_delays: bool
    trial: Callable[[Floats, Floats, Floats], Floats]

    @cached_property
    def heads(self) -> npt.NDArray[np.int64]:
        """The receiver of every arc, shape ``(A,)``."""
        return self.graph.heads

    @cached_property
    def tails(self) -> npt.NDArray[np.int64]:
        """The sender of every arc, shape ``(A,)``."""
        return self.graph.in_indices.astype(np.int64)

    @cached_property
    def from_malicious(self) -> Mask:
        """Which arcs start at a malicious node, shape ``(B, A)``."""
        return self.malicious[:, self.tails]

    @cached_property
    def initial_range(self) -> tuple[Floats, Floats]:
        """The least and greatest position of the normal vehicles at the start, shape ``(B, 1)`` each."""
        return self.normal_range(self.initial)

    def normal_range(self, p: Floats) -> tuple[Floats, Floats]:
        """Return the least and greatest position of the normal vehicles, shape ``(B, 1)`` each; 0 without any."""
        low = np.where(self.malicious, np.inf, p).min(axis=1, keepdims=True, initial=np.inf)
        high = np.where(self.malicious, -np.inf, p).max(axis=1, keepdims=True, initial=-np.inf)
        nobody = self.malicious.all(axis=1, keepdims=True)
        return np.where(nobody, 0.0, low), np.where(nobody, 0.0, high)

    def by_malicious(self, values: Floats) -> Floats:
        """Return the values (any shape that broadcasts to ``(B, n)``) in malicious columns and NaN elsewhere."""
        return np.where(self.malicious, values, np.nan)


@dataclass(frozen=True, eq=False, slots=True)
class View:
    """What an adversary sees at one step.

    Attributes
    ----------
    setting : Setting
    step : int
        The step k; the ``tau`` steps before 0 are played too, with everybody at the initial position.
    p, q : arrays, shape ``(B, n)``
        Aligned positions and velocities now.
    previous : array, shape ``(B, n)``
        The positions one step earlier.
    last_update : integer array, shape ``(B, n)``
        The step of everybody's last update, -1 before the first.
    """

    setting: Setting
    step: int
    p: Floats
    q: Floats
    previous: Floats
    last_update: npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Move:
    """What the malicious nodes do at one step. What is None or NaN stays as it would be for an honest node.

    Attributes
    ----------
    sent : array, shape ``(B, n)``, or None
        The position each malicious node claims to all its neighbours; NaN: the true one.
    positions : array, shape ``(B, n)``, or None
        Where it truly is, as vehicles with active sensing see it; NaN: where the update rule takes it.
    told : array, shape ``(B, A)``, or None
        Byzantine only: the position claimed on each arc; NaN: as ``sent``.
    withheld : boolean array, shape ``(B, A)``, or None
        Where True, nothing is sent (omissive faults).
    delays : integer array, shape ``(B, A)``, or None
        The delay of each arc, where the schedule leaves it to the adversary; -1: as the schedule says.
    """

    sent: Floats | None = None
    positions: Floats | None = None
    told: Floats | None = None
    withheld: Mask | None = None
    delays: npt.NDArray[np.int64] | None = None


class Adversary(Protocol):
    """The protocol: one method. Implementations are frozen dataclasses whose fields are plain values."""

    def play(self, view: View) -> Move:
        """Return what the malicious nodes of every run do at this step."""
