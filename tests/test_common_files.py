"""Files of the kinds that people and other programs write: each is read as its author meant it, or refused."""

from __future__ import annotations

import json
import warnings
from contextlib import suppress
from pathlib import Path

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness import Digraph, GraphWarning, UnreadableTopology
from robustness.files import FORMATS, decode_topology, read_topology

CASES = Path(__file__).parent / "data" / "topologies"
EXPECTED = json.loads((CASES / "expected.json").read_text(encoding="utf-8"))

#: Five links on four nodes, which most of the files hold; and the ring 1 -> 2 -> 3 -> 4 -> 1.
LINKS = [(1, 2), (1, 3), (2, 3), (2, 4), (3, 4)]


def quietly(path: Path) -> Digraph | None:
    """Return the graph, or None when it is refused."""
    with warnings.catch_warnings(), suppress(UnreadableTopology):
        warnings.simplefilter("ignore", GraphWarning)
        return read_topology(path)
    return None


#: What nobody can tell, and what is no graph; every other file is read.
REFUSED = {"prose.txt", "unknown-end.json", "square-pairs.csv", "square-triples.csv", "keyword-first.txt"}


@pytest.mark.parametrize("name", EXPECTED)
def test_the_graph_that_was_meant(name: str) -> None:
    want = EXPECTED[name]
    graph = quietly(CASES / name)
    assert (graph is None) == (name in REFUSED)
    if graph is None:
        assert want.get("refuse") or want.get("or_refuse")
        return
    assert not want.get("refuse")
    assert (graph.n, graph.arc_count) == (want["nodes"], want["arcs"])
    if (graph.n, graph.arc_count) == (4, 10):
        assert nx.is_isomorphic(graph.to_networkx(), nx.Graph(LINKS))
        assert "undirected, 4 nodes, 5 links" in graph.read_as
    elif graph.directed and graph.arc_count == 4:
        assert nx.is_isomorphic(graph.to_networkx(), nx.DiGraph([(1, 2), (2, 3), (3, 4), (4, 1)]))


def read(text: str, suffix: str) -> Digraph:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return decode_topology(text.encode(), suffix)


#: Ways to write the same five links as text; {0} and {1} are the ends.
SHAPES = ["{0} {1}", "{0}\t{1}", "{0}, {1}", "{0};{1}", "{0} {1} 0.5", "{0} -- {1}", "({0}, {1})", '"{0}" "{1}"',
          "{0} {1} {{'weight': 2}}", "{0} {1};", "[{0}, {1}],"]  # fmt: skip


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("before", ["", "# five links\n", "% made up\n\n", "// by hand\n"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_every_shape_of_a_link(shape: str, before: str, end: str) -> None:
    text = before + end.join(shape.format(*link) for link in LINKS) + end
    assert sorted(read(text, ".txt").arcs()) == sorted(Digraph.from_networkx(nx.Graph(LINKS)).arcs())


@pytest.mark.parametrize("said", ["# directed", "# Directed graph (each pair once)", "% digraph", "// directed"])
def test_a_comment_that_says_directed_is_heard(said: str) -> None:
    assert read(f"{said}\n1 2\n2 3\n3 1\n", ".txt").directed
    assert not read("# undirected\n1 2\n2 3\n3 1\n", ".txt").directed


HEADERS = ["Source,Target,Weight", "from,to,cost", "u,v,w", "node1,node2,delay", "SRC,DST,x", "a name,another,z"]


@pytest.mark.parametrize("header", HEADERS)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_header_is_no_link(header: str, separator: str) -> None:
    lines = [header, *(f"{u},{v},0.5" for u, v in LINKS)]
    text = "\n".join(line.replace(",", separator) for line in lines)
    for suffix in (".csv", ".txt"):
        assert read(text, suffix).arc_count == 10


def test_columns_are_found_by_name() -> None:
    text = "id,target,weight,source\n" + "".join(f"{k},{v},1,{u}\n" for k, (u, v) in enumerate(LINKS))
    assert nx.is_isomorphic(read(text, ".csv").to_networkx(), nx.Graph(LINKS))
    directed = "Source,Target,Type\n" + "".join(f"{u},{v},Directed\n" for u, v in LINKS)
    assert read(directed, ".csv").arc_count == 5
    assert read(directed + "1,4,Undirected\n", ".csv").arc_count == 7
    with pytest.raises(UnreadableTopology, match="Type is Directed or Undirected, not 'both'"):
        read(directed + "1,4,both\n", ".csv")


@given(st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6)).filter(lambda pair: pair[0] < pair[1]), min_size=4))
def test_a_matrix_in_any_dress_is_the_same_graph(links: set[tuple[int, int]]) -> None:
    graph = nx.Graph(links)
    graph.add_nodes_from(range(7))
    matrix = nx.to_numpy_array(graph, nodelist=range(7)).astype(int).tolist()
    names = [f"n{k}" for k in range(7)]
    plain = "\n".join(",".join(map(str, row)) for row in matrix)
    labelled = [",".join([name, *map(str, row)]) for name, row in zip(names, matrix, strict=True)]
    dressed = [
        plain,
        plain.replace(",", ";"),
        plain.replace(",", " "),
        plain.replace("\n", ",\n") + ",",
        plain.replace("1", "True").replace("0", "False"),
        "\n".join(",".join(f'"{cell}"' for cell in row) for row in matrix),
        ",".join(names) + "\n" + plain,
        "\n".join([",".join(["", *names]), *labelled]),
        "\n".join(" ".join(f"{cell:.4e}" for cell in row) for row in matrix),
    ]
    for text in dressed:
        for suffix in (".csv", ".txt"):
            assert sorted(read(text, suffix).arcs()) == sorted(Digraph.from_networkx(graph).arcs()), text


@pytest.mark.parametrize("suffix", sorted(FORMATS))
@given(data=st.binary(max_size=300) | st.sampled_from([path.read_bytes() for path in sorted(CASES.iterdir())]))
def test_any_bytes_are_a_graph_or_a_refusal(suffix: str, data: bytes) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        with suppress(UnreadableTopology):
            assert isinstance(decode_topology(data, suffix), Digraph)


def test_graphml_keeps_every_direction_and_every_group() -> None:
    text = """<?xml version="1.0"?><graphml xmlns="http://example.org/another"><graph edgedefault="undirected">
    <node id="a"/><node id="g"><graph edgedefault="directed"><node id="b"/><node id="c"/>
    <edge source="b" target="c"/></graph></node><edge source="a" target="b"/>
    <edge source="a" target="c" directed="1"/><edge source="c" target="a" directed="true"/></graph></graphml>"""
    graph = read(text, ".graphml")
    arcs = {(graph.labels[u], graph.labels[v]) for u, v in graph.arcs()}
    assert arcs == {("b", "c"), ("a", "b"), ("b", "a"), ("a", "c"), ("c", "a")}
    assert graph.n == 4
