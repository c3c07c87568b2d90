"""The violations behind a lower bound that was proven up to swapping nodes, completed for whoever does not swap.

The tree search keeps one of links that swapping two nodes makes the same (:mod:`robustness.kernels.twins`): what
rules out the one rules out the other, but by violations in which the two nodes are swapped, and those were never met.
Here the same tree is searched without swapping. A choice that costs less than the bound and meets all demands has a
violation all the same, since the bound holds; it joins the others. Where they would be too many, as of a network of
many nodes that nothing tells apart, the certificate claims no more than what its violations give.
"""

from __future__ import annotations

from dataclasses import replace

from robustness.errors import InternalError, Undecided
from robustness.limits import Limits
from robustness.mending.actions import with_actions
from robustness.mending.choice_search import MOST_LEVELS, MOST_NODES, ChoiceSearch
from robustness.mending.covers import price_outside
from robustness.mending.demands import Side, masks_of, sets_of, sides_of
from robustness.mending.growing import shrunk
from robustness.mending.oracle import first_violation
from robustness.mending.results import Problem

__all__ = ["completed"]

#: Nodes of the tree, between two looks at the clock and in all, and violations that are added: past them, what is
#: there has to be enough.
_SLICE, _MOST, _MOST_ADDED = 4_000, 1_000_000, 300

#: Nodes of the tree for each step of the bound that is claimed then.
_STEP = 100_000


def completed(problem: Problem, limits: Limits) -> Problem:
    """Return the question with the violations that its lower bound lacks, or with the bound that those there give."""
    actions, n = problem.actions, problem.graph.n
    most = sum(item.cost for item in actions.items) if problem.least is None else problem.least - 1
    is_fit = actions.cheapest > 0 and most // actions.cheapest < MOST_LEVELS and 2 <= n <= MOST_NODES
    if not (problem.is_up_to_swapping and is_fit and most >= 0):
        return problem
    tree, _ = _tree_of(problem, most)
    pairs, is_over = list(problem.pairs), False
    while tree.nodes < _MOST and len(pairs) < len(problem.pairs) + _MOST_ADDED and not limits.expired():
        is_over, chosen = tree.run(_SLICE)
        if is_over:
            break
        if chosen is None:
            continue
        mended = with_actions(problem.graph, actions, chosen)
        try:
            found = first_violation(mended, problem.parts, limits)
        except Undecided:
            break
        if found is None:
            raise InternalError("a choice that costs less than the proven bound reaches the goal: please report")
        first, second = shrunk(*sides_of(*found), masks_of(mended))
        tree.add([(first, second)])
        pairs.append((found[0], sets_of(first, second)))
    more = replace(problem, pairs=tuple(pairs))
    return more if is_over or problem.least is None else replace(more, least=_bound_of(more, problem.least))


def _tree_of(problem: Problem, budget: int) -> tuple[ChoiceSearch, int | None]:
    """Return the tree without swapping for a budget, and what a choice costs at least that evades its covers."""
    heard, items = masks_of(problem.graph), problem.actions.items
    tree = ChoiceSearch(heard, problem.actions, budget, is_swapping=False)
    demands: list[tuple[Side, Side | None]] = [sides_of(part, sets) for part, sets in problem.pairs]
    prices = []
    for part, starts, cover in problem.covers:
        price = price_outside(cover, len(heard), part.r, items)
        if price is None or price > budget:
            demands += [(Side(part, 0, U), None) for U in starts]
            prices.append(price)
    tree.add(dict.fromkeys(demands))
    return tree, min((price for price in prices if price is not None), default=None)


def _bound_of(problem: Problem, most: int) -> int:
    """Return a bound on the cost, at most this, that follows from the violations and covers of a question."""
    bound = 0
    while bound < most:
        tree, evading = _tree_of(problem, bound)
        is_over, chosen = False, None
        while not is_over and chosen is None and tree.nodes < _STEP:
            is_over, chosen = tree.run(_SLICE)
        if not is_over:
            return bound
        bound = min(price for price in (tree.beyond, evading, most) if price is not None)
    return bound
