"""The operations of Lemma 1 and their relatives: each returns a new graph and the robustness it is sure to have.

Every operation takes either a plain graph, which is then decided exactly first, or what another operation returned,
and then no search is needed. Graphs given are never changed. Labels must be those of
:class:`~robustness.digraph.Digraph`; node and edge attributes are not carried over.

>>> import networkx as nx
>>> start = guaranteed(nx.complete_graph(5))
>>> graph, guarantee = add_node(remove_in_arcs(start, [(0, 1)]), 5, hears=[0, 1, 2, 3, 4])
>>> print(guarantee)
(2,4)-robust by add-node
"""

from __future__ import annotations

import random
from collections.abc import Callable, Hashable, Iterable, Mapping
from types import MappingProxyType
from typing import Any

from certificates.graph import Label, label_key
from robustness.constructions.family import require
from robustness.constructions.guarantee import Guarantee, Guaranteed
from robustness.decision.front import determine_robustness, is_rs_robust
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidGraph, InvalidParameter, Undecided
from robustness.json_labels import from_json
from robustness.results import Verdict
from robustness.spelled import counted

__all__ = [
    "add_arcs",
    "add_node",
    "blow_up",
    "carry_out",
    "grow",
    "guaranteed",
    "join_clique",
    "r_beside_clique",
    "remove_in_arcs",
    "remove_nodes",
    "replay",
    "union",
    "weaken",
]

Start = GraphLike | Guaranteed


def guaranteed(G: GraphLike, r: int | None = None, s: int = 1, *, time_limit: float | None = None) -> Guaranteed:
    """Return G with its greatest r and then s, or with the (r,s) given, decided by an exact algorithm.

    Raises
    ------
    InvalidParameter
        When (r,s) was given and G is not (r,s)-robust.
    Undecided
        When the time limit stopped the search.

    >>> import networkx as nx
    >>> print(guaranteed(nx.wheel_graph(6)).guarantee)
    (2,3)-robust by checked
    """
    graph = as_digraph(G)
    if r is None:
        found = determine_robustness(graph, time_limit=time_limit)
        if found.verdict is not Verdict.DETERMINED:
            raise Undecided("r* was not decided, so nothing is guaranteed: raise the time limit or give r and s")
        r, s = found.r, found.s
    elif not is_rs_robust(graph, r, s, time_limit=time_limit):
        raise InvalidParameter(f"the graph is not ({r},{s})-robust: give a smaller r or s")
    return _conclude(graph, r, s, "checked", {}, ())


def weaken(base: Start, r: int, s: int = 1) -> Guaranteed:
    """Return the same graph with a smaller promise, one that follows by Lemma 1 (i) and (ii).

    Raises
    ------
    InvalidParameter
        When (r,s) does not follow.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    require(
        0 <= r and 1 <= s <= max(graph.n, 1) and start.guarantee.implies(r, s),
        f"(r,s) follows from {start.guarantee}",
        r=r,
        s=s,
    )
    return _conclude(graph, r, s, "weaken", {"r": r, "s": s}, (start.guarantee,))


def add_arcs(base: Start, arcs: Iterable[tuple[Hashable, Hashable]]) -> Guaranteed:
    """Add links between present nodes: (r,s) is kept, since ``X_S^r`` never loses a node.

    In an undirected graph every link is an edge. Arcs already present change nothing.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    added = _label_pairs(graph, arcs)
    new = _with_arcs(graph, added)
    return _conclude(new, start.guarantee.r, start.guarantee.s, "add-arcs", {"arcs": added}, (start.guarantee,))


