"""What a violation demands of added links: on one of its sides enough nodes have to hear enough from outside.

Everything is a bit mask of node ids. A *side* is a set S with the malicious set M that goes with it. Its *units* are
its normal nodes i, each with the nodes outside that count for it: those outside S, for two faces those outside
``S | M``. A unit is met when i hears at least ``enough`` of them: r for (r,s)-robustness, f + 1 for traps and
violations. The *worth* of a side is how many of its units are met, or s when all are, and never more than s (s = 1 for
traps and violations).

Lemma (rows). Two sides with the same M that are disjoint (with one face: and cover M) violate the condition in a
network if and only if their worths add up to less than s and, with a local bound, M is f-local.

*Proof.* (r,s)-robustness: worths below s say that neither side consists of r-reachable nodes alone and that together
fewer than s are r-reachable; conversely a side all of whose nodes are r-reachable is worth s, and s of them together
are worth s. Traps and violations, s = 1: worth 0 says that no normal node hears more than f outside.

Adding links meets units and never unmeets one, and makes no set f-local. So adding links destroys violations and makes
none, and what G + A leaves open is left open by G + B for every B inside A.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from robustness.digraph import Digraph
from robustness.mending.goal import Part
from robustness.traps.question import Sets

__all__ = [
    "Side",
    "Unit",
    "bits",
    "fit",
    "holds_apart",
    "masks_of",
    "outside",
    "sets_of",
    "sides_of",
    "units",
    "unlocalizers",
    "worth",
]

Masks = Sequence[int]


class Unit(NamedTuple):
    """The node has to hear at least ``enough`` nodes of the mask ``outside``."""

    node: int
    outside: int
    enough: int


class Side(NamedTuple):
    """One side of a violation: the condition it is about, and the masks of M and S."""

    part: Part
    M: int
    S: int


def bits(mask: int) -> Iterator[int]:
    """Yield the ids in a mask."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def masks_of(graph: Digraph) -> list[int]:
    """Return for every node the mask of its in-neighbours."""
    return list(graph.in_masks)


def sides_of(part: Part, sets: Sets) -> tuple[Side, Side]:
    """Return the two sides of a violation."""
    M, S1, S2 = (sum(1 << i for i in ids) for ids in sets)
    return Side(part, M, S1), Side(part, M, S2)


def sets_of(first: Side, second: Side) -> Sets:
    """Return two sides as id sets."""
    return Sets(*(frozenset(bits(mask)) for mask in (first.M, first.S, second.S)))


def outside(side: Side, everybody: int) -> int:
    """Return which nodes count for the side's units."""
    part = side.part
    return everybody & ~side.S & ~(side.M if part.trap is not None and part.trap.two_faces else 0)


def units(side: Side, n: int) -> Iterator[Unit]:
    """Yield the units of a side."""
    around = outside(side, (1 << n) - 1)
    for i in bits(side.S & ~side.M):
        yield Unit(i, around, side.part.enough)


def worth(side: Side, heard: Masks) -> int:
    """Return how much a side is worth in the network with these in-neighbour masks."""
    return _met(side, heard, side.part.s)


def unlocalizers(side: Side, n: int) -> Iterator[Unit]:
    """Yield, for a local bound, a unit for every node outside M: met, M is no f-local set any more."""
    trap = side.part.trap
    if trap is not None and trap.local:
        for i in bits(((1 << n) - 1) & ~side.M):
            yield Unit(i, side.M, trap.f + 1)


def fit(first: Side, second: Side) -> bool:
    """Return whether two sides can belong to one violation."""
    if first.part != second.part or first.M != second.M or first.S & second.S:
        return False
    trap = first.part.trap
    return trap is None or trap.two_faces or not first.M & ~(first.S | second.S)


def holds_apart(first: Side, second: Side, heard: Masks) -> bool:
    """Return whether two sides that fit violate their condition in the network."""
    s = first.part.s
    met = _met(first, heard, s)
    if met >= s or met + _met(second, heard, s - met) >= s:
        return False
    return not any(
        (heard[unit.node] & unit.outside).bit_count() >= unit.enough for unit in unlocalizers(first, len(heard))
    )


def _met(side: Side, heard: Masks, wanted: int) -> int:
    """Return the worth of a side, counted no further than wanted."""
    members, around, enough = _members(side, len(heard))
    met = 0
    for i in members:
        if (heard[i] & around).bit_count() >= enough:
            met += 1
            if met >= wanted:
                return met
    return wanted if met == len(members) else met


@lru_cache(maxsize=1 << 16)
def _members(side: Side, n: int) -> tuple[tuple[int, ...], int, int]:
    """Return the nodes of a side's units, what counts for them, and how much of it is enough."""
    return tuple(bits(side.S & ~side.M)), outside(side, (1 << n) - 1), side.part.enough
