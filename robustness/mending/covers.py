r"""Sets from which a whole network is taken in, and what that costs: lower bounds that no few violations give.

A set U *takes in* a node that hears at least r of it, and goes on with that node inside. A *cover* is a family of sets
V_1, ..., V_k such that every arc of the network before mending lies inside one of them, and the *room* of a set of m
nodes is ``0 + 1 + ... `` of m terms none of which exceeds r: ``rm - r(r+1)/2`` for m >= r.

Lemma (spreading). Let r >= 1, and U a set of at least r nodes inside one set of the cover. A choice that reaches
(r,s)-robustness makes U worth s (:mod:`robustness.mending.demands`), or at least

    room(V) - room(V_1) - ... - room(V_k)

of its links bring an arc that lies inside no set of the cover.

*Proof.* Let W be all that U takes in, in the network after mending. If W is not everything, no node outside W hears r
nodes of W: the side V - W is worth 0, U is disjoint from it, so U is worth s. If W is everything, order the nodes,
those of U first, then as they were taken in, and let F be, for every node outside U, r arcs from nodes before it. An
undirected link brings at most one arc of F. Each node of V_i outside U has at most min(r, number of nodes of V_i before
it) arcs of F inside V_i; the nodes of V_i in U come first, so together these are at most room(V_i) - room(V_i and U).
And F has r (n - |U|) = room(V) - room(U) arcs. One V_i contains U. So at least the difference lies inside no V_i; these
arcs are new, so each is brought by a link of its own. ∎

For r = 2 the best cover is known: the rigid components of the plane framework, since the rooms 2m - 3 are Laman's
count. They are found by the pebble game of Lee and Streinu (2008). So a (2,2)-robust network in which some node hears
only two is rigid in the plane; of those in which all hear three some are not: there is one of 14 nodes with 24 links.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from robustness.mending.actions import Action
from robustness.mending.demands import bits

__all__ = ["Cover", "cover_around", "lacking", "lies_inside", "price_outside", "rigid_components", "room", "starts_of"]

#: A family of sets, as masks.
Cover = tuple[int, ...]


def room(size: int, r: int) -> int:
    """Return how many arcs that take nodes in a set of this size can hold."""
    return sum(min(r, place) for place in range(size))


def lacking(cover: Iterable[int], n: int, r: int) -> int:
    """Return how many links inside no set of the cover are needed when something takes everything in."""
    return room(n, r) - sum(room(V.bit_count(), r) for V in cover)


def lies_inside(ends: tuple[int, int], cover: Cover) -> bool:
    """Return whether both ends of a link lie inside one set of a cover."""
    both = 1 << ends[0] | 1 << ends[1]
    return any(not both & ~V for V in cover)


def price_outside(cover: Cover, n: int, r: int, items: Iterable[Action]) -> int | None:
    """Return what the links cost at least that a cover lacks, none of them inside it; None when there are too few."""
    costs = sorted(item.cost for item in items if not lies_inside(item.ends, cover))
    missing = max(0, lacking(cover, n, r))
    return sum(costs[:missing]) if missing <= len(costs) else None


def starts_of(heard: Sequence[int]) -> list[int]:
    """Return every two nodes of which one hears the other, as masks: sets inside a set of every cover."""
    return sorted({1 << i | 1 << j for i, mask in enumerate(heard) for j in bits(mask)})


def cover_around(heard: Sequence[int], U: int, r: int) -> Cover:
    """Return a cover of a network with a set of nodes inside one of its sets: for r = 2 the best there is."""
    if r == 2:
        return rigid_components(heard, U)
    near = _near(heard)
    V, waiting = U, True
    while waiting:
        waiting = False
        for i, mask in enumerate(near):
            if not V >> i & 1 and (mask & V).bit_count() >= r:
                V |= 1 << i
                waiting = True
    links = (1 << i | 1 << j for i, mask in enumerate(near) for j in bits(mask) if j < i)
    return (V, *(link for link in links if link & ~V))


def rigid_components(heard: Sequence[int], whole: int = 0) -> Cover:
    """Return the rigid components of a network, whose directions are ignored, as masks of at least two nodes.

    Two of them share at most one node, and every link lies in one. ``whole``: a set all of whose nodes are linked.
    """
    n = len(heard)
    near = _near(heard)
    game = _Pebbles(n)
    components: tuple[int, ...] = ()
    if whole.bit_count() > 1:
        first, second, *others = bits(whole)
        for u, v in ((first, second), *((each, end) for each in others for end in (first, second))):
            game.insert(u, v)
        components = (whole,)
    for u in range(n):
        for v in bits(near[u]):
            if u < v and not any(each >> u & 1 and each >> v & 1 for each in components) and game.insert(u, v):
                new = game.component(u, v)
                components = (*(each for each in components if each & ~new), new)
    return components


def _near(heard: Sequence[int]) -> list[int]:
    """Return for every node those it hears or is heard by."""
    near = list(heard)
    for i, mask in enumerate(heard):
        for j in bits(mask):
            near[j] |= 1 << i
    return near


class _Pebbles:
    """Two pebbles for every node; an independent link takes one of them from one of its ends, which it leaves."""

    def __init__(self, n: int) -> None:
        self._free = [2] * n
        self._out: list[list[int]] = [[] for _ in range(n)]

    def insert(self, u: int, v: int) -> bool:
        """Take the link in when it is independent of those before."""
        if not self._gather(u, v):
            return False
        self._free[u] -= 1
        self._out[u].append(v)
        self._gather(u, v, 3)
        return True

    def component(self, u: int, v: int) -> int:
        """Return the rigid component of a link just taken in: the nodes from which no further free pebble can come."""
        n = len(self._free)
        into: list[list[int]] = [[] for _ in range(n)]
        for tail, heads in enumerate(self._out):
            for head in heads:
                into[head].append(tail)
        reached = {w for w in range(n) if self._free[w] and w not in (u, v)}
        waiting = list(reached)
        while waiting:
            for tail in into[waiting.pop()]:
                if tail not in reached and tail not in (u, v):
                    reached.add(tail)
                    waiting.append(tail)
        return sum(1 << w for w in range(n) if w not in reached)

    def _gather(self, u: int, v: int, wanted: int = 4) -> bool:
        """Bring free pebbles to the two ends; return whether so many are there."""
        while self._free[u] + self._free[v] < wanted:
            if not any(self._free[end] < 2 and self._fetch(end, other) for end, other in ((u, v), (v, u))):
                return False
        return True

    def _fetch(self, end: int, other: int) -> bool:
        """Bring one free pebble to a node, along a path that is turned around; the other end keeps its own."""
        before = {end: end, other: other}
        waiting = [end]
        while waiting:
            node = waiting.pop()
            for head in self._out[node]:
                if head in before:
                    continue
                before[head] = node
                if self._free[head]:
                    self._free[head] -= 1
                    while head != end:
                        tail = before[head]
                        self._out[tail].remove(head)
                        self._out[head].append(tail)
                        head = tail
                    self._free[end] += 1
                    return True
                waiting.append(head)
        return False
