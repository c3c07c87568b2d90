r"""How many more failures until a goal is lost: the fewest links, or nodes, whose loss makes a violation.

As a 0-1 programme over the sets of a violation and what is lost. For every node i and side k, ``a_ik``: i is a normal
node of S_k; ``e_ik``: a node of S_k that may hear as much as it likes (of (r,s)-robustness: one of X_S1 and X_S2;
with one face: malicious inside S_k); ``m_i``: malicious outside both sides (two faces); ``g_i``: node i is lost;
``h_ji``: the link from j to i is lost or j is. With ``b`` the most that a normal node of S_k may hear from outside
(r - 1, or f)::

    minimise    the links lost, or the nodes lost
    a_i1 + e_i1 + a_i2 + e_i2 + m_i + g_i <= 1                                    every i
    sum of a_ik >= 1                                                              both k
    sum over j in N_i of o_jik <= b   if a_ik                                     every i, k
    o_jik >= a_ik - a_jk - e_jk - m_j - h_ji                                      every arc j -> i, every k
    sum of all e_ik <= s - 1;  or the bound on malicious nodes, in all or around every node outside M

For (r,s)-robustness these are its violations: X_Sk lies among the e of its side, neither side is all X, and together
they are fewer than s. What is trusted is CP-SAT's word that no smaller loss suffices; the loss itself is checked by the
exact search's definition.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import Any

from certificates.graph import Label
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InternalError, InvalidParameter
from robustness.limits import Limits
from robustness.mending.goal import Part, goals_of, parts_of
from robustness.mending.oracle import violates
from robustness.natural_order import natural_key
from robustness.showing import Shown
from robustness.solver_calls import solve_within
from robustness.spelled import Spelling, counted, plural
from robustness.traps.question import Sets

__all__ = ["Margin", "margin"]


@dataclass(frozen=True, slots=True, repr=False)
class Margin(Shown):
    """The fewest losses that destroy a goal, as far as they are known.

    Attributes
    ----------
    losses : int or None
        So many destroy it; None when no such loss is known. With ``is_exact`` and None: the goal survives every loss.
    lower_bound : int
        Fewer than this do not.
    is_exact : bool
    links : tuple of pairs of labels
        The lost links (undirected graphs: in natural order).
    nodes : tuple of labels
        The lost nodes.
    graph : Digraph
    goal : str
    """

    losses: int | None
    lower_bound: int
    is_exact: bool
    links: tuple[tuple[Label, Label], ...]
    nodes: tuple[Label, ...]
    graph: Digraph = field(repr=False)
    goal: str = ""
    seconds: float = field(default=0.0, compare=False)

    def summary(self) -> str:
        """Return the margin in one sentence."""
        kind = "node" if self.nodes else "link"
        if self.losses == 0:
            return f"the network does not reach the goal, {self.goal}, as it is"
        if self.losses is None:
            return (
                f"no loss destroys it: {self.goal}"
                if self.is_exact
                else f"fewer than {counted(self.lower_bound, 'loss', 'losses')} do not destroy it: {self.goal}"
            )
        lost, destroy = counted(self.losses, kind), plural(self.losses, "destroys", "destroy")
        if self.is_exact:
            return f"{lost} lost, and no fewer, {destroy} it: {self.goal}"
        return f"{lost} lost {destroy} it, fewer than {self.lower_bound} do not: {self.goal}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return what is lost, as rows of a name and a text."""
        spelled = Spelling(self.graph.labels)
        arrow = "->" if self.graph.directed else "--"
        links = ", ".join(f"{spelled(u)} {arrow} {spelled(v)}" for u, v in self.links)
        rows = (("lost links", links), ("lost nodes", ", ".join(map(spelled, self.nodes))))
        return [(name, text) for name, text in rows if text]

    def as_dict(self) -> dict[str, Any]:
        """Return the margin as JSON-ready values."""
        return {
            "goal": self.goal,
            "losses": self.losses,
            "lower_bound": self.lower_bound,
            "is_exact": self.is_exact,
            "links": [list(link) for link in self.links],
            "nodes": list(self.nodes),
        }


