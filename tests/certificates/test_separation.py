"""Refutations of solutions: accepted for what has none, refused for what has one, however they were come by.

The truth is told by the brute force of ``tests.tolerance``.
"""

from __future__ import annotations

import json
import math
import random
from collections import Counter
from functools import cache
from itertools import combinations, product

import networkx as nx
import pytest

from certificates import CertificateError, MalformedCertificate, RejectedCertificate, masks, verify_tolerance
from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.roles import Roles, Threat, excludes, settle
from certificates.separation import check_separation
from certificates.tolerance import FORMAT, FORMAT_WITH_REFUTATIONS
from robustness import Digraph
from robustness.limits import Limits
from robustness.traps import searching
from robustness.traps.question import Question
from tests.certificates.forging import Token, read, spell
from tests.oracles import digraphs, graphs
from tests.tolerance.brute_force import has_standing_attack, has_trap

KINDS = list(product((False, True), (False, True)))
SMALL = [graph for n in (2, 3, 4, 5) for graph in graphs(n)] + [graph for n in (2, 3) for graph in digraphs(n)]
LARGER = [*list(graphs(6))[::8], *list(digraphs(4))[::24]]
PROPAGATE, ROOT, NORMAL, MALICIOUS, EXCLUDE = 0, 1, 2, 4, 6


def solvable(graph: Digraph, question: Question) -> bool:
    oracle = has_trap if question.two_faces else has_standing_attack
    return oracle(graph.in_masks, question.f, question.local)


def questions(graph: Digraph) -> list[Question]:
    return [Question(f, *kind) for f in range(3) for kind in KINDS]


@cache
def searched(graph: Digraph, question: Question) -> bytes:
    answer = searching.decide(graph, question, Limits(), transcript=True)
    assert answer.exists is False
    assert answer.transcript is not None
    return answer.transcript


def certificate(graph: Digraph, question: Question, body: bytes, version: str = FORMAT_WITH_REFUTATIONS) -> bytes:
    f, two_faces, local = question
    claim = {"f": f, "faces": 2 if two_faces else 1, "bound": "local" if local else "total", "verdict": "together"}
    header = {"format": version, "graph": graph.sha256, "claim": claim, "evidence": {"kind": "refutation"}}
    return json.dumps(header).encode() + b"\n" + body


def is_accepted(graph: Digraph, question: Question, body: bytes) -> bool:
    try:
        verify_tolerance(graph.canonical_bytes(), certificate(graph, question, body))
    except CertificateError:
        return False
    return True


def wander(graph: Digraph, question: Question, draw: random.Random, steps: float = math.inf) -> bytes:
    """Return the transcript of a random search by the kernel's own rules; what it cannot close it leaves out."""
    threat = Threat.of(decode_graph(graph.canonical_bytes()), *question)
    tokens: list[Token] = []
    waiting = [(Roles.of_all_solutions(graph.n), True)]
    while waiting:
        state, symmetric = waiting.pop()
        try:
            settle(threat, state)
            while draw.random() < 0.8 and exclude_some(threat, state, draw, tokens):
                tokens.append((PROPAGATE,))
                settle(threat, state)
        except Contradiction:
            continue
        choices: list[Token] = []
        for side, node in product((0, 1), range(graph.n)):
            if (state.P[side] & ~state.T[side]) >> node & 1:
                choices.append((NORMAL + side, node))
            if (state.Q[side] & ~(state.Z & state.F[side])) >> node & 1:
                choices.append((MALICIOUS + side, node))
        if symmetric and draw.random() < 0.8:
            choices = [(ROOT, node) for node in range(graph.n) if state.P[0] >> node & 1]
        if choices and len(tokens) < steps:
            token = draw.choice(choices)
            tokens.append(token)
            waiting += [
                (child(state, token, question, False), token[0] == ROOT),
                (child(state, token, question, True), False),
            ]
    return spell(tokens)


def exclude_some(threat: Threat, state: Roles, draw: random.Random, tokens: list[Token]) -> bool:
    nodes = range(len(threat.hears))
    found = [
        (side, j, i)
        for side, j, i in product((0, 1), nodes, nodes)
        if state.P[side] >> j & 1 and state.T[1 - side] >> i & 1 and excludes(threat, state, side, j, i)
    ]
    for side, j, i in {(side, j): (side, j, i) for side, j, i in draw.sample(found, min(len(found), 2))}.values():
        tokens.append((EXCLUDE + side, j, i))
        if state.T[side] >> j & 1:
            raise Contradiction
        state.P[side] &= ~(1 << j)
    return bool(found)


def child(state: Roles, token: Token, question: Question, is_true: bool) -> Roles:
    """Return a child of a branch, by the definition of the format."""
    opcode, node = token
    made, bit, side = state.copy(), 1 << node, 0 if opcode == ROOT else opcode & 1
    sides = (0, 1) if opcode == ROOT or (opcode >= MALICIOUS and question.two_faces) else (side,)
    if is_true and opcode >= MALICIOUS:
        made.Z |= bit
        made.F[side] |= bit
    elif is_true:
        made.T[side] |= bit
    for each in sides if not is_true else ():
        (made.Q if opcode >= MALICIOUS else made.P)[each] &= ~bit
    return made


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
