"""Every question has a certificate, and it proves the oracle's verdict: whichever evidence, one thread or two."""

from __future__ import annotations

import json
import random

import networkx as nx
import pytest

from certificates import VerifiedClaim, masks, verify
from robustness import Digraph
from robustness.decision.certification import certify
from robustness.results import Verdict
from tests.certificates.forging import claims, holds
from tests.oracles import digraphs, graphs


def certified(graph: Digraph, r: int, s: int = 1, **options: object) -> VerifiedClaim:
    """Return the claim of the certificate, after a look at the result that carries it."""
    result = certify(graph, r, s, **options)
    assert result.certificate is not None
    claim = verify(graph.canonical_bytes(), result.certificate)
    assert (claim.verdict, claim.r, claim.s, claim.sha256) == (result.verdict.value, r, s, graph.sha256)
    return claim


def assert_complete(graph: Digraph, r: int, s: int) -> None:
    verdict = "robust" if holds(graph, r, s) else "not-robust"
    for evidence in ("shortest", "refutation"):
        claim = certified(graph, r, s, evidence=evidence)
        assert claim.verdict == verdict
        assert claim.evidence in {"not-robust": {"violation"}, "robust": {"degree", "growth", "refutation"}}[verdict]
        assert evidence == "shortest" or claim.evidence in ("violation", "refutation")


FAST = [
    *(graph for n in (2, 3, 4) for graph in graphs(n)),
    *(graph for n in (2, 3) for graph in digraphs(n)),
    *graphs(5)[::4],
    *graphs(6)[::26],
    *digraphs(4)[::36],
]


@pytest.mark.parametrize(
    "family",
    [
        pytest.param(FAST, id="some"),
        pytest.param([*graphs(5), *graphs(6), *digraphs(4)], id="all", marks=pytest.mark.slow),
    ],
)
def test_small_graphs(family: list[Digraph]) -> None:
    for graph in family:
        for true in (True, False):
            for r, s in claims(graph, true=true):
                assert_complete(graph, r, s)


def test_graphs_beyond_brute_force() -> None:
    """The kernel settles every state as the search did, or it would miss a step: here with nodes exempt in plenty."""
    rng, proven = random.Random(16), 0
    for _ in range(120):
        n = rng.randint(8, 14)
        drawn = nx.gnp_random_graph(n, rng.uniform(0.3, 0.95), seed=rng.randrange(2**30), directed=rng.random() < 0.5)
        graph, r, s = Digraph.from_networkx(drawn), rng.randint(1, (n + 1) // 2), rng.randint(1, n)
        proven += certified(graph, r, s, evidence="refutation", jobs=rng.choice((1, 2))).evidence == "refutation"
    assert proven > 20


def test_parts_of_two_threads_are_joined() -> None:
    graph = Digraph.from_networkx(nx.gnp_random_graph(40, 0.5, seed=1))
    result = certify(graph, 10, evidence="refutation", jobs=2)
    assert result.verdict is Verdict.ROBUST
    assert result.stats["cubes"] > 1
    claim = verify(graph.canonical_bytes(), result.certificate)
    assert (claim.verdict, claim.r, claim.evidence) == ("robust", 10, "refutation")
    assert claim.tree_nodes > 100


@pytest.mark.parametrize(
    ("graph", "r", "most"),
    [
        (nx.gnp_random_graph(40, 0.5, seed=1), 10, 100_000),
        (nx.complete_graph(60), 30, 5_000),
        (nx.gnp_random_graph(60, 0.8, seed=1), 24, 200_000),
    ],
    ids=["G(40,.5)", "K_60", "G(60,.8)"],
)
@pytest.mark.parametrize("evidence", ["shortest", "refutation"])
def test_certificates_are_small(graph: nx.Graph, r: int, most: int, evidence: str) -> None:
    result = certify(graph, r, evidence=evidence)
    assert result.verdict is Verdict.ROBUST
    assert len(result.certificate) < most


def test_the_shortest_evidence_is_chosen() -> None:
    assert certified(Digraph.from_networkx(nx.complete_graph(9)), 5, 9).evidence == "degree"
    grown = nx.complete_graph(7)
    for node in range(7, 60):
        grown.add_edges_from((node, other) for other in range(node - 4, node))
    claim = certified(Digraph.from_networkx(grown), 4)
    assert (claim.evidence, claim.tree_nodes) == ("growth", 0)
    assert certified(Digraph.from_networkx(grown), 4, evidence="refutation").evidence == "refutation"


def test_a_growth_whose_seed_needs_a_refutation() -> None:
    """The seed's transcript speaks of the seed's own ids, here far from those of the whole graph."""
    graph = Digraph.from_networkx(nx.barabasi_albert_graph(60, 4, seed=3))
    claim = certified(graph, 2)
    assert claim.verdict == "robust"
    wheel = nx.relabel_nodes(nx.wheel_graph(6), {i: 2 * i + 3 for i in range(6)})
    wheel.add_edges_from((node, other) for node in (0, 1, 2, 4) for other in (3, 5))
    body = certify(nx.wheel_graph(6), 2, evidence="refutation").certificate.split(b"\n", 1)[1]
    whole = Digraph.from_networkx(wheel)
    evidence = {
        "kind": "growth",
        "seed": sorted(whole.ids(range(3, 14, 2))),
        "order": sorted(whole.ids((0, 1, 2, 4))),
        "proof": {"kind": "refutation"},
    }
    claim = {"property": "rs-robust", "r": 2, "s": 1, "verdict": "robust"}
    header = {"format": "robustness/certificate/1", "graph": whole.sha256, "claim": claim, "evidence": evidence}
    found = verify(whole.canonical_bytes(), json.dumps(header).encode() + b"\n" + body)
    assert found.evidence == "growth"
    assert found.tree_nodes > 1


@pytest.mark.slow
@pytest.mark.parametrize("s", [1, 2, 4])
def test_larger_graphs(s: int) -> None:
    for seed in range(40):
        graph = Digraph.from_networkx(nx.gnp_random_graph(24, 0.3 + 0.015 * seed, seed=seed, directed=bool(seed % 2)))
        for r in range(1, 8):
            certified(graph, r, s, evidence="refutation", jobs=1 + seed % 2)


def test_a_proof_beyond_the_limits_of_the_kernel_certifies_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then the answer is undecided, for want of evidence, and says why."""
    monkeypatch.setattr(masks, "MAX_LOOKS", 3)
    result = certify(nx.wheel_graph(5), 2, evidence="refutation")
    assert (result.verdict, result.certificate) == (Verdict.UNDECIDED, None)
    assert "beyond what the kernel checks" in result.stats["reason"]
