"""The paper's counterexample graphs: Proposition 1, a corrected smaller family, and the 5-node figure.

Proposition 1 claims a graph that is 2f-robust and (f+1,f+1)-robust with all in-degrees at least 2f + 1, under which
ADP-MSR fails. What holds of the two variants here, for every f >= 1 (proofs at
:func:`two_f_robust_counterexample`; by exact search in ``tests/constructions/test_counterexamples.py``):

============  ==========================  =========  ================  =============  ===============  ====
variant       nodes                       2f-robust  (f+1,f+1)-robust  (2f+1)-robust  least in-degree  trap
============  ==========================  =========  ================  =============  ===============  ====
paper         7f                          yes        no                no             max(2, 3f - 1)   yes
corrected     max(3f + 2, 4f - 1)         yes        yes               no             3f               yes
============  ==========================  =========  ================  =============  ===============  ====

So the literal graph is 2f-robust and has the trap, but it is not (f+1,f+1)-robust as the proof says, and for f = 1
its least in-degree is 2 = 2f, not 2f + 1 (f >= 2 meets it). The corrected family has every property claimed, with
fewer nodes.
"""

from __future__ import annotations

from itertools import combinations, permutations
from typing import TYPE_CHECKING

from robustness.constructions.family import require
from robustness.errors import InvalidParameter
from robustness.traps import Trap

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["FIVE_NODE_READINGS", "five_node_figure", "two_f_robust_counterexample"]

#: Readings of the 5-node figure by name; the source gives the figure's labels but not its arcs.
FIVE_NODE_READINGS = ("wheel", "wheel-crossed", "digraph")


def two_f_robust_counterexample(f: int, variant: str = "paper") -> nx.Graph:
    """Proposition 1: a 2f-robust graph that is not (2f+1)-robust and on which ADP-MSR fails against f nodes.

    The trap is in ``G.graph["trap"]`` as ``{"M": [...], "S1": [...], "S2": [...]}``; every node has an attribute
    ``group``.

    Parameters
    ----------
    f : int
        At least 1.
    variant : "paper" or "corrected"
        ``"paper"``: the text read literally, a digraph on 7f nodes. ``G1 = K_4f``; G2, G3 and G4 are cliques of f
        nodes; each node of G4 hears the same 2f nodes of G1; each node of G3 hears f nodes of G1 and all of G4, and
        each node of G2 likewise with other f nodes of G1. Where the proof says that G2 is malicious and then moves
        the nodes of G4, the malicious nodes are G4: ``M = G4, S1 = G3, S2 = G2``. r* = 2f, s_max(f + 1) = f, so it is
        not (f+1,f+1)-robust. Links read as undirected give the same verdicts (f = 1, 2 tried).

        ``"corrected"``: for f <= 3 ``K_{3f+2}`` minus a matching of f + 1 edges, an undirected graph: M is f nodes
        joined to all, S1 and S2 are cliques of f + 1 nodes, joined but for a perfect matching. For f >= 4 that has
        too few nodes, since r* <= ceil(n/2): there S1 and S2 are joined by a 3-regular bipartite graph and f - 3
        nodes R are joined to all, ``4f - 1`` nodes together, the least that is possible. r* = 2f, s_max(f + 1) = n,
        least in-degree 3f. f = 1 is the wheel on 5 nodes.

    Returns
    -------
    networkx DiGraph ("paper") or Graph ("corrected")

    Notes
    -----
    Source: Proposition 1 of the source paper; the proofs below are ours. A trap for f rules out (2f+1)-robustness: a
    node of S1 hears at most f nodes outside S1 besides the f of M.

    *Paper.* K_4f is 2f-robust, and every node of G4, then G3, then G2 hears 2f nodes before it (Lemma 1 (vii)). So it
    is (f+1,f)-robust (item (ii)). The pair G3 ∪ G4, G1 ∪ G2 has only the f nodes of G4 that hear f + 1 outside.

    *Corrected.* The least in-degree is at least floor(n/2) + f, which gives (f+1,s) for every s. 2f-robust: for f <= 3
    by exact search. For f >= 4 suppose A and B are disjoint and neither is 2f-reachable. A node of M or R in a set S
    hears n - |S| outside it, so |S| >= 2f, and as n = 4f - 1 one of the sets, B, has no such node. Let it lack p
    nodes of S1 and q of S2. Its nodes hear the 2f - 3 nodes of M and R, so at most 2 others outside: of S1 the p and
    at most 2 - p in S2, and likewise from S2. As each hears 3 in the other clique, B meets both, and p, q <= 2. If A
    has none of M and R either, the same holds for A, and both have f - 1 or more of the f + 1 nodes of S1: too many.
    Otherwise |A| >= 2f, so |B| <= 2f - 1 and p + q >= 3, say p = 2 and q >= 1. A node of S2 that B lacks is heard by
    3 nodes of S1, so by one that is in B; but with p = 2 that one hears nothing in S2 outside B.

    For f = 2 there is one on 7 = 4f - 1 nodes as well: K_7 minus two disjoint edges. ``find_graph`` finds it.

    >>> G = two_f_robust_counterexample(1, variant="corrected")
    >>> len(G), G.graph["trap"]
    (5, {'M': [0], 'S1': [1, 2], 'S2': [3, 4]})
    """
    require(type(f) is int and f >= 1, "f is an integer of at least 1", f=f)
    match variant:
        case "paper":
            return _paper(f)
        case "corrected":
            return _corrected(f)
    raise InvalidParameter(f"variant is 'paper' or 'corrected', not {variant!r}")