def margin(
    G: GraphLike,
    goal: object,
    *,
    of: str = "links",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
) -> Margin:
    """Return the fewest links, or nodes, whose loss destroys a goal, exactly, with one such loss.

    Parameters
    ----------
    G : networkx graph or Digraph
    goal
        As for :func:`robustness.mend`.
    of : "links" or "nodes"
        What is lost. A lost node takes its links along; what is left has to hold at least one node on either side.
    time_limit, jobs, seed
        As for :func:`robustness.check_rs_robustness`.

    Returns
    -------
    Margin

    See Also
    --------
    robustness.mend : links to add
    robustness.thin : links that can be spared

    >>> import networkx as nx
    >>> margin(nx.complete_graph(5), 3).losses, margin(nx.wheel_graph(5), (2, 2)).losses
    (2, 1)
    """
    started = time.monotonic()
    graph = as_digraph(G)
    if of not in ("links", "nodes"):
        raise InvalidParameter(f"what is lost is 'links' or 'nodes', not {of!r}")
    goals = goals_of(goal)
    words = " and ".join(map(str, goals))
    limits = Limits.of(time_limit, jobs, seed)
    losses: int | None = None
    links: tuple[tuple[int, int], ...] = ()
    nodes: tuple[int, ...] = ()
    bounds: list[int | None] = []
    for part in parts_of(goals, graph.n):
        found = _least(graph, part, of == "nodes", limits)
        bounds.append(found.bound)
        if found.lost is not None and (losses is None or len(found.lost[0]) + len(found.lost[1]) < losses):
            links, nodes = found.lost
            losses = len(links) + len(nodes)
    finite = [bound for bound in bounds if bound is not None]
    lower = min(finite, default=0)
    is_exact = losses == lower if losses is not None else not finite
    labels = graph.labels
    return Margin(
        losses,
        lower if losses is None or lower < losses else losses,
        is_exact,
        tuple(sorted(((labels[u], labels[v]) for u, v in links), key=natural_key)),
        tuple(sorted((labels[i] for i in nodes), key=natural_key)),
        graph,
        words,
        time.monotonic() - started,
    )


@dataclass(frozen=True, slots=True)
class _Least:
    """The links and nodes lost (ids; None: none found) and a lower bound (None: no loss makes a violation)."""

    lost: tuple[tuple[tuple[int, int], ...], tuple[int, ...]] | None
    bound: int | None