def union(first: Start, second: Start) -> Guaranteed:
    """Return the union of the arc sets of two graphs on the same nodes: the better (r,s) of the two is kept.

    Raises
    ------
    InvalidGraph
        When the node sets differ.
    """
    one, two = _start(first), _start(second)
    left, right = as_digraph(one.graph), as_digraph(two.graph)
    if left.labels != right.labels:
        raise InvalidGraph("a union is of two graphs on the same nodes: add the missing nodes first")
    arcs = [(graph.labels[u], graph.labels[v]) for graph in (left, right) for u, v in graph.arcs()]
    new = Digraph(left.labels, arcs, directed=left.directed or right.directed)
    r, s = max((one.guarantee.r, one.guarantee.s), (two.guarantee.r, two.guarantee.s))
    return _conclude(new, r, s, "union", {}, (one.guarantee, two.guarantee))


def remove_in_arcs(base: Start, arcs: Iterable[tuple[Hashable, Hashable]]) -> Guaranteed:
    """Remove links: when no node loses more than w in-arcs, (r,s) turns into (r-w,s) (Lemma 1 (vi)).

    An edge of an undirected graph is an in-arc of both its ends. For ``w >= r`` only (0,s) remains, which every graph
    has.

    Raises
    ------
    InvalidGraph
        When one of the arcs is not there.

    Notes
    -----
    Proof: a node with at least r in-neighbours outside S keeps at least r - w of them, so ``X_S^r`` before is
    contained in ``X_S^(r-w)`` after.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    removed = _label_pairs(graph, arcs)
    gone = {tuple(arc) for arc in removed} | ({(v, u) for u, v in removed} if not graph.directed else set())
    present = {(graph.labels[u], graph.labels[v]) for u, v in graph.arcs()}
    if missing := gone - present:
        raise InvalidGraph(f"only links of the graph can be removed, and {min(missing, key=repr)!r} is none")
    new = Digraph(graph.labels, present - gone, directed=graph.directed)
    w = max((graph.in_degrees - new.in_degrees).tolist(), default=0)
    r = max(start.guarantee.r - w, 0)
    return _conclude(new, r, start.guarantee.s, "remove-in-arcs", {"arcs": removed}, (start.guarantee,))


def remove_nodes(base: Start, nodes: Iterable[Hashable]) -> Guaranteed:
    """Remove nodes: when every other node hears at most w of them, (r,s) turns into (r-w,s).

    s is cut to the number of nodes left. Proof: a pair of sets of the smaller graph is one of the larger, and its
    nodes lose at most w outside in-neighbours. (This is what the source paper needs where it removes the malicious
    nodes; Lemma 1 (vi) alone speaks about graphs with the same nodes.)
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    removed = graph.ids(nodes)
    left = [i for i in range(graph.n) if i not in removed]
    w = max((sum(j in removed for j in graph.in_neighbours(i).tolist()) for i in left), default=0)
    arcs = [(graph.labels[u], graph.labels[v]) for u, v in graph.arcs() if not {u, v} & removed]
    new = Digraph([graph.labels[i] for i in left], arcs, directed=graph.directed)
    r = min(max(start.guarantee.r - w, 0), largest_conceivable_r(new.n))
    s = min(start.guarantee.s, max(new.n, 1))
    parameters = {"nodes": [graph.labels[i] for i in sorted(removed)]}
    return _conclude(new, r, s, "remove-nodes", parameters, (start.guarantee,))


