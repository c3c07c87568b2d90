"""Graphs that are in memory already: matrices, graphs of igraph, dicts of neighbours, lists of links.

Each is read by the rules that files are read by, with the same note in ``graph.read_as``.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidGraph, InvalidParameter, UnreadableTopology
from robustness.files.found import Found, Link, Node, ReadingOptions, graph_of
from robustness.spelled import counted

__all__ = ["from_adjacency", "from_edges", "from_igraph", "from_neighbours"]


def from_adjacency(
    A: Any,
    *,
    rows: Literal["speak", "hear"] | None = None,
    labels: Iterable[Hashable] | None = None,
    directed: bool | None = None,
) -> Digraph:
    """Return the graph of an adjacency matrix: entry (u, v) that is not zero is the arc (u, v), so that v hears u.

    Parameters
    ----------
    A : array or sparse matrix, shape ``(n, n)``
        Of numbers or truth values: a NumPy array, a nested list, or a sparse matrix of SciPy. Weights are not used. A
        Laplacian has links where it is negative.
    rows : "speak" or "hear", optional
        ``"speak"``, the default: row u says who hears u. ``"hear"``: row u says whom u hears, as control papers write
        it. It matters for a matrix that is not symmetric.
    labels : iterable of n labels, optional
        The names of the nodes, ``0..n-1`` unless given.
    directed : bool, optional
        False: every link runs both ways.

    Raises
    ------
    InvalidGraph
        When the matrix is not square, holds no numbers, or an entry may be a link and may be none.

    Warns
    -----
    GraphWarning
        When the matrix is not symmetric and ``rows`` is not given: which way it was read.

    Notes
    -----
    Quadratic in n for an array, linear in the entries of a sparse matrix.

    >>> from_adjacency([[0, 1], [0, 0]], rows="hear").in_degrees.tolist()
    [1, 0]
    """
    from robustness.files.sparse import graph_of_matrix, is_sparse

    if not is_sparse(A):
        try:
            A = np.asarray(A)
        except ValueError:
            raise InvalidGraph("an adjacency matrix is square, and these rows have different lengths") from None
    names = None if labels is None else list(labels)
    if names is not None and len(names) != A.shape[0]:
        raise InvalidParameter(f"labels name all {counted(A.shape[0], 'node')} of the matrix, not {len(names)}")
    try:
        return graph_of_matrix(A, ReadingOptions(rows=rows, directed=directed), names)
    except UnreadableTopology as problem:
        raise InvalidGraph(str(problem)) from None


def from_edges(edges: Iterable[Sequence[Any]], *, directed: bool, nodes: Iterable[Hashable] = ()) -> Digraph:
    """Return the graph of pairs (u, v): arcs by which v hears u, or links both ways.

    Parameters
    ----------
    edges : iterable of pairs
        What stands after the first two of each, such as a weight, is not used.
    directed : bool
        There is no default: pairs alone do not say.
    nodes : iterable, optional
        Nodes beside the ends of the pairs.

    >>> from_edges([("a", "b"), ("b", "c")], directed=False).arc_count
    4
    """
    pairs = []
    for k, edge in enumerate(edges):
        if isinstance(edge, str) or len(edge) < 2:
            raise InvalidGraph(f"edge {k}: a link is a pair (u, v), not {edge!r}")
        pairs.append(Link(edge[0], edge[1]))
    labels = dict.fromkeys([*nodes, *(end for link in pairs for end in (link.source, link.target))])
    return graph_of(Found([Node(label) for label in labels], pairs, directed), ReadingOptions())


def from_neighbours(neighbours: Mapping[Hashable, Iterable[Hashable]], *, directed: bool | None = None) -> Digraph:
    """Return the graph of a dict of neighbours: v among those of u is the arc (u, v), so that v hears u.

    Parameters
    ----------
    neighbours : mapping
        Of every node an iterable of nodes: lists, sets, or the dicts of networkx.
    directed : bool, optional
        Needed only where the lists do not agree: True, then the arcs are as listed; False, then every link runs both
        ways.

    Raises
    ------
    InvalidGraph
        When a neighbour has no entry of its own, or lists do not agree and ``directed`` is not given.

    >>> from_neighbours({1: [2], 2: [1, 3], 3: [2]}).arc_count
    4
    """
    pairs = dict.fromkeys((u, v) for u, heads in neighbours.items() for v in heads)
    unknown = next((v for _, v in pairs if v not in neighbours), None)
    if unknown is not None:
        raise InvalidGraph(f"{unknown!r} is somebody's neighbour and has no entry of its own: give it one")
    alone = next(((u, v) for u, v in pairs if (v, u) not in pairs), None)
    if alone is not None and directed is None:
        raise InvalidGraph(
            f"{alone[0]!r} has the neighbour {alone[1]!r} and not the other way round: say directed=True or "
            "directed=False"
        )
    is_directed = alone is not None and bool(directed)
    links = [Link(u, v) for u, v in pairs] if is_directed else [
        Link(*pair) for pair in {frozenset((u, v)): (u, v) for u, v in pairs}.values()
    ]  # fmt: skip
    nodes = [Node(label) for label in neighbours]
    return graph_of(Found(nodes, links, is_directed), ReadingOptions())


def from_igraph(graph: Any) -> Digraph:
    """Return the digraph of a graph of igraph; its vertices are named by ``name``, else ``0..n-1``."""
    names = graph.vs["name"] if "name" in graph.vs.attributes() else [None] * graph.vcount()
    labels = names if all(names) and len(set(names)) == len(names) else range(len(names))
    ends = np.array(graph.get_edgelist(), dtype=np.int64).reshape(-1, 2)
    found = Found([Node(label) for label in labels], [], graph.is_directed(), ends=ends)
    return graph_of(found, ReadingOptions())
