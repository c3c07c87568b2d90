"""Small graphs as SVG, nodes on a circle: plain text, the same on every machine."""

from __future__ import annotations

import math
from html import escape

from robustness.digraph import Digraph
from robustness.threat_models.results import AttackSets

__all__ = ["svg"]

_SIZE, _RADIUS, _NODE = 240, 88, 15
_COLORS = {"M": "#c0392b", "S1": "#2471a3", "S2": "#1e8449", "": "#5d6d7e"}


def svg(graph: Digraph, sets: AttackSets | None = None) -> str:
    """Return a drawing: an undirected link is a line, an arc ``u -> v`` (v hears u) an arrow; sets have colours."""
    places = [_place(i, graph.n) for i in range(graph.n)]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_SIZE} {_SIZE}" width="{_SIZE}" height="{_SIZE}" '
        'font-family="sans-serif" font-size="13">',
        '<defs><marker id="head" markerWidth="9" markerHeight="9" refX="8" refY="3" orient="auto">'
        '<path d="M0,0 L8,3 L0,6 z" fill="#555"/></marker></defs>',
        f'<rect width="{_SIZE}" height="{_SIZE}" fill="#fff"/>',
    ]
    arcs = set(graph.arcs())
    for u, v in sorted(arcs):
        both = (v, u) in arcs
        if both and u > v:
            continue
        (x1, y1), (x2, y2) = _shortened(places[u], places[v])
        head = "" if both else ' marker-end="url(#head)"'
        lines.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#555"{head}/>')
    for i, (x, y) in enumerate(places):
        color = _COLORS[_set_of(graph, i, sets)]
        lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{_NODE}" fill="{color}"/>')
        label = escape(str(graph.labels[i]))
        lines.append(f'<text x="{x:.1f}" y="{y + 4.5:.1f}" text-anchor="middle" fill="#fff">{label}</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def _place(i: int, n: int) -> tuple[float, float]:
    angle = 2 * math.pi * i / n - math.pi / 2
    return _SIZE / 2 + _RADIUS * math.cos(angle), _SIZE / 2 + _RADIUS * math.sin(angle)


def _shortened(a: tuple[float, float], b: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the line between two nodes without the parts inside them."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = math.hypot(dx, dy)
    kx, ky = dx / length * _NODE, dy / length * _NODE
    return (a[0] + kx, a[1] + ky), (b[0] - kx, b[1] - ky)


def _set_of(graph: Digraph, i: int, sets: AttackSets | None) -> str:
    if sets is None:
        return ""
    named = {"M": sets.M, "S1": sets.S1, "S2": sets.S2}
    return next((name for name, labels in named.items() if graph.labels[i] in labels), "")
