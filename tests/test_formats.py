"""Files of many kinds, as programs and people write them: each is the graph that was meant, or a refusal with the fix.

Every case holds the same graph, K4 without the link c-d ("diamond"), on the labels that the kind of file can have.
"""

from __future__ import annotations

import enum
import gzip
import io
import ipaddress
import json
import uuid
import warnings
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
import scipy.io
import scipy.sparse

import robustness as rb
from robustness import Digraph, GraphWarning, UnreadableTopology
from robustness.files import ReadingOptions, decode_topology

#: Five links on four nodes.
LINKS = [("a", "b"), ("a", "c"), ("a", "d"), ("b", "c"), ("b", "d")]
DIAMOND = nx.Graph(LINKS)
NUMBERED = nx.relabel_nodes(DIAMOND, {"a": "1", "b": "2", "c": "3", "d": "4"})
#: The ring a -> b -> c -> d -> a.
RING = nx.DiGraph([("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")])


def read(text: str | bytes, suffix: str, **options: Any) -> Digraph:
    data = text.encode() if isinstance(text, str) else text
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return decode_topology(data, suffix, options=ReadingOptions(**options))


def is_same(found: Digraph, wanted: nx.Graph) -> bool:
    """Return whether labels and arcs are those wanted, whatever the types of labels."""
    named = {(str(found.labels[u]), str(found.labels[v])) for u, v in found.arcs()}
    arcs = set(wanted.to_directed().edges) if not wanted.is_directed() else set(wanted.edges)
    return named == {(str(u), str(v)) for u, v in arcs} and set(map(str, found.labels)) == set(map(str, wanted))


def lines(shape: str, links: Any = LINKS) -> str:
    return "".join(shape.format(u, v) + "\n" for u, v in links)


N = list(NUMBERED.edges)

