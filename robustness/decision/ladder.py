"""One question, one algorithm, one re-checked answer: what the front and everything built on it decide with.

``auto`` takes, in this order: the subset-minimum transform on small graphs (milliseconds); cheap bounds with their
evidence; the subset search. A violating pair is re-checked against the definition before anybody sees it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robustness.decision.algorithms import ALGORITHMS, Answer, Pair
from robustness.definitions import is_violation, r_reachable_ids
from robustness.digraph import Digraph
from robustness.errors import InternalError
from robustness.limits import Limits, Steps
from robustness.results import Verdict, Witness

__all__ = ["TRANSFORM_NODES", "decide", "exempt_count", "run", "witness_of"]

#: Up to this many nodes ``auto`` computes the whole profile by the subset-minimum transform: milliseconds.
TRANSFORM_NODES = 18

#: What heuristics may spend before the exact search begins: about a quarter of a second.
_HEURISTIC_STEPS = 250_000_000


def decide(
    graph: Digraph, r: int, s: int, algorithm: str, limits: Limits, options: Mapping[str, Any]
) -> tuple[str, Answer]:
    """Decide a question with n >= 2 and 1 <= r <= ceil(n/2); return what decided it and the answer."""
    if algorithm != "auto":
        return algorithm, run(graph, r, s, algorithm, limits, options)
    if graph.n <= TRANSFORM_NODES and not options:
        return "transform", run(graph, r, s, "transform", limits, options)
    from robustness.decision.bounds import settle

    settled = settle(graph, r, s, seed=limits.seed, steps=Steps(_HEURISTIC_STEPS, limits.expired))
    if settled is not None:
        answer = Answer(settled.verdict, settled.pair, {"rule": settled.rule})
        return "bounds", _checked(graph, r, s, "bounds", answer)
    return "subset-search", run(graph, r, s, "subset-search", limits, options)


def run(graph: Digraph, r: int, s: int, name: str, limits: Limits, options: Mapping[str, Any]) -> Answer:
    """Run one algorithm of the registry and re-check its pair."""
    return _checked(graph, r, s, name, ALGORITHMS[name](graph, r, s, limits, **options))


def _checked(graph: Digraph, r: int, s: int, name: str, answer: Answer) -> Answer:
    """Return ``answer`` after re-checking its pair against the definition; a wrong pair is an InternalError."""
    if answer.verdict is not Verdict.NOT_ROBUST:
        return answer
    if answer.pair is None or not is_violation(graph, answer.pair.first, answer.pair.second, r, s):
        raise InternalError(f"{name} returned {answer.pair}, no violation of ({r},{s})-robustness: please report")
    return answer


def exempt_count(graph: Digraph, pair: Pair, r: int) -> int:
    """Return ``|X_S1^r| + |X_S2^r|`` of a pair: it violates (r,s) for every greater s, so s_max(r) is at most this."""
    return len(r_reachable_ids(graph, pair.first, r)) + len(r_reachable_ids(graph, pair.second, r))


def witness_of(graph: Digraph, pair: Pair | None) -> Witness | None:
    """Return a pair of id sets as label sets."""
    return None if pair is None else Witness(graph.labels_of(pair.first), graph.labels_of(pair.second))
