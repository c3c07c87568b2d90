"""One thing wrong in good data, and the one error that says so: the graph's format, and the certificate's."""

from __future__ import annotations

import json
from typing import Any

import networkx as nx
import pytest

from certificates import (
    CertificateError,
    MalformedCertificate,
    MalformedGraph,
    Misuse,
    RejectedCertificate,
    VerifiedClaim,
    graph,
    masks,
    stream,
    verify,
)
from certificates.graph import decode_graph, label_key
from robustness import Digraph
from tests.certificates.forging import certificate, read, searched, spell, varint

WHEEL = Digraph.from_networkx(nx.wheel_graph(5))
CANONICAL = WHEEL.canonical_bytes()
BODY = searched(WHEEL, 2, 1)
PROOF = certificate(WHEEL, 2, 1, body=BODY)
PAIR = {"kind": "violation", "S1": [1, 2], "S2": [3, 4]}
SPLIT = certificate(WHEEL, 3, 1, "not-robust", PAIR)
GROWN = {"kind": "growth", "seed": [0, 1, 2], "order": [3, 4], "proof": {"kind": "degree"}}

#: Values of every type, some of them out of every bound.
VALUES: list[Any] = [
    *(None, True, False, -1, 0, 7, 2**31 + 1, 2**63, 10**19, 1.0, 2.5, "", "1", "robust", "refutation", "\ud800"),
    *([], [0], [0, 0], [5], [-1], [True], [1.0], [[0]], ["0"], {}, {"kind": "degree"}, {"S1": []}),
]


def header_of(data: bytes) -> tuple[dict[str, Any], bytes]:
    line, body = data.split(b"\n", 1)
    return json.loads(line), body


def bound(header: object, body: bytes = b"") -> bytes:
    return json.dumps(header).encode() + b"\n" + body


def test_the_good_data_are_good() -> None:
    for data, verdict, r, evidence in ((PROOF, "robust", 2, "refutation"), (SPLIT, "not-robust", 3, "violation")):
        claim = verify(CANONICAL, data)
        assert (claim.verdict, claim.r, claim.s, claim.evidence) == (verdict, r, 1, evidence)
        assert (claim.sha256, claim.nodes, claim.arcs) == (WHEEL.sha256, 5, 16)
    grown = verify(CANONICAL, certificate(WHEEL, 2, 1, evidence=GROWN))
    assert (grown.evidence, grown.tree_nodes) == ("growth", 0)
    assert "is (2,1)-robust" in str(grown)
    assert "is not (3,1)-robust" in str(verify(CANONICAL, SPLIT))


@pytest.mark.parametrize("arguments", [(CANONICAL, PROOF.decode()), (CANONICAL.decode(), PROOF), (None, b"")])
def test_misuse(arguments: tuple[Any, Any]) -> None:
    with pytest.raises(Misuse, match="two bytes objects"):
        verify(*arguments)
    assert issubclass(Misuse, TypeError)


