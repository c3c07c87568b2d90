"""Refutations of solutions: accepted for what has none, refused for what has one, however they were come by.

The truth is told by the brute force of ``tests.tolerance``.
"""

from __future__ import annotations

import random
from collections import Counter
from itertools import combinations, product

import networkx as nx
import pytest

from certificates import MalformedCertificate, RejectedCertificate, masks, verify_tolerance
from certificates.graph import decode_graph
from certificates.separation import check_separation
from certificates.tolerance import FORMAT
from robustness import Digraph
from robustness.traps.question import Question
from tests.certificates.forging import read, spell
from tests.certificates.forging_separation import (
    KINDS,
    PROPAGATE,
    certificate,
    is_accepted,
    questions,
    searched,
    solvable,
    wander,
)
from tests.oracles import digraphs, graphs

SMALL = [graph for n in (2, 3, 4, 5) for graph in graphs(n)] + [graph for n in (2, 3) for graph in digraphs(n)]
LARGER = [*list(graphs(6))[::8], *list(digraphs(4))[::24]]


@pytest.mark.parametrize("family", [SMALL, LARGER], ids=["small", "larger"])
def test_the_search_proves_what_is_true_and_nothing_else_is_accepted(family: list[Digraph]) -> None:
    """Where there is no solution, the transcript is a proof; where there is one, the sibling's transcript is none."""
    proofs: dict[int, set[bytes]] = {}
    false: list[tuple[Digraph, Question]] = []
    for graph in family:
        for question in questions(graph):
            if solvable(graph, question):
                false.append((graph, question))
                continue
            body = searched(graph, question)
            assert is_accepted(graph, question, body), (graph.canonical_bytes(), question)
            proofs.setdefault(graph.n, set()).add(body)
    draw, tried = random.Random(3), 0
    for graph, question in false:
        bodies = sorted(proofs.get(graph.n, ()))
        for body in draw.sample(bodies, min(len(bodies), 6)):
            assert not is_accepted(graph, question, body), (graph.canonical_bytes(), question, body)
            tried += 1
    assert sum(map(len, proofs.values())) > 10
    assert tried > 300


def test_a_search_that_leaves_out_what_it_cannot_close() -> None:
    """Sound step by step, and closed wherever the rules close it: it fails for its missing leaves alone."""
    draw, tried = random.Random(4), 0
    for graph in SMALL + LARGER:
        for question in questions(graph):
            if not solvable(graph, question):
                continue
            body = wander(graph, question, draw, steps=15)
            assert not is_accepted(graph, question, body)
            tokens = read(body)
            for filler in ((draw.choice((6, 7)), 0, 1), (draw.randint(1, 5), draw.randrange(graph.n))):
                tokens.insert(draw.randint(0, len(tokens)), filler)
                assert not is_accepted(graph, question, spell(tokens))
            tried += 1
    assert tried > 400


def test_an_odd_search_for_a_true_claim_is_a_proof() -> None:
    """The rules and branches alone make proofs, whoever chooses them: random choices do, with every kind of step."""
    draw, seen = random.Random(5), Counter[int]()
    for graph in SMALL + LARGER[::3]:
        for question in questions(graph):
            if not solvable(graph, question):
                body = wander(graph, question, draw)
                assert is_accepted(graph, question, body)
                seen.update(token[0] for token in read(body))
    assert set(seen) == set(range(8))


def mutants(body: bytes, n: int) -> list[bytes]:
    """Return every transcript that differs in one number, a dropped or repeated stretch, or one swap."""
    tokens, found = read(body), []
    for place, value in product(range(len(body)), range(max(9, n))):
        found.append(body[:place] + bytes([value]) + body[place + 1 :])
    for start, stop in combinations(range(len(tokens) + 1), 2):
        found.append(spell(tokens[:start] + tokens[stop:]))
        found.append(spell(tokens[:stop] + tokens[start:]))
    return found


