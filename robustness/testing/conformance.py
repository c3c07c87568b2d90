"""What a new algorithm, or a new adversary, has to pass before anybody relies on it.

Each kit is one call that raises AssertionError at the first promise that is not kept, with an example to paste.

>>> from robustness.decision.algorithms import transform
>>> assert_algorithm_conforms(transform.decide, most_nodes=3)
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from robustness.answers import Answer, Verdict
from robustness.decision.algorithms import exhaustive
from robustness.definitions import is_violation, largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import RobustnessError
from robustness.limits import UNBOUNDED, Limits
from robustness.simulation.adversaries.protocol import Adversary, Move, View
from robustness.simulation.engine import Batch
from robustness.simulation.lawful import require_lawful
from robustness.simulation.reference import simulate_plainly
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import Schedule, schedule_named
from robustness.simulation.topology import as_topology

__all__ = ["assert_adversary_conforms", "assert_algorithm_conforms"]

_Decide = Callable[..., Answer]


def assert_algorithm_conforms(decide: _Decide, *, most_nodes: int = 4, samples: int = 40, **options: Any) -> None:
    """Assert that ``decide(graph, r, s, limits, **options) -> Answer`` is an exact algorithm.

    Parameters
    ----------
    decide : callable
        The contract is that of :class:`robustness.decision.algorithms.Algorithm`.
    most_nodes : int
        All undirected graphs with so many nodes, and all digraphs with one node fewer, are asked every question.
    samples : int
        How many larger digraphs, of 5 to 9 nodes, are asked one question each.
    **options
        For ``decide``.

    Raises
    ------
    AssertionError
        When a verdict is not that of the definition; a pair is no violation; the same question gets two verdicts, or
        other threads or another seed another one; or a limit that has passed makes it claim what is wrong.

    Notes
    -----
    ``O(2^(n^2) 3^n)`` for the digraphs on n nodes; a second for the default.
    """
    for graph in _all_graphs(most_nodes):
        for r in range(1, largest_conceivable_r(graph.n) + 1):
            for s in range(1, graph.n + 1):
                _require_right(decide, graph, r, s, UNBOUNDED, options)
    draw = np.random.default_rng(0)
    over = Limits(deadline=0.0)
    for _ in range(samples):
        graph = _random_digraph(draw)
        r, s = int(draw.integers(1, largest_conceivable_r(graph.n) + 1)), int(draw.integers(1, graph.n + 1))
        before = graph.canonical_bytes()
        for limits in (UNBOUNDED, Limits(jobs=2, seed=1)):
            _require_right(decide, graph, r, s, limits, options)
        answer = decide(graph, r, s, over, **options)
        if answer.verdict is not Verdict.UNDECIDED:
            _require_right(lambda *_, known=answer, **__: known, graph, r, s, over, options)
        elif not answer.stats.get("reason"):
            raise AssertionError("UNDECIDED goes with a reason: return Answer.undecided(reason, stats)")
        if graph.canonical_bytes() != before:
            raise AssertionError(f"the graph was changed: {_pasteable(graph)}")


def _require_right(decide: _Decide, graph: Digraph, r: int, s: int, limits: Limits, options: dict[str, Any]) -> None:
    answer = decide(graph, r, s, limits, **options)
    true = exhaustive.decide(graph, r, s, UNBOUNDED).verdict
    question = f"({r},{s})-robustness of {_pasteable(graph)}"
    if not isinstance(answer, Answer):
        raise AssertionError(f"an algorithm returns an Answer, not {answer!r}: {question}")
    if answer.verdict is not true:
        raise AssertionError(f"{answer.verdict.value}, but by the definition {true.value}: {question}")
    if true is Verdict.NOT_ROBUST and (answer.pair is None or not is_violation(graph, *answer.pair, r, s)):
        raise AssertionError(f"{answer.pair} violates nothing: {question}")


def _all_graphs(most_nodes: int) -> Iterator[Digraph]:
    """Yield all labelled undirected graphs on 2 to ``most_nodes`` nodes, and all digraphs on one node fewer."""
    for n in range(2, most_nodes + 1):
        pairs = [(u, v) for u in range(n) for v in range(u)]
        for chosen in product((False, True), repeat=len(pairs)):
            links = [pair for pair, is_there in zip(pairs, chosen, strict=True) if is_there]
            yield Digraph(range(n), [*links, *((v, u) for u, v in links)], directed=False)
        arcs = [(u, v) for u in range(n) for v in range(n) if u != v] if n < most_nodes else []
        for chosen in product((False, True), repeat=len(arcs)) if arcs else ():
            yield Digraph(range(n), [arc for arc, is_there in zip(arcs, chosen, strict=True) if is_there])


def _random_digraph(draw: np.random.Generator) -> Digraph:
    n, density = int(draw.integers(5, 10)), draw.uniform(0.2, 0.9)
    return Digraph(range(n), [(u, v) for u in range(n) for v in range(n) if u != v and draw.uniform() < density])


def _pasteable(graph: Digraph) -> str:
    return f"Digraph(range({graph.n}), {list(graph.arcs())})"


def assert_adversary_conforms(adversary: Adversary, *, steps: int = 12) -> None:
    """Assert that an adversary keeps to the protocol of :mod:`robustness.simulation.adversaries.protocol`.

    Parameters
    ----------
    adversary : Adversary
    steps : int
        How long every run is watched.

    Raises
    ------
    AssertionError
        When it is no frozen dataclass; does what its fault model or the schedule does not allow, or moves a vehicle
        that is not malicious; changes what it sees; plays two moves for one view; plays another move in a batch of
        runs than alone; or makes the engine and the plain loop disagree.
    """
    parameters = getattr(type(adversary), "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise AssertionError("an adversary is a frozen dataclass, so that a run can be replayed from its record")
    for scenario, starts in _scenarios(adversary, steps):
        _watch(scenario, starts)
        _compare_engines(scenario, starts)


def _scenarios(adversary: Adversary, steps: int) -> Iterator[tuple[Scenario, Sequence[Start]]]:
    """Yield small scenarios: every fault model, with and without delays, nobody malicious, one node."""
    draw = np.random.default_rng(1)
    whole = Digraph(range(5), [(u, v) for u in range(5) for v in range(5) if u != v])
    ring = Digraph(range(6), [(u, (u + k) % 6) for u in range(6) for k in (1, 2)])
    alone = Digraph(range(1), [])
    for graph, bad in ((whole, (4,)), (ring, (0, 3)), (ring, ()), (alone, ())):
        starts = [
            Start(
                frozenset(bad if run % 2 == 0 else bad[:1]),
                tuple(draw.uniform(-10.0, 10.0, graph.n).tolist()),
                tuple(draw.uniform(-1.0, 1.0, graph.n).tolist()),
                seed=run,
            )
            for run in range(3)
        ]
        for model in ("malicious", "byzantine"):
            for schedule in (Schedule(), schedule_named("adversarial", 3)):
                network = as_topology(graph, 1)
                yield Scenario(network, 2, "adp-msr", model, adversary, schedule, steps, 1.0), starts


def _watch(scenario: Scenario, starts: Sequence[Start]) -> None:
    """Play a batch beside its runs one by one, and look at every move."""
    together, alone = Batch(scenario, starts), [Batch(scenario, [start]) for start in starts]
    for batch in (together, *alone):
        batch.play_history(partial(_require_lawful_play, scenario, batch))
    for step in range(scenario.steps):
        move = _looked_at(scenario, together.view(step))
        for k, batch in enumerate(alone):
            single = _looked_at(scenario, batch.view(step))
            for name, part in _parts(move):
                own = getattr(single, name)
                if not _same(None if part is None else part[k : k + 1], own):
                    raise AssertionError(f"step {step}: {name} of run {k} is {part} in a batch and {own} alone")
        for batch in (together, *alone):
            batch.act(step)
            batch.advance(step)


def _require_lawful_play(scenario: Scenario, batch: Batch, step: int) -> None:
    _looked_at(scenario, batch.view(step))


def _looked_at(scenario: Scenario, view: View) -> Move:
    """Return the move for a view, after all that can be told from it."""
    seen = [(name, getattr(view, name)) for name in ("p", "q", "previous", "last_update")]
    kept = [(name, array, array.copy()) for name, array in seen]
    move, again = scenario.adversary.play(view), scenario.adversary.play(view)
    for name, array, before in kept:
        if not np.array_equal(array, before, equal_nan=True):
            raise AssertionError(f"step {view.step}: the adversary changed {name} of its view: work on a copy")
    for name, part in _parts(move):
        if not _same(part, getattr(again, name)):
            raise AssertionError(f"step {view.step}: two moves for one view differ in {name}: draw from setting.draws")
    try:
        require_lawful(move, view.setting)
    except RobustnessError as problem:
        raise AssertionError(f"step {view.step}, {scenario.model}, {scenario.schedule}: {problem}") from problem
    return move


def _parts(move: Move) -> list[tuple[str, Any]]:
    return [(each.name, getattr(move, each.name)) for each in dataclasses.fields(move)]


def _same(one: Any, two: Any) -> bool:
    if one is None or two is None:
        return one is two
    return np.array_equal(one, two, equal_nan=np.asarray(one).dtype.kind == "f")


def _compare_engines(scenario: Scenario, starts: Sequence[Start]) -> None:
    runs = simulate(scenario, starts, record=True), simulate_plainly(scenario, starts, record=True)
    for number, (engine, plain) in enumerate(zip(*runs, strict=True)):
        if engine != plain:
            raise AssertionError(f"run {number}: the engine says {engine}, the plain loop {plain}: {scenario}")
