"""Robustness seen: a network with the two sets that do not listen, who lies, and the arcs that count."""

from __future__ import annotations

import math
import os
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import networkx as nx
import numpy as np

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import MissingExtra
from robustness.figures.marking import Marks, marks_of
from robustness.figures.naming import are_short, write_names
from robustness.figures.placement import Positions, moved_apart, positions_for, positions_in, scale_of
from robustness.figures.saving import new_figure, save_figure
from robustness.figures.wording import Names, plain
from robustness.showing import Shown
from robustness.spelled import counted
from robustness.time_varying import TimeVaryingGraph

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw", "draw_to_file"]

#: Colour and shape of every set: told apart without colour as well (Okabe and Ito's palette).
_STYLES: Mapping[str, tuple[str, str]] = {
    "S1": ("#56b4e9", "o"),
    "S2": ("#e69f00", "s"),
    "M": ("#d55e00", "D"),
    "lost": ("#ffffff", "p"),
    "rest": ("#d9d9d9", "o"),
}

#: How far arrows bend, as part of their length, so that there and back are two.
_BEND = 0.06

#: Of more nodes only small sets, and few that face each other, are named; small sets are large enough to be found.
_CROWD, _FEW = 300, 30

#: More arcs of one kind are drawn thinner, and more faint ones that run one way without their heads.
_MANY_STRONG, _MANY_ARCS = 60, 1000

_SILENCED, _ADDED, _PLAIN = "#d55e00", "#009e73", "#b8b8b8"

#: Of links that a change of the network is about: the name in Marks, colour, width, style, and what the legend says.
_CHANGED: tuple[tuple[str, str, float, Literal["-", "--"], str], ...] = (
    ("kept", "#404040", 1.8, "-", "link that stays"),
    ("added", _ADDED, 3.4, "-", "link added"),
    ("dropped", _SILENCED, 1.4, "--", "link that can go"),
    ("lost", _SILENCED, 1.8, "--", "link lost"),
)


