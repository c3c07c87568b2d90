"""Derivations: every step keeps what it says, in whatever chain; one thing wrong is refused; sizes are bounded."""

from __future__ import annotations

import json
import random
from copy import deepcopy
from itertools import pairwise
from typing import Any

import networkx as nx
import pytest

from certificates import CertificateError, MalformedCertificate, RejectedCertificate, derivation, verify
from certificates.derivation import Derivation
from robustness import Digraph
from tests.certificates.forging import certificate, claims, holds, searched, verdict_of
from tests.oracles import digraphs, graphs

Step = dict[str, Any]

SEEDS = [*graphs(2), *graphs(3), *graphs(4), *digraphs(2), *digraphs(3)[::2], Digraph([0], [])]


def some_step(made: Derivation, rng: random.Random) -> Step:
    """Return a step of some rule; most of them can be carried out, not all."""
    n = len(made.hears)
    pairs = [(u, v) for v in range(n) for u in range(n) if u != v]
    absent = [list(arc) for arc in pairs if arc[0] not in made.hears[arc[1]]]
    present = [list(arc) for arc in pairs if arc[0] in made.hears[arc[1]]]
    few = rng.randint(0, 2)
    return rng.choice(
        [
            {"rule": "weaken", "r": rng.randint(1, max(1, made.r)), "s": rng.randint(1, made.s + 1)},
            {"rule": "add-arcs", "arcs": rng.sample(absent, min(few, len(absent)))},
            {"rule": "remove-arcs", "arcs": rng.sample(present, min(few, len(present)))},
            {"rule": "remove-nodes", "nodes": sorted(rng.sample(range(n), min(1, n)))},
            {"rule": "add-node", "hears": sorted(rng.sample(range(n), min(n, made.r + made.s - 1)))},
            {"rule": "join-clique", "size": rng.randint(1, 2)},
            {"rule": "blow-up", "copies": rng.randint(1, 2), "cliques": rng.random() < 0.5},
        ]
    )


def network(made: Derivation) -> Digraph:
    return Digraph(range(len(made.hears)), [(u, v) for v, heard in enumerate(made.hears) for u in heard])


def evidence_of(seed: Digraph, r: int, s: int, steps: list[Step], ids: list[int]) -> dict[str, Any]:
    start = {"nodes": seed.n, "arcs": [list(arc) for arc in seed.arcs()], "r": r, "s": s}
    return {"kind": "derivation", "seed": start, "proof": {"kind": "refutation"}, "steps": steps, "ids": ids}


def chains(draws: int, seed: int, most: int = 7) -> list[tuple[Digraph, int, int, list[Step], Derivation]]:
    """Return seeds, what is true of them, steps that were carried out, and what they made."""
    rng, found = random.Random(seed), []
    for _ in range(draws):
        start = rng.choice(SEEDS)
        true = list(claims(start, true=True))
        if not true:
            continue
        r, s = rng.choice(true)
        made, steps = Derivation(start.n, [list(arc) for arc in start.arcs()], r, s), list[Step]()
        for _ in range(rng.randint(1, 5)):
            step, trial = some_step(made, rng), deepcopy(made)
            try:
                trial.take([step])
            except RejectedCertificate:
                continue
            if 1 <= len(trial.hears) <= most:
                made, steps = trial, [*steps, step]
        found.append((start, r, s, steps, made))
    return found


@pytest.mark.parametrize("draws", [250, pytest.param(20_000, marks=pytest.mark.slow)])
def test_whatever_the_steps_what_is_said_in_the_end_is_true(draws: int) -> None:
    """By the brute force, for s up to n: beyond, (r,s) says no more than (r,n)."""
    rules, sharp = set(), 0
    for _, _, _, steps, made in chains(draws, 1):
        graph = network(made)
        assert graph.n == 1 or holds(graph, made.r, min(made.s, graph.n))
        rules |= {step["rule"] for step in steps}
        sharp += graph.n > 1 and not holds(graph, made.r + 1, 1)
    assert len(rules) == 7
    assert sharp > draws // 10


def test_a_derivation_is_accepted_under_any_numbering() -> None:
    rng, accepted = random.Random(2), 0
    for start, r, s, steps, made in chains(150, 3):
        n = len(made.hears)
        ids = rng.sample(range(n), n)
        graph = Digraph(range(n), [(ids[u], ids[v]) for v, heard in enumerate(made.hears) for u in heard])
        if made.s > n or made.r > (n + 1) // 2:
            continue
        data = certificate(
            graph, made.r, made.s, evidence=evidence_of(start, r, s, steps, ids), body=searched(start, r, s)
        )
        claim = verify(graph.canonical_bytes(), data)
        assert (claim.verdict, claim.r, claim.s, claim.evidence) == ("robust", made.r, made.s, "derivation")
        accepted += 1
    assert accepted > 80


