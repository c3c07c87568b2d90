"""Attacks made from evidence: a violating pair or a trap, turned into a run that is split for ever.

Both keep two groups of vehicles exactly where they start, at every step and for every gain, weight and rule of
this package. Why *exactly*, in floating-point numbers as well: a normal vehicle i of group S_k starts at rest
(``q = 0``). Everything it hears from S_k and, as shown below, from the malicious nodes is its own position, so these
relative positions are 0; at most f other values come from elsewhere. Of these, those above 0 are at most f and are
among the f largest, those below 0 are among the f smallest: all are dropped, wherever they are. The control
input is a sum of zeros minus ``alpha * 0``, so it is 0, and ``p + T * 0 + T²/2 * 0`` is p without rounding. By
induction over the steps nothing in the two groups ever moves, and :class:`~robustness.simulation.observer.Observer`
checks it with ``==``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from certificates.graph import Label
from robustness.definitions import is_violation, r_reachable_ids
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.json_labels import from_json
from robustness.natural_order import in_natural_order
from robustness.showing import Shown
from robustness.simulation.adversaries import Adversary, Alternating, Constant
from robustness.simulation.fault_models import fault_model_named, require_fault_model
from robustness.simulation.outcome import Outcome
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.schedules import AdversarialDelays, EveryStep, Schedule
from robustness.simulation.topology import Topology
from robustness.spelled import Spelling, counted, labels_in_words, plural

__all__ = ["Attack", "attack_from_trap", "attack_from_violation"]

#: Positions of S1, of S2 and of everybody else: small integers, so that nothing is ever rounded.
_LOW, _HIGH, _BETWEEN = 0.0, 100.0, 50.0


@dataclass(frozen=True, repr=False)
class Attack(Shown):
    """A start, a malicious set and what it does, that split a network for ever. Made only from checked evidence.

    Attributes
    ----------
    kind : str
        ``"violation"`` or ``"trap"``.
    graph : Digraph
    f : int
    model : str
        The fault model that the attack obeys.
    malicious : frozenset of labels
        In a violation they are members of the two groups; in a trap they are outside both.
    delayed : bool
        Whether the attack needs delays (of one step).

    Notes
    -----
    ``S1`` and ``S2`` are the two groups, as in a violating pair or a trap.
    """

    kind: str
    graph: Digraph
    f: int
    model: str
    malicious: frozenset[Label]
    S1: frozenset[Label]
    S2: frozenset[Label]
    delayed: bool

    @property
    def adversary(self) -> Adversary:
        """What the malicious nodes do: stand still (violation), or show each group its own face (trap)."""
        if self.kind == "violation":
            return Constant()
        return Alternating(_LOW, _HIGH, self._ordered(self.S1), self._ordered(self.S2))

    @property
    def schedule(self) -> Schedule:
        """Synchronous, or with delays of at most one step that the adversary chooses."""
        return Schedule(EveryStep(), AdversarialDelays(1)) if self.delayed else Schedule()

    def scenario(self, steps: int = 1000, **changes: Any) -> Scenario:
        """Return the scenario of this attack; ``changes`` replace fields of :class:`Scenario`, such as the rule.

        The split does not depend on the rule, the gains, the weights or a formation.
        """
        fields: dict[str, Any] = {
            "network": Topology((self.graph,)),
            "f": self.f,
            "model": self.model,
            "adversary": self.adversary,
            "schedule": self.schedule,
            "groups": (self._ordered(self.S1), self._ordered(self.S2)),
        }
        return Scenario(steps=steps, **(fields | changes))

    def start(self, seed: int = 0) -> Start:
        """Return the start: S1 low, S2 high, the others between, all at rest."""
        places = np.full(self.graph.n, _BETWEEN)
        places[list(self.graph.ids(self.S1))] = _LOW
        places[list(self.graph.ids(self.S2))] = _HIGH
        return Start(self.malicious, tuple(places.tolist()), (0.0,) * self.graph.n, seed)

    def run(self, steps: int = 1000, *, record: bool = False, **changes: Any) -> Outcome:
        """Run the attack; the outcome is a split with ``exact=True``, or there is a bug.

        >>> import networkx as nx
        >>> attack_from_violation(nx.path_graph(4), 1, ({0, 1}, {2, 3})).run(50).exact
        True
        """
        return simulate(self.scenario(steps, **changes), [self.start()], record=record)[0]

    def summary(self) -> str:
        """Return what it is, and the story."""
        return f"{self.kind} for f = {self.f} ({self.model}): {self.story()}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return the sets, as rows of a name and a text."""
        sets = (("malicious", self.malicious), ("S1", self.S1), ("S2", self.S2))
        return [(name, labels_in_words(labels, self.graph.labels)) for name, labels in sets]

    def story(self) -> str:
        """Return the attack in words."""
        low, high = (labels_in_words(side, self.graph.labels) for side in (self.S1, self.S2))
        groups = f"S1 = {low} at {_LOW:g}, S2 = {high} at {_HIGH:g}"
        scene = f"{groups}, all others at {_BETWEEN:g}"
        if not self.malicious:
            return f"{scene}; nobody need be malicious"
        names = ", ".join(map(Spelling(self.graph.labels), in_natural_order(self.malicious)))
        who = f"{plural(len(self.malicious), 'node')} {names}"
        if self.kind == "violation":
            return f"{scene}; {who} malicious, holding the start for ever"
        means = "by delays of 0 or 1 step" if self.delayed else "by telling each so"
        return f"{scene}; {who} malicious, showing S1 always {_LOW:g} and S2 {_HIGH:g}, {means}"

    def as_dict(self) -> dict[str, Any]:
        """Return the attack as JSON-ready values, bound to the graph by its digest."""
        return {
            "schema": "robustness/attack/1",
            "kind": self.kind,
            "graph": {"nodes": self.graph.n, "arcs": self.graph.arc_count, "sha256": self.graph.sha256},
            "f": self.f,
            "model": self.model,
            "malicious": list(self._ordered(self.malicious)),
            "S1": list(self._ordered(self.S1)),
            "S2": list(self._ordered(self.S2)),
            "delayed": self.delayed,
            "positions": {"S1": _LOW, "S2": _HIGH, "others": _BETWEEN},
            "story": self.story(),
        }

    @classmethod
    def from_dict(cls, graph: GraphLike, document: Any) -> Attack:
        """Return the attack that :meth:`as_dict` wrote for this graph; its evidence is checked anew.

        Raises
        ------
        InvalidParameter
            When the document is not an attack, is bound to another graph, or its evidence does not hold.
        """
        network = as_digraph(graph)
        expected = {"schema", "kind", "graph", "f", "model", "malicious", "S1", "S2", "delayed", "positions", "story"}
        if not isinstance(document, dict) or document.get("schema") != "robustness/attack/1":
            raise InvalidParameter("an attack file has the schema robustness/attack/1: write one with 'attack'")
        if set(document) != expected or type(document["f"]) is not int:
            raise InvalidParameter("an attack file has exactly the keys that 'attack' writes: write it anew")
        if document["graph"] != {"nodes": network.n, "arcs": network.arc_count, "sha256": network.sha256}:
            raise InvalidParameter("an attack is bound to its graph by SHA-256, but this is of another graph")
        sets = {key: [from_json(entry) for entry in document[key]] for key in ("malicious", "S1", "S2")}
        if document["kind"] == "violation":
            pair, who = (sets["S1"], sets["S2"]), sets["malicious"]
            made = attack_from_violation(network, document["f"], pair, malicious=who, model=document["model"])
        else:
            trap = (sets["malicious"], sets["S1"], sets["S2"])
            made = attack_from_trap(network, document["f"], *trap, document["model"])
        if _bare(made.as_dict()) != _bare(document):
            raise InvalidParameter("an attack file says what its evidence yields, but this one was changed")
        return made

    def _ordered(self, labels: Iterable[Label]) -> tuple[Label, ...]:
        return tuple(in_natural_order(self.graph.labels_of(self.graph.ids(labels))))


