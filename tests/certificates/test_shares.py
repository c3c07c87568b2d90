"""Shares of a refutation: together they prove what the whole does, and never more, whatever index they are given."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import pairwise

import networkx as nx
import pytest

from certificates import (
    CertificateError,
    MalformedCertificate,
    Misuse,
    RejectedCertificate,
    VerifiedClaim,
    VerifiedToleranceClaim,
    shares,
    stream,
    verify,
    verify_any,
)
from certificates.shares import Share, together, verify_share
from certificates.stream import Stream
from robustness import Digraph
from robustness.decision.certification import certify
from robustness.threat_models import certify_tolerance, tolerance
from tests.certificates.forging import certificate, searched

FOUND = Digraph.from_networkx(nx.gnp_random_graph(24, 0.5, seed=1))
GRAPH = FOUND.canonical_bytes()
PROOF = certificate(FOUND, 7, 1, body=searched(FOUND, 7, 1))
#: A seed with a refutation: what the trees of a growth are about.
GROWN = Digraph.from_networkx(nx.gnp_random_graph(22, 0.5, seed=3))


def trees_of(graph: bytes, data: bytes, monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """Return all trees that the kernel lists when none is too short."""
    monkeypatch.setattr(stream, "_LEAST_TREE", 1)
    reading = Stream(data)
    reading.trees = []
    verify_any(graph, reading)
    return sorted(reading.trees)


def some_of(trees: list[tuple[int, int]], draw: random.Random) -> list[tuple[int, int]]:
    """Draw trees none of which is inside another."""
    chosen: list[tuple[int, int]] = []
    for start, length in sorted(draw.sample(trees, draw.randint(0, len(trees)))):
        if not chosen or sum(chosen[-1]) <= start:
            chosen.append((start, length))
    return chosen


def shared(
    graph: bytes, data: bytes, index: list[tuple[int, int]], count: int
) -> VerifiedClaim | VerifiedToleranceClaim:
    return together([verify_share(graph, data, index, number, count) for number in range(count)])


def test_together_they_prove_what_the_whole_does(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = random.Random(1)
    trees = trees_of(GRAPH, PROOF, monkeypatch)
    assert len(trees) > 20
    for _ in range(60):
        index = some_of(trees, draw)
        assert shared(GRAPH, PROOF, index, draw.randint(1, 4)) == verify(GRAPH, PROOF)


def test_every_kind_with_one_refutation(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = random.Random(2)
    grown = certify(GROWN, 4).certificate
    ring = Digraph.from_networkx(nx.random_regular_graph(8, 16, seed=1))
    table = tolerance(ring, "byzantine-local")
    apart = certify_tolerance(table).guaranteed
    assert grown is not None
    assert apart is not None
    for graph, data in ((GROWN, grown), (ring, apart)):
        about = graph.canonical_bytes()
        trees = trees_of(about, data, monkeypatch)
        for _ in range(10):
            assert shared(about, data, some_of(trees, draw), 2) == verify_any(about, data)


def test_what_is_rejected_whole_is_rejected_in_shares(monkeypatch: pytest.MonkeyPatch) -> None:
    """One byte of the transcript changed, cut or added: whatever trees are apart, some share refuses."""
    draw = random.Random(3)
    trees = trees_of(GRAPH, PROOF, monkeypatch)
    first = PROOF.index(b"\n") + 1
    refused = 0
    for _ in range(400):
        place = draw.randrange(first, len(PROOF))
        changed = draw.choice((bytes([draw.randrange(14)]), b"", bytes([PROOF[place], draw.randrange(14)])))
        data = PROOF[:place] + changed + PROOF[place + 1 :]
        index = some_of(trees, draw)
        try:
            claim = shared(GRAPH, data, index, 3)
        except CertificateError:
            refused += 1
        else:
            assert claim == verify(GRAPH, data)
    assert refused > 200


def test_an_index_that_lies_proves_nothing_false() -> None:
    """Random indices, mostly no trees at all, with a sound transcript and with one that is cut."""
    draw = random.Random(4)
    size = len(PROOF) - PROOF.index(b"\n") - 1
    accepted = 0
    for _ in range(400):
        cuts = sorted(draw.sample(range(size + 5), 2 * draw.randint(1, 4)))
        index = [(a, b - a) for a, b in zip(cuts[::2], cuts[1::2], strict=True)]
        for data in (PROOF, PROOF[: -draw.randint(1, 20)], PROOF + b"\0"):
            try:
                claim = shared(GRAPH, data, index, 2)
            except CertificateError:
                continue
            assert data == PROOF
            assert claim == verify(GRAPH, data)
            accepted += 1
    assert accepted > 10


def test_the_owner_finds_a_tree_that_is_shorter_than_said(monkeypatch: pytest.MonkeyPatch) -> None:
    start, length = next(tree for tree in trees_of(GRAPH, PROOF, monkeypatch) if tree[1] > 6)
    for said in (length - 1, length + 1):
        with pytest.raises(RejectedCertificate, match=f"begins at byte {start} has not the {said} bytes"):
            verify_share(GRAPH, PROOF, [(start, said)], 0, 2)
    with pytest.raises(RejectedCertificate, match="has not the 100000 bytes"):
        verify_share(GRAPH, PROOF, [(start, 100_000)], 1, 2)


def test_trees_that_shares_list_are_those_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = random.Random(6)
    trees = trees_of(GRAPH, PROOF, monkeypatch)
    for _ in range(30):
        index = some_of(trees, draw)
        parts = [verify_share(GRAPH, PROOF, index, number, 3) for number in range(3)]
        assert sorted({tree for part in parts for tree in part.trees}) == trees


def test_the_limit_of_work_holds_for_all_shares_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is too much for one verifier is too much for several, of which each does less."""
    draw = random.Random(7)
    trees = trees_of(GRAPH, PROOF, monkeypatch)
    looks = verify_share(GRAPH, PROOF, [], 0, 1).looks
    for limit, is_enough in ((looks - 1, False), (2 * looks, True)):
        monkeypatch.setattr(shares, "MAX_LOOKS", limit)
        for _ in range(10):
            index = some_of(trees, draw)
            if is_enough:
                assert shared(GRAPH, PROOF, index, 4) == verify(GRAPH, PROOF)
            else:
                with pytest.raises(MalformedCertificate, match=f"at most {limit} looks"):
                    shared(GRAPH, PROOF, index, 4)


