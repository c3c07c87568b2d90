"""What a claim of the paper is, and what can become of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from robustness.constructions.lemma_1 import profile
from robustness.constructions.small_graphs import each_graph
from robustness.digraph import Digraph
from robustness.threat_models.results import AttackSets
from robustness.traps import find_trap

__all__ = [
    "DIGRAPHS",
    "GRAPHS",
    "PLACES",
    "Claim",
    "Outcome",
    "example",
    "failing",
    "holding",
    "in_words",
    "marked",
    "robust",
    "sharper",
    "small_graphs",
    "trapped",
]

#: Where claims stand, in the order of the paper; the page is in this order.
PLACES = (
    "Introduction",
    "Section 2.1",
    "Definition 1",
    "Section 2.2",
    "Section 2.3",
    "Definitions 3 and 4",
    "Section 3.1",
    "Algorithm 1",
    "Theorem 1",
    "Theorem 1, sufficiency",
    "Theorem 1, necessity",
    "Theorem 1, proof",
    "after Theorem 1",
    "before Proposition 1",
    "Proposition 1",
    "Proposition 1, proof",
    "Corollary 1",
    "before Corollary 2",
    "Definition 6",
    "Corollary 2",
    "5-node figure",
    "Section 3.2, normal vehicles",
    "Section 3.2, omissive faults",
    "Section 3.2, added links",
    "Section 4",
    "Section 4, Setting 1",
    "Section 4, Setting 2",
    "Conclusion",
    "Appendix",
)

#: Claims about all graphs are tried on all graphs and digraphs up to so many nodes, up to isomorphism.
GRAPHS, DIGRAPHS = 6, 4


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a claim.

    Attributes
    ----------
    result : str
        ``"holds"``, ``"fails"``, ``"holds corrected"``, ``"answered"``, ``"contradicts itself"`` or ``"not
        checkable"``.
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

    ``place`` is one of ``PLACES``; ``is_paper`` is False for corrections and sharper forms of ours.
    """

    place: str
    text: str
    check: Callable[[], Outcome]
    is_paper: bool = True


def robust(graph: Digraph, r: int, s: int = 1) -> bool:
    """Return whether a small graph is (r,s)-robust."""
    table = profile(graph)
    return r < len(table) and table[r] >= s


@cache
def trapped(graph: Digraph, f: int, local: bool = False) -> bool:
    """Return whether the graph has a trap for f."""
    return find_trap(graph, f, local=local).decided()


@cache
def _list(largest: int, directed: bool) -> tuple[Digraph, ...]:
    return tuple(graph for graph in each_graph(largest, directed=directed) if graph.n >= 2)


def small_graphs(graphs: int = GRAPHS, digraphs: int = DIGRAPHS) -> Iterator[Digraph]:
    """Yield all graphs and then all digraphs on two nodes and more, fewest nodes first; none beyond the sizes given."""
    yield from _list(graphs, False)
    yield from _list(digraphs, True)


def in_words(graphs: int = GRAPHS, digraphs: int = DIGRAPHS) -> str:
    """Return a range as the page says it; a size of 0 leaves that kind out."""
    kinds = (("graphs", graphs), ("digraphs", digraphs))
    told = (f"all {kind} on 2 to {largest} nodes" for kind, largest in kinds if largest)
    return "search: " + ", ".join(told)


def holding(refute: Callable[[Digraph], str | None], *, graphs: int = GRAPHS, digraphs: int = DIGRAPHS) -> Outcome:
    """Return "holds" when ``refute`` finds no reason against any small graph, else "fails" with the first."""
    how = in_words(graphs, digraphs)
    for graph in small_graphs(graphs, digraphs):
        reason = refute(graph)
        if reason is not None:
            return Outcome("fails", how, reason, graph)
    return Outcome("holds", how)


def failing(refute: Callable[[Digraph], str | None], note: str, result: str = "fails") -> Outcome:
    """Return a smallest counterexample to a claim that fails or is loose; without one the claim holds after all."""
    found = holding(refute)
    if found.counterexample is None:
        return found
    return Outcome(result, found.how, f"{note}: {found.note}", found.counterexample)


def marked(outcome: Outcome, f: int = 1) -> Outcome:
    """Return the outcome with a trap for f marked in its drawing."""
    if outcome.counterexample is None:
        return outcome
    found = find_trap(outcome.counterexample, f)
    return replace(outcome, sets=AttackSets(f, 2, False, found.M, found.S1, found.S2) if found.exists else None)


def example(shows: Callable[[Digraph], str | None], note: str = "") -> Outcome:
    """Return "holds" with a smallest graph that shows what is claimed to exist; without one the claim fails."""
    found = holding(shows)
    if found.counterexample is None:
        return Outcome("fails", found.how, "no such graph")
    told = f"{note}: {found.note}" if note else found.note
    return Outcome("holds", "search, smallest first", told, found.counterexample)


def sharper(
    result: str,
    refute: Callable[[Digraph], str | None],
    note: str,
    *,
    graphs: int = GRAPHS,
    digraphs: int = DIGRAPHS,
) -> Outcome:
    """Return ``result`` with a note, such as a sharper statement, when no small graph refutes that; else "fails"."""
    found = holding(refute, graphs=graphs, digraphs=digraphs)
    return found if found.counterexample is not None else Outcome(result, found.how, note)
