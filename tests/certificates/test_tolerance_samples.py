"""The committed samples of tolerance certificates, and what becomes of them when bytes change: a true claim or none."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from certificates import CertificateError, MalformedCertificate, RejectedCertificate, verify_tolerance
from certificates.__main__ import main
from certificates.graph import decode_graph
from certificates.questions import verify_any
from certificates.tolerance import FORMAT_WITH_REFUTATIONS, VerifiedToleranceClaim
from robustness import Digraph
from robustness.traps.question import Question
from tests.certificates.forging import read, spell
from tests.certificates.forging_separation import certificate, solvable
from tests.certificates.make_tolerance_samples import HERE, proof, samples, write
from tests.certificates.test_fuzzing import bodies, ids, json_values

FOLDERS = {"accepted": 0, "rejected": 10, "malformed": 3}
FILES = sorted(path for folder in FOLDERS for path in (HERE / folder).glob("*.cert"))
ACCEPTED = [(graph, data) for folder, _, graph, data in samples() if folder == "accepted"]
SUBJECTS = [
    Digraph.from_networkx(G)
    for G in (nx.wheel_graph(5), nx.complete_graph(4), nx.cycle_graph(5), nx.empty_graph(2), nx.complete_graph(6))
]


def truth(graph: bytes, claim: VerifiedToleranceClaim) -> bool:
    """Return whether the claim is true, by the brute force."""
    found = decode_graph(graph)
    arcs = [(found.labels[u], found.labels[v]) for v, heard in enumerate(found.hears) for u in heard]
    question = Question(claim.f, claim.faces == 2, claim.bound == "local")
    return solvable(Digraph(found.labels, arcs), question) is (claim.verdict == "apart")


def assert_true_or_refused(graph: bytes, data: bytes) -> bool:
    """Return whether it is accepted."""
    try:
        claim = verify_tolerance(graph, data)
    except CertificateError as problem:
        assert len(str(problem)) < 500  # noqa: PT017  # whichever error it is, it is told in a line
        return False
    assert truth(graph, claim), (graph, data)
    return True


def check(path: Path) -> None:
    graph, data = path.with_suffix(".graph").read_bytes(), path.read_bytes()
    match path.parent.name:
        case "accepted":
            claim = verify_tolerance(graph, data)
            assert truth(graph, claim)
            assert verify_any(graph, data) == claim
        case "rejected":
            with pytest.raises(RejectedCertificate):
                verify_tolerance(graph, data)
        case _:
            with pytest.raises(MalformedCertificate):
                verify_tolerance(graph, data)


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_committed_samples(path: Path) -> None:
    check(path)
    code = main(["verify-tolerance", str(path.with_suffix(".graph")), str(path)])
    assert code == FOLDERS[path.parent.name]


def test_the_script_writes_what_is_committed(tmp_path: Path) -> None:
    write(tmp_path)
    written = sorted(tmp_path.glob("*/*"))
    committed = {path.relative_to(HERE) for folder in FOLDERS for path in (HERE / folder).iterdir()}
    assert {path.relative_to(tmp_path) for path in written} == committed
    for path in written:
        if path.suffix == ".cert":
            check(path)


def test_no_two_samples_are_the_same() -> None:
    every = [(graph, data) for _, _, graph, data in samples()]
    assert len(set(every)) == len(every) == len(FILES)


def test_samples_show_every_kind_of_evidence_and_every_threat() -> None:
    claims = [verify_tolerance(*each) for each in ACCEPTED]
    assert {claim.evidence for claim in claims} == {"sets", "robust", "refutation"}
    refuted = {(claim.faces, claim.bound) for claim in claims if claim.evidence == "refutation"}
    assert refuted == {(1, "total"), (1, "local"), (2, "total"), (2, "local")}


#: What docs/certificate-format.md says of those that are rejected.
CODES = {
    "the-proof-of-another-graph": "other-subject",
    "the-refutation-of-a-sibling": "refutation",
    "robust-for-too-small-an-r": "other-claim",
    "too-many-malicious-nodes": "sets",
}


@pytest.mark.parametrize(("name", "code"), CODES.items())
def test_a_rejection_says_by_a_code_which_part_does_not_hold(name: str, code: str) -> None:
    path = HERE / "rejected" / f"{name}.cert"
    with pytest.raises(RejectedCertificate) as caught:
        verify_tolerance(path.with_suffix(".graph").read_bytes(), path.read_bytes())
    assert caught.value.code == code


def test_every_byte_changed_and_every_stretch_cut_out_of_every_accepted_sample() -> None:
    """Some mutants are proofs still, of the same claim or of another true one; none of a false one."""
    alive = tried = 0
    for graph, data in ACCEPTED:
        for place in range(len(data)):
            for mutant in (
                data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :],
                data[:place] + bytes([(data[place] + 1) & 255]) + data[place + 1 :],
                data[:place] + data[place + 1 :],
                data[:place],
            ):
                tried += 1
                alive += assert_true_or_refused(graph, mutant)
    assert tried > 10_000
    assert 0 < alive < tried / 10


def test_every_accepted_transcript_with_a_step_changed_dropped_or_repeated() -> None:
    alive = tried = 0
    for graph, data in ACCEPTED:
        header, transcript = data.split(b"\n", 1)
        if b'"refutation"' not in header:
            continue
        tokens = read(transcript)
        for k, token in enumerate(tokens):
            others = [(), (token, token)]
            others += [((opcode, *token[1:]),) for opcode in range(8) if len(token) > 1]
            others += [((*token[:-1], node),) for node in range(decode_graph(graph).n) if len(token) > 1]
            for new in others:
                mutant = header + b"\n" + spell([*tokens[:k], *new, *tokens[k + 1 :]])
                if mutant != data:
                    tried += 1
                    alive += assert_true_or_refused(graph, mutant)
    assert tried > 1000
    assert alive < tried / 2


kinds = st.sampled_from(["sets", "robust", "refutation", "removals"])
evidence = (
    kinds.map(lambda kind: {"kind": kind})
    | st.fixed_dictionaries({"kind": kinds, "M": ids, "S1": ids, "S2": ids})
    | json_values
)
claims = st.fixed_dictionaries(
    {
        "f": st.integers(0, 3) | json_values,
        "faces": st.sampled_from([1, 2]) | json_values,
        "bound": st.sampled_from(["total", "local"]) | json_values,
        "verdict": st.sampled_from(["apart", "together"]) | json_values,
    }
)


@given(st.sampled_from(SUBJECTS), claims | json_values, evidence, bodies)
def test_headers_of_the_right_shape(graph: Digraph, claim: object, evidence: object, body: bytes) -> None:
    header = {"format": FORMAT_WITH_REFUTATIONS, "graph": graph.sha256, "claim": claim, "evidence": evidence}
    assert_true_or_refused(graph.canonical_bytes(), json.dumps(header).encode() + b"\n" + body)


@given(st.sampled_from(SUBJECTS), st.integers(0, 3), st.booleans(), st.booleans(), bodies)
@example(SUBJECTS[4], 1, True, False, b"\1\0" * 10)
def test_transcripts(graph: Digraph, f: int, two_faces: bool, local: bool, body: bytes) -> None:
    assert_true_or_refused(graph.canonical_bytes(), certificate(graph, Question(f, two_faces, local), body))


@given(st.sampled_from(ACCEPTED), st.integers(0, 400), st.integers(0, 12), st.binary(max_size=6))
def test_a_stretch_of_a_proof_replaced(pair: tuple[bytes, bytes], start: int, length: int, new: bytes) -> None:
    graph, data = pair
    assert_true_or_refused(graph, data[:start] + new + data[start + length :])


@given(st.sampled_from(ACCEPTED), st.sampled_from(ACCEPTED))
def test_proofs_put_under_the_claims_of_others(one: tuple[bytes, bytes], other: tuple[bytes, bytes]) -> None:
    header, transcript = one[1].split(b"\n", 1)[0], other[1].split(b"\n", 1)[1]
    assert_true_or_refused(one[0], header + b"\n" + transcript)


@given(st.binary(max_size=200), st.binary(max_size=200))
@example(proof(SUBJECTS[1], 1, two_faces=False), b"")
def test_any_bytes(graph_bytes: bytes, certificate_bytes: bytes) -> None:
    with pytest.raises(CertificateError):
        verify_tolerance(graph_bytes, certificate_bytes)
