"""What is simulated: the network, the rule, the faults, the schedule; and where each run of a batch starts."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from certificates.graph import Label
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation.adversaries import Adversary, Constant
from robustness.simulation.draws import Draws
from robustness.simulation.models import fault_model_named
from robustness.simulation.rules import rule_named
from robustness.simulation.schedules import Schedule
from robustness.simulation.topology import Topology

__all__ = ["Scenario", "Start", "random_start"]


@dataclass(frozen=True)
class Scenario:
    """Everything the runs of a batch have in common.

    Parameters
    ----------
    network : Topology
        Made by :func:`robustness.simulation.topology.as_topology` from a graph or a time-varying graph.
    f : int
        The bound on faults that the filter and the fault model share.
    rule : str
        ``"w-msr"``, ``"dp-msr"`` or ``"adp-msr"``.
    model : str
        ``"malicious"``, ``"malicious-local"``, ``"byzantine"`` or ``"byzantine-local"``.
    adversary : Adversary
    schedule : Schedule
    steps : int
        The horizon K; states 0 .. K are observed.
    T, target_speed : float
        The sampling period and the target speed r. In transformed coordinates r plays no part.
    alpha : float, mapping from labels, or None
        The gains; None: ``1.5 / T``.
    weights : str or mapping from arcs
        See :func:`robustness.simulation.gains.arc_weights`. First-order rules use them as relative weights beside an
        own weight of 1 (``uniform`` then means the same as ``unit``: the plain mean of what is kept and the own value).
    offsets : mapping from labels, or None
        The formation, see :mod:`robustness.simulation.formation`.
    active : frozenset of labels
        Who senses actively.
    added_links : tuple of pairs of labels
        Links that the malicious nodes add to the network.
    groups : two tuples of labels, or None
        Two groups that evidence says are never to move: every normal node of them is watched bit for bit.
    tolerance : float
        Agreement means a spread of at most this multiple of the normal vehicles' initial spread (of 1 if that is 0),
        and speeds relative to the target of at most as much per unit of time ...
    dwell : int or None
        ... at each of the last ``dwell`` states; None: 10, or twice tau + 1, or for a network that changes twice its
        turn (half the run when that is less), whichever is most. A shorter run decides nothing.
    """

    network: Topology
    f: int
    rule: str = "adp-msr"
    model: str = "malicious"
    adversary: Adversary = Constant()
    schedule: Schedule = Schedule()
    steps: int = 1000
    T: float = 1.0
    target_speed: float = 0.0
    alpha: float | Mapping[Hashable, float] | None = None
    weights: str | Mapping[tuple[Hashable, Hashable], float] = "uniform"
    offsets: Mapping[Hashable, float] | None = None
    active: frozenset[Label] = frozenset()
    added_links: tuple[tuple[Label, Label], ...] = ()
    groups: tuple[tuple[Label, ...], tuple[Label, ...]] | None = None
    tolerance: float = 1e-6
    dwell: int | None = None

    def __post_init__(self) -> None:
        rule, _ = rule_named(self.rule), fault_model_named(self.model)
        if type(self.f) is not int or self.f < 0:
            raise InvalidParameter(f"f is an integer of at least 0, not {self.f!r}")
        if type(self.steps) is not int or self.steps < 1:
            raise InvalidParameter(f"a run has at least 1 step, not {self.steps!r}")
        if not (np.isfinite(self.T) and self.T > 0):
            raise InvalidParameter(f"the sampling period T is a positive number, not {self.T!r}")
        if not np.isfinite(self.target_speed):
            raise InvalidParameter(f"the target speed is a finite number, not {self.target_speed!r}")
        if not (np.isfinite(self.tolerance) and self.tolerance > 0):
            raise InvalidParameter(f"the tolerance is a positive number, not {self.tolerance!r}")
        if self.dwell is not None and not 1 <= self.dwell <= self.steps:
            raise InvalidParameter(f"the dwell time lies in 1..steps = 1..{self.steps}, not {self.dwell}")
        if rule.synchronous and not self.schedule.synchronous:
            raise InvalidParameter(f"{rule.name} updates at every step without delays: use adp-msr for this schedule")

    @property
    def dwell_steps(self) -> int:
        """How many of the last states must show a verdict."""
        if self.dwell is not None:
            return self.dwell
        # A schedule or a sequence of graphs may do nothing for a whole turn.
        turn = 1 if self.network.fixed else min(len(self.network.sequence), self.steps)
        return max(10, 2 * (self.schedule.oldest + 1), min(2 * turn, self.steps // 2))


@dataclass(frozen=True)
class Start:
    """Where one run starts.

    Attributes
    ----------
    malicious : frozenset of labels
    positions, velocities : tuple of float
        Aligned positions ``p - d`` and velocities ``q`` in id order. At step 0 absolute and transformed positions are
        the same, so these are absolute positions relative to each vehicle's place in the formation; velocities are
        relative to the target speed.
    seed : int
        Of every draw of this run.
    """

    malicious: frozenset[Label]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    seed: int = 0


def random_start(graph: Digraph, malicious: Sequence[Hashable] | frozenset[Label], seed: int) -> Start:
    """Return a start at rest from integer positions in ``0 .. 100``, drawn from the seed.

    The normal vehicles with the least and the greatest draw are moved to 0 and 100, so that no start is trivial.

    >>> random_start(Digraph("abc", []), ["a"], seed=1) == random_start(Digraph("abc", []), ["a"], seed=1)
    True
    """
    bad = graph.ids(malicious)
    values = Draws([seed]).integers("start", 0, graph.n, 0, 100)[0].astype(float)
    normal = [i for i in range(graph.n) if i not in bad]
    if len(normal) > 1:
        ordered = sorted(normal, key=lambda i: (values[i], i))
        values[ordered[0]], values[ordered[-1]] = 0.0, 100.0
    return Start(graph.labels_of(bad), tuple(values.tolist()), (0.0,) * graph.n, seed)