def five_node_figure(reading: str = "wheel") -> nx.Graph:
    """Five-node figure: (2,2)-robust and not 3-robust, with a trap for f = 1 around node 4.

    Only the labels of the figure are in the source, not its arcs: these are readings. ``"wheel"``: hub 4 and rim
    1-2-3-5-1; ``"wheel-crossed"``: hub 4 and rim 1-3-2-5-1; ``"digraph"``: ``1->2,4,5  2->1,3,4,5  4->1,2,3,5 5->3``,
    as transcribed elsewhere for the source article. In all of them r* = 2; s_max(2) is 5 for the wheels and 2 for the
    digraph. ``G.graph["trap"]`` holds M = {4}, S1 = {1, 5}, S2 = {2, 3}, the two groups of the paper's simulation.

    >>> sorted(five_node_figure().edges(5))
    [(5, 1), (5, 3), (5, 4)]
    """
    import networkx as nx

    if reading not in FIVE_NODE_READINGS:
        raise InvalidParameter(f"reading is one of {', '.join(FIVE_NODE_READINGS)}, not {reading!r}")
    graph: nx.Graph = nx.DiGraph() if reading == "digraph" else nx.Graph()
    graph.add_nodes_from(range(1, 6))
    if reading == "digraph":
        heard_by = {1: (2, 4, 5), 2: (1, 3, 4, 5), 4: (1, 2, 3, 5), 5: (3,)}
        graph.add_edges_from((u, v) for u, hearers in heard_by.items() for v in hearers)
    else:
        nx.add_cycle(graph, (1, 2, 3, 5) if reading == "wheel" else (1, 3, 2, 5))
        graph.add_edges_from((4, rim) for rim in (1, 2, 3, 5))
    graph.graph["trap"] = Trap(frozenset({4}), frozenset({1, 5}), frozenset({2, 3})).as_dict()
    return graph


def _paper(f: int) -> nx.DiGraph:
    import networkx as nx

    groups = {"G1": range(4 * f), "G2": range(4 * f, 5 * f), "G3": range(5 * f, 6 * f), "G4": range(6 * f, 7 * f)}
    graph = nx.DiGraph()
    for name, members in groups.items():
        graph.add_nodes_from(members, group=name)
        graph.add_edges_from(permutations(members, 2))
    core = groups["G1"]
    heard = {"G4": [*core[: 2 * f]], "G3": [*core[2 * f : 3 * f], *groups["G4"]], "G2": [*core[3 * f :], *groups["G4"]]}
    graph.add_edges_from((u, v) for name, sources in heard.items() for v in groups[name] for u in sources)
    graph.graph["trap"] = {"M": [*groups["G4"]], "S1": [*groups["G3"]], "S2": [*groups["G2"]]}
    return graph


def _corrected(f: int) -> nx.Graph:
    import networkx as nx

    side = f + 1
    groups = {
        "M": range(f),
        "S1": range(f, f + side),
        "S2": range(f + side, f + 2 * side),
        "R": range(f + 2 * side, f + 2 * side + max(f - 3, 0)),
    }
    graph = nx.Graph()
    for name, members in groups.items():
        graph.add_nodes_from(members, group=name)
    graph.add_edges_from(combinations(graph, 2))
    # A node of S1 keeps min(f, 3) links to S2: with those to R, the f that a trap allows.
    graph.remove_edges_from(
        (groups["S1"][i], groups["S2"][j])
        for i in range(side)
        for j in range(side)
        if not 1 <= (j - i) % side <= min(f, 3)
    )
    graph.graph["trap"] = {name: [*groups[name]] for name in ("M", "S1", "S2")}
    return graph
