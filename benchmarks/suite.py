"""The instances: families of graphs at sizes from 10 to 200, each told by a builder's name and plain arguments.

A recipe instead of a graph: it fits on a line of JSON, a child process builds the graph from it, and anybody can
rebuild the one instance that a table shows. Random families take networkx's own generators with the suite's seed, so
that ``gnp(40, 0.5, seed=1)`` is the graph that everybody who writes ``nx.gnp_random_graph(40, 0.5, seed=1)`` gets.
"""

from __future__ import annotations

import itertools
import random
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import robustness as rb
from robustness.constructions import circulant, known_robustness, platoon, preferential_attachment
from robustness.digraph import GraphLike

__all__ = ["BUILDERS", "FAMILIES", "Instance", "build", "instances"]


@dataclass(frozen=True)
class Instance:
    """One graph: its family, the builder with its arguments, and r* where a proof gives it."""

    family: str
    builder: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    known_r: int | None = None

    @property
    def name(self) -> str:
        """Return the recipe as a call, for example ``gnp(n=40, p=0.5, seed=1)``."""
        return f"{self.builder}({', '.join(f'{key}={value}' for key, value in self.arguments.items())})"


def build(instance: Instance) -> rb.Digraph:
    """Return a new graph; nothing that an algorithm derives from a graph is computed yet."""
    with warnings.catch_warnings():
        # Real topologies have parallel links; that they count once is no news here.
        warnings.simplefilter("ignore", rb.GraphWarning)
        graph = BUILDERS[instance.builder](**instance.arguments)
        return graph if isinstance(graph, rb.Digraph) else rb.Digraph.from_networkx(graph)


def gnp(n: int, p: float, seed: int) -> GraphLike:
    import networkx as nx

    return nx.gnp_random_graph(n, p, seed=seed)


def directed_gnp(n: int, p: float, seed: int) -> GraphLike:
    import networkx as nx

    return nx.gnp_random_graph(n, p, seed=seed, directed=True)


def regular(n: int, k: int, seed: int) -> GraphLike:
    import networkx as nx

    return nx.random_regular_graph(k, n, seed=seed)


def hearing_earlier(n: int, k: int, seed: int) -> GraphLike:
    """Return a digraph in which every node hears k nodes before it, drawn by lot; the first k + 1 hear each other."""
    draw = random.Random(seed)
    first = [(u, v) for u in range(k + 1) for v in range(k + 1) if u != v]
    later = ((other, node) for node in range(k + 1, n) for other in draw.sample(range(node), k))
    return rb.Digraph(range(n), itertools.chain(first, later))


def gnm(n: int, m: int, seed: int) -> GraphLike:
    import networkx as nx

    return nx.gnm_random_graph(n, m, seed=seed)


def regular_with_clumps(n: int, k: int, seed: int) -> GraphLike:
    """Return a random k-regular graph with two cliques of k + 1 more nodes, each node linked to one regular node."""
    import networkx as nx

    graph = nx.random_regular_graph(k, n - 2 * (k + 1), seed=seed)
    draw = random.Random(seed)
    for start in (n - 2 * (k + 1), n - (k + 1)):
        clump = range(start, start + k + 1)
        graph.add_edges_from(itertools.combinations(clump, 2))
        graph.add_edges_from(zip(clump, draw.sample(range(n - 2 * (k + 1)), k + 1), strict=True))
    return graph


def unit_disk(n: int, radius: float, seed: int) -> GraphLike:
    import networkx as nx

    return nx.random_geometric_graph(n, radius, seed=seed)


def paley(q: int) -> GraphLike:
    """Return the Paley graph of a prime q = 1 mod 4, the Paley tournament of a prime q = 3 mod 4."""
    import networkx as nx

    graph = nx.paley_graph(q)
    return graph.to_undirected() if q % 4 == 1 else graph


def topohub(name: str) -> GraphLike:
    from robustness.files import read_topology

    return read_topology(f"topohub:{name}")


#: Every builder by the name that recipes use.
BUILDERS: Mapping[str, Callable[..., GraphLike]] = {
    "gnp": gnp,
    "directed_gnp": directed_gnp,
    "regular": regular,
    "regular_with_clumps": regular_with_clumps,
    "hearing_earlier": hearing_earlier,
    "gnm": gnm,
    "unit_disk": unit_disk,
    "preferential_attachment": preferential_attachment,
    "circulant": circulant,
    "platoon": platoon,
    "paley": paley,
    "topohub": topohub,
}


