"""Finding r*, s_max(r*) and whole profiles: bounds from both sides first, then one refutation.

Let c(S1, S2) = |X_S1^r| + |X_S2^r|. By the definition s_max(r) is the least c over the pairs in which neither
side is fully reachable, or n when there is none. So every violating pair found for (r,s) lowers the candidate for
s_max(r) to its own c, and one refutation at that candidate ends the descent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from robustness.answers import Answer, Question, Verdict, answers_in_turn
from robustness.decision.ladder import EXACT_S_NODES, algorithm_rung
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.limits import UNLIMITED, Limits, Steps
from robustness.results import Bound, Bounds, RobustnessResult, Witness

__all__ = ["PROFILE_NODES", "SOLVER_NODES", "determine", "profile"]

#: Up to this many nodes ``auto`` reads the whole profile, and with it r* and s, off the subset-minimum transform, in a
#: tenth of a second: O(n 2^n).
PROFILE_NODES = 22

#: Up to this many nodes, and this many in-neighbours each on average, CP-SAT looks for s too when there is a time limit
#: that both can share (random 5-regular, n = 60, (2,4): 15 seconds, and no end in sight for the search).
SOLVER_NODES, _SPARSE = 100, 10

# Budgets, counted in steps (robustness.limits), so that the answer does not depend on the machine or its load. They
# share what the user's time limit leaves, which alone may cut the work short.

#: What heuristics for bounds may spend before the exact search begins: about half a second.
_HEURISTIC_STEPS = 500_000_000

#: What exact search may spend before bounds that cost more are tried, and once more before local search goes on.
_SHORT_STEPS = 300_000_000

#: The first turn of searches from below and from above; local search has half as much. Each turn has twice the last.
_TURN_STEPS = 2_000_000_000

#: What the search for s may spend on a graph of more nodes when nobody set a limit: about two seconds.
_S_STEPS = 2_000_000_000

#: Why an upper bound holds that local search found.
_LOCAL_SEARCH = "a violating pair found by local search"


@dataclass(slots=True)
class _Work:
    """What all decisions of one determination share: how to decide, and what it has cost so far."""

    graph: Digraph
    algorithm: str
    limits: Limits
    name: str = "transform"
    stats: dict[str, Any] = field(default_factory=dict)

    def search(self, r: int, s: int, limits: Limits) -> Answer:
        """Decide (r,s)-robustness by an exact algorithm, after bounds have said what they can."""
        self.name = "subset-search" if self.algorithm == "auto" else self.algorithm
        answer = _searched(self.graph, r, s, self.name, limits)
        if answer.verdict is not Verdict.UNDECIDED:  # why an earlier, shorter search ended says nothing any more
            self.stats = {key: value for key, value in self.stats.items() if key not in ("reason", "estimate")}
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
        bounds = Bounds.by_convention(graph.n)
        table = MappingProxyType(dict.fromkeys(range(1, graph.n + 1), 1))
        return RobustnessResult(Verdict.DETERMINED, graph.n, 1, bounds=bounds, profile=table, algorithm="definition")
    if algorithm == "auto" and graph.n <= PROFILE_NODES:
        found = _read_off(graph, limits)
        if found is not None:
            return found
    work = _Work(graph, algorithm, limits)
    bounds = _greatest_r(work, on_bounds or (lambda _: None))
    r, witness, name = bounds.lower.value, bounds.upper.witness, work.name
    is_known = r == bounds.upper.value
    s_bounds = None
    if not is_known:
        s = 1 if r else graph.n
    elif r == 0:
        s = graph.n  # every graph is (0,s)-robust
    else:
        s_bounds = _greatest_s(work, r, 1, _limits_for_s(graph, algorithm, limits, s_time_limit))
        s = s_bounds.lower.value
    return RobustnessResult(
        Verdict.DETERMINED if is_known else Verdict.UNDECIDED,
        r,
        s,
        witness,
        bounds=bounds,
        s_bounds=s_bounds,
        algorithm=name,
        stats=work.stats,
    )


def profile(graph: Digraph, algorithm: str, limits: Limits) -> Mapping[int, int]:
    """Return ``r -> s_max(r)`` for r = 1 .. ceil(n/2), or raise Undecided with the part that is proven."""
    if graph.n < 2:
        return {1: 1} if graph.n else {}
    from robustness.decision.algorithms.transform import memory_suffices
    from robustness.decision.algorithms.transform import profile as transform_profile

    # One transform for every r up to r* + 1, where the descent below would take one for every r.
    if algorithm == "transform" or (algorithm == "auto" and graph.n <= EXACT_S_NODES and memory_suffices(graph.n)):
        return transform_profile(graph, limits)
    work = _Work(graph, algorithm, limits)
    table: dict[int, int] = {}
    known = 0
    for r in range(largest_conceivable_r(graph.n), 0, -1):
        # (r,s)-robust implies (r-1,s+1)-robust: what was proven for r+1 starts the descent for r.
        found = _greatest_s(work, r, min(known + 1, graph.n) if known else 0, limits)
        if not found.are_equal:
            raise Undecided(
                f"s_max({r}) lies in {found.lower.value}..{found.upper.value}: raise the time limit",
                bounds=found,
                profile=MappingProxyType(dict(sorted(table.items()))),
            )
        table[r] = known = found.upper.value
    return dict(sorted(table.items()))


def _searched(graph: Digraph, r: int, s: int, name: str, limits: Limits) -> Answer:
    """Return the re-checked answer of one algorithm, for n >= 2 and 1 <= r <= ceil(n/2)."""
    return next(answers_in_turn((algorithm_rung(name),), Question(graph, r, s), limits))


def _limits_for_s(graph: Digraph, algorithm: str, limits: Limits, s_time_limit: float | None) -> Limits:
    """Return how hard to look for s: for as long as the user said, else until it is exact where that takes seconds."""
    if s_time_limit is not None:
        return limits.within(s_time_limit)
    if limits.steps is not None or limits.deadline is not None or algorithm != "auto" or graph.n <= EXACT_S_NODES:
        return limits
    return limits.counted(_S_STEPS)


def _read_off(graph: Digraph, limits: Limits) -> RobustnessResult | None:
    """Return r*, s and the profile from one transform, or None when a limit or the memory does not allow it."""
    try:
        table = profile(graph, "transform", limits)
    except Undecided:
        return None
    r = max((r for r, s in table.items() if s), default=0)
    lower = Bound(r, "transform refuted every violating pair" if r else "every graph is 0-robust")
    upper = Bounds.trivial(graph).upper
    stats: dict[str, Any] = {"sets": 1 << graph.n}
    if r < upper.value:
        answer = _searched(graph, r + 1, 1, "transform", limits)
        if answer.verdict is not Verdict.NOT_ROBUST:
            return None
        upper = (
            Bounds.trivial(graph)
            .narrowed_by(Question(graph, r + 1, 1), answer, "violating pair found by transform")
            .upper
        )
    s = Bound(table[r], "transform") if r else Bound(graph.n, "every graph is (0,s)-robust")
    return RobustnessResult(
        Verdict.DETERMINED,
        r,
        s.value,
        upper.witness,
        bounds=Bounds(lower, upper),
        s_bounds=Bounds(s, s) if r else None,
        profile=MappingProxyType(table),
        algorithm="transform",
        stats=stats,
    )


def _greatest_r(work: _Work, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Return bounds on r*, equal unless a limit stopped the work.

    Bounds that cost milliseconds come first, then bounds that cost a second, each with a short exact search; then local
    search and exact searches from below and from above in turns, each twice as long as before, until one r is left to
    refute: whichever way a graph is easy, it is decided that way, and a limit leaves a narrow interval.
    """
    graph, limits = work.graph, work.limits
    found = Bounds.trivial(graph)
    if work.algorithm != "auto":
        return _descend(work, found, limits, on_bounds)
    from robustness.decision.algorithms.subset_search import MOST_NODES
    from robustness.decision.bounds import bounds

    def report(cheap: Bounds) -> None:
        met = found.met_with(cheap)
        if met != found:
            on_bounds(met)

    for thorough in (False, True):
        part = limits.share(1 / 2)
        steps = Steps(_allowed(limits, _HEURISTIC_STEPS), part.expired)
        cheap = bounds(graph, seed=limits.seed, steps=steps, on_bounds=report, thorough=thorough)
        work.name = work.name if work.stats else "bounds"  # a search has counters
        found = found.met_with(cheap)
        found = _descend(work, found, _one_thread(limits, _SHORT_STEPS), on_bounds)
    if limits.steps is not None:
        return _climb(work, found, limits, on_bounds)
    is_last, turn, budget = False, 0, _TURN_STEPS
    while found.lower.value < found.upper.value and not is_last and not limits.expired():
        # Which end gives way sooner is not known, so both have their turns, until one r is left.
        turn += 1
        found = _look_for_pairs(work, found, Steps(budget // 2, limits.share(1 / 4).expired), turn, on_bounds)
        found = _climb(work, found, _one_thread(limits.share(1 / 4), budget), on_bounds)
        is_last = (turn > 1 and found.lower.value + 1 >= found.upper.value) or graph.n > MOST_NODES
        found = _descend(work, found, limits if is_last else _one_thread(limits, budget), on_bounds)
        budget *= 2
    return found


def _one_thread(limits: Limits, steps: int) -> Limits:
    """Return limits for a search that a budget may stop: one thread stops at the same place on every machine."""
    return replace(limits, jobs=1, steps=_allowed(limits, steps))


def _allowed(limits: Limits, steps: int) -> int:
    """Return these steps, or fewer where one search has a smaller budget."""
    return steps if limits.steps is None else min(steps, limits.steps)


def _look_for_pairs(work: _Work, found: Bounds, steps: Steps, turn: int, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Let local search, from other starts each turn, lower the upper bound until its steps are spent."""
    from robustness.decision.bounds.local_search import find_violation

    while found.lower.value < found.upper.value and not steps.over():
        r = found.upper.value
        pair = find_violation(work.graph, r, seed=work.limits.seed + turn, steps=steps, restarts=UNLIMITED)
        if pair is None:
            break
        found = found.narrowed_by(
            Question(work.graph, r, 1), Answer.violated_by(pair), "a violating pair found by local search"
        )
        on_bounds(found)
    return found


def _descend(work: _Work, found: Bounds, limits: Limits, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Decide r = upper, upper - 1, ... until one holds or a limit is reached."""
    while found.lower.value < found.upper.value:
        closer = _decided(work, found, found.upper.value, limits)
        if closer is None:
            break
        found = closer
        on_bounds(found)
    return found


def _climb(work: _Work, found: Bounds, limits: Limits, on_bounds: Callable[[Bounds], None]) -> Bounds:
    """Decide r = lower + 1, lower + 2, ... below the upper bound until a limit is reached.

    The cost of a refutation grows some hundredfold with each r near r*, so those below cost next to nothing together,
    while the one at the upper bound may never end.
    """
    while found.lower.value + 1 < found.upper.value:
        closer = _decided(work, found, found.lower.value + 1, limits)
        if closer is None:
            break
        found = closer
        on_bounds(found)
    return found


def _decided(work: _Work, found: Bounds, r: int, limits: Limits) -> Bounds | None:
    """Return the bounds after an exact search has decided r-robustness, or None when a limit stopped it."""
    answer = work.search(r, 1, limits)
    if answer.verdict is Verdict.UNDECIDED:
        return None
    is_robust = answer.verdict is Verdict.ROBUST
    reason = f"{work.name} refuted every violating pair" if is_robust else f"violating pair found by {work.name}"
    return found.narrowed_by(Question(work.graph, r, 1), answer, reason)


def _greatest_s(work: _Work, r: int, known: int, limits: Limits) -> Bounds:
    """Return bounds on s_max(r), equal when decided; ``known`` is an s for which (r,s)-robustness is known.

    The cost of a refutation grows steeply with s, so s climbs from below, in doubling steps, towards an upper bound
    that every violating pair found on the way lowers to its own count of exempt nodes.
    """
    graph = work.graph
    lower = Bound(known, "implied by what is proven" if known else "nothing proven yet")
    found = Bounds(lower, Bound(graph.n, "s_max(r) <= n"))
    if work.algorithm == "auto":
        found = _cheap_s(work, r, found, limits)
    step = 1
    while found.lower.value < found.upper.value:
        s = min(found.lower.value + step, found.upper.value)
        answer, name = _searched_by_turns(work, r, s, limits)
        if answer.verdict is Verdict.UNDECIDED:
            break
        is_robust = answer.verdict is Verdict.ROBUST
        reason = f"{name} refuted every violating pair" if is_robust else "violating pair"
        found = found.s_narrowed_by(Question(graph, r, s), answer, reason)
        step = 2 * step if is_robust else 1
    return found


def _searched_by_turns(work: _Work, r: int, s: int, limits: Limits) -> tuple[Answer, str]:
    """Decide (r,s)-robustness, and name what decided.

    On sparse graphs the search loses its way where nodes may be exempt, and CP-SAT does not. So of a time limit an
    eighth is for the search, half of the rest for CP-SAT, and the rest for the search again.
    """
    graph, turns = work.graph, [("search", limits)]
    is_sparse = graph.n <= SOLVER_NODES and graph.arc_count <= _SPARSE * graph.n
    is_here = limits.executor is None and limits.state is None
    if s > 1 and work.algorithm == "auto" and limits.deadline is not None and is_sparse and is_here:
        turns = [("search", limits.share(1 / 8)), ("cp-sat", limits.share(9 / 16)), ("search", limits)]
    for who, part in turns:
        answer = work.search(r, s, part) if who == "search" else _searched(graph, r, s, who, part)
        if answer.verdict is not Verdict.UNDECIDED or limits.expired():
            break
    return answer, work.name if who == "search" else who


def _cheap_s(work: _Work, r: int, known: Bounds, limits: Limits) -> Bounds:
    """Return bounds on s_max(r): from the degree rule, from one transform on small graphs, and from local search."""
    from robustness.decision.bounds.degree import robust_by_degree
    from robustness.decision.bounds.local_search import fewest_exempt

    if robust_by_degree(work.graph, r):
        return Bounds(Bound(work.graph.n, "degree rule: (r,s)-robust for every s"), known.upper)
    transform_steps = work.graph.n << work.graph.n
    if work.graph.n <= EXACT_S_NODES and _allowed(limits, transform_steps) == transform_steps:
        exact = _by_transform(work.graph, r, limits)
        if exact is not None:
            return exact
    steps = Steps(_allowed(limits, _HEURISTIC_STEPS), limits.share(1 / 4).expired)
    found = fewest_exempt(work.graph, r, seed=limits.seed, steps=steps, restarts=4, lower=known.lower.value)
    if found is None:
        return known
    return Bounds(
        known.lower, Bound(found[0], "a violating pair found by local search", Witness.of(work.graph, found[1]))
    )


def _by_transform(graph: Digraph, r: int, limits: Limits) -> Bounds | None:
    from robustness.decision.algorithms.transform import largest_s

    try:
        s, pair = largest_s(graph, r, limits)
    except Undecided:
        return None
    witness = None if pair is None else Witness.of(graph, pair)
    return Bounds(Bound(s, "transform"), Bound(s, "transform", witness))
