"""The pseudo-Boolean model: "this graph has a violating pair of (r,s)", written from the graph alone.

Variables, for every node id i, each 0 or 1:

=========  ============================================================================
x_i, y_i   i is in S1; i is in S2
u_i, w_i   only for s > 1: i is a satisfied node of S1, of S2
e_i, f_i   only for s > 1: i is counted as an exempt node of S1, of S2
=========  ============================================================================

Node i of S_k is *satisfied* when at least ``k_i = max(0, d_i - r + 1)`` of its in-neighbours lie in S_k, that is
``i not in X_Sk^r``, and else *exempt*. By Lemma 1 (docs/certificate-format.md) disjoint sets violate (r,s)-robustness
exactly when each holds a satisfied node and at most s - 1 nodes are exempt. For s = 1 nobody is exempt, so every member
is satisfied: ``u = x`` and ``w = y``. ``~`` is negation, ``~x = 1 - x``. Inequalities, in the order of the file:

1. ``sum_i u_i >= 1``; 2. ``sum_i w_i >= 1``
3. only for s > 1: ``sum_i ~e_i + ~f_i >= 2n - (s - 1)``
4. for every i: ``~x_i + ~y_i >= 1``
5. for every side and every i with k_i > 0: ``k_i ~u_i + sum_{j in N_i} x_j >= k_i``
6. only for s > 1, for every side and i: ``~u_i + x_i >= 1``
7. only for s > 1, for every side and i: ``~x_i + u_i + e_i >= 1``
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from certificates.graph import CanonicalGraph
from certificates.rules import Question
from robustness.spelled import counted

__all__ = ["Model", "inequality", "negated"]


def negated(literal: str) -> str:
    """Return the negation of a literal: ``x1`` for ``~x1`` and back."""
    return literal[1:] if literal.startswith("~") else "~" + literal


def inequality(terms: Sequence[tuple[int, str]], degree: int) -> str:
    """Return ``sum of coefficient * literal >= degree`` as OPB spells it, without the closing semicolon."""
    return "".join(f"{coefficient} {literal} " for coefficient, literal in terms) + f">= {degree}"


@dataclass(slots=True)
class Model:
    """The inequalities of one question about one graph, and the place (from 1) that each has in the file."""

    graph: CanonicalGraph
    r: int
    s: int
    question: Question
    #: For every node its number in the names of the variables: its id in the whole graph.
    names: Sequence[int]
    lines: list[str] = field(default_factory=list)
    #: Place of ``sum ~e + ~f >= 2n - (s - 1)``; 0 for s = 1.
    budget: int = 0
    #: For node i: place of ``~x_i + ~y_i >= 1``.
    disjoint: list[int] = field(default_factory=list)
    #: For side and node: places of inequalities 5 (None where k_i = 0), 6 and 7 (empty lists for s = 1).
    needs: tuple[list[int | None], list[int | None]] = field(default_factory=lambda: ([], []))
    membership: tuple[list[int], list[int]] = field(default_factory=lambda: ([], []))
    exemption: tuple[list[int], list[int]] = field(default_factory=lambda: ([], []))

    @classmethod
    def of(cls, graph: CanonicalGraph, r: int, s: int) -> Model:
        """Return the model of "``graph`` has a violating pair of (r,s)"."""
        model = cls(graph, r, s, Question.of(graph, r, s), range(graph.n))
        nodes = range(graph.n)
        for side in (0, 1):
            model._add([(1, model.satisfied(side, i)) for i in nodes], 1)
        if s > 1:
            exempt = [(1, negated(model.exempt(side, i))) for side in (0, 1) for i in nodes]
            model.budget = model._add(exempt, len(exempt) - (s - 1))
        for i in nodes:
            model.disjoint.append(model._add([(1, negated(model.member(side, i))) for side in (0, 1)], 1))
        for side in (0, 1):
            for i, need in enumerate(model.question.need):
                heard = [(1, model.member(side, j)) for j in graph.hears[i]]
                terms = [(need, negated(model.satisfied(side, i))), *heard]
                model.needs[side].append(model._add(terms, need) if need else None)
        for side in (0, 1) if s > 1 else ():
            for i in nodes:
                member, satisfied, exempt_i = model.member(side, i), model.satisfied(side, i), model.exempt(side, i)
                model.membership[side].append(model._add([(1, negated(satisfied)), (1, member)], 1))
                terms = [(1, negated(member)), (1, satisfied), (1, exempt_i)]
                model.exemption[side].append(model._add(terms, 1))
        return model

    def induced(self, nodes: Sequence[int]) -> Model:
        """Return the part of the model about the subgraph on ``nodes``, renumbered, with its places in the whole.

        The whole model says as much of a node as a model of the subgraph would: an in-neighbour outside adds one to its
        need, and at most one member that it hears.
        """
        index = {node: i for i, node in enumerate(nodes)}
        hears = tuple(tuple(index[j] for j in self.graph.hears[node] if j in index) for node in nodes)
        graph = CanonicalGraph(tuple(self.graph.labels[node] for node in nodes), hears, self.graph.sha256)
        part = Model(graph, self.r, self.s, Question.of(graph, self.r, self.s), nodes, self.lines, self.budget)
        part.disjoint = [self.disjoint[node] for node in nodes]
        for side in (0, 1):
            places = zip(part.question.need, (self.needs[side][node] for node in nodes), strict=True)
            part.needs[side].extend(place if need else None for need, place in places)
            for whole, own in ((self.membership, part.membership), (self.exemption, part.exemption)):
                own[side].extend(whole[side][node] for node in nodes if whole[side])
        return part

    def _add(self, terms: Sequence[tuple[int, str]], degree: int) -> int:
        self.lines.append(inequality(terms, degree) + " ;")
        return len(self.lines)

    def member(self, side: int, i: int) -> str:
        """Return the variable "i is in S1 (S2)"."""
        return f"{'xy'[side]}{self.names[i]}"

    def satisfied(self, side: int, i: int) -> str:
        """Return the variable "i is a satisfied node of S1 (S2)"."""
        return f"{('uw' if self.s > 1 else 'xy')[side]}{self.names[i]}"

    def exempt(self, side: int, i: int) -> str:
        """Return the variable "i is counted as an exempt node of S1 (S2)", for s > 1."""
        return f"{'ef'[side]}{self.names[i]}"

    def swap(self) -> list[tuple[str, str]]:
        """Return the exchange of S1 and S2, which maps the model to itself: every variable and what stands for it."""
        pairs = [("x", "y"), ("u", "w"), ("e", "f")] if self.s > 1 else [("x", "y")]
        kinds = [kind for pair in pairs for kind in (pair, pair[::-1])]
        return [(f"{old}{i}", f"{new}{i}") for old, new in kinds for i in range(self.graph.n)]

    def text(self) -> str:
        """Return the model as an OPB file."""
        variables = len(self.swap())
        size = f"{counted(self.graph.n, 'node')}, {counted(self.graph.arc_count, 'arc')}"
        head = [
            f"* #variable= {variables} #constraint= {len(self.lines)}",
            f"* x and y are a violating pair of ({self.r},{self.s}): satisfiable exactly when the graph is not robust",
            f"* graph: {size}, SHA-256 {self.graph.sha256}",
        ]
        return "\n".join(head + self.lines) + "\n"