def add_node(base: Start, node: Hashable, hears: Iterable[Hashable], heard_by: Iterable[Hashable] = ()) -> Guaranteed:
    """Add a node: (r,s) is kept when its in-degree is at least r + s - 1 (Lemma 1 (vii), strengthened).

    With a smaller in-degree d the best that follows is kept: (r, d-r+1) while d >= r, and (d, 1) below.

    Parameters
    ----------
    base : networkx graph or Guaranteed
    node : label
        Not a node of the graph.
    hears : iterable of nodes
        The in-neighbours of the new node; in an undirected graph its neighbours.
    heard_by : iterable of nodes
        Its out-neighbours; only for directed graphs.

    Notes
    -----
    Proof. Take a pair of the new graph. If the new node v is in neither set, nothing changed. Let v be in S1, which
    is more than {v} ({v} itself is fully reachable, as d >= r). The pair without v has X1 = S1, X2 = S2 or ``|X1| +
    |X2| >= s``, and the last two stay true. If X1 = S1 and v has fewer than r in-neighbours outside S1, it has at
    least s inside, so ``|X1| >= s``.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    sources, targets = _labels(graph, hears), _labels(graph, heard_by)
    if not graph.directed and targets:
        raise InvalidParameter("heard_by is for directed graphs: in an undirected graph the neighbours are in hears")
    if node in graph.index:
        raise InvalidGraph(f"a new node has a new label, but {node!r} is a node already")
    arcs = [(source, node) for source in sources] + [
        (node, target) for target in (targets if graph.directed else sources)
    ]
    new = _with_nodes(graph, [node], arcs)
    r, s = _after_adding(start.guarantee, len(sources))
    parameters = {"node": node, "hears": sources, "heard_by": targets}
    return _conclude(new, r, s, "add-node", parameters, (start.guarantee,))


def grow(base: Start, n: int, *, links: int | None = None, seed: int = 0) -> Guaranteed:
    """Grow to n nodes: each new node hears ``links`` random present nodes, and (r,s) is kept as by :func:`add_node`.

    Parameters
    ----------
    base : networkx graph or Guaranteed
    n : int
        At least the number of nodes present. New labels are the least integers not yet used, from 0.
    links : int, optional
        Default r + s - 1, or all nodes present at the start if these are fewer.
    seed : int
        Fixes the draws.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    require(type(n) is int and n >= graph.n, f"n is at least the {counted(graph.n, 'node')} present", n=n)
    if links is None:
        links = min(start.guarantee.r + start.guarantee.s - 1, graph.n)
    require(0 <= links <= graph.n, f"links is in 0..{graph.n}, the nodes present", links=links)
    draw, fresh = random.Random(seed), _fresh_labels(graph, n - graph.n)
    present: list[Label] = list(graph.labels)
    arcs: list[tuple[Label, Label]] = []
    for node in fresh:
        sources = draw.sample(present, links)
        arcs += [(source, node) for source in sources]
        if not graph.directed:
            arcs += [(node, source) for source in sources]
        present.append(node)
    new = _with_nodes(graph, fresh, arcs)
    r, s = _after_adding(start.guarantee, links) if fresh else (start.guarantee.r, start.guarantee.s)
    return _conclude(new, r, s, "grow", {"n": n, "links": links, "seed": seed}, (start.guarantee,))