def test_one_change_is_refused_or_still_true() -> None:
    """Every number one up and one down, every list shorter, every step dropped or swapped, the claim raised."""
    tried = 0
    for start, r, s, steps, made in chains(16, 4, most=6):
        graph, ids = network(made), list(range(len(made.hears)))
        good = evidence_of(start, r, s, steps, ids)
        for r_claimed, s_claimed in {(made.r, made.s), (made.r + 1, 1), (made.r, made.s + 1)}:
            if s_claimed <= graph.n:
                for evidence in [good, *changes(good)]:
                    tried += 1
                    body = searched(start, r, s)
                    if verdict_of(graph, certificate(graph, r_claimed, s_claimed, evidence=evidence, body=body)):
                        assert graph.n == 1 or holds(graph, r_claimed, s_claimed)
    assert tried > 600


def changes(evidence: dict[str, Any]) -> list[dict[str, Any]]:
    found = []

    def walk(value: Any, put: Any) -> None:
        if isinstance(value, bool):
            put(not value)
        elif isinstance(value, int):
            put(value + 1)
            put(value - 1)
        elif isinstance(value, list):
            for i in range(len(value)):
                put(value[:i] + value[i + 1 :])
                put([*value[:i], *value[i : i + 1], *value[i:]])
                walk(value[i], lambda new, i=i: put([*value[:i], new, *value[i + 1 :]]))
            for i, _ in enumerate(pairwise(value)):
                put([*value[:i], value[i + 1], value[i], *value[i + 2 :]])
        elif isinstance(value, dict):
            for key in value:
                put({name: kept for name, kept in value.items() if name != key})
                walk(value[key], lambda new, key=key: put({**value, key: new}))

    walk(evidence, found.append)
    return found


WHEEL = Digraph.from_networkx(nx.wheel_graph(5))
GOOD = {
    "kind": "derivation",
    "seed": {"nodes": 4, "arcs": [[u, v] for u in range(4) for v in range(4) if u != v], "r": 2, "s": 4},
    "proof": {"kind": "degree"},
    "steps": [
        {"rule": "weaken", "r": 2, "s": 1},
        {"rule": "remove-nodes", "nodes": []},
        {"rule": "add-node", "hears": [0, 3]},
        {"rule": "add-arcs", "arcs": [[4, 0], [4, 3]]},
    ],
    "ids": [0, 1, 2, 3, 4],
}
MADE = Digraph(range(5), [(u, v) for u in range(4) for v in range(4) if u != v] + [(0, 4), (3, 4), (4, 0), (4, 3)])


def changed(path: str, value: object) -> dict[str, Any]:
    """Return GOOD with another value at a place like ``steps.0.r``."""
    document = json.loads(json.dumps(GOOD))
    *parents, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    place = document
    for key in parents:
        place = place[key]
    place[last] = value
    return document


def test_the_good_data_are_good() -> None:
    assert verify(MADE.canonical_bytes(), certificate(MADE, 2, 1, evidence=GOOD)).evidence == "derivation"


