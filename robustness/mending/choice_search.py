"""A tree search over choices of links: whether a choice of a few links meets all demands known so far.

The counterpart of the master problem (:mod:`robustness.mending.master`) where few links are enough: the kernel looks at
10^5 choices a second and more (:mod:`robustness.kernels.choice_tree`), and takes new demands in where it stands.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from robustness.kernels.choice_tree import ChoiceTree
from robustness.mending.actions import Actions
from robustness.mending.demands import Side, Unit, units, unlocalizers

__all__ = ["MOST_LEVELS", "MOST_NODES", "ChoiceSearch"]

#: Node sets of the kernel are single words.
MOST_NODES = 64

#: What the kernel says where nothing was given up for its cost.
_NEVER = 1 << 60

#: A budget of so many links at most: every level of the tree takes memory.
MOST_LEVELS = 64


class ChoiceSearch:
    """A search for a choice within a budget, that can be stopped, told more demands, and gone on with.

    Parameters
    ----------
    heard : sequence of int
        The in-neighbour masks before mending.
    actions : Actions
        Each of which costs at least 1.
    budget : int
        What a choice may cost, in units of the scale.
    is_swapping : bool
        Whether one of links that swapping two nodes makes the same is enough: then what is ruled out is ruled out by
        the demands and their images under swaps.
    """

    def __init__(self, heard: Sequence[int], actions: Actions, budget: int, *, is_swapping: bool = True) -> None:
        n, count = len(heard), len(actions.items)
        self._n = n
        self._actions = actions
        into, arcs = np.full((n, n), -1, dtype=np.int32), np.full((count, 4), -1, dtype=np.int32)
        usable = [0] * n
        base = list(heard)
        gained = [0] * n
        for a, item in enumerate(actions.items):
            for k, (tail, head) in enumerate(item.arcs):
                into[head, tail] = a
                arcs[a, 2 * k : 2 * k + 2] = tail, head
                usable[head] |= 1 << tail
                if a in actions.required:
                    base[head] |= 1 << tail
                    gained[head] += 1
        costs = np.array([item.cost for item in actions.items], dtype=np.int64)
        spent = sum(actions.items[a].cost for a in actions.required)
        levels = max(0, budget - spent) // int(costs.min(initial=budget + 1)) + 2
        room = [n if actions.most is None else actions.most[i] - gained[i] for i in range(n)]
        for i in range(n):
            if room[i] <= 0:
                for a in {int(each) for each in into[i] if each >= 0}:
                    for tail, head in actions.items[a].arcs:
                        usable[head] &= ~(1 << tail)
        self._heard = np.zeros((levels, n), dtype=np.uint64)
        self._heard[0] = base
        self._usable = np.zeros((levels, n), dtype=np.uint64)
        self._usable[0] = usable
        self._options = np.zeros((levels, max(count, 1)), dtype=np.int32)
        self._picked = np.zeros((levels, 2), dtype=np.int64)
        spents = np.zeros(levels, dtype=np.int64)
        spents[0] = spent
        self._reachable = [base[i] | usable[i] for i in range(n)]
        self._tree = ChoiceTree(
            (
                into,
                costs,
                arcs,
                max((len(item.arcs) for item in actions.items), default=1),
                is_swapping and self.can_swap(actions),
            ),
            budget,
            (self._heard, self._usable, self._options, self._picked, spents),
            np.array(room, dtype=np.int64),
            np.zeros(n, dtype=np.uint64),
            np.zeros(n, dtype=np.uint64),
            np.zeros(n, dtype=np.int64),
            np.zeros(n + 1, dtype=np.int64),
        )
        self._rows = np.zeros((64, 7), dtype=np.int64)
        self._units = (np.zeros(64, np.int64), np.zeros(64, np.uint64), np.zeros(64, np.int64))
        self._opened = np.zeros((levels, 64), dtype=np.int32)
        self._opened_count = np.zeros(levels, dtype=np.int64)
        self._row_count = self._unit_count = 0
        self._show_rows()

    @staticmethod
    def can_swap(actions: Actions) -> bool:
        """Return whether nodes that nothing in the network tells apart can be swapped, costs and caps included."""
        return actions.most is None and len({item.cost for item in actions.items}) <= 1

    @property
    def nodes(self) -> int:
        """Nodes of the tree looked at."""
        return int(self._tree.nodes)

    @property
    def beyond(self) -> int | None:
        """No choice that was given up costs less; at the end none that meets all demands does. None: there is none."""
        least = int(self._tree.beyond)
        return None if least == _NEVER else least

    def add(self, demands: Iterable[tuple[Side, Side | None]]) -> None:
        """Take in demands: two sides that fit, or one that has to be worth s."""
        begin = self._row_count
        for first, second in demands:
            self._append(first, second)
        if self._row_count > begin:
            self._show_rows()
            self._tree.added(begin, self._row_count)

    def run(self, nodes: int) -> tuple[bool, frozenset[int] | None]:
        """Go on for so many nodes: whether the search is at its end, and a choice that meets all demands.

        After a choice was returned, add a demand that it does not meet.
        """
        status = self._tree.run(nodes)
        if status != 1:
            return status == 0, None
        levels = range(self._tree.level)
        return False, self._actions.required | {int(self._options[k, self._picked[k, 1] - 1]) for k in levels}

    def _show_rows(self) -> None:
        plan = np.zeros((3, len(self._rows)), dtype=np.int64)
        supports = np.zeros((len(self._rows), self._n), dtype=np.uint64)
        self._tree.with_rows(self._rows, self._units, self._opened, self._opened_count, plan, supports)

    def _append(self, first: Side, second: Side | None) -> None:
        row, place = self._row_count, self._unit_count
        if row == len(self._rows):
            self._rows = np.concatenate([self._rows, np.zeros_like(self._rows)])
            self._opened = np.concatenate([self._opened, np.zeros_like(self._opened)], axis=1)
        groups = [units(first, self._n), () if second is None else units(second, self._n), unlocalizers(first, self._n)]
        self._rows[row, 4] = first.part.s
        for k, group in enumerate(groups):
            self._rows[row, k] = place
            members = list(group)
            able = [unit for unit in members if self._can_meet(unit)]
            if k < 2:
                self._rows[row, 5 + k] = len(able) == len(members) and bool(members)
            for unit in able:
                if place == len(self._units[0]):
                    self._units = tuple(np.concatenate([each, np.zeros_like(each)]) for each in self._units)  # type: ignore[assignment]
                for array, value in zip(self._units, unit, strict=True):
                    array[place] = value
                place += 1
        self._rows[row, 3] = place
        self._row_count, self._unit_count = row + 1, place

    def _can_meet(self, unit: Unit) -> bool:
        return (self._reachable[unit.node] & unit.outside).bit_count() >= unit.enough
