"""Who updates when, and how old the values are that it hears: synchrony, partial asynchrony, delays.

A schedule is two independent choices, update times and delays, under one bound ``tau`` on the age of any value in
use: an update at most every ``gap`` steps with delays of at most ``bound`` steps uses values that are at most
``gap - 1 + bound`` steps old. Before its first update a vehicle has heard nothing and only brakes.

Rows returned have shape ``(1, .)`` when they are the same for all runs of a batch and ``(B, .)`` otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType
from typing import ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import View
from robustness.simulation.dynamics import Floats
from robustness.spelled import counted

__all__ = [
    "SCHEDULES",
    "AdversarialDelays",
    "AdversarialUpdates",
    "ConstantDelays",
    "DelayRule",
    "EveryStep",
    "LatestDelays",
    "NoDelays",
    "Past",
    "PeriodicDelays",
    "PeriodicUpdates",
    "RandomDelays",
    "RandomUpdates",
    "Schedule",
    "UpdateRule",
    "schedule_named",
]

Flags = npt.NDArray[np.uint8]
Steps = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Past:
    """What could be delivered: with delay d, arc e of run b delivers ``ring[(step - d) % len(ring), b, channel[e]]``.

    Attributes
    ----------
    ring : array, shape ``(H, B, C)``
        The announcements of the last H steps, H greater than every delay.
    channel : integer array, shape ``(A,)``
    """

    ring: Floats
    channel: npt.NDArray[np.int64]


class UpdateRule(Protocol):
    """When vehicles update. ``gap``: the greatest number of steps from one update of a vehicle to its next."""

    @property
    def gap(self) -> int:
        """The greatest number of steps between two updates, and from the start to the first (1: every step)."""

    def updates(self, view: View) -> Flags:
        """Return who updates at this step, shape ``(1 or B, n)``."""


class DelayRule(Protocol):
    """How old delivered values are. ``bound``: the greatest delay."""

    @property
    def bound(self) -> int:
        """The greatest delay in steps."""

    @property
    def adversarial(self) -> bool:
        """Whether the adversary may choose the delays."""

    def delays(self, view: View, past: Past) -> Steps:
        """Return the delay of every arc at this step, shape ``(1 or B, A)``."""


@dataclass(frozen=True, slots=True)
class EveryStep:
    """Everybody updates at every step."""

    @property
    def gap(self) -> int:
        """The greatest number of steps between two updates: everybody updates at every step, so 1."""
        return 1

    def updates(self, view: View) -> Flags:
        """Return that everybody updates at this step."""
        return np.ones((1, view.setting.graph.n), dtype=np.uint8)


@dataclass(frozen=True)
class PeriodicUpdates:
    """Vehicle i updates at the steps ``period * l + offset_i``: the source paper's example has period 12.

    Parameters
    ----------
    period : int
        At least 1.
    offsets : mapping
        Node label to offset in ``0 .. period - 1``. A node that is not named gets its id modulo the period.
    """

    period: int
    offsets: Mapping[Hashable, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _require_positive("the period of updates", self.period)
        for label, offset in self.offsets.items():
            if not 0 <= offset < self.period:
                raise InvalidParameter(f"an update offset lies in 0..period - 1, not {offset} at {label!r}")

    @property
    def gap(self) -> int:
        """The greatest number of steps between two updates: the period."""
        return self.period

    def updates(self, view: View) -> Flags:
        """Return whose turn it is."""
        turns = _turns(view.setting.graph, self.period, tuple(self.offsets.items()))
        return np.asarray(turns[view.step % self.period])


@dataclass(frozen=True, slots=True)
class RandomUpdates:
    """Everybody updates with a fixed probability, and at the latest ``gap`` steps after its last update.

    Parameters
    ----------
    probability : float
        In ``0 .. 1``.
    gap : int
        At least 1.
    """

    probability: float = 0.4
    gap: int = 4

    def __post_init__(self) -> None:
        _require_positive("the gap between updates", self.gap)
        if not 0 <= self.probability <= 1:
            raise InvalidParameter(f"a probability lies in 0..1, not {self.probability}")

    def updates(self, view: View) -> Flags:
        """Return the draws of this step, from each run's own seed."""
        draws = view.setting.draws.uniform("updates", view.step, view.setting.graph.n)
        return ((draws < self.probability) | (view.step - view.last_update >= self.gap)).astype(np.uint8)


