"""Files that are no graph: one line that says where and why; hostile ones neither hang nor read other files."""

from __future__ import annotations

import gzip
import io
import os
import warnings
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness import Digraph, GraphWarning, InvalidGraph, UnreadableTopology
from robustness.files import FORMATS, decode_topology, encode_topology
from robustness.files import graph6 as graph6_module

DATA = Path(__file__).parent / "data"


def decode_quietly(data: bytes, suffix: str) -> Digraph:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return decode_topology(data, suffix)


def encode_quietly(graph: object, suffix: str) -> bytes:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return encode_topology(graph, suffix)


def refusal(data: bytes | str, suffix: str = ".json") -> str:
    """Return the one-line error that ``data`` earns."""
    with pytest.raises(UnreadableTopology) as caught:
        decode_quietly(data.encode() if isinstance(data, str) else data, suffix)
    message = str(caught.value)
    assert message.isprintable()
    assert message.startswith("the data: ")
    assert len(message) < 400
    return message


class TestBadNodeLinkJson:
    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("", "line 1, column 1"),
            ('{"nodes": [\n', "line 2, column 1"),
            ('{"nodes": [], "edges": []', "line 1, column 26"),
            ("[]", "is an object"),
            ("null", "not null"),
            ("{}", "'nodes', which is missing"),
            ('{"nodes": []}', "'edges', which is missing"),
            ('{"nodes": {}, "edges": []}', "'nodes' is a list, not an object"),
            ('{"nodes": [], "edges": 7}', "'edges' is a list, not a number"),
            ('{"nodes": [], "edges": [], "links": []}', "keep one"),
            ('{"nodes": [], "nodes": [], "edges": []}', ": the key 'nodes' stands twice"),
            ('{"nodes": [{"id": 1, "id": 2}], "edges": []}', "'id' stands twice"),
            ('{"directed": 1, "nodes": [], "edges": []}', "'directed' is true or false"),
            ('{"nodes": [{}], "edges": []}', "nodes[0]: has no 'id'"),
            ('{"nodes": ["a", {"id": 1}], "edges": []}', "nodes[0]: is an object"),
            ('{"nodes": [{"id": "a"}, {"id": "a"}], "edges": []}', "nodes[1]: the id 'a' is given twice"),
            ('{"nodes": [{"id": [1]}, {"id": [1]}], "edges": []}', "nodes[1]: the id (1,) is given twice"),
            ('{"nodes": [{"id": 1.5}], "edges": []}', "nodes[0]: 'id' is an integer"),
            ('{"nodes": [{"id": NaN}], "edges": []}', "nodes[0]: 'id' is an integer"),
            ('{"nodes": [{"id": true}], "edges": []}', "not a truth value"),
            ('{"nodes": [{"id": null}], "edges": []}', "not null"),
            ('{"nodes": [{"id": {"a": 1}}], "edges": []}', "not an object"),
            ('{"nodes": [{"id": [1, null]}], "edges": []}', "nodes[0]: 'id' holds"),
            ('{"nodes": [{"id": "\\ud800"}], "edges": []}', "surrogate"),
            ('{"nodes": [{"id": 9223372036854775808}], "edges": []}', "2**63"),
            ('{"nodes": [{"id": ' + "9" * 5000 + '}], "edges": []}', "number"),
            ('{"nodes": [{"id": 1}], "edges": [{"source": 1}]}', "edges[0]: has no 'target'"),
            ('{"nodes": [{"id": 1}], "edges": [{"target": 1}]}', "edges[0]: has no 'source'"),
            ('{"nodes": [{"id": 1}], "links": [{"source": 1, "target": "1"}]}', "links[0]: '1' is no node"),
            ('{"nodes": [{"id": 1}], "edges": [[1, 1]]}', "edges[0]: is an object"),
            ("[" * 100_000, "nested too deeply"),
            ('{"nodes": [{"id": ' + "[" * 30 + "]" * 30 + '}], "edges": []}', "deep"),
        ],
    )
    def test_says_where_and_why(self, text: str, complaint: str) -> None:
        assert complaint in refusal(text)

    def test_bytes_that_are_no_text(self) -> None:
        assert "line 2: byte 0xff is not UTF-8" in refusal(b'{"nodes":\n \xff')
        assert "is not UTF-8 text: save the file as UTF-8" in refusal(gzip.compress(b"{}"))

    def test_a_byte_order_mark_is_no_error(self) -> None:
        assert decode_topology(b"\xef\xbb\xbf" + encode_topology(nx.path_graph(2))).n == 2

    @given(st.binary(max_size=60))
    def test_random_bytes_never_escape_as_another_error(self, data: bytes) -> None:
        for suffix in FORMATS:
            try:
                decode_quietly(data, suffix)
            except UnreadableTopology as problem:
                assert str(problem).isprintable()  # noqa: PT017 - some random bytes are a graph

    @pytest.mark.parametrize("suffix", sorted(FORMATS))
    def test_every_truncation_is_an_answer_or_one_line(self, suffix: str) -> None:
        data = (DATA / f"square{suffix}").read_bytes() if suffix != ".d6" else encode_quietly(nx.cycle_graph(4), suffix)
        for length in range(len(data)):
            try:
                decode_quietly(data[:length], suffix)
            except UnreadableTopology as problem:
                assert str(problem).isprintable()  # noqa: PT017 - cut edge lists are shorter edge lists

    @pytest.mark.parametrize("suffix", sorted(FORMATS))
    def test_an_empty_file_is_no_graph(self, suffix: str) -> None:
        refusal(b"", suffix)


