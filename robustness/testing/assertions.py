"""Assertions about graphs; their messages draw the violating pair."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from robustness.decision.front import check_rs_robustness
from robustness.definitions import r_reachable_ids
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import Undecided
from robustness.results import Verdict, Witness
from robustness.spelled import counted, robust

__all__ = ["assert_not_robust", "assert_robust", "draw_violation"]


def assert_robust(G: GraphLike, r: int, s: int = 1, **options: Any) -> None:
    """Assert that G is (r,s)-robust; the message draws the violating pair.

    Parameters
    ----------
    G, r, s, **options
        As for :func:`robustness.check_rs_robustness`.

    Raises
    ------
    AssertionError
        When it is not.
    Undecided
        When a limit stopped the check.

    >>> import networkx as nx
    >>> assert_robust(nx.path_graph(4), 2, algorithm="exhaustive")
    Traceback (most recent call last):
        ...
    AssertionError: not 2-robust: 0 of 4 nodes of S1 and S2 hear 2 or more nodes outside their set
      S1 = {0}
        0  hears 1 outside {1}, 0 inside
      S2 = {1, 2, 3}
        1  hears 1 outside {0}, 1 inside {2}
        2  hears 0 outside, 2 inside {1, 3}
        3  hears 0 outside, 1 inside {2}
    """
    graph = as_digraph(G)
    result = check_rs_robustness(graph, r, s, **options)
    if result.verdict is Verdict.UNDECIDED:
        raise Undecided(f"{robust(r, s)}ness was not decided: raise the time limit")
    if result.verdict is Verdict.NOT_ROBUST:
        raise AssertionError(draw_violation(graph, result.witness, r, s))


def assert_not_robust(G: GraphLike, r: int, s: int = 1, **options: Any) -> Witness | None:
    """Assert that G is not (r,s)-robust, and return the violating pair (None for fewer than two nodes).

    Parameters, errors
        As for :func:`assert_robust`.

    >>> import networkx as nx
    >>> assert_not_robust(nx.complete_graph(5), 3)
    Traceback (most recent call last):
        ...
    AssertionError: 3-robust, though it should not be: 5 nodes, 20 arcs, no violating pair exists
    """
    graph = as_digraph(G)
    result = check_rs_robustness(graph, r, s, **options)
    if result.verdict is Verdict.UNDECIDED:
        raise Undecided(f"{robust(r, s)}ness was not decided: raise the time limit")
    if result.verdict is Verdict.ROBUST:
        size = f"{counted(graph.n, 'node')}, {counted(graph.arc_count, 'arc')}"
        raise AssertionError(f"{robust(r, s)}, though it should not be: {size}, no violating pair exists")
    return result.witness


def draw_violation(graph: Digraph, pair: Witness | None, r: int, s: int = 1) -> str:
    """Return in words and lines why ``pair`` violates (r,s)-robustness; a node marked * hears at least r outside."""
    if pair is None:
        return f"not {robust(r, s)}: fewer than two nodes, and r is greater than their number"
    sides = [graph.ids(side) for side in pair]
    reachable = [r_reachable_ids(graph, side, r) for side in sides]
    count, total = sum(map(len, reachable)), sum(map(len, sides))
    lines = [
        f"not {robust(r, s)}: {count} of {counted(total, 'node')} of S1 and S2 hear {r} or more nodes outside their set"
    ]
    for name, side, reached in zip(("S1", "S2"), sides, reachable, strict=True):
        lines.append(f"  {name} = {_set_text(graph, side)}")
        width = max(len(repr(graph.labels[i])) for i in side)
        for i in sorted(side):
            heard = graph.in_neighbours(i).tolist()
            outside, inside = [j for j in heard if j not in side], [j for j in heard if j in side]
            parts = ", ".join(
                f"{len(ids)} {where}" + (f" {_set_text(graph, ids)}" if ids else "")
                for ids, where in ((outside, "outside"), (inside, "inside"))
            )
            lines.append(f"    {graph.labels[i]!r:<{width}} {'*' if i in reached else ' '}hears {parts}")
    return "\n".join(line.rstrip() for line in lines)


def _set_text(graph: Digraph, ids: Iterable[int]) -> str:
    return "{" + ", ".join(repr(graph.labels[i]) for i in sorted(ids)) + "}"
