"""Finding r*, s_max(r*) and whole profiles: bounds from both sides first, then one refutation.

Let c(S1, S2) = |X_S1^r| + |X_S2^r|. By the definition s_max(r) is the least c over the pairs in which neither
side is fully reachable, or n when there is none. So every violating pair found for (r,s) lowers the candidate for
s_max(r) to its own c, and one refutation at that candidate ends the descent.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from robustness.decision.algorithms import Answer, Limits
from robustness.decision.ladder import TRANSFORM_NODES, decide, exempt_count, run, witness_of
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import InternalError, Undecided
from robustness.results import Bound, Bounds, RobustnessResult, Verdict

__all__ = ["determine", "profile"]

#: Seconds that heuristics for bounds on r* may take before the exact search begins.
_HEURISTIC_SECONDS = 0.5

#: Seconds of exact search before bounds that cost more are tried, and once more before local search goes on.
_SHORT_SECONDS = 0.3

#: Seconds of the first turn of searches from below and from above; local search has half as long.
_TURN_SECONDS = 2.0

#: Restarts that only a time limit ends.
_NO_END = 1 << 62

#: Up to this many nodes ``auto`` reads profiles off the subset-minimum transform: seconds.
_TRANSFORM_PROFILE_NODES = 22


@dataclass(slots=True)
class _Work:
    """What all decisions of one determination share: how to decide, and what it has cost so far."""

    graph: Digraph
    algorithm: str
    limits: Limits
    name: str = "transform"
    stats: dict[str, Any] = field(default_factory=dict)

    def decide(self, r: int, s: int) -> Answer:
        """Decide (r,s)-robustness, bounds first; sum counters and remember what decided."""
        self.name, answer = decide(self.graph, r, s, self.algorithm, self.limits, {})
        return self._count(answer)

    def search(self, r: int, s: int) -> Answer:
        """Decide (r,s)-robustness by an exact algorithm, after bounds have said what they can."""
        if self.algorithm != "auto" or self.graph.n <= TRANSFORM_NODES:
            return self.decide(r, s)
        self.name = "subset-search"
        return self._count(run(self.graph, r, s, self.name, self.limits, {}))

    def _count(self, answer: Answer) -> Answer:
        for key, value in answer.stats.items():
            is_count = isinstance(value, int) and not isinstance(value, bool)
            self.stats[key] = self.stats.get(key, 0) + value if is_count else value
        return answer


def determine(
    graph: Digraph,
    algorithm: str,
    limits: Limits,
    s_time_limit: float | None,
    on_bounds: Callable[[Bounds], None] | None,
) -> RobustnessResult:
    """Return the greatest r and s that are proven, as :func:`robustness.determine_robustness` documents."""
    if graph.n < 2:
        settled = Bound(graph.n, "convention for fewer than two nodes")
        bounds = Bounds(settled, settled)
        return RobustnessResult(Verdict.DETERMINED, graph.n, 1, bounds=bounds, algorithm="definition")
    work = _Work(graph, algorithm, limits)
    bounds = _greatest_r(work, on_bounds or (lambda _: None))
    r, witness = bounds.lower.value, bounds.upper.witness
    if r < bounds.upper.value:
        s = 1 if r else graph.n
        return RobustnessResult(
            Verdict.UNDECIDED, r, s, witness, bounds=bounds, algorithm=work.name, stats=work.stats
        )
    if r == 0:
        # Every graph is (0,s)-robust.
        return RobustnessResult(
            Verdict.DETERMINED, 0, graph.n, witness, bounds=bounds, algorithm=work.name, stats=work.stats
        )
    name = work.name
    if s_time_limit is not None:
        work.limits = _until(limits, s_time_limit)
    s_bounds = _greatest_s(work, r, known=1)
    return RobustnessResult(
        Verdict.DETERMINED,
        r,
        s_bounds.lower.value,
        witness,
        bounds=bounds,
        s_bounds=s_bounds,
        algorithm=name,
        stats=work.stats,
    )


def _greatest_r(work: _Work, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Return bounds on r*, equal unless a limit stopped the work.

    Bounds that cost milliseconds come first, then bounds that cost a second, each with a short exact search; then local
    search and exact searches from below and from above in turns, each twice as long as before, until one r is left to
    refute: whichever way a graph is easy, it is decided that way, and a limit leaves a narrow interval.
    """
    graph, limits = work.graph, work.limits
    found = Bounds(Bound(0, "every graph is 0-robust"), Bound(largest_conceivable_r(graph.n), "r* <= ceil(n/2)"))
    if work.algorithm == "auto" and graph.n <= TRANSFORM_NODES:
        found = _read_off(work, found)
    if work.algorithm != "auto" or graph.n <= TRANSFORM_NODES:
        return _descend(work, found, on_bounds)
    from robustness.decision.algorithms.subset_search import MOST_NODES
    from robustness.decision.bounds import bounds

    def report(cheap: Bounds) -> None:
        met = _meet(found, cheap)
        if met != found:
            on_bounds(met)

    for thorough in (False, True):
        cheap = bounds(
            graph,
            seed=limits.seed,
            time_budget=min(_HEURISTIC_SECONDS, limits.seconds_left() / 2),
            stop=limits.expired,
            on_bounds=report,
            thorough=thorough,
        )
        work.name = work.name if work.stats else "bounds"  # a search has counters
        found = _meet(found, cheap)
        work.limits = _until(limits, _SHORT_SECONDS)
        found = _descend(work, found, on_bounds)
    is_last, turn, seconds = False, 0, _TURN_SECONDS
    while found.lower.value < found.upper.value and not is_last and not limits.expired():
        # Which end gives way sooner is not known, so both have their turns, until one r is left.
        turn += 1
        work.limits = limits
        found = _look_for_pairs(work, found, min(seconds / 2, limits.seconds_left() / 4), turn, on_bounds)
        work.limits = _until(limits, min(seconds, limits.seconds_left() / 4))
        found = _climb(work, found, on_bounds)
        is_last = (turn > 1 and found.lower.value + 1 >= found.upper.value) or graph.n > MOST_NODES
        work.limits = limits if is_last else _until(limits, seconds)
        found = _descend(work, found, on_bounds)
        seconds *= 2
    work.limits = limits
    return found


