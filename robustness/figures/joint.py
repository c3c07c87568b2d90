"""The picture of joint robustness: the steps, which windows fail, and the smallest window against r."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import TYPE_CHECKING

from robustness.figures.saving import new_figure, save_figure
from robustness.figures.wording import plain
from robustness.results import Verdict
from robustness.spelled import counted, robust
from robustness.time_varying import JointResult, TimeVaryingGraph, Violation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_joint"]

#: The colour of every answer, of the title and of the windows alike.
_COLORS = {Verdict.ROBUST: "#1b7f4d", Verdict.UNDECIDED: "#7a7a7a", Verdict.NOT_ROBUST: "#c8402f"}

_WORDS = {Verdict.ROBUST: "robust", Verdict.UNDECIDED: "undecided", Verdict.NOT_ROBUST: "not robust"}


def draw_joint(
    sequence: TimeVaryingGraph,
    result: JointResult,
    curve: Mapping[int, int | None] | None,
    path: str | os.PathLike[str],
    *,
    shown: JointResult | None = None,
) -> None:
    """Draw a timeline to ``path``, in the format of its suffix.

    Above: the arcs of every stored step; where the answer is no, the steps of the first failing window are shaded.
    Below: one mark at the start of every window that was decided, green where its union is robust, red and hatched
    where it fails. With a ``curve`` (as from :func:`~robustness.time_varying.joint_curve`) a third panel shows the
    smallest window length for every r, and ``result.tau``.

    Parameters
    ----------
    result : JointResult
        The answer: the title.
    shown : JointResult, optional
        One about windows a step shorter. At the smallest length nothing fails; a small grey row shows where the length
        below it does. Where no length will do, one about the greatest length, which is drawn instead.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When the suffix names no format that matplotlib writes.
    """
    rows = 2 if curve is None else 3
    figure = new_figure(9.4, 2.3 + 1.7 * rows)
    figure.suptitle(plain(result.summary()) + _tau_text(result), color=_COLORS[result.verdict], fontweight="bold")
    panels = figure.subplots(rows, 1, squeeze=False, height_ratios=[2, 1, 2][:rows])[:, 0]
    panels[1].sharex(panels[0])
    _draw_steps(panels[0], sequence, result.violation)
    # Where no length will do, the windows of the greatest one are the answer, not those below it.
    if result.window_unions or shown is None:
        _draw_windows(panels[1], result, None if shown is result else shown)
    else:
        _draw_windows(panels[1], shown, None)
    if curve is not None:
        _draw_curve(panels[2], curve, result)
    save_figure(figure, path)


def _tau_text(result: JointResult) -> str:
    if result.within_tau is None or result.window is None:
        return ""
    return f" ({'within' if result.within_tau else 'longer than'} the delay bound {result.tau})"


def _draw_steps(axes: Axes, sequence: TimeVaryingGraph, failing: Violation | None) -> None:
    steps = range(len(sequence))
    axes.fill_between([*steps, len(sequence)], [*map(len, sequence.step_arcs), 0], step="post", color="#b9c9d9", lw=0)
    axes.set_ylabel("arcs of the step")
    axes.tick_params(labelbottom=False)
    axes.locator_params(integer=True)
    axes.set_xlim(0, len(sequence))
    axes.set_ylim(bottom=0)
    if sequence.period is not None and sequence.prefix:
        axes.axvline(sequence.prefix, color="black", lw=0.8, ls=":")
        axes.annotate(" period", (sequence.prefix, 0.97), xycoords=("data", "axes fraction"), va="top")
    if failing is not None:
        last = failing.start + failing.length - 1
        label = f"fails: steps {failing.start} to {last}" if failing.length > 1 else f"fails: step {last}"
        for begin, end in _stored_spans(sequence, failing):
            # The outline keeps a few steps out of thousands visible.
            axes.axvspan(begin, end, color=_COLORS[Verdict.NOT_ROBUST], alpha=0.25, lw=1, label=label)
            label = ""
        _legend(axes)


def _stored_spans(sequence: TimeVaryingGraph, failing: Violation) -> Iterator[tuple[int, int]]:
    """Yield the stored steps of a window; one that runs past the last step goes on where the period begins."""
    stop = failing.start + failing.length
    yield failing.start, min(stop, len(sequence))
    if stop > len(sequence) and sequence.period is not None:
        wrapped = min(sequence.prefix + stop - len(sequence), failing.start)
        if wrapped > sequence.prefix:
            yield sequence.prefix, wrapped


def _draw_windows(axes: Axes, result: JointResult, shorter: JointResult | None) -> None:
    """Draw the windows of the answer, and below them, smaller, those one step shorter that show why no less will do."""
    axes.set_yticks([])
    axes.set_ylim(0, 1.05)
    if not result.window_unions and (shorter is None or not shorter.window_unions):
        axes.annotate("no window was decided", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center")
        axes.set_xlabel("step")
        return
    floor = 0.35 if shorter is not None and shorter.window_unions else 0.0
    for verdict, bars in _bars(result).items():
        label = f"{_WORDS[verdict]}: {counted(sum(width for _, width in bars), 'window')}"
        # Told apart without colour too: robust windows are plain, the others hatched.
        axes.broken_barh(
            bars, (floor, 1.0 - floor), facecolors=_COLORS[verdict], edgecolors="white", linewidths=0,
            hatch=None if verdict is Verdict.ROBUST else "///", label=label,
        )  # fmt: skip
    if floor and shorter is not None:
        for verdict, bars in _bars(shorter).items():
            if verdict is not Verdict.ROBUST:
                count = sum(width for _, width in bars)
                axes.broken_barh(
                    bars, (0, 0.25), facecolors="#9a9a9a", edgecolors="#9a9a9a", linewidths=0.5,
                    label=f"{_WORDS[verdict]}: {counted(count, 'window')} of {counted(shorter.examined, 'step')}",
                )  # fmt: skip
    _legend(axes)
    name = robust(result.r, result.s)
    axes.set_xlabel(f"start of the window: is the union over {counted(result.examined, 'step')} {name}?")


def _bars(result: JointResult) -> dict[Verdict, list[tuple[int, int]]]:
    """Return the starts and the lengths of stretches of windows with the same verdict."""
    runs: dict[Verdict, list[tuple[int, int]]] = {}
    start = 0
    for verdict, run in groupby(result.union_verdicts[union].verdict for union in result.window_unions):
        width = sum(1 for _ in run)
        runs.setdefault(verdict, []).append((start, width))
        start += width
    return runs


def _draw_curve(axes: Axes, curve: Mapping[int, int | None], result: JointResult) -> None:
    reached = {r: window for r, window in curve.items() if window is not None}
    axes.plot(list(reached), list(reached.values()), "o-", color=_COLORS[Verdict.ROBUST])
    axes.set_xlim(0.5, len(curve) + 0.5)
    if len(reached) < len(curve):
        # The values grow with r, so these are the last ones.
        axes.axvspan(len(reached) + 0.5, len(curve) + 0.5, color="#eeeeee", lw=0)
        middle = (len(reached) + 1 + len(curve)) / 2
        axes.annotate("none", (middle, 0.5), xycoords=("data", "axes fraction"), ha="center", va="center")
    if result.tau is not None:
        axes.axhline(result.tau, color="black", lw=0.8, ls="--", label=f"delay bound {result.tau}")
        _legend(axes)
    axes.set_ylim(0, 1.08 * max([1, result.tau or 0, *reached.values()]))
    axes.locator_params(integer=True)
    axes.set_xlabel("r" if result.s == 1 else f"r, with s = {result.s}")
    axes.set_ylabel("smallest window")


def _legend(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize="small", frameon=False)
