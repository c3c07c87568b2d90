"""A network as bit masks, as the rules look at it, and the bound on how often they may look."""

from __future__ import annotations

from dataclasses import dataclass, field

from certificates.errors import MalformedCertificate
from certificates.graph import CanonicalGraph

__all__ = ["MAX_LOOKS", "MAX_NODES", "Contradiction", "Network", "masks_of"]

#: Looks at a node, each a few operations on masks, that a transcript may ask for: half an hour or so.
MAX_LOOKS = 2**32

#: Masks take n*n/4 bytes; a transcript is for graphs of at most this many nodes.
MAX_NODES = 10_000


class Contradiction(Exception):
    """The state stands for nothing that is looked for. It closes a branch of the tree and never leaves the kernel."""


def masks_of(graph: CanonicalGraph) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return for every node whom it hears and by whom it is heard.

    Raises
    ------
    MalformedCertificate
        When the graph has more than ``MAX_NODES`` nodes.
    """
    if graph.n > MAX_NODES:
        raise MalformedCertificate(f"a refutation is for graphs of at most {MAX_NODES} nodes, not {graph.n}")
    heard_by = [0] * graph.n
    for i, heard in enumerate(graph.hears):
        for j in heard:
            heard_by[j] |= 1 << i
    return tuple(sum(1 << j for j in heard) for heard in graph.hears), tuple(heard_by)


@dataclass(slots=True)
class Network:
    """In- and out-neighbours of every node as bit masks, and how many of them each needs on its own side."""

    hears: tuple[int, ...]
    heard_by: tuple[int, ...]
    need: tuple[int, ...]
    #: Looks at nodes so far, each weighted with the length of a mask.
    looks: int = field(default=0, kw_only=True)

    def look_at(self, nodes: int) -> None:
        """Count a step that looks at these nodes, so that no transcript keeps the checker busy for ever.

        Raises
        ------
        MalformedCertificate
            When there have been too many.
        """
        self.looks += (1 + nodes.bit_count()) * (1 + len(self.need) // 1024)
        if self.looks > MAX_LOOKS:
            raise MalformedCertificate(f"a refutation may ask for at most {MAX_LOOKS} looks at nodes")

    def hearing(self, nodes: int) -> int:
        """Return who hears any of ``nodes``."""
        found = 0
        while nodes:
            found |= self.heard_by[(nodes & -nodes).bit_length() - 1]
            nodes &= nodes - 1
        return found
