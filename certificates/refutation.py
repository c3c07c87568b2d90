"""Replaying the refutation of every violating pair of (r,s)-robustness, by :mod:`certificates.rules`."""

from __future__ import annotations

from typing import TypeVar

from certificates.graph import CanonicalGraph
from certificates.masks import Contradiction
from certificates.rules import Question, State, excludes, settle
from certificates.stream import Blocks, Stream
from certificates.walk import Walk

__all__ = ["SATISFIED", "Replay", "check_refutation"]

#: Kinds of literals of a branch.
SATISFIED, MEMBER = 0, 1

S = TypeVar("S", bound=State)


def check_refutation(graph: CanonicalGraph, r: int, s: int, body: Blocks | Stream) -> int:
    """Return the number of tree nodes of a transcript that refutes every violating pair; raise otherwise.

    Time is linear in the bytes of the transcript, with a factor polynomial in n, and bounded by ``masks.MAX_LOOKS``;
    the tree is at most 4 n deep; memory O(n^2).

    Raises
    ------
    MalformedCertificate
        When the graph has more than ``MAX_NODES`` nodes, or the work exceeds ``MAX_LOOKS``.
    RejectedCertificate
        When a step does not hold, or the tree is incomplete, or something follows it.
    """
    question = Question.of(graph, r, s)
    return Replay[State](question, graph.n, body).run(State.of_all_pairs(graph.n))


class Replay(Walk[S]):
    """A walk through states of violating pairs."""

    opcodes = 10

    def __init__(self, question: Question, n: int, body: Blocks | Stream) -> None:
        super().__init__(question, n, body)
        self.question = question

    def settle(self, state: S) -> None:
        """Apply all rules but *count*."""
        settle(self.question, state)

    def exclude(self, state: S, which: int) -> None:
        """Read j i1 [i2] and check that *count* excludes j from the satisfied nodes of its side."""
        side, node = which & 1, self.number(self.n)
        if not state.P[side] >> node & 1:
            raise self.reject(f"EXCLUDE of node {node}, which is no candidate")
        self.count(state, side, node, [self.number(self.n) for _ in range(1 + (which >> 1))])
        if state.T[side] >> node & 1:
            raise Contradiction
        state.P[side] &= ~(1 << node)

    def count(self, state: S, side: int, node: int, blockers: list[int]) -> None:
        """Check that *count* excludes the node by these blockers."""
        if len(set(blockers)) < len(blockers) or not all(state.T[1 - side] >> i & 1 for i in blockers):
            raise self.reject(f"the blockers {blockers} are not different satisfied nodes of the other side")
        if not excludes(self.question, state, side, node, blockers):
            raise self.reject(f"the blockers {blockers} do not exclude node {node}")

    def branch(self, state: S, kind: int, side: int, node: int) -> tuple[S, S] | None:
        """*satisfied*: node v is satisfied on this side, or not. *member*: it is a member of this side, or not."""
        bit = 1 << node
        may, must = (state.P, state.T) if kind == SATISFIED else (state.C, state.F)
        if not may[side] & bit or must[side] & bit:
            return None
        true = state.copy()
        (true.T if kind == SATISFIED else true.F)[side] |= bit
        may[side] &= ~bit
        state.P[side] &= ~bit
        return true, state

    def mirror(self, state: S, node: int) -> None:
        """Let the node be satisfied on side 2 no more than on side 1."""
        state.P[1] &= ~(1 << node)
