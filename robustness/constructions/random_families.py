"""Random families: the seed fixes the graph. Growth carries a proof of robustness; the classic models do not.

For Erdős–Rényi and geometric graphs robustness appears together with connectivity: the threshold for being r-robust is
the threshold for being r-connected (Zhang, Fata, Sundaram 2015). That speaks about large n and promises nothing for
one graph, so no value is given for them: compute it.
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING

from robustness.constructions.families import complete, sparse_robust
from robustness.constructions.family import require

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["erdos_renyi", "growth", "preferential_attachment", "random_geometric"]


def growth(n: int, r: int, seed: int = 0) -> nx.Graph:
    """Growth construction: the sparsest r-robust graph on 2r - 1 nodes, then nodes with r random links each.

    For r >= 1 and n >= 2r - 1: ``r* = r``. Proof: a new node with in-degree at least r keeps r-robustness (Lemma 1
    (vii) with s = 1), and the last node has degree r.
    """
    require(r >= 1 and n >= 2 * r - 1, "r >= 1 and n >= 2r - 1, since r* <= ceil(n/2)", n=n, r=r)
    draw = random.Random(seed)
    graph = sparse_robust(2 * r - 1, r)
    for node in range(2 * r - 1, n):
        graph.add_edges_from((node, other) for other in draw.sample(range(node), r))
    return graph


def preferential_attachment(n: int, r: int, seed: int = 0) -> nx.Graph:
    """Preferential attachment from a robust seed: K_{2r-1}, then nodes that link to r nodes drawn by degree.

    For r >= 1 and n >= 2r - 1: ``r* = r``, by the proof of :func:`growth`. (The usual start from a star or from
    isolated nodes gives no such promise.)
    """
    require(r >= 1 and n >= 2 * r - 1, "r >= 1 and n >= 2r - 1, since r* <= ceil(n/2)", n=n, r=r)
    draw = random.Random(seed)
    graph = complete(2 * r - 1)
    ends = [node for edge in graph.edges() for node in edge] or [0]
    for node in range(2 * r - 1, n):
        chosen: set[int] = set()
        while len(chosen) < r:
            chosen.add(draw.choice(ends))
        graph.add_edges_from((node, other) for other in sorted(chosen))
        ends += [*sorted(chosen), *[node] * r]
    return graph


def random_geometric(n: int, radius: float, seed: int = 0) -> nx.Graph:
    """Random geometric (unit disk) graph: points in the unit square, joined within the radius; node attribute pos.

    No closed form; above the connectivity radius robustness appears with connectivity, for large n.
    """
    import networkx as nx

    require(n >= 0 and math.isfinite(radius) and radius >= 0, "n >= 0 and radius >= 0", n=n, radius=radius)
    draw = random.Random(seed)
    points = [(draw.random(), draw.random()) for _ in range(n)]
    graph = nx.Graph()
    graph.add_nodes_from((i, {"pos": list(point)}) for i, point in enumerate(points))
    graph.add_edges_from((i, j) for i in range(n) for j in range(i + 1, n) if math.dist(points[i], points[j]) <= radius)
    return graph


def erdos_renyi(n: int, p: float, directed: bool = False, seed: int = 0) -> nx.Graph:
    """Erdős–Rényi graph G(n, p): every edge (or arc) is present with probability p, independently.

    No closed form; robustness appears with connectivity, for large n.
    """
    import networkx as nx

    require(n >= 0 and 0 <= p <= 1, "n >= 0 and p in 0..1", n=n, p=p)
    draw = random.Random(seed)
    graph: nx.Graph = nx.DiGraph() if directed else nx.Graph()
    graph.add_nodes_from(range(n))
    pairs = ((i, j) for i in range(n) for j in range(n) if (i != j if directed else i < j))
    graph.add_edges_from(pair for pair in pairs if draw.random() < p)
    return graph
