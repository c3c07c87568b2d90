"""Formations: where every vehicle wants to be, and the one sign convention of this package.

The source paper writes ``x_i - x_j -> delta_ij`` in one place and ``x_j - x_i -> delta_ij`` in another. Here
``delta_ij`` is **where i wants j, as seen from i**: ``p_j - p_i -> delta_ij``, which is what its control input
(equation 5) drives to zero. A formation is given by offsets ``d_i`` with ``delta_ij = d_j - d_i``.

*Aligned* positions. With ``y_i = p_i - d_i`` the relative position ``p_j - p_i - delta_ij`` is ``y_j - y_i``, and y
moves as p does, because d is constant. So runs are simulated in y, and only recorded trajectories add d: a split is
exact in any formation, also where ``p_j - p_i - delta_ij`` would be rounded.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation.dynamics import Floats

__all__ = ["node_offsets", "offsets_from_deltas"]

_RELATIVE_ERROR = 1e-9


def node_offsets(graph: Digraph, offsets: Mapping[Hashable, float] | None) -> Floats:
    """Return ``d_i`` for every id, shape ``(n,)``; vehicles that are not named get 0."""
    result = np.zeros(graph.n)
    for label, value in (offsets or {}).items():
        (i,) = graph.ids([label])
        if not np.isfinite(value):
            raise InvalidParameter(f"an offset is a finite number, not {value} at {label!r}")
        result[i] = value
    return result


def offsets_from_deltas(graph: Digraph, deltas: Mapping[tuple[Hashable, Hashable], float]) -> dict[Hashable, float]:
    """Return offsets ``d`` with ``deltas[i, j] = d_j - d_i`` for every pair given, or refuse.

    Parameters
    ----------
    graph : Digraph
    deltas : mapping
        ``(i, j) -> delta_ij``: where i wants j, relative to itself. Pairs need not be arcs.

    Returns
    -------
    dict
        One offset per node; 0 at the first node of each group of nodes that the pairs connect.

    Raises
    ------
    InvalidParameter
        When the pairs contradict each other: around some cycle the deltas do not add up to 0 (in particular
        ``delta_ij != -delta_ji``), so no formation has them. Compared to a relative 1e-9.

    Notes
    -----
    Linear in the pairs (one walk over them).

    >>> line = Digraph("abc", [])
    >>> offsets_from_deltas(line, {("a", "b"): 2.0, ("b", "c"): 3.0, ("c", "a"): -5.0})
    {'a': 0.0, 'b': 2.0, 'c': 5.0}
    """
    links: dict[int, list[tuple[int, float]]] = {i: [] for i in range(graph.n)}
    for (near, far), delta in deltas.items():
        (i,), (j,) = graph.ids([near]), graph.ids([far])
        links[i].append((j, float(delta)))
        links[j].append((i, -float(delta)))
    scale = max((abs(float(delta)) for delta in deltas.values()), default=0.0)
    found: dict[int, float] = {}
    for root in range(graph.n):
        if root in found:
            continue
        found[root] = 0.0
        pending = [root]
        while pending:
            i = pending.pop()
            for j, delta in links[i]:
                if j not in found:
                    found[j] = found[i] + delta
                    pending.append(j)
                elif not abs(found[i] + delta - found[j]) <= _RELATIVE_ERROR * max(scale, 1.0):
                    raise InvalidParameter(
                        f"formation offsets add up to 0 around every cycle, but delta from {graph.labels[i]!r} to "
                        f"{graph.labels[j]!r} is {delta} and the others make it {found[j] - found[i]}: correct one"
                    )
    return {graph.labels[i]: found[i] for i in range(graph.n)}
