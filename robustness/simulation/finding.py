"""From a network to an attack: search for the evidence, then make the attack of it.

Without delays and with everybody told the same, an attack is a violation of (f+1,f+1)-robustness; under every other
model it is a solution of :mod:`robustness.traps`, which looks for M, S1 and S2 together in one search.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from robustness.decision.algorithms.registry import require_algorithm
from robustness.decision.front import check_within
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.gain_region import gain_gap, gain_region
from robustness.limits import Limits, Progress
from robustness.results import Verdict
from robustness.simulation.attacks import Attack, attack_from_trap, attack_from_violation
from robustness.simulation.gains import arc_weights, kept_weight_bound
from robustness.spelled import counted
from robustness.traps.ladder import decide_trap
from robustness.traps.question import Question

__all__ = ["ATTACK_MODELS", "Finding", "find_attack", "find_attack_within"]

#: What the attacker may do, by the names of :mod:`robustness.threat_models`: lie to all alike, to each neighbour
#: differently, or to all alike with delays; and whether the bound is in all or around every normal node.
ATTACK_MODELS = ("malicious", "malicious-local", "byzantine", "byzantine-local", "delayed", "delayed-local")

#: For every model but the first: how many faces a liar has, whether the bound is local, and the fault model.
_KINDS: Mapping[str, tuple[int, bool, str]] = MappingProxyType(
    {
        "malicious-local": (1, True, "malicious-local"),
        "byzantine": (2, False, "byzantine"),
        "byzantine-local": (2, True, "byzantine-local"),
        "delayed": (2, False, "malicious"),
        "delayed-local": (2, True, "malicious-local"),
    }
)

#: What agreement rests on besides the graph, said with every answer that promises it.
_CONDITION = (
    "for W-MSR, and for second-order vehicles whose gains satisfy s = sigma T² < 1 and "
    "2 sqrt(s) - s/2 <= alpha T <= 2 - s/2"
)


@dataclass(frozen=True, slots=True)
class Finding:
    """An attack, or why there is none.

    Attributes
    ----------
    attack : Attack or None
    outcome : str
        What the network does under the worst attack of the model: ``"split"`` with an attack, ``"agreement"`` when a
        theorem promises it, ``"undecided"`` when a limit stopped the search, or when gains were given for which the
        theorem says nothing.
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
    progress: Callable[[Progress], None] | None = None,
    T: float | None = None,
    alpha: float | None = None,
    sigma: float | None = None,
) -> Finding:
    """Find an attack of f nodes that splits the network for ever, or prove that none exists.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    model : str
        ``"malicious"``: synchronous, f-total; decided by (f+1,f+1)-robustness. ``"malicious-local"``: with at most f
        malicious in-neighbours of every normal node; decided by local violations. ``"byzantine"``: synchronous,
        f-total; ``"delayed"``: with delays, f-total; both also with ``"-local"``; decided by traps.
    algorithm, time_limit, jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`; the time limit is for everything together, and the algorithm is
        used for checks of robustness (traps have one of their own).
    T, alpha, sigma : float, optional
        Sampling period, gain, and a bound on the weights that a vehicle keeps: when one is given, agreement is only
        promised inside :mod:`robustness.gain_region`. Those not given are 1, 1.5 / T, and what weights ``1/d`` add up
        to without the f smallest. An attack splits for all gains.

    Returns
    -------
    Finding

    Notes
    -----
    At most one exact check of robustness and one exact search for a trap; both exponential in the worst case. That no
    trap (no local violation) is enough for agreement is proven in docs/theorems.md, Theorems A and B.

    >>> import networkx as nx
    >>> [find_attack(nx.wheel_graph(5), 1, model).outcome for model in ("malicious", "byzantine", "delayed")]
    ['agreement', 'split', 'split']
    """
    graph = as_digraph(G)
    if model not in ATTACK_MODELS:
        raise InvalidParameter(f"an attack's model is one of {', '.join(ATTACK_MODELS)}, not {model!r}")
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
    require_algorithm(algorithm)
    limits = Limits.of(time_limit, jobs, seed, progress)
    gap = None if graph.n < 2 else _gap(graph, f, T, alpha, sigma)
    found = find_attack_within(graph, f, model, limits, algorithm)
    if graph.n < 2 or found.outcome != "agreement":
        return found
    if gap is None:
        return replace(found, reason=f"{found.reason}, {_CONDITION}")
    return Finding(None, "undecided", f"{found.reason} under W-MSR, but with these gains nothing is promised: {gap}")


