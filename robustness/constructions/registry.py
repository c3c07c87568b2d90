"""Every family by the name users type, with the robustness known for its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from robustness.constructions import counterexamples, families, random_families
from robustness.constructions.family import Family, KnownRobustness
from robustness.definitions import largest_conceivable_r
from robustness.errors import InvalidParameter

if TYPE_CHECKING:
    import networkx as nx

__all__ = ["FAMILIES", "build", "known_robustness"]


def build(name: str, **parameters: Any) -> nx.Graph:
    """Return a new graph of the named family.

    ``G.graph["family"]`` records the name and all parameters, defaults included.

    Raises
    ------
    InvalidParameter
        For an unknown name, an unknown or missing parameter, or one out of range.

    >>> build("wheel", n=7).graph
    {'family': {'name': 'wheel', 'parameters': {'n': 7}}}
    """
    family = _family(name)
    bound = family.bind(parameters)
    graph = family.build(**bound)
    recorded = {key: list(value) if isinstance(value, tuple) else value for key, value in bound.items()}
    graph.graph["family"] = {"name": name, "parameters": recorded}
    return graph


def known_robustness(name: str, **parameters: Any) -> KnownRobustness | None:
    """Return what is known about a graph of the named family without a search, or None.

    >>> known_robustness("complete-bipartite", a=3, b=5).r
    3
    """
    family = _family(name)
    bound = family.bind(parameters)
    return family.known(**bound)


def _family(name: str) -> Family:
    if name not in FAMILIES:
        raise InvalidParameter(f"a family is one of {', '.join(FAMILIES)}, not {name!r}")
    return FAMILIES[name]


_LEMMA_V = "Lemma 1 (v)"


def _complete(n: int) -> KnownRobustness:
    return KnownRobustness(largest_conceivable_r(n), max(n, 1), _LEMMA_V)


def _path(n: int) -> KnownRobustness:
    return KnownRobustness(1, 3 if n == 3 else 2, "connected; two end segments have one node each that hears outside")


def _cycle(n: int) -> KnownRobustness:
    return _complete(3) if n == 3 else KnownRobustness(1, 5 if n == 5 else 4, "proof: robustness build cycle --help")


def _star(n: int) -> KnownRobustness:
    return KnownRobustness(1, n, "one of two disjoint sets is without the hub, and all of it hears the hub")


def _one_robust(**_: int) -> KnownRobustness:
    return KnownRobustness(1, None, "connected, and split so that every node hears at most one node across")


def _wheel(n: int) -> KnownRobustness:
    return KnownRobustness(2, n if n <= 5 else 3, "proof: robustness build wheel --help")


def _complete_bipartite(a: int, b: int) -> KnownRobustness:
    a, b = sorted((a, b))
    return KnownRobustness(min(a, (b + 1) // 2), None, "r* = min(a, ceil(b/2)), a case of the multipartite formula")


def _complete_multipartite(sizes: Sequence[int]) -> KnownRobustness:
    return KnownRobustness(families.multipartite_r(sizes), None, "max-flow min-cut over the parts")


def _cocktail_party(m: int) -> KnownRobustness:
    return KnownRobustness(m - 1, 2 * m, "one of two disjoint sets has at most m nodes")


def _circulant(n: int, k: int) -> KnownRobustness | None:
    if n == 2 * k + 1:
        return _complete(n)
    if n > 64 or k > 20:
        return None
    return KnownRobustness(k, None if n > 16 else n if n <= 2 * k + 3 else 4, "exact search for all n <= 64, k <= 20")


def _directed_circulant(n: int, k: int) -> KnownRobustness | None:
    if n == k + 1:
        return _complete(n)
    if n > 40:
        return None
    r = (k + 1) // 2 if k % 2 or n % 2 == 0 else k // 2 + 1
    return KnownRobustness(r, None, "exact search for all n <= 40")


def _platoon(n: int, k: int) -> KnownRobustness | None:
    if n <= k + 1:
        return _complete(n)
    if k == 1:
        return _path(n)
    if k > 40 or n < families.platoon_threshold(k):
        return None
    s = None if n > 16 else 2 if k == 2 else 1
    return KnownRobustness(k, s, "exact search at the least such n for k <= 40; growth beyond, Lemma 1 (vii)")


def _predecessor_platoon(n: int, predecessors: int, leaders: int) -> KnownRobustness:
    return KnownRobustness(
        largest_conceivable_r(leaders), None, "the leaders hear only each other; growth, Lemma 1 (vii)"
    )


def _grown(n: int, r: int, **_: int) -> KnownRobustness:
    return KnownRobustness(r, None, "growth, Lemma 1 (vii), and the last node has degree r")


def _sparse_robust(n: int, r: int) -> KnownRobustness:
    return KnownRobustness(r, None, "the multipartite formula, evaluated for r <= 12 and n <= 3r + 2")


def _unknown(**_: Any) -> None:
    return None


def _two_f_robust(f: int, variant: str) -> KnownRobustness:
    return KnownRobustness(2 * f, None, "exact search for f <= 3; proof and trap: robustness build two-f-robust --help")


def _five_node_figure(reading: str) -> KnownRobustness:
    return KnownRobustness(2, 2 if reading == "digraph" else 5, "exhaustive check")


#: name -> (builder, known, closed form in words)
_TABLE: dict[str, tuple[Callable[..., nx.Graph], Callable[..., KnownRobustness | None], str]] = {
    "complete": (families.complete, _complete, "r* = ceil(n/2), s_max = n"),
    "path": (families.path, _path, "r* = 1"),
    "cycle": (families.cycle, _cycle, "r* = 1 for n >= 4"),
    "star": (families.star, _star, "r* = 1, s_max = n"),
    "grid": (families.grid, _one_robust, "r* = 1"),
    "hypercube": (families.hypercube, _one_robust, "r* = 1"),
    "petersen": (families.petersen, _one_robust, "r* = 1"),
    "wheel": (families.wheel, _wheel, "r* = 2"),
    "complete-bipartite": (families.complete_bipartite, _complete_bipartite, "r* = min(a, ceil(b/2)) for a <= b"),
    "complete-multipartite": (families.complete_multipartite, _complete_multipartite, "r* by an exact formula"),
    "cocktail-party": (families.cocktail_party, _cocktail_party, "r* = m - 1, s_max = n"),
    "circulant": (families.circulant, _circulant, "r* = k for n >= 2k + 2, k + 1 for n = 2k + 1"),
    "directed-circulant": (
        families.directed_circulant,
        _directed_circulant,
        "r* = (k+1)/2 for odd k; k/2 (n even) or k/2 + 1 (n odd)",
    ),
    "platoon": (families.platoon, _platoon, "r* = k for n >= max(floor(5(k-1)/2), 3k-7)"),
    "predecessor-platoon": (families.predecessor_platoon, _predecessor_platoon, "r* = ceil(leaders/2)"),
    "sparse-robust": (families.sparse_robust, _sparse_robust, "r* = r"),
    "growth": (random_families.growth, _grown, "r* = r"),
    "preferential-attachment": (random_families.preferential_attachment, _grown, "r* = r"),
    "random-geometric": (random_families.random_geometric, _unknown, "r* has no formula"),
    "erdos-renyi": (random_families.erdos_renyi, _unknown, "r* has no formula"),
    "two-f-robust": (counterexamples.two_f_robust_counterexample, _two_f_robust, "r* = 2f, with a trap"),
    "five-node-figure": (counterexamples.five_node_figure, _five_node_figure, "r* = 2, with a trap for f = 1"),
}

#: Every family by name.
FAMILIES: Mapping[str, Family] = MappingProxyType({name: Family(name, *row) for name, row in _TABLE.items()})
