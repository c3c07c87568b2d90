"""Where a file places its nodes: read for pictures only, since the mathematics needs no places.

Topologies drawn in an editor or taken from a collection say where their nodes stand. Nothing else depends on it, so a
file whose places cannot be read, or do not fit its graph, is drawn with a layout of ours.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Hashable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import networkx as nx

from robustness.digraph import Digraph
from robustness.figures.placement import positions_in
from robustness.files import topohub_names
from robustness.json_labels import from_json

__all__ = ["positions_of_file"]


def _node_link(text: str) -> Any:
    import json

    document = json.loads(text)
    network = nx.Graph()
    for place, node in enumerate(document["nodes"]):
        label = node.get("id", place)
        attributes = {str(key): value for key, value in node.items() if key != "id"}
        network.add_node(from_json(label), **attributes)
    return network


#: How places are read, by suffix. Only nodes and their attributes are looked at.
_READERS: Mapping[str, Callable[[str], Any]] = MappingProxyType(
    {
        ".json": _node_link,
        ".graphml": lambda text: nx.read_graphml(io.BytesIO(text.encode("utf-8"))),
        ".gexf": lambda text: nx.read_gexf(io.BytesIO(text.encode("utf-8"))),
        ".gml": lambda text: nx.parse_gml(text, label=None),
    }
)


def positions_of_file(source: str | os.PathLike[str], graph: Digraph) -> dict[Hashable, tuple[float, float]] | None:
    """Return where the source of a graph places its nodes, by label, or None when it does not say so for every node.

    Parameters
    ----------
    source : str or path
        As :func:`robustness.read_topology` took it.
    graph : Digraph
        What was read from it. Nodes are matched by label, by name, or, when neither fits, not at all.
    """
    network = _network(os.fspath(source))
    places = None if network is None else positions_in(network)
    if network is None or places is None:
        return None
    for name in ("", "label", "name", "id"):
        named = {
            str(data.get(name, node)) if name else str(node): places[node] for node, data in network.nodes(data=True)
        }
        if len(named) == len(places) and all(str(label) in named for label in graph.labels):
            return {label: named[str(label)] for label in graph.labels}
    return None


def _network(source: str) -> Any:
    """Return the network with its attributes, or None where it cannot be read again."""
    try:
        if source.startswith(topohub_names.PREFIX):
            return _node_link(topohub_names.read(source).decode("utf-8"))
        reader = _READERS.get(Path(source).suffix.lower())
        return None if reader is None or source == "-" else reader(Path(source).read_text(encoding="utf-8"))
    except Exception:  # noqa: BLE001 - of five parsers; the graph itself was read, only its places are not
        return None