UNDIRECTED = {
    # Text.
    "tabs.txt": lines("{}\t{}"),
    "weights.edges": lines("{} {} 0.5", N),
    "konect.txt": "% sym unweighted\n% 5 4 4\n" + lines("{} {}", N),
    "counts.txt": "4 5\n" + lines("{} {}", N),
    "counts-from-0.txt": "4 5\n0 1\n0 2\n0 3\n1 2\n1 3\n",
    "counts-weights.txt": "4 5\n" + lines("{} {} 7", N),
    "how-many-nodes.txt": "4\n" + lines("{} {}", N),
    "colons.txt": "a: b c d\nb: a c d\nc: a b\nd: a b\n",
    "lists.txt": "a b c d\nb a c d\nc a b\nd a b\n",
    "lists.adjlist": "# networkx writes a link once\n# undirected\na b c d\nb c d\nc\nd\n",
    "sections.txt": "nodes\n" + "\n".join("abcd") + "\nlinks\n" + lines("{} {} 10Mbps"),
    "brite.txt": "nodes 4\n" + "\n".join(f"{k} 1 2" for k in range(1, 5)) + "\nedges 5\n"
                 + "".join(f"{10 + k} {u} {v} 3\n" for k, (u, v) in enumerate(N)),
    "header-of-words.txt": "Source Target\n" + lines("{} {}"),
    "quoted-commas.csv": lines('"{}","{}"'),
    "pandas.csv": ",source,target\n" + "".join(f"{k},{u},{v}\n" for k, (u, v) in enumerate(LINKS)),
    "gephi.csv": "Source,Target,Type,Id,Label,Weight\n" + lines("{},{},Undirected,0,,1.0"),
    "matrix.tsv": "\ta\tb\tc\td\na\t0\t1\t1\t1\nb\t1\t0\t1\t1\nc\t1\t1\t0\t0\nd\t1\t1\t0\t0\n",
    "matrix-of-R.txt": '"a" "b" "c" "d"\n"a" 0 1 1 1\n"b" 1 0 1 1\n"c" 1 1 0 0\n"d" 1 1 0 0\n',
    "links-of-R.txt": '"from" "to"\n' + "".join(f'"{k}" "{u}" "{v}"\n' for k, (u, v) in enumerate(LINKS, 1)),
    "matrix-blanks.csv": ",a,b,c,d\na,,1,1,1\nb,1,,1,1\nc,1,1,,\nd,1,1,,\n",
    "of-a-spreadsheet.csv": "sep=;\n" + lines("{};{}"),
    "matrix-nan.csv": "a,b,c,d\nnan,1,1,1\n1,nan,1,1\n1,1,nan,nan\n1,1,nan,nan\n",
    "market-in-text.txt": "%%MatrixMarket matrix coordinate pattern symmetric\n4 4 5\n2 1\n3 1\n4 1\n3 2\n4 2\n",
    # JSON.
    "cytoscape-list.json": json.dumps({"elements": [{"data": {"id": x}} for x in "abcd"]
                           + [{"data": {"id": f"{u}{v}", "source": u, "target": v}} for u, v in LINKS]}),
    "cytoscape-bare.json": json.dumps([{"data": {"id": x}} for x in "abcd"] + [{"data": {"source": u, "target": v}} for u, v in LINKS]),
    "cytoscape-nodes.json": json.dumps({"nodes": [{"data": {"id": x}} for x in "abcd"],
                            "edges": [{"data": {"source": u, "target": v}} for u, v in LINKS]}),
    "jgf.json": json.dumps({"graph": {"directed": False, "nodes": {x: {"label": x} for x in "abcd"},
                "edges": [{"source": u, "target": v} for u, v in LINKS]}}),
    "jgf-1.json": json.dumps({"graphs": [{"directed": False, "nodes": [{"id": x} for x in "abcd"],
                  "edges": [{"source": u, "target": v} for u, v in LINKS]}]}),
    "d3.json": json.dumps({"nodes": [{"name": x} for x in "abcd"], "links": [
               {"source": "abcd".index(u), "target": "abcd".index(v)} for u, v in LINKS]}),
    "d3-names.json": json.dumps({"nodes": [{"name": x} for x in "abcd"],
                     "links": [{"source": u, "target": v} for u, v in LINKS]}),
    "graphology.json": json.dumps({"options": {"type": "undirected"}, "nodes": [{"key": x} for x in "abcd"],
                       "edges": [{"source": u, "target": v} for u, v in LINKS]}),
    "adjacency.json": json.dumps(nx.adjacency_data(DIAMOND)),
    "dict-of-dicts.json": json.dumps(nx.to_dict_of_dicts(DIAMOND)),
    "dict-of-numbers.json": json.dumps({str(k): [int(j) for j in NUMBERED[k]] for k in NUMBERED}),
    "pairs.json": json.dumps(LINKS),
    "records.json": json.dumps([{"from": u, "to": v, "w": 1} for u, v in LINKS]),
    "plain.json": json.dumps({"nodes": list("abcd"), "edges": LINKS}),
    "vis.json": json.dumps({"nodes": [{"id": k, "label": x} for k, x in enumerate("abcd")],
                "edges": [{"from": "abcd".index(u), "to": "abcd".index(v)} for u, v in LINKS]}),
    # XML.
    "labels.gexf": '<gexf xmlns="http://gexf.net/1.3"><graph defaultedgetype="undirected"><nodes count="4">'
                   + "".join(f'<node id="{k}" label="{x}"/>' for k, x in enumerate("abcd"))
                   + "</nodes><edges>" + "".join(f'<edge source="{"abcd".index(u)}" target="{"abcd".index(v)}"/>' for u, v in LINKS)
                   + "</edges></graph></gexf>",
    "yed.graphml": '<graphml xmlns="http://graphml.graphdrawing.org/xmlns" xmlns:y="http://www.yworks.com/xml/graphml">'
                   '<key for="node" id="d6" yfiles.type="nodegraphics"/><graph edgedefault="directed">'
                   '<node id="n9" yfiles.foldertype="group"><graph id="n9:" edgedefault="directed">'
                   + "".join(f'<node id="n9::n{k}"><data key="d6"><y:ShapeNode><y:Geometry x="{k}.5" y="{k * k}"/>'
                             f'<y:NodeLabel x="1">{x}<y:LabelModel/></y:NodeLabel></y:ShapeNode></data></node>'
                             for k, x in enumerate("abcd"))
                   + "</graph></node>"
                   + "".join(f'<edge source="n9::n{"abcd".index(u)}" target="n9::n{"abcd".index(v)}"><data key="d9"><y:PolyLineEdge>'
                             '<y:Arrows source="none" target="none"/></y:PolyLineEdge></data></edge>' for u, v in LINKS)
                   + "</graph></graphml>",
    "igraph.graphml": '<graphml xmlns="http://graphml.graphdrawing.org/xmlns"><key id="v_name" for="node" attr.name="name" '
                      'attr.type="string"/><graph id="G" edgedefault="undirected">'
                      + "".join(f'<node id="n{k}"><data key="v_name">{x}</data></node>' for k, x in enumerate("abcd"))
                      + "".join(f'<edge source="n{"abcd".index(u)}" target="n{"abcd".index(v)}"/>' for u, v in LINKS)
                      + "</graph></graphml>",
    "sndlib.xml": '<network xmlns="http://sndlib.zib.de/network"><networkStructure><nodes>'
                  + "".join(f'<node id="{x}"><coordinates><x>1</x><y>2</y></coordinates></node>' for x in "abcd") + "</nodes><links>"
                  + "".join(f'<link id="{u}{v}"><source>{u}</source><target>{v}</target></link>' for u, v in LINKS)
                  + "</links></networkStructure><demands/></network>",
    # GML, DOT, Pajek.
    "yed.gml": 'Creator "yFiles"\ngraph [ directed 1 '
               + "".join(f'node [ id {k} label "{x}" graphics [ x 1.0 y 2.0 ] ] ' for k, x in enumerate("abcd"))
               + 'node [ id 9 label "box" isGroup 1 ] '
               + "".join(f'edge [ source {"abcd".index(u)} target {"abcd".index(v)} graphics [ fill "#000" ] ] ' for u, v in LINKS)
               + "]",
    "subgraph.dot": "strict graph { a -- {b; c; d} subgraph cluster_1 { node [shape=box]; b -- c; } b:port -- d }",
    "both.gv": "digraph { edge [dir=both]; " + "".join(f"{u} -> {v}; " for u, v in LINKS) + "}",
    "lists.net": '*Vertices 4\n1 "a" 0.1 0.2\n2 "b" 0.3 0.4\n3 "c"\n4 "d"\n*Edgeslist\n1 2 3 4\n2 3 4\n',
    "two-modes.net": '*Vertices 4 2\n1 "a"\n2 "b"\n3 "c"\n4 "d"\n*Edges\n1 2\n1 3\n1 4\n2 3\n2 4\n',
    "matrix.net": '*Vertices 4\n1 "a"\n2 "b"\n3 "c"\n4 "d"\n*Matrix\n0 1 1 1\n1 0 1 1\n1 1 0 0\n1 1 0 0\n*Partition x\n1\n',
}  # fmt: skip


