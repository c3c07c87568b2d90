"""What every answer has in common when it is shown: one line as text, a picture, and a page of evidence in notebooks.

An answer says what it is about by a few methods. What draws it, :mod:`robustness.figures`, is built upon the answers;
here it is known by name alone, and imported when something is drawn.
"""

from __future__ import annotations

import base64
import html
import importlib
import io
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter, MissingExtra
from robustness.natural_order import in_natural_order

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Shown", "ShownOverTime", "labels_in_words", "listed_in_words"]

#: Larger networks are not drawn in notebooks unless asked for: a picture of them says little and takes long.
_LARGEST = 80

#: Characters of a summary in ``repr``.
_LONGEST = 100

_LEFT = "style='text-align:left'"


def labels_in_words(labels: Iterable[object]) -> str:
    """Return a node set as text, in natural order.

    >>> labels_in_words({"n10", "n2"})
    "{'n2', 'n10'}"
    """
    return listed_in_words(in_natural_order(labels))


def listed_in_words(ordered: Sequence[object], most: int | None = None, spelled: Callable[[object], str] = repr) -> str:
    """Return labels as the text of a set, in their order; of more than ``most`` the others are counted.

    >>> listed_in_words(range(20), 3)
    '{0, 1, 2, … 17 more}'
    """
    shown = ordered if most is None else ordered[:most]
    more = f", … {len(ordered) - len(shown)} more" if len(shown) < len(ordered) else ""
    return "{" + ", ".join(map(spelled, shown)) + more + "}"


class Shown:
    """An answer that can be printed, drawn, and looked at in a notebook.

    Subclasses have ``summary()``, and may have ``pictured()`` and ``evidence()``.
    """

    __slots__ = ()

    if TYPE_CHECKING:

        def summary(self) -> str:
            """Return the answer in plain words."""

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        text = " ".join(self.summary().split())
        if len(text) > _LONGEST:
            text = f"{text[:_LONGEST].rpartition(' ')[0]} …"
        return f"<{type(self).__name__}: {text}>"

    def pictured(self) -> GraphLike | None:
        """Return the graph that the answer is about, or None when it does not carry one."""
        return getattr(self, "graph", None)

    def evidence(self) -> Iterable[tuple[str, str]]:
        """Return the evidence as rows of a name and a text."""
        return ()

    def plot(
        self,
        G: GraphLike | None = None,
        *,
        pos: Mapping[Hashable, Sequence[float]] | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw the graph with what the answer says about it, and return the axes.

        Parameters
        ----------
        G : graph, optional
            The graph to draw, with its node attributes; by default the one that the answer carries.
        pos, ax
            As for :func:`robustness.draw`.

        Raises
        ------
        InvalidParameter
            When neither is there.
        MissingExtra
            When matplotlib is not installed.
        """
        graph = self.pictured() if G is None else G
        if graph is None:
            raise InvalidParameter("this answer carries no graph: pass the one it is about, plot(G)")
        axes: Axes = _drawing("network").draw(graph, self, pos=pos, ax=ax)
        return axes

    def _small_picture(self) -> str:
        """Return a small picture as HTML; empty where there is nothing to draw, or nothing to draw with."""
        graph = self.pictured()
        if graph is None or not 1 <= as_digraph(graph).n <= _LARGEST:
            return ""
        try:
            figure = _drawing("saving").new_figure(6.4, 3.6)
        except MissingExtra:
            return ""
        try:
            self.plot(ax=figure.subplots()).set_title("")
        except InvalidParameter:  # a run that was not recorded
            return ""
        return _as_image(figure)

    def _repr_html_(self) -> str:
        """Render in notebooks: the summary, a small picture, and the evidence to unfold."""
        rows = "".join(
            f"<tr><th {_LEFT}>{html.escape(name)}</th><td {_LEFT}>{html.escape(text)}</td></tr>"
            for name, text in self.evidence()
        )
        folded = f"<details><summary>evidence</summary><table>{rows}</table></details>" if rows else ""
        return f"<div><p>{html.escape(self.summary())}</p>{self._small_picture()}{folded}</div>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": self._repr_html_()}


class ShownOverTime(Shown):
    """A run, which is drawn against time."""

    __slots__ = ()

    def plot(
        self,
        G: GraphLike | None = None,
        *,
        pos: Mapping[Hashable, Sequence[float]] | None = None,
        ax: Axes | None = None,
        last_step: int | None = None,
    ) -> Axes:
        """Draw the run against time, vehicles coloured by the group they end in, and return the axes.

        Parameters
        ----------
        G, pos
            As for other answers: with a graph given, the graph is drawn instead, with the groups that were watched.
        ax : matplotlib axes, optional
        last_step : int, optional
            Where the time axis ends; by default a while after nothing moves any more.

        Raises
        ------
        InvalidParameter
            When the run was not recorded.
        MissingExtra
            When matplotlib is not installed.
        """
        if G is not None:
            return super().plot(G, pos=pos, ax=ax)
        axes: Axes = _drawing("simulation").draw_outcome(self, ax, last_step=last_step)
        return axes


def _drawing(technique: str) -> Any:
    """Return a module of the drawing room."""
    return importlib.import_module(f"robustness.figures.{technique}")


def _as_image(figure: Any) -> str:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=80)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f"<img alt='' src='data:image/png;base64,{data}'/>"
