"""Sides grown from seeds: cheap violations before the exact search is asked.

A set grows while one of its nodes hears too much from outside, by a node that this node hears, until it is a side of
worth 0 (up to nodes that are let off), or everything. Two grown sides that are disjoint are a violation. Not complete:
what it does not find, the exact search does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from robustness.mending.demands import Side, bits, holds_apart, worth
from robustness.mending.goal import Part

__all__ = ["every_pair", "grown_sides", "lonely_nodes", "shrunk"]


def grown_sides(
    heard: Sequence[int], part: Part, M: int = 0, in_time: Callable[[], None] = lambda: None
) -> Iterator[Side]:
    """Yield sides of worth below s in the network with these in-neighbour masks: from every node, and every arc.

    ``in_time`` is called again and again, and may raise. For traps with two faces M is given; violations with one face
    are left to the exact search.
    """
    if part.trap is not None and not part.trap.two_faces:
        return
    n = len(heard)
    everybody = ((1 << n) - 1) & ~M
    seen: set[int] = set()
    seeds = [1 << i for i in range(n)]
    seeds += [1 << i | 1 << j for i in range(n) for j in bits(heard[i]) if j < i or not heard[j] >> i & 1]
    for seed in seeds:
        for spared in (0, seed) if part.s > 1 and seed.bit_count() == 1 else (0,):
            in_time()
            if seed & M:
                continue
            S = _grow(heard, seed, everybody, part.enough, spared)
            if S and S not in seen and S != everybody:
                seen.add(S)
                side = Side(part, M, S)
                if worth(side, heard) < part.s:
                    yield side


def lonely_nodes(heard: Sequence[int], part: Part) -> tuple[list[tuple[Side, Side]], int]:
    """Return the violations between one node and all others, and how many arcs it takes to break them.

    For r >= 2 nobody hears r of one node, so that a node which hears fewer than r has to hear r.
    """
    if part.trap is not None or part.r < 2 or len(heard) < 2:
        return [], 0
    everybody = (1 << len(heard)) - 1
    lonely = [(i, mask.bit_count()) for i, mask in enumerate(heard) if mask.bit_count() < part.r]
    pairs = [(Side(part, 0, 1 << i), Side(part, 0, everybody & ~(1 << i))) for i, _ in lonely]
    return pairs, sum(part.r - hears for _, hears in lonely)


def every_pair(heard: Sequence[int], part: Part) -> Iterator[tuple[Side, Side]]:
    """Yield every violation of (r,s)-robustness in a network of a few nodes: ``3^n / 2`` pairs are looked at."""
    everybody = (1 << len(heard)) - 1
    sides = [side for S in range(1, everybody) if worth(side := Side(part, 0, S), heard) < part.s]
    for k, first in enumerate(sides):
        for second in sides[k + 1 :]:
            if not first.S & second.S and holds_apart(first, second, heard):
                yield first, second


def _grow(heard: Sequence[int], seed: int, everybody: int, enough: int, spared: int) -> int:
    """Return the grown set, or 0 when it becomes everything."""
    S, waiting = seed, list(bits(seed & ~spared))
    while waiting:
        crowded = waiting.pop()
        # A node that hears little from outside hears no more when the set grows.
        while (outside := heard[crowded] & everybody & ~S).bit_count() >= enough:
            # The newcomer that asks for the fewest others.
            newcomer = min(bits(outside), key=lambda j: ((heard[j] & everybody & ~S).bit_count(), j))
            S |= 1 << newcomer
            waiting.append(newcomer)
        if S == everybody:
            return 0
    return S if spared == 0 or S != seed else 0


def shrunk(first: Side, second: Side, heard: Sequence[int]) -> tuple[Side, Side]:
    """Return a violation from which no single normal node can go: small sides make demands that are hard to evade.

    Nodes that hear much from outside are the first to be spared.
    """
    everybody = (1 << len(heard)) - 1
    pair = [first, second]
    order = [(k, i) for k, side in enumerate(pair) for i in bits(side.S & ~side.M)]
    order.sort(key=lambda place: (-(heard[place[1]] & everybody & ~pair[place[0]].S).bit_count(), place))
    for k, i in order:
        side = pair[k]
        smaller = side._replace(S=side.S & ~(1 << i))
        if smaller.S & ~side.M and holds_apart(smaller, pair[1 - k], heard):
            pair[k] = smaller
    return pair[0], pair[1]