def _bare(document: dict[str, Any]) -> Any:
    """Return a document after JSON, its story without what older versions wrote round labels, or did not write."""
    return json.loads(json.dumps({**document, "story": re.sub(r"[{}'\"]|\bnodes? ", "", str(document["story"]))}))


def attack_from_violation(
    G: GraphLike,
    f: int,
    pair: tuple[Iterable[Hashable], Iterable[Hashable]],
    *,
    malicious: Iterable[Hashable] | None = None,
    model: str = "malicious",
) -> Attack:
    """Return the attack of the necessity proof: the nodes that could break out of their set are malicious.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    pair : two sets of nodes
        A violation of (f+1,f+1)-robustness, such as ``RobustnessResult.witness``.
    malicious : set of nodes, optional
        Who is malicious; by default ``X_S1 ∪ X_S2`` for r = f + 1, at most f nodes. A set of one's own lies in the two
        sets, covers neither, and leaves nobody in them with more than f in-neighbours outside.
    model : str
        The bound that the malicious set obeys: in all, or with ``"malicious-local"`` around every normal node.

    Returns
    -------
    Attack
        The malicious nodes hold their start, so every other node of S_k hears its own position from all of S_k, and
        at most f values from outside.

    Raises
    ------
    InvalidParameter
        When the pair is no violation, or the malicious set is none that carries it out.

    Notes
    -----
    Source: Theorem 1 of the source paper, necessity; LeBlanc et al. 2013, Theorem 1.
    """
    graph = as_digraph(G)
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
    first, second = (graph.ids(side) for side in pair)
    reachable = r_reachable_ids(graph, first, f + 1) | r_reachable_ids(graph, second, f + 1)
    if malicious is None and not is_violation(graph, first, second, f + 1, f + 1):
        raise InvalidParameter(
            f"an attack on f = {f} needs a violation of ({f + 1},{f + 1})-robustness, and this pair is none: "
            "take the witness that check_rs_robustness returns"
        )
    bad = reachable if malicious is None else graph.ids(malicious)
    _require_bound(graph, bad, f, model)
    if first & second or not first - bad or not second - bad or not reachable <= bad <= first | second:
        raise InvalidParameter(
            "the malicious nodes of a violation lie in its two disjoint sets, leave a normal node in each, and are all "
            f"those with more than f = {counted(f, 'in-neighbour')} outside their set: name others"
        )
    M, S1, S2 = (graph.labels_of(ids) for ids in (bad, first, second))
    return Attack("violation", graph, f, model, M, S1, S2, delayed=False)


