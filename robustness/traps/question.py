"""What a trap search is asked, and the definitions that every answer is re-checked against.

Let ``f >= 0``. Three sets M, S1, S2 of nodes, and the normal members ``N_k = S_k - M``, both nonempty, hold a network
apart when every node of N_k has at most f in-neighbours outside ``S_k`` (with one face) or outside ``S_k | M`` (with
two). Then nodes that drop their f largest and f smallest values never move: N1 stays at one value and N2 at another
for ever, because nobody in N_k hears anything but its own value from inside, and at most f values from outside.

* *one face*: each malicious node says the same to all, so it is a member of S1 or of S2, ``M <= S1 | S2``, and stays
  there; S1 and S2 are disjoint. With ``|M| <= f`` this is exactly a violation of (f+1,f+1)-robustness:
  take ``M = X_S1 | X_S2`` (Theorem 1 of the source paper, necessity).
* *two faces*: a malicious node shows side 1 one value and side 2 the other, by lying to each (Byzantine) or by
  delays (see :mod:`robustness.simulation.attacks`); M, S1 and S2 are disjoint. This is a *trap*.

M is bounded in all (*total*: ``|M| <= f``) or around every normal node (*local*: every node outside M, also one in
neither S1 nor S2, hears at most f nodes of M).

Lemma (one face is weaker). If (M, S1, S2) is a solution with one face, ``(M, S1 - M, S2 - M)`` is one with two: what
lies outside ``(S_k - M) | M`` lies outside S_k. So "no trap" implies (f+1,f+1)-robustness.

Lemma (monotone). A solution for f is one for f + 1.

Lemma ((2f+1)-robust graphs have none). Of N1 and N2 one has a node i with 2f + 1 in-neighbours outside N_k; at most f
of them are malicious, total or local, so f + 1 are outside ``N_k | M``.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from robustness.definitions import MANY, heard_outside
from robustness.digraph import Digraph
from robustness.errors import InternalError

__all__ = ["Question", "Sets", "TrapAnswer", "obeys_bound", "solves"]


class Question(NamedTuple):
    """Is there a solution for f, with one face or two, M bounded in total or locally?"""

    f: int
    two_faces: bool = True
    local: bool = False


class Sets(NamedTuple):
    """M, S1 and S2 as id sets. With one face malicious nodes are members of S1 or S2, with two of neither."""

    M: frozenset[int]
    S1: frozenset[int]
    S2: frozenset[int]


class TrapAnswer(NamedTuple):
    """Whether a solution exists (None: a limit), one, what decided it, and the counters, lemma or reason."""

    exists: bool | None
    sets: Sets | None = None
    decided_by: str = ""
    stats: Mapping[str, Any] = MappingProxyType({})
    #: The refutation of all solutions in the form of a certificate, where one was asked for.
    transcript: bytes | None = None

    @classmethod
    def by_lemma(cls, sets: Sets | None, rule: str) -> TrapAnswer:
        """Return a solution, or with None that there is none, as a lemma tells it."""
        return cls(sets is not None, sets, "lemma", {"rule": rule})

    @classmethod
    def undecided(
        cls, reason: str, stats: Mapping[str, Any] = MappingProxyType({}), decided_by: str = ""
    ) -> TrapAnswer:
        """Return that nothing is claimed, with its reason among the stats."""
        return cls(None, None, decided_by, {**stats, "reason": reason})

    def rechecked(self, graph: Digraph, question: Question) -> TrapAnswer:
        """Return the answer after its sets were checked against the definition; wrong ones are an InternalError."""
        if self.exists and (self.sets is None or not solves(graph, question, self.sets)):
            raise InternalError(f"{self.decided_by} returned {self.sets}, no solution of {question}: please report")
        return self


def obeys_bound(graph: Digraph, M: frozenset[int], f: int, *, local: bool) -> bool:
    """Return whether M has at most f nodes, or (local) every node outside M hears at most f of them."""
    if not local:
        return len(M) <= f
    if graph.n > MANY:
        heard = graph.in_degrees - heard_outside(graph, M)
        heard[list(M)] = 0
        return bool((heard <= f).all())
    return all(len(M.intersection(graph.in_neighbours(i).tolist())) <= f for i in range(graph.n) if i not in M)


def solves(graph: Digraph, question: Question, sets: Sets) -> bool:
    """Return whether the sets answer the question: the definition in the module, nothing else."""
    f, two_faces, local = question
    M, S1, S2 = sets
    if S1 & S2 or not S1 - M or not S2 - M:
        return False
    if (M & (S1 | S2)) if two_faces else M - S1 - S2:
        return False
    if not obeys_bound(graph, M, f, local=local):
        return False
    if len(S1) + len(S2) > MANY:
        heard = [heard_outside(graph, side | M if two_faces else side)[list(side - M)] for side in (S1, S2)]
        return all(bool((count <= f).all()) for count in heard)
    return all(
        sum(j not in side and not (two_faces and j in M) for j in graph.in_neighbours(i).tolist()) <= f
        for side in (S1, S2)
        for i in side - M
    )
