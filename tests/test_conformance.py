"""The conformance kit passes what is right, and fails each kind of what is wrong."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from robustness import ALGORITHMS, Digraph
from robustness.answers import Answer
from robustness.decision.algorithms import exhaustive
from robustness.evidence import Exhausted, Pair
from robustness.limits import Limits
from robustness.results import Verdict
from robustness.simulation import ADVERSARIES
from robustness.simulation.adversaries import Move, View
from robustness.testing import assert_adversary_conforms, assert_algorithm_conforms


@pytest.mark.parametrize(
    "name",
    [name if name not in ("milp", "cp-sat") else pytest.param(name, marks=pytest.mark.slow) for name in ALGORITHMS],
)
def test_every_algorithm_conforms(name: str) -> None:
    assert_algorithm_conforms(ALGORITHMS[name])


def no_pair_ever(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    return Answer(Exhausted())


def one_s_too_many(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    return exhaustive.decide(graph, r, max(s - 1, 1), limits)


def halves(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    """Find the right verdict, and show for it a pair that need not be one."""
    right = exhaustive.decide(graph, r, s, limits)
    everybody, half = frozenset(range(graph.n)), frozenset(range(graph.n // 2))
    return right if right.pair is None else Answer.violated_by(Pair(half, everybody - half))


def wrong_with_threads(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    return Answer(Exhausted()) if limits.jobs > 1 else exhaustive.decide(graph, r, s, limits)


def robust_when_stopped(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    return Answer(Exhausted()) if limits.expired() else exhaustive.decide(graph, r, s, limits)


def silent_when_stopped(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    return Answer.undecided("") if limits.expired() else exhaustive.decide(graph, r, s, limits)


def no_answer(graph: Digraph, r: int, s: int, limits: Limits) -> Any:
    return exhaustive.decide(graph, r, s, limits).verdict is Verdict.ROBUST


@pytest.mark.parametrize(
    ("decide", "said"),
    [
        (no_pair_ever, "by the definition not-robust"),
        (one_s_too_many, "robust, but by the definition"),
        (halves, "violates nothing"),
        (wrong_with_threads, "by the definition"),
        (robust_when_stopped, "by the definition not-robust"),
        (silent_when_stopped, "goes with a reason"),
        (no_answer, "returns an Answer"),
    ],
)
def test_a_wrong_algorithm_fails(decide: Any, said: str) -> None:
    with pytest.raises(AssertionError, match=said):
        assert_algorithm_conforms(decide)


@pytest.mark.parametrize("name", ADVERSARIES)
def test_every_adversary_conforms(name: str) -> None:
    assert_adversary_conforms(ADVERSARIES[name](), steps=5)


@dataclass
class Mutable:
    def play(self, view: View) -> Move:
        return Move()


@dataclass(frozen=True)
class MovesEverybody:
    def play(self, view: View) -> Move:
        return Move(positions=np.zeros_like(view.p))


@dataclass(frozen=True)
class DrawsItsOwn:
    generator: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))

    def play(self, view: View) -> Move:
        return Move(sent=view.setting.by_malicious(self.generator.normal(size=view.p.shape)))


@dataclass(frozen=True)
class ChangesTheView:
    def play(self, view: View) -> Move:
        view.p[:] += 1.0
        return Move()


@dataclass(frozen=True)
class LooksAtOtherRuns:
    def play(self, view: View) -> Move:
        return Move(sent=view.setting.by_malicious(np.full_like(view.p, view.p.mean())))


@dataclass(frozen=True)
class AlwaysTwoFaced:
    def play(self, view: View) -> Move:
        arcs = view.setting.from_malicious
        return Move(told=np.where(arcs, np.arange(arcs.shape[1], dtype=float), np.nan))


@dataclass(frozen=True)
class TooLate:
    def play(self, view: View) -> Move:
        late = view.setting.longest_delay + 1 if view.setting.chooses_delays else -1
        return Move(delays=np.full(view.setting.from_malicious.shape, late))


@dataclass(frozen=True)
class Infinite:
    def play(self, view: View) -> Move:
        return Move(sent=view.setting.by_malicious(np.full_like(view.p, np.inf)))


@pytest.mark.parametrize(
    ("adversary", "said"),
    [
        (Mutable(), "frozen dataclass"),
        (MovesEverybody(), "set positions of normal ones"),
        (DrawsItsOwn(), "two moves for one view"),
        (ChangesTheView(), "changed p of its view"),
        (LooksAtOtherRuns(), "in a batch and"),
        (AlwaysTwoFaced(), "need a Byzantine model"),
        (TooLate(), "delays are at most"),
        (Infinite(), "finite numbers"),
    ],
)
def test_a_wrong_adversary_fails(adversary: Any, said: str) -> None:
    with pytest.raises(AssertionError, match=said):
        assert_adversary_conforms(adversary, steps=5)