@dataclass(frozen=True, slots=True)
class AdversarialUpdates:
    """Vehicles far from the middle wait as long as they may; the others update at every step.

    What holds the spread open is an outer vehicle that does not move inwards, so those whose distance from the
    middle of the normal range exceeds half the greatest distance put off their update for ``gap`` steps.

    Parameters
    ----------
    gap : int
        At least 1.
    """

    gap: int = 4

    def __post_init__(self) -> None:
        _require_positive("the gap between updates", self.gap)

    def updates(self, view: View) -> Flags:
        """Return the inner vehicles and those that may wait no longer."""
        low, high = view.setting.normal_range(view.p)
        outer = np.abs(view.p - (low + high) / 2) > (high - low) / 4
        return (~outer | (view.step - view.last_update >= self.gap)).astype(np.uint8)


@dataclass(frozen=True, slots=True)
class NoDelays:
    """Every value is from this step."""

    @property
    def bound(self) -> int:
        """The greatest delay: values arrive at once, so 0."""
        return 0

    @property
    def adversarial(self) -> bool:
        """Whether the adversary may choose the delays: it may not."""
        return False

    def delays(self, view: View, past: Past) -> Steps:
        """Return that every arc delivers at once."""
        return np.zeros((1, view.setting.graph.arc_count), dtype=np.int64)


