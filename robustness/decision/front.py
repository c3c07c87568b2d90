"""THE front: every question about (r,s)-robustness of one graph comes through here.

A question is validated here, once; the ladder (:mod:`robustness.decision.ladder`) answers it, with what decided and a
violating pair that was checked against the definition.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from robustness.answers import Question
from robustness.cubes.executors import require_executor
from robustness.decision.algorithms import require_algorithm, require_options
from robustness.decision.bounds import quick_bounds
from robustness.decision.determination import determine, profile
from robustness.decision.ladder import decide
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.limits import Limits, Progress
from robustness.results import Bounds, RobustnessResult, Verdict
from robustness.whole_numbers import taking_numpy_integers

__all__ = [
    "check_rs_robustness",
    "check_within",
    "determine_robustness",
    "determine_within",
    "is_r_robust",
    "is_rs_robust",
    "robustness_profile",
]


@taking_numpy_integers
def is_r_robust(G: GraphLike, r: int, **options: Any) -> bool:
    """Return whether G is r-robust, that is (r,1)-robust.

    Takes the options of :func:`check_rs_robustness`; raises :class:`Undecided` when a limit stopped it.

    >>> import networkx as nx
    >>> is_r_robust(nx.complete_graph(5), 3)
    True
    """
    return check_rs_robustness(G, r, 1, **options).decided()


@taking_numpy_integers
def is_rs_robust(G: GraphLike, r: int, s: int, **options: Any) -> bool:
    """Return whether G is (r,s)-robust.

    Takes the options of :func:`check_rs_robustness`; raises :class:`Undecided` when a limit stopped it.

    >>> import networkx as nx
    >>> is_rs_robust(nx.wheel_graph(5), 2, 2), is_rs_robust(nx.wheel_graph(5), 3, 1)
    (True, False)
    """
    return check_rs_robustness(G, r, s, **options).decided()


@taking_numpy_integers
def check_rs_robustness(
    G: GraphLike,
    r: int,
    s: int = 1,
    *,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    executor: Any = None,
    state: str | Path | None = None,
    **options: Any,
) -> RobustnessResult:
    """Decide whether G is (r,s)-robust.

    Definition: for every pair of nonempty disjoint node sets S1, S2 at least one holds: every node of S1 has at
    least r in-neighbours outside S1; likewise for S2; or at least s nodes of the two sets together do.

    Parameters
    ----------
    G : networkx Graph or DiGraph, or Digraph
        An arc ``(u, v)`` means v hears u. Never changed.
    r : int
        At least 0. Every graph is (0,s)-robust; none on n nodes is (r,s)-robust for r > ceil(n/2).
    s : int
        In 1..n.
    algorithm : str
        A name in ``ALGORITHMS``, or ``"auto"``: ``transform`` on up to 20 nodes; cheap bounds and then
        ``subset-search`` on all others, which on up to 28 nodes and for s > 1 gives way to ``transform`` where it would
        take longer. What decided is recorded in the result.
    time_limit : float, optional
        Wall-clock seconds; past it the verdict is UNDECIDED.
    jobs : int
        Threads.
    seed : int
        Of the heuristics; it changes the time taken and the pair found, never the verdict.
    progress : callable, optional
        Called now and then with a :class:`~robustness.limits.Progress`.
    executor : concurrent.futures.Executor, distributed.Client or robustness.cubes.CubeExecutor, optional
        Who solves the cubes of ``subset-search`` in place of threads of this process. It stays open. Workers that
        are lost change nothing, or leave the question UNDECIDED: ``docs/cluster.md``.
    state : path, optional
        A journal to which every closed cube of ``subset-search`` is appended; asked again with it, here or on another
        machine, the search goes on where it was.
    **options
        Switches of the algorithm, listed in ``algorithms.OPTIONS``; they never change a verdict.

    Returns
    -------
    RobustnessResult
        ROBUST; NOT_ROBUST with a re-checked violating pair; or UNDECIDED.

    Raises
    ------
    InvalidGraph, InvalidParameter
        For input the definition does not speak about.
    TypeError
        For an option that the algorithm does not have.

    See Also
    --------
    robustness.determine_robustness : the greatest r, and s with it
    robustness.certify : the same, with evidence that a small program checks
    robustness.mend : the links that make it so

    Notes
    -----
    coNP-complete (Zhang, Fata, Sundaram 2015). Source of the definition: LeBlanc, Zhang, Koutsoukos, Sundaram
    2013; Definition 1 of the source paper.

    >>> import networkx as nx
    >>> check_rs_robustness(nx.cycle_graph(6), 2).verdict
    <Verdict.NOT_ROBUST: 'not-robust'>
    """
    require_executor(executor)
    require_algorithm(algorithm)
    require_options("check_rs_robustness", algorithm, options)
    question = Question.about(G, r, s)
    limits = Limits.of(time_limit, jobs, seed, progress).spread_over(executor, state)
    result = check_within(*question, limits, algorithm, options)
    if result.verdict is Verdict.UNDECIDED and result.bounds is not None:
        return replace(result, bounds=result.bounds.met_with(quick_bounds(question.graph)))
    return result


def check_within(
    graph: Digraph,
    r: int,
    s: int,
    limits: Limits,
    algorithm: str = "auto",
    options: Mapping[str, Any] = MappingProxyType({}),
) -> RobustnessResult:
    """Do what :func:`check_rs_robustness` does for a question that is known to be valid, within ``limits``.

    For those of this package who have limits of their own, and budgets of steps with them.
    """
    started = time.monotonic()
    question = Question(graph, r, s)
    answer = decide(question, limits, algorithm, options)
    return RobustnessResult.of(question, answer, time.monotonic() - started)


@taking_numpy_integers
def determine_robustness(
    G: GraphLike,
    *,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    s_time_limit: float | None = None,
    on_bounds: Callable[[Bounds], None] | None = None,
    executor: Any = None,
    state: str | Path | None = None,
) -> RobustnessResult:
    """Return r*, the greatest r for which G is r-robust, and then the greatest s for which G is (r*,s)-robust.

    Parameters
    ----------
    G, algorithm, time_limit, jobs, seed, progress, executor, state
        As for :func:`check_rs_robustness`. Short searches on the way are done here.
    s_time_limit : float, optional
        Seconds that the search for s may go on once r* is known. Without it the search uses what ``time_limit`` leaves;
        and without that it goes on until s is exact on up to 28 nodes, when an algorithm is named, and otherwise for a
        budget of steps (about two seconds).
    on_bounds : callable, optional
        Called with the proven :class:`~robustness.results.Bounds` on r* each time they improve.

    Returns
    -------
    RobustnessResult
        DETERMINED: ``r`` is r* exactly, ``s`` the greatest s that is proven, and ``s_bounds`` tells what s_max(r*) can
        be (``s_is_exact`` when nothing else). ``profile`` is the whole table where it was computed on the way: on up to
        22 nodes, unless an algorithm is named or a limit came first. UNDECIDED, when a limit stopped it before r* was
        known, with the best proven r and ``bounds``. ``witness`` is a pair that violates (r* + 1, 1).

    See Also
    --------
    robustness.check_rs_robustness : one (r,s)
    robustness.robustness_profile : the greatest s for every r
    robustness.tolerance : what it means for liars

    Notes
    -----
    The upper bound is lowered by violating pairs first, so that exact search has one r to refute.

    >>> import networkx as nx
    >>> result = determine_robustness(nx.wheel_graph(7))
    >>> result.r, result.s
    (2, 3)
    """
    started = time.monotonic()
    graph = as_digraph(G)
    require_algorithm(algorithm)
    require_executor(executor)
    limits = Limits.of(time_limit, jobs, seed, progress).spread_over(executor, state)
    limits.within(s_time_limit, "s_time_limit")
    found = determine(graph, algorithm, limits, s_time_limit, on_bounds)
    return replace(found, seconds=time.monotonic() - started, graph=graph)


def determine_within(graph: Digraph, limits: Limits) -> RobustnessResult:
    """Do what :func:`determine_robustness` does, within ``limits``; see :func:`check_within`."""
    started = time.monotonic()
    found = determine(graph, "auto", limits, None, None)
    return replace(found, seconds=time.monotonic() - started, graph=graph)


@taking_numpy_integers
def robustness_profile(
    G: GraphLike,
    *,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> Mapping[int, int]:
    """Return the robustness profile of G: ``r -> s_max(r)`` for r = 1 .. ceil(n/2).

    ``s_max(r)`` is the largest s <= n for which G is (r,s)-robust, 0 when G is not even r-robust.

    Parameters
    ----------
    G, algorithm, time_limit, jobs, seed, progress
        As for :func:`check_rs_robustness`.

    Raises
    ------
    Undecided
        When a limit stopped it. Its ``profile`` holds the values that are proven by then, and its ``bounds`` the
        interval of the r at which it stopped.

    See Also
    --------
    robustness.determine_robustness : the greatest r alone, on larger networks

    >>> import networkx as nx
    >>> dict(robustness_profile(nx.wheel_graph(5)))
    {1: 5, 2: 5, 3: 0}
    """
    graph = as_digraph(G)
    require_algorithm(algorithm)
    return profile(graph, algorithm, Limits.of(time_limit, jobs, seed, progress))
