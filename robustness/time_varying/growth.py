"""Robustness that outlives one window: a seed that is robust and an order in which the rest joins it.

By the theorem of :mod:`robustness.decision.bounds.growth` a graph is (r,s)-robust when some node set, the *seed*,
induces an (r,s)-robust graph and the others can be put in an *order* in which each hears at least r + s - 1 nodes of
the seed or before it in the order. Between one window and the next a few arcs come and go, but a seed of
well-connected nodes stays a seed. Here the order is found anew on the marked arcs of the universe, and with it a small
set of arcs that proves it: as long as they stay, nothing has to be looked at again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from robustness.decision.bounds.degree import sufficient_degree
from robustness.digraph import Digraph

__all__ = ["Arcs", "Seed", "find_seed", "grow"]

#: How many nodes, beyond the fewest possible, a seed may have, and from how many nodes one is started.
_SEED_SLACK, _SEED_STARTS = 6, 4

#: Seeds of more nodes are not examined subset by subset in a certificate.
_EXHAUSTIVE_NODES = 16


@dataclass(frozen=True, slots=True)
class Arcs:
    """The arc universe as two arrays of ids, shape ``(arcs,)`` each: arc k is ``(tails[k], heads[k])``."""

    n: int
    heads: npt.NDArray[np.int64]
    tails: npt.NDArray[np.int64]


class Seed:
    """A node set, and for which of its induced graphs (as the arcs come and go) it is known to be robust."""

    def __init__(self, arcs: Arcs, members: npt.NDArray[np.int64], is_robust: Callable[[Digraph], bool]) -> None:
        self.inside = np.zeros(arcs.n, dtype=bool)
        self.inside[members] = True
        self.members = tuple(np.flatnonzero(self.inside).tolist())
        #: Positions in the universe of the arcs between members.
        self.places = np.flatnonzero(self.inside[arcs.heads] & self.inside[arcs.tails])
        self._pairs = list(zip(arcs.tails[self.places].tolist(), arcs.heads[self.places].tolist(), strict=True))
        self._is_robust = is_robust
        self._known: dict[bytes, bool] = {}

    def robust(self, present: npt.NDArray[np.bool_]) -> bool:
        """Return whether the induced graph is proven robust; each distinct one is decided once."""
        marks = present[self.places]
        key = np.packbits(marks).tobytes()
        if key not in self._known:
            self._known[key] = self._is_robust(self._induced(marks))
        return self._known[key]

    def proof(self, present: npt.NDArray[np.bool_], r: int) -> Literal["degree", "exhaustive"] | None:
        """Return what a certificate can say of the induced graph: the degree rule, or few enough nodes to try all."""
        size = len(self.members)
        if self._induced(present[self.places]).in_degrees.min() >= sufficient_degree(size, r):
            return "degree"
        return "exhaustive" if size <= _EXHAUSTIVE_NODES else None

    def _induced(self, marks: npt.NDArray[np.bool_]) -> Digraph:
        return Digraph(self.members, (self._pairs[k] for k in np.flatnonzero(marks).tolist()))


def grow(
    arcs: Arcs, present: npt.NDArray[np.bool_], seed: Seed, need: int, weight: npt.NDArray[np.int64]
) -> tuple[list[int], npt.NDArray[np.int64]] | None:
    """Return the order in which everything joins ``seed``, and the arcs that prove it, or None when something cannot.

    The arcs are those between members of the seed and, for every further node, ``need`` arcs from earlier ones,
    those with the greatest ``weight`` first. Time linear in the arcs, times the rounds of the percolation.
    """
    heads, tails = arcs.heads[present], arcs.tails[present]
    join = np.where(seed.inside, 0, -1)
    heard = np.zeros(arcs.n, dtype=np.int64)
    fresh, order, joined = seed.inside, [], 0
    while fresh.any():
        heard += np.bincount(heads[fresh[tails]], minlength=arcs.n)
        joined += 1
        fresh = (join < 0) & (heard >= need)
        join[fresh] = joined
        order += np.flatnonzero(fresh).tolist()
    if (join < 0).any():
        return None
    useful = np.flatnonzero(present & (join[arcs.tails] < join[arcs.heads]))
    useful = useful[np.lexsort((-weight[useful], arcs.heads[useful]))]
    first = np.searchsorted(arcs.heads[useful], arcs.heads[useful])
    chosen = useful[np.arange(len(useful)) - first < need]
    core = np.concatenate([seed.places[present[seed.places]], chosen])
    return order, core


def find_seed(
    arcs: Arcs, present: npt.NDArray[np.bool_], r: int, s: int, is_robust: Callable[[Digraph], bool]
) -> Seed | None:
    """Return a small seed of the graph marked by ``present`` from which everything grows, or None if none shows up.

    A heuristic: from a few nodes of high degree, always add the node with the most arcs from and to the set; from
    ``2r - 1`` nodes on (fewer are never r-robust, as r* <= ceil(n/2)) see whether it percolates and is robust.
    """
    heads, tails = arcs.heads[present], arcs.tails[present]
    degree = np.bincount(heads, minlength=arcs.n) + np.bincount(tails, minlength=arcs.n)
    fewest = max(2 * r - 1, s, 1)
    for start in np.argsort(-degree, kind="stable")[:_SEED_STARTS]:
        members = [int(start)]
        links = np.zeros(arcs.n, dtype=np.int64)
        while len(members) < min(arcs.n - 1, fewest + _SEED_SLACK):
            newest = members[-1]
            links += np.bincount(heads[tails == newest], minlength=arcs.n)
            links += np.bincount(tails[heads == newest], minlength=arcs.n)
            links[members] = -1
            members.append(int(np.argmax(links * (2 * len(present) + 1) + degree)))
            if len(members) >= fewest:
                seed = Seed(arcs, np.array(members), is_robust)
                if grow(arcs, present, seed, r + s - 1, np.zeros(len(present), np.int64)) and seed.robust(present):
                    return seed
    return None