class TestBadTextFiles:
    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("a b\nc\n", "line 2: has 1 column, but line 1 has 2"),
            ("a\nb\n", "line 1: an edge is two labels"),
            ("5 4\n1 2\n1 3\n2 4\n4 5\n", "may be a link, or the numbers of nodes and links: --skip-lines 1 if"),
            ("gain 1 2 -60\ngain 1 3 -60\n", "which may be a keyword or a node: --columns source=2,target=3"),
            ("one two three\nfour five six\n", "'three' in column 3 is neither a label nor a weight"),
            ("1 -> 2\n2 3\n", "line 2: has no arrow"),
            ("1 -> 2\n2 -- 3\n", "some lines have '->' and some '--'"),
            ("# directed\n# undirected\n1 2\n", "line 2: one comment says directed and another undirected"),
            ("0 1 5\n1 2 3\n2 0 4\n", "may be a matrix and may be 3 links"),
            ("u v\nx y\n", "u v may be a link or the names of the columns: --skip-lines 1"),
            ("node1 node2\nnode3 node4\n", "node1 node2 may be a link or the names of the columns"),
            ("1 2\n2 1\n2 3\n", "may run one way or both: '1' '2' is given in both directions and '2' '3' in one"),
            (
                "1 2 3\n2 1 3\n3 1 2\n",
                "may be links with weights and may be lists of neighbours: say which with --format",
            ),
            ("1 2 3\n2 1\n3 1 4\n4 3\n5 1 2 3\n", "line 2: has 2 columns"),
            ("1: 2\n2: 3\n3:\n", "'1' lists '2' and '2' does not list '1': --undirected"),
            ("% bip unweighted\n1 1\n1 2\n", "line 1: a comment says bipartite"),
            ("7\n1 2\n2 3\n", "line 1: 7 may be the number of nodes or of links"),
            ("# nothing\n\n", "none"),
            ("a b\n\u0000\n", "line 2"),
        ],
    )
    def test_edge_lists(self, text: str, complaint: str) -> None:
        assert complaint in refusal(text, ".edgelist")

    def test_edge_lists_as_networkx_writes_them(self) -> None:
        graph = nx.relabel_nodes(nx.petersen_graph(), str)
        nx.set_edge_attributes(graph, 3, "weight")
        for data in (True, False, ["weight"]):
            stream = io.BytesIO()
            nx.write_edgelist(graph, stream, data=data)
            assert decode_quietly(stream.getvalue(), ".txt") == Digraph.from_networkx(graph)

    def test_direction_of_an_edge_list(self) -> None:
        assert decode_quietly(b"a b\n", ".txt").arc_count == 2
        directed = decode_quietly(b"# directed\r\na b # heard by b\r\n", ".txt")
        assert list(directed.arcs()) == [(0, 1)]
        assert nx.parse_edgelist(["# directed", "a b"]).number_of_edges() == 1

    @pytest.mark.parametrize("label", [" a", "", "a\nb", "\u2003"])
    def test_labels_an_edge_list_cannot_hold(self, label: str) -> None:
        with pytest.raises(InvalidGraph, match=r"cannot hold the label|read back"):
            encode_quietly(nx.Graph([("u", label)]), ".edgelist")

    @pytest.mark.parametrize("label", ["a b", "#x", "a;b", 'say "so"', "->", "u--v", "(1", "%", "{x}", "//"])
    def test_odd_labels_come_back(self, label: str) -> None:
        graph = nx.Graph([("one", label), (label, "two")])
        assert decode_quietly(encode_quietly(graph, ".edgelist"), ".edgelist") == Digraph.from_networkx(graph)

    def test_a_first_link_that_reads_as_a_header_is_not_written(self) -> None:
        graph = nx.Graph([("source", "target"), ("x", "y")])
        with pytest.raises(InvalidGraph, match="another graph"):
            encode_quietly(graph, ".edgelist")

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("0,1\n1\n", "line 2: has 1 column, but line 1 has 2"),
            ("0,1,0,1\n1,0,1,0\n", "square, not 2 x 4"),
            ("1,2\n2,3\n", "may be a matrix and may be 2 links"),
            ("0,x,0,1\n1,0,1,0\n0,1,0,1\n1,0,1,0\n", "line 1, column 2: 'x' is not a number"),
            ("0,1,0\n\nnan,0,1\n0,1,0\n", "line 3, column 1: 'nan' may be no link"),
            ("0,inf,0\n1,0,0\n0,0,0\n", "line 1, column 2"),
            ("0,\n1,0\n", "line 1: one end of the link is empty"),
            ("0,-1,0\n1,0,1\n0,1,0\n", "line 1, column 2: '-1' may be no link"),
            ("0,1e-999,0\n1,0,1\n0,1,0\n", "line 1, column 2: '1e-999' is too small a number"),
            ("0,1_0,0,1\n1,0,1,0\n0,1,0,1\n1,0,1,0\n", "line 1, column 2: '1_0' is not a number"),
            ("\n\n", "at least one row"),
        ],
    )
    def test_csv(self, text: str, complaint: str) -> None:
        assert complaint in refusal(text, ".csv")

    def test_csv_separators(self) -> None:
        texts = ("0,1\n1,0\n", "0;1\r\n1;0\r\n", "0 1\n1 0", " 0 , 1 \n1, 0\n\n", "0\t1\n1\t0\n", "0e0,1e-3\n1.5,0.0")
        for text in texts:
            assert decode_topology(text.encode(), ".csv") == Digraph([0, 1], [(0, 1), (1, 0)])

    @pytest.mark.parametrize(
        ("data", "suffix", "complaint"),
        [
            (b"A_\nA_\n", ".g6", "line 2: a second graph follows: one of the 2 is meant, for example FILE#1"),
            (b"A", ".g6", ""),
            (b"A__", ".g6", ""),
            (b"A\x07\n", ".g6", "line 1, column 2: byte 0x07"),
            (b":A_\n", ".g6", "does not start as graph6"),
            (b"A_\n", ".s6", "does not start as sparse6"),
            (b"A_\n", ".d6", "does not start as digraph6"),
            (b":~~~~~~~~\n", ".s6", "announces 68719476735 nodes"),
            (b"~~~~~~~~\n", ".g6", "announces 68719476735 nodes"),
            (b"&~~~~~~~~\n", ".d6", "announces 68719476735 nodes"),
            (b"&D\n", ".d6", "5 nodes need 5 bytes of arcs, and 0 are there"),
            (b"&A@\n", ".d6", "padding"),
            (b"~?\n", ".g6", "ends before"),
        ],
    )
    def test_graph6_family(self, data: bytes, suffix: str, complaint: str) -> None:
        assert complaint in refusal(data, suffix)

    def test_the_announced_size_is_checked_before_anything_is_built(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(graph6_module, "NODE_LIMIT", 3)
        assert "announces 4 nodes, and at most 3" in refusal(b":C\n", ".s6")

    @pytest.mark.parametrize(
        "text", ["graph [", "nonsense", "graph [ node [ ] ]", "graph [ edge [ source 1 target 2 ] ]"]
    )
    def test_gml(self, text: str) -> None:
        refusal(text, ".gml")

    @pytest.mark.parametrize("separator", [";", ",", "\t", " "])
    def test_a_line_of_separators_alone(self, separator: str) -> None:
        for suffix in (".dat", ".csv", ".edgelist", ".adjlist"):
            refusal(f"a {{\nb{separator}\n{separator}\n{separator}{separator}\n b -- c{separator}\n}}\n", suffix)
            refusal(f'a {{\n"b"{separator}\n"b" -- "c" [4, 3]}}\n{separator}\n}}\n', suffix)

    def test_lines_of_one_word(self) -> None:
        for suffix in (".el", ".edgelist", ".txt", ".dat", ".csv", ".tsv"):
            assert "line 1" in refusal(":Cda\nda\nda\n", suffix)

    def test_gml_names_nodes_by_label_or_else_by_id(self) -> None:
        named = 'graph [ node [ id 0 label "a" ] node [ id 1 label "b" ] edge [ source 0 target 1 ] ]'
        assert decode_quietly(named.encode(), ".gml").labels == ("a", "b")
        plain = "graph [ directed 1 node [ id 4 ] node [ id 7 ] edge [ source 4 target 7 ] ]"
        assert decode_quietly(plain.encode(), ".gml") == Digraph([4, 7], [(4, 7)])
        twice = 'graph [ node [ id 0 label "a" ] node [ id 1 label "a" ] ]'
        assert decode_quietly(twice.encode(), ".gml").labels == (0, 1)
        lacking = 'graph [ node [ id 0 label "a" ] node [ id 1 ] ]'
        assert decode_quietly(lacking.encode(), ".gml").labels == (0, 1)


def npy(array: np.ndarray, *, allow_pickle: bool = False) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=allow_pickle)
    return stream.getvalue()


