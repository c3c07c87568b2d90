"""Pictures of runs: positions and velocities against time, as in the source paper's six figures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from robustness.errors import InvalidParameter, MissingExtra
from robustness.simulation.dynamics import Floats, to_absolute
from robustness.simulation.outcome import Outcome
from robustness.simulation.scenario import Scenario, Start

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["QUANTITIES", "Run", "draw_runs"]

#: What can be drawn: the axis label of each quantity.
QUANTITIES = {
    "position": "position x",
    "velocity": "velocity v",
    "relative-position": "relative to the moving target, p = x - kTr",
}

#: Told apart without colour as well.
_DASHES = ("-", "--", "-.", ":")


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
    quantities: Sequence[str] = ("relative-position", "velocity"),
    last_step: int | None = None,
) -> None:
    """Draw the normal vehicles of recorded runs against time, one row per run and one panel per quantity.

    Parameters
    ----------
    runs : sequence of Run
        At least one.
    path : str or path
        The format is that of its suffix: ``.png``, ``.svg``, ``.pdf``.
    quantities : sequence of str
        Of :data:`QUANTITIES`.
    last_step : int, optional
        Where the time axis ends.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When a run was not recorded, a quantity is unknown, or the suffix names no format.
    """
    if not runs or any(run.outcome.trajectory is None for run in runs):
        raise InvalidParameter("only a recorded run can be drawn: simulate with record=True")
    for quantity in quantities:
        if quantity not in QUANTITIES:
            raise InvalidParameter(f"a quantity is one of {', '.join(QUANTITIES)}, not {quantity!r}")
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
    figure = Figure(figsize=(6.4 * len(quantities), 4.0 * len(runs)), layout="constrained")
    rows = figure.subplots(len(runs), len(quantities), squeeze=False)
    for run, panels in zip(runs, rows, strict=True):
        for panel, quantity in zip(panels, quantities, strict=True):
            _draw_quantity(panel, quantity, run, last_step)
        panels[-1].legend(title="vehicle", loc="best", fontsize="small")
        if len(runs) > 1:
            panels[0].set_title(run.title, loc="left")
    if len(runs) == 1 and runs[0].title:
        figure.suptitle(runs[0].title)
    _save(figure, path)


def _draw_quantity(panel: Axes, quantity: str, run: Run, last_step: int | None) -> None:
    scenario, start = run.scenario, run.start
    times, values = _values(quantity, scenario, run.outcome, last_step)
    labels = scenario.network.union.labels
    normal = [i for i, label in enumerate(labels) if label not in start.malicious]
    for place, i in enumerate(normal):
        dashes = _DASHES[place // 10 % len(_DASHES)]
        panel.plot(times, values[:, i], dashes, color=f"C{place % 10}", label=str(labels[i]))
    panel.set_xlabel("time kT" if scenario.T != 1 else "step k")
    panel.set_ylabel(QUANTITIES[quantity])
    panel.grid(alpha=0.3)


def _values(quantity: str, scenario: Scenario, outcome: Outcome, last_step: int | None) -> tuple[Floats, Floats]:
    """Return the time axis and the values ``(steps, n)``, thinned to what a picture can show."""
    states = outcome.trajectory
    if states is None:  # draw_runs has checked it
        raise InvalidParameter("only a recorded run can be drawn: simulate with record=True")
    steps = np.arange(len(states.p))[: None if last_step is None else last_step + 1]
    steps = steps[:: max(1, len(steps) // 2000)]
    x, v = to_absolute(states.p[steps], states.q[steps], steps[:, None], scenario.T, scenario.target_speed)
    chosen = {"position": x, "velocity": v, "relative-position": states.p[steps]}[quantity]
    return np.asarray(steps * scenario.T, dtype=np.float64), chosen


def _save(figure: Any, path: str | os.PathLike[str]) -> None:
    """Write the figure without a date and with fixed ids: the same run gives the same file."""
    from matplotlib import rc_context

    suffix = os.path.splitext(os.fspath(path))[1].lower().lstrip(".")
    formats = figure.canvas.get_supported_filetypes()
    if suffix not in formats:
        raise InvalidParameter(f"a picture's suffix is one of {', '.join(sorted(formats))}, not {suffix!r}")
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with rc_context({"svg.hashsalt": "robustness"}):
        figure.savefig(path, format=suffix, metadata=undated.get(suffix), dpi=110)