@pytest.mark.parametrize("index", [[(5, 0)], [(-1, 3)], [(5, 4), (8, 2)], [(9, 1), (5, 1)], [(5, -1)]])
def test_misuse(index: list[tuple[int, int]]) -> None:
    with pytest.raises(Misuse, match="an index is"):
        verify_share(GRAPH, PROOF, index, 0, 1)


def test_misuse_of_numbers_and_kinds() -> None:
    for number, count in ((2, 2), (-1, 2), (0, 0)):
        with pytest.raises(Misuse, match="numbered from 0"):
            verify_share(GRAPH, PROOF, [], number, count)
    with pytest.raises(Misuse, match="has no shares"):
        verify_share(GRAPH, b'{"format": "robustness/joint-certificate/1"}\n', [], 0, 1)
    with pytest.raises(MalformedCertificate, match="the format of a certificate"):
        verify_share(GRAPH, b"{}\n", [], 0, 1)


def test_a_share_alone_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    trees = trees_of(GRAPH, PROOF, monkeypatch)
    index = [tree for tree, other in pairwise(trees) if sum(tree) <= other[0]][:4]
    assert len(index) > 1
    first, second = (verify_share(GRAPH, PROOF, index, number, 2) for number in range(2))
    assert together([first, second]).r == 7
    others: list[list[Share]] = [
        [first],
        [first, replace(second, index=())],
        [first, replace(second, sha256="0")],
        [first, replace(second, number=0)],
        [replace(first, claim=replace(first.claim, s=2)), second],
        [],
    ]
    for each in others:
        with pytest.raises(RejectedCertificate, match="not all the shares"):
            together(each)
    part = Stream(PROOF)
    part.share[3] = 1, False
    for check in (verify, verify_any):
        with pytest.raises(Misuse, match="by certificates\\.shares alone"):
            check(GRAPH, part)
