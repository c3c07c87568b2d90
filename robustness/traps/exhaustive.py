"""The definitions tried out: the slow truth that every other search is compared with."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.traps.question import Question, Sets, TrapAnswer, solves

__all__ = ["decide"]


def decide(graph: Digraph, question: Question, limits: Limits) -> TrapAnswer:
    """Return whether a solution exists (None past the deadline), and one: all ``4^n`` (``5^n``) roles are tried."""
    for number, sets in enumerate(_role_assignments(graph.n, question.two_faces)):
        if number % 256 == 0 and limits.expired():
            return TrapAnswer.undecided("the time limit was reached")
        if solves(graph, question, sets):
            return TrapAnswer(True, sets)
    return TrapAnswer(False)


def _role_assignments(n: int, two_faces: bool) -> Iterator[Sets]:
    """Yield every way to give each node a role: nowhere, S1, S2, or malicious (with one face: inside S1 or S2)."""
    for roles in product("-12M" if two_faces else "-12ab", repeat=n):
        those = {role: frozenset(i for i in range(n) if roles[i] == role) for role in "12Mab"}
        yield Sets(those["M"] | those["a"] | those["b"], those["1"] | those["a"], those["2"] | those["b"])