class TestHeader:
    @pytest.mark.parametrize("data", [PROOF, SPLIT, certificate(WHEEL, 2, 1, evidence=GROWN)])
    def test_every_field_removed_added_renamed_or_given_another_value(self, data: bytes) -> None:
        header, body = header_of(data)
        claim = verify(CANONICAL, data)
        tried = 0
        for path in paths(header):
            place, key = container(header, path)
            kept = place[key]
            changed: list[Any] = [value for value in VALUES if type(value) is not type(kept) or value != kept]
            if isinstance(kept, list):
                changed += [kept[1:], [*kept, 4], kept[::-1]]
            if isinstance(kept, dict):
                changed += [{**kept, "more": 1}, {name.upper(): value for name, value in kept.items()}]
            for value in changed:
                place[key] = value
                tried += 1
                assert_claims_at_most(header, body, claim)
            del place[key]
            assert_claims_at_most(header, body, claim)
            place.insert(key, kept) if isinstance(place, list) else place.update({key: kept})
        assert tried > 200

    @pytest.mark.parametrize(
        ("data", "what"),
        [
            (b"", "one line of JSON"),
            (PROOF.split(b"\n")[0], "one line of JSON"),
            (b"\n", "not JSON"),
            (b"{}\n", "exactly the keys"),
            (b"[]\n", "exactly the keys"),
            (b"\xff\n", "not UTF-8"),
            (b"[" * 200_000 + b"\n", "nested too deeply"),
            (b'{"a":' * 200_000 + b"\n", "nested too deeply"),
            (PROOF.replace(b'"r": 2', b'"r": NaN'), "NaN"),
            (PROOF.replace(b'"r": 2', b'"r": -Infinity'), "-Infinity"),
            (PROOF.replace(b'"r": 2', b'"r": 2.0'), "integers"),
            (PROOF.replace(b'"r": 2', b'"r": 2e0'), "integers"),
            (PROOF.replace(b'"r": 2', b'"r": 1e999999999'), "integers"),
            (PROOF.replace(b'"r": 2', b'"r": ' + b"2" * 21), "does not have"),
            (PROOF.replace(b'"r": 2', b'"r": ' + b"2" * 1_000_000), "does not have"),
            (PROOF.replace(b'"r": 2', b'"r": true'), "integers"),
            (PROOF.replace(b'"r": 2', b'"r": 0'), "lies in 1..2147483648"),
            (PROOF.replace(b'"r": 2', b'"r": 4294967296'), "lies in 1..2147483648"),
            (PROOF.replace(b'"s": 1', b'"s": 6'), "1..5"),
            (PROOF.replace(b'"s": 1', b'"s": 0'), "1..5"),
            (PROOF.replace(b'"r": 2', b'"r": 2, "r": 2'), "repeats a key"),
            (PROOF.replace(b'"r": 2', b'"r": 2, "t": 2'), "exactly the keys"),
            (PROOF.replace(b"certificate/1", b"certificate/2"), "the format is"),
            (PROOF.replace(b'"robustness/certificate/1"', b"[" * 400 + b"]" * 400), "type list"),
            (PROOF.replace(b"rs-robust", b"rs-round"), "the property"),
            (PROOF.replace(b'"robust"', b'"maybe"'), "a verdict is"),
            (PROOF.replace(b'"robust"', b'"not-robust"'), "no evidence of kind"),
            (PROOF.replace(b'"refutation"', b'"violation"'), "no evidence of kind"),
            (PROOF.replace(b'"refutation"', b'"belief"'), "no evidence of kind"),
            (PROOF.replace(b'"refutation"', b"7.5"), "with a 'kind'"),
            (PROOF.replace(b'{"kind": "refutation"}', b'"refutation"'), "with a 'kind'"),
            (PROOF.replace(b'"refutation"', b'"degree"'), "bytes follow"),
            (SPLIT + b"\n", "1 bytes follow"),
            (SPLIT.replace(b"[1, 2]", b"[2, 1]"), "ascending"),
            (SPLIT.replace(b"[1, 2]", b"[1, 1]"), "ascending"),
            (SPLIT.replace(b"[1, 2]", b"[1, 5]"), "ids in 0..4"),
            (SPLIT.replace(b"[1, 2]", b"[1, true]"), "ids in 0..4"),
            (SPLIT.replace(b"[1, 2]", b'{"1": 2}'), "ids in 0..4"),
        ],
        ids=lambda value: str(value)[:60],
    )
    def test_one_thing_wrong(self, data: bytes, what: str) -> None:
        with pytest.raises((MalformedCertificate, RejectedCertificate), match=what):
            verify(CANONICAL, data)

    @pytest.mark.parametrize(
        ("data", "what"),
        [
            (certificate(WHEEL, 3, 1, "not-robust", PAIR | {"S2": [0, 3]}), "does not violate"),
            (certificate(WHEEL, 3, 1, "not-robust", PAIR | {"S1": []}), "nonempty and disjoint"),
            (certificate(WHEEL, 3, 1, "not-robust", PAIR | {"S1": [1, 3]}), "nonempty and disjoint"),
            (certificate(WHEEL, 2, 1, "not-robust", PAIR), "does not violate"),
            (certificate(WHEEL, 3, 1, evidence={"kind": "degree"}), "least in-degree 3 is below"),
            (certificate(WHEEL, 4, 1, evidence={"kind": "degree"}), "at most ceil"),
            (certificate(WHEEL, 2, 1, evidence=GROWN | {"order": [3]}), "every node once"),
            (certificate(WHEEL, 2, 1, evidence=GROWN | {"order": [3, 3]}), "every node once"),
            (certificate(WHEEL, 2, 2, evidence=GROWN), r"hears 2 .* below r \+ s - 1 = 3"),
            (certificate(WHEEL, 1, 4, evidence=GROWN), "a seed of 3 nodes"),
            (certificate(WHEEL, 2, 1, evidence=GROWN | {"seed": [0, 1], "order": [3, 2, 4]}), "in-degree 1 is below"),
        ],
    )
    def test_a_false_proof_is_rejected_and_not_malformed(self, data: bytes, what: str) -> None:
        with pytest.raises(RejectedCertificate, match=what):
            verify(CANONICAL, data)

    def test_another_graph(self) -> None:
        other = Digraph.from_networkx(nx.complete_graph(5))
        with pytest.raises(RejectedCertificate, match=f"another graph.*{other.sha256}"):
            verify(other.canonical_bytes(), PROOF)

    @pytest.mark.parametrize("kind", ["violation", "growth", {"kind": "degree"}, 2])
    def test_a_seed_is_proven_directly(self, kind: object) -> None:
        proof = kind if isinstance(kind, dict) else {"kind": kind}
        with pytest.raises(MalformedCertificate, match="1 bytes follow" if isinstance(kind, dict) else "a proof is of"):
            verify(CANONICAL, certificate(WHEEL, 2, 1, evidence=GROWN | {"proof": proof}, body=b"\0"))

    def test_on_one_node_the_convention_decides(self) -> None:
        one = Digraph(["a"], [])
        assert verify(one.canonical_bytes(), certificate(one, 1, 1, evidence={"kind": "degree"})).r == 1
        assert verify(one.canonical_bytes(), certificate(one, 1, 1, body=b"\1\0")).tree_nodes == 3
        for r in (2, 5):
            with pytest.raises(RejectedCertificate, match="at most ceil"):
                verify(one.canonical_bytes(), certificate(one, r, 1, body=b"\1\0"))

    def test_no_claim_is_about_the_empty_graph(self) -> None:
        empty = Digraph([], [])
        with pytest.raises(MalformedCertificate, match=r"1\.\.n"):
            verify(empty.canonical_bytes(), certificate(empty, 1, 1, evidence={"kind": "degree"}))

    def test_size_limits(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(stream, "MAX_CERTIFICATE_BYTES", len(PROOF) - 1)
        with pytest.raises(MalformedCertificate, match="at most"):
            verify(CANONICAL, PROOF)
        monkeypatch.setattr(stream, "MAX_CERTIFICATE_BYTES", len(PROOF))
        monkeypatch.setattr(stream, "MAX_HEADER_BYTES", PROOF.index(b"\n"))
        with pytest.raises(MalformedCertificate, match="one line"):
            verify(CANONICAL, PROOF)
        monkeypatch.setattr(stream, "MAX_HEADER_BYTES", len(PROOF))
        monkeypatch.setattr(masks, "MAX_NODES", 4)
        with pytest.raises(MalformedCertificate, match="at most 4 nodes"):
            verify(CANONICAL, PROOF)
        monkeypatch.setattr(masks, "MAX_NODES", 5)
        monkeypatch.setattr(masks, "MAX_LOOKS", 10)
        with pytest.raises(MalformedCertificate, match="at most 10 looks"):
            verify(CANONICAL, PROOF)
        monkeypatch.setattr(graph, "MAX_GRAPH_BYTES", len(CANONICAL) - 1)
        with pytest.raises(MalformedGraph, match="at most"):
            verify(CANONICAL, PROOF)

    def test_messages_stay_short(self) -> None:
        """A label of lone surrogates, however long, is shown in part."""
        document = b'{"arcs":[],"format":"robustness/graph/1","labels":["' + b"\\ud800" * 10_000 + b'"]}'
        with pytest.raises(MalformedGraph, match="lone surrogates") as caught:
            verify(document, certificate(WHEEL, 1, 1))
        assert len(str(caught.value)) < 500


class TestBody:
    @pytest.mark.parametrize(
        ("body", "what"),
        [
            (b"", "ends in the middle"),
            (BODY[:-1], "ends in the middle"),
            (BODY + b"\0", "1 bytes follow"),
            (b"\0" + BODY, "PROPAGATE without"),
            (b"\1\x80\0" + BODY[2:], "shortest spelling: 0"),
            (b"\x81\0" + BODY[1:], "shortest spelling: 1"),
            (b"\1\5", "out of range"),
            (b"\1\xff\xff\xff\xff\xff\xff", "out of range"),
            (b"\1\xff", "ends in the middle"),
            (b"\x0a\0", "out of range"),
            (b"\2\0\1\1", "not symmetric"),
            (b"\2\0\2\0", "already decided: node 0"),
            (b"\4\0\4\0", "already decided: node 0"),
            (b"\6\0\1", "not different satisfied nodes"),
            (b"\2\0\7\0\0", "no candidate"),
            (b"\2\0\7\1\2", "not different satisfied nodes"),
            (b"\2\0\2\1\x09\2\0\0", "not different satisfied nodes"),
        ],
    )
    def test_one_thing_wrong(self, body: bytes, what: str) -> None:
        with pytest.raises(RejectedCertificate, match=f"refutation, byte .*{what}"):
            verify(CANONICAL, certificate(WHEEL, 2, 1, body=body))

    def test_the_false_child_of_a_branch_that_is_no_root_is_not_symmetric(self) -> None:
        with pytest.raises(RejectedCertificate, match="tree node 3: ROOT in a state that is not symmetric"):
            verify(CANONICAL, certificate(WHEEL, 1, 2, body=b"\2\0\1\1"))

    def test_an_exclusion_holds_and_is_propagated(self) -> None:
        """A transcript with EXCLUDE steps; without one of its PROPAGATEs; and with an exclusion that does not hold."""
        found = Digraph.from_networkx(nx.gnp_random_graph(14, 0.6, seed=1))
        tokens = read(searched(found, 4, 1))
        assert {token[0] for token in tokens} >= {0, 1, 7}
        data = found.canonical_bytes()
        assert verify(data, certificate(found, 4, 1, body=spell(tokens))).tree_nodes > 1
        place = next(i for i, token in enumerate(tokens) if token == (0,) and tokens[i + 1][0] < 6)
        for what, wrong in (
            ("without a PROPAGATE", tokens[:place] + tokens[place + 1 :]),
            ("do not exclude|no candidate|not different", [(7, 13, 0) if t[0] == 7 else t for t in tokens]),
        ):
            with pytest.raises(RejectedCertificate, match=what):
                verify(data, certificate(found, 4, 1, body=spell(wrong)))

    def test_numbers_of_two_bytes(self) -> None:
        cycle = Digraph.from_networkx(nx.cycle_graph(200))
        assert verify(cycle.canonical_bytes(), certificate(cycle, 1, 1, body=varint(1) + varint(150))).tree_nodes == 3


class TestGraph:
    def test_node_link_is_brought_into_canonical_form(self) -> None:
        for G in (nx.wheel_graph(5), nx.MultiDiGraph([(0, 1), (0, 1), (1, 1), ("0", 1)]), nx.grid_2d_graph(2, 2)):
            expected = {(u, v) for u, v in G.edges() if u != v}
            expected |= set() if G.is_directed() else {(v, u) for u, v in expected}
            for edges in ("edges", "links"):
                document = nx.node_link_data(G, edges=edges) | {"more": [1.5, None]}
                found = decode_graph(json.dumps(document).encode())
                names = found.labels
                assert set(names) == set(G)
                assert {(names[u], names[v]) for v, heard in enumerate(found.hears) for u in heard} == expected

    def test_labels_one_and_one_in_quotes(self) -> None:
        graphs = [Digraph([1, "1", 2], [(1, 2)]), Digraph([1, "1", 2], [("1", 2)])]
        assert graphs[0].sha256 != graphs[1].sha256
        for one in graphs:
            again = decode_graph(one.canonical_bytes())
            assert again.sha256 == one.sha256
            assert again.labels == (1, 2, "1")

    def test_canonical_order_of_labels(self) -> None:
        labels = [-(2**63), -1, 0, 2**63 - 1, "", "A", "a", "\u00e9", "\U0001f600", (), (0,), (0, 0), (0, "a"), ("a",)]
        assert sorted(labels[5:] + labels[:5], key=label_key) == labels

    @pytest.mark.parametrize(
        ("wrong", "what"),
        [
            (b"", "not JSON"),
            (b"[]", "JSON object"),
            (b'"' + b"a" * 10, "not JSON"),
            (b"\xef\xbb\xbf{}", "not JSON"),
            (b"{}", "node-link document has lists"),
            (b'{"nodes":[],"edges":[],"directed":1}', "node-link document has lists"),
            (b'{"nodes":[],"edges":[],"links":[]}', "not both"),
            (b'{"nodes":[1],"edges":[]}', "an 'id'"),
            (b'{"nodes":[{}],"edges":[]}', "an 'id'"),
            (b'{"nodes":[{"id":0}],"edges":[{"source":0}]}', "an 'id'"),
            (b'{"nodes":[{"id":0}],"edges":[{"source":0,"target":1}]}', "two nodes of the document"),
            (b'{"nodes":[{"id":0},{"id":0}],"edges":[]}', "distinct"),
            (b'{"nodes":[{"id":1.5}],"edges":[]}', "not Opaque"),
            (b'{"nodes":[{"id":null}],"edges":[]}', "not NoneType"),
            (b'{"nodes":[{"id":true}],"edges":[]}', "not bool"),
            (b'{"nodes":[{"id":{}}],"edges":[]}', "not dict"),
            (b'{"nodes":[{"id":9223372036854775808}],"edges":[]}', "-2\\*\\*63"),
            (b'{"nodes":[{"id":"\\ud800"}],"edges":[]}', "lone surrogates"),
            (b'{"nodes":[{"id":[[[[[[[[[[0]]]]]]]]]]}],"edges":[]}', "8 deep"),
            (CANONICAL + b"\n", "canonical spelling"),
            (CANONICAL.replace(b"[0,1]", b"[0, 1]"), "canonical spelling"),
            (CANONICAL.replace(b'"format"', b'"\\u0066ormat"'), "canonical spelling"),
            (CANONICAL.replace(b"[0,1,2", b"[-0,1,2"), "canonical spelling"),
            (CANONICAL.replace(b'"labels":[0,1,2,3,4]', b'"labels":[0,1,2,3,4],"more":0'), "exactly the keys"),
            (CANONICAL.replace(b'"labels":[0,1,2,3,4]', b'"labels":{}'), "labels is a list"),
            (CANONICAL.replace(b'"labels":[0,1,2,3,4]', b'"labels":[0,1,2,4,3]'), "ascending canonical"),
            (CANONICAL.replace(b'"labels":[0,1,2,3,4]', b'"labels":[0,1,2,3,3]'), "ascending canonical"),
            (CANONICAL.replace(b'"labels":[0,1,2,3,4]', b'"labels":[0,1,2,3,4.0]'), "not Opaque"),
            (CANONICAL.replace(b"[[0,1],", b"[[1,0],"), "strictly ascending"),
            (CANONICAL.replace(b"[[0,1],", b"[[0,1],[0,1],"), "strictly ascending"),
            (CANONICAL.replace(b"[[0,1],", b"[[0,0],[0,1],"), "two different nodes"),
            (CANONICAL.replace(b"[[0,1],", b"[[-1,1],[0,1],"), "two different nodes"),
            (CANONICAL.replace(b"[4,3]]", b"[4,5]]"), "two different nodes"),
            (CANONICAL.replace(b"[4,3]]", b"[4,3,2]]"), "pair of ids"),
            (CANONICAL.replace(b"[4,3]]", b"[4,true]]"), "pair of ids"),
            (b'{"arcs":{},"format":"robustness/graph/1","labels":[]}', "list of pairs"),
            (CANONICAL.replace(b"graph/1", b"graph/2"), "node-link"),
        ],
        ids=lambda value: str(value)[-60:],
    )
    def test_one_thing_wrong(self, wrong: bytes, what: str) -> None:
        assert wrong != CANONICAL
        with pytest.raises(MalformedGraph, match=what):
            decode_graph(wrong)

    def test_errors_of_the_graph_come_through_the_one_entry(self) -> None:
        with pytest.raises(MalformedGraph):
            verify(b"{}", PROOF)


def test_the_tree_of_errors() -> None:
    assert issubclass(MalformedGraph, MalformedCertificate)
    for error in (Misuse, MalformedCertificate, RejectedCertificate):
        assert error.__mro__[1] is CertificateError
    assert issubclass(MalformedCertificate, ValueError)
    assert issubclass(RejectedCertificate, ValueError)


def assert_claims_at_most(header: object, body: bytes, claim: VerifiedClaim) -> None:
    """Whatever a changed header still proves is true of the wheel: (2,5)-robust, not 3-robust."""
    try:
        found = verify(CANONICAL, bound(header, body))
    except (MalformedCertificate, RejectedCertificate):
        return
    assert found.verdict == claim.verdict
    assert found.verdict == ("robust" if found.r <= 2 else "not-robust")


def paths(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the path of every value inside ``value``."""
    keys = list(value) if isinstance(value, dict) else list(range(len(value))) if isinstance(value, list) else []
    return [found for key in keys for found in [(*path, key), *paths(value[key], (*path, key))]]


def container(value: Any, path: tuple[Any, ...]) -> tuple[Any, Any]:
    for key in path[:-1]:
        value = value[key]
    return value, path[-1]
