"""The search: a master problem over the demands known so far, and the exact oracle that finds the ones left open.

An implicit hitting set (Moreno-Centeno and Karp 2013). Each round the master proposes the cheapest choice; violations
that it leaves open are found, by growing sides and then exactly; a repair breaks them one after the other until the
network reaches the goal, and gives up what is superfluous. Every violation met on the way becomes a demand: it is open
under the proposal, since the proposal lies inside the repaired choice. The proposal's cost is a lower bound, the
repaired choice an upper one; both improve until they meet. Once a choice is known, the master is mostly asked for any
choice that costs less and meets all demands: that is quicker than to minimise, its violations are harder to evade, and
when there is none, the best is optimal. Between rounds the best is taken apart a little and repaired in another way,
and a tree search (:mod:`robustness.mending.deepening`) goes on that raises the bound step by step.
"""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from robustness.digraph import Digraph
from robustness.errors import InternalError, Undecided
from robustness.limits import Limits, Progress
from robustness.mending.actions import Actions, with_actions
from robustness.mending.construction import grown_choices
from robustness.mending.covers import Cover, lacking, rigid_components, starts_of
from robustness.mending.deepening import Deepening
from robustness.mending.demands import (
    Side,
    Unit,
    bits,
    fit,
    holds_apart,
    masks_of,
    sides_of,
    units,
    unlocalizers,
    worth,
)
from robustness.mending.goal import Part
from robustness.mending.growing import every_pair, grown_sides, lonely_nodes, shrunk
from robustness.mending.master import Master, Proposal
from robustness.mending.oracle import first_violation
from robustness.traps.question import Sets

__all__ = ["Search"]

#: How many orders of giving up superfluous links are tried in a round; one when there are more links than so many.
_ORDERS, _MANY = 3, 40

#: Pairs of grown sides are added all together up to so many, beyond that only those that a proposal leaves open.
_MOST_PAIRS = 300

#: Then a new side is paired with so many others, the smallest.
_MOST_PARTNERS = 8

#: The solver's units of effort for the first bound, about a second, and for a call in the first round; in the rounds it
#: grows by a factor whenever a call did not finish.
_FIRST_EFFORT, _EFFORT, _GROWTH, _GROWTH_ON_FEW = 1.0, 4.0, 1.3, 1.5

#: A proposal is repaired in so many ways, divided by the square of the number of nodes, and in one at least.
_REPAIRED = 2000

#: Of so many proposals one is a cheapest choice, which takes longest to find.
_SELDOM = 3

#: At most so many links of the best choice are taken away at once, to be replaced by others.
_MOST_SHAKEN = 4

#: On so few nodes every violation of (r,s)-robustness is a demand from the start: faster than to solve again and again.
_FEW = 8

Pair = tuple[Side, Side]