class TestBadArrays:
    def test_pickles_are_never_loaded(self, tmp_path: Path) -> None:
        trap = tmp_path / "sprung"

        class Trap:
            def __reduce__(self) -> tuple[object, tuple[object, ...]]:
                return (os.mkdir, (str(trap),))

        assert "numbers or truth values, not object" in refusal(npy(np.array([[Trap()]]), allow_pickle=True), ".npy")
        assert not trap.exists()

    @pytest.mark.parametrize(
        ("array", "complaint"),
        [
            (np.zeros((2, 3)), "square, not 2 x 3"),
            (np.zeros(4), "square, not 4"),
            (np.zeros(()), "square, not one number"),
            (np.zeros((2, 2, 2)), "square, not 2 x 2 x 2"),
            (np.array([["a"]]), "numbers or truth values"),
            (np.array([[1j]]), "numbers or truth values"),
            (np.array([[0.0, np.nan], [0.0, 0.0]]), "row 0, column 1: nan"),
            (np.array([[0.0, 0.0], [-np.inf, 0.0]]), "row 1, column 0: -inf"),
        ],
    )
    def test_says_what_is_wrong(self, array: np.ndarray, complaint: str) -> None:
        assert complaint in refusal(npy(array), ".npy")

    def test_nothing_is_allocated_on_the_word_of_a_header(self) -> None:
        data = npy(np.zeros((2, 2), dtype=np.uint8))
        huge = data.replace(b"(2, 2), }" + b" " * 14, b"(9999999, 9999999), }  ")
        assert huge != data
        assert "99999980000001 bytes, and 4 are there" in refusal(huge, ".npy")
        assert "there" in refusal(data[:-1], ".npy")
        assert "there" in refusal(data + b"x", ".npy")
        assert "header" in refusal(b"\x93NUMPY\x01\x00", ".npy")


