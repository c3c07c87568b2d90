"""Pictures of runs: positions and velocities against time, as in the source paper's six figures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from robustness.errors import InvalidParameter, MissingExtra
from robustness.simulation.dynamics import Floats, to_absolute
from robustness.simulation.outcome import Outcome
from robustness.simulation.scenario import Scenario, Start

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["QUANTITIES", "draw_run"]

#: What can be drawn: the axis label of each quantity.
QUANTITIES = {
    "position": "position x",
    "velocity": "velocity v",
    "relative-position": "relative to the moving target, p = x - kTr",
}

#: Told apart without colour as well.
_DASHES = ("-", "--", "-.", ":")


def draw_run(
    scenario: Scenario,
    start: Start,
    outcome: Outcome,
    path: str | os.PathLike[str],
    *,
    quantities: Sequence[str] = ("relative-position", "velocity"),
    title: str = "",
    last_step: int | None = None,
) -> None:
    """Draw the normal vehicles of a recorded run against time, one panel per quantity.

    Parameters
    ----------
    scenario, start, outcome
        A run with a trajectory (``simulate(..., record=True)``).
    path : str or path
        The format is that of its suffix: ``.png``, ``.svg``, ``.pdf``.
    quantities : sequence of str
        Of :data:`QUANTITIES`.
    title : str
    last_step : int, optional
        Where the time axis ends.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When the run was not recorded, a quantity is unknown, or the suffix names no format.
    """
    if outcome.trajectory is None:
        raise InvalidParameter("only a recorded run can be drawn: simulate with record=True")
    for quantity in quantities:
        if quantity not in QUANTITIES:
            raise InvalidParameter(f"a quantity is one of {', '.join(QUANTITIES)}, not {quantity!r}")
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
    figure = Figure(figsize=(6.4 * len(quantities), 4.0), layout="constrained")
    panels = figure.subplots(1, len(quantities), squeeze=False)[0]
    for panel, quantity in zip(panels, quantities, strict=True):
        _draw_quantity(panel, quantity, scenario, start, outcome, last_step)
    panels[-1].legend(title="vehicle", loc="best", fontsize="small")
    if title:
        figure.suptitle(title)
    _save(figure, path)


def _draw_quantity(
    panel: Axes, quantity: str, scenario: Scenario, start: Start, outcome: Outcome, last_step: int | None
) -> None:
    times, values = _values(quantity, scenario, outcome, last_step)
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
    if states is None:  # draw_run has checked it
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
