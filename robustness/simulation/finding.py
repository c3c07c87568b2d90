"""From a network to an attack: search for the evidence, then make the attack of it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from robustness.checking import check_rs_robustness
from robustness.constructions.traps import without
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.results import Verdict
from robustness.simulation.attacks import Attack, attack_from_trap, attack_from_violation

__all__ = ["ATTACK_MODELS", "Finding", "find_attack"]

#: What the attacker may do: lie to all alike; the same with delays; lie to each differently.
ATTACK_MODELS = ("malicious", "delayed", "byzantine")


@dataclass(frozen=True, slots=True)
class Finding:
    """An attack, or why there is none.

    Attributes
    ----------
    attack : Attack or None
    outcome : str
        What the network does under the worst attack of the model: ``"split"`` with an attack, ``"agreement"`` when a
        theorem promises it, ``"undecided"`` when a limit stopped the search or the theory leaves the case open.
    reason : str
        In words.
    """

    attack: Attack | None
    outcome: str
    reason: str


def find_attack(
    G: GraphLike,
    f: int,
    model: str = "malicious",
    *,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
) -> Finding:
    """Find an attack of f nodes that splits the network for ever, or prove that none exists.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    model : str
        ``"malicious"``: synchronous, f-total; decided by (f+1,f+1)-robustness. ``"delayed"``: with delays, where a
        trap is an attack as well; undecided when there is none and the network is not (2f+1)-robust. ``"byzantine"``:
        synchronous, decided by traps.
    algorithm, time_limit, jobs, seed
        As for :func:`robustness.check_rs_robustness`; the time limit is for everything together.

    Returns
    -------
    Finding

    Notes
    -----
    At most one exact check for the violation, and one for each of the ``sum C(n, m), m <= f`` sets of a trap.

    >>> import networkx as nx
    >>> [find_attack(nx.wheel_graph(5), 1, model).outcome for model in ATTACK_MODELS]
    ['agreement', 'split', 'split']
    """
    graph = as_digraph(G)
    if model not in ATTACK_MODELS:
        raise InvalidParameter(f"an attack's model is one of {', '.join(ATTACK_MODELS)}, not {model!r}")
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
    if graph.n < 2:
        return Finding(None, "agreement", "fewer than two nodes: nobody to disagree with")
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    options: dict[str, Any] = {"algorithm": algorithm, "jobs": jobs, "seed": seed}
    # A violating pair leaves a node of each set unreachable, so beyond s = n the third condition says no more.
    result = check_rs_robustness(graph, f + 1, min(f + 1, graph.n), time_limit=time_limit, **options)
    if result.verdict is Verdict.UNDECIDED:
        return Finding(None, "undecided", f"({f + 1},{f + 1})-robustness was not decided: raise the time limit")
    if result.witness is not None:
        attack = attack_from_violation(graph, f, result.witness)
        return Finding(attack, "split", f"not ({f + 1},{f + 1})-robust: {attack.story()}")
    if model == "malicious":
        return Finding(None, "agreement", f"({f + 1},{f + 1})-robust: f = {f} malicious nodes do not split it")
    strong = check_rs_robustness(graph, 2 * f + 1, time_limit=_left(deadline), **options)
    if strong.verdict is Verdict.ROBUST:
        return Finding(None, "agreement", f"{2 * f + 1}-robust: f = {f} nodes do not split it, two-faced or not")
    return _find_two_faced(graph, f, model, deadline, options)


def _find_two_faced(graph: Digraph, f: int, model: str, deadline: float, options: dict[str, Any]) -> Finding:
    """Return the attack of a trap, or what its absence proves."""
    for size in range(f + 1):
        for chosen in combinations(range(graph.n), size):
            rest = without(graph, frozenset(chosen))
            result = check_rs_robustness(rest, f + 1, time_limit=_left(deadline), **options)
            if result.witness is not None:
                faults = "byzantine" if model == "byzantine" else "malicious"
                attack = attack_from_trap(graph, f, graph.labels_of(chosen), *result.witness, model=faults)
                return Finding(attack, "split", f"trapped: {attack.story()}")
            if result.verdict is Verdict.UNDECIDED or time.monotonic() > deadline:
                return Finding(None, "undecided", f"no trap for f = {f} found in time: raise the time limit")
    if model == "byzantine":
        return Finding(None, "agreement", f"{f + 1}-robust without any {f} nodes: {f} Byzantine ones do not split it")
    return Finding(None, "undecided", f"no trap, but not proven {2 * f + 1}-robust: the theory leaves this case open")


def _left(deadline: float) -> float | None:
    """Return the seconds until the deadline, hardly any once it has passed, or None without one."""
    return None if deadline == float("inf") else max(deadline - time.monotonic(), 1e-3)