@pytest.mark.parametrize("name", UNDIRECTED)
def test_the_diamond_in_every_dress(name: str) -> None:
    found = read(UNDIRECTED[name], Path(name).suffix)
    wanted = [DIAMOND, NUMBERED, nx.relabel_nodes(NUMBERED, {k: str(int(k) - 1) for k in NUMBERED})]
    assert any(is_same(found, graph) for graph in wanted), (found.labels, found.read_as)
    assert not found.directed
    assert found.read_as.startswith("undirected, 4 nodes, 5 links")


R = list(RING.edges)

DIRECTED = {
    "snap.txt": "# Directed graph (each unordered pair of nodes is saved once): ring.txt\n# Nodes: 4 Edges: 4\n" + lines("{}\t{}", R),
    "konect.txt": "% asym unweighted\n" + lines("{} {}", R),
    "arrows.txt": lines("{} -> {}", R),
    "gephi.csv": "Source,Target,Type\n" + lines("{},{},Directed", R),
    "jgf.json": json.dumps({"graph": {"nodes": {x: {} for x in "abcd"}, "edges": [{"source": u, "target": v} for u, v in R]}}),
    "vis.json": json.dumps({"nodes": [{"id": x} for x in "abcd"], "edges": [{"from": u, "to": v, "arrows": "to"} for u, v in R]}),
    "vis-from.json": json.dumps({"nodes": [{"id": x} for x in "abcd"], "edges": [{"from": v, "to": u, "arrows": {"from": True}} for u, v in R]}),
    "adjacency.json": json.dumps(nx.adjacency_data(RING)),
    "back.dot": "digraph { a -> b -> c; d -> c [dir=back]; a -> d [dir=back] }",
    "arcs.net": '*Network x\n*Vertices 4\n1 "a"\n2 "b"\n3 "c"\n4 "d"\n*Arcs :1 "r"\n1 2 1\n2 3 1\n*Arcslist\n3 4\n4 1\n',
    "reversed.graphml": '<graphml xmlns:y="y"><graph edgedefault="directed">' + "".join(f'<node id="{x}"/>' for x in "abcd")
                        + "".join(f'<edge source="{v}" target="{u}"><data key="d"><y:Arrows source="standard" target="none"/></data></edge>'
                                  for u, v in R) + "</graph></graphml>",
}  # fmt: skip


