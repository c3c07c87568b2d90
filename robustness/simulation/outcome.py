"""What a run showed: agreement, split, divergence, or none of them; and whether what the theory promises was kept."""

from __future__ import annotations

import enum
import importlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from certificates.graph import Label
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter, MissingExtra
from robustness.natural_order import in_natural_order
from robustness.showing import ShownOverTime
from robustness.simulation.contraction import Contraction
from robustness.simulation.dynamics import Floats, to_absolute
from robustness.spelled import counted, labels_in_words

if TYPE_CHECKING:
    from robustness.simulation.scenario import Scenario, Start

__all__ = ["Outcome", "RunVerdict", "Trajectory", "convergence_rate", "groups_of", "settled_since", "verdict_of"]


class RunVerdict(enum.Enum):
    """What a run showed by its horizon."""

    #: All normal vehicles stayed within the tolerance during the last ``dwell`` states.
    AGREEMENT = "agreement"
    #: Normal vehicles stayed apart by a gap that does not change by one bit, or repeats: see :func:`verdict_of`.
    SPLIT = "split"
    #: A normal vehicle left the finite numbers or grew past the scenario's factor: see ``diverged_at``.
    DIVERGENCE = "divergence"
    #: None of these by the horizon.
    UNDECIDED = "undecided"


@dataclass(frozen=True, eq=False, slots=True)
class Trajectory:
    """The states of one run.

    Attributes
    ----------
    p, q : arrays, shape ``(K + 1, n)``
        Transformed positions and velocities, in id order.
    sent : array, shape ``(K + 1, n)``
        What each node claimed to all its neighbours.
    """

    p: Floats
    q: Floats
    sent: Floats


@dataclass(frozen=True, slots=True, repr=False)
class Outcome(ShownOverTime):
    """One run's verdict and its numbers.

    Attributes
    ----------
    verdict : RunVerdict
    exact : bool
        True for a split that evidence predicted and every step confirmed bit for bit: it lasts for ever. (What the
        other vehicles do makes no difference to it, even if they diverge.)
    diverged_at : int or None
        The step at which the run diverged, see :class:`robustness.simulation.divergence.Divergence`. Its states stay
        as they were then (at the step before, when they were no finite numbers any more), and all numbers below are
        about those.
    spread : float
        ``max - min`` of ``p - d`` over the normal vehicles at the horizon.
    initial_spread : float
    speed : float
        The greatest ``|q|`` of a normal vehicle at the horizon.
    since : int or None
        The first step from which the spread stayed within the tolerance.
    rate : float or None
        The fitted factor by which the spread shrinks per step; None when it does not shrink to a fit.
    contraction : Contraction or None
        The proven shrinking to compare it with, for a network that satisfies the condition of its threat model; None
        where the theory gives none.
    safe : bool or None
        Whether no normal vehicle ever left the hull that the theory promises; None when it promises none. The hull is
        that of all ``p`` and ``p + c q`` at the start, :func:`robustness.gain_region.hull_velocity_factor`.
    promise_gap : str or None
        Why the theory promises nothing about this run, or None when its gains lie inside the theory.
    groups : tuple
        Normal vehicles in groups of equal ``p - d`` (to the tolerance) at the horizon, from the lowest to the highest:
        pairs of the mean value and the labels.
    trajectory : Trajectory or None
        When recorded.
    scenario, start : Scenario, Start or None
        What was run.
    """

    verdict: RunVerdict
    exact: bool
    diverged_at: int | None
    spread: float
    initial_spread: float
    speed: float
    since: int | None
    rate: float | None
    contraction: Contraction | None
    safe: bool | None
    promise_gap: str | None
    groups: tuple[tuple[float, tuple[Label, ...]], ...]
    trajectory: Trajectory | None = field(default=None, compare=False)
    scenario: Scenario | None = field(default=None, compare=False)
    start: Start | None = field(default=None, compare=False)

    @property
    def positions(self) -> Floats:
        """Where every vehicle is, ``x = p + kTr``: shape ``(steps + 1, n)``, columns as in :attr:`labels`.

        After a divergence the last finite positions are repeated.

        Raises
        ------
        InvalidParameter
            When the run was not recorded.
        """
        return self._absolute()[0]

    @property
    def velocities(self) -> Floats:
        """How fast every vehicle is, ``v = q + r``; shape and errors as for :attr:`positions`. 0 for first order."""
        return self._absolute()[1]

    @property
    def labels(self) -> tuple[Label, ...]:
        """The nodes, in the order of the columns."""
        return () if self.scenario is None else self.scenario.network.union.labels

    def _absolute(self) -> tuple[Floats, Floats]:
        states, scenario = self.trajectory, self.scenario
        if states is None or scenario is None:
            raise InvalidParameter("only a recorded run has positions: simulate with record=True")
        steps = np.arange(len(states.p))[:, None]
        return to_absolute(states.p, states.q, steps, scenario.T, scenario.target_speed)

    def to_frame(self) -> Any:
        """Return the positions as a pandas DataFrame: one row per step, one column per node.

        Raises
        ------
        MissingExtra
            When pandas is not installed.
        InvalidParameter
            When the run was not recorded.
        """
        positions = self.positions
        try:
            # Not a dependency: who has pandas gets its frames.
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise MissingExtra("a DataFrame needs pandas: pip install pandas") from None
        columns = pandas.Index(list(self.labels), name="node", tupleize_cols=False)
        return pandas.DataFrame(positions, columns=columns, index=pandas.RangeIndex(len(positions), name="step"))

    def summary(self) -> str:
        """Return the verdict and where the vehicles are, in one line."""
        graph = self.pictured()
        nodes = None if graph is None else graph.labels
        where = "; ".join(f"{labels_in_words(labels, nodes)} at {value:.6g}" for value, labels in self.groups[:6])
        more = f"; {counted(len(self.groups) - 6, 'more group')}" if len(self.groups) > 6 else ""
        exactly = ", exactly" if self.exact else ""
        at = "" if self.diverged_at is None else f" at step {self.diverged_at}"
        return f"{self.verdict.value}{exactly}{at}: {where}{more}"

    def pictured(self) -> Digraph | None:
        """Return the network, all links that ever exist."""
        return None if self.scenario is None else self.scenario.network.union

    def evidence(self) -> list[tuple[str, str]]:
        """Return the numbers, as rows of a name and a text."""
        rows = [
            ("spread", f"{self.initial_spread:g} at first, {self.spread:g} at the end"),
            ("greatest speed at the end", f"{self.speed:g}"),
        ]
        if self.since is not None:
            rows.append(("within the tolerance since", f"step {self.since}"))
        if self.rate is not None:
            rows.append(("spread shrinks each step by the factor", f"{self.rate:.4g}, fitted"))
        if self.contraction is not None:
            least, every = self.contraction
            rows.append(
                ("proven", f"without a trap it loses at least {least:.2g} of itself in {counted(every, 'step')}")
            )
        if self.safe is not None:
            rows.append(("left the hull of the start", "no normal node" if self.safe else "a normal node"))
        if self.promise_gap is not None:
            rows.append(("gains", self.promise_gap))
        return rows

    def as_dict(self) -> dict[str, Any]:
        """Return the outcome as JSON-ready values (without the trajectory)."""
        return {
            "outcome": self.verdict.value,
            "exact": self.exact,
            "diverged_at": self.diverged_at,
            "spread": self.spread,
            "initial_spread": self.initial_spread,
            "speed": self.speed,
            "agreement_since": self.since,
            "rate": self.rate,
            "contraction": None if self.contraction is None else self.contraction._asdict(),
            "safe": self.safe,
            "promise_gap": self.promise_gap,
            "groups": [{"value": value, "nodes": in_natural_order(labels)} for value, labels in self.groups],
        }