@pytest.mark.parametrize(
    ("path", "value", "error", "what"),
    [
        ("seed.nodes", 0, MalformedCertificate, "the number of nodes"),
        ("seed.nodes", 2**30, MalformedCertificate, "more than 4194304"),
        ("seed.nodes", 10**19, MalformedCertificate, "the number of nodes"),
        ("seed.nodes", 3, RejectedCertificate, r"step 0: an arc joins two different nodes in 0\.\.2"),
        ("seed.arcs", [[0, 0]], RejectedCertificate, "two different nodes"),
        ("seed.arcs", [[0, 1], [0, 1]], RejectedCertificate, "there already"),
        ("seed.arcs", [[0, 1, 2]], MalformedCertificate, "pairs of ids"),
        ("seed.arcs", [[0, True]], MalformedCertificate, "pairs of ids"),
        ("seed.arcs", 7, MalformedCertificate, "pairs of ids"),
        ("seed.arcs", [], RejectedCertificate, "least in-degree 0 is below"),
        ("seed.r", 3, RejectedCertificate, "least in-degree 3 is below"),
        ("seed.s", 0, MalformedCertificate, "s is an integer"),
        ("seed", [], MalformedCertificate, "the seed is an object"),
        ("proof", {"kind": "derivation"}, MalformedCertificate, "'degree' or 'refutation'"),
        ("proof", {"kind": "refutation"}, RejectedCertificate, "ends in the middle"),
        ("steps", {}, MalformedCertificate, "steps is a list"),
        ("steps.0", "weaken", MalformedCertificate, "step 1 is an object with exactly the keys of one rule"),
        ("steps.0.rule", "strengthen", MalformedCertificate, "exactly the keys of one rule"),
        ("steps.0.rule", ["weaken"], MalformedCertificate, "exactly the keys of one rule"),
        ("steps.0.more", 1, MalformedCertificate, "exactly the keys of one rule"),
        ("steps.0.r", 3, RejectedCertificate, r"step 1: \(3,1\) does not follow from \(2,4\)"),
        ("steps.0.s", 5, RejectedCertificate, r"\(2,5\) does not follow"),
        ("steps.0.r", 0, MalformedCertificate, "r is an integer"),
        ("steps.1.nodes", [4], RejectedCertificate, r"step 2: ids ascend strictly in 0\.\.3"),
        ("steps.1.nodes", [1, 0], RejectedCertificate, "ascend strictly"),
        ("steps.1.nodes", [0, 1], RejectedCertificate, "step 2: r is below 1"),
        ("steps.1.nodes", [None], MalformedCertificate, "a list of ids"),
        ("steps.1.nodes", 0, MalformedCertificate, "a list of ids"),
        ("steps.2.hears", [0], RejectedCertificate, r"step 3: the new node hears 1 nodes, below r \+ s - 1 = 2"),
        ("steps.2.hears", [0, 0], RejectedCertificate, "ascend strictly"),
        ("steps.2.hears", [0, 4], RejectedCertificate, "ascend strictly"),
        ("steps.2.hears", [0, 2], RejectedCertificate, "node 4 of the graph hears others"),
        ("steps.3.arcs", [[4, 0]], RejectedCertificate, "node 3 of the graph hears others"),
        ("steps.3.arcs", [[4, 5]], RejectedCertificate, "step 4: an arc joins"),
        ("steps.3", {"rule": "remove-arcs", "arcs": [[4, 0]]}, RejectedCertificate, "the arc 4, 0 is not there"),
        ("steps.3", {"rule": "remove-arcs", "arcs": [[0, 3], [1, 3]]}, RejectedCertificate, "r is below 1"),
        ("steps.3", {"rule": "join-clique", "size": 0}, MalformedCertificate, "the size is an integer"),
        ("steps.3", {"rule": "join-clique", "size": 2**31}, MalformedCertificate, "more than 4194304"),
        ("steps.3", {"rule": "blow-up", "copies": 2**31, "cliques": True}, MalformedCertificate, "more than 4194304"),
        ("steps.3", {"rule": "blow-up", "copies": 1, "cliques": 1}, MalformedCertificate, "true or false"),
        ("steps.3", {"rule": "blow-up", "copies": 2, "cliques": False}, RejectedCertificate, "for 10 nodes made"),
        ("ids", [0, 1, 2, 3], RejectedCertificate, "each of the 5 nodes once"),
        ("ids", [0, 1, 2, 3, 3], RejectedCertificate, "each of the 5 nodes once"),
        ("ids", [1, 0, 2, 3, 4], RejectedCertificate, "hears others"),
        ("ids", [0, 1, 2, 3, 5], MalformedCertificate, r"ids in 0\.\.4"),
    ],
)
def test_one_thing_wrong(path: str, value: object, error: type[CertificateError], what: str) -> None:
    with pytest.raises(error, match=what):
        verify(MADE.canonical_bytes(), certificate(MADE, 2, 1, evidence=changed(path, value)))


def test_a_claim_beyond_the_derivation() -> None:
    with pytest.raises(RejectedCertificate, match=r"\(2,2\) does not follow from \(2,1\)"):
        verify(MADE.canonical_bytes(), certificate(MADE, 2, 2, evidence=GOOD))
    with pytest.raises(MalformedCertificate, match="1 bytes follow"):
        verify(MADE.canonical_bytes(), certificate(MADE, 2, 1, evidence=GOOD, body=b"\0"))


def test_many_small_steps_are_bounded_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(derivation, "MAX_WORK", 1000)
    steps = [{"rule": "remove-nodes", "nodes": []}] * 100
    with pytest.raises(MalformedCertificate, match="step 23: the steps make more than 1000"):
        verify(MADE.canonical_bytes(), certificate(MADE, 2, 1, evidence=changed("steps", steps)))
