"""Reading and writing topologies: round trips, places in error messages, and hostile files."""

from __future__ import annotations

import io
import json
import os
import stat
import warnings
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness import Digraph, GraphWarning, InvalidGraph, MissingExtra, UnreadableTopology
from robustness.files import (
    FORMATS,
    decode_topology,
    encode_topology,
    read_topology,
    topohub_names,
    write_topology,
)

LINK_LISTS = [suffix for suffix, form in FORMATS.items() if form is FORMATS[".txt"]]
WRITTEN = sorted(suffix for suffix, form in FORMATS.items() if form.encode is not None)
DATA = Path(__file__).parent / "data"
#: Formats that do not say whether links run one way.
DIRECTIONLESS = {".edgelist", ".txt"}
TEXT_FORMATS = [".graphml", ".gexf", ".gml", ".edgelist", ".txt", ".dot", ".net"]

atoms = st.integers(-(2**63), 2**63 - 1) | st.text(max_size=6) | st.sampled_from([1, "1", 0, "0", "", " ", "a b", "#"])
labels = st.recursive(atoms, lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=4)
#: networkx reads nested tuples back in nodes, but not in edges.
flat_labels = atoms | st.lists(atoms, max_size=3).map(tuple)
#: Text that every text format can hold: no spaces, quotes or comment sign, nothing XML refuses, not GML's () and [].
words = st.text(st.characters(categories=("L", "N", "P", "S"), exclude_characters='#()[]"\\'), min_size=1, max_size=6)


@st.composite
def digraphs(draw: st.DrawFn, names: st.SearchStrategy = labels, min_arcs: int = 0, min_nodes: int = 0) -> Digraph:
    nodes = draw(st.lists(names, unique=True, min_size=min_nodes, max_size=7))
    directed = draw(st.booleans())
    pairs = [(u, v) for u in nodes for v in nodes if u != v]
    arcs = draw(st.lists(st.sampled_from(pairs), unique=True, min_size=min_arcs)) if pairs else []
    if not directed:
        arcs += [(v, u) for u, v in arcs]
    return Digraph(nodes, arcs, directed=directed)


def decode_quietly(data: bytes, suffix: str) -> Digraph:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return decode_topology(data, suffix)


def encode_quietly(graph: object, suffix: str) -> bytes:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        return encode_topology(graph, suffix)


class TestRoundTrips:
    @given(digraphs())
    def test_node_link_json_keeps_everything(self, graph: Digraph) -> None:
        again = decode_topology(encode_topology(graph))
        assert again == graph
        assert again.sha256 == graph.sha256
        assert again.directed == graph.directed

    @given(digraphs(flat_labels))
    def test_networkx_reads_our_json_and_we_read_its(self, graph: Digraph) -> None:
        theirs = nx.node_link_graph(json.loads(encode_topology(graph)))
        assert set(theirs) == set(graph.labels)
        for key in ("edges", "links"):
            written = json.dumps(nx.node_link_data(graph.to_networkx(), edges=key)).encode()
            assert decode_topology(written) == graph

    @pytest.mark.parametrize("suffix", TEXT_FORMATS)
    @given(graph=digraphs(words, min_nodes=2, min_arcs=1))
    def test_text_formats_keep_graphs_with_plain_text_labels(self, suffix: str, graph: Digraph) -> None:
        again = decode_quietly(encode_quietly(graph, suffix), suffix)
        expected = graph.to_networkx()
        if suffix in (".edgelist", ".txt"):
            expected.remove_nodes_from(list(nx.isolates(expected)))
        assert again == Digraph.from_networkx(expected)
        assert again.directed == graph.directed

    @pytest.mark.parametrize("suffix", TEXT_FORMATS)
    @given(graph=digraphs())
    def test_a_text_format_keeps_the_structure_or_refuses(self, suffix: str, graph: Digraph) -> None:
        try:
            data = encode_quietly(graph, suffix)
        except InvalidGraph as refused:
            assert ".json" in str(refused)  # noqa: PT017 - a refusal is one of the two right answers
            return
        texts = [str(label) for label in graph.labels]
        arcs = [(texts[u], texts[v]) for u, v in graph.arcs()]
        kept = texts if suffix not in (".edgelist", ".txt") else {end for arc in arcs for end in arc}
        assert decode_quietly(data, suffix) == Digraph(kept, arcs)

    @pytest.mark.parametrize("suffix", [".csv", ".npy", ".d6", ".mtx"])
    @given(graph=digraphs(min_nodes=1))
    def test_matrices_and_digraph6_keep_arcs_between_ids(self, suffix: str, graph: Digraph) -> None:
        again = decode_quietly(encode_quietly(graph, suffix), suffix)
        assert again == Digraph(range(graph.n), graph.arcs())

    @pytest.mark.parametrize("suffix", [".g6", ".s6"])
    @given(graph=digraphs())
    def test_graph6_and_sparse6_keep_edges_between_ids(self, suffix: str, graph: Digraph) -> None:
        if not graph.is_symmetric:
            with pytest.raises(InvalidGraph, match="undirected graphs only"):
                encode_quietly(graph, suffix)
            return
        assert decode_quietly(encode_quietly(graph, suffix), suffix) == Digraph(range(graph.n), graph.arcs())

    @pytest.mark.parametrize("n", [0, 1, 62, 63, 64, 300])
    def test_digraph6_at_every_length_of_its_size_field(self, n: int) -> None:
        graph = Digraph(range(n), [(i, i + 1) for i in range(n - 1)])
        assert decode_topology(encode_topology(graph, ".d6"), ".d6") == graph

    def test_digraph6_of_its_own_specification(self) -> None:
        # formats.txt by McKay: n = 5, arcs 0->2, 0->4, 3->1, 3->4 is "&DI?AO?".
        assert decode_topology(b">>digraph6<<&DI?AO?\n", ".d6") == Digraph(range(5), [(0, 2), (0, 4), (3, 1), (3, 4)])

    def test_equal_graphs_give_equal_bytes(self) -> None:
        one, two = nx.Graph([(1, 2), ("a", 1)]), nx.Graph([(1, "a"), (2, 1)])
        assert encode_topology(one) == encode_topology(two)


