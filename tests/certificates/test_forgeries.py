"""No certificate of a false claim is accepted: forgeries of every kind for every small graph that is not robust.

The property is always the same: accepted implies true, by the brute force of ``tests.oracles``.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import combinations

import networkx as nx
import pytest

from robustness import Digraph
from tests.certificates.forging import (
    Token,
    certificate,
    claims,
    holds,
    read,
    searched,
    spell,
    verdict_of,
    wander,
)
from tests.oracles import digraphs, graphs

SMALL = [graph for n in (2, 3, 4, 5) for graph in graphs(n)] + [graph for n in (2, 3) for graph in digraphs(n)]
LARGER = [graph for n, step in ((6, 16), (7, 174)) for graph in graphs(n)[::step]] + list(digraphs(4)[::24])


def assert_refused(graph: Digraph, r: int, s: int, body: bytes) -> None:
    assert not holds(graph, r, s)
    assert verdict_of(graph, certificate(graph, r, s, body=body)) is None, (graph.canonical_bytes(), r, s, body)


def proofs(n: int, graphs: list[Digraph]) -> set[bytes]:
    """Return the transcripts of all true claims about the graphs on n nodes."""
    return {searched(graph, r, s) for graph in graphs if graph.n == n for r, s in claims(graph, true=True)}


@pytest.mark.parametrize("family", [SMALL, LARGER], ids=["small", "larger"])
def test_a_proof_about_another_graph_or_for_another_r_and_s(family: list[Digraph]) -> None:
    """Every transcript of a robust sibling, bound anew to a graph and a claim for which it is false."""
    tried = 0
    for n in {graph.n for graph in family}:
        bodies = sorted(proofs(n, family))
        for graph in (graph for graph in family if graph.n == n):
            for r, s in claims(graph, true=False):
                for body in random.Random(tried).sample(bodies, min(len(bodies), 6)):
                    assert_refused(graph, r, s, body)
                    tried += 1
    assert tried > 1500


@pytest.mark.slow
def test_every_proof_about_another_small_graph() -> None:
    for n in (2, 3, 4, 5):
        bodies = proofs(n, SMALL)
        for graph in (graph for graph in SMALL if graph.n == n):
            for r, s in claims(graph, true=False):
                for body in bodies:
                    assert_refused(graph, r, s, body)


@pytest.mark.parametrize("family", [SMALL, LARGER], ids=["small", "larger"])
def test_a_search_that_leaves_out_what_it_cannot_close(family: list[Digraph]) -> None:
    """Sound step by step, and closed wherever the rules close it: it fails for its missing leaves alone."""
    rng, tried = random.Random(11), 0
    for graph in family:
        for r, s in claims(graph, true=False):
            body = wander(graph, r, s, rng, steps=20)
            assert_refused(graph, r, s, body)
            # The leaves it could not close, filled with what closes leaves elsewhere.
            tokens = read(body)
            for filler in ((rng.choice((6, 7)), 0, 1), (rng.randint(1, 5), rng.randrange(graph.n))):
                tokens.insert(rng.randint(0, len(tokens)), filler)
                assert_refused(graph, r, s, spell(tokens))
            tried += 1
    assert tried > 400


def test_an_odd_search_for_a_true_claim_is_a_proof() -> None:
    """The rules and branches alone make proofs, whoever chooses them: random choices do, with every kind of step."""
    rng, seen = random.Random(12), set()
    for graph in SMALL + LARGER:
        for r, s in 3 * list(claims(graph, true=True)):
            body = wander(graph, r, s, rng)
            claim = verdict_of(graph, certificate(graph, r, s, body=body))
            assert claim is not None
            assert (claim.verdict, claim.r, claim.s, claim.evidence) == ("robust", r, s, "refutation")
            seen |= {token[0] for token in read(body)}
    assert seen == set(range(10))


def test_random_transcripts() -> None:
    rng, tried = random.Random(13), 0
    for graph in SMALL:
        for r, s in claims(graph, true=False):
            for _ in range(5):
                opcodes = [rng.choice((0, 1, 2, 3, 4, 5, 6, 7, 8, 9)) for _ in range(rng.randint(0, 12))]
                sizes = (0, 1, 1, 1, 1, 1, 2, 2, 3, 3)
                tokens = [(code, *(rng.randrange(graph.n) for _ in range(sizes[code]))) for code in opcodes]
                assert_refused(graph, r, s, spell(tokens))
                tried += 1
    assert tried > 2000


def changes(tokens: list[Token], n: int) -> Iterator[bytes]:
    """Yield every transcript that differs in one number, a dropped or repeated stretch, or one swap."""
    body = spell(tokens)
    for place in range(len(body)):
        for value in {*range(max(10, n)), body[place] | 128, body[place] ^ 64} - {body[place]}:
            yield body[:place] + bytes([value]) + body[place + 1 :]
    for start, stop in combinations(range(len(tokens) + 1), 2):
        # A subtree is a stretch of steps, so every dropped and every repeated subtree is among these.
        yield spell(tokens[:start] + tokens[stop:])
        yield spell(tokens[:stop] + tokens[start:])
        if stop < len(tokens):
            yield spell([*tokens[:start], tokens[stop], *tokens[start + 1 : stop], tokens[start], *tokens[stop + 1 :]])
    for end in range(len(body)):
        yield body[:end]
    for tail in (b"\0", b"\1", b"\1\0", b"\n", body):
        yield body + tail


def test_one_change_in_a_proof_leaves_a_proof_or_is_refused() -> None:
    """Whatever is still accepted after the change is a proof of the same true claim; most changes are refused."""
    accepted = refused = 0
    for graph in [*graphs(5)[::5], *digraphs(3)[::2]]:
        for r, s in claims(graph, true=True):
            tokens = read(searched(graph, r, s))
            if len(tokens) > 16:
                continue
            for body in changes(tokens, graph.n):
                claim = verdict_of(graph, certificate(graph, r, s, body=body))
                accepted += claim is not None
                refused += claim is None
                assert claim is None or (claim.verdict, claim.r, claim.s) == ("robust", r, s)
    assert accepted < refused / 4


def test_one_change_in_a_proof_does_not_carry_it_to_a_false_claim() -> None:
    """The same changes, with the claim raised to the next r or s, which is false, in the same stroke."""
    tried = 0
    for graph in [*graphs(4), *graphs(5)[::4], *digraphs(3)[::2]]:
        false = set(claims(graph, true=False))
        for r, s in claims(graph, true=True):
            for wrong in {(r, s + 1), (r + 1, s), (r + 1, 1)} & false:
                tokens = read(searched(graph, r, s))
                rng = random.Random(tried)
                bodies = list(changes(tokens, graph.n)) if len(tokens) <= 16 else [spell(tokens)]
                for body in rng.sample(bodies, min(len(bodies), 100)):
                    assert_refused(graph, *wrong, body)
                    tried += 1
    assert tried > 5000


def test_another_graph_with_the_same_degrees() -> None:
    """Two triangles are not 1-robust, the hexagon is; K_{3,3} is 2-robust, the prism 1-robust."""
    triangles = nx.disjoint_union(nx.cycle_graph(3), nx.cycle_graph(3))
    for robust, sibling, r in (
        (nx.cycle_graph(6), triangles, 1),
        (nx.complete_bipartite_graph(3, 3), nx.circular_ladder_graph(3), 2),
    ):
        graph, other = Digraph.from_networkx(robust), Digraph.from_networkx(sibling)
        assert sorted(graph.in_degrees) == sorted(other.in_degrees)
        honest = certificate(graph, r, 1, body=searched(graph, r, 1))
        assert verdict_of(graph, honest) is not None
        assert verdict_of(other, honest) is None
        assert_refused(other, r, 1, searched(graph, r, 1))


def test_other_evidence_for_false_claims() -> None:
    """Degree, growth from every seed in a good order, and pairs of all kinds."""
    rng = random.Random(14)
    for graph in SMALL + LARGER:
        everyone = list(range(graph.n))
        for r, s in claims(graph, true=False):
            assert verdict_of(graph, certificate(graph, r, s, evidence={"kind": "degree"})) is None
            seed = sorted(rng.sample(everyone, rng.randint(1, graph.n)))
            order = sorted(set(everyone) - set(seed), key=lambda node: -int(graph.in_degrees[node]))
            for proof, body in (("degree", b""), ("refutation", wander(graph, r, s, rng, steps=4))):
                evidence = {"kind": "growth", "seed": seed, "order": order, "proof": {"kind": proof}}
                assert verdict_of(graph, certificate(graph, r, s, evidence=evidence, body=body)) is None


def test_pairs_are_accepted_exactly_when_they_violate_the_definition() -> None:
    for graph in [*graphs(4)[::3], *graphs(3), *digraphs(3)[::2]]:
        subsets = [list(chosen) for size in range(graph.n + 1) for chosen in combinations(range(graph.n), size)]
        for r, s in [*claims(graph, true=True), *claims(graph, true=False)]:
            accepted = 0
            for S1 in subsets:
                for S2 in subsets:
                    evidence = {"kind": "violation", "S1": S1, "S2": S2}
                    accepted += verdict_of(graph, certificate(graph, r, s, "not-robust", evidence)) is not None
            assert (accepted == 0) is holds(graph, r, s)


def test_growth_is_accepted_for_true_claims_only() -> None:
    """Every seed with its own proof, every order: accepted or not, nothing false comes out."""
    rng, accepted = random.Random(15), 0
    for graph in SMALL + LARGER:
        everyone = list(range(graph.n))
        for size in range(1, graph.n + 1):
            seed = sorted(rng.sample(everyone, size))
            place = {node: i for i, node in enumerate(seed)}
            arcs = [(place[u], place[v]) for u, v in graph.arcs() if u in place and v in place]
            induced = Digraph(range(size), arcs)
            order = [node for node in everyone if node not in place]
            rng.shuffle(order)
            for r, s in claims(induced, true=True):
                for proof, body in (("refutation", searched(induced, r, s)), ("degree", b"")):
                    evidence = {"kind": "growth", "seed": seed, "order": order, "proof": {"kind": proof}}
                    claim = verdict_of(graph, certificate(graph, r, s, evidence=evidence, body=body))
                    assert claim is None or holds(graph, r, s)
                    accepted += claim is not None
    assert accepted > 500
