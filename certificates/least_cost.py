"""The least cost of mending: a tree over choices of links, in which none that is cheaper does what is demanded.

A *unit* is a node with the nodes outside its set that count for it: it is met when it hears enough of them. A *demand*
is met when its units are worth s: each counts 1 that is met, and all of one side together count s. That every choice
which reaches the goal meets the demands say the lemma on choices and the lemma on spreading in
docs/certificate-format.md; of a cover that lacks links which cost more than may be spent it remains that each of its
starts is worth s.

A node of the tree has links that are chosen and links that still may be. A demand that is not met needs one of its
links at least: those that bring an arc to a unit which is not met and still can be. So there is a branch for each of
them, in which those of the branches before are given up. A node is closed when a demand can no longer be met, or when
demands no two of which share a link need more links together than can be paid for. Where they need all that can be paid
for, every other link is given up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

__all__ = ["DEFAULT_CHOICES", "no_choice_is_cheaper"]

#: Nodes of the tree that are looked at unless more are asked for: some ten seconds on 30 nodes and few hundred pairs.
DEFAULT_CHOICES = 10_000

#: Links times links, units and sets of covers: where there is more there is no tree. It takes seconds to write down.
_MOST_WORK = 2**27

#: How often links are given up at one node.
_ROUNDS = 8

#: More links than there are.
_NEVER = 1 << 62


class _Unit(NamedTuple):
    """It is met by ``enough`` of the links in the mask."""

    links: int
    enough: int


class _Demand(NamedTuple):
    """Its units have to be worth ``s``: those of two sides, and those each of which makes M no f-local set any more."""

    s: int
    sides: tuple[tuple[_Unit, ...], ...]
    others: tuple[_Unit, ...]


class _Node(NamedTuple):
    """Masks of the links that are chosen and that may be, what may be spent on these, and what may be unmet."""

    chosen: int
    free: int
    budget: int
    demands: list[_Demand]


def no_choice_is_cheaper(
    hears: Sequence[Sequence[int]], document: dict[str, Any], may_go_on: Callable[[int], bool]
) -> bool:
    """Return whether a tree over choices shows that none costs less than the certificate claims.

    ``document`` is the header of a mending certificate of which all else has been verified; ``may_go_on`` is asked with
    the nodes looked at so far. False says nothing: it said no, or a cheaper choice meets the demands written down.
    """
    if not may_go_on(0) or _work(len(hears), document) > _MOST_WORK:
        return False
    problem = _Problem(hears, document)
    path, looked = [iter([problem.root])], 0
    while path:
        node = next(path[-1], None)
        if node is None:
            path.pop()
            continue
        if not may_go_on(looked):
            return False
        looked += 1
        left = problem.narrowed(node)
        if left is None:
            continue
        node, options = left
        if not node.demands:
            return False
        path.append(problem.branches(node, options))
    return True


def _work(n: int, document: dict[str, Any]) -> int:
    """Return how many bits are written down, about: a mask of links for each unit."""
    links = len(document["actions"]["links"])
    local = [part.get("bound") == "local" for part in document["claim"]["parts"]]
    units = sum(n * local[k] + len(S1) + len(S2) for k, _, S1, S2 in document["pairs"])
    units += sum(len(sets) + sum(map(len, starts)) for _, starts, *sets in document["covers"])
    return int(links * (links + units))


class _Problem:
    """What a certificate demands of a choice, over masks of its links."""

    def __init__(self, hears: Sequence[Sequence[int]], document: dict[str, Any]) -> None:
        actions, claim = document["actions"], document["claim"]
        self._hears = [frozenset(heard) for heard in hears]
        self._everybody = frozenset(range(len(hears)))
        self._links = actions["links"]
        self._cheapest = min((cost for *_, cost in self._links), default=0)
        self._into: list[dict[int, int]] = [{} for _ in hears]
        for a, (u, v, _) in enumerate(self._links):
            link = 1 << a
            for tail, head in ((u, v),) if actions["one_way"] else ((u, v), (v, u)):
                if tail not in self._hears[head]:
                    self._into[head][tail] = link
        self._caps = [(sum(self._into[i].values()), most) for i, most in enumerate(actions["most"] or ())]
        everything = sum(cost for *_, cost in self._links)
        may_cost = everything if claim["least"] is None else claim["least"] - 1
        demands = [self._of_pair(claim["parts"][k], *sets) for k, *sets in document["pairs"]]
        for k, starts, *sets in document["covers"]:
            if not self._is_affordable(sets, claim["parts"][k]["r"], may_cost):
                demands += [self._of_start(claim["parts"][k], start) for start in starts]
        chosen = sum(1 << a for a in actions["required"])
        spent = sum(self._links[a][2] for a in actions["required"])
        free = self._within_caps(chosen, (1 << len(self._links)) - 1 & ~chosen)
        is_possible = all((chosen & links).bit_count() <= most for links, most in self._caps)
        self.root = _Node(chosen, free, may_cost - spent if is_possible else -1, list(dict.fromkeys(demands)))

    def _of_pair(self, part: dict[str, Any], M: list[int], *sides: list[int]) -> _Demand:
        """Return what a violation demands."""
        if "r" in part:
            return _Demand(part["s"], tuple(self._side(S, [], part["r"]) for S in sides), ())
        enough = part["f"] + 1
        ignored = M if part["faces"] == 2 else []
        units = tuple(self._side([i for i in S if i not in set(M)], [*S, *ignored], enough) for S in sides)
        local = part["bound"] == "local"
        others = [self._unit(i, frozenset(M), enough) for i in sorted(self._everybody - set(M))] if local else []
        return _Demand(1, units, tuple(others))

    def _of_start(self, part: dict[str, Any], start: list[int]) -> _Demand:
        """Return what a start of a cover demands whose links cost too much."""
        return _Demand(part["s"], (self._side(start, [], part["r"]),), ())

    def _side(self, nodes: list[int], inside: list[int], enough: int) -> tuple[_Unit, ...]:
        around = self._everybody - set(nodes) - set(inside)
        return tuple(self._unit(i, around, enough) for i in nodes)

    def _unit(self, i: int, around: frozenset[int], enough: int) -> _Unit:
        links = sum(link for tail, link in self._into[i].items() if tail in around)
        return _Unit(links, max(0, enough - len(self._hears[i] & around)))

    def _is_affordable(self, cover: list[list[int]], r: int, may_cost: int) -> bool:
        """Return whether the links that a cover lacks can be had, outside all of its sets."""
        holding: list[set[int]] = [set() for _ in self._hears]
        for k, V in enumerate(cover):
            for i in V:
                holding[i].add(k)
        lacking = _room(len(self._hears), r) - sum(_room(len(V), r) for V in cover)
        outside = sorted(cost for u, v, cost in self._links if holding[u].isdisjoint(holding[v]))
        return lacking <= len(outside) and sum(outside[: max(0, lacking)]) <= may_cost

    def _within_caps(self, chosen: int, free: int) -> int:
        """Return the free links without those to nodes that may gain no more."""
        for links, most in self._caps:
            if (chosen & links).bit_count() >= most:
                free &= ~links
        return free

    def narrowed(self, node: _Node) -> tuple[_Node, int] | None:
        """Return the node without what is met and given up, and the links of one demand; None when it is closed."""
        chosen, free, budget, demands = node
        if budget < 0:
            return None
        rounds = 0
        while True:
            rounds += 1
            unmet: list[tuple[int, int, int, int]] = []
            for place, demand in enumerate(demands):
                least, links = _needs(demand, chosen, free)
                if least == _NEVER or least * self._cheapest > budget:
                    return None
                if least:
                    unmet.append((links.bit_count(), -least, place, links))
            unmet.sort()
            apart = needed = 0
            for _, least, _, links in unmet:
                if not links & apart:
                    apart |= links
                    needed -= least
            if needed * self._cheapest > budget:
                return None
            demands = [demands[place] for _, _, place, _ in unmet]
            are_spare = (needed + 1) * self._cheapest <= budget
            if not unmet or are_spare or not free & ~apart or rounds == _ROUNDS:
                return _Node(chosen, free, budget, demands), unmet[0][3] if unmet else 0
            free &= apart

    def branches(self, node: _Node, options: int) -> Iterator[_Node]:
        """Yield a node for each link that can be paid for, without those before it."""
        chosen, free, budget, demands = node
        while options:
            link = options & -options
            options ^= link
            free ^= link
            left = budget - self._links[link.bit_length() - 1][2]
            if left >= 0:
                yield _Node(chosen | link, self._within_caps(chosen | link, free), left, demands)


def _needs(demand: _Demand, chosen: int, free: int) -> tuple[int, int]:
    """Return how many more links a demand needs at least, none when it is met, and which free ones it can use.

    A link brings one arc to each of its ends: it serves one node of each side at most, and of one side, all of whose
    nodes hear enough, one alone.
    """
    usable = met = 0
    least, gaps = _NEVER, []
    for side in demand.sides:
        whole: int | None = 0
        for links, enough in side:
            gap = enough - (chosen & links).bit_count()
            if gap <= 0:
                met += 1
            elif ((chosen | free) & links).bit_count() >= enough:
                usable |= links
                gaps.append(gap)
                whole = None if whole is None else whole + gap
            else:
                whole = None
        if side and whole is not None:
            least = min(least, whole)
    for links, enough in demand.others:
        gap = enough - (chosen & links).bit_count()
        if gap <= 0 or ((chosen | free) & links).bit_count() >= enough:
            usable |= links
            least = min(least, max(0, gap))
    wanted = demand.s - met
    if wanted <= 0 or least == 0:
        return 0, 0
    if wanted <= len(gaps):
        gaps.sort()
        least = min(least, max(gaps[wanted - 1], -(-sum(gaps[:wanted]) // 2)))
    return least, usable & free


def _room(size: int, r: int) -> int:
    """Return for how many arcs a set has room by which its nodes are taken in one after the other."""
    return sum(min(r, before) for before in range(size))