def _until(limits: Limits, seconds: float) -> Limits:
    """Return ``limits`` that end after so many seconds at the latest."""
    ends = time.monotonic() + seconds
    return replace(limits, deadline=ends if limits.deadline is None else min(ends, limits.deadline))


def _look_for_pairs(
    work: _Work, found: Bounds, seconds: float, turn: int, on_bounds: Callable[[Bounds], None]
) -> Bounds:
    """Give local search so many seconds, from other starts each turn, to lower the upper bound."""
    from robustness.decision.bounds.local_search import find_violation

    ends, limits = time.monotonic() + seconds, work.limits
    while found.lower.value < found.upper.value and (left := ends - time.monotonic()) > 0:
        r = found.upper.value
        pair = find_violation(
            work.graph, r, seed=limits.seed + turn, time_budget=left, restarts=_NO_END, stop=limits.expired
        )
        if pair is None:
            break
        witness = witness_of(work.graph, pair)
        found = Bounds(found.lower, Bound(r - 1, "a violating pair found by local search", witness))
        on_bounds(found)
    return found


def _read_off(work: _Work, found: Bounds) -> Bounds:
    """Return bounds from the whole profile; the pair of the upper one is still found and re-checked by a decision."""
    from robustness.decision.algorithms.transform import profile as transform_profile

    try:
        table = transform_profile(work.graph, work.limits)
    except Undecided:
        return found
    r = max((r for r, s in table.items() if s), default=0)
    lower = Bound(r, "transform refuted every violating pair") if r else found.lower
    if r == found.upper.value:
        return Bounds(lower, found.upper)
    answer = run(work.graph, r + 1, 1, "transform", work.limits, {})
    if answer.verdict is not Verdict.NOT_ROBUST:
        return found
    return Bounds(lower, Bound(r, "violating pair found by transform", witness_of(work.graph, answer.pair)))


def _meet(one: Bounds, two: Bounds) -> Bounds:
    """Return the tighter bound on either side; of equal upper bounds one that has a pair."""
    lower = max(one.lower, two.lower, key=lambda bound: bound.value)
    upper = min(one.upper, two.upper, key=lambda bound: (bound.value, bound.witness is None))
    return Bounds(lower, upper)


