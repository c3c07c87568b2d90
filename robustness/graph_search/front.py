"""Search for graphs with given properties: :func:`find_graph`.

>>> from robustness.graph_search import find_graph
>>> result = find_graph(range(2, 7), satisfies=["2-robust", "(2,2)-robust", "min-degree>=3", "trap(1)"])
>>> result.verdict.value, result.n, result.edges
('found', 5, 8)
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from robustness.cubes.executors import require_executor
from robustness.digraph import Digraph
from robustness.errors import InternalError, InvalidParameter, Undecided
from robustness.graph_search.enumeration import can_enumerate, first_fitting
from robustness.graph_search.properties import (
    HasTrap,
    Property,
    parse_property,
)
from robustness.graph_search.results import FindResult, FindVerdict
from robustness.graph_search.synthesis import Synthesis, synthesise
from robustness.limits import Limits, Progress
from robustness.spelled import counted
from robustness.traps.smallest import smallest_trap
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["METHODS", "find_graph"]

METHODS = ("auto", "enumeration", "cp-sat")


@dataclass(frozen=True, slots=True)
class _Search:
    """The question, validated once."""

    satisfies: tuple[Property, ...]
    violates: tuple[Property, ...]
    directed: bool
    minimise: bool
    limits: Limits
    method: str
    symmetry_breaking: bool


@taking_numpy_integers
def find_graph(
    n: int | Iterable[int],
    satisfies: Sequence[Property | str] = (),
    violates: Sequence[Property | str] = (),
    *,
    directed: bool = False,
    minimise: str | None = None,
    time_limit: float | None = None,
    method: str = "auto",
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    symmetry_breaking: bool = True,
    executor: Any = None,
    on_result: Callable[[FindResult], None] | None = None,
) -> FindResult:
    """Search for a graph that has all properties in ``satisfies`` and none of those in ``violates``.

    Parameters
    ----------
    n : int or iterable of int
        The number of nodes; several are tried in ascending order, and the first with a graph wins: the smallest graph.
    satisfies, violates : sequences of properties or of their texts
        See :mod:`robustness.graph_search.properties`. Beyond the listed graphs only the properties of that module.
    directed : bool
        Whether to search among digraphs.
    minimise : None or "edges"
        Whether to look for the fewest edges (arcs). Enumeration finds the fewest anyway.
    time_limit : float, optional
        Wall-clock seconds in all; past it the verdict is UNDECIDED.
    method : "auto", "enumeration" or "cp-sat"
        ``"auto"`` enumerates where all graphs are listed up to isomorphism, up to 7 nodes (digraphs: 5), and otherwise
        uses CP-SAT with the arcs as unknowns, adding violated pairs, traps and separators as they are found.
    jobs, seed : int
        Threads and random seed of CP-SAT.
    progress : callable, optional
        Called with a :class:`~robustness.limits.Progress` after every graph that CP-SAT proposed.
    symmetry_breaking : bool
        Whether CP-SAT may number the nodes by role or degree; it changes the time, never the verdict.
    executor : concurrent.futures.Executor, distributed.Client or CubeExecutor, optional
        Where the exact searches for violating pairs of what is proposed are solved, by cubes.
    on_result : callable, optional
        Called with an UNDECIDED result whenever more is proven: that no graph of a size fits, or that fewer edges do
        not, or a graph that fits.

    Returns
    -------
    FindResult
        FOUND with a re-checked graph, IMPOSSIBLE, or UNDECIDED. With ``HasTrap`` in ``satisfies`` the graph has a
        trap in ``G.graph["trap"]``.

    Raises
    ------
    InvalidParameter
        For a property that does not parse, numbers of nodes below 0, or a method that cannot serve them.

    See Also
    --------
    robustness.mend : from a network that is there

    >>> find_graph(6, satisfies=["3-connected"], violates=["2-robust"]).verdict.value
    'found'
    >>> find_graph(range(1, 6), satisfies=["3-robust"], violates=["min-degree>=3"]).verdict.value
    'impossible'
    """
    started = time.monotonic()
    sizes = _sizes(n)
    require_executor(executor)
    limits = Limits.of(time_limit, jobs, seed, progress).spread_over(executor)
    search = _search(satisfies, violates, directed, minimise, limits, method, symmetry_breaking)
    impossible: list[int] = []

    def whole(result: FindResult) -> FindResult:
        return replace(result, impossible_for=tuple(impossible), seconds=time.monotonic() - started)

    def tell(known: FindResult) -> None:
        if on_result is not None:
            on_result(whole(known))

    result = FindResult(FindVerdict.IMPOSSIBLE)
    for size in sizes:
        result = _find_on(size, search, tell)
        if result.verdict is not FindVerdict.IMPOSSIBLE:
            break
        impossible.append(size)
        tell(FindResult(FindVerdict.UNDECIDED, method=result.method))
    return whole(result)


def _find_on(n: int, search: _Search, tell: Callable[[FindResult], None]) -> FindResult:
    """Return the answer for one number of nodes; ``tell`` hears what is known before."""
    listed = can_enumerate(n, directed=search.directed)
    if search.method == "enumeration" and not listed:
        raise InvalidParameter(
            f"graphs on {counted(n, 'node')} are not listed up to isomorphism: use method 'auto' or 'cp-sat'"
        )
    if search.method == "enumeration" or (listed and (search.method == "auto" or n < 2)):
        try:
            graph = first_fitting(n, search.satisfies, search.violates, directed=search.directed, limits=search.limits)
        except Undecided as limit:
            return FindResult(FindVerdict.UNDECIDED, n=n, method="enumeration", stats={"reason": str(limit)})
        return _answer(graph, n, search, "enumeration", fewest=True)
    return _synthesise_on(n, search, tell)


def _synthesise_on(n: int, search: _Search, tell: Callable[[FindResult], None]) -> FindResult:
    found = synthesise(
        n,
        search.satisfies,
        search.violates,
        directed=search.directed,
        minimise=search.minimise,
        limits=search.limits,
        symmetry_breaking=search.symmetry_breaking,
        on_known=lambda known: tell(_known(n, search, known)),
    )
    stats = MappingProxyType(found.stats)
    if not found.is_complete and found.graph is None:
        return _known(n, search, found)
    fewest = search.minimise and found.is_complete
    return _answer(
        found.graph,
        n,
        search,
        "cp-sat",
        fewest=fewest,
        at_least=found.edges_at_least,
        stats=stats,
        decided=found.is_complete,
    )


def _known(n: int, search: _Search, found: Synthesis) -> FindResult:
    """Return what the search on n nodes knows before it is over."""
    stats, at_least = MappingProxyType(dict(found.stats)), found.edges_at_least
    if found.graph is None:
        return FindResult(FindVerdict.UNDECIDED, n=n, edges_at_least=at_least, method="cp-sat", stats=stats)
    return _answer(found.graph, n, search, "cp-sat", fewest=False, at_least=at_least, stats=stats, decided=False)


def _answer(
    graph: Digraph | None,
    n: int,
    search: _Search,
    method: str,
    *,
    fewest: bool,
    at_least: int = 0,
    stats: Mapping[str, Any] = MappingProxyType({}),
    decided: bool = True,
) -> FindResult:
    """Return a result after checking the graph once more against everything asked for."""
    if graph is None:
        return FindResult(FindVerdict.IMPOSSIBLE, n=n, method=method, stats=stats)
    made = graph.to_networkx()
    try:
        broken = [str(each) for each in search.satisfies if not each.holds(graph, search.limits)]
        broken += [f"not {each}" for each in search.violates if each.holds(graph, search.limits)]
        for each in search.satisfies:
            if isinstance(each, HasTrap):
                trap = smallest_trap(graph, each.f, **search.limits.spread_over().keywords())
                made.graph["trap"] = None if trap is None else trap.as_dict()
    except Undecided as limit:
        return FindResult(FindVerdict.UNDECIDED, n=n, method=method, stats={**stats, "reason": str(limit)})
    if broken:
        raise InternalError(f"a graph that was found is not {' and '.join(broken)}: please report")
    edges = graph.arc_count if graph.directed else graph.arc_count // 2
    verdict = FindVerdict.FOUND if decided else FindVerdict.UNDECIDED
    return FindResult(
        verdict,
        made,
        n,
        edges,
        has_fewest_edges=fewest,
        edges_at_least=max(at_least, edges if fewest else 0),
        method=method,
        stats=stats,
    )


def _search(
    satisfies: Sequence[Property | str],
    violates: Sequence[Property | str],
    directed: bool,
    minimise: str | None,
    limits: Limits,
    method: str,
    symmetry_breaking: bool,
) -> _Search:
    if minimise not in (None, "edges"):
        raise InvalidParameter(f"minimise is None or 'edges', not {minimise!r}")
    if method not in METHODS:
        raise InvalidParameter(f"method is one of {', '.join(METHODS)}, not {method!r}")
    return _Search(
        _properties(satisfies),
        _properties(violates),
        directed,
        minimise is not None,
        limits,
        method,
        symmetry_breaking,
    )


def _properties(given: Sequence[Property | str]) -> tuple[Property, ...]:
    if isinstance(given, str):
        raise InvalidParameter(f"properties come in a list, even a single one: [{given!r}]")
    read = tuple(parse_property(each) if isinstance(each, str) else each for each in given)
    for each in read:
        if not isinstance(each, Property):
            raise InvalidParameter(f"a property has a method holds(graph, limits), and {each!r} has none")
    return read


def _sizes(n: int | Iterable[int]) -> list[int]:
    sizes = sorted({n} if isinstance(n, int) else set(n))
    if not sizes or any(type(size) is not int or size < 0 for size in sizes):
        raise InvalidParameter(f"n is a number of nodes of at least 0, or several of these, not {n!r}")
    return sizes