def attack_from_trap(
    G: GraphLike,
    f: int,
    M: Iterable[Hashable],
    S1: Iterable[Hashable],
    S2: Iterable[Hashable],
    model: str = "malicious",
) -> Attack:
    """Return the two-face attack: M shows S1 always one value and S2 always another.

    Parameters
    ----------
    G : networkx graph or Digraph
    f : int
        At least 0.
    M, S1, S2 : sets of nodes
        A *trap*: disjoint, S1 and S2 nonempty, M within the fault model, and every node of S_k has at most f
        in-neighbours outside ``S_k ∪ M``.
    model : str
        ``"malicious"`` or ``"malicious-local"``: every node of M alternates between the two values, the same for all
        neighbours, and delays of 0 or 1 step decide who sees which. ``"byzantine"`` or ``"byzantine-local"``: it
        tells each neighbour its value, without delays.

    Returns
    -------
    Attack
        Every node of S_k hears its own position from S_k and from M, and at most f other values.

    Raises
    ------
    InvalidParameter
        When the sets are no trap.

    Notes
    -----
    Proposition 1 of the source paper is one instance. A trap with ``|M| <= f`` exists exactly when ``G - M`` is not
    (f+1)-robust for some M, the condition of Vaidya, Tseng and Liang 2012 for Byzantine faults.
    """
    graph = as_digraph(G)
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
    bad, first, second = graph.ids(M), graph.ids(S1), graph.ids(S2)
    _require_bound(graph, bad, f, model)
    if not first or not second or first & second or bad & (first | second):
        raise InvalidParameter("a trap is three disjoint sets M, S1, S2 of which S1 and S2 are nonempty")
    for group in (first, second):
        for i in sorted(group):
            outside = [j for j in graph.in_neighbours(i).tolist() if j not in group and j not in bad]
            if len(outside) > f:
                raise InvalidParameter(
                    f"in a trap a node hears at most f = {f} others outside its set and M, "
                    f"but {graph.labels[i]!r} hears {len(outside)}"
                )
    sets = [graph.labels_of(ids) for ids in (bad, first, second)]
    return Attack("trap", graph, f, model, sets[0], sets[1], sets[2], delayed=not fault_model_named(model).byzantine)


def _require_bound(graph: Digraph, malicious: frozenset[int], f: int, model: str) -> None:
    """Guarantees that the malicious set obeys the model, or raises :class:`InvalidParameter`."""
    mask = np.zeros((1, graph.n), dtype=bool)
    mask[0, list(malicious)] = True
    require_fault_model(graph, mask, f, fault_model_named(model))
