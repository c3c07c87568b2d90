"""What may be done to a network: links that can be added, what each costs, and how many a node can bear."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.spelled import Spelling

__all__ = ["Action", "Actions", "CostLike", "actions_for", "cost_of", "with_actions"]

Link = tuple[Hashable, Hashable]
CostLike = Mapping[Link, Any] | Callable[[Hashable, Hashable], Any] | None

#: Costs are counted in this part of a unit at the finest.
_FINEST = 10**6


class Action(NamedTuple):
    """A link that can be added: its ends (ids), what it costs in whole units of the scale, and the arcs it brings."""

    ends: tuple[int, int]
    cost: int
    arcs: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Actions:
    """All actions, and the constraints on choosing among them.

    Attributes
    ----------
    items : tuple of Action
    scale : int
        ``Action.cost`` counts in units of ``1 / scale``.
    required : frozenset of int
        Indices of actions that have to be chosen.
    most : tuple of int or None
        For every node how many in-neighbours it may gain; None: as many as it likes.
    uniform : bool
        Whether every link that is not there can be added, all at one cost, without constraints: then nodes that
        cannot be told apart in the network cannot be told apart in the question.
    one_way : bool
        Whether an action is one arc, not one each way.
    budget : int or None
        What a choice may cost at most, in units of the scale.
    """

    items: tuple[Action, ...]
    scale: int
    required: frozenset[int]
    most: tuple[int, ...] | None
    uniform: bool
    one_way: bool = False
    budget: int | None = None

    @property
    def cheapest(self) -> int:
        """What a link costs at least, in units of the scale; 0 when there is none."""
        return min((item.cost for item in self.items), default=0)

    def price(self, units: int) -> int | float:
        """Return a cost as people write it."""
        value = Fraction(units, self.scale)
        return int(value) if value.denominator == 1 else float(value)


def actions_for(
    graph: Digraph,
    candidates: Iterable[Link] | None,
    cost: CostLike,
    *,
    forbid: Iterable[Link],
    require: Iterable[Link],
    max_in_degree: int | Mapping[Hashable, int] | None,
    one_way: bool,
    budget: Any = None,
) -> Actions:
    """Return what may be done; see :func:`robustness.mend` for the parameters.

    Raises
    ------
    InvalidParameter
        For links between unknown nodes, costs that are no finite numbers of at least 0, and required links that are
        forbidden or no candidates.
    """
    present = {(u, v) for u, v in graph.arcs()}
    forbidden = {_ends(graph, link, one_way) for link in forbid}
    required = {_ends(graph, link, one_way) for link in require}
    every = _every(graph.n, one_way) if candidates is None else (_ends(graph, link, one_way) for link in candidates)
    ends = dict.fromkeys([*every, *sorted(required)])
    if required & forbidden:
        u, v = sorted(required & forbidden)[0]
        raise InvalidParameter(f"the link {_name(graph, (u, v))} is both mandatory and forbidden")
    chosen: list[tuple[tuple[int, int], tuple[tuple[int, int], ...]]] = []
    for u, v in ends:
        arcs = tuple(arc for arc in (((u, v),) if one_way else ((u, v), (v, u))) if arc not in present)
        if arcs and (u, v) not in forbidden:
            chosen.append(((u, v), arcs))
    prices = [_price(graph, pair, cost) for pair, _ in chosen]
    scale = math.lcm(*(price.denominator for price in prices)) if prices else 1
    if scale > _FINEST:
        raise InvalidParameter(f"costs are multiples of 1/{_FINEST}: round them")
    items = tuple(Action(pair, int(price * scale), arcs) for (pair, arcs), price in zip(chosen, prices, strict=True))
    most = None if max_in_degree is None else _most(graph, max_in_degree)
    uniform = candidates is None and len(set(prices)) <= 1 and not forbidden and not required and most is None
    wanted = frozenset(k for k, item in enumerate(items) if item.ends in required)
    return Actions(items, scale, wanted, most, uniform, one_way, _units(budget, scale))


def with_actions(graph: Digraph, actions: Actions, chosen: Iterable[int]) -> Digraph:
    """Return the network with the links of the chosen actions."""
    labels = graph.labels
    arcs = [*graph.arcs(), *(arc for a in sorted(chosen) for arc in actions.items[a].arcs)]
    said: dict[Hashable, Mapping[str, object]] = dict(graph.node_attributes.items())
    joined = ((labels[u], labels[v]) for u, v in arcs)
    return Digraph(labels, joined, directed=graph.directed, node_attributes=said)


def cost_of(value: object, link: str) -> Fraction:
    """Return what a link costs as an exact number; ``link`` is its name.

    Raises
    ------
    InvalidParameter
        When the value is no finite number of at least 0.
    """
    try:
        price = Fraction(str(value))
    except (ValueError, ZeroDivisionError):
        price = Fraction(-1)
    if isinstance(value, bool) or price < 0:
        raise InvalidParameter(f"a cost is a finite number of at least 0, not {value!r} of {link}")
    return price


def _most(graph: Digraph, max_in_degree: int | Mapping[Hashable, int]) -> tuple[int, ...]:
    """Return for every node how many in-neighbours it may gain."""
    caps: list[int] = [max(graph.n - 1, 0)] * graph.n
    if isinstance(max_in_degree, Mapping):
        for label, cap in max_in_degree.items():
            (i,) = graph.ids([label])
            caps[i] = cap
    else:
        caps = [max_in_degree] * graph.n
    for cap in caps:
        if type(cap) is not int or cap < 0:
            raise InvalidParameter(f"max_in_degree is an integer of at least 0, for all nodes or for each, not {cap!r}")
    return tuple(max(0, cap - degree) for cap, degree in zip(caps, graph.in_degrees.tolist(), strict=True))


def _units(budget: Any, scale: int) -> int | None:
    if budget is None:
        return None
    try:
        units = Fraction(str(budget)) * scale
    except (ValueError, ZeroDivisionError):
        units = Fraction(-1)
    if isinstance(budget, bool) or units < 0:
        raise InvalidParameter(f"a budget is a finite number of at least 0, not {budget!r}")
    return math.floor(units)


def _every(n: int, one_way: bool) -> Iterable[tuple[int, int]]:
    return ((u, v) for u in range(n) for v in range(n) if (u != v if one_way else u < v))


def _ends(graph: Digraph, link: Any, one_way: bool) -> tuple[int, int]:
    if not isinstance(link, tuple | list) or len(link) != 2:
        raise InvalidParameter(f"a link is a pair of nodes, not {link!r}")
    (u,), (v,) = graph.ids([link[0]]), graph.ids([link[1]])
    if u == v:
        raise InvalidParameter(f"a link joins two nodes, not {link[0]!r} with itself")
    return (u, v) if one_way or u < v else (v, u)


def _name(graph: Digraph, ends: tuple[int, int]) -> str:
    spelled = Spelling(graph.labels)
    return f"{spelled(graph.labels[ends[0]])} -- {spelled(graph.labels[ends[1]])}"


def _price(graph: Digraph, ends: tuple[int, int], cost: CostLike) -> Fraction:
    u, v = (graph.labels[i] for i in ends)
    if cost is None:
        return Fraction(1)
    if callable(cost):
        value = cost(u, v)
    else:
        value = cost.get((u, v), cost.get((v, u)))
        if value is None:
            raise InvalidParameter(f"the link {_name(graph, ends)} has no cost: give one, or leave it out")
    return cost_of(value, _name(graph, ends))
