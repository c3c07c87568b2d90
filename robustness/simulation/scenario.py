"""What is simulated: the network, the rule, the faults, the schedule; and where each run of a batch starts."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from certificates.graph import Label
from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.simulation.adversaries import Adversary, Constant
from robustness.simulation.arguments import (
    adversary_from,
    collected,
    finite,
    integer,
    label_set,
    label_tuple,
    mapping_or_none,
    numbers_in,
    schedule_from,
)
from robustness.simulation.divergence import LARGEST_START
from robustness.simulation.draws import Draws
from robustness.simulation.fault_models import fault_model_named
from robustness.simulation.schedules import Schedule
from robustness.simulation.topology import Topology, as_topology
from robustness.simulation.update_rules import RULES, Rule, UpdateFunction, rule_named
from robustness.time_varying import TimeVaryingGraph

__all__ = ["Scenario", "Start", "random_start"]


@dataclass(frozen=True, init=False)
class Scenario:
    """Everything the runs of a batch have in common.

    Parameters
    ----------
    network : Topology, networkx graph, Digraph, TimeVaryingGraph, or callable from the step to a graph
        Kept as a :class:`~robustness.simulation.topology.Topology`.
    f : int
        The bound on faults that the filter and the fault model share.
    rule : str, Rule or function
        ``"w-msr"``, ``"dp-msr"``, ``"adp-msr"``, or an update rule of one's own, a function of (own value, heard
        values): see :func:`robustness.simulation.update_rules.rule_named`.
    model : str
        ``"malicious"``, ``"malicious-local"``, ``"byzantine"`` or ``"byzantine-local"``.
    adversary : Adversary or str
        An adversary, or the name of one in ``ADVERSARIES``.
    schedule : Schedule or str
        A schedule, or the name of one in ``SCHEDULES``, then with tau = 3 (0 in step).
    steps : int
        The horizon K; states 0 .. K are observed.
    T, target_speed : float
        The sampling period and the target speed r. In transformed coordinates r plays no part.
    alpha : float, mapping from labels, or None
        The gains; None: ``1.5 / T``, which lies inside :mod:`robustness.gain_region` when sigma T² < 1.
    weights : str or mapping from arcs
        See :func:`robustness.simulation.gains.arc_weights`. First-order rules use them as relative weights beside an
        own weight of 1 (``uniform`` then means the same as ``unit``: the plain mean of what is kept and the own value).
    offsets : mapping from labels, or None
        The formation, see :mod:`robustness.simulation.formation`.
    active : frozenset of labels
        Who senses actively.
    added_links : tuple of pairs of labels
        Links that the malicious nodes add to the network.
    groups : two tuples of labels, or None
        Two groups that evidence says are never to move: every normal node of them is watched bit for bit.
    tolerance : float
        Agreement means, at each of the last ``dwell`` states, a spread of at most this multiple of the normal vehicles'
        initial spread (of 1 if that is 0), and speeds relative to the target of at most as much per unit of time.
    dwell : int or None
        How many of the last states must show agreement or a split; None: 10, or twice tau + 1, or for a network that
        changes twice its turn (half the run when that is less), whichever is most. A shorter run decides nothing.
    growth : float
        A run *diverges* when a normal vehicle gets farther away than this many times the extent of the start, see
        :class:`robustness.simulation.divergence.Divergence`.

    Raises
    ------
    InvalidParameter
        When something is out of its range or of the wrong kind.
    """

    network: Topology
    f: int
    rule: str | Rule
    model: str
    adversary: Adversary
    schedule: Schedule
    steps: int
    T: float
    target_speed: float
    alpha: float | Mapping[Hashable, float] | None
    weights: str | Mapping[tuple[Hashable, Hashable], float]
    offsets: Mapping[Hashable, float] | None
    active: frozenset[Label]
    added_links: tuple[tuple[Label, Label], ...]
    groups: tuple[tuple[Label, ...], tuple[Label, ...]] | None
    tolerance: float
    dwell: int | None
    growth: float

    def __init__(
        self,
        network: Topology | GraphLike | TimeVaryingGraph | Callable[[int], GraphLike],
        f: int,
        rule: str | Rule | UpdateFunction = "adp-msr",
        model: str = "malicious",
        adversary: Adversary | str = Constant(),
        schedule: Schedule | str = Schedule(),
        steps: int = 1000,
        T: float = 1.0,
        target_speed: float = 0.0,
        alpha: float | Mapping[Hashable, float] | None = None,
        weights: str | Mapping[tuple[Hashable, Hashable], float] = "uniform",
        offsets: Mapping[Hashable, float] | None = None,
        active: Iterable[Hashable] = frozenset(),
        added_links: Iterable[tuple[Hashable, Hashable]] = (),
        groups: tuple[Iterable[Hashable], Iterable[Hashable]] | None = None,
        tolerance: float = 1e-6,
        dwell: int | None = None,
        growth: float = 1000.0,
    ) -> None:
        horizon = integer("the number of steps", steps, 1)
        made: dict[str, Any] = {
            "network": as_topology(network, horizon),
            "f": integer("f", f, 0),
            "rule": rule if isinstance(rule, str) and rule in RULES else rule_named(rule),
            "model": fault_model_named(model).name,
            "adversary": adversary_from(adversary),
            "schedule": schedule_from(schedule),
            "steps": horizon,
            "T": finite("the sampling period T", T, positive=True),
            "target_speed": finite("the target speed", target_speed),
            "alpha": alpha if alpha is None or isinstance(alpha, Mapping) else finite("alpha", alpha, positive=True),
            "weights": weights if isinstance(weights, str) else mapping_or_none("weights", weights) or {},
            "offsets": mapping_or_none("offsets", offsets),
            "active": label_set("active", active),
            "added_links": tuple(_pair(link) for link in collected("the set of added links", added_links, "links")),
            "groups": None if groups is None else _two_groups(groups),
            "tolerance": finite("the tolerance", tolerance, positive=True),
            "dwell": None if dwell is None else integer("the dwell time", dwell, 1),
            "growth": finite("the growth limit", growth, positive=True, largest=LARGEST_START),
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)
        if self.dwell is not None and self.dwell > self.steps:
            raise InvalidParameter(f"the dwell time lies in 1..steps = 1..{self.steps}, not {self.dwell}")
        chosen = rule_named(self.rule)
        if chosen.synchronous and not self.schedule.synchronous:
            raise InvalidParameter(f"{chosen.name} updates at every step without delays: use adp-msr for this schedule")
        self.network.graphs[0].ids([*self.active, *(label for group in self.groups or () for label in group)])

    @property
    def dwell_steps(self) -> int:
        """How many of the last states must show a verdict."""
        if self.dwell is not None:
            return self.dwell
        # A schedule or a sequence of graphs may do nothing for a whole turn.
        turn = 1 if self.network.fixed else min(len(self.network.sequence), self.steps)
        return max(10, 2 * (self.schedule.oldest + 1), min(2 * turn, self.steps // 2))


@dataclass(frozen=True, init=False)
class Start:
    """Where one run starts.

    Attributes
    ----------
    malicious : frozenset of labels
    positions, velocities : sequence of float
        Aligned positions ``p - d`` and velocities ``q`` in id order. At step 0 absolute and transformed positions are
        the same, so these are absolute positions relative to each vehicle's place in the formation; velocities are
        relative to the target speed.
    seed : int
        Of every draw of this run.

    Raises
    ------
    InvalidParameter
        When the malicious nodes are no collection, or a state is no finite number.

    >>> Start([4], range(5), [0] * 5).positions
    (0.0, 1.0, 2.0, 3.0, 4.0)
    """

    malicious: frozenset[Label]
    positions: tuple[float, ...]
    velocities: tuple[float, ...]
    seed: int

    def __init__(
        self, malicious: Iterable[Hashable], positions: Iterable[float], velocities: Iterable[float], seed: int = 0
    ) -> None:
        made: dict[str, Any] = {
            "malicious": label_set("the set of malicious nodes", malicious),
            "positions": numbers_in("positions", positions),
            "velocities": numbers_in("velocities", velocities),
            "seed": integer("a seed", seed, 0),
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)


def _pair(link: Any) -> tuple[Any, ...]:
    pair = label_tuple("an added link", link)
    if len(pair) != 2:
        raise InvalidParameter(f"an added link is a pair (sender, receiver), not {link!r}")
    return pair


def _two_groups(groups: Any) -> tuple[tuple[Any, ...], ...]:
    two = collected("the pair of groups", groups, "nodes")
    if len(two) != 2:
        raise InvalidParameter(f"groups are two collections of nodes, not {groups!r}")
    return tuple(label_tuple("each of the two groups", group) for group in two)


def random_start(graph: GraphLike | Topology, malicious: Iterable[Hashable], seed: int = 0) -> Start:
    """Return a start at rest from integer positions in ``0 .. 100``, drawn from the seed.

    The normal vehicles with the least and the greatest draw are moved to 0 and 100, so that no start is trivial.

    >>> import networkx as nx
    >>> random_start(nx.path_graph(3), [1], seed=1) == random_start(nx.path_graph(3), {1}, seed=1)
    True
    """
    network = graph.union if isinstance(graph, Topology) else as_digraph(graph)
    bad, seed = network.ids(label_set("the set of malicious nodes", malicious)), integer("a seed", seed, 0)
    values = Draws([seed]).integers("start", 0, network.n, 0, 100)[0].astype(float)
    normal = [i for i in range(network.n) if i not in bad]
    if len(normal) > 1:
        ordered = sorted(normal, key=lambda i: (values[i], i))
        values[ordered[0]], values[ordered[-1]] = 0.0, 100.0
    return Start(network.labels_of(bad), tuple(values.tolist()), (0.0,) * network.n, seed)
