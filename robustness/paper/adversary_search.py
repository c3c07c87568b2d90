"""Adversaries that search: what they leave of the spread on every small network that only the exact condition promises.

``python -m robustness.paper.adversary_search docs`` makes docs/searching-adversaries.jsonl anew, a line for each
network, and the page docs/searching-adversaries.md, in five minutes.

A *policy* repeats after a few steps. It says for every phase whom each liar shows what (the lowest place of the normal
vehicles, the highest, or the receiver's own), how old what everybody hears is, and who updates. It is found by hill
climbing from random policies and from one that a greedy choice suggests, receiver by receiver: who starts above the
middle is shown the highest place and the oldest values, who starts below it the lowest. Every set of liars that obeys
its bound is tried: f in all, and of every size around each vehicle. Nothing is shared with the simulator: the motion is
written out again, as docs/theorems.md has it (H1 to H6).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robustness.constructions.families import complete, wheel
from robustness.constructions.lemma_1 import profile
from robustness.constructions.small_graphs import each_graph
from robustness.digraph import Digraph, as_digraph
from robustness.gain_region import gain_region, hull_velocity_factor
from robustness.traps import find_trap

__all__ = [
    "CONTROLS",
    "FLEETS",
    "Row",
    "Vehicles",
    "attacked",
    "left_of_the_worst",
    "liars",
    "page",
    "promised",
    "rows",
    "spread_left",
]

Numbers = npt.NDArray[Any]

#: Steps of a policy before it repeats, steps of a run, policies that climb side by side, and their steps uphill.
PHASES, STEPS, CLIMBERS, CLIMB = 4, 120, 24, 6
#: What a liar shows; any other number: the receiver's own place.
LOW, HIGH = 0, 1


@dataclass(frozen=True, slots=True)
class Vehicles:
    """How vehicles move (T = 1): ``s = sigma T²``, ``a = alpha T``, delays up to b, updates up to g steps apart."""

    s: float = 0.25
    a: float = 1.5
    delay: int = 2
    gap: int = 2

    @property
    def coasting(self) -> float:
        """The factor c of the hull of p and p + c q; 1 outside the gain region."""
        region = gain_region(1.0, self.s)
        inside = region is not None and region[0] <= self.a <= region[1]
        return hull_velocity_factor(1.0, self.a, self.s) if inside else 1.0


@dataclass(frozen=True, slots=True, eq=False)
class _Policies:
    """A batch of B policies on n vehicles.

    ``shown`` and ``late`` uint8, shape ``(B, PHASES, n, n)``, of receiver and sender; ``update`` bool, shape
    ``(B, PHASES, n)``.
    """

    shown: Numbers
    late: Numbers
    update: Numbers

    def parts(self) -> tuple[Numbers, Numbers, Numbers]:
        return self.shown, self.late, self.update


def promised(largest: int, f: int, *, directed: bool) -> Iterator[Digraph]:
    """Yield every connected graph (or digraph) without a trap for f that is not (2f+1)-robust, up to isomorphism."""
    for graph in each_graph(largest, directed=directed):
        table = profile(graph)
        if graph.n <= 3 * f or table[f + 1] < 1 or (len(table) > 2 * f + 1 and table[2 * f + 1] >= 1):
            continue
        if find_trap(graph, f).exists is False:
            yield graph


def liars(graph: Digraph, f: int, *, local: bool) -> Iterator[frozenset[int]]:
    """Yield every nonempty set of liars that leaves two normal vehicles: f in all, or at most f around each."""
    hears = _adjacency(graph)
    for size in range(1, (graph.n - 2 if local else min(f, graph.n - 2)) + 1):
        for chosen in combinations(range(graph.n), size):
            rest = [i for i in range(graph.n) if i not in chosen]
            if not local or hears[np.ix_(rest, chosen)].sum(axis=1).max() <= f:
                yield frozenset(chosen)


def spread_left(
    graph: Digraph,
    f: int,
    bad: Iterable[int],
    vehicles: Vehicles = Vehicles(),
    *,
    seed: int = 0,
    climb: int = CLIMB,
    steps: int = STEPS,
) -> float:
    """Return the largest spread that the search leaves after so many steps, of 1 at the start.

    Starts at rest, the normal vehicles at 0, at 1 or between. The spread is the length of the hull of all p and
    p + c q.
    """
    rng = np.random.default_rng(seed)
    hears, normal = _adjacency(graph), np.array([i not in frozenset(bad) for i in range(graph.n)])
    start = rng.choice([0.0, 0.5, 1.0], size=(CLIMBERS, graph.n), p=[0.4, 0.2, 0.4])
    free = np.flatnonzero(normal)
    start[:, free[0]], start[:, free[-1]] = 0.0, 1.0
    best = _first_policies(rng, graph.n, vehicles, start)
    left = _run(hears, normal, f, vehicles, best, start, steps)
    for _ in range(climb):
        other = _changed(rng, best, vehicles)
        moved = np.where(rng.random(start.shape) < 1 / graph.n, rng.choice([0.0, 0.5, 1.0], size=start.shape), start)
        moved[:, free[0]], moved[:, free[-1]] = 0.0, 1.0
        reached = _run(hears, normal, f, vehicles, other, moved, steps)
        better = reached >= left
        start[better], left[better] = moved[better], reached[better]
        for kept, tried in zip(best.parts(), other.parts(), strict=True):
            kept[better] = tried[better]
        # The best policy takes the place of the worst few.
        order = np.argsort(left, kind="stable")
        worst, top = order[: CLIMBERS // 6], order[-1]
        for part in (*best.parts(), start, left):
            part[worst] = part[top]
    return float(left.max())


def _adjacency(graph: Digraph) -> Numbers:
    hears = np.zeros((graph.n, graph.n), bool)
    hears[graph.heads, graph.in_indices] = True
    return hears


def _lawful(update: Numbers, gap: int) -> Numbers:
    """Let everybody update who otherwise would not, at least once in any ``gap`` steps of the repeated policy."""
    for _ in range(2):
        for phase in range(PHASES):
            waited = np.stack([update[:, (phase - k) % PHASES] for k in range(gap)])
            update[:, phase] |= ~waited.any(axis=0)
    return update


def _first_policies(rng: np.random.Generator, n: int, vehicles: Vehicles, start: Numbers) -> _Policies:
    shape = CLIMBERS, PHASES, n, n
    shown, late = rng.integers(0, 3, shape, np.uint8), rng.integers(0, vehicles.delay + 1, shape, np.uint8)
    update = rng.random(shape[:3]) < 0.5
    half = CLIMBERS // 2
    shown[:half] = np.where(start[:half] >= 0.5, HIGH, LOW)[:, None, :, None]
    late[: half // 2] = vehicles.delay
    update[:half] = True
    return _Policies(shown, late, _lawful(update, vehicles.gap))


def _changed(rng: np.random.Generator, policies: _Policies, vehicles: Vehicles) -> _Policies:
    shape, rate = policies.shown.shape, rng.choice([0.02, 0.1, 0.3])
    shown = np.where(rng.random(shape) < rate, rng.integers(0, 3, shape, np.uint8), policies.shown)
    late = np.where(rng.random(shape) < rate, rng.integers(0, vehicles.delay + 1, shape, np.uint8), policies.late)
    return _Policies(shown, late, _lawful(policies.update ^ (rng.random(shape[:3]) < rate), vehicles.gap))


def _run(
    hears: Numbers,
    normal: Numbers,
    f: int,
    vehicles: Vehicles,
    policies: _Policies,
    start: Numbers,
    steps: int = STEPS,
) -> Numbers:
    """Return the spread after so many steps of every policy, shape ``(B,)``."""
    runs, n = start.shape
    p, q = start.copy(), np.zeros_like(start)
    weight = vehicles.s / np.maximum(hears.sum(axis=1) - f, 1)
    past = np.repeat(p[None], vehicles.delay + 1, axis=0)
    held, kept = np.zeros((runs, n, n)), np.zeros((runs, n, n), bool)
    at = np.arange(runs)[:, None, None], np.arange(n)
    for step in range(steps):
        phase = step % PHASES
        low, high, _ = _ends(p, q, normal, vehicles)
        shown = policies.shown[:, phase]
        lies = np.where(shown == HIGH, high[:, None, None], np.where(shown == LOW, low[:, None, None], p[:, :, None]))
        heard = np.where(normal, past[policies.late[:, phase], at[0], at[1]], lies)
        now = policies.update[:, phase, :, None]
        held = np.where(now, heard, held)
        kept = np.where(now, _filter(heard - p[:, :, None], hears, f), kept)
        e = weight * np.where(kept, held - p[:, :, None], 0.0).sum(axis=2)
        u = e - vehicles.a * q
        p, q = p + q + u / 2, q + u
        past = np.concatenate([p[None], past[:-1]])
    low, high, length = _ends(p, q, normal, vehicles)
    return length


def _filter(off: Numbers, hears: Numbers, f: int) -> Numbers:
    """Return what H4 keeps of ``off``, the heard values less the own, shape ``(B, n, n)``."""
    kept = np.broadcast_to(hears, off.shape).copy()
    for sign in (1.0, -1.0):
        for _ in range(f):
            value = np.where(kept, sign * off, -np.inf)
            worst = value.argmax(axis=2)[..., None]
            out = np.take_along_axis(value, worst, 2) >= 0
            np.put_along_axis(kept, worst, np.take_along_axis(kept, worst, 2) & ~out, 2)
    return kept


def _ends(p: Numbers, q: Numbers, normal: Numbers, vehicles: Vehicles) -> tuple[Numbers, Numbers, Numbers]:
    """Return the least and the greatest p of normal vehicles, and the length of the hull of all p and p + c q."""
    place, ahead = p[:, normal], (p + vehicles.coasting * q)[:, normal]
    length = np.maximum(place.max(axis=1), ahead.max(axis=1)) - np.minimum(place.min(axis=1), ahead.min(axis=1))
    return place.min(axis=1), place.max(axis=1), length


#: Gains that the search takes in turns: inside the region, at both of its ends, and with s next to 1.
FLEETS = (Vehicles(), Vehicles(a=0.875), Vehicles(a=1.875), Vehicles(0.81, 1.5, 1, 3))

#: What must not contract: networks with a trap, s = 1, and gains outside the region.
CONTROLS: tuple[tuple[str, Digraph, int, frozenset[int], Vehicles], ...] = (
    ("wheel on 5 vehicles, f = 1: a trap", as_digraph(wheel(5)), 1, frozenset({0}), Vehicles()),
    ("K_6, f = 2: a trap", as_digraph(complete(6)), 2, frozenset({0, 1}), Vehicles()),
    ("two vehicles, nobody lies, s = 1, a = 3/2", as_digraph(complete(2)), 0, frozenset(), Vehicles(1.0, 1.5, 1, 1)),
    ("two vehicles, nobody lies, s = 1/4, a = 1/4", as_digraph(complete(2)), 0, frozenset(), Vehicles(0.25, 0.25)),
    ("two vehicles, nobody lies, s = 1/4, a = 2.1", as_digraph(complete(2)), 0, frozenset(), Vehicles(0.25, 2.1)),
)


@dataclass(frozen=True, slots=True)
class Row:
    """One network under attack: how many sets of liars, and the largest spread that each fleet was left with."""

    directed: bool
    n: int
    f: int
    arcs: tuple[tuple[int, int], ...]
    #: Whether sets of liars were local; else they were f in all.
    local: bool
    sets: int
    left: tuple[float, ...]

    @classmethod
    def of(cls, document: dict[str, Any]) -> Row:
        """Return the row of a line of the table."""
        arcs = tuple((u, v) for u, v in document["arcs"])
        return cls(**{**document, "arcs": arcs, "left": tuple(document["left"])})


def attacked(graph: Digraph, f: int) -> Row:
    """Attack every set of liars in every fleet; local sets are played where there is no local trap."""
    local = find_trap(graph, f, local=True).exists is False
    sets = list(liars(graph, f, local=local))
    left = [max(spread_left(graph, f, bad, fleet, seed=k) for k, bad in enumerate(sets)) for fleet in FLEETS]
    arcs = tuple((int(u), int(v)) for u, v in graph.arcs())
    return Row(graph.directed, graph.n, f, arcs, local, len(sets), tuple(float(f"{each:.3g}") for each in left))


def rows(largest: int = 7) -> Iterator[Row]:
    """Yield the table: connected graphs with up to so many nodes, digraphs with up to four."""
    for directed in (False, True):
        for f in (1, 2):
            for graph in promised(min(largest, 4) if directed else largest, f, directed=directed):
                yield attacked(graph, f)


def left_of_the_worst(table: Sequence[Row], steps: int) -> float:
    """Return what is left after so many steps where most was left: the same network, fleet and sets of liars."""
    row = max(table, key=lambda row: max(row.left))
    graph, fleet = Digraph(range(row.n), row.arcs, directed=row.directed), FLEETS[row.left.index(max(row.left))]
    every = enumerate(liars(graph, row.f, local=row.local))
    return max(spread_left(graph, row.f, bad, fleet, seed=k, steps=steps) for k, bad in every)


def page(table: Sequence[Row]) -> str:
    """Return the page of the documentation as Markdown."""
    lines = []
    for directed, f, n in sorted({(row.directed, row.f, row.n) for row in table}):
        group = [row for row in table if (row.directed, row.f, row.n) == (directed, f, n)]
        left = " | ".join(f"{max(each):.1e}" for each in zip(*(row.left for row in group), strict=True))
        kind, sets = "digraphs" if directed else "graphs", sum(row.sets for row in group)
        lines.append(f"| {kind} | {n} | {f} | {len(group)} | {sets} | {left} |")
    controls = [
        f"| {name} | {spread_left(graph, f, bad, vehicles, climb=10 * CLIMB):.3f} |"
        for name, graph, f, bad, vehicles in CONTROLS
    ]
    fleets = " | ".join(f"s = {each.s:g}, a = {each.a:g}, b = {each.delay}, g = {each.gap}" for each in FLEETS)
    return _PAGE.format(
        fleets=fleets,
        rule="|---" * (5 + len(FLEETS)) + "|",
        rows="\n".join(lines),
        controls="\n".join(controls),
        steps=STEPS,
        longer=", ".join(f"{left_of_the_worst(table, k * STEPS):.2f} after {k * STEPS}" for k in (2, 4)),
        phases=PHASES,
    )


_PAGE = """\
# Adversaries that search

