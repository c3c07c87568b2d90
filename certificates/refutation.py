"""Replaying a refutation: every branch of a search for a violating pair ends in a contradiction.

The transcript names branches and exclusions; the rules between them are applied here anew, by
:mod:`certificates.rules`. How the search found its steps is not trusted and not seen. Since no rule loses a pair, a
contradictory state stands for none, and the children of a branch stand for all pairs of their parent, a complete tree
leaves no violating pair (docs/certificate-format.md, the theorem on refutations).
"""

from __future__ import annotations

from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph
from certificates.rules import Contradiction, Question, State, excludes, settle

__all__ = ["MAX_NODES", "check_refutation"]

#: Masks take n*n/4 bytes; a refutation is for graphs of at most this many nodes.
MAX_NODES = 10_000

#: Opcodes: BRANCH + 2 * kind + side, EXCLUDE + 2 * (blockers - 1) + side.
PROPAGATE, ROOT, BRANCH, EXCLUDE = 0, 1, 2, 6
_OPCODES = 10
SATISFIED, MEMBER = 0, 1


def check_refutation(graph: CanonicalGraph, r: int, s: int, body: bytes) -> int:
    """Return the number of tree nodes of a transcript that refutes every violating pair; raise otherwise.

    Time is linear in the bytes of the transcript, with a factor polynomial in n, and bounded by ``rules.MAX_LOOKS``;
    the tree is at most 4 n deep; memory O(n^2).

    Raises
    ------
    MalformedCertificate
        When the graph has more than ``MAX_NODES`` nodes, or the work exceeds ``MAX_LOOKS``.
    RejectedCertificate
        When a step does not hold, or the tree is incomplete, or something follows it.
    """
    if graph.n > MAX_NODES:
        raise MalformedCertificate(f"a refutation is for graphs of at most {MAX_NODES} nodes, not {graph.n}")
    return _Replay(graph, r, s, body).run()


class _Replay:
    """One transcript being read: the question, the bytes and the place in them."""

    def __init__(self, graph: CanonicalGraph, r: int, s: int, body: bytes) -> None:
        self.n = graph.n
        self.question = Question.of(graph, r, s)
        self.body = body
        self.place = 0
        self.nodes = 0

    def run(self) -> int:
        """Walk the tree in preorder with an explicit stack of the false children to come."""
        state, symmetric = State.of_all_pairs(self.n), True
        waiting: list[tuple[State, bool]] = []
        while True:
            self.nodes += 1
            try:
                settle(self.question, state)
                self.exclusions(state)
            except Contradiction:
                if not waiting:
                    break
                state, symmetric = waiting.pop()
            else:
                true, false, false_symmetric = self.branch(state, symmetric)
                waiting.append((false, false_symmetric))
                state, symmetric = true, False
        if self.place != len(self.body):
            raise self.reject(f"{len(self.body) - self.place} bytes follow the complete refutation")
        return self.nodes

    def exclusions(self, state: State) -> None:
        """Read the runs of EXCLUDE steps, each followed by PROPAGATE, that come before a branch."""
        while EXCLUDE <= self.peek() < _OPCODES:
            while EXCLUDE <= self.peek() < _OPCODES:
                self.exclude(state)
            if self.number(_OPCODES) != PROPAGATE:
                raise self.reject("EXCLUDE steps without a PROPAGATE after them")
            settle(self.question, state)

    def exclude(self, state: State) -> None:
        """Read EXCLUDE j i1 [i2] and check that *count* excludes j from the satisfied nodes of its side."""
        code = self.number(_OPCODES) - EXCLUDE
        side, node = code & 1, self.number(self.n)
        if not state.P[side] >> node & 1:
            raise self.reject(f"EXCLUDE of node {node}, which is no candidate")
        blockers = [self.number(self.n) for _ in range(1 + (code >> 1))]
        if len(set(blockers)) < len(blockers) or not all(state.T[1 - side] >> i & 1 for i in blockers):
            raise self.reject(f"the blockers {blockers} are not different satisfied nodes of the other side")
        if not excludes(self.question, state, side, node, blockers):
            raise self.reject(f"the blockers {blockers} do not exclude node {node}")
        if state.T[side] >> node & 1:
            raise Contradiction
        state.P[side] &= ~(1 << node)

    def branch(self, state: State, symmetric: bool) -> tuple[State, State, bool]:
        """Read a branch on an open literal; return its true child, its false child, and whether that is symmetric.

        ROOT: a symmetric state has the same sets on both sides, and its pairs may be swapped. So when no pair has v
        satisfied in S1, none has it satisfied in S2 either: the false child loses v on both sides, and is symmetric.
        """
        opcode = self.number(EXCLUDE)
        if opcode == PROPAGATE:
            raise self.reject("PROPAGATE without an EXCLUDE before it")
        if opcode == ROOT and not symmetric:
            raise self.reject("ROOT in a state that is not symmetric")
        kind, side = (SATISFIED, 0) if opcode == ROOT else divmod(opcode - BRANCH, 2)
        node = self.number(self.n)
        bit = 1 << node
        may, must = (state.P, state.T) if kind == SATISFIED else (state.C, state.F)
        if not may[side] & bit or must[side] & bit:
            raise self.reject(f"the branch literal is already decided: node {node}")
        true = state.copy()
        (true.T if kind == SATISFIED else true.F)[side] |= bit
        may[side] &= ~bit
        state.P[side] &= ~bit
        if opcode == ROOT:
            state.P[1] &= ~bit
        return true, state, opcode == ROOT

    def peek(self) -> int:
        """Return the byte that comes next, or -1 at the end."""
        return self.body[self.place] if self.place < len(self.body) else -1

    def number(self, limit: int) -> int:
        """Read one number below ``limit``: seven bits a byte, low first, shortest spelling."""
        value = shift = 0
        while True:
            byte = self.peek()
            if byte < 0:
                raise self.reject("the transcript ends in the middle of the tree")
            self.place += 1
            value |= (byte & 127) << shift
            if byte < 128:
                break
            shift += 7
            if shift > 28:
                raise self.reject("a number is out of range")
        if value >= limit or (shift and value >> shift == 0):
            raise self.reject(f"a number is out of range or not in its shortest spelling: {value}")
        return value

    def reject(self, why: str) -> RejectedCertificate:
        """Return the error that says what is wrong, and where."""
        return RejectedCertificate(f"refutation, byte {self.place}, tree node {self.nodes}: {why}")
