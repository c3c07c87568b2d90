"""Whatever bytes come in, a claim or an error of the kernel's own tree comes out, and the claim is true."""

from __future__ import annotations

import json

import networkx as nx
from hypothesis import example, given
from hypothesis import strategies as st

from certificates import CertificateError, verify
from certificates.graph import FORMAT, decode_graph, encode_graph
from robustness import Digraph
from tests.certificates.forging import certificate, holds, searched

GRAPHS = [
    Digraph.from_networkx(G)
    for G in (
        nx.wheel_graph(5),
        nx.cycle_graph(4),
        nx.empty_graph(3),
        nx.complete_graph(6),
        nx.gnp_random_graph(5, 0.6, seed=3, directed=True),
        nx.path_graph(1),
        nx.empty_graph(0),
    )
]
WHEEL = GRAPHS[0]
PROOF = certificate(WHEEL, 2, 1, body=searched(WHEEL, 2, 1))

text = st.text(st.characters(codec=None, exclude_categories=()), max_size=6)
scalars = st.none() | st.booleans() | st.integers() | st.floats() | text | st.integers(-2, 6)
json_values = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(text, inner, max_size=3), max_leaves=12
)
ids = st.lists(st.integers(-1, 6), max_size=6) | st.lists(st.integers(0, 5), max_size=6, unique=True).map(sorted)
kinds = st.sampled_from(["violation", "degree", "growth", "refutation", "derivation"])
pairs = st.lists(st.lists(st.integers(-1, 5), min_size=2, max_size=2) | ids, max_size=8)
small = st.integers(-1, 4) | st.integers()
steps = st.lists(
    st.fixed_dictionaries({"rule": st.just("weaken"), "r": small, "s": small})
    | st.fixed_dictionaries({"rule": st.sampled_from(["add-arcs", "remove-arcs"]), "arcs": pairs})
    | st.fixed_dictionaries({"rule": st.just("remove-nodes"), "nodes": ids})
    | st.fixed_dictionaries({"rule": st.just("add-node"), "hears": ids})
    | st.fixed_dictionaries({"rule": st.just("join-clique"), "size": small})
    | st.fixed_dictionaries({"rule": st.just("blow-up"), "copies": small, "cliques": st.booleans() | small})
    | st.fixed_dictionaries({"rule": text, "arcs": pairs}),
    max_size=5,
)
seeds = st.fixed_dictionaries({"nodes": small, "arcs": pairs, "r": small, "s": small})
evidence = (
    kinds.map(lambda kind: {"kind": kind})
    | st.fixed_dictionaries({"kind": kinds, "S1": ids, "S2": ids})
    | st.fixed_dictionaries({"kind": kinds, "seed": ids, "order": ids, "proof": kinds.map(lambda kind: {"kind": kind})})
    | st.fixed_dictionaries(
        {
            "kind": st.just("derivation"),
            "seed": seeds,
            "proof": kinds.map(lambda kind: {"kind": kind}),
            "steps": steps,
            "ids": ids,
        }
    )
    | json_values
)
numbers = st.integers(0, 7) | json_values
claims = st.fixed_dictionaries(
    {
        "property": st.just("rs-robust"),
        "r": numbers,
        "s": numbers,
        "verdict": st.sampled_from(["robust", "not-robust"]) | json_values,
    }
)
#: Bytes that mean something in a transcript, or everything else.
bodies = st.binary(max_size=40) | st.lists(st.integers(0, 9), max_size=40).map(bytes)


def assert_true_or_refused(graph: Digraph, data: bytes) -> None:
    try:
        claim = verify(graph.canonical_bytes(), data)
    except CertificateError as problem:
        assert len(str(problem)) < 500  # noqa: PT017  # whichever error it is, it is told in a line
        return
    assert (claim.verdict == "robust") is holds(graph, claim.r, claim.s)


@given(st.binary(max_size=200), st.binary(max_size=200))
@example(b"", b"")
@example(WHEEL.canonical_bytes(), b"\0\n")
def test_any_bytes(graph_bytes: bytes, certificate_bytes: bytes) -> None:
    try:
        verify(graph_bytes, certificate_bytes)
    except CertificateError:
        return
    raise AssertionError("no claim comes out of nothing")


@given(st.sampled_from(GRAPHS), claims | json_values, evidence, bodies)
def test_headers_of_the_right_shape(graph: Digraph, claim: object, evidence: object, body: bytes) -> None:
    header = {"format": "robustness/certificate/1", "graph": graph.sha256, "claim": claim, "evidence": evidence}
    assert_true_or_refused(graph, json.dumps(header).encode() + b"\n" + body)


@given(st.sampled_from(GRAPHS), json_values)
def test_headers_of_any_shape(graph: Digraph, header: object) -> None:
    assert_true_or_refused(graph, json.dumps(header).encode() + b"\n")


@given(st.sampled_from(GRAPHS), st.integers(1, 4), st.integers(1, 6), bodies)
@example(WHEEL, 3, 1, b"\1\0" * 10)
def test_transcripts(graph: Digraph, r: int, s: int, body: bytes) -> None:
    assert_true_or_refused(graph, certificate(graph, r, s, body=body))


@given(st.integers(0, len(PROOF)), st.integers(0, 12), st.binary(max_size=6))
def test_a_stretch_of_a_proof_replaced(start: int, length: int, new: bytes) -> None:
    assert_true_or_refused(WHEEL, PROOF[:start] + new + PROOF[start + length :])


@given(json_values | st.fixed_dictionaries({"nodes": json_values, "edges": json_values}))
def test_graphs_of_any_shape(document: object) -> None:
    for data in (json.dumps(document).encode(), json.dumps({"format": FORMAT, "x": document}).encode()):
        try:
            decode_graph(data)
        except CertificateError as problem:
            assert len(str(problem)) < 500  # noqa: PT017


labels = st.recursive(
    st.integers(-(2**63), 2**63 - 1) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3).map(tuple),
    max_leaves=4,
)


@given(st.lists(labels, max_size=6, unique_by=repr), st.data())
def test_the_canonical_bytes_of_a_graph_are_read_as_that_graph(names: list[object], data: st.DataObject) -> None:
    ends = st.sampled_from(names) if names else st.nothing()
    arcs = data.draw(st.lists(st.tuples(ends, ends).filter(lambda arc: arc[0] != arc[1]), max_size=8)) if names else []
    graph = Digraph(names, arcs)
    found = decode_graph(graph.canonical_bytes())
    assert (found.labels, found.sha256) == (graph.labels, graph.sha256)
    assert (found.n, found.arc_count) == (graph.n, graph.arc_count)
    assert encode_graph(found.labels, graph.arcs()) == graph.canonical_bytes()
