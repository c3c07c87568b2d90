"""Graphs with a known robustness: families, Lemma 1 operations with their guarantees, and counterexamples.

>>> from robustness.constructions import build, known_robustness
>>> known_robustness("wheel", n=7).r
2
"""

from robustness.constructions.certified import certify_derivation
from robustness.constructions.counterexamples import FIVE_NODE_READINGS, five_node_figure, two_f_robust_counterexample
from robustness.constructions.families import (
    circulant,
    cocktail_party,
    complete,
    complete_bipartite,
    complete_multipartite,
    cycle,
    directed_circulant,
    grid,
    hypercube,
    path,
    petersen,
    platoon,
    predecessor_platoon,
    sparse_robust,
    star,
    wheel,
)
from robustness.constructions.family import Family, KnownRobustness
from robustness.constructions.guarantee import RULES, Guarantee, Guaranteed
from robustness.constructions.operations import (
    add_arcs,
    add_node,
    blow_up,
    grow,
    guaranteed,
    join_clique,
    remove_in_arcs,
    remove_nodes,
    replay,
    union,
    weaken,
)
from robustness.constructions.random_families import erdos_renyi, growth, preferential_attachment, random_geometric
from robustness.constructions.registry import FAMILIES, build, known_robustness

__all__ = [
    "FAMILIES",
    "FIVE_NODE_READINGS",
    "RULES",
    "Family",
    "Guarantee",
    "Guaranteed",
    "KnownRobustness",
    "add_arcs",
    "add_node",
    "blow_up",
    "build",
    "certify_derivation",
    "circulant",
    "cocktail_party",
    "complete",
    "complete_bipartite",
    "complete_multipartite",
    "cycle",
    "directed_circulant",
    "erdos_renyi",
    "five_node_figure",
    "grid",
    "grow",
    "growth",
    "guaranteed",
    "hypercube",
    "join_clique",
    "known_robustness",
    "path",
    "petersen",
    "platoon",
    "predecessor_platoon",
    "preferential_attachment",
    "random_geometric",
    "remove_in_arcs",
    "remove_nodes",
    "replay",
    "sparse_robust",
    "star",
    "two_f_robust_counterexample",
    "union",
    "weaken",
    "wheel",
]
