"""The best bounds on r* that cheap techniques give, from both sides."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from robustness.decision.bounds.cuts import closed_pair, degree_pair, separating_pair
from robustness.decision.bounds.degree import degree_bound
from robustness.decision.bounds.growth import find_growth
from robustness.decision.bounds.local_search import TINY, best_upper_bound
from robustness.decision.bounds.spectral import MOST_SPECTRAL_NODES, spectral_bound
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.limits import Steps
from robustness.results import Bound, Bounds, Witness
from robustness.spelled import counted

__all__ = ["all_bounds", "bounds", "quick_bounds"]

#: Up to this many nodes exact search is tried before growth: it settles most of what growth would.
_SMALL = 256

#: The budget of a caller that names none: about a second.
_DEFAULT_STEPS = 1_000_000_000

#: Restarts of the local search that come before anything that costs more.
_FEW_RESTARTS = 4


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
        Of the heuristics: see :func:`robustness.decision.bounds.local_search.find_violation`. The linear-time rules
        always run.
    on_bounds : callable, optional
        Called with every improvement.
    thorough : bool
        Whether to spend on the spectral bound and on a long local search; without it, what takes milliseconds.

    >>> import networkx as nx
    >>> both = bounds(Digraph.from_networkx(nx.complete_graph(5)))
    >>> both.lower.value, both.upper.value
    (3, 3)
    """
    lower, upper = Bounds.trivial(graph).lower, Bounds.trivial(graph).upper
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


#: What a limit that has passed still allows: a few milliseconds.
_QUICK_STEPS = 4_000_000


def quick_bounds(graph: Digraph) -> Bounds:
    """Return what is known of r* in milliseconds: what an answer that a limit stopped is told with.

    Of more than 256 nodes, what the linear-time rules tell.
    """
    found = bounds(graph, steps=Steps(_QUICK_STEPS if graph.n <= _SMALL else 0), thorough=False)
    if 2 <= graph.n <= MOST_SPECTRAL_NODES:
        found = found.met_with(Bounds(spectral_bound(graph), found.upper))
    return found


def all_bounds(graph: Digraph, *, seed: int = 0, steps: Steps | None = None) -> tuple[list[Bound], list[Bound]]:
    """Return every lower and every upper bound on r*, for display; those that say nothing are left out."""
    found = list(_in_turn(graph, seed, steps or Steps(_DEFAULT_STEPS), thorough=True))
    return [b for is_lower, b in found if is_lower and b.value > 0], [b for is_lower, b in found if not is_lower]


def _in_turn(graph: Digraph, seed: int, steps: Steps, thorough: bool) -> Iterator[tuple[bool, Bound]]:
    """Yield ``(is it a lower bound?, bound)``, cheapest techniques first."""
    if graph.n < 2:
        settled = Bounds.by_convention(graph.n)
        yield True, settled.lower
        yield False, settled.upper
        return
    for_growth = steps.left // 10  # of one r
    top = largest_conceivable_r(graph.n)
    yield False, Bounds.trivial(graph).upper
    least = max(1, int(graph.in_degrees.min()))
    pair = degree_pair(graph, least + 1)
    if pair is not None and least < top:
        reason = f"degree: r* <= max(1, min in-degree {int(graph.in_degrees.min())})"
        yield False, Bound(least, reason, Witness.of(graph, pair))
    degree = degree_bound(graph)
    yield True, degree
    pair = closed_pair(graph)
    if pair is not None:
        yield False, Bound(0, "no node reaches all others", Witness.of(graph, pair))
        return
    yield True, Bound(1, "a node reaches all others")
    if graph.n <= TINY:
        yield True, spectral_bound(graph)
        return
    pair = separating_pair(graph)
    if pair is not None:
        yield False, Bound(1, "a node separates the graph", Witness.of(graph, pair))
        return
    known, upper = max(1, degree.value), min(least, top)
    for restarts in (_FEW_RESTARTS, None) if thorough else (_FEW_RESTARTS,):
        value, found = best_upper_bound(graph, seed=seed, steps=steps, restarts=restarts, lower=known)
        if found is not None and value < upper:
            upper = value
            yield False, Bound(value, "a violating pair found by local search", Witness.of(graph, found))
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
            yield (
                True,
                Bound(
                    known, f"growth: {counted(len(growth.seed), 'robust node')}, then each node hears {known} before it"
                ),
            )
        if thorough and known < upper and graph.n <= MOST_SPECTRAL_NODES:
            spectral = spectral_bound(graph)
            known = max(known, spectral.value)
            yield True, spectral