@pytest.mark.parametrize("name", DIRECTED)
def test_the_ring_keeps_its_direction(name: str) -> None:
    found = read(DIRECTED[name], Path(name).suffix)
    assert is_same(found, RING), (sorted(found.arcs()), found.read_as)
    assert found.directed


@pytest.mark.parametrize(
    ("name", "text", "what_decides"),
    [
        ("x.csv", "1,2\n2,3\n", "--format matrix or --format edge-list"),
        ("x.csv", "0,1,5\n1,2,3\n2,0,4\n", "--format matrix or --format edge-list"),
        ("x.txt", "0 1 5 2\n1 2 3 2\n2 0 4 2\n3 1 1 2\n", "--format matrix or --format edge-list"),
        ("x.txt", "1 2 3\n2 1 3\n3 1 2\n", "--format edge-list or --format adjacency-list"),
        ("x.txt", "1 2\n2 1\n2 3\n", "--directed or --undirected"),
        ("x.json", '{"a": ["b"], "b": ["a", "c"], "c": []}', "--directed or --undirected"),
        ("x.json", "[[0, 1], [1, 0]]", "may be a matrix and may be links"),
        ("x.json", '{"tags": ["new", "old"]}', "has no list of its own"),
        ("x.json", '{"type": "NetworkCollection", "collection": []}', "'nodes'"),
        ("x.txt", "5 4\n1 2\n1 3\n2 4\n4 5\n", "--skip-lines 1 if it is counts"),
        ("x.txt", "gain 1 2 -60\ngain 1 3 -60\n", "--columns source=2,target=3"),
        ("x.txt", "u v\nx y\n", "--skip-lines 1"),
        ("x.adjlist", "a b\nb c\nc\n", "--undirected if a link is listed once"),
        ("x.dot", "graph { a -- ", "this is not the DOT language"),
        ("x.dot", "graph { a } graph { b }", "holds 2 graphs"),
        ("x.net", "*Vertices 2\n*Arcs\n1 3\n", "line 3: '3' is no number of a vertex"),
        ("x.net", "*Vertices 2\n*Foo\n", "'\\*foo' is no heading"),
        ("x.mtx", "%%MatrixMarket matrix coordinate pattern general\n2 3 1\n1 2\n", "square, not 2 x 3"),
        ("x.mtx", "%%MatrixMarket matrix array real general\n99999999 99999999\n", "larger than what is read"),
        ("x.csv", "Id,Label\nann,Ann\nbob,Bob\n", "columns of a table of nodes"),
        ("x.csv", "hero,comic\nann,x\nann,y\nbob,x\n", "'hero' and 'comic' are ends of no other link"),
        ("x.csv", "ann,ann\nbob,bob\n", "2 of 2 rows join a node with itself"),
        ("x.graphml", "<graphml><graph>/edge&gt;<node id='1'/></graph></graphml>", "the text '/edge>' stands where"),
        ("x.g6", "A_\nA_\n", "FILE#1"),
        ("x.graphml", "<graphml><graph><hyperedge/></graph></graphml>", "hyperedge"),
    ],
)
def test_what_decides_is_named(name: str, text: str, what_decides: str) -> None:
    with pytest.raises(UnreadableTopology, match=what_decides) as caught:
        read(text, Path(name).suffix)
    assert "\n" not in str(caught.value)


