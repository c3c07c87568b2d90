"""THE front: ``tolerance(G)``, what a network survives under each threat model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, overload

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits, Progress
from robustness.spelled import counted
from robustness.threat_models.decisions import Decisions
from robustness.threat_models.models import THREAT_MODELS, threat_model_named
from robustness.threat_models.over_time import MODELS_OVER_TIME, JointDecisions, over_time
from robustness.threat_models.parameters import Parameters
from robustness.threat_models.results import ToleranceResult, ToleranceTable
from robustness.threat_models.verdicts import judge
from robustness.time_varying import TimeVaryingGraph
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["tolerance", "tolerance_within"]


@overload
def tolerance(
    G: GraphLike,
    model: str,
    *,
    tau: int | None = None,
    delay: int | None = None,
    gap: int | None = None,
    T: float | None = None,
    alpha: float | None = None,
    sigma: float | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_result: Callable[[ToleranceResult], None] | None = None,
) -> ToleranceResult: ...


@overload
def tolerance(
    G: GraphLike,
    model: None = None,
    *,
    tau: int | None = None,
    delay: int | None = None,
    gap: int | None = None,
    T: float | None = None,
    alpha: float | None = None,
    sigma: float | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_result: Callable[[ToleranceResult], None] | None = None,
) -> ToleranceTable: ...


@taking_numpy_integers
def tolerance(
    G: GraphLike,
    model: str | None = None,
    *,
    tau: int | None = None,
    delay: int | None = None,
    gap: int | None = None,
    T: float | None = None,
    alpha: float | None = None,
    sigma: float | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_result: Callable[[ToleranceResult], None] | None = None,
) -> ToleranceResult | ToleranceTable:
    """Return the largest f that a network survives under a threat model, and the smallest f with an attack.

    Every f is one or the other, or undecided because a limit stopped the work: the conditions are exact
    (docs/theorems.md).

    Parameters
    ----------
    G : networkx graph, Digraph or TimeVaryingGraph
        An arc ``(u, v)`` means v hears u. Never changed. Of a time-varying network only the delayed models are known;
        see :mod:`robustness.threat_models.over_time`.
    model : str, optional
        A name in ``THREAT_MODELS``: ``"malicious"``, ``"byzantine"`` or ``"delayed"``, each also with ``"-local"``.
        Without one: all of them, as a table.
    tau : int, optional
        For a time-varying network, and only there, at least 1: how many steps after it was sent a value is still used,
        also through a link that has gone.
    delay, gap : int, optional
        The bound on delays and the longest gap between two updates of a vehicle. With tau they are part of the
        question: at least 1 (tau unless given; 1 unless given), and a value may not be late before it is used:
        ``delay + gap - 1 <= tau``. On a fixed network the answer is the same for all of them.
    T, alpha, sigma : float, optional
        The sampling period, the gain (``1.5 / T`` unless given) and a bound on the sum of kept weights (1 unless given)
        of second-order vehicles. With these, ``delay`` and ``gap``, ``result.parameters`` says whether what is known
        applies to them, and what would make it apply.
    time_limit : float, optional
        Wall-clock seconds in all; what is not decided by then is UNDECIDED, and nothing is claimed about it.
    jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`.
    on_result : callable, optional
        Called with the result of each threat model as soon as it is known.

    Returns
    -------
    ToleranceResult
        ``guaranteed`` (-1 when not even f = 0 is promised), ``refuted``, ``reasons``, ``standing(f)`` and ``attack``.
    ToleranceTable
        Without a model: the results by name.

    Raises
    ------
    InvalidGraph, InvalidParameter
        For input the definitions do not speak about.

    See Also
    --------
    robustness.simulate : a run with liars
    robustness.check_rs_robustness : the property of the network alone
    robustness.mend : links that make it survive

    Notes
    -----
    f = 0 is agreement without adversaries: 1-robustness, a node that reaches all others. On fewer than two nodes nobody
    can disagree: guaranteed is 0, nothing is refuted, and every f stands as guaranteed. Every attack leaves at least
    two normal nodes, one on either side. All graphs on two or more nodes have one for ``f = ceil(n/2)`` (one face) or
    for ``f = ceil(n/3)`` (two faces): with so many values discarded, nobody moves.

    Exponential in the worst case: it decides robustness, which is coNP-complete.

    >>> import networkx as nx
    >>> table = tolerance(nx.wheel_graph(5))
    >>> table.guaranteed["malicious"], table["delayed"].refuted
    (1, 1)
    >>> table["delayed"].attack.malicious
    frozenset({0})
    """
    limits = Limits.of(time_limit, jobs, seed, progress)
    decisions, names = _questions(G, model, (tau, delay, gap), limits)
    parameters = Parameters.of(T, alpha, sigma, delay, gap)
    over = over_time if isinstance(decisions, JointDecisions) else threat_model_named
    results: list[ToleranceResult] = []
    for name in names:
        result = replace(judge(decisions, over(name)), parameters=parameters)
        if isinstance(decisions, JointDecisions):
            result = replace(
                result,
                sequence=decisions.sequence,
                tau=decisions.tau,
                delay=decisions.delay,
                gap=decisions.gap,
                longest_window=decisions.longest_window,
            )
        results.append(result)
        if on_result is not None:
            on_result(result)
    return results[0] if model is not None else ToleranceTable(decisions.graph, tuple(results))


def tolerance_within(graph: Digraph, limits: Limits) -> ToleranceTable:
    """Do what :func:`tolerance` does under every threat model, within ``limits``.

    For those of this package who have limits of their own, and budgets of steps with them.
    """
    decisions = Decisions(graph, limits)
    return ToleranceTable(graph, tuple(judge(decisions, threat) for threat in THREAT_MODELS.values()))


def _questions(
    G: Any, model: str | None, ages: tuple[int | None, int | None, int | None], limits: Limits
) -> tuple[Decisions, tuple[str, ...]]:
    """Return what decides about G, and the threat models to decide about."""
    if not isinstance(G, TimeVaryingGraph):
        if ages[0] is not None:
            raise InvalidParameter("tau belongs to a time-varying network: leave it out, or pass a TimeVaryingGraph")
        names = tuple(THREAT_MODELS) if model is None else (threat_model_named(model).name,)
        return Decisions(as_digraph(G), limits), names
    tau, delay, gap = ages
    if type(tau) is not int or tau < 1:
        raise InvalidParameter(f"a time-varying network needs tau, an integer of at least 1, not {tau!r}")
    delay, gap = tau if delay is None else delay, 1 if gap is None else gap
    for name, value in (("delay", delay), ("gap", gap)):
        if type(value) is not int or value < 1:
            raise InvalidParameter(f"{name} is an integer of at least 1, not {value!r}")
    if delay > tau:
        raise InvalidParameter(
            f"with delays up to {counted(delay, 'step')} values are used for at least as long: raise tau to {delay}"
        )
    names = MODELS_OVER_TIME if model is None else (over_time(model).name,)
    union = G.union(0, len(G))
    return JointDecisions(union, limits, sequence=G, tau=tau, delay=delay, gap=gap), names