def draw(
    G: GraphLike | TimeVaryingGraph,
    result_or_attack: Any = None,
    *,
    pos: Mapping[Hashable, Sequence[float]] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a network, and what an answer says about it.

    Parameters
    ----------
    G : networkx Graph or DiGraph, Digraph, or TimeVaryingGraph
        An arc ``(u, v)`` means v hears u. Of a sequence, the union of the window that the answer is about, or of all
        steps.
    result_or_attack : optional
        What to mark: the answer to a question about G (``check_rs_robustness``, ``determine_robustness``,
        ``tolerance``, a joint result, a trap, an attack, an outcome, a mended network), or the sets themselves,
        ``(S1, S2)`` or ``(M, S1, S2)``. S1 and S2 are coloured, the malicious nodes M are red diamonds, and arcs into
        S1 or S2 from outside, the ones that the definition counts, are drawn strong.
    pos : mapping from nodes to pairs of numbers, optional
        Where the nodes stand; by default where the graph's node attributes say (``pos``, ``x`` and ``y``, longitude and
        latitude, as files of yEd, Gephi and topology collections have them), else S1 left and S2 right, or a layout.
    ax : matplotlib axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib axes

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    InvalidGraph, InvalidParameter
        When G is no graph of the definitions, or the answer marks nothing in it.

    See Also
    --------
    robustness.report : a page with many pictures

    Notes
    -----
    Linear in the arcs, once nodes have places.
    """
    picture = _placed(G, result_or_attack, pos)
    if ax is None:
        try:
            from matplotlib import pyplot as plt
        except ImportError:
            raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
        ax = plt.subplots(figsize=picture.size(), layout="constrained")[1]
    picture.draw_on(ax)
    return ax


@dataclass(frozen=True, slots=True)
class _Placed:
    """A network, what is marked in it, and where its nodes stand: as a map or its user says, or by a layout of ours."""

    graph: Digraph
    marks: Marks
    places: Positions
    is_map: bool

    def size(self) -> tuple[float, float]:
        return _size(self.graph, self.places, self.is_map)

    def draw_on(self, axes: Axes) -> None:
        room = _room(_size_around(axes), self.graph, self.marks)
        _draw_on(axes, self.graph, self.marks, self.places, scale_of(self.places, room, self.is_map))
        if not self.is_map:
            # Circles of ours stay circles, in a picture that is filled, so that no node of a flat one is cut off; maps
            # and users' places fill a picture of their shape.
            axes.set_aspect("equal", adjustable="datalim")


def _placed(G: GraphLike | TimeVaryingGraph, answer: Any, pos: Mapping[Hashable, Sequence[float]] | None) -> _Placed:
    drawn = _union_for(G, answer) if isinstance(G, TimeVaryingGraph) else G
    graph = as_digraph(drawn)
    marks, known = marks_of(graph, answer), positions_in(drawn)
    return _Placed(graph, marks, positions_for(graph, marks, pos, known), pos is not None or known is not None)


def _union_for(sequence: TimeVaryingGraph, result: Any) -> GraphLike:
    """Return the union of the window that an answer about a sequence shows, or of all steps."""
    pictured: GraphLike | None = result.pictured() if isinstance(result, Shown) else None
    return sequence.union(0, len(sequence)) if pictured is None else pictured


def draw_to_file(
    G: GraphLike,
    result_or_attack: Any,
    path: str | os.PathLike[str],
    *,
    pos: Mapping[Hashable, Sequence[float]] | None = None,
) -> None:
    """Draw as :func:`draw` does, to a file in the format of its suffix; the same picture gives the same bytes."""
    picture = _placed(G, result_or_attack, pos)
    figure = new_figure(*picture.size())
    picture.draw_on(figure.subplots())
    save_figure(figure, path)


def _size(graph: Digraph, places: Positions, is_map: bool) -> tuple[float, float]:
    """Return the width and height of a picture in inches: the shape of the map or layout, within reason."""
    side = min(5.0 + graph.n / 15, 12.0)
    if len(places) < 2:
        return side * 1.35, side
    across, up = np.ptp(np.array(list(places.values())), axis=0)
    shape = min(max(across / up if up else math.inf, 0.6), 3.0)
    if not is_map:  # drawn true to scale
        return side * 1.35, side * min(1.0, max(0.5, 1.2 / shape))
    return side * max(1.35, shape**0.75) + 0.5, side * min(1.35, shape**-0.25)


def _size_around(axes: Axes) -> tuple[float, float]:
    """Return the width and height in inches of a picture that has axes of this size alone."""
    figure: Any = axes.figure
    extent = axes.get_window_extent().transformed(figure.dpi_scale_trans.inverted())
    return float(extent.width) / 0.775, float(extent.height) / 0.77


def _room(shape: tuple[float, float], graph: Digraph, marks: Marks) -> tuple[float, float]:
    """Return the width and height in inches that the network takes of a picture, beside its legend and margins."""
    named = [_told(name, group) for name, group in _groups(graph, marks) if group]
    told = [*(named if len(named) > 1 else []), *(handle.get_label() for handle in _arc_handles(marks))]
    legend = (45 + 4.8 * max(map(len, told))) / 72 if told else 0.0
    return 0.78 * max(0.3 * shape[0], shape[0] - legend), 0.78 * shape[1]


def _draw_on(axes: Axes, graph: Digraph, marks: Marks, places: Positions, scale: np.ndarray) -> None:
    """Draw arcs first, then nodes, then names, then what everything means; ``scale`` is points a unit, both ways."""
    picture = nx.DiGraph()
    picture.add_nodes_from(range(graph.n))
    picture.add_edges_from(graph.arcs())
    names_of = Names(graph.labels)
    named = [names_of.short(label) for label in graph.labels]
    size = _node_size(places, scale, 25.0 if are_short(named) else 17.0)
    places = moved_apart(places, scale, 1.2 * size**0.5)
    groups = [(name, group) for name, group in _groups(graph, marks) if group]
    arrows = _draw_arcs(axes, picture, graph, marks, places, size)
    # Small sets over large ones, and their names first: in a crowd they are what the picture is about.
    smallest_first = sorted(groups, key=lambda one: len(one[1]))
    largest_first = sorted(groups, key=lambda one: -len(one[1]))
    sizes = {name: _seen(size, graph, group) for name, group in groups}
    drawn = {name: _draw_group(axes, picture, name, group, places, sizes[name]) for name, group in largest_first}
    points = {i: (x * float(scale[0]), y * float(scale[1])) for i, (x, y) in places.items()}
    naming = [group for _, group in smallest_first]
    if graph.n > _CROWD:
        facing = frozenset(node for arc in marks.counted for node in arc)
        naming = [group for group in (*naming, facing) if len(group) <= _FEW]
    names = {i: named[i] for group in naming for i in sorted(group)}
    unnamed = graph.n - len(names)
    unnamed += write_names(axes, names, places, points, _seen(size, graph), list(picture.edges), arrows, _BEND)
    if not graph.n:
        axes.text(0.5, 0.5, "a network without nodes", ha="center", va="center", transform=axes.transAxes)
    if marks.title:
        axes.set_title(plain(marks.title), fontsize=11, wrap=True)
    axes.set_axis_off()
    axes.margins(0.12 if graph.n <= _CROWD else 0.05)
    told = [drawn[name] for name, _ in groups]
    notes = [f"{counted(unnamed, 'name')} left out"] if unnamed else []
    notes += ["grey arcs drawn without heads"] if len(_faint_one_way(picture, marks)) > _MANY_ARCS else []
    _legend(axes, [*(told if len(told) > 1 else []), *_arc_handles(marks), *map(_note, notes)])


def _node_size(places: Positions, scale: np.ndarray, largest: float) -> float:
    """Return the area of a node in square points, not wider than ``largest``: what the places leave room for."""
    is_crowd = len(places) > _CROWD
    least, part = (2.5, 0.5) if is_crowd else (13.4 * min(1.0, (100 / max(len(places), 1)) ** 0.5), 0.8)
    if len(places) < 2:
        return largest**2
    points = np.array([places[i] for i in sorted(places)]) * scale
    near = np.sort(np.hypot(*(points[:, None] - points[None]).T), axis=0)[1]
    # Most nodes get room; the few that lie nearly on top of each other are moved apart.
    return float(min(largest, max(least, part * float(np.quantile(near, 0.2))))) ** 2


def _seen(size: float, graph: Digraph, group: Iterable[int] = ()) -> float:
    """Return the area of a node of a group: in a crowd, those of a small one are large enough to be found."""
    is_small = graph.n > _CROWD and len(frozenset(group)) <= _FEW
    return max(size, 64.0) if is_small else size


def _groups(graph: Digraph, marks: Marks) -> list[tuple[str, frozenset[int]]]:
    rest = frozenset(range(graph.n)) - marks.S1 - marks.S2 - marks.M - marks.lost_nodes
    sides = [("S1", marks.S1 - marks.M), ("S2", marks.S2 - marks.M)]
    return [*sides, ("M", marks.M), ("lost", marks.lost_nodes), ("rest", rest)]


def _draw_group(
    axes: Axes, picture: nx.DiGraph, name: str, group: frozenset[int], places: Positions, size: float
) -> Any:
    """Draw one set of nodes; its return value is what the legend shows."""
    color, shape = _STYLES[name]
    drawn = nx.draw_networkx_nodes(
        picture, places, nodelist=sorted(group), node_color=color, node_shape=shape, node_size=size,
        edgecolors="#404040", linewidths=min(0.8, 0.1 * size**0.5), ax=axes,
    )  # fmt: skip
    drawn.set_label(_told(name, group))
    drawn.set_clip_on(False)  # axes of equal scale may end in the middle of a node
    return drawn


def _told(name: str, group: frozenset[int]) -> str:
    """Return what the legend says of a set of nodes."""
    told = {"M": "M, malicious", "rest": "other"}.get(name, name)
    return f"{told}: {counted(len(group), 'node')}"


def _draw_arcs(
    axes: Axes, picture: nx.DiGraph, graph: Digraph, marks: Marks, places: Positions, size: float
) -> list[tuple[int, int]]:
    """Draw what does not count first and faint, as lines where a link goes both ways; then what does, as arrows.

    Returns the arcs that have heads.
    """
    strong = _strong(marks)
    mutual = [(u, v) for u, v in picture.edges if u < v and picture.has_edge(v, u)]
    both = [(u, v) for u, v in mutual if (u, v) not in strong and (v, u) not in strong]
    single = _faint_one_way(picture, marks)
    width = 1.0 if graph.arc_count <= 400 else 0.4
    bend = f"arc3,rad={_BEND}"
    nx.draw_networkx_edges(
        picture, places, both if len(single) <= _MANY_ARCS else both + single, edge_color=_PLAIN, width=width,
        arrows=False, ax=axes,
    )  # fmt: skip
    single = single if len(single) <= _MANY_ARCS else []
    thick = 2.2 if len(marks.counted) <= _MANY_STRONG else 0.8
    shapes = (
        (single, _PLAIN, width, "solid"),
        ([arc for arc in marks.silenced if arc[1] in marks.S1 | marks.S2], _SILENCED, 1.4, "dotted"),
        ([arc for arc in marks.counted if arc[1] in marks.S1], "#0072b2", thick, "solid"),
        ([arc for arc in marks.counted if arc[1] not in marks.S1], "#b36b00", thick, "solid"),
        *(
            (arcs, color, wide, style)
            for name, color, wide, style, _ in _CHANGED
            for arcs in _both_and_one_way(getattr(marks, name))
        ),
    )
    # The corners of squares and diamonds stick out; heads end before them.
    cornered = marks.S2 | marks.M
    large = {node: _seen(size, graph, group) for _, group in _groups(graph, marks) for node in group}
    ends = [large[node] * (1.7 if node in cornered else 1.0) for node in picture]
    headed: list[tuple[int, int]] = []
    links = {arc for group in _changed(marks) for arc in _both_and_one_way(group)[0]}
    for arcs, color, thick, style in shapes:
        if arcs:
            shape = picture.copy()
            shape.add_edges_from(arcs)
            nx.draw_networkx_edges(
                shape, places, sorted(arcs), edge_color=color, width=thick, style=style, node_size=ends, arrows=True,
                arrowstyle="-" if links.issuperset(arcs) else "-|>", arrowsize=11, connectionstyle=bend, ax=axes,
            )  # fmt: skip
            headed += [] if links.issuperset(arcs) else arcs
    return headed


def _strong(marks: Marks) -> frozenset[tuple[int, int]]:
    return frozenset(marks.counted | marks.silenced).union(*_changed(marks))


def _changed(marks: Marks) -> list[frozenset[tuple[int, int]]]:
    return [getattr(marks, name) for name, *_ in _CHANGED]


def _faint_one_way(picture: nx.DiGraph, marks: Marks) -> list[tuple[int, int]]:
    """Return the arcs that nothing marks and that none ran against before links were added."""
    strong, new = _strong(marks), marks.added
    alone = ((u, v) for u, v in picture.edges if not picture.has_edge(v, u) or (v, u) in new)
    return [arc for arc in alone if arc not in strong]


def _both_and_one_way(arcs: frozenset[tuple[int, int]]) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Return the links that go both ways, each once, which have no heads, and the arcs that none runs against."""
    both = {(u, v) for u, v in arcs if (v, u) in arcs}
    return sorted((u, v) for u, v in both if u < v), sorted(arcs - both)


