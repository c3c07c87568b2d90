"""Families of graphs whose robustness is known in closed form.

Every function returns a new networkx graph on the nodes ``0..n-1``; an arc ``(u, v)`` means v hears u. Every value
named in a docstring is compared with the exact algorithms in ``tests/constructions/test_families.py``, over the
range given there; where a value has a proof, the docstring has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from robustness.constructions.family import require
from robustness.definitions import largest_conceivable_r

if TYPE_CHECKING:
    import networkx as nx

__all__ = [
    "circulant",
    "cocktail_party",
    "complete",
    "complete_bipartite",
    "complete_multipartite",
    "cycle",
    "directed_circulant",
    "grid",
    "hypercube",
    "path",
    "petersen",
    "platoon",
    "predecessor_platoon",
    "sparse_robust",
    "star",
    "wheel",
]


def complete(n: int) -> nx.Graph:
    """Complete graph K_n: everybody hears everybody.

    For n >= 1: ``r* = ceil(n/2)`` and ``s_max(r) = n`` for every ``1 <= r <= r*`` (Lemma 1 (v)). Proof: of two disjoint
    sets one has at most ``floor(n/2)`` nodes, each of which hears the other ``ceil(n/2)``, so X = S for that set.
    """
    import networkx as nx

    require(n >= 0, "n is at least 0", n=n)
    return nx.complete_graph(n)


def path(n: int) -> nx.Graph:
    """Path P_n.

    For n >= 2: ``r* = 1``; ``s_max(1) = 2`` for n = 2 and n >= 4, and 3 for n = 3. Proof: it is connected, so each of
    two disjoint sets has a node that hears one outside; two end segments of two nodes each have no more.
    """
    import networkx as nx

    require(n >= 2, "a path has at least 2 nodes", n=n)
    return nx.path_graph(n)


def cycle(n: int) -> nx.Graph:
    """Cycle C_n.

    ``r* = 2`` with ``s_max(2) = 3`` for n = 3 (it is K_3). For n >= 4: ``r* = 1``, since two disjoint paths of two
    nodes hear one node each side; ``s_max(1) = 4``, except 5 for n = 5. Proof: a set of which not every node hears
    one outside holds a path of three nodes, so it has two nodes that do; n = 5 has no two disjoint such paths, n >= 6
    has, and for n = 4 every s up to n = 4 holds.
    """
    import networkx as nx

    require(n >= 3, "a cycle has at least 3 nodes", n=n)
    return nx.cycle_graph(n)


def star(n: int) -> nx.Graph:
    """Star: node 0 joined to n - 1 leaves.

    For n >= 2: ``r* = 1`` and ``s_max(1) = n``. Proof: a set without the hub has X^1 = S, and of two sets one is
    without the hub; a leaf has degree 1.
    """
    import networkx as nx

    require(n >= 2, "a star has at least 2 nodes", n=n)
    return nx.star_graph(n - 1)


def grid(rows: int, columns: int) -> nx.Graph:
    """Grid of rows times columns nodes, node ``columns * i + j`` in row i and column j.

    For rows * columns >= 2: ``r* = 1``. Proof: connected; cut along a line, every node hears at most one node across.
    """
    import networkx as nx

    require(
        rows >= 1 and columns >= 1 and rows * columns >= 2, "a grid has at least 2 nodes", rows=rows, columns=columns
    )
    return nx.convert_node_labels_to_integers(nx.grid_2d_graph(rows, columns), ordering="sorted")


def hypercube(dimension: int) -> nx.Graph:
    """Hypercube with 2^dimension nodes, node numbers read in binary.

    For dimension >= 1: ``r* = 1``. Proof: connected; of two opposite facets every node hears one node outside.
    """
    import networkx as nx

    require(1 <= dimension <= 20, "dimension is in 1..20", dimension=dimension)
    return nx.convert_node_labels_to_integers(nx.hypercube_graph(dimension), ordering="sorted")


def petersen() -> nx.Graph:
    """Petersen graph on 10 nodes.

    ``r* = 1``: the outer and the inner 5-cycle hear one node each. (3-connected and 3-regular: connectivity is not
    robustness.)
    """
    import networkx as nx

    graph: nx.Graph = nx.petersen_graph()
    graph.graph.clear()
    return graph


def wheel(n: int) -> nx.Graph:
    """Wheel on n nodes: hub 0 joined to every node of the cycle 1..n-1.

    For n >= 4: ``r* = 2``; ``s_max(2) = n`` for n = 4 and 5 (the wheel on 5 nodes is (2,5)-robust), and 3 for n >= 6.
    Proof for n >= 6: two rim paths hear one rim node and the hub, at most, so 3 is out of reach. A set without the
    hub of which not all hear two outside holds a rim path of three, whose ends do; the other set has a node that
    does, the hub or likewise. A rim path of three, and the hub with a rim path of two, reach no more than these 3.
    """
    import networkx as nx

    require(n >= 4, "a wheel has at least 4 nodes", n=n)
    return nx.wheel_graph(n)


def complete_bipartite(a: int, b: int) -> nx.Graph:
    """Complete bipartite graph K_{a,b}.

    For ``1 <= a <= b``: ``r* = min(a, ceil(b/2))`` (the two-part case of :func:`complete_multipartite`); the order of a
    and b does not matter.
    """
    import networkx as nx

    require(a >= 1 and b >= 1, "both sides have at least 1 node", a=a, b=b)
    graph: nx.Graph = nx.complete_bipartite_graph(a, b)
    return nx.Graph(graph.edges())


def complete_multipartite(sizes: Sequence[int]) -> nx.Graph:
    """Complete multipartite graph: nodes are joined unless they are in the same part.

    For at least two parts r* is the value of :func:`multipartite_r`, an exact formula that takes ``O(n^3 m)`` steps for
    m parts; K_{a,b} and the cocktail party are the cases with a closed form.
    """
    import networkx as nx

    require(len(sizes) >= 2 and min(sizes) >= 1, "there are at least 2 parts of at least 1 node", sizes=tuple(sizes))
    graph: nx.Graph = nx.complete_multipartite_graph(*sizes)
    plain = nx.Graph()
    plain.add_nodes_from(range(sum(sizes)))
    plain.add_edges_from(graph.edges())
    return plain


def multipartite_r(sizes: Sequence[int]) -> int:
    """Return r* of the complete multipartite graph with these part sizes, at least two parts.

    Let a set S hold ``a_i`` of the ``p_i`` nodes of part i, ``|S| = x``. A node of S in part i hears
    ``n - p_i - (x - a_i)`` nodes outside S. So S is not r-reachable iff every part it touches has
    ``a_i <= p_i - (n - x - r + 1)``. Two disjoint such sets of sizes x and y exist iff x units can be spread
    under the caps ``u_i = max(0, p_i - (n - x - r + 1))``, y units under the caps ``w_i`` got from y, and both
    together under ``p_i``: a flow from two sources, which by max-flow min-cut exists iff
    ``sum min(p_i, u_i) >= x``, ``sum min(p_i, w_i) >= y`` and ``sum min(p_i, u_i + w_i) >= x + y``.

    >>> multipartite_r([3, 5]), multipartite_r([2, 2, 2, 2]), multipartite_r([1, 1, 1, 1, 1])
    (3, 3, 3)
    """
    n = sum(sizes)
    r = 1
    while r < largest_conceivable_r(n) and not _multipartite_pair_exists(sizes, n, r + 1):
        r += 1
    return r


def _multipartite_pair_exists(sizes: Sequence[int], n: int, r: int) -> bool:
    """Return whether two disjoint nonempty sets exist that are both not r-reachable; see :func:`multipartite_r`."""
    caps = {x: [min(p, max(0, p - (n - x - r + 1))) for p in sizes] for x in range(1, n)}
    possible = [x for x, cap in caps.items() if sum(cap) >= x]
    return any(
        x + y <= n and sum(min(p, u + w) for p, u, w in zip(sizes, caps[x], caps[y], strict=True)) >= x + y
        for x in possible
        for y in possible
        if x <= y
    )


def cocktail_party(m: int) -> nx.Graph:
    """Cocktail party graph K_{2,...,2} with m parts: node i does not hear node i + m, its partner.

    For m >= 2: ``r* = m - 1`` and ``s_max(m - 1) = n = 2m``. Proof: of two disjoint sets one has at most m nodes and
    each of its nodes hears at least 2m - 2 - (m - 1) = m - 1 outside; and it is not m-robust, since the sets
    of two halves that keep partners apart hear m - 1 each.
    """
    import networkx as nx

    require(m >= 2, "a cocktail party has at least 2 pairs", m=m)
    graph: nx.Graph = nx.complete_graph(2 * m)
    graph.remove_edges_from([(i, i + m) for i in range(m)])
    return graph


def circulant(n: int, k: int) -> nx.Graph:
    """Undirected circulant C_n(1..k): every node is joined to the k nodes on either side of it.

    For k >= 1 and n >= 2k + 1: ``r* = k + 1`` for n = 2k + 1 (it is complete) and k beyond, by exact search for all
    n <= 64 with k <= 20. That it is no more than k is clear: of two disjoint intervals of k + 1 nodes each node hears k
    outside. ``s_max(r*) = n`` for n <= 2k + 3, and 4 beyond (n <= 16).
    """
    import networkx as nx

    require(k >= 1 and n >= 2 * k + 1, "k >= 1 and n >= 2k + 1", n=n, k=k)
    graph = nx.Graph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from((i, (i + offset) % n) for i in range(n) for offset in range(1, k + 1))
    return graph


def directed_circulant(n: int, k: int) -> nx.DiGraph:
    """Directed circulant C_n{1..k}: node i hears the k nodes before it in a ring.

    For k >= 1 and n >= k + 1: ``r* = (k + 1) / 2`` for odd k; for even k it is ``k / 2`` when n is even and
    ``k / 2 + 1`` when n is odd, by exact search for all n <= 40. n = k + 1 is the complete digraph.
    """
    import networkx as nx

    require(k >= 1 and n >= k + 1, "k >= 1 and n >= k + 1", n=n, k=k)
    graph = nx.DiGraph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from((i, (i + offset) % n) for i in range(n) for offset in range(1, k + 1))
    return graph


def platoon(n: int, k: int) -> nx.Graph:
    """k-nearest platoon P_n^k: vehicles in a row, each joined to the k ahead of it and the k behind it.

    For k >= 2 and n > k + 1: ``r* = k`` if and only if ``n >= max(floor(5(k-1)/2), 3k - 7)``, by exact search for k
    <= 40; for k = 1 it is a path. For n <= k + 1 it is complete. In between r* < k, and no closed form is known to
    us. One search per k settles all larger n: appending a vehicle keeps k-robustness (Lemma 1 (vii)), and the first
    vehicle has degree k. The bound n >= 2k that one may expect is too small from k = 7 on: P_14^7 is 6-robust only.
    For n <= 16: ``s_max(k) = 2`` for k = 2 and 1 for k >= 3, where r* = k.
    """
    import networkx as nx

    require(k >= 1 and n >= 1, "k >= 1 and n >= 1", n=n, k=k)
    graph = nx.Graph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from((i, j) for i in range(n) for j in range(i + 1, min(n, i + k + 1)))
    return graph


def platoon_threshold(k: int) -> int:
    """Return the least n beyond k + 1 from which on the k-nearest platoon is k-robust; k >= 2, known for k <= 40."""
    return max(5 * (k - 1) // 2, 3 * k - 7)


def predecessor_platoon(n: int, predecessors: int = 1, leaders: int = 1) -> nx.DiGraph:
    """Vehicle platoon with leader links: each follower hears all leaders and its nearest predecessors.

    Vehicles ``0 .. leaders - 1`` lead and hear each other; vehicle i behind them hears all of them and vehicles ``i -
    predecessors .. i - 1``. For n >= leaders: ``r* = ceil(leaders / 2)``, whatever the number of predecessors (for
    one leader ``r* = 1``). Proof: the leaders are K_m, and every follower hears at least m vehicles already present
    (Lemma 1 (vii)); and leaders hear only leaders, so a pair that violates K_m violates the platoon. The number of
    leaders, not of predecessors, makes a one-way platoon robust.
    """
    import networkx as nx

    require(
        n >= leaders >= 1 and predecessors >= 0,
        "n >= leaders >= 1 and predecessors >= 0",
        n=n,
        predecessors=predecessors,
        leaders=leaders,
    )
    graph = nx.DiGraph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from((i, j) for i in range(leaders) for j in range(leaders) if i != j)
    for i in range(leaders, n):
        graph.add_edges_from((j, i) for j in {*range(leaders), *range(max(0, i - predecessors), i)})
    return graph


def sparse_robust(n: int, r: int) -> nx.Graph:
    """Sparsest r-robust graph on n nodes that we know: a complete multipartite graph (:func:`sparse_parts`).

    For r >= 1 and n >= 2r - 1: ``r* = r``. It has ``3r(r-1)/2`` edges for n = 2r - 1, where it is ``K_r`` joined to r
    - 1 nodes that do not hear each other, and ``r(n - r)`` edges for n >= 3r - 1, where it is ``K_{r,n-r}``. For n <=
    7 no r-robust graph has fewer edges (r >= 2; all graphs tried); for n <= 17 no complete multipartite graph has.
    """
    require(r >= 1 and n >= 2 * r - 1, "r >= 1 and n >= 2r - 1, since r* <= ceil(n/2)", n=n, r=r)
    return complete_multipartite(sparse_parts(n, r)) if n > 1 else complete(1)


def sparse_parts(n: int, r: int) -> tuple[int, ...]:
    """Return the part sizes of :func:`sparse_robust`: n - r nodes, which hear the other r, and a split of these.

    The r nodes are split into parts as large as possible, but of at most ``n - 2r + 2`` nodes, and the last part is not
    as large as that: one that would be is split once more. The first part has degree r, so r* is at most r.

    >>> [sparse_parts(n, 4) for n in (7, 8, 9, 10, 11)]
    [(3, 1, 1, 1, 1), (4, 2, 1, 1), (5, 3, 1), (6, 3, 1), (7, 4)]
    """
    largest = n - 2 * r + 2
    full, rest = divmod(r, largest)
    split = [largest] * full + ([rest] if rest else [])
    if not rest and largest > 1:
        split[-1:] = [largest - 1, 1]
    return (n - r, *split)
