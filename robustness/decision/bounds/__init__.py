"""Cheap lower and upper bounds on r*, one technique per file, each with its evidence; this front combines them.

Memory is linear in the arcs, except for the spectral bound, which leaves graphs on more than 150 nodes alone. Every
lower bound is a theorem whose hypotheses were checked in integers; every upper bound below ceil(n/2) carries a pair
that was checked against the definition. Nothing here is a guess, whatever the budget.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from robustness.decision.algorithms import Pair
from robustness.decision.bounds.cuts import at_once, closed_pair, degree_pair, half_split, separating_pair
from robustness.decision.bounds.degree import degree_bound, robust_by_degree
from robustness.decision.bounds.growth import Growth, find_growth
from robustness.decision.bounds.local_search import TINY, best_upper_bound, find_violation
from robustness.decision.bounds.spectral import Spectral, spectral_bound, spectral_evidence
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.limits import Steps
from robustness.results import Bound, Bounds, Verdict, Witness

__all__ = ["Growth", "Settled", "Spectral", "all_bounds", "bounds", "settle"]


#: The exact proof of the spectral bound takes milliseconds up to this many nodes, and seconds beyond.
_SPECTRAL_NODES = 150

#: Up to this many nodes exact search is tried before growth: it settles most of what growth would.
_SMALL = 256

#: The budget of a caller that names none: about a second.
_DEFAULT_STEPS = 1_000_000_000

#: Restarts of the local search that come before anything that costs more.
_FEW_RESTARTS = 4


@dataclass(frozen=True, slots=True)
class Settled:
    """A question that a bound alone decided.

    Attributes
    ----------
    verdict : Verdict
        ROBUST or NOT_ROBUST.
    rule : str
        In words, for the user.
    pair : Pair or None
        The violating pair of a NOT_ROBUST.
    evidence : Growth, Spectral, ``"degree"`` or None
        What a certificate of a ROBUST can carry; ``"degree"`` needs no data.
    """

    verdict: Verdict
    rule: str
    pair: Pair | None = None
    evidence: Growth | Spectral | str | None = None


def settle(
    graph: Digraph,
    r: int,
    s: int = 1,
    *,
    seed: int = 0,
    steps: Steps | None = None,
) -> Settled | None:
    """Decide (r,s)-robustness by bounds alone, or return None.

    Parameters
    ----------
    graph : Digraph
        With n >= 2; the front settles the rest by convention.
    r, s : int
        At least 1.
    seed, steps
        Of the heuristics: see :func:`robustness.decision.bounds.local_search.find_violation`. The linear-time
        rules always run.

    Notes
    -----
    Time and memory linear in the arcs before the heuristics, which keep to the budget of steps.

    >>> import networkx as nx
    >>> settle(Digraph.from_networkx(nx.star_graph(4)), 2).rule
    'a node hears 1 < 2 nodes'
    """
    pair = at_once(graph, r)
    if pair is not None:
        least = int(graph.in_degrees.min())
        half = r > largest_conceivable_r(graph.n)
        return Settled(Verdict.NOT_ROBUST, "r* <= ceil(n/2)" if half else f"a node hears {least} < {r} nodes", pair)
    if robust_by_degree(graph, r):
        return Settled(Verdict.ROBUST, "degree rule", evidence="degree")
    if r == 1:
        pair = closed_pair(graph)
        if pair is not None:
            return Settled(Verdict.NOT_ROBUST, "two sets hear nobody outside", pair)
    if graph.n <= TINY:
        return None
    steps = steps or Steps(_DEFAULT_STEPS)
    growth = find_growth(graph, r, s, steps=steps.part(steps.left // 3))
    if growth is not None:
        return Settled(Verdict.ROBUST, f"growth from {len(growth.seed)} nodes", evidence=growth)
    spectral = spectral_evidence(graph) if graph.n <= _SPECTRAL_NODES else None
    if spectral is not None and spectral.r >= r + s - 1:
        return Settled(Verdict.ROBUST, f"lambda_2 > {spectral.mu}", evidence=spectral)
    if r == 2:
        pair = separating_pair(graph)
        if pair is not None:
            return Settled(Verdict.NOT_ROBUST, "a node separates the graph", pair)
    pair = find_violation(graph, r, s, seed=seed, steps=steps.part(steps.left // 2), restarts=_FEW_RESTARTS)
    return None if pair is None else Settled(Verdict.NOT_ROBUST, "local search", pair)


def bounds(
    graph: Digraph,
    *,
    seed: int = 0,
    steps: Steps | None = None,
    on_bounds: Callable[[Bounds], None] | None = None,
    thorough: bool = True,
) -> Bounds:
    """Return the best lower and upper bound on r* that cheap techniques give.

    Parameters
    ----------
    graph : Digraph
    seed, steps
        As for :func:`settle`.
    on_bounds : callable, optional
        Called with every improvement.
    thorough : bool
        Whether to spend on the spectral bound and on a long local search; without it, what takes milliseconds.

    >>> import networkx as nx
    >>> both = bounds(Digraph.from_networkx(nx.complete_graph(5)))
    >>> both.lower.value, both.upper.value
    (3, 3)
    """
    lower, upper = Bound(0, "every graph is 0-robust"), Bound(largest_conceivable_r(graph.n), "r* <= ceil(n/2)")
    for is_lower, bound in _in_turn(graph, seed, steps or Steps(_DEFAULT_STEPS), thorough):
        if is_lower and bound.value > lower.value:
            lower = bound
        elif not is_lower and (bound.value < upper.value or (bound.value == upper.value and upper.witness is None)):
            upper = bound
        else:
            continue
        if on_bounds is not None:
            on_bounds(Bounds(lower, upper))
        if lower.value == upper.value and (upper.witness is not None or graph.n < 2):
            break
    return Bounds(lower, upper)


def all_bounds(graph: Digraph, *, seed: int = 0, steps: Steps | None = None) -> tuple[list[Bound], list[Bound]]:
    """Return every lower and every upper bound on r*, for display; those that say nothing are left out."""
    found = list(_in_turn(graph, seed, steps or Steps(_DEFAULT_STEPS), thorough=True))
    return [b for is_lower, b in found if is_lower and b.value > 0], [b for is_lower, b in found if not is_lower]


def _in_turn(graph: Digraph, seed: int, steps: Steps, thorough: bool) -> Iterator[tuple[bool, Bound]]:
    """Yield ``(is it a lower bound?, bound)``, cheapest techniques first."""
    if graph.n < 2:
        settled = Bound(graph.n, "by convention for fewer than two nodes")
        yield True, settled
        yield False, settled
        return
    for_growth = steps.left // 10  # of one r
    top = largest_conceivable_r(graph.n)
    yield False, Bound(top, "r* <= ceil(n/2)", _witness(graph, half_split(graph)))
    least = max(1, int(graph.in_degrees.min()))
    pair = degree_pair(graph, least + 1)
    if pair is not None and least < top:
        reason = f"degree: r* <= max(1, min in-degree {int(graph.in_degrees.min())})"
        yield False, Bound(least, reason, _witness(graph, pair))
    degree = degree_bound(graph)
    yield True, degree
    pair = closed_pair(graph)
    if pair is not None:
        yield False, Bound(0, "no node reaches all others", _witness(graph, pair))
        return
    yield True, Bound(1, "a node reaches all others")
    if graph.n <= TINY:
        yield True, spectral_bound(graph)
        return
    pair = separating_pair(graph)
    if pair is not None:
        yield False, Bound(1, "a node separates the graph", _witness(graph, pair))
        return
    known, upper = max(1, degree.value), min(least, top)
    for restarts in (_FEW_RESTARTS, None) if thorough else (_FEW_RESTARTS,):
        value, found = best_upper_bound(graph, seed=seed, steps=steps, restarts=restarts, lower=known)
        if found is not None and value < upper:
            upper = value
            yield False, Bound(value, "a violating pair found by local search", _witness(graph, found))
        if restarts is None:
            return
        while (thorough or graph.n > _SMALL) and known < upper and not steps.over():
            allowed = steps.part(for_growth)
            before = allowed.left
            growth = find_growth(graph, known + 1, steps=allowed)
            steps.spend(before - allowed.left)
            if growth is None:
                break
            known += 1
            yield True, Bound(known, f"growth: {len(growth.seed)} robust nodes, then each node hears {known} before it")
        if thorough and known < upper and graph.n <= _SPECTRAL_NODES:
            spectral = spectral_bound(graph)
            known = max(known, spectral.value)
            yield True, spectral


def _witness(graph: Digraph, pair: Pair) -> Witness:
    return Witness(graph.labels_of(pair.first), graph.labels_of(pair.second))
