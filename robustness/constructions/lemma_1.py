"""Lemma 1 of the source paper, and what the paper says beside it, as executable statements.

A :class:`Statement` takes a graph and returns why the graph refutes it, or None. Nothing is assumed to behave alike
for graphs and digraphs. Lemma 1 is stated for an (r,s)-robust graph on n > 1 nodes; ``T[r]`` below is its profile
s_max(r), so that (r,s)-robust means ``s <= T[r]``, for s in 1..n. (The paper's definition asks for r, s < n but item
(v) lets s be n. Nothing hangs on it: a pair that violates (r,n) leaves a node of either side unreached, so it
violates (r,n-1) too.)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from robustness.connectivity import smallest_separation
from robustness.constructions.small_graphs import Batch, batch_profiles, batch_s_max
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.spelled import counted

__all__ = ["STATEMENTS", "Statement", "profile"]


@dataclass(frozen=True, slots=True)
class Statement:
    """One claim about every graph on at least two nodes.

    Attributes
    ----------
    item : str
        Where it stands: ``"(vi)"``, or a remark's place.
    text : str
        The claim, in our words.
    refute : callable
        Takes a graph on at least two nodes and returns in what way it is a counterexample, or None.
    is_paper : bool
        Whether the paper says so; otherwise it is a correction, a strengthening, or a converse.
    has_choices : bool
        Whether it tries exponentially many changes of each graph, so that large graphs take long.
    """

    item: str
    text: str
    refute: Callable[[Digraph], str | None]
    is_paper: bool = True
    has_choices: bool = False


def profile(graph: Digraph) -> list[int]:
    """Return ``[n, s_max(1), ..., s_max(ceil(n/2))]``."""
    row: list[int] = batch_profiles(np.array([graph.in_masks], dtype=np.int64))[0].tolist()
    return row


def _smaller_pairs(graph: Digraph) -> str | None:
    T = profile(graph)
    return next((f"T = {T}" for r in range(1, len(T)) if T[r] > T[r - 1]), None)


def _one_r_for_one_s(graph: Digraph) -> str | None:
    T, n = profile(graph), graph.n
    return next((f"T = {T}" for r in range(1, len(T)) if T[r] and T[r - 1] < min(T[r] + 1, n)), None)


def _connected(graph: Digraph) -> str | None:
    r = _largest_r(graph)
    found = smallest_separation(graph, r)
    if found is None and r < graph.n:
        return None
    return f"{r}-robust, but removing {counted(len(found.separator) if found else 0, 'node')} disconnects it"


def _connected_is_robust(graph: Digraph) -> str | None:
    r = _largest_r(graph) + 1
    is_connected = r < graph.n and smallest_separation(graph, r) is None
    return f"{r}-connected, but not {r}-robust" if is_connected else None


def _rooted_after_removals(graph: Digraph) -> str | None:
    r = _largest_r(graph)
    for size in range(r):
        for removed in combinations(range(graph.n), size):
            if not _has_spanning_tree(graph.without(frozenset(removed))):
                return f"{r}-robust, but without {set(removed)} no node reaches all"
    return None


def _spanning_tree(graph: Digraph) -> str | None:
    return "(0,1)-robust, as every graph is, but no node reaches all" if not _has_spanning_tree(graph) else None


def _spanning_tree_from_one(graph: Digraph) -> str | None:
    if (_largest_r(graph) >= 1) == _has_spanning_tree(graph):
        return None
    return f"r* = {_largest_r(graph)}, spanning tree: {_has_spanning_tree(graph)}"


def _at_most_half(graph: Digraph) -> str | None:
    r = largest_conceivable_r(graph.n) + 1
    return f"{r}-robust" if batch_s_max(_batch(graph), r)[0] else None


def _complete(graph: Digraph) -> str | None:
    if graph.arc_count < graph.n * (graph.n - 1):
        return None
    T = profile(graph)
    return None if T == [graph.n] * len(T) else f"T = {T}"


def _remove_in_arcs(graph: Digraph) -> str | None:
    """Every set of links is removed; w is the most that one node loses."""
    T, links = profile(graph), _links(graph)
    choices = np.arange(1 << len(links))
    batch = np.repeat(_batch(graph), len(choices), axis=0)
    for place, (u, v) in enumerate(links):
        gone = choices >> place & 1
        batch[:, v] ^= gone << u
        if not graph.directed:
            batch[:, u] ^= gone << v
    lost = (graph.in_degrees - np.bitwise_count(batch)).max(axis=1)
    left = batch_profiles(batch)
    for r in range(1, len(T)):
        for w in range(r):
            if T[r] and (left[lost <= w, r - w] < T[r]).any():
                return f"({r},{T[r]})-robust, and removing {w} in-arcs per node leaves less than ({r - w},{T[r]})"
    return None


def _add_node(graph: Digraph, degree: Callable[[int, int], int], promise: Callable[[int, int], int]) -> str | None:
    """Add a node in every way with in-degree at least ``degree(r, s)``; (r, ``promise(r, s)``) is expected."""
    T, n = profile(graph), graph.n
    hears = np.repeat(np.arange(1 << n), 1 << n if graph.directed else 1)
    heard_by = np.tile(np.arange(1 << n), 1 << n) if graph.directed else hears
    batch = np.zeros((len(hears), n + 1), dtype=np.int64)
    batch[:, :n] = _batch(graph) | (heard_by[:, None] >> np.arange(n) & 1) << n
    batch[:, n] = hears
    bigger, in_degree = batch_profiles(batch), np.bitwise_count(hears)
    for r in range(1, len(T)):
        for s in range(1, T[r] + 1):
            bad = (in_degree >= degree(r, s)) & (bigger[:, r] < promise(r, s))
            if bad.any():
                d = int(in_degree[bad][0])
                return f"({r},{s})-robust, and a node of in-degree {d} makes it not ({r},{promise(r, s)})-robust"
    return None


def _from_larger_r(graph: Digraph) -> str | None:
    T = profile(graph)
    for r, s in product(range(1, len(T)), range(1, graph.n + 1)):
        if r + s - 1 < len(T) and T[r + s - 1] and T[r] < s:
            return f"{r + s - 1}-robust, but not ({r},{s})-robust"
    return None


def _to_larger_r(graph: Digraph) -> str | None:
    T, r_star = profile(graph), _largest_r(graph)
    pairs = ((r, s) for r in range(1, len(T)) for s in range(1, T[r] + 1))
    return next((f"({r},{s})-robust, but not {r + s - 1}-robust" for r, s in pairs if r + s - 1 > r_star), None)


def _least_degree(graph: Digraph, least_r: int = 1) -> str | None:
    r, d = _largest_r(graph), int(graph.in_degrees.min())
    return f"{r}-robust, but the least in-degree is {d}" if r >= least_r and d < r else None


def _only_complete(graph: Digraph) -> str | None:
    if graph.n % 2 == 0 or _largest_r(graph) < largest_conceivable_r(graph.n) or graph.n < 3:
        return None
    missing = graph.n * (graph.n - 1) - graph.arc_count
    return f"{_largest_r(graph)}-robust with {counted(missing, 'arc')} missing" if missing else None


def _normal_part(graph: Digraph) -> str | None:
    T = profile(graph)
    for f in range(1, len(T) - 1):
        if T[f + 1] < f + 1:
            continue
        for size in range(1, min(f, graph.n - 2) + 1):
            for removed in combinations(range(graph.n), size):
                left = profile(graph.without(frozenset(removed)))
                if left[1] < min(f + 1, graph.n - size):
                    return f"({f + 1},{f + 1})-robust, but without {set(removed)} not (1,{f + 1})-robust"
    return None


def _keeps(degree: Callable[[int, int], int], promise: Callable[[int, int], int]) -> Callable[[Digraph], str | None]:
    return lambda graph: _add_node(graph, degree, promise)


#: In the order of the lemma.
STATEMENTS: tuple[Statement, ...] = (
    Statement("(i)", "(r,s)-robust implies (r',s')-robust for r' <= r and s' <= s", _smaller_pairs),
    Statement(
        "(ii)", "(r,s)-robust implies (r-1,s+1)-robust (s+1 read as n where it would exceed n)", _one_r_for_one_s
    ),
    Statement("(iii)", "(r,s)-robust implies at least r-connected", _connected),
    Statement(
        "(iii)", "(r,s)-robust implies: without any r-1 nodes, some node reaches all", _rooted_after_removals, False
    ),
    Statement("(iii)", "r-connected implies r-robust; the paper says that it does not", _connected_is_robust, False),
    Statement("(iv)", "(r,s)-robust implies a directed spanning tree, r >= 0 as in (i)", _spanning_tree),
    Statement("(iv)", "1-robust if and only if there is a directed spanning tree", _spanning_tree_from_one, False),
    Statement("(v)", "(r,s)-robust implies r <= ceil(n/2)", _at_most_half),
    Statement("(v)", "K_n is (r,s)-robust for 0 < r <= ceil(n/2), 1 <= s <= n", _complete),
    Statement("(vi)", "losing at most w < r in-arcs per node leaves (r-w,s)-robust", _remove_in_arcs, True, True),
    Statement(
        "(vii)",
        "a new node of in-degree >= r+s-1 leaves r-robust",
        _keeps(lambda r, s: r + s - 1, lambda r, s: 1),
        True,
        True,
    ),
    Statement(
        "(vii)",
        "a new node of in-degree >= r+s-1 leaves (r,s)-robust",
        _keeps(lambda r, s: r + s - 1, lambda r, s: s),
        False,
        True,
    ),
    Statement(
        "(vii)", "a new node of in-degree >= r leaves r-robust", _keeps(lambda r, s: r, lambda r, s: 1), False, True
    ),
    Statement(
        "(vii)",
        "a new node of in-degree >= max(r, r+s-2) leaves (r,s)-robust",
        _keeps(lambda r, s: max(r, r + s - 2), lambda r, s: s),
        False,
        True,
    ),
    Statement("last line", "(r+s-1)-robust implies (r,s)-robust", _from_larger_r),
    Statement("last line", "(r,s)-robust implies (r+s-1)-robust, the converse", _to_larger_r, False),
    Statement("Section 3", "r-robust implies every in-degree >= r", _least_degree),
    Statement(
        "Section 3", "r-robust with r >= 2 implies every in-degree >= r", lambda graph: _least_degree(graph, 2), False
    ),
    Statement("Section 3.2", "(f+1,f+1)-robust, without at most f nodes, is (1,f+1)-robust", _normal_part),
    Statement("Section 4", "for odd n only K_n is ceil(n/2)-robust; the paper says so for n = 5", _only_complete),
)


def _batch(graph: Digraph) -> Batch:
    return np.array([graph.in_masks], dtype=np.int64)


def _largest_r(graph: Digraph) -> int:
    return sum(s > 0 for s in profile(graph)[1:])


def _links(graph: Digraph) -> list[tuple[int, int]]:
    return [(u, v) for u, v in graph.arcs() if graph.directed or u < v]


def _has_spanning_tree(graph: Digraph) -> bool:
    """Return whether some node reaches all others; the empty graph and one node count as trees."""
    heard_by = [sum(1 << v for v, mask in enumerate(graph.in_masks) if mask >> u & 1) for u in range(graph.n)]
    return graph.n == 0 or any(len(set(_reached(root, heard_by))) == graph.n for root in range(graph.n))


def _reached(root: int, heard_by: list[int]) -> Iterator[int]:
    seen, waiting = 1 << root, [root]
    while waiting:
        node = waiting.pop()
        yield node
        new = heard_by[node] & ~seen
        seen |= new
        waiting += [v for v in range(len(heard_by)) if new >> v & 1]