def _descend(work: _Work, found: Bounds, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Decide r = upper, upper - 1, ... until one holds or a limit is reached."""
    while found.lower.value < found.upper.value:
        closer = _decided(work, found, found.upper.value)
        if closer is None:
            break
        found = closer
        on_bounds(found)
    return found


def _climb(work: _Work, found: Bounds, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Decide r = lower + 1, lower + 2, ... below the upper bound until a limit is reached.

    The cost of a refutation grows some hundredfold with each r near r*, so those below cost next to nothing together,
    while the one at the upper bound may never end.
    """
    while found.lower.value + 1 < found.upper.value:
        closer = _decided(work, found, found.lower.value + 1)
        if closer is None:
            break
        found = closer
        on_bounds(found)
    return found


def _decided(work: _Work, found: Bounds, r: int) -> Bounds | None:
    """Return the bounds after an exact search has decided r-robustness, or None when a limit stopped it."""
    answer = work.search(r, 1)
    if answer.verdict is Verdict.UNDECIDED:
        return None
    if answer.verdict is Verdict.ROBUST:
        return Bounds(Bound(r, f"{work.name} refuted every violating pair"), found.upper)
    witness = witness_of(work.graph, answer.pair)
    return Bounds(found.lower, Bound(r - 1, f"violating pair found by {work.name}", witness))


def _greatest_s(work: _Work, r: int, known: int = 0) -> Bounds:
    """Return bounds on s_max(r), equal when decided; ``known`` is an s for which (r,s)-robustness is known.

    The cost of a refutation grows steeply with s, so s climbs from below, in doubling steps, towards an upper bound
    that every violating pair found on the way lowers to its own count of exempt nodes.
    """
    graph = work.graph
    lower = Bound(known, "implied by what is proven" if known else "nothing proven yet")
    upper = Bound(graph.n, "s_max(r) <= n")
    if work.algorithm == "auto":
        lower, upper = _cheap_s(work, r, lower, upper)
    step = 1
    while lower.value < upper.value:
        s = min(lower.value + step, upper.value)
        answer = work.search(r, s)
        if answer.verdict is Verdict.UNDECIDED:
            break
        if answer.verdict is Verdict.ROBUST:
            lower, step = Bound(s, f"{work.name} refuted every violating pair"), 2 * step
            continue
        if answer.pair is None:
            raise InternalError(f"a violation of ({r},{s})-robustness without a pair: please report")
        upper = Bound(exempt_count(graph, answer.pair, r), "violating pair", witness_of(graph, answer.pair))
        step = 1
    return Bounds(lower, upper)


def _cheap_s(work: _Work, r: int, lower: Bound, upper: Bound) -> tuple[Bound, Bound]:
    """Return bounds on s_max(r) from the degree rule and from local search."""
    from robustness.decision.bounds.degree import robust_by_degree
    from robustness.decision.bounds.local_search import fewest_exempt

    if robust_by_degree(work.graph, r):
        return Bound(work.graph.n, "degree rule: (r,s)-robust for every s"), upper
    if work.graph.n <= _TRANSFORM_PROFILE_NODES:
        from robustness.decision.algorithms.transform import profile as transform_profile

        with suppress(Undecided):
            exact = Bound(transform_profile(work.graph, work.limits)[r], "transform")
            return exact, exact
    seconds = min(_HEURISTIC_SECONDS, work.limits.seconds_left() / 4)
    found = fewest_exempt(
        work.graph,
        r,
        seed=work.limits.seed,
        time_budget=seconds,
        restarts=4,
        lower=lower.value,
        stop=work.limits.expired,
    )
    if found is not None:
        upper = Bound(found[0], "a violating pair found by local search", witness_of(work.graph, found[1]))
    return lower, upper


def profile(graph: Digraph, algorithm: str, limits: Limits) -> Mapping[int, int]:
    """Return ``r -> s_max(r)`` for r = 1 .. ceil(n/2), or raise Undecided."""
    if graph.n < 2:
        return {1: 1} if graph.n else {}
    if algorithm == "transform" or (algorithm == "auto" and graph.n <= _TRANSFORM_PROFILE_NODES):
        from robustness.decision.algorithms.transform import profile as transform_profile

        return transform_profile(graph, limits)
    work = _Work(graph, algorithm, limits)
    table: dict[int, int] = {}
    known = 0
    for r in range(largest_conceivable_r(graph.n), 0, -1):
        # (r,s)-robust implies (r-1,s+1)-robust: what was proven for r+1 starts the descent for r.
        found = _greatest_s(work, r, known=min(known + 1, graph.n) if known else 0)
        if found.lower.value < found.upper.value:
            raise Undecided(f"s_max({r}) lies in {found.lower.value}..{found.upper.value}: raise the time limit")
        table[r] = known = found.upper.value
    return dict(sorted(table.items()))