ENTITY_BOMB = (
    '<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY a{i} "{f"&a{i - 1 or str()};" * 10}">' for i in range(1, 12))
    + "]><graphml><graph edgedefault='undirected'><node id='&a11;'/></graph></graphml>"
)


class TestHostileXml:
    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    @pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-8-sig"])
    def test_entity_bombs_are_refused_at_once(self, suffix: str, encoding: str) -> None:
        # Had it been read, there would be no answer: 10^11 letters.
        assert "DOCTYPE is never read" in refusal(ENTITY_BOMB.encode(encoding), suffix)

    def test_a_declared_encoding_hides_nothing(self) -> None:
        text = '<?xml version="1.0" encoding="utf-16"?><!DOCTYPE a [<!ENTITY b "c">]><a/>'
        assert "DOCTYPE" in refusal(text.encode("utf-16"), ".graphml")
        assert "line 1" in refusal('<?xml version="1.0" encoding="utf-7"?><a/>', ".graphml")
        assert "line 1" in refusal('<?xml version="1.0" encoding="no-such"?><a/>', ".graphml")

    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    @pytest.mark.parametrize(
        "door",
        [
            "<!DOCTYPE a SYSTEM '{}'>",
            "<!DOCTYPE a [<!ENTITY b SYSTEM '{}'>]>",
            "<!DOCTYPE a [<!ENTITY % b SYSTEM '{}'> %b;]>",
        ],
    )
    def test_no_file_is_read_through_an_entity(self, tmp_path: Path, suffix: str, door: str) -> None:
        secret = tmp_path / "secret"
        secret.write_text("do not read")
        message = refusal(f"<?xml version='1.0'?>{door.format(secret.as_uri())}<a>&b;</a>", suffix)
        assert "DOCTYPE" in message
        assert "do not" not in message

    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    def test_deep_nesting_is_refused(self, suffix: str) -> None:
        assert "nested more than 100 deep" in refusal("<a>" * 200_000, suffix)

    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    @pytest.mark.parametrize(
        ("body", "complaint"),
        [
            ("<node/>", "line 2: <node> has no 'id'"),
            ("<node id='a'/><node id='a'/>", "node 'a' is given twice"),
            ("<node id='a'/>\n<edge source='a'/>", "line 3: <edge> has no 'target'"),
            ("<node id='a'/><edge source='a' target='b'/>", "line 2: <edge> joins 'b', which is no node"),
            ("<node id='a'>", "line 2, column 16: mismatched tag"),
            ("</graph><graph>", "line 2: a second <graph>"),
        ],
    )
    def test_says_which_line(self, suffix: str, body: str, complaint: str) -> None:
        head = '<graphml xmlns="http://graphml.graphdrawing.org/xmlns"><graph edgedefault="directed">\n'
        assert complaint in refusal(f"{head}{body}</graph></graphml>", suffix)

    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    def test_other_xml_is_no_graph(self, suffix: str) -> None:
        refusal("<svg/>", suffix)

    @pytest.mark.parametrize("suffix", [".graphml", ".gexf"])
    @pytest.mark.parametrize("label", ["\x00", "\x1b", "\n", "\ufffe"])
    def test_labels_that_xml_cannot_hold(self, suffix: str, label: str) -> None:
        with pytest.raises(InvalidGraph, match="cannot hold the label"):
            encode_quietly(nx.Graph([("u", label)]), suffix)