def verdict_of(
    spread: Floats, speed: Floats, limit: float, dwell: int, *, watched: bool, unchanged: bool, diverged: bool = False
) -> tuple[RunVerdict, bool]:
    """Return the verdict of one run, and whether it is an exact split.

    Parameters
    ----------
    spread, speed : arrays, shape ``(K + 1,)``
        Of the normal vehicles, at every step.
    limit : float
        The tolerance in the units of the spread.
    dwell : int
        How many of the last states count.
    watched : bool
        Whether two groups were watched; then a split is theirs, and nothing else is called one.
    unchanged : bool
        Whether the watched groups kept every position and a velocity of 0 exactly, at every step, apart.
    diverged : bool
        Whether the run was stopped because it diverged; then it is no agreement and no observed split.

    Notes
    -----
    Without watched groups a split is a gap that in the last ``dwell`` states stays the same bit for bit, or repeats
    after at most half of them (vehicles that swap places), and exceeds the tolerance. That is an observation at the
    horizon; only the watched kind is proven to last.
    """
    late_spread, late_speed = spread[-dwell:], speed[-dwell:]
    if watched and unchanged:
        return RunVerdict.SPLIT, True
    if diverged:
        return RunVerdict.DIVERGENCE, False
    if len(late_spread) < dwell:
        return RunVerdict.UNDECIDED, False
    if late_spread.max() <= limit and late_speed.max() <= limit:
        return RunVerdict.AGREEMENT, False
    if not watched and late_spread.max() > limit and _repeats(late_spread):
        return RunVerdict.SPLIT, False
    return RunVerdict.UNDECIDED, False


def _repeats(values: Floats) -> bool:
    """Return whether the values repeat bit for bit after one step, or after a few, at most half of them."""
    return any((values[turn:] == values[:-turn]).all() for turn in range(1, len(values) // 2 + 1))


def settled_since(spread: Floats, limit: float) -> int | None:
    """Return the first step from which the spread stays within the limit, or None; NaN is outside."""
    outside = np.flatnonzero(~(spread <= limit))
    if not len(outside):
        return 0
    return int(outside[-1]) + 1 if outside[-1] + 1 < len(spread) else None


def convergence_rate(spread: Floats) -> float | None:
    """Return the factor per step of an exponential decay fitted to the spread, by least squares on its logarithm.

    Only the states before the spread first falls below 1e-10 of its start are used, where rounding does not matter.
    None when fewer than 3 are left, the fit does not shrink, or one of them is no finite number.

    >>> round(convergence_rate(0.5 ** np.arange(20.0)), 6)
    0.5
    """
    if not spread[0] > 0:
        return None
    low = np.flatnonzero(spread <= 1e-10 * spread[0])
    used = spread[: low[0]] if len(low) else spread
    if len(used) < 3 or not np.isfinite(used).all():
        return None
    slope = float(np.polyfit(np.arange(len(used)), np.log(used), 1)[0])
    return float(np.exp(slope)) if slope < 0 else None


def groups_of(
    aligned: Floats, normal: npt.NDArray[np.bool_], labels: tuple[Label, ...], limit: float
) -> tuple[tuple[float, tuple[Label, ...]], ...]:
    """Return the normal vehicles grouped wherever two neighbours on the line are farther apart than the limit."""
    # Not "> limit": what is not a number is close to nothing.
    order = [i for i in np.argsort(aligned, kind="stable").tolist() if normal[i]]
    found: list[list[int]] = []
    for i in order:
        if not found or not aligned[i] - aligned[found[-1][-1]] <= limit:
            found.append([])
        found[-1].append(i)
    return tuple((float(np.mean(aligned[g])), tuple(labels[i] for i in sorted(g))) for g in found)
