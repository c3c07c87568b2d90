"""A trap as a user holds it, sets of labels, and the search for one with as few malicious nodes as possible.

A trap for f exists iff for some M with at most f nodes the graph without M is not (f+1)-robust: (S1, S2) is
a pair that violates it. The definition is in :mod:`robustness.traps.question`; how the delays keep S1 and S2 apart, in
:mod:`robustness.simulation.attacks`.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from itertools import combinations

from certificates.graph import Label
from robustness.decision.front import check_within
from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter, Undecided
from robustness.limits import Limits, Progress
from robustness.natural_order import in_natural_order
from robustness.results import Verdict
from robustness.traps.question import Question, Sets, solves

__all__ = ["Trap", "is_trap", "smallest_trap"]


@dataclass(frozen=True, slots=True)
class Trap:
    """A trap (M, S1, S2); see the module."""

    M: frozenset[Label]
    S1: frozenset[Label]
    S2: frozenset[Label]

    def as_dict(self) -> dict[str, list[Label]]:
        """Return the sets as lists in natural order, as kept in ``G.graph["trap"]``."""
        return {name: in_natural_order(getattr(self, name)) for name in ("M", "S1", "S2")}


def is_trap(G: GraphLike, f: int, M: Iterable[Hashable], S1: Iterable[Hashable], S2: Iterable[Hashable]) -> bool:
    """Return whether (M, S1, S2) is a trap for f in G.

    Parameters
    ----------
    G : networkx graph or Digraph
        An arc ``(u, v)`` means v hears u.
    f : int
        At least 0.
    M, S1, S2 : iterables of nodes
        The malicious set and the two sets held apart.

    Raises
    ------
    InvalidParameter
        For a negative f.
    InvalidGraph
        When a set holds something that is not a node of G.

    Notes
    -----
    Linear in the in-degrees of S1 and S2.

    >>> import networkx as nx
    >>> is_trap(nx.wheel_graph(5), 1, {0}, {1, 2}, {3, 4})
    True
    """
    _require_f(f)
    graph = as_digraph(G)
    return solves(graph, Question(f), Sets(graph.ids(M), graph.ids(S1), graph.ids(S2)))


def smallest_trap(
    G: GraphLike,
    f: int,
    *,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> Trap | None:
    """Return a trap for f in G with a smallest M, or None when G has none.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    time_limit : float, optional
        Wall-clock seconds in all.
    jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`.

    Raises
    ------
    Undecided
        When the limit stopped the search and no trap was found.

    Notes
    -----
    Straight from the equivalence in the module: one exact (f+1)-robustness check for each of the
    ``sum C(n, m), m <= f`` sets M. For small n and f.

    >>> import networkx as nx
    >>> smallest_trap(nx.wheel_graph(5), 1).M
    frozenset({0})
    >>> smallest_trap(nx.complete_graph(5), 1) is None
    True
    """
    _require_f(f)
    graph = as_digraph(G)
    limits = Limits.of(time_limit, jobs, seed, progress)
    for size in range(min(f, graph.n - 2) + 1):
        for removed in combinations(range(graph.n), size):
            rest = graph.without(frozenset(removed))
            result = check_within(rest, f + 1, 1, limits)
            if result.verdict is Verdict.UNDECIDED:
                raise Undecided(f"whether a trap for f = {f} exists was not decided: raise the time limit")
            if result.witness is not None:
                return Trap(graph.labels_of(removed), result.witness.S1, result.witness.S2)
    return None


def _require_f(f: int) -> None:
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
