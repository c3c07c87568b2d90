r"""The master problem: the cheapest actions that meet every demand known so far.

Over ``x_a`` (action a is chosen), ``y_u`` (the unit u is met) and for every side S known so far ``w_S`` (its worth, in
0..s) and ``f_S`` (all its units are met), with h_u the in-neighbours that count for u in the network before mending::

    minimise    sum of c_a x_a
    (enough_u - h_u) y_u <= sum of x_a over the actions that bring an arc into the node of u from its outside
    f_S <= y_u  (u of S),   w_S <= sum of y_u over S + s f_S
    w_S + w_T >= s   (or a node outside M hears more than f of M)              every pair (S, T) of a violation
    sum of x_a over the actions that bring an arc into i <= most_i             every capped i
    sum of c_a x_a <= budget                                                   if there is one
    x_a = 1                                                                    required a
    w_U >= s z,   sum of x_a over the actions outside a cover >= lacking (1 - z)   every start U and cover

For s = 1 the worth is 0 or 1, and one more inequality helps the relaxation: some unit of a side of worth 1 is met in
full, so ``sum over u, a of (L / m_u) x_a >= L w_S`` for a common multiple L of what the units miss. Of sides that are
disjoint in pairs all but one are worth something: the solver finds this by itself, because sides are shared by pairs.

The last rows are those of :mod:`robustness.mending.covers`: ``z``, one for each condition with r = 2,
says that no two linked nodes take everything in.

Every choice that reaches the goal fulfils all of this, whichever pairs are known; so the minimum is a lower bound on
the cost. Where all links are alike (:attr:`~robustness.mending.actions.Actions.uniform`), nodes with equal neighbours
are interchangeable: some optimum gives the first of them the most links, and only such ones are looked at.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.limits import UNBOUNDED, Limits
from robustness.mending.actions import Actions
from robustness.mending.covers import Cover, lacking, lies_inside, price_outside, starts_of
from robustness.mending.demands import Side, Unit, masks_of, units, unlocalizers
from robustness.mending.goal import Part
from robustness.solver_calls import solve_within

__all__ = ["Master", "Proposal", "load_solver"]

#: Multiples beyond this are not worth an inequality.
_LARGEST_MULTIPLE = 5040


def load_solver() -> None:
    """Import the solver now, so that no limit is spent on it."""
    from ortools.sat.python import cp_model  # noqa: F401


class Proposal(NamedTuple):
    """What the solver said: a choice (indices; None without one), a proven lower bound, and whether it is optimal.

    ``bound`` is None when no choice can meet the demands, within what it may cost.
    """

    chosen: frozenset[int] | None
    bound: int | None
    is_optimal: bool


class Master:
    """The master problem, to which pairs of sides are added between solves."""

    def __init__(self, graph: Digraph, actions: Actions, limits: Limits = UNBOUNDED) -> None:
        from ortools.sat.python import cp_model

        self._limits = limits
        self._model = cp_model.CpModel()
        self._actions = actions
        self._n = graph.n
        self._heard = masks_of(graph)
        self._x = [self._model.new_bool_var("") for _ in actions.items]
        self._units: dict[Unit, Any] = {}
        self._sides: dict[Side, Any] = {}
        self._freed: dict[Side, Any] = {}
        self._slow: dict[Part, Any] = {}
        #: What it costs at least that a variable of ``_slow`` is 0; None: it cannot be.
        self._prices: list[tuple[Any, int | None]] = []
        self._into: dict[int, list[tuple[int, int]]] = defaultdict(list)
        for a, item in enumerate(actions.items):
            for tail, head in item.arcs:
                self._into[head].append((tail, a))
        for a in actions.required:
            self._model.add(self._x[a] == 1)
        if actions.most is not None:
            for i, most in enumerate(actions.most):
                self._model.add(sum(self._x[a] for _, a in self._into[i]) <= most)
        if actions.uniform:
            self._break_symmetry(graph)
        self._cost = sum(item.cost * x for item, x in zip(actions.items, self._x, strict=True))
        self._dearest = sum(item.cost for item in actions.items)
        if actions.budget is not None:
            self._dearest = min(self._dearest, actions.budget)
        #: The row of what a choice may cost, which every call sets anew.
        self._ceiling = self._model.add(self._cost <= self._dearest) if actions.items else None

    def add(self, first: Side, second: Side) -> None:
        """Add one demand: two sides that fit."""
        s = first.part.s
        worths = [self._worth(side) for side in (first, second)]
        freed = self._unlocalized(first)
        if s == 1:
            self._model.add_bool_or([*worths, *([] if freed is None else [freed])])
        elif freed is None:
            self._model.add(sum(worths) >= s)
        else:
            self._model.add(sum(worths) + s * freed >= s)

    def add_cover(self, part: Part, cover: Cover) -> None:
        """Add the demand of the lemma on spreading: so many links outside the cover, or every start is worth s."""
        if part not in self._slow:
            self._slow[part] = self._model.new_bool_var("")
            for U in starts_of(self._heard):
                self._model.add(self._worth(Side(part, 0, U)) >= part.s * self._slow[part])
        items = self._actions.items
        outer = [x for item, x in zip(items, self._x, strict=True) if not lies_inside(item.ends, cover)]
        missing = lacking(cover, self._n, part.r)
        self._model.add(sum(outer) >= missing * (1 - self._slow[part]))
        self._prices.append((self._slow[part], price_outside(cover, self._n, part.r, items)))

    def solve(
        self,
        limits: Limits,
        hint: frozenset[int] | None,
        effort: float | None = None,
        *,
        within: int | None = None,
        any_choice: bool = False,
    ) -> Proposal:
        """Return the cheapest choice, as far as the limits, and the solver's units of effort, allow.

        ``within``: it may cost so much. ``any_choice``: any that meets the demands will do; nothing is said about the
        bound unless there is none.
        """
        self._model.clear_hints()  # type: ignore[no-untyped-call]
        self._model.clear_objective()  # type: ignore[no-untyped-call]
        most = self._dearest if within is None else min(within, self._dearest)
        if self._ceiling is not None:
            self._ceiling.proto.linear.domain[1] = most
        for slow, _ in self._prices:
            slow.proto.domain[0] = 0
        for slow, least in self._prices:
            if least is None or least > most:
                slow.proto.domain[0] = 1
        if not any_choice:
            self._model.minimize(self._cost)
        if hint is not None:
            for a, x in enumerate(self._x):
                self._model.add_hint(x, a in hint)
        outcome = solve_within(self._model, limits, effort, relaxed=not any_choice)
        if outcome.is_infeasible:
            return Proposal(None, None, is_optimal=False)
        bound = 0 if any_choice else math.ceil(max(0, outcome.bound) - 1e-6)
        if not outcome.has_solution:
            return Proposal(None, bound, is_optimal=False)
        chosen = frozenset(a for a, x in enumerate(self._x) if outcome.value(x))
        if outcome.is_optimal and not any_choice:
            return Proposal(chosen, sum(self._actions.items[a].cost for a in chosen), is_optimal=True)
        return Proposal(chosen, bound, is_optimal=False)

    def _suppliers(self, unit: Unit) -> list[int]:
        return [a for tail, a in self._into[unit.node] if unit.outside >> tail & 1]

    def _missing(self, unit: Unit) -> int:
        return unit.enough - (self._heard[unit.node] & unit.outside).bit_count()

    def _met(self, unit: Unit) -> Any:
        """Return the variable that the unit is met; 1 when it is met without any action."""
        if unit not in self._units:
            if self._limits.expired():
                raise Undecided("the limit came while the master problem was written")
            missing, suppliers = self._missing(unit), self._suppliers(unit)
            met = self._model.new_bool_var("")
            if missing <= 0:
                self._model.add(met == 1)
            elif len(suppliers) < missing:
                self._model.add(met == 0)
            else:
                self._model.add(sum(self._x[a] for a in suppliers) >= missing).only_enforce_if(met)
            self._units[unit] = met
        return self._units[unit]

    def _worth(self, side: Side) -> Any:
        if side not in self._sides:
            members = list(units(side, self._n))
            met, s = [self._met(unit) for unit in members], side.part.s
            if s == 1:
                worth = self._model.new_bool_var("")
                self._model.add_bool_or([*met, worth.negated()])
                self._relax(members, worth)
            else:
                worth, full = self._model.new_int_var(0, s, ""), self._model.new_bool_var("")
                if len(met) < s:
                    for each in met:
                        self._model.add_implication(full, each)
                    self._model.add(worth <= sum(met) + s * full)
                else:
                    self._model.add(worth <= sum(met))
            self._sides[side] = worth
        return self._sides[side]

    def _relax(self, members: Sequence[Unit], worth: Any) -> None:
        missing = {unit: self._missing(unit) for unit in members}
        supplied = [unit for unit in members if len(self._suppliers(unit)) >= missing[unit]]
        if any(each <= 0 for each in missing.values()) or not supplied:
            return
        multiple = math.lcm(*(missing[unit] for unit in supplied))
        if multiple <= _LARGEST_MULTIPLE:
            weights: dict[int, int] = defaultdict(int)
            for unit in supplied:
                for a in self._suppliers(unit):
                    weights[a] += multiple // missing[unit]
            self._model.add(sum(weight * self._x[a] for a, weight in sorted(weights.items())) >= multiple * worth)

    def _unlocalized(self, side: Side) -> Any:
        """Return the variable that M is no f-local set any more; None where the bound is in all."""
        if side.part.trap is None or not side.part.trap.local:
            return None
        key = Side(side.part, side.M, 0)
        if key not in self._freed:
            freed = self._model.new_bool_var("")
            self._model.add_bool_or([*(self._met(unit) for unit in unlocalizers(side, self._n)), freed.negated()])
            self._freed[key] = freed
        return self._freed[key]

    def _break_symmetry(self, graph: Digraph) -> None:
        for alike in _twins(graph):
            for u, v in pairwise(alike):
                gains = [sum(self._x[a] for _, a in self._into[i]) for i in (u, v)]
                self._model.add(gains[0] >= gains[1])


def _twins(graph: Digraph) -> list[Sequence[int]]:
    """Return groups of nodes any two of which can be swapped without changing the network: equal neighbours."""
    heard = masks_of(graph)
    speaks = [0] * graph.n
    for tail, head in graph.arcs():
        speaks[tail] |= 1 << head
    groups: list[Sequence[int]] = []
    for closed in (0, 1):
        found: dict[tuple[int, int], list[int]] = defaultdict(list)
        for i in range(graph.n):
            found[heard[i] | closed << i, speaks[i] | closed << i].append(i)
        groups += [group for group in found.values() if len(group) > 1]
    return groups
