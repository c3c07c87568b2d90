"""Replaying the refutation of every solution that would hold a network apart, by :mod:`certificates.roles`."""

from __future__ import annotations

from certificates.graph import CanonicalGraph
from certificates.masks import Contradiction
from certificates.roles import Roles, Threat, excludes, settle
from certificates.stream import Blocks, Stream
from certificates.walk import Walk

__all__ = ["check_separation"]

#: Kinds of literals of a branch.
NORMAL, MALICIOUS = 0, 1


def check_separation(graph: CanonicalGraph, f: int, faces: int, bound: str, body: Blocks | Stream) -> int:
    """Return the number of tree nodes of a transcript that refutes every solution; raise otherwise.

    Time, memory and errors are those of :func:`certificates.refutation.check_refutation`.
    """
    threat = Threat.of(graph, f, faces == 2, bound == "local")
    return _Replay(threat, graph.n, body).run(Roles.of_all_solutions(graph.n))


class _Replay(Walk[Roles]):
    """A walk through states of solutions."""

    opcodes = 8

    def __init__(self, threat: Threat, n: int, body: Blocks | Stream) -> None:
        super().__init__(threat, n, body)
        self.threat = threat

    def settle(self, state: Roles) -> None:
        settle(self.threat, state)

    def exclude(self, state: Roles, which: int) -> None:
        """Read j i and check that *count* excludes j from the normal nodes of side ``which``."""
        side, node, blocker = which, self.number(self.n), self.number(self.n)
        if not state.P[side] >> node & 1:
            raise self.reject(f"EXCLUDE of node {node}, which is no candidate")
        if not state.T[1 - side] >> blocker & 1:
            raise self.reject(f"the blocker {blocker} is no normal node of the other side")
        if not excludes(self.threat, state, side, node, blocker):
            raise self.reject(f"the blocker {blocker} does not exclude node {node}")
        if state.T[side] >> node & 1:
            raise Contradiction
        state.P[side] &= ~(1 << node)

    def branch(self, state: Roles, kind: int, side: int, node: int) -> tuple[Roles, Roles] | None:
        """*normal*: node v is normal on this side, or not. *malicious*: it is malicious on this side, or not."""
        bit = 1 << node
        may, must = (state.P, state.T) if kind == NORMAL else (state.Q, [state.Z & each for each in state.F])
        if not may[side] & bit or must[side] & bit:
            return None
        true = state.copy()
        may[side] &= ~bit
        if kind == NORMAL:
            true.T[side] |= bit
            return true, state
        true.Z |= bit
        true.F[side] |= bit
        if self.threat.two_faces:
            state.Q[1 - side] &= ~bit
        return true, state

    def mirror(self, state: Roles, node: int) -> None:
        state.P[1] &= ~(1 << node)