@dataclass(frozen=True)
class ConstantDelays:
    """A fixed delay per arc.

    Parameters
    ----------
    steps : int
        The delay of every arc that is not named.
    arcs : mapping
        ``(u, v)``, v hears u: the delay of that arc.
    """

    steps: int = 1
    arcs: Mapping[tuple[Hashable, Hashable], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if min([self.steps, *self.arcs.values()]) < 0:
            raise InvalidParameter("a delay is a number of steps of at least 0: nobody hears the future")

    @property
    def bound(self) -> int:
        """The greatest of the delays."""
        return max([self.steps, *self.arcs.values()])

    @property
    def adversarial(self) -> bool:
        """Whether the adversary may choose the delays: it may not."""
        return False

    def delays(self, view: View, past: Past) -> Steps:
        """Return the delay of every arc, the same at every step."""
        graph = view.setting.graph
        row = np.full(graph.arc_count, self.steps, dtype=np.int64)
        for (u, v), steps in self.arcs.items():
            (sender,), (receiver,) = graph.ids([u]), graph.ids([v])
            row[(view.setting.tails == sender) & (view.setting.heads == receiver)] = steps
        return row[None]


@dataclass(frozen=True, slots=True)
class PeriodicDelays:
    """Every arc has the same delay, which changes from step to step and repeats.

    Parameters
    ----------
    steps : tuple of int
        The delay at step k is ``steps[k % len(steps)]``.
    """

    steps: tuple[int, ...]

    def __post_init__(self) -> None:
        if not self.steps or min(self.steps) < 0:
            raise InvalidParameter("periodic delays are one or more numbers of steps, each of at least 0")

    @property
    def bound(self) -> int:
        """The greatest of the delays."""
        return max(self.steps)

    @property
    def adversarial(self) -> bool:
        """Whether the adversary may choose the delays: it may not."""
        return False

    def delays(self, view: View, past: Past) -> Steps:
        """Return the delay of this step, for every arc."""
        late = self.steps[view.step % len(self.steps)]
        return np.full((1, view.setting.graph.arc_count), late, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class _Bounded:
    """Delays of up to ``bound`` steps, which the adversary may choose where ``adversarial`` is true."""

    bound: int = 2
    adversarial: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _require_nonnegative("the bound on delays", self.bound)


@dataclass(frozen=True, slots=True)
class RandomDelays(_Bounded):
    """Every arc and step has a delay drawn uniformly from ``0 .. bound``, from the run's own seed."""

    adversarial: ClassVar[bool] = False

    def delays(self, view: View, past: Past) -> Steps:
        """Return the draws of this step."""
        setting = view.setting
        return setting.draws.integers("delays", view.step, setting.graph.arc_count, 0, self.bound)


@dataclass(frozen=True, slots=True)
class AdversarialDelays(_Bounded):
    """Delays chosen to keep the vehicles apart; an adversary's move may override each of them.

    A vehicle above the middle of the normal range hears, from every neighbour, the greatest value of the last
    ``bound + 1`` steps, and the others the least.
    """

    def delays(self, view: View, past: Past) -> Steps:
        """Return the delay that serves each arc's receiver worst."""
        from robustness.kernels.steps import worst_delays

        setting = view.setting
        low, high = setting.normal_range(view.p)
        delays = np.empty((len(view.p), len(past.channel)), dtype=np.int64)
        above = (view.p > (low + high) / 2).view(np.uint8)
        worst_delays(view.step, self.bound, past.ring, past.channel, setting.heads, above, delays)
        return delays


@dataclass(frozen=True, slots=True)
class LatestDelays(_Bounded):
    """Every value arrives ``bound`` steps late, unless an adversary's move says otherwise."""

    def delays(self, view: View, past: Past) -> Steps:
        """Return the bound for every arc."""
        return np.full((1, view.setting.graph.arc_count), self.bound, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class Schedule:
    """Update times and delays.

    Parameters
    ----------
    update_times : UpdateRule
    delay_rule : DelayRule
    tau : int or None
        The bound on the age of a value in use; None: the least that the two rules allow, ``gap - 1 + bound``.

    Raises
    ------
    InvalidParameter
        When tau is no integer of at least 0, or the two rules together can exceed it.

    >>> Schedule(PeriodicUpdates(12)).oldest
    11
    """

    update_times: UpdateRule = EveryStep()
    delay_rule: DelayRule = NoDelays()
    tau: int | None = None

    def __post_init__(self) -> None:
        needed = self.update_times.gap - 1 + self.delay_rule.bound
        if self.tau is not None:
            _require_nonnegative("tau", self.tau)
        if self.tau is not None and needed > self.tau:
            raise InvalidParameter(
                f"values in use are at most tau = {counted(self.tau, 'step')} old, but updates "
                f"{counted(self.update_times.gap, 'step')} apart with delays "
                f"up to {self.delay_rule.bound} make them {needed} old: raise tau to {needed}"
            )

    @property
    def oldest(self) -> int:
        """The bound tau: how old the values are at most that an update uses."""
        return self.update_times.gap - 1 + self.delay_rule.bound if self.tau is None else self.tau

    @property
    def synchronous(self) -> bool:
        """Whether everybody updates at every step with values of this step."""
        return self.update_times.gap == 1 and self.delay_rule.bound == 0


@lru_cache(maxsize=64)
def _turns(graph: Digraph, period: int, offsets: tuple[tuple[Hashable, int], ...]) -> Flags:
    """Return who updates at each step of a period, shape ``(period, 1, n)``; worked out once for all steps."""
    turns = np.arange(graph.n) % period
    for label, offset in offsets:
        (i,) = graph.ids([label])
        turns[i] = offset
    return np.asarray(np.arange(period)[:, None, None] == turns, dtype=np.uint8)


#: Schedules by the name users type, each a function of tau >= 0.
SCHEDULES: Mapping[str, Callable[[int], Schedule]] = MappingProxyType(
    {
        "synchronous": lambda tau: Schedule(tau=tau),
        "periodic": lambda tau: Schedule(PeriodicUpdates(tau + 1)),
        "random": lambda tau: Schedule(RandomUpdates(gap=tau - tau // 2 + 1), RandomDelays(tau // 2)),
        "adversarial": lambda tau: Schedule(AdversarialUpdates(tau - tau // 2 + 1), AdversarialDelays(tau // 2)),
        "delayed": lambda tau: Schedule(EveryStep(), AdversarialDelays(tau)),
    }
)


def schedule_named(name: str, tau: int) -> Schedule:
    """Return the schedule of this name for the bound tau, or raise :class:`InvalidParameter`."""
    if name not in SCHEDULES:
        raise InvalidParameter(f"a schedule is one of {', '.join(SCHEDULES)}, not {name!r}")
    _require_nonnegative("tau", tau)
    return SCHEDULES[name](tau)


def _require_positive(what: str, value: int) -> None:
    if type(value) is not int or value < 1:
        raise InvalidParameter(f"{what} is an integer of at least 1, not {value!r}")


def _require_nonnegative(what: str, value: int) -> None:
    if type(value) is not int or value < 0:
        raise InvalidParameter(f"{what} is an integer of at least 0, not {value!r}")
