"""The spectral lower bound r* >= ceil(lambda_2 / 2), proven in integers rather than read off a float.

Theorem. Let L be the Laplacian of an undirected graph and lambda_2 its second smallest eigenvalue. If
``lambda_2 > 2 (r - 1)``, the graph is r-robust.

Proof. Let S1, S2 be disjoint, nonempty and not r-reachable: every node of S_k has at most r - 1 neighbours outside
S_k. Put x = a on S1, -b on S2, 0 elsewhere, with a, b > 0 and a |S1| = b |S2|, so that x is orthogonal to the constant
vector. In x'Lx a link from S1 to S2 counts (a + b)^2 <= 2 a^2 + 2 b^2, one from S1 (S2) to neither a^2 (b^2).
Charge each link that leaves S1 with 2 a^2 and each that leaves S2 with 2 b^2: ``x'Lx <= 2 (r - 1) (|S1| a^2 + |S2| b^2)
= 2 (r - 1) x'x``, so lambda_2 <= 2 (r - 1). ∎

(``lambda_2 > r - 1`` is sometimes quoted and is false: K_4 has lambda_2 = 4 and r* = 2.) On a digraph the theorem is
applied to the links that run both ways; adding arcs only enlarges every X_S, so the bound holds for the whole.

What is proven. lambda_2 > mu = 2 (r - 1) exactly when the integer matrix ``M = L + J - mu I`` (J all ones, n > mu) is
positive definite. A float Cholesky factor of M is scaled by 2^k and rounded to an integer matrix R; then
``E = 4^k M - R R'`` is computed exactly, and if E is strictly diagonally dominant with a positive diagonal, M is
positive definite: 4^k M is the sum of a semidefinite and a definite matrix. The float eigenvalue and the float factor
are guesses that no conclusion depends on. The product is exact in float64 because k is chosen such that every
partial sum is an integer below 2^53, in whatever order it is summed. Where the margin is too thin for that,
fraction-free elimination in Python integers decides, up to 64 nodes; otherwise nothing is claimed.
"""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.evidence import Spectral
from robustness.results import Bound

__all__ = ["MOST_SPECTRAL_NODES", "is_positive_definite", "prove_lambda_2_above", "spectral_bound", "spectral_evidence"]

#: Cheap bounds stop here: the exact proof takes milliseconds up to this many nodes, and seconds beyond.
MOST_SPECTRAL_NODES = 150
_NODES = 600
_EXACT_NODES = 64
_EXACT_FLOAT = 2**53
#: What is known of graphs that are in use: every r and s ask for the same number.
_KNOWN: WeakKeyDictionary[Digraph, Spectral | None] = WeakKeyDictionary()
#: Below this the float lambda_2 is taken to be equal to the even integer, so that nothing is attempted.
_TIE = 1e-8


def spectral_evidence(graph: Digraph) -> Spectral | None:
    """Return the largest r that the spectral theorem proves, or None when it proves nothing.

    Cubic time and quadratic memory; graphs on more than 600 nodes are left alone.

    >>> import networkx as nx
    >>> spectral_evidence(Digraph.from_networkx(nx.complete_graph(7)))
    Spectral(r=4, mu=6)
    """
    if graph not in _KNOWN:
        _KNOWN[graph] = _evidence(graph)
    return _KNOWN[graph]


def _evidence(graph: Digraph) -> Spectral | None:
    if not 2 <= graph.n <= _NODES or graph.arc_count == 0:
        return None
    laplacian = _mutual_laplacian(graph)
    guess = float(np.linalg.eigvalsh(laplacian)[1])
    r = math.ceil((guess - _TIE) / 2)
    if r >= 1 and prove_lambda_2_above(laplacian, 2 * (r - 1)):
        return Spectral(r, 2 * (r - 1))
    # The float was not below the truth by more than a rounding error, so one step down has a wide margin.
    if r >= 2 and prove_lambda_2_above(laplacian, 2 * (r - 2)):
        return Spectral(r - 1, 2 * (r - 2))
    return None


def spectral_bound(graph: Digraph) -> Bound:
    """Return :func:`spectral_evidence` as a lower bound on r*."""
    found = spectral_evidence(graph)
    if found is None:
        return Bound(0, "none")
    return Bound(found.r, f"spectral: lambda_2 > {found.mu}, verified in integers")


def _mutual_laplacian(graph: Digraph) -> npt.NDArray[np.float64]:
    """Return the Laplacian of the links that run both ways, shape ``(n, n)``, integers held as floats."""
    adjacent = np.zeros((graph.n, graph.n))
    adjacent[graph.heads, graph.in_indices] = 1
    adjacent *= adjacent.T
    laplacian: npt.NDArray[np.float64] = np.diag(adjacent.sum(axis=1)) - adjacent
    return laplacian


def prove_lambda_2_above(laplacian: npt.NDArray[np.float64], mu: int) -> bool:
    """Return whether lambda_2 > mu was proven, for an integer Laplacian and an integer 0 <= mu < n."""
    matrix = laplacian + 1 - mu * np.eye(len(laplacian))
    if _proven_by_rounding(matrix):
        return True
    return len(matrix) <= _EXACT_NODES and is_positive_definite(matrix.astype(int).tolist())


def _proven_by_rounding(matrix: npt.NDArray[np.float64]) -> bool:
    """Return whether a rounded Cholesky factor proves the integer ``matrix`` positive definite (module docstring)."""
    n, diagonal = len(matrix), float(matrix.diagonal().max())
    # |R_ij| <= 2^k sqrt(M_ii) + 1/2 and n |R|^2 + 4^k max |M| must stay below 2^53.
    k = int((51 - math.log2(max(n * (diagonal + 1), 2))) // 2)
    margin = float(np.linalg.eigvalsh(matrix)[0]) / 2
    if k < 4 or margin <= 0:
        return False
    try:
        factor = np.rint(np.linalg.cholesky(matrix - margin * np.eye(n)) * 2.0**k)
    except np.linalg.LinAlgError:
        return False
    largest = int(np.abs(factor).max())
    if n * largest**2 + 4**k * int(np.abs(matrix).max()) >= _EXACT_FLOAT:
        return False
    rest = matrix * 4.0**k - factor @ factor.T
    off = np.abs(rest - np.diag(rest.diagonal()))
    if n * int(off.max(initial=0)) >= _EXACT_FLOAT:
        return False
    return bool((rest.diagonal() > off.sum(axis=1)).all())


def is_positive_definite(matrix: list[list[int]]) -> bool:
    """Return whether a symmetric integer matrix is positive definite, exactly (Sylvester; Bareiss 1968).

    Fraction-free elimination: after step k the pivot is the leading principal minor of order k + 1, an integer.

    >>> is_positive_definite([[2, -1], [-1, 1]]), is_positive_definite([[1, 1], [1, 1]])
    (True, False)
    """
    rows, previous = [list(row) for row in matrix], 1
    for k, pivot_row in enumerate(rows):
        pivot = pivot_row[k]
        if pivot <= 0:
            return False
        for row in rows[k + 1 :]:
            factor = row[k]
            for j in range(k + 1, len(rows)):
                row[j] = (row[j] * pivot - factor * pivot_row[j]) // previous
        previous = pivot
    return True