class TestFilesInData:
    @pytest.mark.parametrize("path", sorted(DATA.glob("square.*")), ids=lambda path: path.suffix)
    def test_the_square_in_every_format(self, path: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GraphWarning)
            graph = read_topology(path)
        assert (graph.n, graph.arc_count, graph.directed) == (4, 8, False)
        assert set(graph.in_degrees.tolist()) == {2}

    def test_every_format_has_its_square(self) -> None:
        assert {path.suffix for path in DATA.glob("square.*")} == set(FORMATS) - {".d6"}

    @pytest.mark.parametrize(
        "suffix", [".json", ".csv", ".npy", ".edgelist", ".d6", ".graphml", ".gexf", ".gml", ".dot", ".net", ".mtx"]
    )
    def test_an_arc_from_row_to_column_is_heard_by_the_column(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"arc{suffix}"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GraphWarning)
            write_topology(Digraph([0, 1], [(0, 1)]), path)
            graph = read_topology(path)
        assert graph.in_degrees.tolist() == [0, 1]
        assert graph.directed

    def test_matrix_rows_are_senders(self) -> None:
        with pytest.warns(GraphWarning, match="row u, column v says that v hears u"):
            assert list(decode_topology(b"0,1,0\n0,0,2.5\n0,0,0\n", ".csv").arcs()) == [(0, 1), (1, 2)]
        stream = io.BytesIO()
        np.save(stream, np.asfortranarray([[False, True], [False, False]]))
        with pytest.warns(GraphWarning, match="row u, column v says that v hears u"):
            assert list(decode_topology(stream.getvalue(), ".npy").arcs()) == [(0, 1)]

    def test_paths_and_capital_suffixes(self, tmp_path: Path) -> None:
        path = tmp_path / "TWO NODES.G6"
        path.write_bytes(b"A_\n")
        assert read_topology(str(path)) == read_topology(path) == Digraph([0, 1], [(0, 1), (1, 0)])

    def test_standard_input_is_node_link_json(self) -> None:
        assert read_topology("-", io.BytesIO((DATA / "square.json").read_bytes())).n == 4