class TestOptions:
    def test_a_doubt_is_decided(self) -> None:
        assert read("1,2\n2,3\n", ".csv", format="edge-list").labels == ("1", "2", "3")
        assert read("1,2\n2,3\n", ".csv", format="matrix").labels == (0, 1)
        assert read("1,2\n2,3\n", ".csv", rows="speak").labels == (0, 1)
        lists = read("1 2 3\n2 1 3\n3 1 2\n", ".txt", format="adjacency-list")
        assert (lists.n, lists.arc_count) == (3, 6)
        assert read("1 2\n2 1\n2 3\n", ".txt", directed=True).arc_count == 3
        assert read("1 2\n2 1\n2 3\n", ".txt", directed=False).arc_count == 4
        assert read("gain 1 2 -60\ngain 1 3 -60\n", ".txt", columns={"source": 2, "target": 3}).labels == (
            "1",
            "2",
            "3",
        )
        assert read("u v\nx y\n", ".txt", skip_lines=0).n == 4
        assert read("u v\nx y\n", ".txt", skip_lines=1).n == 2
        assert read("a,b,c\n1,2,3\n", ".csv", columns={"source": "b", "target": "c"}).labels == ("2", "3")

    @pytest.mark.parametrize("suffix", [".csv", ".txt", ".npy", ".npz", ".mat", ".mtx"])
    def test_rows_of_a_matrix(self, suffix: str) -> None:
        matrix = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]], dtype=np.uint8)
        stream = io.BytesIO()
        if suffix in (".csv", ".txt"):
            stream.write("\n".join(",".join(map(str, row)) for row in matrix.tolist()).encode())
        elif suffix == ".npy":
            np.save(stream, matrix)
        elif suffix == ".npz":
            scipy.sparse.save_npz(stream, scipy.sparse.coo_matrix(matrix))
        elif suffix == ".mat":
            scipy.io.savemat(stream, {"A": matrix})
        else:
            scipy.io.mmwrite(stream, scipy.sparse.coo_matrix(matrix))
        speak, hear, silent = (read(stream.getvalue(), suffix, rows=rows) for rows in ("speak", "hear", None))
        assert list(speak.arcs()) == list(silent.arcs()) == [(0, 1), (0, 2), (1, 2)]
        assert list(hear.arcs()) == [(1, 0), (2, 0), (2, 1)]
        assert "row u, column v says that v hears u" in silent.read_as
        assert "whom u hears, as asked" in hear.read_as
        both = read(stream.getvalue(), suffix, directed=False)
        assert both.arc_count == 6
        assert not both.directed

    def test_an_option_that_means_nothing_is_refused(self) -> None:
        for suffix, options in [
            (".json", {"rows": "hear"}),
            (".g6", {"label_attribute": "x"}),
            (".gml", {"columns": {}}),
        ]:
            with pytest.raises(rb.InvalidParameter, match="means nothing in"):
                read("", suffix, **options)
        with pytest.raises(rb.InvalidParameter, match="a format is one of json"):
            read("", ".json", format="jsno")

    def test_labels_by_attribute(self) -> None:
        text = UNDIRECTED["labels.gexf"]
        assert read(text, ".gexf").labels == ("a", "b", "c", "d")
        assert read(text, ".gexf", label_attribute="id").labels == ("0", "1", "2", "3")
        with pytest.raises(UnreadableTopology, match=r"has no attribute 'city' .* nodes here have: id, label"):
            read(text, ".gexf", label_attribute="city")
        twice = text.replace('label="b"', 'label="a"')
        assert read(twice, ".gexf").labels == ("0", "1", "2", "3")
        assert "labels repeat or lack, so nodes are named by id" in read(twice, ".gexf").read_as
        with pytest.raises(UnreadableTopology, match="does not tell nodes apart"):
            read(twice, ".gexf", label_attribute="label")

    def test_places_and_names_survive(self) -> None:
        graph = read(UNDIRECTED["yed.graphml"], ".graphml").to_networkx()
        assert graph.nodes["c"] == {"id": "n9::n2", "pos": (2.5, -4.0)}  # y points down in yEd

    @pytest.mark.parametrize(("editor", "y"), [("yFiles", -2.0), ("Gephi", 2.0)])
    def test_up_is_up_in_what_editors_draw(self, editor: str, y: float) -> None:
        drawn = (
            f'Creator "{editor}"\ngraph [ node [ id 0 graphics [ x 1.0 y 2.0 ] ] node [ id 1 graphics [ x 5.0 y 0 ] ] '
            "edge [ source 0 target 1 ] ]"
        )
        assert read(drawn, ".gml").places == [(1.0, y), (5.0, 0.0)]

    def test_direction_as_asked(self) -> None:
        assert read(DIRECTED["snap.txt"], ".txt", directed=False).arc_count == 8
        arcs = read(UNDIRECTED["tabs.txt"], ".txt", directed=True)
        assert (arcs.arc_count, arcs.directed) == (5, True)
        mixed = "Source,Target,Type\na,b,Directed\nb,c,Undirected\n"
        assert read(mixed, ".csv").read_as.startswith("directed, 3 nodes, 2 links; 1 of the links runs both ways")


