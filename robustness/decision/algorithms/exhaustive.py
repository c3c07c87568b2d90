"""Every pair of nonempty disjoint sets, straight from the definition. Slow on purpose: the oracle.

For each of the ``3^n`` ways to put every node into S1, S2 or neither, the three conditions of
(r,s)-robustness are evaluated as they are written. Nothing is pruned, so that nothing can be wrong but
the definition itself. All other algorithms are compared with this one.
"""

from __future__ import annotations

from robustness.answers import Answer
from robustness.digraph import Digraph
from robustness.evidence import Exhausted, Pair
from robustness.limits import Limits

__all__ = ["decide"]


def decide(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    """Decide (r,s)-robustness by the definition. Time ``O(3^n)`` after ``O(n 2^n)`` preparation."""
    hears, everyone = graph.in_masks, (1 << graph.n) - 1
    reachable: dict[int, int] = {}
    for members in range(1, everyone + 1):
        if members & 1023 == 0 and limits.expired():
            return Answer.undecided("the time limit was reached", {"pairs": 0})
        outside = everyone ^ members
        reachable[members] = sum(
            1 << i for i in range(graph.n) if members >> i & 1 and (hears[i] & outside).bit_count() >= r
        )
    pairs = 0
    for first in range(1, everyone + 1):
        if limits.expired():
            return Answer.undecided("the time limit was reached", {"pairs": pairs})
        second = rest = everyone ^ first
        while second:
            pairs += 1
            x1, x2 = reachable[first], reachable[second]
            if not (x1 == first or x2 == second or x1.bit_count() + x2.bit_count() >= s):
                return Answer.violated_by(Pair(_ids(first), _ids(second)), {"pairs": pairs})
            second = (second - 1) & rest
    return Answer(Exhausted(), {"pairs": pairs})


def _ids(mask: int) -> frozenset[int]:
    return frozenset(i for i in range(mask.bit_length()) if mask >> i & 1)