def _least(graph: Digraph, part: Part, of_nodes: bool, limits: Limits) -> _Least:
    from ortools.sat.python import cp_model

    if limits.expired():
        return _Least(None, 0)
    model = cp_model.CpModel()
    n, question = graph.n, part.trap
    normal = [[model.new_bool_var("") for _ in range(2)] for _ in range(n)]
    exempt = [[model.new_bool_var("") for _ in range(2)] for _ in range(n)]
    outside = [model.new_bool_var("") for _ in range(n)]
    gone = [model.new_bool_var("") for _ in range(n)]
    two_faces = question is not None and question.two_faces
    for i in range(n):
        model.add_at_most_one([*normal[i], *exempt[i], outside[i], gone[i]])
        if two_faces:
            model.add(exempt[i][0] + exempt[i][1] == 0)
        else:
            model.add(outside[i] == 0)
        if not of_nodes:
            model.add(gone[i] == 0)
    for k in range(2):
        model.add_bool_or([normal[i][k] for i in range(n)])
    cut = _cuts(model, graph, of_nodes)
    most = part.r - 1 if question is None else question.f
    for i in range(n):
        heard = graph.in_neighbours(i).tolist()
        if len(heard) <= most:
            continue
        for k in range(2):
            counted = []
            for j in heard:
                each = model.new_bool_var("")
                lost = gone[j] if of_nodes else cut[j, i]
                model.add(each >= normal[i][k] - normal[j][k] - exempt[j][k] - outside[j] - lost)
                counted.append(each)
            model.add(sum(counted) <= most)
    _bound_the_exempt(model, graph, part, exempt, outside, gone, cut)
    model.minimize(sum(gone) if of_nodes else sum(_links(graph, cut).values()))
    outcome = solve_within(model, limits)
    if outcome.is_infeasible:
        return _Least(None, None)
    if not outcome.has_solution:
        return _Least(None, 0)
    links = tuple(ends for ends, each in _links(graph, cut).items() if outcome.value(each)) if not of_nodes else ()
    nodes = tuple(i for i in range(n) if outcome.value(gone[i]))
    sides = [
        frozenset(i for i in range(n) if outcome.value(normal[i][k]) or outcome.value(exempt[i][k])) for k in (0, 1)
    ]
    bad = frozenset(
        i for i in range(n) if outcome.value(outside[i]) or (question and any(map(outcome.value, exempt[i])))
    )
    _check(graph, part, Sets(bad, *sides), links, nodes)
    bound = len(links) + len(nodes) if outcome.is_optimal else math.ceil(max(0, outcome.bound) - 1e-6)
    return _Least((links, nodes), max(bound, 0))


def _cuts(model: Any, graph: Digraph, of_nodes: bool) -> dict[tuple[int, int], Any]:
    """Return for every arc whether it is lost; the two arcs of an undirected link are lost together."""
    cut: dict[tuple[int, int], Any] = {}
    if of_nodes:
        return cut
    for u, v in graph.arcs():
        if not graph.directed and (v, u) in cut:
            cut[u, v] = cut[v, u]
        else:
            cut[u, v] = model.new_bool_var("")
    return cut


def _links(graph: Digraph, cut: dict[tuple[int, int], Any]) -> dict[tuple[int, int], Any]:
    return {(u, v): each for (u, v), each in cut.items() if graph.directed or u < v}


def _bound_the_exempt(
    model: Any, graph: Digraph, part: Part, exempt: Any, outside: Any, gone: Any, cut: dict[tuple[int, int], Any]
) -> None:
    """Bound the nodes that may hear as much as they like."""
    bad = [outside[i] + exempt[i][0] + exempt[i][1] for i in range(graph.n)]
    if part.trap is None:
        model.add(sum(bad) <= part.s - 1)
        return
    if not part.trap.local:
        model.add(sum(bad) <= part.trap.f)
        return
    for i in range(graph.n):
        heard = graph.in_neighbours(i).tolist()
        if len(heard) <= part.trap.f:
            continue
        counted = []
        for j in heard:
            each = model.new_bool_var("")
            lost = cut[j, i] if cut else 0
            model.add(each >= bad[j] - lost)
            counted.append(each)
        model.add(sum(counted) <= part.trap.f + len(heard) * (bad[i] + gone[i]))


def _check(graph: Digraph, part: Part, sets: Sets, links: tuple[tuple[int, int], ...], nodes: tuple[int, ...]) -> None:
    """Guarantees that the sets violate the condition once the loss has happened."""
    lost = set(links) | ({(v, u) for u, v in links} if not graph.directed else set())
    left = [i for i in range(graph.n) if i not in nodes]
    place = {i: k for k, i in enumerate(left)}
    arcs = [
        (graph.labels[u], graph.labels[v]) for u, v in graph.arcs() if (u, v) not in lost and u in place and v in place
    ]
    after = Digraph([graph.labels[i] for i in left], arcs, directed=graph.directed)
    moved = Sets(*(after.ids(graph.labels[i] for i in ids) for ids in sets))
    if not violates(after, part, moved):
        raise InternalError(
            f"the solver returned {sets} after the loss of {links or nodes}, no violation: please report"
        )