class Colour(enum.Enum):
    RED = 1


class TestLabels:
    def test_any_label_with_a_text_that_stays(self) -> None:
        labels = [
            1,
            "1",
            1.5,
            Colour.RED,
            ipaddress.ip_address("10.0.0.1"),
            frozenset({"b", "a"}),
            (0, 2.5),
            uuid.UUID(int=1),
        ]
        graph = Digraph(labels, [(label, 1) for label in labels[1:]])
        assert {str(label) for label in graph.labels} == {
            "1", "1.5", "Colour.RED", "10.0.0.1", "{a, b}", "(0, '2.5')", "00000000-0000-0000-0000-000000000001"
        }  # fmt: skip
        assert graph.n == 8
        assert graph.labels_of(graph.ids([Colour.RED, frozenset({"a", "b"})])) == {"Colour.RED", "{a, b}"}
        path = nx.Graph([(1.5, Colour.RED), (Colour.RED, frozenset({1, 2}))])
        assert not rb.is_r_robust(path, 2)

    def test_texts_that_are_the_same_or_change(self) -> None:
        with pytest.raises(rb.InvalidGraph, match=r"the nodes 1.5 and '1.5' have the same text '1.5': relabel one"):
            Digraph([1.5, "1.5"], [])
        with pytest.raises(rb.InvalidGraph, match="object has none: give it __str__"):
            Digraph([object()], [])

    def test_numpy_integers_are_integers(self) -> None:
        for kind in (np.int8, np.int64, np.uint32):
            assert rb.is_rs_robust(DIAMOND, kind(2), s=kind(1))
            assert rb.check_rs_robustness(DIAMOND, r=kind(2)).r == 2
            assert rb.mend(nx.path_graph(3), rb.Goal(r=kind(2))).links
        with pytest.raises(rb.InvalidParameter, match="r is an integer"):
            rb.is_r_robust(DIAMOND, np.float64(2))


def test_text_in_utf_16_with_its_mark() -> None:
    assert is_same(read(("Source;Target\n" + lines("{};{}")).encode("utf-16"), ".csv"), DIAMOND)


def test_packed_files_and_many_graphs(tmp_path: Path) -> None:
    packed = tmp_path / "diamond.json.gz"
    rb.write_topology(DIAMOND, packed)
    assert packed.read_bytes()[:2] == b"\x1f\x8b"
    assert is_same(rb.read_topology(packed), DIAMOND)
    packed.write_bytes(packed.read_bytes()[:-9])
    with pytest.raises(UnreadableTopology, match="cannot be unpacked"):
        rb.read_topology(packed)
    many = tmp_path / "many.g6"
    many.write_bytes(b">>graph6<<\nA_\nC~\nBw\n")
    assert [rb.read_topology(f"{many}#{k}").n for k in (1, 2, 3)] == [2, 4, 3]
    with pytest.raises(UnreadableTopology, match=r"graphs 1\.\.3, and #4"):
        rb.read_topology(f"{many}#4")
    rows = rb.survey([many], models=[])
    assert [(Path(row.network).name, row.nodes) for row in rows] == [
        ("many.g6#1", 2),
        ("many.g6#2", 4),
        ("many.g6#3", 3),
    ]


def test_a_bomb_of_gzip_is_cut_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bomb = tmp_path / "x.json.gz"
    bomb.write_bytes(gzip.compress(b" " * 10**6))
    monkeypatch.setattr("robustness.files.front.SIZE_LIMIT", 10**5)
    with pytest.raises(UnreadableTopology, match="larger than 100000 bytes"):
        rb.read_topology(bomb)
