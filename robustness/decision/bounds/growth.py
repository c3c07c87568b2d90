"""Growth certificates: a small robust seed, and an order in which all other nodes keep the graph robust.

Theorem. Let H be (r,s)-robust and let v hear at least ``r + s - 1`` nodes of H. Then H + v is (r,s)-robust.
(LeBlanc et al. 2013; Lemma 1 (vii) of the source paper states the conclusion for s = 1 only.)

Proof. Take a pair S1, S2 of H + v. If v is in neither set, the condition that held in H still holds: a further node
outside only adds to X. Let v be in S1. If S1 = {v}, then v has r in-neighbours outside it, and X_S1 = S1. Otherwise
the pair S1 - v, S2 of H satisfied a condition, and nothing leaves X_S2 or X_(S1 - v) when v comes. If it was the
second or the third, it still holds. If it was the first, all of S1 - v is in X_S1; then either v is too, or v has
fewer than r in-neighbours outside S1, hence at least s in S1, and |X_S1| >= s. ∎

Growing is bootstrap percolation with threshold r + s - 1 from the seed; which node joins first does not matter. Arcs
that are not counted do no harm: more in-neighbours only enlarge every X.

The seed itself is proven (r,s)-robust by the degree rule inside it (a complete graph on 2r - 1 nodes, say) or, up to
16 nodes, by all its subsets. For r = s = 1 one node is a seed, because 1-robust means that one node reaches all.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from robustness.decision.algorithms.transform import largest_s
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.evidence import Growth
from robustness.limits import Limits, Steps

__all__ = ["find_growth", "growth_order"]

_WORK_PER_CALL = 20_000_000
#: Of the transform, for each subset and node (measured).
_STEPS_TO_EXAMINE = 7
_SEED_LIMIT = 64


def growth_order(graph: Digraph, need: int, seed_ids: Sequence[int]) -> list[int] | None:
    """Return all other nodes so that each hears ``need`` of the seed and of those before it, or None.

    Linear time. That the order proves (r,s)-robustness for need = r + s - 1 takes a seed that is itself (r,s)-robust.

    >>> growth_order(Digraph(range(4), [(0, 2), (1, 2), (1, 3), (2, 3)]), 2, [0, 1])
    [2, 3]
    """
    if graph.n == len(seed_ids):
        return []
    from robustness.decision.bounds.adjacency import adjacency
    from robustness.kernels.passes import grow

    order = np.empty(graph.n, np.int32)
    order[: len(seed_ids)] = seed_ids
    present, heard = np.zeros(graph.n, np.uint8), np.zeros(graph.n, np.int32)
    size = grow(*adjacency(graph)[2:], present, heard, order, len(seed_ids), need)
    return order[len(seed_ids) :].tolist() if size == graph.n else None


def find_growth(graph: Digraph, r: int, s: int = 1, *, steps: Steps | None = None) -> Growth | None:
    """Look for a growth certificate of (r,s)-robustness; None says nothing.

    Parameters
    ----------
    graph : Digraph
    r, s : int
        At least 1.
    steps : Steps, optional
        The budget, after which no further seed is tried; without one it has no end.

    Notes
    -----
    Seeds are dense sets around nodes of high in-degree. A seed whose growth stops short bars its whole growth: a seed
    inside it would grow no further. So all failing growths together take time linear in the arcs times their overlaps.
    Memory is linear in the arcs.

    >>> import networkx as nx
    >>> found = find_growth(Digraph.from_networkx(nx.wheel_graph(6)), 2)
    >>> len(found.seed), found.seed_proof, len(found.order)
    (3, 'degree', 3)
    """
    n, need = graph.n, r + s - 1
    if r < 1 or n < 2 or np.count_nonzero(graph.in_degrees < need) > _SEED_LIMIT:
        return None
    from robustness.decision.bounds.adjacency import adjacency
    from robustness.kernels.passes import forget, grow, mother
    from robustness.kernels.seeds import by_degree, find_seed

    arrays = adjacency(graph)
    order = np.empty(n, np.int32)
    present, heard, barred = np.zeros(n, np.uint8), np.zeros(n, np.int32), np.zeros(n, np.uint8)
    if r == s == 1:
        order[0] = mother(*arrays[2:])
        size = grow(*arrays[2:], present, heard, order, 1, 1)
        return Growth(1, 1, (int(order[0]),), order[1:], "node") if size == n else None
    steps = steps or Steps()
    examine = partial(_is_robust, r, s, steps)
    anchors = np.argsort(-graph.in_degrees, kind="stable").astype(np.int32)
    done, limit = 0, min(n, _SEED_LIMIT, 3 * need + 4)
    while done < n and not steps.over():
        steps.spend(_WORK_PER_CALL)
        tried, size = find_seed(*arrays, anchors[done:], barred, r, s, limit, _WORK_PER_CALL, order, examine)
        done += tried
        if not size:
            continue
        seed = tuple(order[:size].tolist())
        grown = grow(*arrays[2:], present, heard, order, size, need)
        if grown == n:
            complete = by_degree(_rows(graph, seed), size, r)
            return Growth(r, s, seed, order[size:].copy(), "degree" if complete else "exhaustive")
        barred[order[:grown]] = True
        forget(*arrays[2:], present, heard, order, grown)
    return None


def _is_robust(
    r: int, s: int, steps: Steps, hears: npt.NDArray[np.uint64], size: int, pair: npt.NDArray[np.uint64]
) -> bool:
    """Decide for a seed, by all its subsets, whether it is (r,s)-robust; leave a violating pair of it in ``pair``.

    ``hears[i]`` has bit j set when node i of the seed hears node j of it. When the budget is spent, it says no.
    """
    if steps.over():
        return False
    steps.spend(_STEPS_TO_EXAMINE * size << size)
    rows = [int(row) for row in hears[:size]]
    inside = Digraph(range(size), [(j, i) for i, row in enumerate(rows) for j in range(size) if row >> j & 1])
    try:
        greatest, found = largest_s(inside, r, Limits())
    except Undecided:  # no memory for 2^16 bytes
        return False
    if found is None or greatest >= s:
        return True
    pair[0], pair[1] = (sum(1 << i for i in side) for side in found)
    return False


def _rows(graph: Digraph, seed: tuple[int, ...]) -> npt.NDArray[np.uint64]:
    """Return, for each node of the seed, which nodes of the seed it hears, as bits."""
    place = {node: k for k, node in enumerate(seed)}
    rows = np.zeros(len(seed), np.uint64)
    for node, k in place.items():
        rows[k] = sum(1 << place[j] for j in graph.in_neighbours(node).tolist() if j in place)
    return rows
