"""Violating pairs by heuristics: upper bounds on r* and on s_max(r), each a pair anybody can check.

Nothing here proves robustness. A pair found is counted again by the definition before it is returned. Finding the
pair for r* + 1 first is what lets exact search concentrate on refuting a single r.

What is tried, cheapest first: the smallest in-degree; two sets that hear nobody outside (exact for r = 1); cuts of a
few node orders, peeled to their cores; small sets around nodes of low in-degree; tabu search
(:mod:`robustness.kernels.tabu`) from these cuts, from random halves and from breadth-first balls.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from robustness.decision.bounds.cuts import at_once
from robustness.definitions import half_split
from robustness.digraph import Digraph
from robustness.evidence import Pair
from robustness.limits import Steps

if TYPE_CHECKING:
    from robustness.decision.bounds.adjacency import Adjacency

__all__ = ["Target", "best_upper_bound", "fewest_exempt", "find_violation"]

#: Up to this many nodes heuristics are left out: exact search is instant there.
TINY = 12
_CLUMP = 24
#: Of one tabu search: moves for each node, and the steps that a moved node stays at least, by turns. For s = 1 found by
#: trial: with 20 moves and three steps pairs of random 10-regular graphs took twice (n = 110) and four times (n = 160)
#: as long on average; dense graphs hardly notice.
_MOVES, _TENURES = 50, (1, 2)
_MOVES_WITH_EXEMPT, _TENURES_WITH_EXEMPT = 20, (3,)
#: Passes over the graph that cutting one node order and peeling both sides of eight cuts take, about.
_PASSES_OF_A_CUT = 30


def find_violation(
    graph: Digraph,
    r: int,
    s: int = 1,
    *,
    seed: int = 0,
    steps: Steps | None = None,
    restarts: int | None = None,
) -> Pair | None:
    """Look for a pair that violates (r,s)-robustness; None says nothing.

    Parameters
    ----------
    graph : Digraph
    r, s : int
        r >= 1 and 1 <= s <= n.
    seed : int
        Of every random choice.
    steps : Steps, optional
        The budget, after which no further attempt starts; without one it has no end. Unless its ``stop`` cuts the
        search short, the result depends on the graph, the seed and the budget alone.
    restarts : int, optional
        At most this many tabu searches of 50 n moves (20 n for s > 1); n by default, so that small graphs cost little.

    Returns
    -------
    Pair or None
        Ids of S1 and S2, checked.

    Notes
    -----
    An attempt costs about ``O((n + m) + n d^2)`` for degree d, memory ``O(n + m)``.

    >>> import networkx as nx
    >>> find_violation(Digraph.from_networkx(nx.star_graph(3)), 2)
    Pair(first=frozenset({1}), second=frozenset({0, 2, 3}))
    """
    if graph.n < 2 or r < 1:
        return None
    pair = at_once(graph, r)
    if pair is not None:
        return pair
    if graph.n <= TINY:
        return None
    search = _Search.of(graph, seed, steps or Steps())
    found = search.pair(r, s, restarts)
    return None if found is None else search.checked(found, r, s)


def best_upper_bound(
    graph: Digraph,
    *,
    seed: int = 0,
    steps: Steps | None = None,
    restarts: int | None = None,
    lower: int = 0,
    on_pair: Callable[[int, Pair], None] | None = None,
) -> tuple[int, Pair | None]:
    """Return ``(u, pair)`` with r* <= u, where ``pair`` violates (u + 1, 1); lowered while pairs are found.

    Parameters
    ----------
    graph, seed, steps, restarts
        As for :func:`find_violation`; ``steps`` is for the whole descent.
    lower : int
        A proven lower bound on r*: the descent ends there.
    on_pair : callable, optional
        Called with every improvement.

    Notes
    -----
    A pair refutes every r above the largest number of in-neighbours that a node of it has outside its
    side, so one pair often lowers the bound by several. On fewer than two nodes there is no pair and u = n.

    >>> best_upper_bound(Digraph(range(3), [(0, 1), (1, 2), (2, 0)]))[0]
    1
    """
    if graph.n < 2:
        return graph.n, None
    pair = half_split(graph)
    upper = _most_outside(graph, pair)
    if on_pair is not None:
        on_pair(upper, pair)
    search = None
    while upper > lower:
        found = at_once(graph, upper)
        if found is None and graph.n > TINY:
            search = search or _Search.of(graph, seed, steps or Steps())
            sets = search.pair(upper, 1, restarts)
            found = None if sets is None else search.checked(sets, upper, 1)
        if found is None:
            break
        upper, pair = _most_outside(graph, found), found
        if on_pair is not None:
            on_pair(upper, pair)
    return upper, pair


def fewest_exempt(
    graph: Digraph,
    r: int,
    *,
    seed: int = 0,
    steps: Steps | None = None,
    restarts: int | None = None,
    lower: int = 0,
) -> tuple[int, Pair] | None:
    """Return ``(c, pair)`` with s_max(r) <= c: a pair with ``|X_S1^r| + |X_S2^r| = c``, neither side fully reachable.

    Parameters
    ----------
    graph, r, seed, steps, restarts
        As for :func:`find_violation`; ``steps`` is for the whole descent.
    lower : int
        A proven lower bound on s_max(r): the descent ends there.

    Returns
    -------
    tuple or None
        None when no such pair with c < n was found.
    """
    best: tuple[int, Pair] | None = None
    steps = steps or Steps()
    s = graph.n
    while s > lower:
        pair = find_violation(graph, r, s, seed=seed, steps=steps, restarts=restarts)
        if pair is None:
            break
        s = _exempt(graph, pair, r)
        best = s, pair
    return best


def _outside(graph: Digraph, members: frozenset[int]) -> npt.NDArray[np.int64]:
    """Return how many in-neighbours outside ``members`` every node has; meaningful for its members."""
    outside = np.ones(graph.n, dtype=bool)
    outside[np.fromiter(members, np.int64, len(members))] = False
    return np.bincount(graph.heads[outside[graph.in_indices]], minlength=graph.n)[~outside]


def _most_outside(graph: Digraph, pair: Pair) -> int:
    return max(int(_outside(graph, side).max()) for side in pair)


def _exempt(graph: Digraph, pair: Pair, r: int) -> int:
    return sum(int((_outside(graph, side) >= r).sum()) for side in pair)


class Target(NamedTuple):
    """What :class:`robustness.kernels.tabu.Tabu` looks for, a pair that violates (r,s), and what its states cost.

    Attributes
    ----------
    price : array, shape ``(2, d + 3)``
        What having x - 1 in-neighbours outside costs a plain node (row 0) and an anchor (row 1).
    fee : int
        What a node in neither side costs.
    least : int
        Sides get no smaller.
    """

    r: int
    s: int
    price: npt.NDArray[np.int64]
    fee: int
    least: int


@dataclass(slots=True)
class _Search:
    """One graph's arrays, random generator and limits, for any number of questions about it."""

    graph: Digraph
    arrays: Adjacency
    random: np.random.Generator
    steps: Steps
    orders: list[npt.NDArray[np.int32]] = field(default_factory=list)

    @classmethod
    def of(cls, graph: Digraph, seed: int, steps: Steps) -> _Search:
        from robustness.decision.bounds.adjacency import adjacency

        return cls(graph, adjacency(graph), np.random.default_rng(seed), steps)

    @property
    def size(self) -> int:
        """Nodes and arcs: the steps of one pass over the graph."""
        return self.graph.n + self.graph.arc_count

    def checked(self, sets: tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]], r: int, s: int) -> Pair:
        """Return the sets as a pair, after counting again what the definition asks for."""
        pair = Pair(*(frozenset(np.flatnonzero(side).tolist()) for side in sets))
        exempt = [_outside(self.graph, side) >= r for side in pair]
        if (sets[0] & sets[1]).any() or any(e.all() for e in exempt) or sum(int(e.sum()) for e in exempt) >= s:
            from robustness.errors import InternalError

            raise InternalError(f"local search returned sets that do not violate ({r},{s})-robustness: please report")
        return pair

    def pair(self, r: int, s: int, restarts: int | None) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None:
        """Try everything for (r,s), cheapest first."""
        if r == 1:
            found = self.closed_sets()
            if found is not None or s == 1:
                return found
        cuts = []
        for order in self.node_orders():
            if self.steps.over():
                return None
            self.steps.spend(_PASSES_OF_A_CUT * self.size)
            found, state = self.cut(order, r)
            if found is not None:
                return found
            cuts.append(state)
        return self.clumps(r) or self.tabu(r, s, self.graph.n if restarts is None else restarts, cuts)

    def closed_sets(self) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None:
        """Return two disjoint sets that hear nobody outside, or None when there are none: r = 1, exactly."""
        from robustness.decision.bounds.reaching import two_closed_sets

        return two_closed_sets(self.arrays)

    def node_orders(self) -> Iterator[npt.NDArray[np.int32]]:
        """Yield label order, breadth-first order from a far node, and the order of a smooth function on the nodes."""
        from robustness.kernels.passes import breadth_first, smooth

        arrays, n = self.arrays, self.graph.n
        if not self.orders:
            self.orders.append(np.arange(n, dtype=np.int32))
        yield self.orders[0]
        if len(self.orders) < 2:
            order, size = np.empty(n, np.int32), 0
            for start in (int(self.random.integers(n)), -1):
                seen, size = np.zeros(n, np.uint8), 0
                for node in (start if start >= 0 else int(order[-1]), *range(n)):
                    size = breadth_first(*arrays[2:], node, order, seen, size)
                    if size == n:
                        break
            self.orders.append(order)
        yield self.orders[1]
        if len(self.orders) < 3:
            values = self.random.standard_normal(n)
            passes = max(5, min(100, 100_000_000 // (len(arrays.in_indices) + n)))
            smooth(*arrays, values, passes)
            self.steps.spend(passes * self.size)
            self.orders.append(np.argsort(values, kind="stable").astype(np.int32))
        yield self.orders[2]

    def cut(
        self, order: npt.NDArray[np.int32], r: int
    ) -> tuple[tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None, npt.NDArray[np.int8]]:
        """Cut ``order`` where few nodes are exposed and peel both sides; return a pair or None, and the middle cut."""
        from robustness.kernels.passes import both_cores, sweep

        n = self.graph.n
        first, second = np.empty(n, np.uint8), np.empty(n, np.uint8)
        cuts = np.ones(min(8, n - 1), np.int64)
        sweep(*self.arrays, order, r, cuts)
        state = np.ones(n, np.int8)
        for length in cuts.tolist():
            state[:] = 1
            state[order[:length]] = 0
            if both_cores(*self.arrays, state, r, first, second):
                return (first.view(np.bool_), second.view(np.bool_)), state
        state[:] = 1
        state[order[: int(cuts[len(cuts) // 2])]] = 0
        return None, state

    def clumps(self, r: int) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None:
        """Look for a small non-r-reachable set around nodes of low in-degree."""
        from robustness.kernels.passes import clump, core

        n = self.graph.n
        anchors = np.argsort(self.arrays.in_indptr[1:] - self.arrays.in_indptr[:-1], kind="stable").astype(np.int32)
        members = np.empty(n, np.int32)
        done = 0
        while done < n and not self.steps.over():
            self.steps.spend(min(2000, n - done) * _CLUMP * (self.size // n))
            tried, size = clump(*self.arrays, anchors[done : done + 2000], min(_CLUMP, n - 1), r, members)
            done += tried
            if size:
                first = np.zeros(n, np.uint8)
                first[members[:size]] = 1
                second = 1 - first
                if core(*self.arrays, second, r):
                    return first.view(np.bool_), second.view(np.bool_)
        return None

    def tabu(
        self, r: int, s: int, restarts: int, cuts: list[npt.NDArray[np.int8]]
    ) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]] | None:
        """Run tabu searches from the cuts, random halves and balls."""
        from robustness.kernels.tabu import Tabu

        n = self.graph.n
        first, second = np.empty(n, np.uint8), np.empty(n, np.uint8)
        price = _prices(int(self.graph.in_degrees.max()), r, s)
        # The stop is asked for after every fifty million steps or so.
        degree = self.graph.arc_count // n + 1
        cost = 50 + 20 * degree + degree * degree // 5  # of one move
        length, tenures = (_MOVES * n, _TENURES) if s == 1 else (_MOVES_WITH_EXEMPT * n, _TENURES_WITH_EXEMPT)
        moves = max(100, min(length, 50_000_000 // cost))
        for attempt in range(restarts):
            kind = np.zeros(n, np.int8)
            state = cuts[attempt] if attempt < len(cuts) and s == 1 else self.start(attempt, kind, r, s)
            least = max(1, int(n * (0.4, 0.2, 0.05)[attempt % 3])) if s == 1 else 1
            least = min(least, int((state == 0).sum()), int((state == 1).sum()))
            fee = (2, 1, 2, 3)[attempt % 4] if s == 1 else (2, 0)[attempt % 2]
            for _ in range(0, length, moves):
                if self.steps.over():
                    return None
                self.steps.spend(moves * cost)
                seed = int(self.random.integers(2**31))
                walk = Tabu(self.arrays, Target(r, s, price, fee, least), state, kind)
                if walk.run(moves, tenures[attempt % len(tenures)], seed, first, second):
                    return first.view(np.bool_), second.view(np.bool_)
        return None

    def start(self, attempt: int, kind: npt.NDArray[np.int8], r: int, s: int) -> npt.NDArray[np.int8]:
        """Return a random half split, or a ball against the rest; for s > 1 with one anchor per side."""
        n = self.graph.n
        if attempt % 3 == 2:
            return self.ball() if s == 1 else self.two_hearths(kind, r)
        state = np.zeros(n, np.int8)
        state[self.random.permutation(n)[: n // 2]] = 1
        if s > 1:
            for wanted in (0, 1):
                kind[self.random.choice(np.flatnonzero(state == wanted))] = 1
        return state

    def ball(self) -> npt.NDArray[np.int8]:
        """Return a breadth-first ball of random size around a random node against the rest."""
        from robustness.kernels.passes import breadth_first

        n = self.graph.n
        order, seen = np.empty(n, np.int32), np.zeros(n, np.uint8)
        size = breadth_first(*self.arrays[:2], int(self.random.integers(n)), order, seen, 0)
        state = np.ones(n, np.int8)
        state[order[: min(size, n - 1, 1 + int(self.random.integers(max(1, n // 2))))]] = 0
        return state

    def two_hearths(self, kind: npt.NDArray[np.int8], r: int) -> npt.NDArray[np.int8]:
        """Return two random anchors, each with as many random in-neighbours on its side as keep it from X."""
        state = np.full(self.graph.n, 2, np.int8)
        anchors = self.random.choice(self.graph.n, 2, replace=False)
        state[anchors], kind[anchors] = (0, 1), 1
        for wanted, anchor in enumerate(anchors.tolist()):
            heard = self.random.permutation(self.graph.in_neighbours(anchor))
            state[heard[state[heard] == 2][: max(0, len(heard) - r + 1)]] = wanted
        return state


def _prices(largest_degree: int, r: int, s: int) -> npt.NDArray[np.int64]:
    """Return the price of :class:`Target`."""
    excess = np.maximum(np.arange(-1, largest_degree + 2) - (r - 1), 0)
    if s == 1:
        return np.stack([excess, 4 * excess])
    concave = np.array([0, 3, 5, 6])
    return np.stack([concave[np.minimum(excess, 3)], 6 * excess])