def find_attack_within(graph: Digraph, f: int, model: str, limits: Limits, algorithm: str = "auto") -> Finding:
    """Do what :func:`find_attack` does for whatever gains and a question that is known to be valid, within ``limits``.

    For those of this package who have limits of their own, and budgets of steps with them.
    """
    if graph.n < 2:
        return Finding(None, "agreement", "fewer than two nodes: nobody to disagree with")
    if model == "malicious":
        return _find_violation(graph, f, limits, algorithm)
    return _find_by_search(graph, f, model, limits, algorithm)


def _gap(graph: Digraph, f: int, T: float | None, alpha: float | None, sigma: float | None) -> str | None:
    """Return why the gains lie outside their region, or None when they lie inside or none was given."""
    if T is None and alpha is None and sigma is None:
        return None
    period = 1.0 if T is None else T
    most = float(kept_weight_bound(graph, arc_weights(graph, "uniform"), f).max()) if sigma is None else sigma
    gain_region(period, most)  # refuses a period that nothing can be divided by
    return gain_gap(period, 1.5 / period if alpha is None else alpha, most)


def _find_violation(graph: Digraph, f: int, limits: Limits, algorithm: str) -> Finding:
    """Return the attack of a violating pair, or that there is none."""
    # A violating pair leaves a node of each set unreachable, so beyond s = n the third condition says no more.
    result = check_within(graph, f + 1, min(f + 1, graph.n), limits, algorithm)
    if result.verdict is Verdict.UNDECIDED:
        return Finding(None, "undecided", f"({f + 1},{f + 1})-robustness was not decided: raise the time limit")
    if result.witness is None:
        return Finding(
            None,
            "agreement",
            f"({f + 1},{f + 1})-robust: {counted(f, 'malicious node does', 'malicious nodes do')} not split it",
        )
    attack = attack_from_violation(graph, f, result.witness)
    return Finding(attack, "split", f"not ({f + 1},{f + 1})-robust: {attack.story()}")


def _find_by_search(graph: Digraph, f: int, model: str, limits: Limits, algorithm: str) -> Finding:
    """Return the attack that the trap search finds, or what its absence proves."""
    faces, local, faults = _KINDS[model]
    # (2f+1)-robust graphs have no attack of these kinds, which spares the search; that check gets half of the time.
    strong = check_within(graph, 2 * f + 1, 1, limits.share(1 / 2), algorithm)
    if strong.verdict is Verdict.ROBUST:
        return Finding(
            None,
            "agreement",
            f"{2 * f + 1}-robust: {counted(f, 'node does', 'nodes do')} not split it, two-faced or not",
        )
    found = decide_trap(graph, Question(f, faces == 2, local), limits)
    if found.exists is None:
        return Finding(
            None,
            "undecided",
            f"whether {counted(f, 'node splits', 'nodes split')} it was not decided: raise the time limit",
        )
    if found.sets is not None:
        M, S1, S2 = (graph.labels_of(ids) for ids in found.sets)
        if faces == 1:
            attack = attack_from_violation(graph, f, (S1, S2), malicious=M, model=faults)
        else:
            attack = attack_from_trap(graph, f, M, S1, S2, model=faults)
        return Finding(attack, "split", f"{'trapped' if faces == 2 else 'held apart'}: {attack.story()}")
    bound = "f-local set of nodes" if local else counted(f, "node")
    known = f"{f + 1}-robust without any {bound}" if faces == 2 else "no local violation"
    return Finding(None, "agreement", f"{known}: {counted(f, 'does', 'do')} not split it")
