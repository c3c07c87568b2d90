"""One call from a network to a run: what people type first."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from robustness.digraph import Digraph, GraphLike
from robustness.errors import InvalidParameter
from robustness.limits import Progress
from robustness.simulation.adversaries import Adversary
from robustness.simulation.arguments import integer, schedule_from
from robustness.simulation.outcome import Outcome
from robustness.simulation.run import simulate as simulate_batch
from robustness.simulation.scenario import Scenario, Start, random_start
from robustness.simulation.schedules import Schedule
from robustness.simulation.update_rules import Rule, UpdateFunction
from robustness.time_varying import TimeVaryingGraph
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["most_heard", "simulate"]

#: Fields of a scenario that :func:`simulate` has no argument of its own for.
_OPTIONS = frozenset(
    {
        "T", "target_speed", "alpha", "weights", "offsets", "active", "added_links", "groups", "tolerance", "dwell",
        "growth",
    }
)  # fmt: skip


@taking_numpy_integers
def simulate(
    G: GraphLike | TimeVaryingGraph | Callable[[int], GraphLike],
    rule: str | Rule | UpdateFunction = "adp-msr",
    f: int = 1,
    malicious: Iterable[Hashable] | None = None,
    adversary: str | Adversary = "greedy",
    steps: int = 1000,
    seed: int = 0,
    *,
    model: str = "malicious",
    schedule: str | Schedule = "synchronous",
    tau: int | None = None,
    positions: Sequence[float] | Mapping[Hashable, float] | None = None,
    velocities: Sequence[float] | Mapping[Hashable, float] | None = None,
    time_limit: float | None = None,
    progress: Callable[[Progress], None] | None = None,
    **options: Any,
) -> Outcome:
    """Run resilient consensus on a network under attack, and return what came of it, with all positions.

    Parameters
    ----------
    G : networkx graph, Digraph, TimeVaryingGraph, or callable from the step to a graph
        An arc ``(u, v)`` means v hears u.
    rule : str or function
        ``"w-msr"`` (first order), ``"dp-msr"``, ``"adp-msr"`` (vehicles), or an update rule of one's own: a function of
        (own value, heard values) that returns the next value.
    f : int
        The bound on faults.
    malicious : collection of nodes, optional
        By default the f nodes that most others hear.
    adversary : str or Adversary
        What they do: a name in ``robustness.simulation.ADVERSARIES``, or an adversary.
    steps : int
        How long.
    seed : int
        Of the start and of every random draw; the same call gives the same run.
    model : str
        ``"malicious"``, ``"malicious-local"``, ``"byzantine"`` or ``"byzantine-local"``.
    schedule : str or Schedule
        ``"synchronous"``, ``"periodic"``, ``"random"``, ``"adversarial"`` or ``"delayed"``.
    tau : int, optional
        With a schedule by name: how old values in use may get, besides the turn of a network that changes; by default
        3, and 0 in step.
    positions, velocities : sequence in the order of the nodes, or mapping, optional
        The start; by default positions drawn from the seed in 0 .. 100, at rest. Nodes that a mapping does not name
        get 0.
    time_limit, progress : optional
        As for :func:`robustness.simulation.simulate`.
    **options
        Fields of :class:`robustness.simulation.Scenario`: ``T``, ``alpha``, ``weights``, ``target_speed``, ``offsets``,
        ``active``, ``added_links``, ``groups``, ``tolerance``, ``dwell``, ``growth``.

    Returns
    -------
    Outcome
        ``.verdict``, ``.groups``, ``.positions`` (steps + 1 x nodes), ``.to_frame()``, ``.plot()`` and more.

    Raises
    ------
    InvalidGraph, InvalidParameter
        At once, with the rule that was broken.
    Undecided
        When the time limit came first.

    Warns
    -----
    PromiseWarning
        When the gains lie outside the theory.

    See Also
    --------
    robustness.simulation.simulate : many runs of one scenario at once.
    robustness.tolerance : what is proven for all adversaries.

    Notes
    -----
    ``O(steps (n + A f))`` for n nodes and A arcs.

    >>> import networkx as nx
    >>> outcome = simulate(nx.complete_graph(5), "w-msr", f=1, malicious=[4], adversary="sine", steps=100, seed=0)
    >>> outcome.verdict.value, outcome.positions.shape
    ('agreement', (101, 5))
    """
    unknown = sorted(set(options) - _OPTIONS)
    if unknown:
        known = _OPTIONS | {name for name in inspect.signature(simulate).parameters if name not in ("G", "options")}
        raise TypeError(
            f"simulate() got an unexpected keyword argument {unknown[0]!r}: there are {', '.join(sorted(known))}"
        )
    if tau is not None and isinstance(schedule, Schedule):
        raise InvalidParameter("tau belongs to a schedule by name: a Schedule has its own")
    when = schedule_from(schedule, None if tau is None else integer("tau", tau, 0))
    scenario = Scenario(G, f, rule, model, adversary, when, steps, **options)
    if isinstance(schedule, str) and not scenario.network.fixed:
        # A link may be gone for a turn of the network less one step.
        turn = len(scenario.network.sequence)
        scenario = replace(scenario, schedule=replace(when, tau=when.oldest + turn - 1))
    graph = scenario.network.union
    start = random_start(graph, most_heard(graph, scenario.f) if malicious is None else malicious, seed)
    if positions is not None or velocities is not None:
        start = Start(
            start.malicious,
            start.positions if positions is None else _in_order(graph, "positions", positions),
            start.velocities if velocities is None else _in_order(graph, "velocities", velocities),
            start.seed,
        )
    return simulate_batch(scenario, [start], record=True, time_limit=time_limit, progress=progress)[0]


def most_heard(graph: Digraph, f: int) -> list[Any]:
    """Return the f nodes with the most listeners, at least one node fewer than all."""
    listeners = np.bincount(graph.in_indices, minlength=graph.n)
    return [graph.labels[i] for i in np.argsort(-listeners, kind="stable")[: max(0, min(f, graph.n - 1))].tolist()]


def _in_order(graph: Digraph, what: str, values: Any) -> Any:
    """Return values by id, given in order or by label."""
    if not isinstance(values, Mapping):
        return values
    graph.ids(values)
    return [values.get(label, 0.0) for label in graph.labels]
