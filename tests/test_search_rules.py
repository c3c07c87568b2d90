"""Every rule of the subset search keeps every violating pair: by enumeration, on states at random."""

from __future__ import annotations

import itertools
import random

import networkx as nx
import numpy as np
import numpy.typing as npt
import pytest

import robustness as rb
from robustness.decision.algorithms.registry import OPTIONS
from robustness.definitions import is_violation, r_reachable_ids
from robustness.kernels.layout import MEMBER, SATISFIED, C, F, P, T
from robustness.kernels.search_rules import Rules, assume
from tests.oracles import brute_profile

#: What a literal is: kind, side, node, true.
Literal = tuple[int, int, int, bool]
#: A violating pair as its sides' members and their satisfied ones.
Solution = tuple[tuple[frozenset[int], frozenset[int]], tuple[frozenset[int], frozenset[int]]]


def solutions(graph: rb.Digraph, r: int, s: int) -> list[Solution]:
    """Return every violating pair, in either order."""
    found: list[Solution] = []
    for roles in itertools.product("-12", repeat=graph.n):
        sides = tuple(frozenset(i for i in range(graph.n) if roles[i] == role) for role in "12")
        if sides[0] and sides[1] and is_violation(graph, sides[0], sides[1], r, s):
            satisfied = tuple(side - r_reachable_ids(graph, side, r) for side in sides)
            found.append((sides, satisfied))  # type: ignore[arg-type]
    return found


def obeys(solution: Solution, literal: Literal) -> bool:
    kind, side, node, true = literal
    return (node in solution[kind == SATISFIED][side]) == true


def kept(solution: Solution, state: npt.NDArray[np.uint64]) -> bool:
    """Return whether the state still stands for the pair."""
    members, satisfied = solution
    for side in range(2):
        rows = [{i for i in range(64) if int(state[row + side, 0]) >> i & 1} for row in (C, P, F, T)]
        may_be, may_be_satisfied, is_member, is_satisfied = rows
        if not (is_member <= members[side] <= may_be and is_satisfied <= satisfied[side] <= may_be_satisfied):
            return False
    return True


def whole_state(n: int) -> npt.NDArray[np.uint64]:
    state = np.zeros((8, 1), np.uint64)
    state[:4] = (1 << n) - 1
    return state


@pytest.mark.parametrize("sharing", [False, True])
@pytest.mark.parametrize("blockers", [0, 1, 2])
@pytest.mark.parametrize("s", [1, 2, 3])
def test_propagation_keeps_every_violating_pair(blockers: int, s: int, sharing: bool) -> None:
    draw = random.Random(f"{blockers} {s}")
    stood_for = closed = 0
    for _ in range(40):
        n = draw.choice((5, 6))
        graph = rb.Digraph.from_networkx(
            nx.gnp_random_graph(n, draw.uniform(0.4, 1), seed=draw.randrange(2**31), directed=draw.random() < 0.6)
        )
        r = draw.choice((1, 2, 2, 3))
        every = solutions(graph, r, s)
        need = np.maximum(graph.in_degrees - r + 1, 0).astype(np.int64)
        for _ in range(12):
            if draw.random() < 0.5 or not every:
                literals: list[Literal] = [
                    (draw.choice((SATISFIED, MEMBER)), draw.randrange(2), draw.randrange(n), draw.random() < 0.5)
                    for _ in range(draw.randrange(4))
                ]
            else:
                # Part of a pair, so that counting has blockers that are tight.
                of = draw.choice(every)
                literals = [
                    (kind, side, node, node in of[kind == SATISFIED][side])
                    for kind, side, node in itertools.product((SATISFIED, MEMBER), range(2), range(n))
                    if draw.random() < 0.3
                ]
            state = whole_state(n)
            for kind, side, node, true in literals:
                assume(state, kind, side, node, true)
            expected = [pair for pair in every if all(obeys(pair, each) for each in literals)]
            alive = Rules(graph.in_words, need, s - 1, blockers, sharing).propagate(state) >= 0
            assert alive or not expected, (graph.in_masks, r, s, literals, expected[:1])
            closed += not alive
            for pair in expected if alive else ():
                stood_for += 1
                assert kept(pair, state), (graph.in_masks, r, s, literals, pair)
    assert stood_for > 1000
    assert closed > 20


@pytest.mark.parametrize("blockers", [0, 1, 2])
@pytest.mark.parametrize("look_ahead", [False, True])
@pytest.mark.parametrize("sharing", [False, True])
def test_no_switch_changes_an_answer(blockers: int, look_ahead: bool, sharing: bool) -> None:
    draw = random.Random(7)
    for _ in range(25):
        graph = rb.Digraph.from_networkx(
            nx.gnp_random_graph(draw.choice((6, 7)), draw.uniform(0.4, 1), seed=draw.randrange(2**31), directed=True)
        )
        for r, s_max in brute_profile(graph).items():
            for s in {max(s_max, 1), min(s_max + 1, graph.n)}:
                switches = {"blockers": blockers, "look_ahead": look_ahead, "sharing": sharing}
                found = rb.check_rs_robustness(graph, r, s, algorithm="subset-search", **switches)
                assert found.verdict is (rb.Verdict.ROBUST if s <= s_max else rb.Verdict.NOT_ROBUST)


def test_counting_and_looking_ahead_save_what_they_are_for() -> None:
    graph = nx.gnp_random_graph(24, 0.6, seed=2)
    r = rb.determine_robustness(graph, algorithm="subset-search").r
    nodes = [
        rb.check_rs_robustness(graph, r, algorithm="subset-search", **switches).stats["nodes"]
        for switches in ({"blockers": 0}, {"blockers": 1}, {"blockers": 1, "look_ahead": False})
    ]
    assert nodes[1] < nodes[0]
    assert nodes[1] < nodes[2]


def test_sharing_saves_what_it_is_for() -> None:
    graph = rb.Digraph.from_networkx(nx.gnp_random_graph(18, 0.6, seed=3))
    nodes = [
        rb.check_rs_robustness(graph, 4, 3, algorithm="subset-search", blockers=1, sharing=sharing).stats["nodes"]
        for sharing in (True, False)
    ]
    assert nodes[0] < nodes[1]


def test_each_rule_of_the_search_has_a_switch() -> None:
    """Those in docs/certificate-format.md which are more than what a state means, and look-ahead."""
    assert OPTIONS["subset-search"] - {"transcript"} == {"blockers", "sharing", "look_ahead"}
    with pytest.raises(rb.InvalidParameter, match="transcript is recorded with the rule share on"):
        rb.check_rs_robustness(nx.petersen_graph(), 2, algorithm="subset-search", transcript=True, sharing=False)


def test_blockers_are_none_one_or_two() -> None:
    with pytest.raises(rb.InvalidParameter, match="blockers is 0, 1 or 2, not 3"):
        rb.check_rs_robustness(nx.petersen_graph(), 2, algorithm="subset-search", blockers=3)