def join_clique(base: Start, size: int) -> Guaranteed:
    """Join with a clique: add ``size`` nodes that hear, and are heard by, each other and all nodes present.

    With m = size, N nodes in the end and d the least in-degree before, r turns into
    ``R = min(r + m, ceil(N/2), max(m, floor((m + d)/2) + 1))``; where that is no gain, (r,s) as by :func:`add_node`.

    Notes
    -----
    Proof. Suppose S1 and S2 are both not R-reachable. A new node in a set S hears N - |S| <= R - 1 <= ceil(N/2) - 1
    outside, so |S| > N/2: not both sets have one. If neither has, r-robustness before gives a node with r + m outside.
    So let S1 have one and S2 none: |S2| <= N - |S1| <= R - 1, and a node of S2 hears all m new nodes and at least
    d - (|S2| - 1) others outside, so at least max(m, m + d - R + 2) >= R.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    require(type(size) is int and size >= 1, "size is at least 1", size=size)
    fresh = _fresh_labels(graph, size)
    everyone = [*graph.labels, *fresh]
    arcs = [(u, v) for u in everyone for v in fresh if u != v] + [(u, v) for u in fresh for v in graph.labels]
    new = _with_nodes(graph, fresh, arcs)
    r = r_beside_clique(start.guarantee.r, graph, size)
    best = max((r, 1), _after_adding(start.guarantee, graph.n))
    return _conclude(new, *best, "join-clique", {"size": size}, (start.guarantee,))


def r_beside_clique(r: int, graph: Digraph, size: int) -> int:
    """Return the R of :func:`join_clique` for an r-robust graph and a clique of ``size`` nodes."""
    least = int(graph.in_degrees.min()) if graph.n else 0
    return min(r + size, largest_conceivable_r(graph.n + size), max(size, (size + least) // 2 + 1))


def blow_up(base: Start, copies: int, *, cliques: bool = False) -> Guaranteed:
    """Blow-up: replace every node v by copies (v, 0) .. (v, copies - 1) that hear all copies of what v hears.

    With t copies and d the least in-degree before, r turns into ``R = min(t r, ceil(t d / 2))``; with
    ``cliques``, when the copies of a node hear each other too, into ``min(t r, ceil(t (d + 1) / 2))``. s turns into 1.

    Notes
    -----
    Proof. Suppose S1 and S2 are both not R-reachable. Copies of a node hear the same, so a set that has one copy of v
    stays not R-reachable when it takes others; let both take what is free. If v has copies in both sets, one copy in
    each hears at most R - 1 outside its set; together they hear every copy of every in-neighbour at least once, so
    ``t d <= 2 (R - 1)``, against R <= ceil(t d / 2). So both sets are full sets of copies; they come from disjoint
    sets before, one of which has a node with r in-neighbours outside: t r outside after.
    """
    start = _start(base)
    graph = as_digraph(start.graph)
    require(type(copies) is int and copies >= 1, "copies is at least 1", copies=copies)
    nodes = [(label, copy) for label in graph.labels for copy in range(copies)]
    arcs = [
        ((graph.labels[u], i), (graph.labels[v], j))
        for u, v in graph.arcs()
        for i in range(copies)
        for j in range(copies)
    ]
    if cliques:
        arcs += [((v, i), (v, j)) for v in graph.labels for i in range(copies) for j in range(copies) if i != j]
    new = Digraph(nodes, arcs, directed=graph.directed)
    least = (int(graph.in_degrees.min()) if graph.n else 0) + cliques
    r = min(copies * start.guarantee.r, (copies * least + 1) // 2)
    return _conclude(new, r, 1, "blow-up", {"copies": copies, "cliques": cliques}, (start.guarantee,))


def replay(guarantee: Guarantee, seeds: Iterable[GraphLike], *, time_limit: float | None = None) -> Guaranteed:
    """Carry out a derivation again from its seed graphs, deciding each of these exactly, and return its conclusion.

    Parameters
    ----------
    guarantee : Guarantee
        For instance from :meth:`Guarantee.from_dict`.
    seeds : iterable of graphs
        The graphs that the leaves, the ``"checked"`` ones, speak about.

    Raises
    ------
    InvalidParameter
        When a seed is missing or a step does not give what the derivation says.
    """
    return _replay(guarantee, {graph.sha256: graph for graph in map(as_digraph, seeds)}, time_limit)


def _replay(guarantee: Guarantee, seeds: Mapping[str, Digraph], time_limit: float | None) -> Guaranteed:
    if guarantee.rule == "checked":
        if guarantee.sha256 not in seeds:
            raise InvalidParameter(f"the seed graph {guarantee.sha256[:12]} is missing: give it in seeds")
        return guaranteed(seeds[guarantee.sha256], guarantee.r, guarantee.s, time_limit=time_limit)
    return carry_out(guarantee, [_replay(premise, seeds, time_limit) for premise in guarantee.premises])


def carry_out(guarantee: Guarantee, premises: Iterable[Guaranteed]) -> Guaranteed:
    """Carry out the last step of a derivation, given what its premises speak about.

    Raises
    ------
    InvalidParameter
        When it does not give what the derivation says.
    """
    parameters = {k: from_json(v) if k == "node" else _from_json(v) for k, v in guarantee.parameters.items()}
    try:
        again = OPERATIONS[guarantee.rule](*premises, **parameters)
    except TypeError:
        raise InvalidParameter(f"a {guarantee.rule} step does not have these parameters or premises") from None
    if again.guarantee != guarantee:
        raise InvalidParameter(f"the derivation says {guarantee}, but carrying it out gives {again.guarantee}")
    return again


#: Every operation by the name of its rule.
OPERATIONS: Mapping[str, Callable[..., Guaranteed]] = MappingProxyType(
    {
        "weaken": weaken,
        "add-arcs": add_arcs,
        "union": union,
        "remove-in-arcs": remove_in_arcs,
        "remove-nodes": remove_nodes,
        "add-node": add_node,
        "grow": grow,
        "join-clique": join_clique,
        "blow-up": blow_up,
    }
)


def _start(base: Start) -> Guaranteed:
    """Return ``base`` with its guarantee, decided first when it is a plain graph, and checked to belong to it."""
    if not isinstance(base, Guaranteed):
        return guaranteed(base)
    if as_digraph(base.graph).sha256 != base.guarantee.sha256:
        raise InvalidGraph("the graph was changed after its guarantee was given: start from guaranteed(graph)")
    return base


def _conclude(
    graph: Digraph, r: int, s: int, rule: str, parameters: Mapping[str, Any], premises: tuple[Guarantee, ...]
) -> Guaranteed:
    made = graph.to_networkx()
    return Guaranteed(
        made, Guarantee(r, s, rule, {k: _to_json(v) for k, v in parameters.items()}, premises, graph.sha256)
    )


def _after_adding(guarantee: Guarantee, in_degree: int) -> tuple[int, int]:
    """Return the best (r,s) that a new node of this in-degree keeps."""
    r = min(guarantee.r, in_degree)
    return r, min(guarantee.s + guarantee.r - r, in_degree - r + 1) if r else 1


def _with_arcs(graph: Digraph, arcs: Iterable[tuple[Label, Label]]) -> Digraph:
    return _with_nodes(graph, [], [*arcs, *(((v, u) for u, v in arcs) if not graph.directed else ())])


def _with_nodes(graph: Digraph, nodes: Iterable[Hashable], arcs: Iterable[tuple[Hashable, Hashable]]) -> Digraph:
    present = [(graph.labels[u], graph.labels[v]) for u, v in graph.arcs()]
    return Digraph([*graph.labels, *nodes], [*present, *arcs], directed=graph.directed)


def _labels(graph: Digraph, nodes: Iterable[Hashable]) -> list[Label]:
    return sorted(graph.labels_of(graph.ids(nodes)), key=label_key)


def _label_pairs(graph: Digraph, arcs: Iterable[tuple[Hashable, Hashable]]) -> list[tuple[Label, Label]]:
    pairs = {(graph.labels[u], graph.labels[v]) for a, b in arcs for u in graph.ids([a]) for v in graph.ids([b])}
    if loops := [u for u, v in pairs if u == v]:
        raise InvalidGraph(f"a link joins two different nodes, not {loops[0]!r} with itself")
    return sorted(pairs, key=label_key)


def _fresh_labels(graph: Digraph, count: int) -> list[Label]:
    """Return the least integers from 0 that are no labels yet."""
    fresh: list[Label] = []
    candidate = 0
    while len(fresh) < count:
        if candidate not in graph.index:
            fresh.append(candidate)
        candidate += 1
    return fresh


def _to_json(value: Any) -> Any:
    """Return ``value`` with tuples as lists, as JSON would give it back."""
    return [_to_json(part) for part in value] if isinstance(value, list | tuple) else value


def _from_json(value: Any) -> Any:
    """Return ``value`` with the lists inside a list as tuples: labels and arcs are tuples, collections lists."""
    return [from_json(part) for part in value] if isinstance(value, list) else value
