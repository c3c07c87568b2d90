"""Each rule about roles keeps every solution that a state stands for: by enumeration, on states at random.

The states are not only those that a transcript can reach.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import networkx as nx
import pytest

from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.roles import Roles, Threat, excludes, settle
from robustness import Digraph
from robustness.traps.question import Question, Sets, solves

KINDS = list(product((False, True), (False, True)))


class Solution(NamedTuple):
    """Normal members and malicious nodes inside either side, as masks."""

    normal: tuple[int, int]
    malicious: tuple[int, int]

    def fits(self, state: Roles) -> bool:
        return not state.Z & ~(self.malicious[0] | self.malicious[1]) and all(
            not self.normal[k] & ~state.P[k]
            and not state.T[k] & ~self.normal[k]
            and not self.malicious[k] & ~state.Q[k]
            and not state.F[k] & ~(self.normal[k] | self.malicious[k])
            for k in (0, 1)
        )


def mask(roles: tuple[str, ...], wanted: str) -> int:
    return sum(1 << i for i, role in enumerate(roles) if role in wanted)


def solutions(graph: Digraph, question: Question) -> list[Solution]:
    """Return all solutions, from the definition."""
    found = []
    for roles in product("-12M" if question.two_faces else "-12ab", repeat=graph.n):
        held = {role: frozenset(i for i in range(graph.n) if roles[i] == role) for role in "12Mab"}
        if solves(
            graph, question, Sets(held["M"] | held["a"] | held["b"], held["1"] | held["a"], held["2"] | held["b"])
        ):
            found.append(Solution((mask(roles, "1"), mask(roles, "2")), (mask(roles, "Ma"), mask(roles, "Mb"))))
    return found


def subset(nodes: int, draw: random.Random, share: float) -> int:
    return sum(1 << i for i in range(nodes.bit_length()) if nodes >> i & 1 and draw.random() < share)


def some_state(n: int, solution: Solution, draw: random.Random) -> Roles:
    """Return a state that stands for this solution and, more often than not, for others."""
    everyone = (1 << n) - 1
    loose, fixed = draw.choice((0.3, 0.7, 0.95)), draw.choice((0.0, 0.3, 0.8, 1.0))
    P, Q, F, T = ([0, 0] for _ in range(4))
    for k in (0, 1):
        P[k] = solution.normal[k] | subset(everyone, draw, loose)
        Q[k] = solution.malicious[k] | subset(everyone, draw, loose)
        T[k] = subset(solution.normal[k], draw, fixed)
        F[k] = subset(solution.normal[k] | solution.malicious[k], draw, fixed)
    return Roles(P, Q, F, T, subset(solution.malicious[0] | solution.malicious[1], draw, fixed))


def cases(kind: tuple[bool, bool], draws: int) -> Iterator[tuple[Threat, list[Solution], Roles, random.Random]]:
    draw = random.Random(f"{kind}")
    for _ in range(draws):
        n = draw.choice((2, 3, 4, 5, 5))
        drawn = nx.gnp_random_graph(
            n, draw.choice((0.4, 0.7, 1)), seed=draw.randrange(2**30), directed=draw.random() < 0.7
        )
        graph = Digraph.from_networkx(drawn)
        question = Question(draw.choice((0, 1, 1, 2)), *kind)
        every = solutions(graph, question)
        threat = Threat.of(decode_graph(graph.canonical_bytes()), *question)
        for _ in range(8 if every else 0):
            yield threat, every, some_state(n, draw.choice(every), draw), draw


DRAWS = [100, pytest.param(5_000, marks=pytest.mark.slow)]


@pytest.mark.parametrize("draws", DRAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_settling_keeps_every_solution_and_is_idempotent(kind: tuple[bool, bool], draws: int) -> None:
    looked = stood_for = 0
    for threat, every, state, _ in cases(kind, draws):
        before = state.sets()
        kept = [each for each in every if each.fits(state)]
        assert kept
        settle(threat, state)
        looked += state.sets() != before
        stood_for += len(kept)
        assert all(each.fits(state) for each in kept)
        again = Roles(state.P[:], state.Q[:], state.F[:], state.T[:], state.Z)
        settle(threat, again)
        assert again.sets() == state.sets()
    assert looked > 100
    assert stood_for > 1000


@pytest.mark.parametrize("draws", DRAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_contradictory_state_stands_for_no_solution(kind: tuple[bool, bool], draws: int) -> None:
    """With a literal or two turned against the solution that the state was made for."""
    seen: Counter[bool] = Counter()
    for threat, every, state, draw in cases(kind, draws):
        for _ in range(draw.randint(1, 3)):
            row, side, bit = (
                draw.choice((state.P, state.Q, state.F, state.T)),
                draw.randrange(2),
                1 << draw.randrange(5),
            )
            row[side] = (
                row[side] & ~bit if row in (state.P, state.Q) else row[side] | bit & (1 << len(threat.hears)) - 1
            )
        kept = [each for each in every if each.fits(state)]
        try:
            settle(threat, state)
        except Contradiction:
            assert not kept
        assert not kept or all(each.fits(state) for each in kept)
        seen[bool(kept)] += 1
    assert min(seen.values()) > 50


@pytest.mark.parametrize("draws", DRAWS)
@pytest.mark.parametrize("kind", KINDS)
def test_an_exclusion_excludes_no_solution_also_after_others(kind: tuple[bool, bool], draws: int) -> None:
    done = 0
    for threat, every, state, draw in cases(kind, draws):
        if draw.random() < 0.3:
            settle(threat, state)
        kept = [each for each in every if each.fits(state)]
        nodes = range(len(threat.hears))
        steps = [(side, j, i) for side in (0, 1) for j in nodes for i in nodes if state.T[1 - side] >> i & 1]
        for side, j, i in draw.sample(steps, len(steps)):
            if state.P[side] >> j & 1 and excludes(threat, state, side, j, i):
                assert not any(each.normal[side] >> j & 1 for each in kept)
                done += 1
                state.P[side] &= ~(1 << j)
    assert done > 5


@pytest.mark.parametrize("elsewhere", [0, 4])
def test_a_node_that_is_inside_and_can_be_neither_is_a_contradiction(elsewhere: int) -> None:
    graph = Digraph.from_networkx(nx.complete_graph(3))
    threat = Threat.of(decode_graph(graph.canonical_bytes()), 1, True, False)
    state = Roles([3, 7], [0, elsewhere], [4, 0], [0, 0], 0)  # it may be malicious on the other side, or nowhere
    with pytest.raises(Contradiction):
        settle(threat, state)
