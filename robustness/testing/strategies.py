"""Strategies: graphs that keep a promise by construction, time-varying graphs, and sets of malicious nodes.

An r-robust graph is drawn as a seed that is r-robust, nodes of in-degree at least r added to it, and more links;
nothing is drawn and thrown away.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from itertools import combinations, permutations
from typing import Literal

# Here and not where they are used: hypothesis takes a first draw that waits for an import for a slow strategy.
import networkx as nx

from robustness.decision.bounds.degree import sufficient_degree
from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter, MissingExtra
from robustness.pasteable import PasteableDiGraph, PasteableGraph
from robustness.results import Witness
from robustness.spelled import counted

try:
    from hypothesis import strategies as st
except ImportError as missing:  # pragma: no cover - the tests of this module need it
    raise MissingExtra("robustness.testing needs hypothesis: pip install 'graph-robustness[testing]'") from missing

__all__ = [
    "digraphs",
    "graphs",
    "malicious_sets",
    "not_r_robust_graphs",
    "r_robust_graphs",
    "rs_robust_graphs",
    "time_varying_graphs",
]

Draw = st.DrawFn


@st.composite
def graphs(draw: Draw, *, min_nodes: int = 1, max_nodes: int = 7) -> nx.Graph:
    """Undirected graphs on nodes 0, 1, 2, ...

    Shrinks towards few nodes, then few edges.
    """
    return _any_graph(draw, min_nodes, max_nodes, directed=False)


@st.composite
def digraphs(draw: Draw, *, min_nodes: int = 1, max_nodes: int = 6) -> nx.DiGraph:
    """Directed graphs on nodes 0, 1, 2, ...

    Shrinks towards few nodes, then few arcs.
    """
    return _any_graph(draw, min_nodes, max_nodes, directed=True)


def r_robust_graphs(
    r: int, *, min_nodes: int | None = None, max_nodes: int | None = None, directed: bool = False
) -> st.SearchStrategy[nx.Graph]:
    """Guarantees that every graph is r-robust.

    Parameters
    ----------
    r : int
        At least 0.
    min_nodes, max_nodes : int, optional
        Default: as small as possible (2r - 1 nodes, at least 1), and four nodes more.
    directed : bool
        Whether to draw digraphs.

    Notes
    -----
    A seed is drawn, then nodes that hear at least r nodes before them (Lemma 1 (vii)), then any further links,
    and the nodes are renumbered. Seeds are the complete graph K_{2r-1}, and graphs of least in-degree
    ``floor(n/2) + r - 1``, which are r-robust since of two disjoint sets one has at most n/2 nodes. Not every
    r-robust graph can be drawn. Shrinks to K_{2r-1}, for r >= 2.
    """
    return rs_robust_graphs(r, 1, min_nodes=min_nodes, max_nodes=max_nodes, directed=directed)


def rs_robust_graphs(
    r: int, s: int, *, min_nodes: int | None = None, max_nodes: int | None = None, directed: bool = False
) -> st.SearchStrategy[nx.Graph]:
    """Guarantees that every graph is (r,s)-robust.

    Parameters
    ----------
    r : int
        At least 0.
    s : int
        At least 1.
    min_nodes, max_nodes : int, optional
        Default: as small as possible (``max(2r - 1, s)`` nodes), and four nodes more.
    directed : bool
        Whether to draw digraphs.

    Notes
    -----
    As :func:`r_robust_graphs`; new nodes hear at least r + s - 1 nodes, or all while there are fewer. A graph of least
    in-degree ``floor(n/2) + r - 1`` is (r,s)-robust for every s, since X_S = S for the smaller of two disjoint sets.
    """
    _require_at_least("r", r, 0)
    _require_at_least("s", s, 1)
    least = max(2 * r - 1, s, 1)
    low = least if min_nodes is None else max(min_nodes, least)
    high = max(least, low) + 4 if max_nodes is None else max_nodes
    if high < low:
        raise InvalidParameter(
            f"a ({r},{s})-robust graph has at least {counted(least, 'node')}, so max_nodes is at least {low}"
        )
    return _robust_graphs(r, s, least, low, high, directed)


def not_r_robust_graphs(
    r: int, *, min_nodes: int = 2, max_nodes: int = 7, directed: bool = False
) -> st.SearchStrategy[tuple[nx.Graph, Witness]]:
    """Guarantees that every graph is not r-robust, and comes with a pair that violates it: ``(graph, (S1, S2))``.

    Parameters
    ----------
    r : int
        At least 1.
    min_nodes, max_nodes : int
        At least 2.
    directed : bool
        Whether to draw digraphs.

    Notes
    -----
    The pair comes first: nodes are put into S1, S2 or neither, and then links are drawn so that no node of either set
    hears more than r - 1 nodes outside it. Every graph that is not r-robust can be drawn. Shrinks to two nodes, no
    link.
    """
    _require_at_least("r", r, 1)
    _require_at_least("min_nodes", min_nodes, 2)
    _require_at_least("max_nodes", max_nodes, min_nodes)
    return _not_robust_graphs(r, min_nodes, max_nodes, directed)


@st.composite
def time_varying_graphs(
    draw: Draw,
    *,
    r: int = 0,
    min_nodes: int | None = None,
    max_nodes: int | None = None,
    max_period: int = 3,
    directed: bool = False,
) -> list[nx.Graph]:
    """Lists of graphs on the same nodes, one period: repeated for ever, they are jointly r-robust over one period.

    Draws an r-robust graph and gives each of its links to at least one of the steps. A single step need not be
    r-robust, and is mostly not. ``TimeVaryingGraph(steps, period=len(steps))`` is the sequence. Shrinks to one step.
    """
    _require_at_least("max_period", max_period, 1)
    whole = draw(r_robust_graphs(r, min_nodes=min_nodes, max_nodes=max_nodes, directed=directed))
    period = draw(st.integers(1, max_period))
    steps = [whole.__class__() for _ in range(period)]
    for step in steps:
        step.add_nodes_from(whole)
    for edge in whole.edges:
        for k in draw(st.sets(st.integers(0, period - 1), min_size=1)):
            steps[k].add_edge(*edge)
    return steps


@st.composite
def malicious_sets(draw: Draw, G: GraphLike, f: int, model: Literal["total", "local"] = "total") -> frozenset[Hashable]:
    """Sets of malicious nodes of G: f-total, or f-local.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    model : "total" or "local"
        ``"total"``: at most f nodes, and one node is left normal. ``"local"``: every normal node hears at most f of
        them; all such sets can be drawn, the set of all nodes too, where no normal node is left.

    Notes
    -----
    For ``"local"`` any set is drawn, and while a normal node hears more than f of it, the last of these is let go; that
    ends, as the set shrinks. Shrinks to the empty set.
    """
    _require_at_least("f", f, 0)
    graph = as_digraph(G)
    if model == "total":
        most = max(min(f, graph.n - 1), 0)
        return graph.labels_of(draw(st.sets(st.sampled_from(range(graph.n)), max_size=most)) if most else ())
    if model != "local":
        raise InvalidParameter(f"model is 'total' or 'local', not {model!r}")
    malicious = {i for i in range(graph.n) if draw(st.booleans())}
    hears = [graph.in_neighbours(i).tolist() for i in range(graph.n)]
    while True:
        heard = ([j for j in hears[i] if j in malicious] for i in range(graph.n) if i not in malicious)
        too_many = next((each for each in heard if len(each) > f), None)
        if too_many is None:
            return graph.labels_of(malicious)
        malicious.discard(too_many[-1])


def _any_graph(draw: Draw, min_nodes: int, max_nodes: int, *, directed: bool) -> nx.Graph:
    _require_at_least("min_nodes", min_nodes, 0)
    _require_at_least("max_nodes", max_nodes, min_nodes)
    # What becomes of each node is drawn apart from the links, and all links are drawn whatever becomes of their
    # ends. So shrinking can drop a node, or merge it with a neighbour, or drop a link, and leave the rest as it is:
    # steps to any minor.
    fates = [draw(st.sampled_from(_FATES)) for _ in range(max_nodes - min_nodes)]
    graph = _empty(max_nodes, directed)
    graph.add_edges_from(_links(draw, max_nodes, directed))
    lost = {min_nodes + i: fate for i, fate in enumerate(fates) if fate != "there"}
    for node, fate in lost.items():
        if fate == "merged":
            _merge(graph, node, lost)
    return _without(graph, lost)


#: What may become of a node, the simplest first; most stay.
_FATES = ("gone", "merged", "there", "there", "there", "there")


def _merge(graph: nx.Graph, node: int, lost: Mapping[int, str]) -> None:
    """Give the links of ``node`` to the first of its neighbours that stays or is merged later, if there is one."""
    neighbours = sorted(nx.all_neighbors(graph, node))
    heir = next((each for each in neighbours if each not in lost or (each > node and lost[each] == "merged")), None)
    if heir is not None:
        for arc in (
            list(graph.in_edges(node)) + list(graph.out_edges(node)) if graph.is_directed() else list(graph.edges(node))
        ):
            moved = [heir if end == node else end for end in arc]
            if moved[0] != moved[1]:
                graph.add_edge(*moved)


def _links(draw: Draw, n: int, directed: bool) -> list[tuple[int, int]]:
    """Return any set of links between n nodes; one draw for each, so that each can be dropped alone."""
    return [pair for pair in (permutations if directed else combinations)(range(n), 2) if draw(st.booleans())]


def _without(graph: nx.Graph, nodes: Iterable[int]) -> nx.Graph:
    """Return ``graph`` without these nodes, the others renumbered 0, 1, 2, ... in order."""
    gone = set(nodes)
    order = {node: place for place, node in enumerate(node for node in graph if node not in gone)}
    return _relabelled(graph.subgraph(order), order)


@st.composite
def _robust_graphs(draw: Draw, r: int, s: int, least: int, low: int, high: int, directed: bool) -> nx.Graph:
    n = draw(st.integers(low, high))
    seed_size = draw(st.integers(least, n))
    graph = _seed(draw, seed_size, r, directed)
    graph.add_nodes_from(range(n))
    for v in range(seed_size, n):
        heard = min(r + s - 1, v)
        sources = (
            draw(st.lists(st.sampled_from(range(v)), min_size=heard, max_size=heard, unique=True)) if heard else []
        )
        graph.add_edges_from((u, v) for u in sources)
    missing = [arc for arc in (permutations if directed else combinations)(range(n), 2) if not graph.has_edge(*arc)]
    if missing:
        graph.add_edges_from(draw(st.lists(st.sampled_from(missing), unique=True, max_size=n)))
    return _renumbered(draw, graph)


def _seed(draw: Draw, n: int, r: int, directed: bool) -> nx.Graph:
    """Return a graph on n >= 2r - 1 nodes with least in-degree ``floor(n/2) + r - 1``, capped at complete; n >= 1.

    Such a graph is (r,s)-robust for every s: of two disjoint sets one has at most ``floor(n/2)`` nodes, and each
    of its nodes hears at most ``floor(n/2) - 1`` nodes inside, so at least r outside. n - 1 in-neighbours do as well.
    """
    graph: nx.Graph = nx.complete_graph(n, create_using=nx.DiGraph if directed else nx.Graph)
    spare = [max(n - 1 - sufficient_degree(n, r), 0) if r else n - 1] * n
    if not any(spare):
        return graph
    # What is drawn is what is taken away, so shrinking ends in the complete graph, the seed that is easiest to see.
    for u, v in draw(st.lists(st.sampled_from(sorted(graph.edges)), unique=True, max_size=2 * n)):
        ends = [v] if directed else [u, v]
        if all(spare[end] for end in ends):
            graph.remove_edge(u, v)
            for end in ends:
                spare[end] -= 1
    return graph


@st.composite
def _not_robust_graphs(draw: Draw, r: int, min_nodes: int, max_nodes: int, directed: bool) -> tuple[nx.Graph, Witness]:
    roles: list[int | None] = [1, 2, *(draw(st.sampled_from((1, 2, 0))) for _ in range(min_nodes - 2))]
    roles += [draw(st.sampled_from((None, 1, 2, 0))) for _ in range(max_nodes - min_nodes)]  # None: not there
    graph, budget = _empty(max_nodes, directed), [r - 1] * max_nodes
    for source, sink in _links(draw, max_nodes, directed):
        # A node of a set pays for every node outside the set that it hears; absent nodes cost nothing.
        across = roles[source] != roles[sink] and None not in (roles[source], roles[sink])
        paying = [end for end in ([sink] if directed else [source, sink]) if across and roles[end]]
        if all(budget[end] for end in paying):
            graph.add_edge(source, sink)
            for end in paying:
                budget[end] -= 1
    present = [role for role in roles if role is not None]
    order = draw(st.permutations(range(len(present))))
    sides = (frozenset(order[i] for i, role in enumerate(present) if role == side) for side in (1, 2))
    graph = _without(graph, [i for i, role in enumerate(roles) if role is None])
    return _relabelled(graph, dict(enumerate(order))), Witness(*sides)


def _empty(n: int, directed: bool) -> nx.Graph:
    graph: nx.Graph = PasteableDiGraph() if directed else PasteableGraph()
    graph.add_nodes_from(range(n))
    return graph


def _renumbered(draw: Draw, graph: nx.Graph) -> nx.Graph:
    return _relabelled(graph, dict(enumerate(draw(st.permutations(range(len(graph)))))))


def _relabelled(graph: nx.Graph, order: Mapping[int, int]) -> nx.Graph:
    relabelled = _empty(len(order), graph.is_directed())
    relabelled.add_edges_from(sorted(tuple(order[end] for end in edge) for edge in graph.edges))
    return relabelled


def _require_at_least(name: str, value: int, least: int) -> None:
    if type(value) is not int or value < least:
        raise InvalidParameter(f"{name} is an integer of at least {least}, not {value!r}")