@dataclass(slots=True)
class Search:
    """One question, its demands, the best choice so far and the proven lower bound.

    Attributes
    ----------
    any_choice : bool
        End with the first choice that reaches the goal, within the budget.
    best : frozenset of int or None
        A choice that was checked to reach the goal.
    bound : int
        No choice that reaches the goal costs less.
    witness : (Part, Sets) or None
        What no choice can break; then the goal is out of reach.
    rows : list of pairs of sides
        The demands that the master problem holds.
    covers : list of (Part, starts, Cover)
        The covers behind its other rows, and those behind the demands of the tree search
        (:mod:`robustness.mending.covers`).
    is_up_to_swapping : bool
        Whether the bound follows from the demands and their images under swaps of nodes, not from them alone.
    """

    graph: Digraph
    actions: Actions
    parts: Sequence[Part]
    limits: Limits
    on_improvement: Callable[[Search], None] | None = None
    any_choice: bool = False
    best: frozenset[int] | None = None
    bound: int = 0
    witness: tuple[Part, Sets] | None = None
    is_impossible: bool = False
    reason: str = ""
    rows: list[Pair] = field(default_factory=list)
    covers: list[tuple[Part, tuple[int, ...], Cover]] = field(default_factory=list)
    base: list[int] = field(default_factory=list)
    is_up_to_swapping: bool = False
    _seen: set[Pair] = field(default_factory=set)
    _pool: dict[tuple[Part, int], dict[int, Side]] = field(default_factory=dict)
    _master: Master | None = None
    _effort: float = _EFFORT
    _deepening: Deepening | None = None
    _into: dict[int, list[tuple[int, int]]] = field(default_factory=lambda: defaultdict(list))

    def cost(self, chosen: Iterable[int]) -> int:
        """Return the cost of a choice, in units of the scale."""
        return sum(self.actions.items[a].cost for a in chosen)

    @property
    def is_optimal(self) -> bool:
        """Whether the best choice is proven to be cheapest."""
        return self.best is not None and self.cost(self.best) <= self.bound

    @property
    def is_done(self) -> bool:
        """Whether there is nothing more to find out."""
        return self.is_optimal or self.is_impossible or (self.any_choice and self.best is not None)

    def run(self) -> None:
        """Search until the bounds meet, the goal is proven to be out of reach, or a limit comes."""
        self.base = masks_of(self.graph)
        for a, item in enumerate(self.actions.items):
            for tail, head in item.arcs:
                self._into[head].append((tail, a))
        everything = frozenset(range(len(self.actions.items)))
        try:
            self.witness = first_violation(with_actions(self.graph, self.actions, everything), self.parts, self.limits)
            self.is_impossible = self.witness is not None
            if self.is_impossible:
                return
            self.improve(everything)
            self._start()
            turn = 1
            while not self.is_done:
                self._round(turn)
                turn += 1
        except Undecided:
            self.reason = "the time limit was reached"

    def _start(self) -> None:
        """Find a first choice, write the first demands, and find the first bound and better choices."""
        if self._keeps_caps(self.actions.required) and self._is_enough(self.actions.required, self.limits.share(0.5)):
            self.bound = self.cost(self.actions.required)
            self.improve(self.actions.required)
            if self.best is None:  # they cost more than the budget
                self.rule_out()
            return
        grown = sorted(grown_choices(self.base, self.parts, self.actions), key=self.cost)
        for chosen in grown:
            if (self.best is None or self.cost(chosen) < self.cost(self.best)) and self._is_enough(chosen, self.limits):
                self.improve(chosen)
        if self.is_done:
            return
        self._master = Master(self.graph, self.actions, self.limits)
        self._deepening = Deepening.of(self)
        for part in self.parts:
            pairs, arcs = lonely_nodes(self.base, part)
            for pair in pairs:
                self.learn(*pair)
            self.raise_bound(-(-arcs // (1 if self.actions.one_way else 2)) * self.actions.cheapest)
        self._spread(self.base)
        self._grow(self.base)
        for part in self.parts:
            if part.trap is None and self.graph.n <= _FEW:
                for pair in every_pair(self.base, part):
                    self.learn(*pair)
        # A bound before the first repair, which can take long; counted, so that it is the same on every machine.
        self._believe(self._master.solve(self.limits.share(0.5), None, _FIRST_EFFORT))
        self._tell()
        self._deepen()
        if not self.is_done:
            self.improve(self._repair(grown[0] if grown else self.actions.required, 0))

    def _deepen(self) -> None:
        if self._deepening is not None and not self.is_done:
            self._deepening.go_on()

    def _is_enough(self, chosen: Iterable[int], limits: Limits) -> bool:
        """Return whether a choice is found to reach the goal, by the exact search alone and within these limits."""
        try:
            return first_violation(with_actions(self.graph, self.actions, chosen), self.parts, limits) is None
        except Undecided:
            return False

    def _keeps_caps(self, chosen: Iterable[int]) -> bool:
        """Return whether no node gains more in-neighbours than it may."""
        gains = Counter(head for a in chosen for _, head in self.actions.items[a].arcs)
        return all(gains[i] <= cap for i, cap in enumerate(self.actions.most or ()))

    def _round(self, turn: int) -> None:
        """Propose, and repair; raise :class:`Undecided` when a limit came."""
        if self._master is None:
            raise InternalError("a round without a master problem: please report")
        is_few = self.graph.n <= _FEW  # then all demands are there, and the two ways to ask race each other
        is_one_off = self.best is not None and self.cost(self.best) == self.bound + 1
        any_choice = self.best is not None and (turn % 2 == 1 if is_few else turn % _SELDOM != 1 or is_one_off)
        within = None if self.best is None else self.cost(self.best) - 1
        proposal = self._master.solve(
            self.limits.share(0.7), self.best, self._effort, within=within, any_choice=any_choice
        )
        self._believe(proposal)
        if proposal.chosen is None:
            self._effort *= _GROWTH_ON_FEW if is_few else _GROWTH
        if proposal.chosen is not None and not self.is_done:
            known = len(self.rows), len(self.covers)
            heard = self.heard(proposal.chosen)
            self._spread(heard)
            self._grow(heard)
            for again in range(1 + _REPAIRED // self.graph.n**2):
                self.improve(self._repair(proposal.chosen, turn, again))
                if (len(self.rows), len(self.covers)) == known:  # it reaches the goal itself
                    break
            if (len(self.rows), len(self.covers)) == known and proposal.is_optimal:
                self.bound = max(self.bound, self.cost(proposal.chosen))
        if not self.is_done and self.best is not None:
            self.improve(self._shaken(self.best, turn))
        self._deepen()
        if not self.is_done and self.limits.expired():
            raise Undecided("the limit came before the bounds met")

    def _believe(self, proposal: Proposal) -> None:
        """Take in what a call of the solver says about the bound."""
        if proposal.bound is None and self.best is None:
            self.rule_out()
            return
        self.raise_bound(self.cost(self.best or ()) if proposal.bound is None else proposal.bound)

    def raise_bound(self, proven: int) -> None:
        """No choice that reaches the goal costs less than this."""
        if proven > self.bound:
            self.bound, self.is_up_to_swapping = proven, False
            self._tell()

    def _shaken(self, chosen: frozenset[int], turn: int) -> frozenset[int] | None:
        """Return another choice that reaches the goal: some links are taken away, and what is open repaired."""
        rng = random.Random(f"{self.limits.seed} {turn} shaken")
        movable = sorted(chosen - self.actions.required)
        gone = rng.sample(movable, min(len(movable), rng.randint(2, _MOST_SHAKEN)))
        return self._repair(chosen.difference(gone), turn)

    def rule_out(self) -> None:
        """No choice meets the demands; with a budget, none within it: then it is a bound on the cost."""
        self.is_impossible = True
        if self.actions.budget is not None:
            self.bound = max(self.bound, self.actions.budget + 1)

    def _in_time(self) -> None:
        if self.limits.expired():
            raise Undecided("the limit came while demands were gathered")

    def _tell(self) -> None:
        if self.limits.progress is not None:
            best = "none yet" if self.best is None else f"{self.actions.price(self.cost(self.best))}"
            note = f"demands, best {best}, at least {self.actions.price(self.bound)}"
            self.limits.progress(Progress(len(self.rows), note))
        if self.on_improvement is not None:
            self.on_improvement(self)

    def improve(self, chosen: frozenset[int] | None) -> None:
        """Take in a choice that reaches the goal, where it is better and allowed."""
        budget = self.actions.budget
        if chosen is None or (budget is not None and self.cost(chosen) > budget) or not self._keeps_caps(chosen):
            return
        if self.best is None or self.cost(chosen) < self.cost(self.best):
            self.best = chosen
            self._tell()

    def _grow(self, heard: Sequence[int]) -> None:
        """Take sides grown in a network into the pool, and pairs of them into the master problem."""
        for part in self.parts:
            known = {M for other, M in self._pool if other == part} | ({0} if part.trap is None else set())
            for M in sorted(known):
                for side in grown_sides(heard, part, M, self._in_time):
                    self._take(side, heard)

    def _spread(self, heard: Sequence[int]) -> None:
        """Take the best cover of a network into the master problem, for conditions with r = 2."""
        for part in self.parts:
            if part.trap is None and part.r == 2 and self._master is not None:
                cover = rigid_components(heard)
                self._in_time()
                row = part, tuple(starts_of(self.base)), cover
                if lacking(cover, len(heard), part.r) > 0 and row not in self.covers:
                    self.covers.append(row)
                    self._master.add_cover(part, cover)

    def _take(self, side: Side, heard: Sequence[int]) -> None:
        """Add a side to the pool; pair it with all others there that fit."""
        group = self._pool.setdefault((side.part, side.M), {})
        if side.S in group:
            return
        partners = 0
        for other in sorted(group.values(), key=lambda each: (each.S.bit_count(), each.S)):
            is_early = len(self.rows) < _MOST_PAIRS
            if not is_early and (partners == _MOST_PARTNERS or not holds_apart(side, other, heard)):
                continue
            if fit(side, other):
                self.learn(side, other)
                self._in_time()
                partners += 1
        group[side.S] = side

    def learn(self, first: Side, second: Side) -> None:
        """Take a pair into the demands, unless it is known or met before mending."""
        pair = (first, second) if first.S < second.S else (second, first)
        if pair not in self._seen and self._master is not None and holds_apart(*pair, self.base):
            self._seen.add(pair)
            self.rows.append(pair)
            self._master.add(*pair)

    def sides(self, part: Part) -> list[Side]:
        """Return all sides of a part that were met, with no malicious set."""
        return list(self._pool.get((part, 0), {}).values())

    def heard(self, chosen: Iterable[int]) -> list[int]:
        """Return the in-neighbour masks of the network with a choice."""
        heard = list(self.base)
        for a in chosen:
            for tail, head in self.actions.items[a].arcs:
                heard[head] |= 1 << tail
        return heard

    def _repair(self, proposal: frozenset[int], turn: int, again: int = 0) -> frozenset[int] | None:
        """Break what the proposal leaves open; return a choice that reaches the goal, or None when caps forbid it."""
        chosen = set(proposal)
        rng = random.Random(f"{self.limits.seed} {turn} {again}")
        while True:
            pair = self.open_pair(chosen)
            if pair is None:
                self.improve(frozenset(chosen))
                return self._reduced(frozenset(chosen), rng)
            if not self._break(pair, chosen, rng):
                return None

    def open_pair(self, chosen: Iterable[int], *, thorough: bool = True) -> Pair | None:
        """Return a demand that the choice does not meet: a known one, else the oracle's; None when all are met.

        ``thorough``: what the oracle finds is followed by all that grows in this network.
        """
        if self.limits.expired():
            raise Undecided("the limit came during a repair")
        heard = self.heard(chosen)
        for pair in self.rows:
            if holds_apart(*pair, heard):
                return pair
        found = first_violation(with_actions(self.graph, self.actions, chosen), self.parts, self.limits)
        if found is None:
            return None
        first, second = shrunk(*sides_of(*found), heard)
        for side in (first, second):
            self._take(side, heard)
        self.learn(first, second)
        if thorough:
            self._grow(heard)
        return first, second

    def _break(self, pair: Pair, chosen: set[int], rng: random.Random) -> bool:
        """Add the cheapest actions that meet one more unit of the pair; return whether there are any."""
        heard = self.heard(chosen)
        gains = self._gains(heard)
        options: list[tuple[float, float, list[int]]] = []
        n = len(heard)
        for unit in (*units(pair[0], n), *units(pair[1], n), *unlocalizers(pair[0], n)):
            missing = unit.enough - (heard[unit.node] & unit.outside).bit_count()
            if missing <= 0:
                continue
            supplies = [a for a in self._suppliers(unit) if a not in chosen and self._is_free(a, heard)]
            if min(len(supplies), self._room(unit.node, heard)) >= missing:
                supplies.sort(key=lambda a: (self.actions.items[a].cost - gains.get(a, 0.0), rng.random()))
                taken = supplies[:missing]
                price = sum(self.actions.items[a].cost - gains.get(a, 0.0) for a in taken)
                options.append((price, rng.random(), taken))
        if not options:
            return False
        chosen.update(min(options)[2])
        return True

    def _suppliers(self, unit: Unit) -> list[int]:
        return [a for tail, a in self._into[unit.node] if unit.outside >> tail & 1]

    def _gains(self, heard: Sequence[int]) -> dict[int, float]:
        """Return for every action how much it helps with all open demands, at most nine tenths of its cost."""
        wanted: dict[tuple[int, int], float] = {}
        n = len(heard)
        sides = {side for pair in self.rows if holds_apart(*pair, heard) for side in pair}
        for side in sides:
            if worth(side, heard):
                continue
            members = list(units(side, n))
            for unit in members:
                missing = unit.enough - (heard[unit.node] & unit.outside).bit_count()
                for tail in bits(unit.outside & ~heard[unit.node]):
                    place = (tail, unit.node)
                    wanted[place] = wanted.get(place, 0.0) + 1.0 / (missing * missing * len(members))
        most = max(wanted.values(), default=1.0)
        return {
            a: 0.9 * item.cost * sum(wanted.get(arc, 0.0) for arc in item.arcs) / (len(item.arcs) * most)
            for a, item in enumerate(self.actions.items)
        }

    def _room(self, node: int, heard: Sequence[int]) -> int:
        """Return how many further in-neighbours a node may gain."""
        most = self.actions.most
        return len(heard) if most is None else most[node] - (heard[node] & ~self.base[node]).bit_count()

    def _is_free(self, action: int, heard: Sequence[int]) -> bool:
        return all(self._room(head, heard) > 0 for _, head in self.actions.items[action].arcs)

    def _reduced(self, chosen: frozenset[int], rng: random.Random) -> frozenset[int]:
        """Return the choice without what is superfluous: no single action can go. Several orders are tried."""
        best: frozenset[int] | None = None
        for turn in range(_ORDERS if len(chosen) <= _MANY else 1):
            kept = set(chosen)
            order = sorted(kept - self.actions.required)
            rng.shuffle(order)
            if turn % 2 == 0:
                order.sort(key=lambda a: -self.actions.items[a].cost)
            for a in order:
                kept.discard(a)
                if self.open_pair(kept, thorough=False) is None:
                    self.improve(frozenset(kept))
                else:
                    kept.add(a)
            if best is None or self.cost(kept) < self.cost(best):
                best = frozenset(kept)
        return chosen if best is None else best
