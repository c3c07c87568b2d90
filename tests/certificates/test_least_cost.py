"""The kernel's tree over choices confirms a least cost exactly when no choice is cheaper, each of them tried."""

from __future__ import annotations

import json
import random
from itertools import combinations
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from certificates import verify_mending
from certificates.least_cost import DEFAULT_CHOICES, no_choice_is_cheaper
from robustness.definitions import is_violation
from robustness.digraph import Digraph, as_digraph
from robustness.mending import certify_mending
from robustness.traps.question import Question as TrapQuestion
from robustness.traps.question import Sets, solves

PARTS: list[dict[str, Any]] = [
    {"r": 1, "s": 1},
    {"r": 2, "s": 1},
    {"r": 2, "s": 2},
    {"r": 3, "s": 1},
    {"r": 2, "s": 3},
    {"r": 3, "s": 2},
    {"f": 1, "faces": 1, "bound": "total"},
    {"f": 1, "faces": 2, "bound": "total"},
    {"f": 1, "faces": 1, "bound": "local"},
    {"f": 1, "faces": 2, "bound": "local"},
]


def violates(graph: Digraph, part: dict[str, Any], M: list[int], S1: list[int], S2: list[int]) -> bool:
    """Say by the definitions whether the sets violate the part."""
    if "r" in part:
        return is_violation(graph, frozenset(S1), frozenset(S2), part["r"], part["s"])
    question = TrapQuestion(part["f"], part["faces"] == 2, part["bound"] == "local")
    return solves(graph, question, Sets(frozenset(M), frozenset(S1), frozenset(S2)))


def mended(graph: Digraph, document: dict[str, Any], chosen: frozenset[int]) -> Digraph:
    arcs = set(graph.arcs())
    for a in chosen:
        u, v, _ = document["actions"]["links"][a]
        arcs |= {(u, v)} if document["actions"]["one_way"] else {(u, v), (v, u)}
    return Digraph(graph.labels, sorted(arcs), directed=True)


def least_by_trying(graph: Digraph, document: dict[str, Any]) -> int | None:
    """Return what the cheapest choice costs that keeps the constraints and breaks all pairs, by trying every choice."""
    actions, costs = document["actions"], []
    for size in range(len(actions["links"]) + 1):
        for some in combinations(range(len(actions["links"])), size):
            chosen = frozenset(some)
            after = mended(graph, document, chosen)
            gains = [len(after.in_neighbours(i)) - len(graph.in_neighbours(i)) for i in range(graph.n)]
            caps = actions["most"] or [graph.n] * graph.n
            if not set(actions["required"]) <= chosen or any(g > cap for g, cap in zip(gains, caps, strict=True)):
                continue
            if not any(violates(after, document["claim"]["parts"][k], *sets) for k, *sets in document["pairs"]):
                costs.append(sum(actions["links"][a][2] for a in chosen))
    return min(costs, default=None)


def question(rng: random.Random) -> tuple[Digraph, dict[str, Any]]:
    """Return a small graph, links for it, and violations of one or two parts in it."""
    n, one_way = rng.randint(3, 6), rng.random() < 0.5
    directed = one_way or rng.random() < 0.3
    graph = as_digraph(
        nx.gnp_random_graph(n, rng.choice([0.1, 0.3, 0.6]), seed=rng.randrange(10**6), directed=directed)
    )
    arcs = set(graph.arcs())
    ends = [(u, v) for u in range(n) for v in range(n) if u != v and (one_way or u < v)]
    free = [(u, v) for u, v in ends if not {(u, v), (u, v) if one_way else (v, u)} <= arcs]
    links = sorted(rng.sample(free, min(len(free), rng.randint(0, 8))))
    few = rng.random() < 0.3
    parts = rng.sample(PARTS, rng.randint(1, 2))
    pairs = []
    for _ in range(60):
        k = rng.randrange(len(parts))
        places = [rng.choice(["M", "S1", "S2", ""] if "f" in parts[k] else ["S1", "S2", ""]) for _ in range(n)]
        M, S1, S2 = ([i for i in range(n) if places[i] == name] for name in ("M", "S1", "S2"))
        if "f" in parts[k] and parts[k]["faces"] == 1:  # with one face M lies in the two sides
            for i in M:
                (S1 if rng.random() < 0.5 else S2).append(i)
        if S1 and S2 and violates(graph, parts[k], M, sorted(S1), sorted(S2)):
            pairs.append([k, M, sorted(S1), sorted(S2)])
    actions = {
        "one_way": one_way,
        "links": [[u, v, rng.choice([0, 1, 1, 2, 5]) if few else 1] for u, v in links],
        "required": sorted(rng.sample(range(len(links)), min(len(links), rng.choice([0, 0, 1, 2])))),
        "most": [rng.randint(0, 3) for _ in range(n)] if rng.random() < 0.3 else None,
        "chosen": None,
    }
    return graph, {
        "claim": {"parts": parts, "cost": None, "least": None},
        "actions": actions,
        "pairs": pairs,
        "covers": [],
    }


@pytest.mark.parametrize("seed", range(120))
def test_against_every_choice(seed: int) -> None:
    graph, document = question(random.Random(seed))
    hears = [sorted(graph.in_neighbours(i).tolist()) for i in range(graph.n)]
    least = least_by_trying(graph, document)
    for claimed in [*range(len(document["actions"]["links"]) + 3), None]:
        document["claim"]["least"] = claimed
        is_true = least is None or (claimed is not None and claimed <= least)
        assert no_choice_is_cheaper(hears, document, lambda looked: looked < 10**6) == is_true, (claimed, least)