def _arc_handles(marks: Marks) -> list[Any]:
    """Return what the legend shows for arcs."""
    from matplotlib.lines import Line2D

    rows: tuple[tuple[Any, str, Literal["-", ":", "--"], str], ...] = (
        ([arc for arc in marks.counted if arc[1] in marks.S1], "#0072b2", "-", "into S1 from outside"),
        ([arc for arc in marks.counted if arc[1] not in marks.S1], "#b36b00", "-", "into S2 from outside"),
        (marks.silenced, _SILENCED, ":", "from M: shows each side its own value"),
        *((getattr(marks, name), color, style, told) for name, color, _, style, told in _CHANGED),
    )
    return [Line2D([], [], color=color, ls=style, lw=2, label=text) for arcs, color, style, text in rows if arcs]


def _note(text: str) -> Any:
    """Return a line of the legend that stands for nothing drawn."""
    from matplotlib.lines import Line2D

    return Line2D([], [], ls="", label=text)


def _legend(axes: Axes, handles: list[Any]) -> None:
    """Put what everything means beside the picture, where it covers nothing."""
    from matplotlib.collections import PathCollection

    if handles:
        drawn = axes.legend(
            handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small",
            labelspacing=0.9,
        )  # fmt: skip
        for handle in drawn.legend_handles:
            if isinstance(handle, PathCollection):
                handle.set_sizes([110])
