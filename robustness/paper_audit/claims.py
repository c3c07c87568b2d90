"""What a claim of the paper is, and what can become of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

from robustness.constructions.small_graphs import each_graph
from robustness.digraph import Digraph
from robustness.threat_models.results import AttackSets

__all__ = ["DIGRAPHS", "GRAPHS", "RANGE", "Claim", "Outcome", "failing", "holding", "small_graphs"]

#: Claims about all graphs are tried on all graphs and digraphs up to so many nodes, up to isomorphism.
GRAPHS, DIGRAPHS = 6, 4

RANGE = f"search: all graphs on 2 to {GRAPHS} nodes, all digraphs on 2 to {DIGRAPHS}"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a claim.

    Attributes
    ----------
    result : str
        ``"holds"``, ``"fails"``, ``"holds corrected"``, ``"contradicts itself"`` or ``"not checkable"``.
    how : str
        What was tried.
    note : str
        What exactly was found.
    counterexample : Digraph or None
        A smallest one, to be drawn.
    sets : AttackSets or None
        What to mark in the drawing.
    """

    result: str
    how: str
    note: str = ""
    counterexample: Digraph | None = None
    sets: AttackSets | None = None


@dataclass(frozen=True, slots=True)
class Claim:
    """One claim: where it stands, what it says in our words, and how it is checked.

    ``is_paper`` is False for corrections and sharper forms of ours.
    """

    place: str
    text: str
    check: Callable[[], Outcome]
    is_paper: bool = True


@cache
def _list(largest: int, directed: bool) -> tuple[Digraph, ...]:
    return tuple(graph for graph in each_graph(largest, directed=directed) if graph.n >= 2)


def small_graphs(graphs: int = GRAPHS, digraphs: int = DIGRAPHS) -> Iterator[Digraph]:
    """Yield all graphs and then all digraphs on two nodes and more, fewest nodes first."""
    yield from _list(graphs, False)
    yield from _list(digraphs, True)


def holding(refute: Callable[[Digraph], str | None], how: str = RANGE, *, graphs: int = GRAPHS) -> Outcome:
    """Return "holds" when ``refute`` finds no reason against any small graph, else "fails" with the first."""
    for graph in small_graphs(graphs):
        reason = refute(graph)
        if reason is not None:
            return Outcome("fails", how, reason, graph)
    return Outcome("holds", how)


def failing(refute: Callable[[Digraph], str | None], note: str, result: str = "fails", *, how: str = RANGE) -> Outcome:
    """Return a smallest counterexample to a claim that fails or is loose; without one the claim holds after all."""
    found = holding(refute, how)
    if found.counterexample is None:
        return found
    return Outcome(result, how, f"{note}: {found.note}", found.counterexample)
