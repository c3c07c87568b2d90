"""THE front of mending: ``mend`` adds the cheapest links that reach a goal, ``thin`` keeps the cheapest."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace

from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits, Progress
from robustness.mending.actions import Actions, CostLike, Link, actions_for, with_actions
from robustness.mending.certification import certify_mending
from robustness.mending.demands import sets_of
from robustness.mending.goal import Goal, Part, goals_of, parts_of
from robustness.mending.hitting_set import Search
from robustness.mending.master import load_solver
from robustness.mending.results import Demand, MendResult, MendVerdict, Problem
from robustness.natural_order import natural_key
from robustness.traps.question import Sets
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["links_within", "mend", "thin"]


@taking_numpy_integers
def mend(
    G: GraphLike,
    goal: object,
    *,
    candidates: Iterable[Link] | None = None,
    cost: CostLike = None,
    forbid: Iterable[Link] = (),
    mandatory: Iterable[Link] = (),
    max_in_degree: int | Mapping[Hashable, int] | None = None,
    one_way: bool | None = None,
    budget: float | None = None,
    any_choice: bool = False,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_improvement: Callable[[MendResult], None] | None = None,
) -> MendResult:
    """Return the cheapest links whose addition makes G reach a goal, exactly.

    Parameters
    ----------
    G : networkx graph or Digraph
        An arc ``(u, v)`` means v hears u. Never changed.
    goal : Goal, int, pair of int, or several of these
        What the network has to be: ``Goal(r=2, s=2)`` or ``(2, 2)``; ``Goal(survive=1, model="delayed")``; ``3`` for
        3-robust.
    candidates : iterable of pairs of nodes, optional
        The links that can be added; all that are not there unless given. :func:`links_within` gives those within a
        radio range.
    cost : mapping from links to numbers, or function of two nodes, optional
        What a link costs, at least 0; 1 unless given.
    forbid, mandatory : iterable of pairs of nodes
        Links that may not, and that must, be added.
    max_in_degree : int, or mapping from nodes to int, optional
        How many nodes a node that gains links can hear at most; one that the mapping leaves out, as many as it likes.
    one_way : bool, optional
        Whether an action is one arc; unless given, for directed graphs.
    budget : number, optional
        What the links may cost together at most; IMPOSSIBLE when nothing within it reaches the goal. For the most that
        a budget buys, see :func:`robustness.mending.best_within`.
    any_choice : bool
        End with the first links, within the budget, that reach the goal; they are FEASIBLE unless known to be cheapest.
    time_limit : float, optional
        Wall-clock seconds; past it the best links so far are FEASIBLE, with the lower bound that is proven.
    jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`.
    on_improvement : callable, optional
        Called with the result so far whenever the links or the bound improve.

    Returns
    -------
    MendResult

    Raises
    ------
    InvalidGraph, InvalidParameter
        For a goal, links or costs that cannot be meant.

    See Also
    --------
    robustness.thin : links that can be spared
    robustness.margin : how many losses it survives
    robustness.find_graph : a network from nothing

    Notes
    -----
    Adding links never destroys (r,s)-robustness, nor makes a trap or a violation, so every violation of a choice is one
    of every smaller choice (:mod:`robustness.mending.demands`). An implicit hitting set
    (:mod:`robustness.mending.hitting_set`) finds as many of them as the optimum needs. Exponential in the worst case.

    >>> import networkx as nx
    >>> found = mend(nx.path_graph(4), (2, 2))
    >>> found.verdict.value, found.cost, found.lower_bound
    ('optimal', 2, 2)
    """
    limits = _limits_of(time_limit, jobs, seed, progress)
    graph = as_digraph(G)
    goals = goals_of(goal)
    arcs_only = graph.directed if one_way is None else bool(one_way)
    actions = actions_for(
        graph,
        candidates,
        cost,
        forbid=forbid,
        require=mandatory,
        max_in_degree=max_in_degree,
        one_way=arcs_only,
        budget=budget,
    )
    return _answer(graph, goals, actions, limits, arcs_only, on_improvement, any_choice=any_choice)


@taking_numpy_integers
def thin(
    G: GraphLike,
    goal: object,
    *,
    cost: CostLike = None,
    keep: Iterable[Link] = (),
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_improvement: Callable[[MendResult], None] | None = None,
) -> MendResult:
    """Return the cheapest of G's own links that still reach a goal, exactly; the others can go.

    The dual of :func:`mend`: the empty network is mended with the links of G as candidates.

    Parameters
    ----------
    G, goal, cost, time_limit, jobs, seed, progress, on_improvement
        As for :func:`mend`; a cost is what it costs to keep a link.
    keep : iterable of pairs of nodes
        Links that may not go.

    Returns
    -------
    MendResult
        ``links`` stay and ``dropped`` go. IMPOSSIBLE when G itself does not reach the goal.

    See Also
    --------
    robustness.mend : links to add
    robustness.margin : how many losses it survives

    >>> import networkx as nx
    >>> found = thin(nx.complete_graph(5), (2, 2))
    >>> found.verdict.value, found.cost, len(found.dropped)
    ('optimal', 7, 3)
    """
    limits = _limits_of(time_limit, jobs, seed, progress)
    graph = as_digraph(G)
    goals = goals_of(goal)
    labels = graph.labels
    own = [(labels[u], labels[v]) for u, v in graph.arcs() if graph.directed or u < v]
    empty = Digraph(labels, [], directed=graph.directed)
    kept = list(keep)
    for link in kept:
        if tuple(link) not in own and tuple(reversed(link)) not in own:
            raise InvalidParameter(f"the link {link!r} that is to stay is not in the network: leave it out")
    actions = actions_for(empty, own, cost, forbid=(), require=kept, max_in_degree=None, one_way=graph.directed)

    def with_dropped(result: MendResult) -> MendResult:
        if result.cost is None:
            return replace(result, before=graph, graph=graph)
        stay = set(result.links)
        dropped = sorted(
            (
                link
                for link in own
                if (link not in stay and (link[1], link[0]) not in stay) or (graph.directed and link not in stay)
            ),
            key=natural_key,
        )
        return replace(result, before=graph, dropped=tuple(dropped), thinned=True)

    def tell(result: MendResult) -> None:
        if on_improvement is not None:
            on_improvement(with_dropped(result))

    return with_dropped(_answer(empty, goals, actions, limits, graph.directed, tell))


def _limits_of(time_limit: float | None, jobs: int, seed: int, progress: Callable[[Progress], None] | None) -> Limits:
    """Return the limits; their clock starts when the solver has been imported."""
    if time_limit is not None:
        load_solver()
    return Limits.of(time_limit, jobs, seed, progress)


#: Seconds that are kept back for the result, and for each action.
_TELLING, _TELLING_EACH = 0.05, 2e-5


def links_within(positions: Mapping[Hashable, Sequence[float]], reach: float) -> list[Link]:
    """Return all pairs of nodes whose places are at most ``reach`` apart: what a radio of this range can link.

    Raises
    ------
    InvalidParameter
        When ``reach`` is no number of at least 0.

    >>> links_within({"a": (0, 0), "b": (3, 4), "c": (9, 9)}, 5.0)
    [('a', 'b')]
    """
    if not reach >= 0:
        raise InvalidParameter(f"a range is a number of at least 0, not {reach!r}")
    nodes = sorted(positions, key=natural_key)
    return [
        (u, v)
        for k, u in enumerate(nodes)
        for v in nodes[k + 1 :]
        if sum((a - b) ** 2 for a, b in zip(positions[u], positions[v], strict=True)) <= reach * reach
    ]


def _answer(
    graph: Digraph,
    goals: tuple[Goal, ...],
    actions: Actions,
    limits: Limits,
    one_way: bool,
    on_improvement: Callable[[MendResult], None] | None,
    *,
    any_choice: bool = False,
) -> MendResult:
    started = time.monotonic()
    parts = parts_of(goals, graph.n)

    def told(search: Search) -> None:
        if on_improvement is not None:
            on_improvement(_result(search, goals, one_way, time.monotonic() - started))

    # What is found has to be told within the limit as well.
    kept_back = min(limits.seconds_left() / 5, _TELLING + _TELLING_EACH * len(actions.items))
    in_time = limits if limits.deadline is None else replace(limits, deadline=limits.deadline - kept_back)
    search = Search(graph, actions, parts, in_time, told, any_choice)
    search.run()
    return _result(search, goals, one_way, time.monotonic() - started)


def _result(search: Search, goals: tuple[Goal, ...], one_way: bool, seconds: float) -> MendResult:
    graph, actions, best = search.graph, search.actions, search.best
    if search.is_impossible:
        verdict = MendVerdict.IMPOSSIBLE
    elif best is None:
        verdict = MendVerdict.UNDECIDED
    else:
        verdict = MendVerdict.OPTIMAL if search.is_optimal else MendVerdict.FEASIBLE
    chosen = frozenset() if best is None else best
    ends = [tuple(graph.labels[i] for i in actions.items[a].ends) for a in chosen]
    return MendResult(
        verdict,
        goals,
        tuple(sorted(ends, key=natural_key)),  # type: ignore[arg-type]
        None if best is None else actions.price(search.cost(best)),
        actions.price(search.bound),
        with_actions(graph, actions, chosen),
        graph,
        demands=tuple(_demand(first.part, graph, sets_of(first, second)) for first, second in search.rows),
        witness=None if search.witness is None else _demand(search.witness[0], graph, search.witness[1]),
        one_way=one_way,
        reason=search.reason,
        seconds=seconds,
        problem=_problem(search),
        certify=certify_mending,
    )


def _problem(search: Search) -> Problem:
    pairs: tuple[tuple[Part, Sets], ...]
    if search.is_impossible and search.witness is not None:
        pairs = (search.witness,) if search.witness[1].S1 else ()
    else:
        pairs = tuple((first.part, sets_of(first, second)) for first, second in search.rows)
    covers = () if search.is_impossible and search.witness is not None else tuple(search.covers)
    beyond_budget = search.is_impossible and search.witness is None and search.actions.budget is not None
    least = None if search.is_impossible and not beyond_budget else search.bound
    return Problem(
        search.graph, search.actions, tuple(search.parts), search.best, least, pairs, covers, search.is_up_to_swapping
    )


def _demand(part: Part, graph: Digraph, sets: Sets) -> Demand:
    M, S1, S2 = (graph.labels_of(ids) for ids in sets)
    return Demand(str(part), M, S1, S2)
