"""Choices by construction, where all links can be added: in milliseconds, and some that reach the goal for certain.

A complete core, then one node after the other, each of which hears k of what is there.

Lemma (growth; LeBlanc, Zhang, Koutsoukos and Sundaram 2013, Theorem 5). A complete network of 2k - 1 nodes is k-robust,
and a k-robust network stays so when a node comes that hears k of it. A k-robust network is (r,s)-robust for
k = r + s - 1, and has no trap and no violation for k = 2f + 1.

With smaller k, from k = r on, and with a core of k nodes the network may miss the goal; it costs less, and repairing it
less than to begin with nothing. A tree whose nodes all hear one hub besides misses nothing for (2,2).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robustness.mending.actions import Actions
from robustness.mending.demands import bits
from robustness.mending.goal import Part

__all__ = ["grown_choices"]


def grown_choices(heard: Sequence[int], parts: Sequence[Part], actions: Actions) -> Iterator[frozenset[int]]:
    """Yield choices, the last of which reaches all parts, as far as the links that they need are actions and allowed.

    ``heard``: the in-neighbour masks before mending.
    """
    by_arc = {arc: a for a, item in enumerate(actions.items) for arc in item.arcs}
    certain = max((part.r + part.s - 1 if part.trap is None else 2 * part.trap.f + 1 for part in parts), default=0)
    least = max((part.enough for part in parts), default=0)
    for k, core in ((each, size) for each in range(least, certain + 1) for size in (each, 2 * each - 1)):
        wanted = _grown(heard, k, min(len(heard), core))
        if actions.most is None and all(arc in by_arc for arc in wanted):
            chosen = frozenset(by_arc[arc] for arc in wanted) | actions.required
            if actions.budget is None or sum(actions.items[a].cost for a in chosen) <= actions.budget:
                yield chosen


def _grown(heard: Sequence[int], k: int, core_size: int) -> set[tuple[int, int]]:
    """Return the arcs to add.

    The core is where most links are already; then always the node comes that hears most of what is there, and what it
    lacks it hears from those of the core that most hear.
    """
    n = len(heard)
    order = sorted(range(n), key=lambda i: (-heard[i].bit_count(), i))
    inside = 0
    while inside.bit_count() < core_size:
        inside |= 1 << max((i for i in order if not inside >> i & 1), key=lambda i: (heard[i] & inside).bit_count())
    core = list(bits(inside))
    wanted = {(j, i) for i in core for j in core if i != j and not heard[i] >> j & 1}
    hubs = sorted(core, key=lambda j: (-sum(mask >> j & 1 for mask in heard), j))
    waiting = [i for i in order if not inside >> i & 1]
    while waiting:
        i = max(waiting, key=lambda each: (heard[each] & inside).bit_count())
        missing = max(0, k - (heard[i] & inside).bit_count())
        wanted.update((j, i) for j in [j for j in hubs if not heard[i] >> j & 1][:missing])
        waiting.remove(i)
        inside |= 1 << i
    return wanted
