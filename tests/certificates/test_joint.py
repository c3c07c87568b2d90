"""Joint certificates: what is proven is accepted, and whatever one changes is refused or still true."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator, Sequence
from itertools import permutations, product
from pathlib import Path
from typing import Any

import pytest

from certificates import (
    CertificateError,
    MalformedCertificate,
    MalformedGraph,
    Misuse,
    RejectedCertificate,
    joint,
    stream,
    verify,
    verify_joint,
)
from certificates import __main__ as program
from certificates.graph import digest
from certificates.joint import VerifiedJointClaim, encode_sequence
from robustness import TimeVaryingGraph
from robustness.decision.certification import certify
from robustness.errors import InvalidParameter
from robustness.results import Verdict
from robustness.time_varying import canonical_sequence, certify_joint
from tests.time_varying import brute_force

Arcs = list[tuple[int, int]]

#: Node k is heard by all others at step k; with period 5 jointly 2-robust over every 3 steps and not over every 2.
STARS: list[Arcs] = [[(k, v) for v in range(5) if v != k] for k in range(5)]
STAR = TimeVaryingGraph.from_arcs(range(5), STARS, period=5)


def holds(sequence: TimeVaryingGraph, r: int, s: int, length: int) -> bool:
    """Return the truth by brute force. Windows that are longer than two turns have no other arcs."""
    steps = [frozenset(sequence.graph_at(k).arcs()) for k in range(len(sequence))]
    return brute_force.holds(sequence.n, steps, sequence.period, r, s, min(length, 2 * len(steps) + 1))


def parts(certificate: bytes) -> tuple[dict[str, Any], bytes]:
    header, body = certificate.split(b"\n", 1)
    return json.loads(header), body


def joined(header: dict[str, Any], body: bytes) -> bytes:
    return json.dumps(header).encode() + b"\n" + body


def proof(sequence: TimeVaryingGraph, r: int, s: int = 1, window: int | None = None) -> bytes:
    certificate = certify_joint(sequence, r, s, window=window)[1]
    assert certificate is not None
    return certificate


ROBUST, NOT_ROBUST = proof(STAR, 2, window=3), proof(STAR, 2, window=2)
DATA = canonical_sequence(STAR)


@pytest.mark.parametrize("period", [None, 1, 2, 3])
def test_every_small_question_has_its_certificate(period: int | None) -> None:
    rng = random.Random(7)
    arcs = [(u, v) for u, v in product(range(4), repeat=2) if u != v]
    seen = set()
    for _ in range(9):
        steps = [rng.sample(arcs, rng.choice([0, 3, 8, 11])) for _ in range(3)]
        sequence = TimeVaryingGraph.from_arcs(range(4), steps, period)
        for r, s, length in product((1, 2, 3), (1, 2), (1, 2, 3, 4, 9)):
            result, certificate = certify_joint(sequence, r, s, window=length)
            claim = verify_joint(canonical_sequence(sequence), certificate or b"")
            assert (claim.verdict == "robust") is holds(sequence, r, s, length) is result.decided()
            assert (claim.r, claim.s, claim.window) == (r, s, length)
            assert (claim.nodes, claim.steps, claim.period) == (4, 3, period)
            seen.add(claim.evidence)
    assert seen == {"windows", "violation"} | ({"no-window"} if period is None else set())


def test_what_a_claim_says() -> None:
    claim = verify_joint(DATA, ROBUST)
    assert str(claim) == (
        f"the sequence with 5 nodes, 5 steps (the last 5 for ever) and SHA-256 {claim.sha256} is jointly (2,1)-robust "
        "over every 3 consecutive steps (evidence: windows)"
    )
    assert (claim.certificates, claim.start) == (5, None)
    refuted = verify_joint(DATA, NOT_ROBUST)
    assert str(refuted).endswith(
        "is not jointly (2,1)-robust over every 2 consecutive steps (evidence: violation from step 0)"
    )
    trace = TimeVaryingGraph.from_arcs(range(5), STARS)
    assert "5 steps (a finite trace)" in str(verify_joint(canonical_sequence(trace), proof(trace, 2)))


def test_equal_unions_share_one_certificate() -> None:
    sequence = TimeVaryingGraph.from_arcs(range(5), STARS * 4, period=5)
    claim = verify_joint(canonical_sequence(sequence), proof(sequence, 2, window=3))
    assert (claim.steps, claim.certificates) == (20, 5)


def test_the_search_trees_are_counted() -> None:
    path = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)]
    union = TimeVaryingGraph.from_arcs(range(4), [path], period=1)
    claim = verify_joint(canonical_sequence(union), proof(union, 1))
    ordinary = certify(union.graph_at(0), 1, evidence="refutation").certificate or b""
    header, _ = parts(proof(union, 1))
    header["evidence"]["lengths"] = [len(ordinary)]
    refuted = verify_joint(canonical_sequence(union), joined(header, ordinary))
    assert refuted.tree_nodes == verify(union.graph_at(0).canonical_bytes(), ordinary).tree_nodes > 0
    assert claim.certificates == refuted.certificates == 1


def test_without_a_window_the_smallest_is_certified_or_one_that_refutes_all() -> None:
    assert verify_joint(DATA, proof(STAR, 2)).window == 3
    claim = verify_joint(DATA, proof(STAR, 4))
    assert (claim.verdict, claim.window, claim.start) == ("not-robust", 5, 0)


def test_one_node() -> None:
    sequence = TimeVaryingGraph.from_arcs(["a"], [[], []], period=1)
    assert verify_joint(canonical_sequence(sequence), proof(sequence, 1)).verdict == "robust"
    with pytest.raises(InvalidParameter, match="settled by convention"):
        certify_joint(sequence, 2)
    with pytest.raises(InvalidParameter, match="nothing to certify"):
        certify_joint(STAR, 0)


def test_numbers_beyond_the_format() -> None:
    sequence = TimeVaryingGraph.from_arcs(range(2), [[(0, 1)]], period=1)
    for r, window in ((2**31 + 1, 1), (1, 2**31 + 1)):
        with pytest.raises(InvalidParameter, match="up to 2147483648"):
            certify_joint(sequence, r, window=window)


def test_no_certificate_without_a_verdict() -> None:
    result, certificate = certify_joint(STAR, 2, time_limit=1e-9)
    assert (result.verdict, certificate) == (Verdict.UNDECIDED, None)


def _leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in items:
        yield from _leaves(part, (*path, key))


def _changed(document: Any, path: Sequence[Any], value: Any) -> Any:
    """Return a copy with the value at ``path`` replaced; ``...`` removes it."""
    if not path:
        return value
    copy = dict(document) if isinstance(document, dict) else list(document)
    part = _changed(copy[path[0]], path[1:], value)
    if part is ...:
        del copy[path[0]]
    else:
        copy[path[0]] = part
    return copy


def _verdict(sequence: TimeVaryingGraph, certificate: bytes) -> VerifiedJointClaim | None:
    try:
        return verify_joint(canonical_sequence(sequence), certificate)
    except CertificateError:
        return None


@pytest.mark.parametrize("certificate", [ROBUST, NOT_ROBUST, proof(STAR, 3, 2, 5), proof(STAR, 4)])
def test_any_field_that_is_changed_is_refused_or_still_true(certificate: bytes) -> None:
    header, body = parts(certificate)
    values: list[Any] = [..., None, True, -1, 0, 1, 2, 3, 2**31, 2**31 + 1, "robust", "not-robust", "violation"]
    values += [1.5, "windows", "no-window", [], {}, [0], [0, 0, 0, 0, 0], [[]], [-1, 1]]
    refused = 0
    for path in _leaves(header):
        for value in values if path else values[1:]:
            claim = _verdict(STAR, joined(_changed(header, path, value), body))
            refused += claim is None
            if claim is not None:
                assert (claim.verdict == "robust") is holds(STAR, claim.r, claim.s, claim.window)
    assert refused > 100


@pytest.mark.parametrize("certificate", [ROBUST, NOT_ROBUST])
def test_truncated_or_continued(certificate: bytes) -> None:
    for size in range(len(certificate)):
        assert _verdict(STAR, certificate[:size]) is None
    assert _verdict(STAR, certificate + b"\n") is None
    assert _verdict(STAR, certificate + certificate) is None


def test_any_byte_of_the_body() -> None:
    header, body = parts(ROBUST)
    for place in range(0, len(body), 3):
        changed = body[:place] + bytes([body[place] ^ 1]) + body[place + 1 :]
        claim = _verdict(STAR, joined(header, changed))
        assert claim is None or claim.verdict == "robust"


def test_another_sequence() -> None:
    for steps, period in ((STARS, None), (STARS, 4), (STARS[::-1], 5), (STARS[:4], 4), ([*STARS[:4], []], 5)):
        other = TimeVaryingGraph.from_arcs(range(5), steps, period)
        with pytest.raises(RejectedCertificate, match="another sequence"):
            verify_joint(canonical_sequence(other), ROBUST)
        header, body = parts(ROBUST)
        header["sequence"] = digest(canonical_sequence(other))
        claim = _verdict(other, joined(header, body))
        assert claim is None or holds(other, 2, 1, 3)


def forged(certificate: bytes = ROBUST, body: bytes | None = None, **evidence: Any) -> bytes:
    header, old = parts(certificate)
    header["evidence"] |= evidence
    return joined(header, old if body is None else body)


class TestTheMapOfWindows:
    def test_every_other_map_is_refused(self) -> None:
        right = (0, 1, 2, 3, 4)
        replaced = [(*right[:k], i, *right[k + 1 :]) for k, i in product(range(5), repeat=2)]
        for named in [*permutations(range(5)), *replaced]:
            claim = _verdict(STAR, forged(unions=named))
            assert (claim is not None) is (named == right)

    def test_a_window_that_fails_cannot_be_hidden(self) -> None:
        good = TimeVaryingGraph.from_arcs(range(5), [STARS[0] + STARS[1] + STARS[2]] * 2, None)
        bad = TimeVaryingGraph.from_arcs(range(5), [STARS[0] + STARS[1] + STARS[2], STARS[0]], None)
        header, body = parts(proof(good, 2, window=1))
        assert header["evidence"]["unions"] == [0, 0]
        header["sequence"] = digest(canonical_sequence(bad))
        with pytest.raises(RejectedCertificate, match="window 1: its union is not the graph of certificate 0"):
            verify_joint(canonical_sequence(bad), joined(header, body))

    @pytest.mark.parametrize(
        ("evidence", "error", "message"),
        [
            ({"unions": [0, 1, 2, 3]}, RejectedCertificate, "5 windows, not 4"),
            ({"unions": [0, 1, 2, 3, 5]}, MalformedCertificate, "numbers of certificates in 0..4"),
            ({"unions": [0, 1, 2, 3, -1]}, MalformedCertificate, "numbers of certificates"),
            ({"unions": None}, MalformedCertificate, "numbers of certificates"),
            ({"unions": [0, 1, 2, 3, 3]}, RejectedCertificate, "window 4: its union is not"),
            ({"unions": [1, 0, 2, 3, 4]}, RejectedCertificate, "window 0: the certificate is about another graph"),
            ({"lengths": [1, 1]}, MalformedCertificate, "have 2 bytes, but"),
            ({"lengths": [0]}, MalformedCertificate, "positive integers"),
            ({"lengths": "5"}, MalformedCertificate, "positive integers"),
            ({"more": 1}, MalformedCertificate, "exactly the keys"),
        ],
    )
    def test_forgeries(self, evidence: dict[str, Any], error: type[CertificateError], message: str) -> None:
        with pytest.raises(error, match=message):
            verify_joint(DATA, forged(**evidence))

    def test_a_certificate_that_nobody_names(self) -> None:
        header, body = parts(ROBUST)
        lengths = header["evidence"]["lengths"]
        with pytest.raises(RejectedCertificate, match="1 certificates are named for no window"):
            verify_joint(DATA, forged(lengths=[*lengths, 7], body=body + b"nothing"))

    def test_the_claim_of_every_part_is_the_joint_claim(self) -> None:
        header, body = parts(proof(STAR, 1, window=3))
        header["claim"]["r"] = 2
        with pytest.raises(RejectedCertificate, match=r"about \(1,1\), robust, not about \(2,1\), robust"):
            verify_joint(DATA, joined(header, body))

    def test_a_refuted_part_proves_no_robust_claim(self) -> None:
        header, body = parts(NOT_ROBUST)
        header["claim"]["verdict"] = "robust"
        header["evidence"] = {"kind": "windows", "unions": [0] * 5, "lengths": [len(body)]}
        with pytest.raises(RejectedCertificate, match=r"\(2,1\), not-robust, not about \(2,1\), robust"):
            verify_joint(DATA, joined(header, body))


class TestRefutations:
    @pytest.mark.parametrize("start", [-1, 5, 10**9])
    def test_a_start_that_is_none(self, start: int) -> None:
        with pytest.raises(RejectedCertificate, match="starts at"):
            verify_joint(DATA, forged(NOT_ROBUST, start=start))

    def test_a_start_of_another_union(self) -> None:
        with pytest.raises(RejectedCertificate, match="window 1: the certificate is about another graph"):
            verify_joint(DATA, forged(NOT_ROBUST, start=1))

    def test_too_short_a_trace(self) -> None:
        trace = TimeVaryingGraph.from_arcs(range(5), STARS)
        data, certificate = canonical_sequence(trace), proof(trace, 1, window=6)
        assert verify_joint(data, certificate).evidence == "no-window"
        with pytest.raises(MalformedCertificate, match="1 bytes follow"):
            verify_joint(data, certificate + b"x")
        header, _ = parts(certificate)
        header["claim"]["window"] = 5
        with pytest.raises(RejectedCertificate, match="there are windows of 5 steps"):
            verify_joint(data, joined(header, b""))
        header["claim"] |= {"window": 6, "verdict": "robust"}
        header["evidence"] = {"kind": "windows", "unions": [], "lengths": []}
        with pytest.raises(RejectedCertificate, match="not seen is not claimed"):
            verify_joint(data, joined(header, b""))

    def test_a_sequence_with_a_period_always_has_windows(self) -> None:
        header, _ = parts(NOT_ROBUST)
        header["evidence"] = {"kind": "no-window"}
        header["claim"]["window"] = 2**31
        with pytest.raises(RejectedCertificate, match="there are windows"):
            verify_joint(DATA, joined(header, b""))


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("format",), "robustness/joint-certificate/2", "the format is"),
        (("format",), "robustness/certificate/1", "the format is"),
        (("claim", "property"), "rs-robust", "the property is"),
        (("claim", "r"), 0, "integers in 1.."),
        (("claim", "window"), True, "integers in 1.."),
        (("claim", "s"), 6, "s lies in 1..n = 1..5"),
        (("claim", "verdict"), "perhaps", "a verdict is"),
        (("claim", "verdict"), None, "a verdict is"),
        (("evidence", "kind"), "violation", "no evidence of kind"),
        (("evidence",), {"kind": "violation", "start": "0"}, "no evidence of kind"),
    ],
)
def test_malformed_headers(path: tuple[str, ...], value: Any, message: str) -> None:
    header, body = parts(ROBUST)
    with pytest.raises(MalformedCertificate, match=message):
        verify_joint(DATA, joined(_changed(header, path, value), body))


def test_a_start_is_an_integer() -> None:
    with pytest.raises(MalformedCertificate, match="start is an integer"):
        verify_joint(DATA, forged(NOT_ROBUST, start=False))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"[]", "exactly the keys"),
        (b"{}", "exactly the keys"),
        (b'{"format":"x","labels":[],"period":null,"steps":[[]]}', "the format of a sequence"),
        (DATA + b"\n", "canonical spelling"),
        (DATA.replace(b'"period":5', b'"period":6'), "the period is null or"),
        (DATA.replace(b'"period":5', b'"period":0'), "the period is null or"),
        (DATA.replace(b'"period":5', b'"period":true'), "the period is null or"),
        (DATA.replace(b"[0,1,2,3,4]", b"[0,1,2,4,3]"), "ascending canonical order"),
        (DATA.replace(b"[0,1,2,3,4]", b"[0,1,2,3,3]"), "ascending canonical order"),
        (DATA.replace(b"[0,1,2,3,4]", b"[0,1,2,3,4.5]"), "a node label"),
        (encode_sequence((1,), [], None), "steps is a list of 1.."),
        (encode_sequence((1,), [[]], None).replace(b"[[]]", b"{}"), "steps is a list"),
        (encode_sequence((1,), [[]], None).replace(b"[[]]", b"[{}]"), "a step is a list"),
        (encode_sequence((1, 2), [[(0, 2)]], None), "a pair of ids in 0..1"),
        (encode_sequence((1, 2), [[(-1, 1)]], None), "a pair of ids"),
        (encode_sequence((1, 2), [[(0, True)]], None), "a pair of ids"),
        (encode_sequence((1, 2), [[(0, 1)]], None).replace(b"[0,1]", b"[0]"), "a pair of ids"),
        (encode_sequence((1, 2), [[(0, 1)]], None).replace(b"[0,1]", b"7"), "a pair of ids"),
        (encode_sequence((1, 2), [[(0, 0)]], None), "two different nodes"),
        (encode_sequence((1, 2), [[(0, 1), (0, 1)]], None), "strictly ascending"),
        (encode_sequence((1, 2), [[(1, 0), (0, 1)]], None), "strictly ascending"),
    ],
)
def test_malformed_sequences(data: bytes, message: str) -> None:
    with pytest.raises(MalformedGraph, match=message):
        verify_joint(data, ROBUST)


def test_windows_are_compared_by_what_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    """A union is put together for its certificate alone: 20,000 windows of one union take one, not 20,000."""
    everybody = [(i, j) for i in range(5) for j in range(5) if i != j]
    two = [everybody[::2], everybody[1::2]]
    header, body = parts(proof(TimeVaryingGraph.from_arcs(range(5), two, 2), 3, window=2))
    put_together = []
    encode = joint.encode_graph

    def counting(labels: Sequence[Any], arcs: list[tuple[int, int]]) -> bytes:
        put_together.append(len(arcs))
        return encode(labels, arcs)

    monkeypatch.setattr(joint, "encode_graph", counting)
    data = canonical_sequence(TimeVaryingGraph.from_arcs(range(5), two * 10_000, None))
    header["evidence"]["unions"] = [0] * 19_999
    header["sequence"] = digest(data)
    assert verify_joint(data, json.dumps(header).encode() + b"\n" + body).certificates == 1
    assert put_together == [20]


def test_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, message in (
        ("MAX_STEPS", "steps is a list of 1..4"),
        ("MAX_UNION_SIZE", "the unions have more than 4 nodes and arcs together"),
        ("MAX_SEQUENCE_BYTES", "at most 4 bytes"),
        ("MAX_CERTIFICATE_BYTES", "at most 4 bytes"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(stream if name == "MAX_CERTIFICATE_BYTES" else joint, name, 4)
            with pytest.raises(MalformedCertificate, match=message):
                verify_joint(DATA, ROBUST)


def test_misuse() -> None:
    for wrong in ((DATA.decode(), ROBUST), (DATA, None)):
        with pytest.raises(Misuse, match="two bytes objects"):
            verify_joint(*wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "code", "err"),
    [
        (("sequence", "robust"), 0, ""),
        (("sequence", "robust", "--expect", "robust", "-r", "2", "-s", "1", "--window", "3"), 0, ""),
        (("sequence", "split", "--expect", "not-robust"), 0, ""),
        (("sequence", "split", "--expect", "robust"), 10, "not the one asked for (verdict robust)"),
        (("sequence", "robust", "--window", "2"), 10, "not the one asked for (window 2)"),
        (("other", "robust"), 10, "rejected: the certificate is about another sequence"),
        (("sequence", "cut"), 3, "malformed: the certificates have"),
        (("robust", "robust"), 3, "malformed: the sequence is not JSON"),
        (("absent", "robust"), 3, "error: cannot read"),
    ],
)
def test_the_command(
    arguments: tuple[str, ...],
    code: int,
    err: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    other = canonical_sequence(TimeVaryingGraph.from_arcs(range(5), STARS))
    files = {"sequence": DATA, "other": other, "robust": ROBUST, "split": NOT_ROBUST, "cut": ROBUST[:-1]}
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    monkeypatch.chdir(tmp_path)
    assert program.main(["verify-joint", *arguments]) == code
    said = capsys.readouterr()
    assert err in said.err
    assert said.err.count("\n") == bool(err)
    assert ("jointly (2,1)-robust" in said.out) is (code == 0)
