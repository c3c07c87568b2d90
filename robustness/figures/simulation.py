"""Pictures of runs: positions and velocities against time, groups told apart, and what the liars say."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from robustness.errors import InvalidParameter
from robustness.figures.saving import new_figure, save_figure
from robustness.figures.time_span import last_step_shown
from robustness.figures.wording import Names, plain
from robustness.simulation.adversaries import Alternating
from robustness.simulation.dynamics import Floats, to_absolute
from robustness.simulation.outcome import Outcome, Trajectory
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.update_rules import rule_named
from robustness.spelled import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "GROUP_COLORS",
    "LIAR_COLOR",
    "QUANTITIES",
    "Run",
    "draw_outcome",
    "draw_runs",
    "position_in_words",
    "recorded",
    "run_title",
]

#: What can be drawn: the axis label of each quantity.
QUANTITIES = {
    "position": "position x",
    "velocity": "velocity v",
    "relative-position": "relative to the moving target, p = x - kTr",
}

#: One colour for every group of vehicles that end together (Okabe and Ito's palette; the liars' red is left out).
GROUP_COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#8a6d00")

LIAR_COLOR = "#d55e00"

#: Told apart without colour as well: the vehicles of one group take turns.
_DASHES = ("-", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)))

#: So many groups are named; more than these are mostly vehicles that never met.
_NAMED = 6

#: Crosses on a curve of claims, other ones for every curve, and letters on a line of the legend.
_CROSSES, _CLAIM_MARKS, _LEGEND_WIDE = 20, ("x", "+", "1", "2", "3", "4"), 34


class Run(NamedTuple):
    """A recorded run (``simulate(..., record=True)``) and what to write above it."""

    scenario: Scenario
    start: Start
    outcome: Outcome
    title: str = ""


def draw_runs(
    runs: Sequence[Run],
    path: str | os.PathLike[str],
    *,
    quantities: Sequence[str] | None = None,
    last_step: int | None = None,
) -> None:
    """Draw recorded runs against time, one row per run and one panel per quantity.

    Parameters
    ----------
    runs : sequence of Run
        At least one.
    path : str or path
        The format is that of its suffix: ``.png``, ``.svg``, ``.pdf``.
    quantities : sequence of str, optional
        Of :data:`QUANTITIES`. By default positions relative to the target and, where some rule has them, velocities.
    last_step : int, optional
        Where the time axis ends. By default a while after nothing moves any more, see
        :func:`robustness.figures.time_span.last_step_shown`.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When a run was not recorded, a quantity is unknown, or the suffix names no format.
    """
    if not runs:
        raise InvalidParameter("only a recorded run can be drawn: simulate with record=True")
    for run in runs:
        recorded(run)
    if quantities is None:
        moving = any(not rule_named(run.scenario.rule).first_order for run in runs)
        quantities = ("relative-position", "velocity") if moving else ("relative-position",)
    _require_quantities(quantities)
    figure = new_figure(5.6 * len(quantities) + 2.2, 3.9 * len(runs))
    rows = figure.subplots(len(runs), len(quantities), squeeze=False)
    for run, panels in zip(runs, rows, strict=True):
        for panel, quantity in zip(panels, quantities, strict=True):
            _draw_quantity(panel, quantity, run, last_step)
        panels[0].set_title(run_title(run), loc="left", fontsize=10, wrap=True)
        _legend(panels[-1], panels[0])
    save_figure(figure, path)


def draw_outcome(
    outcome: Any, ax: Axes | None = None, quantity: str = "relative-position", last_step: int | None = None
) -> Axes:
    """Draw one recorded run on axes, new ones of pyplot unless given, and return them; see :func:`draw_runs`."""
    _require_quantities([quantity])
    if not isinstance(outcome, Outcome) or outcome.scenario is None or outcome.start is None:
        raise InvalidParameter("only a run of the simulator can be drawn")
    run = Run(outcome.scenario, outcome.start, outcome)
    recorded(run)
    if ax is None:
        new_figure(1, 1)  # says what is missing when matplotlib is
        from matplotlib import pyplot as plt

        ax = plt.subplots(figsize=(8.0, 4.2), layout="constrained")[1]
    _draw_quantity(ax, quantity, run, last_step)
    ax.set_title(run_title(run), loc="left", fontsize=10, wrap=True)
    _legend(ax, ax)
    return ax


def recorded(run: Run) -> Trajectory:
    """Return the states of a recorded run, or raise :class:`InvalidParameter`."""
    if run.outcome.trajectory is None:
        raise InvalidParameter("only a recorded run can be drawn: simulate with record=True")
    return run.outcome.trajectory


def run_title(run: Run) -> str:
    """Return what a picture of the run says above it: its own title, the rule, the model and the verdict."""
    scenario, outcome = run.scenario, run.outcome
    how = f"{rule_named(scenario.rule).name}, f = {scenario.f}, {scenario.model}"
    delays = "" if scenario.schedule.synchronous else f", values up to {counted(scenario.schedule.oldest, 'step')} old"
    end = outcome.verdict.value + (", exactly" if outcome.exact else "")
    if outcome.diverged_at is not None:
        end += f" at step {outcome.diverged_at}"
    return (f"{plain(run.title)}\n" if run.title else "") + plain(f"{how}{delays}: {end}")


def position_in_words(scenario: Scenario, quantity: str = "relative-position") -> str:
    """Return what the axis of positions is called: one word where the target stands still."""
    return QUANTITIES[quantity] if scenario.target_speed else "position p"


def _require_quantities(quantities: Sequence[str]) -> None:
    for quantity in quantities:
        if quantity not in QUANTITIES:
            raise InvalidParameter(f"a quantity is one of {', '.join(QUANTITIES)}, not {quantity!r}")


def _draw_quantity(panel: Axes, quantity: str, run: Run, last_step: int | None) -> None:
    """Draw the normal vehicles, coloured by the group they end in, and for positions what the liars say."""
    scenario, start, outcome, _ = run
    labels = scenario.network.union.labels
    steps = _steps(run, last_step)
    times = steps * scenario.T
    values = _values(quantity, scenario, recorded(run), steps)
    normal = [i for i, label in enumerate(labels) if label not in start.malicious]
    named = Names(labels)
    values_in_words = _told_apart([value for value, _ in outcome.groups])
    for number, (_, group) in enumerate(outcome.groups):
        color = GROUP_COLORS[number % len(GROUP_COLORS)]
        for place, label in enumerate(group):
            i = labels.index(label)
            dashes = _DASHES[place % len(_DASHES)]
            panel.plot(times, values[:, i], ls=dashes, lw=1.4, color=color, label="_")
        if number < _NAMED:
            told = f"{named.together(group, 5)} at {values_in_words[number]}"
            panel.plot([], [], color=color, lw=2, label=_wrapped(told))
    if len(outcome.groups) > _NAMED:
        panel.plot([], [], lw=0, label=f"… {len(outcome.groups) - _NAMED} more")
    if normal:
        _fit(panel, values[:, normal])
    if quantity != "velocity" and start.malicious:
        _draw_claims(panel, quantity, run, steps)
    if outcome.diverged_at is not None:
        panel.axvline(outcome.diverged_at * scenario.T, color="black", lw=0.8, ls=":")
    panel.set_xlabel(_time_axis(run, int(steps[-1])))
    panel.locator_params(axis="x", integer=scenario.T == 1)
    panel.set_ylabel("velocity v" if quantity == "velocity" else position_in_words(scenario, quantity))
    panel.grid(alpha=0.3)


def _wrapped(told: str) -> str:
    """Return a line of the legend in several where it would take the room of the curves."""
    return textwrap.fill(told, _LEGEND_WIDE, break_long_words=False, break_on_hyphens=False)


def _told_apart(values: Sequence[float]) -> list[str]:
    """Return numbers with as few digits as tell them apart, four at least."""
    for digits in range(4, 17):
        told = [f"{value:.{digits}g}" for value in values]
        if len(set(told)) == len(told):
            break
    return told


def _time_axis(run: Run, last: int) -> str:
    """Return what stands under the picture: the unit, and how long the run was where it is cut short."""
    unit = "time kT" if run.scenario.T != 1 else "step k"
    end = len(recorded(run).p) - 1
    is_whole = last == end or run.outcome.diverged_at is not None
    return unit if is_whole else f"{unit} (the run has {counted(end, 'step')})"


def _fit(panel: Axes, shown: Floats) -> None:
    """Scale to the normal vehicles: a liar far away would hide them."""
    low, high = float(shown.min()), float(shown.max())
    margin = 0.08 * (high - low) or 1.0
    panel.set_ylim(low - margin, high + margin)


def _draw_claims(panel: Axes, quantity: str, run: Run, steps: Any) -> None:
    """Draw what the liars say, dashed, once for those who say the same; two faces as two lines, where one has them."""
    scenario, start = run.scenario, run.start
    labels, sent = scenario.network.union.labels, recorded(run).sent
    marks = iter(_CLAIM_MARKS)
    same: dict[bytes, list[object]] = {}
    for label in sorted(start.malicious, key=labels.index):
        same.setdefault(sent[:, labels.index(label)].tobytes(), []).append(label)
    for liars in list(same.values())[:3]:
        i = labels.index(liars[0])
        for which, told in _faces(scenario, liars, sent[:, i]):
            chosen = steps[(steps % 2 == which) | (which < 0)]
            claims = sent[chosen, i]
            if quantity == "position":
                claims = to_absolute(claims, claims, chosen, scenario.T, scenario.target_speed)[0]
            # Behind the curves; the crosses stick out where a claim is what a normal vehicle says.
            panel.plot(
                chosen * scenario.T, claims, ls=(0, (4, 3)), lw=0.8, color=LIAR_COLOR, zorder=1.5, label=_wrapped(told),
                marker=next(marks), markersize=5, markevery=max(1, len(chosen) // _CROSSES),
            )  # fmt: skip


def _faces(scenario: Scenario, liars: Sequence[object], sent: Floats) -> Iterator[tuple[int, str]]:
    """Yield the lines that show what liars say: of all steps (-1), or of even (0) and odd ones (1)."""
    one = len(liars) == 1
    named = Names(scenario.network.union.labels)
    name = named(liars[0]) if one else named.together(liars, 4)
    say, show = ("says", "shows") if one else ("say", "show")
    adversary = scenario.adversary
    if isinstance(adversary, Alternating) and adversary.sees_even and adversary.sees_odd:
        yield 0, f"{name} {show} {named.together(adversary.sees_even, 4)}"
        yield 1, f"{name} {show} {named.together(adversary.sees_odd, 4)}"
        return
    jumps = np.abs(np.diff(sent))
    if len(jumps) >= 4 and np.median(jumps) > 0.2 * (np.ptp(sent) or 1.0):
        yield 0, f"{name} {say} at even steps"
        yield 1, f"{name} {say} at odd steps"
        return
    yield -1, f"{name} {say}"


def _steps(run: Run, last_step: int | None) -> Any:
    """Return the steps to draw, thinned to what a picture can show, even and odd ones alike; up to a divergence."""
    end = last_step_shown(run.outcome, last_step) + 1
    pairs = np.arange(0, end, 2 * max(1, end // 2000))
    return np.unique(np.minimum(np.concatenate([pairs, pairs + 1]), end - 1))


def _values(quantity: str, scenario: Scenario, states: Trajectory, steps: Any) -> Floats:
    """Return the values of all vehicles at these steps, shape ``(steps, n)``."""
    x, v = to_absolute(states.p[steps], states.q[steps], steps[:, None], scenario.T, scenario.target_speed)
    return np.asarray({"position": x, "velocity": v, "relative-position": states.p[steps]}[quantity])


def _legend(panel: Axes, named: Axes) -> None:
    """Put the legend of ``named`` beside the last panel, where it covers no curve and is as tall as it needs."""
    handles, told = named.get_legend_handles_labels()
    if handles:
        panel.legend(
            handles, told, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, fontsize="small",
            frameon=False,
        )  # fmt: skip
