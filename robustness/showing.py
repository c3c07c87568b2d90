"""What answers about a graph have in common: they are told, and drawn with the graph that they carry.

What draws them, :mod:`robustness.figures`, is built upon the answers; it is imported when something is drawn.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING

from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.told import Told, drawing, small_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Shown", "ShownOverTime"]


class Shown(Told):
    """An answer that can be printed, drawn, and looked at in a notebook.

    Subclasses have ``summary()`` and ``as_dict()``, and may have ``pictured()`` and ``evidence()``.
    """

    __slots__ = ()

    def pictured(self) -> GraphLike | None:
        """Return the graph that the answer is about, or None when it does not carry one."""
        return getattr(self, "graph", None)

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
        axes: Axes = drawing("network").draw(graph, self, pos=pos, ax=ax)
        return axes

    def _small_picture(self) -> str:
        graph = self.pictured()
        return "" if graph is None else small_picture(as_digraph(graph).n, lambda axes: self.plot(ax=axes))


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
        axes: Axes = drawing("simulation").draw_outcome(self, ax, last_step=last_step)
        return axes
