r"""The bound raised step by step: is there a choice that costs no more than what is proven so far?

A tree search (:mod:`robustness.mending.choice_search`) over the demands known so far looks for a choice within a budget
that is the bound itself (iterative deepening: Korf 1985). Where there is none, the bound rises to the least that was
given up; a choice that meets all demands is either the cheapest, or has a violation, which is one demand more.

Within a budget t demands are stronger. By the lemma on spreading (:mod:`robustness.mending.covers`) a set U either is
worth s, or takes everything in at the price of so many links outside a cover; when these cost more than t, U alone has
to be worth s, whatever the other side does. A choice that evades this costs at least that price: the bound rises no
further than to the least of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

from robustness import kernels
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.limits import Limits
from robustness.mending.actions import Actions
from robustness.mending.choice_search import MOST_LEVELS, MOST_NODES, ChoiceSearch
from robustness.mending.covers import Cover, cover_around, price_outside
from robustness.mending.demands import Side, worth
from robustness.mending.goal import Part

__all__ = ["Deepening"]

#: Nodes of the tree in the first round, by which factor more in the next one, and never more: counted, so that every
#: machine does the same. Few at first, so that links that reach the goal do not wait for a proof.
_LOOKS, _GROWTH, _MOST = 20_000, 1.8, 2_000_000

#: The clock is looked at after so many nodes; plain Python takes as long for one in a hundred.
_SLICE, _PLAIN = 4_000, 100

#: Larger sets take in much for little.
_LARGEST = 10

#: One side alone has to be worth s when there is no other.
Demand = tuple[Side, Side | None]


class Asked(Protocol):
    """What the tree search needs of the search it is a part of (:class:`robustness.mending.hitting_set.Search`)."""

    graph: Digraph
    actions: Actions
    parts: Sequence[Part]
    limits: Limits
    best: frozenset[int] | None
    bound: int
    rows: list[tuple[Side, Side]]
    covers: list[tuple[Part, tuple[int, ...], Cover]]
    base: list[int]
    is_up_to_swapping: bool

    @property
    def is_done(self) -> bool:
        """Whether there is nothing more to find out."""

    def cost(self, chosen: Iterable[int]) -> int:
        """Return what a choice costs."""

    def heard(self, chosen: Iterable[int]) -> list[int]:
        """Return the in-neighbour masks of the network with a choice."""

    def sides(self, part: Part) -> list[Side]:
        """Return all sides of a part that were met, with no malicious set."""

    def open_pair(self, chosen: Iterable[int]) -> tuple[Side, Side] | None:
        """Return a demand that the choice does not meet, a new one where all known ones are met."""

    def improve(self, chosen: frozenset[int] | None) -> None:
        """Take in a choice that reaches the goal."""

    def raise_bound(self, proven: int) -> None:
        """No choice that reaches the goal costs less than this."""

    def rule_out(self) -> None:
        """No choice meets the demands."""


class Deepening:
    """The tree search of a question, and what was learnt for it."""

    def __init__(self, search: Asked) -> None:
        self._search = search
        self._tree: ChoiceSearch | None = None
        self._budget = -1
        self._known: set[Demand] = set()
        self._rows_seen = 0
        self._evading: int | None = None
        self._told: set[tuple[Part, int]] = set()
        self._around: dict[tuple[Part, int], tuple[Cover, int | None]] = {}
        self._looks = float(_LOOKS)

    @classmethod
    def of(cls, search: Asked) -> Deepening | None:
        """Return the tree search of a question, where it can be had: on 64 nodes and links that all cost something."""
        is_fit = 2 <= search.graph.n <= MOST_NODES and search.actions.cheapest > 0
        return cls(search) if is_fit else None

    def go_on(self) -> None:
        """Search for so many nodes; raise the bound, or find the cheapest choice, where it comes to that."""
        search = self._search
        scale = 1 if kernels.IS_COMPILED else _PLAIN
        left = int(self._looks) // scale
        self._looks = min(self._looks * _GROWTH, _MOST)
        while left > 0 and not search.is_done:
            if search.limits.expired():
                raise Undecided("the limit came during the tree search")
            tree = self._current()
            if tree is None:
                return
            before = tree.nodes
            is_over, chosen = tree.run(min(left, _SLICE // scale))
            left -= max(1, tree.nodes - before)
            if is_over:
                prices = [price for price in (tree.beyond, self._evading) if price is not None]
                self._rise(min(prices, default=None))
            elif chosen is not None:
                self._examine(chosen)

    def _rise(self, beyond: int | None) -> None:
        self._raise_or_rule_out(beyond)
        self._search.is_up_to_swapping = ChoiceSearch.can_swap(self._search.actions)

    def _raise_or_rule_out(self, beyond: int | None) -> None:
        search = self._search
        if search.best is not None:
            most = search.cost(search.best)
            search.raise_bound(most if beyond is None else min(beyond, most))
        elif beyond is None or (search.actions.budget is not None and beyond > search.actions.budget):
            search.rule_out()
        else:
            search.raise_bound(beyond)

    def _examine(self, chosen: frozenset[int]) -> None:
        search = self._search
        pair = search.open_pair(chosen)
        if pair is None:
            search.improve(chosen)
            search.raise_bound(search.cost(chosen))
            return
        heard = search.heard(chosen)
        self._take([pair])
        for part in search.parts:
            if part.trap is None:
                self._take((side, None) for side in search.sides(part) if worth(side, heard) < part.s)

    def _current(self) -> ChoiceSearch | None:
        """Return the tree for the bound as it is, with all demands; None where it would be too deep."""
        search = self._search
        if self._budget != search.bound or self._tree is None:
            if search.bound // search.actions.cheapest >= MOST_LEVELS:
                return None
            self._budget, self._known, self._rows_seen, self._evading = search.bound, set(), 0, None
            self._tree = ChoiceSearch(search.base, search.actions, self._budget)
            for part in search.parts:
                if part.trap is None:
                    self._take((side, None) for side in search.sides(part))
        if self._rows_seen < len(search.rows):
            new = search.rows[self._rows_seen :]
            self._rows_seen = len(search.rows)
            self._take(new)
        return self._tree

    def _take(self, demands: Iterable[Demand]) -> None:
        """Add demands to the tree, each in its strongest form within the budget."""
        fresh: list[Demand] = []
        for first, second in demands:
            alone = [side for side in (first, second) if side is not None and self._stands_alone(side)]
            strong: list[Demand] = [(side, None) for side in alone]
            if not strong and second is not None:
                strong = [(first, second)]
            fresh += [each for each in strong if each not in self._known]
            self._known.update(strong)
        if self._tree is not None and fresh:
            self._tree.add(dict.fromkeys(fresh))

    def _stands_alone(self, side: Side) -> bool:
        """Return whether a side has to be worth s in every choice within the budget."""
        part, U, search = side.part, side.S, self._search
        if part.trap is not None or not part.r <= U.bit_count() <= _LARGEST or worth(side, search.base) >= part.s:
            return False
        if (part, U) not in self._around:
            cover = cover_around(search.base, U, part.r)
            self._around[part, U] = cover, price_outside(cover, search.graph.n, part.r, search.actions.items)
        cover, least = self._around[part, U]
        if (least is not None and least <= self._budget) or any(V.bit_count() < 2 for V in cover):
            return False  # certificates know no sets of one node, which would be of use for r = 1 alone
        if least is not None:
            self._evading = least if self._evading is None else min(self._evading, least)
        if (part, U) not in self._told:
            self._told.add((part, U))
            search.covers.append((part, (U,), cover))
        return True