def test_the_questions_are_of_all_kinds() -> None:
    """Else the comparison above would show little."""
    asked = [question(random.Random(seed)) for seed in range(120)]
    least = [least_by_trying(graph, document) for graph, document in asked]
    assert {None, 0, 1, 2, 3} <= set(least)
    used = [document["claim"]["parts"][pair[0]] for _, document in asked for pair in document["pairs"]]
    assert all(part in used for part in PARTS)
    assert sum(document["actions"]["most"] is not None for _, document in asked) > 20


@pytest.mark.parametrize("goal", [rb.Goal(2, 2), rb.Goal(3), rb.Goal(2, 3), rb.Goal(survive=1, model="delayed")])
@pytest.mark.parametrize("n", [5, 6])
def test_what_mend_finds_is_proven_and_not_one_more(n: int, goal: rb.Goal) -> None:
    for seed in range(6):
        network = as_digraph(nx.gnp_random_graph(n, 0.4, seed=seed))
        found = rb.mend(network, goal)
        data = certify_mending(found)
        assert data is not None
        claim = verify_mending(network.canonical_bytes(), data, lambda looked: looked < 50_000)
        assert claim.least == found.cost
        header = data.partition(b"\n")[0]
        higher = header.replace(
            b'"cost":%d,"least":%d' % (found.cost, found.cost), b'"cost":null,"least":%d' % (found.cost + 1)
        )  # type: ignore[operator]
        chosen = higher[higher.index(b'"chosen":') : higher.index(b"}", higher.index(b'"chosen":'))]
        higher = higher.replace(chosen, b'"chosen":null')
        higher = higher[: higher.index(b'"lengths":')] + b'"lengths":[]}\n'
        assert not verify_mending(network.canonical_bytes(), higher, lambda looked: looked < 5_000).is_least


def test_covers_alone_where_they_cost_too_much() -> None:
    """What the rigid components of a path lack is proven without a tree; one link more is not."""
    path = as_digraph(nx.path_graph(8))
    data = certify_mending(rb.mend(path, (2, 2)))
    assert data is not None
    claim = verify_mending(path.canonical_bytes(), data, lambda looked: looked < DEFAULT_CHOICES)
    assert (claim.least, claim.covers > 0, claim.is_least) == (6, True, True)


def test_it_stops_when_it_is_told_to() -> None:
    path = as_digraph(nx.path_graph(7))
    data = certify_mending(rb.mend(path, 3))
    assert data is not None
    asked: list[int] = []

    def may_go_on(looked: int) -> bool:
        asked.append(looked)
        return looked < 5

    assert not verify_mending(path.canonical_bytes(), data, may_go_on).is_least
    assert asked == [0, 0, 1, 2, 3, 4, 5]
    assert not verify_mending(path.canonical_bytes(), data).is_least


def test_a_cover_whose_links_can_be_paid_for_demands_nothing() -> None:
    """It may be met by those links, and which they are is left to a solver."""
    path = as_digraph(nx.path_graph(5))
    data = certify_mending(rb.mend(path, (2, 2)))
    assert data is not None
    header, _, body = data.partition(b"\n")
    document = json.loads(header)
    document["pairs"], document["covers"] = [], [[0, [[0, 1]], [0, 1, 2, 3, 4]]]
    told = json.dumps(document).encode() + b"\n" + body
    assert not verify_mending(path.canonical_bytes(), told, lambda looked: looked < 1_000).is_least
    document["covers"] = [[0, [[0, 1]], [0, 1], [1, 2], [2, 3], [3, 4]]]
    told = json.dumps(document).encode() + b"\n" + body
    assert verify_mending(path.canonical_bytes(), told, lambda looked: looked < 1_000).is_least


def test_a_long_chain_of_links_given_up_is_cut() -> None:
    """Each round at the root gives up one link more; it is the nodes that may_go_on counts, so rounds are few."""
    n = 40
    pairs = [[0, [], [0, e], [2 if e == 1 else 1]] for e in range(1, n)]
    header = {
        "claim": {"parts": [{"r": 1, "s": 1}], "cost": None, "least": 2},
        "actions": {"one_way": True, "links": [[j, 0, 1] for j in range(1, n)], "required": [], "most": None},
        "pairs": pairs,
        "covers": [],
    }
    asked: list[int] = []
    assert no_choice_is_cheaper([[]] * n, header, lambda looked: not asked.append(looked))  # type: ignore[func-returns-value]
    assert len(asked) > 2
    header["claim"]["least"] = 3  # type: ignore[index]
    assert not no_choice_is_cheaper([[]] * n, header, lambda looked: True)


def test_what_is_too_large_to_write_down_has_no_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    path = as_digraph(nx.path_graph(6))
    data = certify_mending(rb.mend(path, (2, 2)))
    assert data is not None
    assert verify_mending(path.canonical_bytes(), data, lambda looked: looked < 1_000).is_least
    monkeypatch.setattr("certificates.least_cost._MOST_WORK", 100)
    assert not verify_mending(path.canonical_bytes(), data, lambda looked: True).is_least
    asked: list[int] = []
    assert not verify_mending(path.canonical_bytes(), data, asked.append).is_least  # type: ignore[arg-type]
    assert asked == [0]
