"""A run as a short film: vehicles as dots on their lanes, coloured by where they end, and what the liars claim."""

from __future__ import annotations

import html
import os
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from robustness.errors import InvalidParameter, MissingExtra
from robustness.figures.lettering import drawn_with_letters
from robustness.figures.saving import new_figure
from robustness.figures.simulation import GROUP_COLORS, LIAR_COLOR, Run, position_in_words, recorded, run_title
from robustness.figures.time_span import last_step_shown
from robustness.figures.wording import Names
from robustness.files import replace_file
from robustness.natural_order import in_natural_order

__all__ = ["animate", "film_format"]

#: Frames of a film, and frames a second.
_FRAMES, _RATE = 90, 12


def film_format(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a film's path, or raise :class:`InvalidParameter`."""
    suffix = os.path.splitext(os.fspath(path))[1].lower()
    if suffix not in (".gif", ".html"):
        raise InvalidParameter(f"an animation's suffix is .gif or .html, not {suffix!r}")
    return suffix


def animate(run: Run, path: str | os.PathLike[str], *, last_step: int | None = None) -> None:
    """Write a recorded run as an animation: ``.gif``, or ``.html`` with play and pause, in one file without a network.

    Across: the position relative to the moving target. Up: one lane per vehicle. A liar is a cross at what it claims.
    The film ends where a picture does: at ``last_step``, or a while after nothing moves any more.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidParameter
        When the run was not recorded, or the suffix is neither.
    """
    suffix = film_format(path)
    states = recorded(run)
    try:
        from matplotlib.animation import FuncAnimation, PillowWriter
    except ImportError:
        raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
    labels, end = run.scenario.network.union.labels, last_step_shown(run.outcome, last_step)
    steps = np.unique(np.linspace(0, end, _FRAMES).round().astype(int))
    numbered = enumerate(group for _, group in run.outcome.groups)
    colors = {label: GROUP_COLORS[k % len(GROUP_COLORS)] for k, group in numbered for label in group}
    normal = [i for i, label in enumerate(labels) if label not in run.start.malicious]
    bad = [i for i, label in enumerate(labels) if label in run.start.malicious]
    figure = new_figure(7.0, 1.4 + min(0.32 * len(labels), 6.0))
    axes = figure.subplots()
    shown = states.p[: end + 1, normal] if normal else states.p[: end + 1]
    low, high = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
    margin = 0.1 * (high - low) or 1.0
    axes.set_xlim(low - margin, high + margin)
    axes.set_ylim(-0.8, len(labels) + 0.3)  # a lane more for the clock
    in_order, named = in_natural_order(labels), Names(labels)
    axes.set_yticks(range(len(labels)), [named(each) for each in in_order], fontsize=max(4, 9 - len(labels) // 12))
    axes.invert_yaxis()
    lane = np.argsort([labels.index(each) for each in in_order])
    claimed = f"\ncross: what {named.together([labels[i] for i in bad], 4)} claims, at the edge when farther out"
    axes.set_xlabel(position_in_words(run.scenario) + (claimed if bad else ""))
    axes.set_title(run_title(run), fontsize=10, loc="left")
    axes.grid(axis="y", alpha=0.3)
    dots = axes.scatter(states.p[0, normal], lane[normal], c=[colors[labels[i]] for i in normal], s=46, zorder=3)
    crosses = axes.scatter(states.sent[0, bad], lane[bad], marker="x", c=LIAR_COLOR, s=60, zorder=3)
    clock = axes.text(0.99, 0.02, "", transform=axes.transAxes, ha="right", va="bottom", fontsize=9)

    def show(step: int) -> list[Any]:
        dots.set_offsets(np.column_stack([states.p[step, normal], lane[normal]]))
        if bad:
            claims = np.clip(states.sent[step, bad], low - margin, high + margin)
            crosses.set_offsets(np.column_stack([claims, lane[bad]]))
        clock.set_text(f"step {step}")
        return [dots, crosses, clock]

    film = FuncAnimation(figure, show, frames=steps.tolist(), interval=1000 / _RATE, blit=False)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"film{suffix}"
        if suffix == ".gif":
            drawn_with_letters(lambda: film.save(made, writer=PillowWriter(fps=_RATE), dpi=80))
        else:
            made.write_text(_page(film, run), encoding="utf-8")
        replace_file(path, made.read_bytes())


#: matplotlib's player takes the pictures on its buttons from a server; these letters stand for them.
_BUTTONS = {
    "minus": "\u2212", "fast-backward": "|\u25c0", "step-backward": "\u2039", "play fa-flip-horizontal": "\u25c0",
    "pause": "||", "play": "\u25b6", "step-forward": "\u203a", "fast-forward": "\u25b6|", "plus": "+",
}  # fmt: skip

#: For a narrow screen: the picture shrinks, and the slider and the buttons with it.
_STYLE = (
    "body { margin: 0.5rem; } .animation, .animation img { max-width: 100%; height: auto; }"
    " input[type=range].anim-slider { width: 95%; } .anim-buttons button { min-height: 32px; }"
)


def _page(film: Any, run: Run) -> str:
    """Return the film as one page that loads nothing."""
    from matplotlib import rc_context

    with rc_context({"animation.embed_limit": 60.0, "savefig.dpi": 80}):
        player: str = drawn_with_letters(lambda: film.to_jshtml(fps=_RATE, default_mode="once"))
    player = re.sub(r"<link\b[^>]*>", "", player)
    player = re.sub(r'<i class="fa fa-([a-z -]+)"></i>', lambda icon: _BUTTONS.get(icon[1], icon[1]), player)
    title = html.escape(run_title(run))
    return (
        f"<!DOCTYPE html>\n<html lang='en'>\n<meta charset='utf-8'>\n"
        f"<meta name='viewport' content='width=device-width, initial-scale=1'>\n<title>{title}</title>\n"
        f"<link rel='icon' href='data:,'>\n{player}\n<style>{_STYLE}</style>\n</html>\n"
    )