The theorems are [proven](theorems.md). This page is an attack on them all the same, on every connected graph
on up to 7 nodes and every digraph on up to 4 that only the exact condition promises: no trap, but not
$(2f+1)$-robust. It is made by a command:

```
python -m robustness.paper.adversary_search docs
```

An adversary chooses the liars (every set of at most $f$, and, where there is no local trap, every set with at
most $f$ around each normal vehicle), what each shows to whom, the age of all that is heard, who updates when,
and the start; all of it periodic with {phases} steps, found by hill climbing from random policies and from
greedy ones, which push every receiver to the end that it is nearer to. Gains lie inside the region, at both
of its ends, and next to $s = 1$. The motion is written out anew and shares nothing with the simulator.

The largest spread (the length of the hull of all $p$ and $p + cq$) after {steps} steps, of 1 at the start, for
vehicles with $s = \\sigma T^2$, $a = \\alpha T$, delays up to $b$ and updates up to $g$ steps apart:

| | n | f | networks | sets of liars | {fleets} |
{rule}
{rows}

Where most is left it falls by about the same factor in the same time: {longer}, with a search for these lengths.

`searching-adversaries.jsonl` beside this page has a line for each network; `tests/tolerance/test_adversary_search.py`
attacks some of them anew. The same search where it must succeed; most of the spread is left, or it grows:

| control | left |
|---|---|
{controls}
"""


if __name__ == "__main__":
    folder, table = Path(sys.argv[1]), list(rows())
    text = "".join(json.dumps(asdict(row)) + "\n" for row in table)
    (folder / "searching-adversaries.jsonl").write_text(text, encoding="utf-8")
    (folder / "searching-adversaries.md").write_text(page(table), encoding="utf-8")