class TestWarnings:
    @pytest.mark.parametrize("suffix", TEXT_FORMATS)
    def test_writing_a_lossy_format_warns_once_and_reading_it_where_it_is_in_doubt(self, suffix: str) -> None:
        with pytest.warns(GraphWarning, match="text") as writing:
            data = encode_topology(nx.path_graph(3), suffix)
        assert len(writing) == 1
        assert writing[0].filename == __file__
        with warnings.catch_warnings(record=True) as reading:
            warnings.simplefilter("always")
            decode_topology(data, suffix)
        # Only where the file can be read in another way: a list of links says nothing of their direction.
        assert ["--directed" in str(each.message) for each in reading] == [True] * (suffix in DIRECTIONLESS)

    def test_lost_isolated_nodes_are_counted(self) -> None:
        graph = nx.Graph([("a", "b")])
        graph.add_nodes_from(["c", "d"])
        with pytest.warns(GraphWarning, match="here 2"):
            encode_topology(graph, ".edgelist")

    @pytest.mark.parametrize("suffix", [".csv", ".npy", ".g6", ".s6", ".d6"])
    def test_lost_labels_are_told(self, suffix: str) -> None:
        with pytest.warns(GraphWarning, match="replaces the labels"):
            encode_topology(nx.Graph([("a", "b")]), suffix)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            encode_topology(nx.path_graph(2), suffix)

    def test_json_warns_of_nothing(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            decode_topology(encode_topology(nx.path_graph(3)))

    @pytest.mark.parametrize("label", ["()", "[]"])
    def test_labels_that_networkx_would_misread_in_gml(self, label: str) -> None:
        with pytest.raises(InvalidGraph, match="GML cannot hold the label"):
            encode_quietly(nx.Graph([("u", label)]), ".gml")

    def test_parallel_edges_and_self_loops_in_json(self) -> None:
        doc = {"nodes": [{"id": 1}, {"id": 2}], "edges": [{"source": 1, "target": 2}, {"source": 2, "target": 1}]}
        graph = decode_topology(json.dumps(doc).encode())
        assert graph.arc_count == 2
        assert "1 parallel edge counts once" in graph.read_as
        doc["edges"] = [{"source": 1, "target": 1}]
        graph = decode_topology(json.dumps(doc).encode())
        assert graph.arc_count == 0
        assert "1 self-loop dropped" in graph.read_as

    @pytest.mark.parametrize("suffix", TEXT_FORMATS)
    def test_labels_with_one_text_are_refused(self, suffix: str) -> None:
        with pytest.raises(InvalidGraph, match="cannot tell node 1 from node '1'"):
            encode_quietly(nx.Graph([(1, "1")]), suffix)


class TestPaths:
    def test_what_is_not_there_or_no_file(self, tmp_path: Path) -> None:
        (tmp_path / "folder.json").mkdir()
        with pytest.raises(FileNotFoundError, match="No such file"):
            read_topology(tmp_path / "gone.json")
        for path, complaint in [
            (tmp_path / "gone.json", "No such file"),
            (tmp_path / "folder.json", "is a directory"),
            ("nul\0byte.json", "null byte"),
            ("line\nbreak.json", "line break.json: cannot be read"),
            ("x" * 5000 + ".json", "too long"),
        ]:
            with pytest.raises(UnreadableTopology, match=complaint) as caught:
                read_topology(path)
            assert str(caught.value).isprintable()

    def test_permissions(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        path = tmp_path / "closed.json"
        path.write_bytes(encode_topology(nx.path_graph(2)))

        def refuse(*_: object) -> None:
            raise PermissionError(13, "Permission denied", str(path))

        # Made by hand, because a superuser may read everything.
        monkeypatch.setattr("builtins.open", refuse)
        with pytest.raises(UnreadableTopology, match=r"closed\.json: cannot be read: Permission denied"):
            read_topology(path)

    @pytest.mark.parametrize("name", ["graph", "graph.pdf", "graph.gz"])
    def test_an_unknown_suffix_names_the_known_ones(
        self, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(tmp_path)
        (tmp_path / name).touch()
        with pytest.raises(UnreadableTopology, match=r"one of \.json, .*\.d6"):
            read_topology(name)
        with pytest.raises(UnreadableTopology, match="suffix"):
            write_topology(nx.path_graph(2), name)

    @pytest.mark.parametrize(("name", "told"), [("", "no name"), ("graph", "graph"), ("graph.pdf", "graph.pdf")])
    def test_of_a_file_that_is_not_there_the_suffix_is_not_the_news(self, name: str, told: str) -> None:
        with pytest.raises(FileNotFoundError, match=f"^{told}: cannot be read: No such file or directory$"):
            read_topology(name)

    def test_endless_input_is_cut_off(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robustness.files.front.SIZE_LIMIT", 1000)
        with pytest.raises(UnreadableTopology, match="larger than 1000 bytes"), open("/dev/zero", "rb") as endless:
            read_topology("-", endless)

    def test_a_closed_standard_input(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("sys.stdin", None)
        with pytest.raises(UnreadableTopology, match=r"^standard input: is closed$"):
            read_topology("-")

    def test_errors_name_the_file(self) -> None:
        with pytest.raises(UnreadableTopology, match=r"^standard input: line 1, column 2"):
            read_topology("-", io.BytesIO(b"{"))

    @pytest.mark.parametrize("suffix", sorted(FORMATS))
    @pytest.mark.parametrize("content", [b"", b"\n \n"])
    def test_an_empty_file_is_called_empty(self, tmp_path: Path, suffix: str, content: bytes) -> None:
        """Whatever the format: each parser would miss something else."""
        place = tmp_path / f"net{suffix}"
        place.write_bytes(content)
        with pytest.raises(UnreadableTopology, match=rf"^{place}: is empty$"):
            read_topology(place)
        with pytest.raises(UnreadableTopology, match=r"^standard input: nothing came$"):
            read_topology("-", io.BytesIO(content))


class TestWriting:
    def test_a_failure_leaves_the_old_file_and_no_other(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        path = tmp_path / "graph.json"
        write_topology(nx.path_graph(2), path)
        before = path.read_bytes()

        def fail(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "replace", fail)
        with pytest.raises(OSError, match="No space left"):
            write_topology(nx.path_graph(3), path)
        assert path.read_bytes() == before
        assert list(tmp_path.iterdir()) == [path]

    def test_permissions_are_those_of_the_old_file_or_the_usual(self, tmp_path: Path) -> None:
        path, usual = tmp_path / "graph.json", tmp_path / "usual"
        usual.write_bytes(b"")
        write_topology(nx.path_graph(2), path)
        assert path.stat().st_mode == usual.stat().st_mode
        path.chmod(0o600)
        write_topology(nx.path_graph(3), path)
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert read_topology(path).n == 3

    def test_a_folder_that_is_not_there(self, tmp_path: Path) -> None:
        target = tmp_path / "gone" / "graph.json"
        with pytest.raises(FileNotFoundError) as caught:
            write_topology(nx.path_graph(2), target)
        assert caught.value.filename == str(target)

    def test_the_callers_graph_is_not_changed(self, tmp_path: Path) -> None:
        graph = nx.Graph([(1, "a"), ("a", (2, 3))], name="mine")
        before = nx.node_link_data(graph.copy())
        for suffix in set(WRITTEN) - set(LINK_LISTS):  # which cannot hold (2, 3)
            encode_quietly(graph, suffix)
        assert nx.node_link_data(graph) == before

    @pytest.mark.parametrize("suffix", WRITTEN)
    def test_empty_graph_and_one_node(self, suffix: str) -> None:
        for n in (0, 1):
            try:
                data = encode_quietly(nx.empty_graph(n), suffix)
            except InvalidGraph as refused:
                assert suffix in LINK_LISTS or (FORMATS[suffix].encode, n) == (FORMATS[".csv"].encode, 0)
                assert ".json" in str(refused)  # noqa: PT017 - which formats refuse is asserted above
            else:
                assert decode_quietly(data, suffix).n == n


class TestTopohub:
    def test_a_network_by_name(self) -> None:
        graph = read_topology("topohub:topozoo/Abilene")
        assert (graph.n, graph.arc_count) == (11, 28)
        assert set(graph.labels) == {str(i) for i in range(11)}
        assert read_topology("topohub:sndlib/di-yuan").in_degrees.min() > 0

    def test_folders_and_case_may_be_left_out_where_one_network_is_meant(self) -> None:
        assert read_topology("topohub:caida/2607") == read_topology("topohub:caida/2024-08/2607")
        assert read_topology("topohub:TOPOZOO/abilene") == read_topology("topohub:topozoo/Abilene")

    @pytest.mark.parametrize(
        ("name", "hint"),
        [
            ("topozoo/Abilen", "topohub:topozoo/Abilene"),
            ("Abilene", "topohub:topozoo/Abilene"),
            ("gabriel/0", "did you mean"),
            ("", "no one network"),
            ("../../topozoo/Abilene", "did you mean topohub:topozoo/Abilene"),
            ("/etc/passwd", "no one network"),
        ],
    )
    def test_an_unknown_name_earns_a_suggestion(self, name: str, hint: str) -> None:
        with pytest.raises(UnreadableTopology) as caught:
            read_topology(f"topohub:{name}")
        assert hint in str(caught.value)

    def test_every_name_in_the_list_is_a_graph(self) -> None:
        names = topohub_names.list_names()
        assert len(names) >= 700
        assert {name.partition("/")[0] for name in names} == {"backbone", "caida", "gabriel", "sndlib", "topozoo"}
        for name in names[::25]:
            assert read_topology(f"topohub:{name}").n > 1

    def test_without_the_package_the_fix_is_named(self, monkeypatch: pytest.MonkeyPatch) -> None:
        topohub_names.list_names.cache_clear()
        monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
        with pytest.raises(MissingExtra, match=r"pip install 'graph-robustness\[topologies\]'"):
            read_topology("topohub:topozoo/Abilene")
        topohub_names.list_names.cache_clear()


def test_a_hundred_thousand_nodes() -> None:
    n = 100_000
    tails = np.random.default_rng(0).integers(0, n, 5 * n).tolist()
    arcs = [(str(u), str(i // 5)) for i, u in enumerate(tails) if u != i // 5]
    lines = "\n".join(f"{u} {v}" for u, v in arcs)
    graph = decode_quietly(f"# directed\n{lines}".encode(), ".edgelist")
    assert graph.n == n
    assert graph.arc_count == len(set(arcs))
