"""The picture of joint robustness: the steps, which windows fail, and the smallest window against r."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import TYPE_CHECKING, Any

from robustness.errors import InvalidParameter, MissingExtra
from robustness.results import Verdict
from robustness.time_varying import JointResult, TimeVaryingGraph, Violation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_joint"]

#: Told apart without colour too: the marks of failing windows are drawn taller. What comes later lies on top.
_COLORS = {Verdict.ROBUST: "#3b7dbd", Verdict.UNDECIDED: "#9a9a9a", Verdict.NOT_ROBUST: "#c8402f"}

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

    Above: the arcs of every stored step, with the steps of the first failing window shaded. Below: one mark at the
    start of every window that was decided, red and tall where its union fails. With a ``curve`` (as from
    :func:`~robustness.time_varying.joint_curve`) a third panel shows the smallest window length for every r, and
    ``result.tau``.

    Parameters
    ----------
    result : JointResult
        The answer: the title.
    shown : JointResult, optional
        The one whose windows are drawn, ``result`` unless given. At the smallest window length nothing fails, so one
        may prefer to see the length below it.

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
    shown = result if shown is None else shown
    rows = 2 if curve is None else 3
    figure = Figure(figsize=(9, 2.3 + 1.7 * rows), layout="constrained")
    figure.suptitle(result.summary() + _tau_text(result))
    panels = figure.subplots(rows, 1, squeeze=False, height_ratios=[2, 1, 2][:rows])[:, 0]
    panels[1].sharex(panels[0])
    _draw_steps(panels[0], sequence, shown.violation)
    _draw_windows(panels[1], shown)
    if curve is not None:
        _draw_curve(panels[2], curve, result)
    # No date and fixed ids: the same question gives the same file.
    from matplotlib import rc_context

    with rc_context({"svg.hashsalt": "robustness"}):
        _save(figure, path)


def _tau_text(result: JointResult) -> str:
    if result.within_tau is None or result.window is None:
        return ""
    return f" ({'within' if result.within_tau else 'longer than'} the delay bound {result.tau})"


def _save(figure: Any, path: str | os.PathLike[str]) -> None:
    suffix = os.path.splitext(os.fspath(path))[1].lower()
    known = sorted(figure.canvas.get_supported_filetypes())
    if suffix.lstrip(".") not in known:
        raise InvalidParameter(f"a picture's suffix is one of {', '.join('.' + one for one in known)}, not {suffix!r}")
    figure.savefig(path, dpi=150, metadata={"Date": None} if suffix == ".svg" else None)


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


def _draw_windows(axes: Axes, result: JointResult) -> None:
    verdicts = [result.union_verdicts[union].verdict for union in result.window_unions]
    axes.set_yticks([])
    axes.set_ylim(0, 1.05)
    if not verdicts:
        axes.annotate("no window was decided", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center")
        axes.set_xlabel("step")
        return
    runs: dict[Verdict, list[tuple[int, int]]] = {verdict: [] for verdict in _COLORS}
    start = 0
    for verdict, run in groupby(verdicts):
        width = sum(1 for _ in run)
        runs[verdict].append((start, width))
        start += width
    for verdict, color in _COLORS.items():
        if runs[verdict]:
            height, outline = (0.5, 0) if verdict is Verdict.ROBUST else (1.0, 1)
            label = f"{_WORDS[verdict]}: {sum(width for _, width in runs[verdict])}"
            axes.broken_barh(
                runs[verdict], (0, height), facecolors=color, edgecolors=color, linewidths=outline, label=label
            )
    _legend(axes)
    name = f"{result.r}-robust" if result.s == 1 else f"({result.r},{result.s})-robust"
    steps = "1 step" if result.examined == 1 else f"{result.examined} steps"
    axes.set_xlabel(f"start of the window: is the union over {steps} {name}?")


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
    axes.set_ylim(bottom=0)
    axes.locator_params(integer=True)
    axes.set_xlabel("r" if result.s == 1 else f"r, with s = {result.s}")
    axes.set_ylabel("smallest window")


def _legend(axes: Axes) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize="small", frameon=False)
