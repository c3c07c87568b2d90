"""A constraint model whose unknowns are the arcs of a graph on n nodes, for CP-SAT.

*There is* a violating pair, a trap, a separator, a node: such demands are written down at once, with 0/1 variables
that say which nodes play which role. *For all* pairs, traps or separators: such demands become one constraint for
each pair, added when a candidate graph has shown that it is needed (see :mod:`robustness.graph_search.synthesis`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.evidence import Pair
from robustness.graph_search.properties import Connected, Edges, HasTrap, InDegree, Property, RSRobust

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

__all__ = ["GraphModel"]


class GraphModel:
    """The graphs on n nodes that meet some demands, as a CP-SAT model.

    Parameters
    ----------
    n : int
        The number of nodes, at least 2.
    directed : bool
        Undirected: one variable serves both arcs of an edge.
    symmetry_breaking : bool
        Whether to fix one labelling per graph as far as that is easy. Every demand is about unlabelled graphs, so
        the nodes may be numbered by their role in the first *there is* demand, or else by in-degree.
    """

    def __init__(self, n: int, *, directed: bool, symmetry_breaking: bool = True) -> None:
        from ortools.sat.python import cp_model

        self.n, self.directed = n, directed
        self.model = cp_model.CpModel()
        self.edges = {
            (u, v): self.model.new_bool_var(f"a{u},{v}")
            for u in range(n)
            for v in range(n)
            if (u != v if directed else u < v)
        }
        self._reached: dict[tuple[int, int, int], Any] = {}
        self._may_order = symmetry_breaking

    def arc(self, u: int, v: int) -> Any:
        """Return the variable of the arc (u, v)."""
        return self.edges[(u, v) if self.directed or u < v else (v, u)]

    def in_degree(self, v: int) -> Any:
        """Return the in-degree of v as an expression."""
        return sum(self.arc(u, v) for u in range(self.n) if u != v)

    def edge_count(self) -> Any:
        """Return the number of edges (arcs, for a digraph) as an expression."""
        return sum(self.edges.values())

    def demand(self, satisfies: Sequence[Property], violates: Sequence[Property]) -> None:
        """Add all that can be written down at once, and the implied bounds that help a solver."""
        for wanted in satisfies:
            self._demand(wanted)
        for unwanted in violates:
            self._demand_not(unwanted)
        if self._may_order:
            for v in range(self.n - 1):
                self.model.add(self.in_degree(v) >= self.in_degree(v + 1))

    def _demand(self, wanted: Property) -> None:
        match wanted:
            case RSRobust(r, s):
                self._imply_by_robustness(r, s)
            case Connected(k):
                if k >= max(self.n, 1):
                    self._never()
                for v in range(self.n):
                    self.model.add(self.in_degree(v) >= k)
            case HasTrap(f):
                self._exists_pair(most=f, exempt=0, removed=f)
            case InDegree(least, most):
                for v in range(self.n):
                    self.model.add(self.in_degree(v) >= least)
                    if most is not None:
                        self.model.add(self.in_degree(v) <= most)
            case Edges(least, most):
                self.model.add(self.edge_count() >= least)
                if most is not None:
                    self.model.add(self.edge_count() <= most)
            case _:
                raise InvalidParameter(
                    f"beyond the listed graphs a property is one of the built-in ones, not {wanted!r}"
                )

    def _imply_by_robustness(self, r: int, s: int) -> None:
        """Add bounds that every (r,s)-robust graph meets; the definition itself is learnt pair by pair."""
        if r > largest_conceivable_r(self.n) or s > self.n:
            self._never()
        # r* <= max(1, least in-degree); a 1-robust graph has a node that reaches all, so n - 1 arcs.
        for v in range(self.n if r >= 2 else 0):
            self.model.add(self.in_degree(v) >= r)
        if r >= 1:
            self.model.add(self.edge_count() >= self.n - 1)

    def _demand_not(self, unwanted: Property) -> None:
        match unwanted:
            case RSRobust(r, s):
                if r == 0 and s <= self.n:
                    self._never()
                elif r <= largest_conceivable_r(self.n) and s <= self.n:
                    self._exists_pair(most=r - 1, exempt=s - 1, removed=0)
            case Connected(k):
                if k == 0:
                    self._never()
                elif k < self.n:
                    self._exists_separator(k - 1)
            case HasTrap():
                pass  # a "for all": see forbid_trap
            case InDegree(least, most):
                odd = [self.model.new_bool_var("") for _ in range(2 * self.n)]
                for v in range(self.n):
                    self.model.add(self.in_degree(v) <= least - 1).only_enforce_if(odd[v])
                    if most is None:
                        self.model.add(odd[self.n + v] == 0)
                    else:
                        self.model.add(self.in_degree(v) >= most + 1).only_enforce_if(odd[self.n + v])
                self.model.add_bool_or(odd)
            case Edges(least, most):
                few, many = self.model.new_bool_var(""), self.model.new_bool_var("")
                self.model.add(self.edge_count() <= least - 1).only_enforce_if(few)
                self.model.add(self.edge_count() >= (len(self.edges) if most is None else most) + 1).only_enforce_if(
                    many
                )
                self.model.add_bool_or(few, many)
            case _:
                raise InvalidParameter(
                    f"beyond the listed graphs a property is one of the built-in ones, not {unwanted!r}"
                )

    def _never(self) -> None:
        self.model.add_bool_or([])

    def _exists_pair(self, *, most: int, exempt: int, removed: int) -> None:
        """Demand disjoint nonempty sets S1 and S2, and a set M outside both, with few outside links.

        M has at most ``removed`` nodes. Each node of a side hears at most ``most`` nodes outside the side and M, except
        for at most ``exempt`` nodes in all, and not a whole side.
        (r - 1, s - 1, 0) is a violation of (r,s)-robustness; (f, 0, f) is a trap for f.
        """
        m, first, second, rest = roles = [[self.model.new_bool_var("") for _ in range(self.n)] for _ in range(4)]
        for i in range(self.n):
            self.model.add_exactly_one(role[i] for role in roles)
        self.model.add(sum(m) <= removed)
        self.model.add(sum(first) <= sum(second))  # the two sides may be swapped
        free: list[Any] = []
        for side in (first, second):
            bound = [self.model.new_bool_var("") for _ in range(self.n)]
            for i in range(self.n):
                self.model.add_implication(bound[i], side[i])
                heard = [self._heard(j, i, side[j], m[j]) for j in range(self.n) if j != i]
                self.model.add(sum(heard) <= most).only_enforce_if(bound[i])
            self.model.add_bool_or(bound)
            free += [in_side - is_bound for in_side, is_bound in zip(side, bound, strict=True)]
        self.model.add(sum(free) <= exempt)
        self._order_by([m, first, second, rest])

    def _heard(self, j: int, i: int, *silenced: Any) -> Any:
        """Return a variable that is 1 when i hears j and j plays none of the roles ``silenced``."""
        heard = self.model.new_bool_var("")
        self.model.add_bool_or([heard, self.arc(j, i).negated(), *silenced])
        return heard

    def _exists_separator(self, size: int) -> None:
        """Demand a set of at most ``size`` nodes without which some nodes hear nothing from some others."""
        separator, sources, sinks = roles = [[self.model.new_bool_var("") for _ in range(self.n)] for _ in range(3)]
        for i in range(self.n):
            self.model.add_exactly_one(role[i] for role in roles)
        self.model.add(sum(separator) <= size)
        self.model.add_bool_or(sources)
        self.model.add_bool_or(sinks)
        for u in range(self.n):
            for v in range(self.n):
                if u != v:
                    self.model.add_bool_or([self.arc(u, v).negated(), sources[u].negated(), sinks[v].negated()])
        self._order_by(roles)

    def _order_by(self, roles: Sequence[Sequence[Any]]) -> None:
        """Number the nodes by role; only one demand may do so."""
        if self._may_order:
            place = [sum(code * role[i] for code, role in enumerate(roles)) for i in range(self.n)]
            for i in range(self.n - 1):
                self.model.add(place[i] <= place[i + 1])
            self._may_order = False

    def forbid_pair(self, pair: Pair, r: int, s: int) -> None:
        """Demand that ``pair`` does not violate (r,s)-robustness: the three conditions of the definition."""
        sides = [[self._reach(side, i, r) for i in sorted(side)] for side in pair]
        if s == 1:
            self.model.add_bool_or([*sides[0], *sides[1]])
            return
        enough = self.model.new_bool_var("")
        self.model.add(sum(sides[0]) + sum(sides[1]) >= s).only_enforce_if(enough)
        chosen = [enough]
        for side in sides:
            everyone = self.model.new_bool_var("")
            for reached in side:
                self.model.add_implication(everyone, reached)
            chosen.append(everyone)
        self.model.add_bool_or(chosen)

    def forbid_trap(self, pair: Pair, removed: Iterable[int], f: int) -> None:
        """Demand that ``pair`` with M = ``removed`` is no trap for f."""
        silent = frozenset(removed)
        self.model.add_bool_or([self._reach(side | silent, i, f + 1) for side in pair for i in sorted(side)])

    def forbid_separator(self, sources: Iterable[int], sinks: Iterable[int]) -> None:
        """Demand an arc from ``sources`` to ``sinks``."""
        targets = list(sinks)
        self.model.add_bool_or([self.arc(u, v) for u in sources for v in targets])

    def _reach(self, members: frozenset[int], i: int, r: int) -> Any:
        """Return a variable that is 1 only when i has at least r in-neighbours outside ``members``."""
        key = (sum(1 << j for j in members), i, r)
        if key not in self._reached:
            reached = self.model.new_bool_var("")
            outside = [self.arc(j, i) for j in range(self.n) if j not in members and j != i]
            self.model.add(sum(outside) >= r).only_enforce_if(reached)
            self._reached[key] = reached
        return self._reached[key]

    def candidate(self, solver: cp_model.CpSolver) -> Digraph:
        """Return the graph of the solver's solution."""
        arcs = [arc for arc, variable in self.edges.items() if solver.boolean_value(variable)]
        if not self.directed:
            arcs += [(v, u) for u, v in arcs]
        return Digraph(range(self.n), arcs, directed=self.directed)
