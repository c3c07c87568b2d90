"""Graphs whose search takes long enough to be stopped, and what is true of them."""

from __future__ import annotations

import networkx as nx
import numpy as np

from robustness import Digraph
from robustness.cubes.cube import CubeQuestion

#: (graph, r): r-robust, which a search of some thousand nodes refutes to the end; the second has ten times as many.
SMALL = Digraph.from_networkx(nx.gnp_random_graph(44, 0.5, seed=2)), 11
MIDDLE = Digraph.from_networkx(nx.gnp_random_graph(48, 0.5, seed=1)), 12
LONG = Digraph.from_networkx(nx.gnp_random_graph(52, 0.5, seed=1)), 13
#: A search of ten million nodes.
ENDLESS = Digraph.from_networkx(nx.gnp_random_graph(70, 0.5, seed=1)), 17


def question_of(graph: Digraph, r: int) -> CubeQuestion:
    need = np.maximum(graph.in_degrees - r + 1, 0).astype(np.int64)
    return CubeQuestion(graph.in_words, need, 0, False, 2, True)
