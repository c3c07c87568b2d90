"""Joint robustness from the definitions alone: every pair, every window. Shares nothing with the package."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from itertools import chain, product

from hypothesis import strategies as st

Arc = tuple[int, int]
Step = frozenset[Arc]


@cache
def is_robust(n: int, arcs: Step, r: int, s: int) -> bool:
    if r == 0:
        return True
    if r > (n + 1) // 2:
        return False
    hears = [{u for u, v in arcs if v == i} for i in range(n)]
    for side in product((0, 1, 2), repeat=n):
        sets = [{i for i in range(n) if side[i] == k} for k in (1, 2)]
        reached = [{i for i in members if len(hears[i] - members) >= r} for members in sets]
        if all(sets) and reached[0] != sets[0] and reached[1] != sets[1] and len(reached[0] | reached[1]) < s:
            return False
    return True


def violates(n: int, arcs: Iterable[Arc], first: set[int], second: set[int], r: int, s: int) -> bool:
    hears = [{u for u, v in arcs if v == i} for i in range(n)]
    reached = [{i for i in members if len(hears[i] - members) >= r} for members in (first, second)]
    disjoint = bool(first) and bool(second) and not first & second
    return disjoint and reached[0] != first and reached[1] != second and len(reached[0] | reached[1]) < s


def step_at(steps: Sequence[Step], period: int | None, k: int) -> Step:
    if k < len(steps):
        return steps[k]
    assert period is not None
    while k >= len(steps):
        k -= period
    return steps[k]


def union(steps: Sequence[Step], period: int | None, start: int, length: int) -> Step:
    return frozenset(chain.from_iterable(step_at(steps, period, k) for k in range(start, start + length)))


def starts(steps: Sequence[Step], period: int | None, length: int) -> range:
    """Return the starts of all windows; of an infinite sequence more than a whole turn of them."""
    return range(len(steps) - length + 1) if period is None else range(2 * len(steps) + 1)


def holds(n: int, steps: Sequence[Step], period: int | None, r: int, s: int, length: int) -> bool:
    windows = starts(steps, period, length)
    return len(windows) > 0 and all(is_robust(n, union(steps, period, k, length), r, s) for k in windows)


def smallest(n: int, steps: Sequence[Step], period: int | None, r: int, s: int) -> int | None:
    return next((k for k in range(1, 2 * len(steps) + 2) if holds(n, steps, period, r, s, k)), None)


def all_arcs(n: int) -> list[Arc]:
    return [(u, v) for u in range(n) for v in range(n) if u != v]


def all_digraphs(n: int) -> list[Step]:
    arcs = all_arcs(n)
    return [
        frozenset(a for a, bit in zip(arcs, bits, strict=True) if bit) for bits in product((0, 1), repeat=len(arcs))
    ]


def all_graphs(n: int) -> list[Step]:
    edges = [(u, v) for u, v in all_arcs(n) if u < v]
    return [
        frozenset(chain.from_iterable(((u, v), (v, u)) for (u, v), bit in zip(edges, bits, strict=True) if bit))
        for bits in product((0, 1), repeat=len(edges))
    ]


@st.composite
def questions(draw: st.DrawFn) -> tuple[int, list[Step], int | None, int, int]:
    """Draw nodes, steps, period, r and s: finite traces, periodic and eventually periodic sequences."""
    n = draw(st.integers(1, 5))
    step = st.frozensets(st.sampled_from(all_arcs(n))) if n > 1 else st.just(frozenset())
    steps = draw(st.lists(step, min_size=1, max_size=6))
    period = draw(st.none() | st.integers(1, len(steps)))
    return n, steps, period, draw(st.integers(0, (n + 1) // 2 + 1)), draw(st.integers(1, n))
