"""The threat models tried out set by set, from the definitions alone: masks, no rule, no lemma, no search."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from robustness import Digraph, TimeVaryingGraph
from tests.oracles import brute_profile


def subsets(mask: int) -> Iterator[int]:
    """Yield every subset of a mask, the empty one too."""
    part = mask
    while True:
        yield part
        if not part:
            return
        part = (part - 1) & mask


def obeys(masks: tuple[int, ...], M: int, f: int, local: bool) -> bool:
    """Return whether M is f-total, or f-local: every node outside M hears at most f nodes of M."""
    if not local:
        return M.bit_count() <= f
    return all((heard & M).bit_count() <= f for i, heard in enumerate(masks) if not M >> i & 1)


@cache
def has_trap(masks: tuple[int, ...], f: int, local: bool) -> bool:
    """Return whether some M leaves two disjoint sets whose nodes hear at most f outside their set and M."""
    everybody = (1 << len(masks)) - 1
    for M in subsets(everybody):
        if not obeys(masks, M, f, local):
            continue
        held = [
            S
            for S in subsets(everybody & ~M)
            if S and all((masks[i] & ~S & ~M).bit_count() <= f for i in range(len(masks)) if S >> i & 1)
        ]
        if any(not S1 & S2 for S1 in held for S2 in held):
            return True
    return False


@cache
def has_standing_attack(masks: tuple[int, ...], f: int, local: bool) -> bool:
    """Return whether some M inside two disjoint sets leaves in each a normal node, all hearing at most f outside."""
    n = len(masks)
    everybody = (1 << n) - 1
    for M in subsets(everybody):
        if not obeys(masks, M, f, local):
            continue
        # Sets whose normal members all hear at most f outside, and that have one.
        held = [
            S
            for S in subsets(everybody)
            if S & ~M and all((masks[i] & ~S).bit_count() <= f for i in range(n) if S & ~M & 1 << i)
        ]
        if any(not S1 & S2 and M & ~(S1 | S2) == 0 for S1 in held for S2 in held):
            return True
    return False


def expected(graph: Digraph) -> dict[str, tuple[int, int]]:
    """Return (guaranteed, refuted) for every threat model of a graph on at least two nodes."""
    masks, profile, top = graph.in_masks, brute_profile(graph), graph.n

    def first(condition: object) -> int:
        return next(f for f in range(top + 1) if condition(f))  # type: ignore[operator]

    def s_max(r: int) -> int:
        return profile.get(r, 0)

    trapped = first(lambda f: has_trap(masks, f, False))
    around = first(lambda f: has_trap(masks, f, True))
    refuted = {
        "malicious": first(lambda f: s_max(f + 1) < f + 1),
        "malicious-local": first(lambda f: has_standing_attack(masks, f, True)),
        "byzantine": trapped,
        "byzantine-local": around,
        "delayed": trapped,
        "delayed-local": around,
    }
    return {model: (f - 1, f) for model, f in refuted.items()}


def has_trap_over_time(sequence: TimeVaryingGraph, ages: tuple[int, int, int], f: int, local: bool) -> bool:
    """Return whether of some triple nobody is ever active at g consecutive steps, for ages (tau, b, g): Theorem C (b).

    For sequences that repeat from their first step on.
    """
    tau, delay, gap = ages
    period = len(sequence)
    union = sequence.union(0, period).in_masks
    used = [sequence.union(k, tau - delay + 1).in_masks for k in range(period)]
    everybody = (1 << sequence.n) - 1

    def is_held(S: int, M: int) -> bool:
        for i in range(sequence.n):
            if S >> i & 1:
                active = [(masks[i] & ~S & ~M).bit_count() > f for masks in used]
                if any(all(active[(k + m) % period] for m in range(gap)) for k in range(period)):
                    return False
        return True

    for M in subsets(everybody):
        if obeys(union, M, f, local):
            held = [S for S in subsets(everybody & ~M) if S and is_held(S, M)]
            if any(not S1 & S2 for S1 in held for S2 in held):
                return True
    return False
