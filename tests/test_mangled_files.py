"""Files that say the same in another dress, and files of one kind under the suffix of another: right, or refused."""

from __future__ import annotations

import io
import random
import re
import warnings
from collections.abc import Callable
from pathlib import Path

import networkx as nx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from robustness import Digraph, GraphWarning, InvalidGraph, UnreadableTopology
from robustness.files import FORMATS, decode_topology, encode_topology

DATA = Path(__file__).parent / "data"
names = st.text("abcdefgh", min_size=2, max_size=4) | st.integers(0, 99).map(str)


@st.composite
def graphs(draw: st.DrawFn) -> nx.Graph:
    """Graphs on plain names in which every node has a link."""
    nodes = draw(st.lists(names, unique=True, min_size=2, max_size=7))
    kind = nx.DiGraph if draw(st.booleans()) else nx.Graph
    pairs = [(u, v) for u in nodes for v in nodes if u != v]
    return kind(draw(st.lists(st.sampled_from(pairs), unique=True, min_size=1)))


def decoded(data: bytes, suffix: str) -> Digraph | None:
    """Return the graph, or None for a refusal, which is one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GraphWarning)
        try:
            return decode_topology(data, suffix)
        except UnreadableTopology as problem:
            if not str(problem).isprintable():
                raise AssertionError(f"not on one line: {problem!r}") from None
            return None


def of_networkx(write: Callable[[nx.Graph, io.BytesIO], None]) -> Callable[[nx.Graph], bytes]:
    def written(graph: nx.Graph) -> bytes:
        stream = io.BytesIO()
        write(graph, stream)
        return stream.getvalue()

    return written


def ours(suffix: str) -> Callable[[nx.Graph], bytes]:
    def written(graph: nx.Graph) -> bytes:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GraphWarning)
            return encode_topology(graph, suffix)

    return written


#: Writers of text with names, ours and networkx's.
WRITERS: dict[str, tuple[str, Callable[[nx.Graph], bytes]]] = {
    "ours.json": (".json", ours(".json")),
    "ours.graphml": (".graphml", ours(".graphml")),
    "ours.gexf": (".gexf", ours(".gexf")),
    "ours.gml": (".gml", ours(".gml")),
    "ours.txt": (".txt", ours(".txt")),
    "ours.dot": (".dot", ours(".dot")),
    "ours.net": (".net", ours(".net")),
    "networkx.graphml": (".graphml", of_networkx(nx.write_graphml_xml)),
    "networkx.gexf": (".gexf", of_networkx(nx.write_gexf)),
    "networkx.gml": (".gml", of_networkx(nx.write_gml)),
    "networkx.net": (".net", of_networkx(nx.write_pajek)),
    "networkx.adjlist": (".adjlist", of_networkx(nx.write_adjlist)),
    "networkx.edgelist": (".edgelist", of_networkx(nx.write_edgelist)),
}


def mangled(text: str, suffix: str, chance: random.Random) -> str:
    """Return the text with other line ends, spaces and comments, which mean nothing in its format."""
    if suffix in (".txt", ".edgelist", ".adjlist", ".net"):
        comment = "%" if suffix == ".net" else chance.choice("#%")
        lines = [line for line in text.split("\n") if line]
        text = "\n".join(
            part for line in lines for part in ([f"{comment} made up", line] if chance.random() < 0.2 else [line])
        )
        text = re.sub(r"(?m)$", lambda _: " " * chance.randrange(3), text)
    elif suffix in (".graphml", ".gexf"):
        text = re.sub(r">\s*<", lambda _: ">" + chance.choice(["", "\n", "  ", "<!-- made up -->"]) + "<", text)
    elif suffix in (".json", ".gml", ".dot"):
        text = re.sub(r"(?m)^\s*|$", lambda _: " " * chance.randrange(3), text)
    end = chance.choice(["\n", "\r\n"])
    return (
        ("\ufeff" if chance.random() < 0.2 else "")
        + text.replace("\r", "").replace("\n", end)
        + end * chance.randrange(3)
    )


@pytest.mark.parametrize("name", WRITERS)
@given(graph=graphs(), seed=st.integers(0, 10**6))
def test_another_dress_is_the_same_graph_or_a_refusal(name: str, graph: nx.Graph, seed: int) -> None:
    suffix, write = WRITERS[name]
    try:
        data = write(graph)
    except InvalidGraph:
        return
    found = decoded(mangled(data.decode(), suffix, random.Random(seed)).encode(), suffix)
    if found is None:
        # Only what does not say which way its links run, or has labels that may be something else.
        assert suffix in (".txt", ".edgelist", ".adjlist"), data
        return
    says_direction = name not in ("networkx.adjlist", "networkx.edgelist")
    wanted = graph if says_direction or not graph.is_directed() else graph.to_undirected()
    assert found.sha256 == Digraph.from_networkx(wanted).sha256, (data, found.read_as)


@pytest.mark.parametrize("suffix", sorted(FORMATS))
def test_a_file_under_another_suffix_is_the_square_or_refused(suffix: str) -> None:
    square = nx.cycle_graph(4)
    for path in sorted(DATA.glob("square.*")):
        found = decoded(path.read_bytes(), suffix)
        if found is not None:
            assert nx.is_isomorphic(found.to_networkx().to_undirected(), square), (path.name, suffix, found.read_as)


@pytest.mark.parametrize(
    "suffix", sorted({".json", ".csv", ".txt", ".graphml", ".gml", ".net", ".mtx", ".adjlist", ".npz", ".mat"})
)
@settings(suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_a_damaged_file_ends_in_one_line_or_a_graph(suffix: str, data: st.DataObject) -> None:
    whole = (DATA / f"square{suffix}").read_bytes()
    cut = data.draw(st.integers(0, len(whole)))
    drawn = data.draw(
        st.binary(max_size=8) | st.sampled_from([b"\n", b",", b'"', b"<", b"[", b"1 2 3\n", b"-", b"*Arcs\n"])
    )
    skip = data.draw(st.integers(0, 8))
    decoded(whole[:cut] + drawn + whole[cut + skip :], suffix)
