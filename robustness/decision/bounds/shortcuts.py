"""What settles a question about (r,s)-robustness without a search, cheapest first."""

from __future__ import annotations

from robustness.answers import Answer, Question
from robustness.decision.bounds.cuts import at_once, closed_pair, separating_pair
from robustness.decision.bounds.degree import robust_by_degree
from robustness.decision.bounds.growth import find_growth
from robustness.decision.bounds.local_search import TINY, find_violation
from robustness.decision.bounds.spectral import MOST_SPECTRAL_NODES, spectral_evidence
from robustness.definitions import largest_conceivable_r
from robustness.evidence import DegreeRule, Evidence, Pair, ViolatingPair
from robustness.limits import Limits, Steps
from robustness.spelled import counted

__all__ = ["HEURISTIC_STEPS", "settle"]

#: What heuristics may spend before the exact search begins: about a quarter of a second.
HEURISTIC_STEPS = 250_000_000

#: Restarts of the local search that come before the search proper.
_FEW_RESTARTS = 4


def settle(question: Question, limits: Limits) -> Answer | None:
    """Decide by bounds alone, or return None.

    Parameters
    ----------
    question : Question
        With n >= 2 and r >= 1; conventions settle the rest.
    limits : Limits
        The linear-time rules always run; heuristics have a budget of :data:`HEURISTIC_STEPS`, and stop at the deadline.

    Notes
    -----
    Time and memory linear in the arcs before the heuristics.

    >>> import networkx as nx
    >>> settle(Question.about(nx.star_graph(4), 2, 1), Limits()).stats["rule"]
    'a node hears 1 < 2 nodes'
    """
    graph, r, s = question
    pair = at_once(graph, r)
    if pair is not None:
        half = r > largest_conceivable_r(graph.n)
        return _violated(
            pair, "r* <= ceil(n/2)" if half else f"a node hears {int(graph.in_degrees.min())} < {counted(r, 'node')}"
        )
    if robust_by_degree(graph, r):
        return _answer(DegreeRule(), "degree rule")
    if r == 1:
        pair = closed_pair(graph)
        if pair is not None:
            return _violated(pair, "two sets hear nobody outside")
    if graph.n <= TINY:
        return None
    steps = Steps(HEURISTIC_STEPS, limits.expired)
    growth = find_growth(graph, r, s, steps=steps.part(steps.left // 3))
    if growth is not None:
        return _answer(growth, f"growth from {counted(len(growth.seed), 'node')}")
    spectral = spectral_evidence(graph) if graph.n <= MOST_SPECTRAL_NODES else None
    if spectral is not None and spectral.r >= r + s - 1:
        return _answer(spectral, f"lambda_2 > {spectral.mu}")
    if r == 2:
        pair = separating_pair(graph)
        if pair is not None:
            return _violated(pair, "a node separates the graph")
    pair = find_violation(graph, r, s, seed=limits.seed, steps=steps.part(steps.left // 2), restarts=_FEW_RESTARTS)
    return None if pair is None else _violated(pair, "local search")


def _answer(evidence: Evidence, rule: str) -> Answer:
    return Answer(evidence, {"rule": rule}, "bounds")


def _violated(pair: Pair, rule: str) -> Answer:
    return _answer(ViolatingPair(pair), rule)
