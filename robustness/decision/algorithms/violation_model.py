r"""A violating pair as an integer programme: one model in OR-tools' MathOpt, for ``milp`` and ``cp-sat``.

Let ``d_i = |N_i|`` and ``k_i = max(0, d_i - r + 1)``, the in-neighbours that i needs inside its own set if fewer than
r are to be outside. Every node is in one of five states, by four binary variables: a *satisfied* member of S1 (``a_i``)
or S2 (``b_i``), which must not be r-reachable; an *exempt* member (``e_i``, ``g_i``), which may be; or in neither::

    a_i + e_i + b_i + g_i <= 1                              every i
    sum of a_i >= 1,   sum of b_i >= 1
    sum over j in N_i of (a_j + e_j) >= k_i a_i             every i, and the same for S2 with b and g
    sum of (e_i + g_i) <= s - 1                             or minimised, for s_max(r)

The programme is feasible iff the digraph is not (r,s)-robust; the minimum is s_max(r), or n when it is infeasible.
Proof. For a violating pair let the exempt members be exactly ``X_S1`` and ``X_S2``. Every other member i has at most
r - 1 in-neighbours outside its set, so at least ``d_i - r + 1`` inside; since ``X_Sk != Sk`` both sides hold a member;
and ``|X_S1| + |X_S2| <= s - 1``. Conversely, let S1 be the nodes with ``a_i + e_i = 1`` and S2 those with
``b_i + g_i = 1``: disjoint and nonempty. A satisfied i has at most ``d_i - k_i <= r - 1`` in-neighbours outside
(``d_i <= r - 1`` when k_i = 0). So ``X_Sk`` holds exempt members only, never all of Sk, and
``|X_S1| + |X_S2| <= s - 1``.

``e_i`` and ``g_i`` are left out where k_i = 0 (such a node is never r-reachable) and for s = 1. ``k_i`` is the least
coefficient ("big M") with which a row says nothing when ``a_i = 0``. The symmetry of S1 and S2 is broken by one node
that is kept out of S2.

For r* itself, with one integer t in place of the exemptions (Usevitch and Panagou)::

    minimise t  subject to  t + sum over j in N_i of a_j >= d_i a_i  for every i, and the same with b

``d_i a_i - sum a_j`` is row i of the Laplacian times the indicator of S1: ``|N_i \ S1|`` for i in S1 and at most 0
elsewhere. So the least t is the least ``max |N_i \ S_k|`` over all pairs; and G is r-robust iff every pair has a node
with ``|N_i \ S_k| >= r``. Hence the minimum is r*.

Pair counting (ours; the switch ``pair_counting``). Let i be satisfied in S1 and j in S2. At least k_i nodes of
``N_i - j`` are in S1, at least k_j nodes of ``N_j - i`` in S2, and these are disjoint. A satisfied one among the former
must itself go with j, one among the latter with i, and at most s - 1 are exempt. Where that does not fit
(:func:`compatible_pairs`), ``a_i + b_j <= 1``. A node that goes with no other is never satisfied; if no two nodes go
together, the graph is (r,s)-robust without any search.

What is trusted. For a violating pair: nothing; it is rounded and re-checked. For ROBUST: the solver's claim that the
programme is infeasible. All data are small integers, so every violating pair satisfies the rows exactly, and
tolerances only enlarge the feasible set: they can lead to a false pair, which the re-check turns into UNDECIDED, but
not to a false ROBUST. CP-SAT reasons in integers; HiGHS and SCIP in floating point, without a proof to check.

Source: J. Usevitch and D. Panagou, "Determining r- and (r,s)-robustness of digraphs using mixed integer linear
programming", Automatica 111, 2020 (arXiv 1901.11000). Their (r,s) programme has a row with a large coefficient for
each node; making every member satisfied or exempt, with tight rows, is our variation. It decides 20-node questions with
s = 9 in about a second, where membership variables with exemptions on top took HiGHS over half a minute.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.evidence import Pair
from robustness.limits import Limits

if TYPE_CHECKING:
    from ortools.math_opt.python import mathopt

__all__ = ["ViolationModel", "all_pairs", "compatible_pairs", "largest_r_model", "pair_model"]


@dataclass(frozen=True, slots=True)
class ViolationModel:
    """A MathOpt model, and for either side the variables that put node i into it."""

    model: mathopt.Model
    first: Sequence[Sequence[mathopt.Variable]]
    second: Sequence[Sequence[mathopt.Variable]]

    def pair(self, values: dict[Any, float]) -> Pair:
        """Return the pair of a solution, rounded; nothing is promised about it."""
        first, second = (
            frozenset(i for i, states in enumerate(side) if any(values[state] > 0.5 for state in states))
            for side in (self.first, self.second)
        )
        return Pair(first, second)


def pair_model(graph: Digraph, r: int, s: int | None, compatible: Sequence[int]) -> ViolationModel:
    """Return the programme whose solutions are the violating pairs of (r,s)-robustness.

    Parameters
    ----------
    graph : Digraph
        Any digraph.
    r : int
        At least 1.
    s : int or None
        At least 1; None minimises ``|X_S1| + |X_S2|`` over all s.
    compatible : sequence of int
        ``compatible[i]``: mask of the nodes that may be satisfied in the other set when i is satisfied in one.
    """
    from ortools.math_opt.python import mathopt

    model = mathopt.Model()
    need = [max(0, degree - r + 1) for degree in graph.in_degrees.tolist()]
    satisfied = [[model.add_binary_variable() for _ in need] for _ in range(2)]
    exempt = [[[model.add_binary_variable()] if k and s != 1 else [] for k in need] for _ in range(2)]
    inside = [[[h, *x] for h, x in zip(*side, strict=True)] for side in zip(satisfied, exempt, strict=True)]
    _add_sides(model, inside, satisfied, graph)
    for side in range(2):
        for i, k in enumerate(need):
            if k:
                heard = [state for j in graph.in_neighbours(i).tolist() for state in inside[side][j]]
                model.add_linear_constraint(mathopt.fast_sum(heard) >= k * satisfied[side][i])
    exempted = mathopt.fast_sum([state for side in exempt for states in side for state in states])
    if s is None:
        model.minimize(exempted)
    elif s > 1:
        model.add_linear_constraint(exempted <= s - 1)
    for i, others in enumerate(compatible):
        if not others:
            satisfied[0][i].upper_bound = satisfied[1][i].upper_bound = 0
            continue
        for j, back in enumerate(compatible):
            if i != j and back and not others >> j & 1:
                model.add_linear_constraint(satisfied[0][i] + satisfied[1][j] <= 1)
    return ViolationModel(model, *inside)


def largest_r_model(graph: Digraph) -> ViolationModel:
    """Return the programme of Usevitch and Panagou whose minimum is r* (at least two nodes)."""
    from ortools.math_opt.python import mathopt

    model = mathopt.Model()
    members = [[model.add_binary_variable() for _ in range(graph.n)] for _ in range(2)]
    inside = [[[member] for member in side] for side in members]
    _add_sides(model, inside, members, graph)
    outside = model.add_integer_variable(lb=0, ub=largest_conceivable_r(graph.n))
    for side in members:
        for i, degree in enumerate(graph.in_degrees.tolist()):
            heard = [side[j] for j in graph.in_neighbours(i).tolist()]
            model.add_linear_constraint(outside + mathopt.fast_sum(heard) >= degree * side[i])
    model.minimize(outside)
    return ViolationModel(model, *inside)


def _add_sides(
    model: mathopt.Model,
    inside: Sequence[Sequence[Sequence[mathopt.Variable]]],
    satisfied: Sequence[Sequence[mathopt.Variable]],
    graph: Digraph,
) -> None:
    """Add the rows: every node in at most one set, both sets with a satisfied member, one node kept out of S2."""
    from ortools.math_opt.python import mathopt

    for one, two in zip(*inside, strict=True):
        model.add_linear_constraint(mathopt.fast_sum([*one, *two]) <= 1)
    for side in satisfied:
        model.add_linear_constraint(mathopt.fast_sum(side) >= 1)
    for state in inside[1][int(graph.in_degrees.argmax())]:
        state.upper_bound = 0


def all_pairs(n: int) -> list[int]:
    """Return the relation in which every node goes with every other: pair counting switched off."""
    return [((1 << n) - 1) ^ (1 << i) for i in range(n)]


def compatible_pairs(graph: Digraph, r: int, s: int, limits: Limits) -> list[int]:
    r"""Return for every node i the mask of the nodes j that may be satisfied in S2 while i is satisfied in S1.

    The relation is symmetric, and it shrinks to a fixpoint: with ``P = (N_i - j) & goes_with[j]`` and
    ``Q = (N_j - i) & goes_with[i]``, the pair i, j goes when, for some way to exempt s - 1 more nodes of ``N_i``
    and ``N_j``, k_i fit into P, k_j into Q and ``k_i + k_j`` into their union.

    Notes
    -----
    Every pair that is removed is in no violating pair of sets, by induction on the order of removal (module
    docstring). ``O(n^2)`` set operations per round; a handful of rounds in practice.

    Raises
    ------
    Undecided
        When the deadline passes.
    """
    hears, goes = graph.in_masks, all_pairs(graph.n)
    need = [max(0, mask.bit_count() - r + 1) for mask in hears]
    changed = True
    while changed:
        changed = False
        for i, k_i in enumerate(need):
            if limits.expired():
                raise Undecided("the time limit was reached: raise it")
            for j in range(i):
                if goes[i] >> j & 1:
                    for_i, for_j = hears[i] & ~(1 << j), hears[j] & ~(1 << i)
                    p, q = for_i & goes[j], for_j & goes[i]
                    if (
                        k_i > _room(p, for_i, s)
                        or need[j] > _room(q, for_j, s)
                        or k_i + need[j] > _room(p | q, for_i | for_j, s)
                    ):
                        goes[i] ^= 1 << j
                        goes[j] ^= 1 << i
                        changed = True
    return goes


def _room(satisfied: int, heard: int, s: int) -> int:
    """Return how many members ``heard`` can give: all of ``satisfied``, and at most s - 1 exempt others."""
    certain = satisfied.bit_count()
    return certain + min(s - 1, heard.bit_count() - certain)
