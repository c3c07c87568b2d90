"""Counterexample-guided search: propose a graph that meets the constraints so far, see what breaks it, learn from it.

A proposal that breaks a *for all* demand comes with a violating pair, a trap or a separator. The demand for that pair
speaks about sets of nodes and not about the proposal, so it holds for every graph that fits, and is added to the
model. When the model has no solution left, no graph fits; when nothing breaks the proposal, it fits. The loop is
finite, as there are finitely many pairs. The scheme is Solar-Lezama's (counterexample-guided inductive synthesis);
CP-SAT proposes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robustness.connectivity import smallest_separation
from robustness.decision.front import check_within
from robustness.digraph import Digraph
from robustness.errors import InternalError, Undecided
from robustness.evidence import Pair
from robustness.graph_search.model import GraphModel
from robustness.graph_search.properties import Connected, HasTrap, Property, RSRobust
from robustness.limits import UNBOUNDED, Limits, Progress
from robustness.results import Verdict
from robustness.solver_calls import solve_within
from robustness.spelled import counted
from robustness.traps.smallest import smallest_trap

__all__ = ["Synthesis", "small_violations", "synthesise"]

#: Up to this many nodes a proposal shows many violating pairs at once, not only the first that is found.
ALL_PAIRS_NODES = 10
PAIRS_A_ROUND = 100


@dataclass(slots=True)
class Synthesis:
    """What the loop came to: a graph that fits, and what is proven about the number of edges.

    ``is_complete`` says that the question was settled: without ``graph`` none exists, and with it, where edges were
    minimised, none has fewer.
    """

    graph: Digraph | None = None
    edges_at_least: int = 0
    is_complete: bool = False
    stats: dict[str, Any] = field(default_factory=lambda: {"proposals": 0, "constraints": 0})


def synthesise(
    n: int,
    satisfies: Sequence[Property],
    violates: Sequence[Property],
    *,
    directed: bool,
    minimise: bool = False,
    limits: Limits = UNBOUNDED,
    symmetry_breaking: bool = True,
    on_known: Callable[[Synthesis], None] = lambda known: None,
) -> Synthesis:
    """Search for a graph on n >= 2 nodes; with ``minimise``, for one with the fewest edges.

    First any graph is looked for, then one with fewer edges, until none is left: so a limit leaves a graph that fits,
    and ``edges_at_least`` below it. ``on_known`` is called whenever one of the two is new.
    """
    model = GraphModel(n, directed=directed, symmetry_breaking=symmetry_breaking)
    model.demand(satisfies, violates)
    found = Synthesis()
    try:
        found.graph = _propose_until_it_fits(model, satisfies, violates, found, limits, on_known)
        if found.graph is not None and minimise:
            on_known(found)
            model.model.minimize(model.edge_count())
            # The optimum of every relaxation is a lower bound, so the first proposal that fits is a graph with
            # fewest edges.
            found.graph = _propose_until_it_fits(model, satisfies, violates, found, limits, on_known)
            if found.graph is None:
                raise InternalError("a graph that fits was lost while its edges were minimised: please report")
        found.is_complete = True
    except Undecided as limit:
        found.stats["reason"] = str(limit)
    return found


def _propose_until_it_fits(
    model: GraphModel,
    satisfies: Sequence[Property],
    violates: Sequence[Property],
    found: Synthesis,
    limits: Limits,
    on_known: Callable[[Synthesis], None],
) -> Digraph | None:
    """Return a graph that fits (with an objective: an optimal one), or None when there is none."""
    while True:
        outcome = solve_within(model.model, limits)
        if outcome.is_infeasible:
            return None
        if model.model.has_objective() and outcome.bound > 0:
            at_least = math.ceil(outcome.bound - 1e-6)
            if at_least > found.edges_at_least:
                found.edges_at_least = at_least
                on_known(found)
        if not outcome.has_solution:
            raise Undecided("the time limit was reached")
        proposal = model.candidate(outcome.solver)
        found.stats["proposals"] += 1
        if limits.progress is not None:
            learnt_so_far = f"{counted(model.n, 'node')}: {counted(found.stats['constraints'], 'constraint')} learnt"
            limits.progress(Progress(found.stats["proposals"], learnt_so_far))
        learnt = _learn(model, proposal, satisfies, violates, limits)
        found.stats["constraints"] += learnt
        if not learnt:
            if model.model.has_objective() and not outcome.is_optimal:
                found.graph = proposal
                raise Undecided("the time limit was reached")
            return proposal


def _learn(
    model: GraphModel,
    proposal: Digraph,
    satisfies: Sequence[Property],
    violates: Sequence[Property],
    limits: Limits,
) -> int:
    """Add what the proposal shows to be missing, and return how many constraints that are."""
    learnt = 0
    for wanted in satisfies:
        match wanted:
            case RSRobust(r, s):
                learnt += _learn_pair(model, proposal, r, s, limits)
            case Connected(k):
                learnt += _learn_separator(model, proposal, k)
    for unwanted in violates:
        if isinstance(unwanted, HasTrap):
            learnt += _learn_trap(model, proposal, unwanted.f, limits)
    return learnt


def _learn_pair(model: GraphModel, proposal: Digraph, r: int, s: int, limits: Limits) -> int:
    """Forbid a violating pair of the proposal, if it has one; on few nodes, many at once."""
    if r == 0:
        return 0
    pairs: Sequence[Pair]
    if proposal.n <= ALL_PAIRS_NODES:
        pairs = small_violations(proposal, r, s, PAIRS_A_ROUND)
    else:
        result = check_within(proposal, r, s, limits)
        if result.verdict is Verdict.UNDECIDED:
            raise Undecided("a proposal could not be checked within the time limit")
        witness = result.witness
        pairs = [] if witness is None else [Pair(proposal.ids(witness.S1), proposal.ids(witness.S2))]
    for pair in pairs:
        model.forbid_pair(pair, r, s)
    return len(pairs)


def small_violations(graph: Digraph, r: int, s: int, most: int) -> list[Pair]:
    """Return up to ``most`` violating pairs of (r,s)-robustness, of the smallest sets: their constraints say most.

    Quadratic in ``2^n``; empty exactly when the graph is (r,s)-robust.
    """
    n = graph.n
    subsets = np.arange(1 << n)
    reached = np.zeros(1 << n, dtype=np.int64)
    for i, mask in enumerate(graph.in_masks):
        inside = subsets >> i & 1 == 1
        reached[inside] += np.bitwise_count(mask & ~subsets[inside]) >= r
    sizes = np.bitwise_count(subsets)
    bad = subsets[(reached < sizes) & (reached < s)]
    first, second = (side.ravel() for side in np.meshgrid(bad, bad))
    is_pair = (first < second) & (first & second == 0) & (reached[first] + reached[second] < s)
    first, second = first[is_pair], second[is_pair]
    order = np.argsort(sizes[first] + sizes[second], kind="stable")[:most]
    return [
        Pair(_members(one), _members(two))
        for one, two in zip(first[order].tolist(), second[order].tolist(), strict=True)
    ]


def _members(mask: int) -> frozenset[int]:
    return frozenset(i for i in range(mask.bit_length()) if mask >> i & 1)


def _learn_trap(model: GraphModel, proposal: Digraph, f: int, limits: Limits) -> int:
    trap = smallest_trap(proposal, f, **limits.spread_over().keywords())
    if trap is None:
        return 0
    model.forbid_trap(Pair(proposal.ids(trap.S1), proposal.ids(trap.S2)), proposal.ids(trap.M), f)
    return 1


def _learn_separator(model: GraphModel, proposal: Digraph, k: int) -> int:
    """Forbid a smallest separator of fewer than k nodes, if the proposal has one."""
    found = smallest_separation(proposal, k)
    if found is None:
        return 0
    model.forbid_separator(found.sources, found.sinks)
    return 1