def test_mutants_of_proofs_bound_to_graphs_with_a_solution() -> None:
    """A link less and the claim is false: no change of the proof that was true makes it a proof."""
    draw, tried = random.Random(6), 0
    for graph in SMALL + LARGER:
        for question in questions(graph):
            if question.f == 0 or solvable(graph, question):
                continue
            for gone in draw.sample(range(graph.arc_count), min(4, graph.arc_count)):
                arcs = [(j, i) for i in range(graph.n) for j in graph.in_neighbours(i).tolist()]
                weaker = Digraph(range(graph.n), arcs[:gone] + arcs[gone + 1 :])
                if not solvable(weaker, question):
                    continue
                changed = mutants(searched(graph, question), graph.n)
                for body in draw.sample(changed, min(len(changed), 60)):
                    assert not is_accepted(weaker, question, body), (weaker.canonical_bytes(), question, body)
                    tried += 1
    assert tried > 500


def test_proofs_of_graphs_that_take_a_search() -> None:
    """Sparse and dense, more nodes than a word has bits: every transcript of a search is accepted."""
    tree_nodes = 0
    for drawn, f in ((nx.random_regular_graph(10, 40, seed=1), 2), (nx.gnp_random_graph(70, 0.3, seed=1), 2)):
        graph = Digraph.from_networkx(drawn)
        for two_faces, local in KINDS:
            question = Question(f, two_faces, local)
            body = searched(graph, question)
            claim = verify_tolerance(graph.canonical_bytes(), certificate(graph, question, body))
            assert (claim.verdict, claim.evidence, claim.certificates) == ("together", "refutation", 0)
            tree_nodes += claim.tree_nodes
    assert tree_nodes > 500


class TestRejected:
    K5 = Digraph.from_networkx(nx.complete_graph(5))
    ASKED = Question(1)

    @pytest.mark.parametrize(
        ("body", "message"),
        [
            (b"", "ends in the middle"),
            (b"\0", "PROPAGATE without an EXCLUDE"),
            (b"\1\5", "out of range"),
            (b"\1\1\1\2", "not symmetric"),
            (b"\1\1\2\1", "already decided: node 1"),
            (b"\1\1\4\1", "already decided: node 1"),
            (b"\1\1\6\2\1", "blocker 1 is no normal node"),
            (b"\1\1\7\1\1", "EXCLUDE of node 1, which is no candidate"),
            (b"\1\1\7\2\1", "blocker 1 does not exclude node 2"),
            (b"\1\1\x08\2\1\3", "out of range"),
        ],
    )
    def test_one_step_wrong(self, body: bytes, message: str) -> None:
        loose = Digraph.from_networkx(nx.empty_graph(5))
        with pytest.raises(RejectedCertificate, match=message):
            check_separation(decode_graph(loose.canonical_bytes()), 1, 2, "total", body)

    def test_a_tail(self) -> None:
        body = searched(self.K5, self.ASKED) + b"\0"
        with pytest.raises(RejectedCertificate, match="1 bytes follow"):
            verify_tolerance(self.K5.canonical_bytes(), certificate(self.K5, self.ASKED, body))

    def test_exclude_without_propagate(self) -> None:
        for graph in SMALL + LARGER:
            for question in questions(graph):
                if solvable(graph, question):
                    continue
                tokens = read(searched(graph, question))
                for place, token in enumerate(tokens):
                    if token[0] == PROPAGATE:
                        assert not is_accepted(graph, question, spell(tokens[:place] + tokens[place + 1 :]))
                        return
        pytest.fail("no transcript has a PROPAGATE")

    def test_the_first_format_has_no_such_evidence(self) -> None:
        data = certificate(self.K5, self.ASKED, searched(self.K5, self.ASKED), FORMAT)
        with pytest.raises(MalformedCertificate, match="no evidence of kind 'refutation'"):
            verify_tolerance(self.K5.canonical_bytes(), data)

    def test_limits(self, monkeypatch: pytest.MonkeyPatch) -> None:
        data = certificate(self.K5, self.ASKED, searched(self.K5, self.ASKED))
        monkeypatch.setattr(masks, "MAX_LOOKS", 3)
        with pytest.raises(MalformedCertificate, match="at most 3 looks"):
            verify_tolerance(self.K5.canonical_bytes(), data)
        monkeypatch.setattr(masks, "MAX_NODES", 4)
        with pytest.raises(MalformedCertificate, match="at most 4 nodes"):
            verify_tolerance(self.K5.canonical_bytes(), data)
