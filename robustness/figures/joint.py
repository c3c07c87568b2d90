"""The picture of joint robustness: the steps, which windows fail, and the smallest window against r."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from robustness.errors import InvalidParameter, MissingExtra
from robustness.results import Verdict
from robustness.time_varying import JointResult, TimeVaryingGraph

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_joint"]

#: Told apart without colour too: the marks of failing windows are drawn taller.
_COLORS = {Verdict.ROBUST: "#3b7dbd", Verdict.NOT_ROBUST: "#c8402f", Verdict.UNDECIDED: "#9a9a9a"}


def draw_joint(
    sequence: TimeVaryingGraph,
    result: JointResult,
    curve: Mapping[int, int | None] | None,
    path: str | os.PathLike[str],
) -> None:
    """Draw a timeline to ``path``, in the format of its suffix.

    Above: the arcs of every stored step, with the steps of the first failing window shaded. Below: one mark at the
    start of every window that ``result`` decided, red and tall where its union fails. With a ``curve`` (as from
    :func:`~robustness.time_varying.joint_curve`) a third panel shows the smallest window length for every r.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When the suffix names no format that matplotlib writes.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
    rows = 2 if curve is None else 3
    figure = Figure(figsize=(9, 2 + 1.6 * rows), layout="constrained")
    panels = figure.subplots(rows, 1, squeeze=False, height_ratios=[2, 1, 2][:rows])[:, 0]
    panels[1].sharex(panels[0])
    name = f"{result.r}-robust" if result.s == 1 else f"({result.r},{result.s})-robust"
    _draw_steps(panels[0], sequence, result)
    _draw_windows(panels[1], result, name)
    if curve is not None:
        _draw_curve(panels[2], curve, result.s)
    # No date and fixed ids: the same question gives the same file.
    from matplotlib import rc_context

    with rc_context({"svg.hashsalt": "robustness"}):
        _save(figure, path)


def _save(figure: Any, path: str | os.PathLike[str]) -> None:
    suffix = os.path.splitext(os.fspath(path))[1].lower()
    known = sorted(figure.canvas.get_supported_filetypes())
    if suffix.lstrip(".") not in known:
        raise InvalidParameter(f"a picture's suffix is one of {', '.join('.' + one for one in known)}, not {suffix!r}")
    figure.savefig(path, dpi=150, metadata={"Date": None} if suffix == ".svg" else None)


def _draw_steps(axes: Axes, sequence: TimeVaryingGraph, result: JointResult) -> None:
    steps = range(len(sequence))
    axes.fill_between([*steps, len(sequence)], [*map(len, sequence.step_arcs), 0], step="post", color="#b9c9d9", lw=0)
    axes.set_ylabel("arcs of the step")
    axes.tick_params(labelbottom=False)
    axes.locator_params(axis="y", integer=True)
    axes.set_xlim(0, len(sequence))
    axes.set_ylim(bottom=0)
    if sequence.period is not None and sequence.prefix:
        axes.axvline(sequence.prefix, color="black", lw=0.8, ls=":")
        axes.annotate(" period", (sequence.prefix, 0.97), xycoords=("data", "axes fraction"), va="top")
    if result.violation is not None:
        start, stop = result.violation.start, result.violation.start + result.violation.length
        axes.axvspan(start, min(stop, len(sequence)), color=_COLORS[Verdict.NOT_ROBUST], alpha=0.25, lw=0)
        if stop > len(sequence) and sequence.period is not None:
            wrapped = min(sequence.prefix + stop - len(sequence), start)
            axes.axvspan(sequence.prefix, wrapped, color=_COLORS[Verdict.NOT_ROBUST], alpha=0.25, lw=0)


def _draw_windows(axes: Axes, result: JointResult, name: str) -> None:
    verdicts = [result.union_verdicts[union].verdict for union in result.window_unions]
    counts = []
    for verdict, color in _COLORS.items():
        height = 1.0 if verdict is Verdict.NOT_ROBUST else 0.5
        marks = [height if found is verdict else 0.0 for found in verdicts]
        if any(marks):
            axes.fill_between(range(len(marks) + 1), [*marks, 0.0], step="post", color=color, lw=0)
            counts.append(f"{len(marks) - marks.count(0.0)} {verdict.value}")
    axes.set_yticks([])
    axes.set_ylim(0, 1.05)
    shown = f" ({', '.join(counts)})" if counts else ""
    axes.set_xlabel(f"start of the window: is the union over {result.examined} steps {name}?{shown}")


def _draw_curve(axes: Axes, curve: Mapping[int, int | None], s: int) -> None:
    reached = {r: window for r, window in curve.items() if window is not None}
    axes.plot(list(reached), list(reached.values()), "o-", color=_COLORS[Verdict.ROBUST])
    for r in curve.keys() - reached.keys():
        axes.annotate("none", (r, 0), xycoords=("data", "axes fraction"), ha="center", va="bottom", color="#666666")
    axes.set_xlim(0.5, len(curve) + 0.5)
    axes.set_ylim(bottom=0)
    axes.locator_params(integer=True)
    axes.set_xlabel("r" if s == 1 else f"r, with s = {s}")
    axes.set_ylabel("smallest window")
