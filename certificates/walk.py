"""Replaying a transcript: every branch of a search ends in a contradiction, so what was looked for does not exist.

The transcript names branches and exclusions; the rules between them are applied anew, by the walk's own kind of state.
How the search found its steps is not trusted and not seen. Since no rule loses anything that a state stands for, a
contradictory state stands for nothing, and the children of a branch stand for all of their parent, a complete tree
leaves nothing (docs/certificate-format.md, the theorems on refutations).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from certificates.errors import RejectedCertificate
from certificates.masks import Contradiction, Network
from certificates.stream import Blocks, Stream

__all__ = ["BRANCH", "EXCLUDE", "PROPAGATE", "ROOT", "Walk"]

#: Opcodes: BRANCH + 2 * kind + side, EXCLUDE + 2 * (blockers - 1) + side.
PROPAGATE, ROOT, BRANCH, EXCLUDE = 0, 1, 2, 6

S = TypeVar("S")


class Walk(ABC, Generic[S]):
    """One transcript being read, and the states of one kind of search."""

    #: The number of opcodes.
    opcodes: int

    def __init__(self, network: Network, n: int, body: Blocks | Stream) -> None:
        self.network, self.n = network, n
        self.body = Stream.of(body)
        self.share = self.body.share
        self.nodes = 0

    @abstractmethod
    def settle(self, state: S) -> None:
        """Apply all rules but *count* until nothing changes, or raise :class:`Contradiction`."""

    @abstractmethod
    def exclude(self, state: S, which: int) -> None:
        """Read the operands of the opcode EXCLUDE + ``which`` and apply it, or raise :class:`Contradiction`."""

    @abstractmethod
    def branch(self, state: S, kind: int, side: int, node: int) -> tuple[S, S] | None:
        """Return the true and the false child of a branch, or None when its literal is already decided."""

    @abstractmethod
    def mirror(self, state: S, node: int) -> None:
        """Make the false child of a ROOT, in which ``node`` is gone from side 1, symmetric again."""

    def run(self, state: S) -> int:
        """Walk the whole tree, from its first, symmetric ``state``, and return the number of its nodes."""
        self.tree(state, symmetric=True)
        if not self.body.is_over():
            raise self.reject(f"{self.body.left()} bytes follow the complete refutation")
        self.body.looks = self.network.looks
        return self.nodes

    def tree(self, state: S, symmetric: bool) -> None:
        """Walk the tree below ``state`` in preorder, with an explicit stack of the false children to come.

        A tree is at most as deep as there are literals.

        ROOT: a symmetric state has the same sets on both sides, and what it stands for may be swapped. So when nothing
        has the node satisfied on side 1, nothing has it on side 2 either: the false child loses it on both sides.
        """
        waiting: list[tuple[S, bool, int]] = []
        while True:
            self.nodes += 1
            try:
                self.settle(state)
                if self.body.place in self.share:
                    self.cube(state, symmetric)
                self.exclusions(state)
            except Contradiction:
                if not waiting:
                    break
                state, symmetric, start = waiting.pop()
                self.body.note(start)
                continue
            opcode = self.number(EXCLUDE)
            if opcode == PROPAGATE:
                raise self.reject("PROPAGATE without an EXCLUDE before it")
            if opcode == ROOT and not symmetric:
                raise self.reject("ROOT in a state that is not symmetric")
            kind, side = (0, 0) if opcode == ROOT else divmod(opcode - BRANCH, 2)
            node = self.number(self.n)
            children = self.branch(state, kind, side, node)
            if children is None:
                raise self.reject(f"the branch literal is already decided: node {node}")
            state, false = children
            if opcode == ROOT:
                self.mirror(false, node)
            waiting.append((false, opcode == ROOT, self.body.place))
            symmetric = False

    def cube(self, state: S, symmetric: bool) -> None:
        """Walk a tree that is this share's own, or leave it to whose it is: :mod:`certificates.shares`."""
        start, (length, is_own) = self.body.place, self.share.pop(self.body.place)
        self.nodes -= 1
        if is_own:
            nodes, looks = self.nodes, self.network.looks
            self.tree(state, symmetric)
            self.body.own_nodes += self.nodes - nodes
            self.body.own_looks += self.network.looks - looks
        else:
            self.body.skip(length)
        if self.body.place != start + length:
            raise self.reject(f"the tree that begins at byte {start} has not the {length} bytes that are said")
        raise Contradiction

    def exclusions(self, state: S) -> None:
        """Read the runs of EXCLUDE steps, each followed by PROPAGATE, that come before a branch."""
        while EXCLUDE <= self.body.peek() < self.opcodes:
            while EXCLUDE <= (opcode := self.body.peek()) < self.opcodes:
                self.body.next()
                self.exclude(state, opcode - EXCLUDE)
            if self.number(self.opcodes) != PROPAGATE:
                raise self.reject("EXCLUDE steps without a PROPAGATE after them")
            self.settle(state)

    def number(self, limit: int) -> int:
        """Read one number below ``limit``: seven bits a byte, low first, shortest spelling."""
        value = shift = 0
        while True:
            byte = self.body.next()
            if byte < 0:
                raise self.reject("the transcript ends in the middle of the tree")
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
        return RejectedCertificate(f"refutation, byte {self.body.place}, tree node {self.nodes}: {why}", "refutation")