def _gnp_family(p: float, sizes: tuple[int, ...]) -> Callable[[str, int], Iterator[Instance]]:
    def make(family: str, seed: int) -> Iterator[Instance]:
        return (Instance(family, "gnp", {"n": n, "p": p, "seed": seed}) for n in sizes)

    return make


def _directed(family: str, seed: int) -> Iterator[Instance]:
    for p, sizes in ((0.3, (10, 20, 30, 40, 60)), (0.5, (10, 20, 30, 40, 50))):
        yield from (Instance(family, "directed_gnp", {"n": n, "p": p, "seed": seed}) for n in sizes)


def _regular(family: str, seed: int) -> Iterator[Instance]:
    for k, sizes in ((6, (10, 20, 40, 80, 120)), (10, (20, 40, 60, 80))):
        yield from (Instance(family, "regular", {"n": n, "k": k, "seed": seed}) for n in sizes)


def _unit_disk(family: str, seed: int) -> Iterator[Instance]:
    for n, radius in ((10, 0.6), (20, 0.5), (40, 0.4), (60, 0.6), (120, 0.4), (200, 0.3)):
        yield Instance(family, "unit_disk", {"n": n, "radius": radius, "seed": seed})


def _preferential_attachment(family: str, seed: int) -> Iterator[Instance]:
    for n, r in ((10, 3), (20, 4), (40, 6), (80, 8), (120, 8), (200, 8)):
        yield _with_known_r(family, "preferential_attachment", {"n": n, "r": r, "seed": seed})


def _circulant(family: str, seed: int) -> Iterator[Instance]:
    for n, k in ((10, 3), (20, 4), (40, 6), (60, 8), (80, 10), (200, 10)):
        yield _with_known_r(family, "circulant", {"n": n, "k": k})


def _platoon(family: str, seed: int) -> Iterator[Instance]:
    for n, k in ((10, 3), (20, 4), (40, 6), (80, 8), (120, 8), (200, 8)):
        yield _with_known_r(family, "platoon", {"n": n, "k": k})


def _paley(family: str, seed: int) -> Iterator[Instance]:
    return (Instance(family, "paley", {"q": q}) for q in (11, 13, 17, 19, 23, 29, 31, 37, 41, 43))


#: Those of the 707 with the greatest r*, found by a sweep; most of the others have a leaf, so r* <= 1.
_ROBUST_TOPOLOGIES = ("sndlib/dfn-bwin", "sndlib/di-yuan", "sndlib/pdh", "topozoo/Globalcenter", "caida/2024-08/2607")


def _topohub(family: str, seed: int) -> Iterator[Instance]:
    from robustness.files.topohub_names import list_names

    names = [name for name in list_names() if name not in _ROBUST_TOPOLOGIES]
    random.Random(seed).shuffle(names)
    shuffled = (Instance(family, "topohub", {"name": name}) for name in names)
    yield from (Instance(family, "topohub", {"name": name}) for name in _ROBUST_TOPOLOGIES)
    yield from itertools.islice((each for each in shuffled if 10 <= build(each).n <= 200), 7)


def _with_known_r(family: str, builder: str, arguments: dict[str, Any]) -> Instance:
    known = known_robustness(builder.replace("_", "-"), **arguments)
    return Instance(family, builder, arguments, None if known is None else known.r)


#: Every family by the name that ``--family`` takes.
FAMILIES: Mapping[str, Callable[[str, int], Iterator[Instance]]] = {
    "gnp-.1": _gnp_family(0.1, (10, 20, 40, 60, 80, 100, 150)),
    "gnp-.3": _gnp_family(0.3, (10, 20, 30, 40, 60)),
    "gnp-.5": _gnp_family(0.5, (10, 15, 20, 25, 30, 40)),
    "gnp-.8": _gnp_family(0.8, (10, 20, 30, 40, 50, 60)),
    "directed-gnp": _directed,
    "regular": _regular,
    "unit-disk": _unit_disk,
    "preferential-attachment": _preferential_attachment,
    "circulant": _circulant,
    "platoon": _platoon,
    "paley": _paley,
    "topohub": _topohub,
}


def instances(seed: int = 1, families: tuple[str, ...] = tuple(FAMILIES), largest: int | None = None) -> list[Instance]:
    """Return the suite for a seed: the named families, and of them the graphs on at most ``largest`` nodes."""
    chosen = [instance for family in families for instance in FAMILIES[family](family, seed)]
    return [each for each in chosen if largest is None or build(each).n <= largest]
