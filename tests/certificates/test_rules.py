"""Each rule of the kernel keeps every violating pair that a state stands for: by enumeration, on states at random.

This is the soundness of refutations, step by step. The states are not only those that a transcript can reach.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple

import networkx as nx
import pytest

from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.rules import Question, State, _least_exempt, excludes, settle
from robustness import Digraph


class Violation(NamedTuple):
    """A violating pair as masks: both sets, and their nodes that are not r-reachable."""

    sets: tuple[int, int]
    satisfied: tuple[int, int]

    def fits(self, state: State) -> bool:
        return all(
            not state.F[k] & ~self.sets[k]
            and not self.sets[k] & ~state.C[k]
            and not state.T[k] & ~self.satisfied[k]
            and not self.satisfied[k] & ~state.P[k]
            for k in (0, 1)
        )

    def further_exempt(self, state: State, side: int) -> int:
        return (self.sets[side] & ~self.satisfied[side] & ~(state.F[side] & ~state.P[side])).bit_count()


def violations(graph: Digraph, r: int, s: int) -> list[Violation]:
    """Return all violating pairs, from the definition."""
    found = []
    for place in product((0, 1, 2), repeat=graph.n):
        sets = [{i for i in range(graph.n) if place[i] == k} for k in (1, 2)]
        reachable = [{i for i in S if len(set(graph.in_neighbours(i).tolist()) - S) >= r} for S in sets]
        if all(S and S != X for S, X in zip(sets, reachable, strict=True)) and sum(map(len, reachable)) < s:
            satisfied = [mask(S - X) for S, X in zip(sets, reachable, strict=True)]
            found.append(Violation((mask(sets[0]), mask(sets[1])), (satisfied[0], satisfied[1])))
    return found


def mask(nodes: set[int]) -> int:
    return sum(1 << node for node in nodes)


def subset(nodes: int, rng: random.Random, share: float) -> int:
    return sum(1 << i for i in range(nodes.bit_length()) if nodes >> i & 1 and rng.random() < share)


def some_state(n: int, pair: Violation, rng: random.Random) -> State:
    """Return a state that stands for ``pair`` and, more often than not, for others."""
    everyone = (1 << n) - 1
    loose, fixed = rng.choice((0.2, 0.6, 0.95)), rng.choice((0.0, 0.3, 0.8, 1.0))
    sides = []
    for members, satisfied in zip(pair.sets, pair.satisfied, strict=True):
        C = members | subset(everyone, rng, loose)
        P = satisfied | subset(everyone, rng, loose)
        sides.append((C, P, subset(members, rng, fixed), subset(satisfied, rng, fixed)))
    return State(*([sides[0][row], sides[1][row]] for row in range(4)))


def cases(draws: int) -> Iterator[tuple[Question, list[Violation], State, random.Random]]:
    rng = random.Random(20231109)
    for _ in range(draws):
        n = rng.choice((2, 3, 4, 5, 5, 6))
        density = rng.choice((0.3, 0.6, 0.9))
        drawn = nx.gnp_random_graph(n, density, seed=rng.randrange(2**30), directed=rng.random() < 0.5)
        graph = Digraph.from_networkx(drawn)
        r, s = rng.randint(1, (n + 1) // 2 + 1), rng.randint(1, n)
        pairs = violations(graph, r, s)
        question = Question.of(decode_graph(graph.canonical_bytes()), r, s)
        for _ in range(8 if pairs else 0):
            yield question, pairs, some_state(n, rng.choice(pairs), rng), rng


@pytest.fixture(scope="module", params=[600, pytest.param(30_000, marks=pytest.mark.slow)])
def settled(request: pytest.FixtureRequest) -> list[tuple[Question, list[Violation], State, random.Random]]:
    """States that have been settled, with the violating pairs they stood for before; settling contradicted none."""
    found = []
    for question, pairs, state, rng in cases(request.param):
        kept = [pair for pair in pairs if pair.fits(state)]
        assert kept
        settle(question, state)
        found.append((question, kept, state, rng))
    return found


Settled = list[tuple[Question, list[Violation], State, random.Random]]


def test_settling_keeps_every_violating_pair(settled: Settled) -> None:
    assert len(settled) > 1000
    for _, pairs, state, _ in settled:
        assert all(pair.fits(state) for pair in pairs)


def test_settling_is_idempotent(settled: Settled) -> None:
    for question, _, state, _ in settled:
        again = state.copy()
        settle(question, again)
        assert (again.C, again.P, again.F, again.T) == (state.C, state.P, state.F, state.T)
        assert (again.left, again.allowed) == (state.left, state.allowed)


def test_exempt_nodes_are_bounded_by_what_is_left_and_allowed(settled: Settled) -> None:
    shared = 0
    for question, pairs, state, _ in settled:
        shared += min(state.allowed) < state.left
        for pair in pairs:
            further = [pair.further_exempt(state, side) for side in (0, 1)]
            assert sum(further) <= state.left
            for side in (0, 1):
                assert _least_exempt(question, state, side) <= further[side] <= state.allowed[side]
    assert shared > 10


def groups_of(blockers: int) -> list[list[int]]:
    nodes = [i for i in range(blockers.bit_length()) if blockers >> i & 1]
    return [[i] for i in nodes] + [list(pair) for pair in combinations(nodes, 2)]


@pytest.mark.parametrize("draws", [600, pytest.param(30_000, marks=pytest.mark.slow)])
def test_an_exclusion_excludes_no_violating_pair_also_after_others(draws: int) -> None:
    """With the smallest bounds on exempt nodes that are true of the pairs, and the same bounds throughout a run."""
    done = dict.fromkeys(product((1, 2), (False, True)), 0)
    for question, pairs, state, rng in cases(draws):
        state.F = [state.F[side] | state.T[side] for side in (0, 1)]
        kept = [pair for pair in pairs if pair.fits(state)]
        further = [[pair.further_exempt(state, side) for side in (0, 1)] for pair in kept]
        state.left, state.allowed = max(map(sum, further)), [max(column) for column in zip(*further, strict=True)]
        steps = [
            (side, j, group)
            for side in (0, 1)
            for j in range(len(question.hears))
            for group in groups_of(state.T[1 - side])
        ]
        for side, j, group in rng.sample(steps, len(steps)):
            if state.P[side] >> j & 1 and excludes(question, state, side, j, group):
                assert not any(pair.satisfied[side] >> j & 1 for pair in kept)
                done[len(group), state.left > 0] += 1
                state.P[side] &= ~(1 << j)
    assert min(done.values()) > 20


def test_settling_does_not_depend_on_the_numbering() -> None:
    rng = random.Random(7)
    contradictions = 0
    for _ in range(400):
        n, seed, directed = rng.randint(2, 9), rng.randrange(2**30), rng.random() < 0.5
        drawn = nx.gnp_random_graph(n, rng.choice((0.4, 0.7)), seed=seed, directed=directed)
        order = rng.sample(range(n), n)
        r, s = rng.randint(1, (n + 1) // 2), rng.randint(1, n)
        rows = [[subset((1 << n) - 1, rng, share) for _ in (0, 1)] for share in (0.95, 0.9, 0.1, 0.05)]
        results = []
        for place in (list(range(n)), order):
            graph = Digraph.from_networkx(nx.relabel_nodes(drawn, dict(enumerate(place))))
            state = State(*([moved(row, place) for row in sides] for sides in rows))
            try:
                settle(Question.of(decode_graph(graph.canonical_bytes()), r, s), state)
            except Contradiction:
                contradictions += 1
                results.append(None)
                continue
            back = [place.index(i) for i in range(n)]
            results.append([[moved(row, back) for row in sides] for sides in (state.C, state.P, state.F, state.T)])
        assert results[0] == results[1]
    assert 20 < contradictions < 780


def moved(nodes: int, place: list[int]) -> int:
    return sum(1 << place[i] for i in range(nodes.bit_length()) if nodes >> i & 1)
