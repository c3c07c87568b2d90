"""What a file says of its links beside their ends is kept, in every format that says it; no mathematics sees it."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import networkx as nx
import pytest

import robustness as rb

LINKS = {("a", "b"): "2.5", ("b", "c"): "7"}


def network() -> nx.Graph:
    graph = nx.Graph()
    graph.add_edge("a", "b", cost=2.5)
    graph.add_edge("b", "c", cost=7)
    return graph


def written(folder: Path, suffix: str) -> Path:
    file = folder / f"network.{suffix}"
    match suffix:
        case "graphml":
            nx.write_graphml_xml(network(), file)
        case "gexf":
            nx.write_gexf(network(), file)
        case "gml":
            nx.write_gml(network(), file)
        case "json":
            file.write_text(json.dumps(nx.node_link_data(network(), edges="links")))
        case "csv":
            file.write_text("cost,source,target\n2.5,a,b\n7,b,c\n")
    return file


@pytest.mark.filterwarnings("ignore::robustness.digraph.GraphWarning")
@pytest.mark.parametrize("suffix", ["graphml", "gexf", "gml", "json", "csv"])
def test_attributes_of_links_are_kept(tmp_path: Path, suffix: str) -> None:
    graph = rb.read_topology(written(tmp_path, suffix))
    said = {link: str(attributes["cost"]) for link, attributes in graph.link_attributes.items()}
    assert said == LINKS
    assert copy.deepcopy(graph).link_attributes == graph.link_attributes


@pytest.mark.filterwarnings("ignore::robustness.digraph.GraphWarning")
def test_columns_without_names_are_numbered(tmp_path: Path) -> None:
    file = tmp_path / "network.edges"
    file.write_text("a b 2.5\nb c 7\n")
    graph = rb.read_topology(file)
    assert {link: attributes["3"] for link, attributes in graph.link_attributes.items()} == LINKS


def test_an_edge_of_graphml_and_its_nodes_have_attributes_of_their_own(tmp_path: Path) -> None:
    file = tmp_path / "network.graphml"
    file.write_text(
        '<graphml><key id="d0" for="node" attr.name="label"/><key id="d1" for="edge" attr.name="label"/>'
        '<key id="d2" for="all" attr.name="note"/><graph edgedefault="undirected">'
        '<node id="0"><data key="d0">here</data><data key="d2">n</data></node>'
        '<node id="1"><data key="d0">there</data></node>'
        '<edge source="0" target="1"><data key="d1">fibre</data><data key="d2">e</data></edge></graph></graphml>'
    )
    graph = rb.read_topology(file)
    assert "nodes are named by their label" in graph.read_as
    assert graph.labels == ("here", "there")
    assert dict(graph.link_attributes) == {("here", "there"): {"label": "fibre", "note": "e"}}


def test_graphs_that_come_from_no_file_have_none() -> None:
    assert not rb.Digraph.from_networkx(network()).link_attributes
