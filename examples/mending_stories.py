"""The three stories of docs/mending.md, with their pictures.

python examples/mending_stories.py docs/figures
"""

from __future__ import annotations

import sys
from pathlib import Path

import networkx as nx

import robustness as rb
from robustness.constructions import build
from robustness.figures.network import draw_to_file
from robustness.mending.front import links_within


def main(folder: str) -> None:
    """Mend a platoon, a backbone and a swarm, and draw each with its new links."""
    platoon = build("platoon", n=8, k=2)
    line = {k: (float(k), 0.35 * (k % 2)) for k in platoon}
    found = rb.mend(platoon, 3)
    print(found.summary())
    draw_to_file(found.graph, found, Path(folder) / "mending-platoon.svg", pos=line)

    backbone = rb.read_topology("topohub:sndlib/polska")
    found = rb.mend(backbone, rb.Goal(survive=1, model="malicious"))
    print(found.summary())
    draw_to_file(found.graph, found, Path(folder) / "mending-backbone.svg")

    swarm = nx.random_geometric_graph(12, 0.38, seed=4)
    places = nx.get_node_attributes(swarm, "pos")
    found = rb.mend(swarm, 2, candidates=links_within(places, 0.6))
    print(found.summary())
    draw_to_file(found.graph, found, Path(folder) / "mending-swarm.svg", pos=places)


if __name__ == "__main__":
    main(sys.argv[1])
