"""Derivations: from a robust seed to the graph, in steps that are each known to keep or change (r,s) in one way.

A step is carried out on the arcs and on the pair (r,s) at once, by the function that bears its name; the lemma of each
is proven under the same name in docs/certificate-format.md. Between the steps "(r,s)-robust" means that no violating
pair of (r,s) exists, whatever s and the number of nodes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from certificates.direct import check_direct
from certificates.envelope import id_list, require_keys
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph
from certificates.stream import Stream

__all__ = ["MAX_WORK", "Derivation", "check_derivation"]

#: Arcs that all steps together may make or copy beside those that they list; a node counts like eight.
MAX_WORK = 2**22

#: The greatest number that a step may name.
_MOST = 2**31

_KEYS = {
    "weaken": {"rule", "r", "s"},
    "add-arcs": {"rule", "arcs"},
    "remove-arcs": {"rule", "arcs"},
    "remove-nodes": {"rule", "nodes"},
    "add-node": {"rule", "hears"},
    "join-clique": {"rule", "size"},
    "blow-up": {"rule", "copies", "cliques"},
}


class Derivation:
    """A graph in the making, ``hears[i]`` being the nodes that i hears, and the (r,s) that it is sure to have."""

    def __init__(self, nodes: Any, arcs: Any, r: Any, s: Any) -> None:
        self.work = 0
        self.step = 0
        self.hears: list[set[int]] = []
        self.spend(8 * self.number(nodes, "the number of nodes"))
        self.hears = [set() for _ in range(nodes)]
        self.r, self.s = self.number(r, "r"), self.number(s, "s")
        self.link(arcs)

    def take(self, steps: Any) -> None:
        """Carry out all steps.

        Raises
        ------
        MalformedCertificate
            When a step is not of the format, or all together make too large a graph.
        RejectedCertificate
            When a step cannot be carried out, or leaves nothing that is sure.
        """
        if not isinstance(steps, list):
            raise MalformedCertificate("steps is a list")
        for self.step, step in enumerate(steps, 1):
            rule = step.get("rule") if isinstance(step, dict) else None
            if type(rule) is not str or set(step) != _KEYS.get(rule):
                known = "; ".join(" ".join(sorted(keys)) for keys in _KEYS.values())
                raise MalformedCertificate(f"step {self.step} is an object with exactly the keys of one rule: {known}")
            self.carry_out(rule, step)
            if self.r < 1:
                raise self.reject("r is below 1 after it")

    def carry_out(self, rule: str, step: dict[str, Any]) -> None:
        """Carry out one step with the keys of its rule."""
        match rule:
            case "weaken":
                self.weaken(self.number(step["r"], "r"), self.number(step["s"], "s"))
            case "add-arcs":
                self.link(step["arcs"])  # X_S^r never loses a node, so (r,s) is kept.
            case "remove-arcs":
                self.remove_arcs(step["arcs"])
            case "remove-nodes":
                self.remove_nodes(step["nodes"])
            case "add-node":
                self.add_node(step["hears"])
            case "join-clique":
                self.join_clique(self.number(step["size"], "the size"))
            case _:
                self.blow_up(self.number(step["copies"], "the number of copies"), step["cliques"])

    def weaken(self, r: int, s: int) -> None:
        """(r,s) turns into (r',s') when r' <= r and s' <= s + r - r'."""
        if r > self.r or s > self.s + self.r - r:
            raise self.reject(f"({r},{s}) does not follow from ({self.r},{self.s})")
        self.r, self.s = r, s

    def link(self, arcs: Any) -> None:
        """Add arcs that are not there."""
        for u, v in self.pairs(arcs):
            if u in self.hears[v]:
                raise self.reject(f"the arc {u}, {v} is there already")
            self.hears[v].add(u)

    def remove_arcs(self, arcs: Any) -> None:
        """(r,s) turns into (r - w, s) when no node loses more than w in-arcs."""
        pairs = self.pairs(arcs)
        for u, v in pairs:
            if u not in self.hears[v]:
                raise self.reject(f"the arc {u}, {v} is not there")
            self.hears[v].remove(u)
        self.r -= max(Counter(v for _, v in pairs).values(), default=0)

    def remove_nodes(self, nodes: Any) -> None:
        """(r,s) turns into (r - w, s) when no node that stays hears more than w of the others."""
        gone = set(self.ids(nodes))
        self.spend(8 * len(self.hears) + sum(map(len, self.hears)))
        kept = [i for i in range(len(self.hears)) if i not in gone]
        place = {i: k for k, i in enumerate(kept)}
        self.r -= max((len(self.hears[i] & gone) for i in kept), default=0)
        self.hears = [{place[j] for j in self.hears[i] if j in place} for i in kept]

    def add_node(self, hears: Any) -> None:
        """(r,s) is kept by a new node that hears at least r + s - 1 others (Lemma 4)."""
        heard = set(self.ids(hears))
        self.spend(8)
        if len(heard) < self.r + self.s - 1:
            raise self.reject(f"the new node hears {len(heard)} nodes, below r + s - 1 = {self.r + self.s - 1}")
        self.hears.append(heard)

    def join_clique(self, size: int) -> None:
        """Joined with a clique of m nodes to N nodes in all, d being the least in-degree before, r turns into R.

        ``R = min(r + m, ceil(N/2), max(m, floor((m + d)/2) + 1))``, and s into 1.
        """
        n = len(self.hears)
        self.spend(size * (2 * n + size + 8))
        least = min(map(len, self.hears), default=0)
        self.r = min(self.r + size, (n + size + 1) // 2, max(size, (size + least) // 2 + 1))
        self.s = 1
        everyone = set(range(n + size))
        for heard in self.hears:
            heard.update(range(n, n + size))
        self.hears += [everyone - {i} for i in range(n, n + size)]

    def blow_up(self, copies: int, cliques: Any) -> None:
        """With t copies of every node, that hear all copies of what it hears, r turns into R, and s into 1.

        ``R = min(t r, ceil(t d / 2))``, where d is the least in-degree, and one more when copies hear each other.
        Node i becomes t i .. t i + t - 1.
        """
        if type(cliques) is not bool:
            raise MalformedCertificate(f"step {self.step}: cliques is true or false")
        self.spend(copies * copies * (8 * len(self.hears) + sum(map(len, self.hears))))
        least = min(map(len, self.hears), default=0) + cliques
        self.r, self.s = min(copies * self.r, (copies * least + 1) // 2), 1
        made = []
        for i, heard in enumerate(self.hears):
            all_copies = {copies * j + k for j in (heard | {i} if cliques else heard) for k in range(copies)}
            made += [all_copies - {copies * i + k} for k in range(copies)]
        self.hears = made

    def number(self, value: Any, what: str) -> int:
        """Return a positive integer."""
        if type(value) is not int or not 1 <= value <= _MOST:
            raise MalformedCertificate(f"step {self.step}: {what} is an integer in 1..{_MOST}")
        return value

    def ids(self, nodes: Any) -> list[int]:
        """Return a strictly ascending list of nodes that are there."""
        if not isinstance(nodes, list) or not all(type(i) is int for i in nodes):
            raise MalformedCertificate(f"step {self.step}: a list of ids is expected")
        if any(not a < b for a, b in pairwise([-1, *nodes, len(self.hears)])):
            raise self.reject(f"ids ascend strictly in 0..{len(self.hears) - 1}")
        return nodes

    def pairs(self, arcs: Any) -> Sequence[tuple[int, int]]:
        """Return a list of pairs of different nodes that are there."""
        if not isinstance(arcs, list) or not all(
            isinstance(arc, list) and len(arc) == 2 and all(type(i) is int for i in arc) for arc in arcs
        ):
            raise MalformedCertificate(f"step {self.step}: arcs is a list of pairs of ids")
        if not all(0 <= u < len(self.hears) and 0 <= v < len(self.hears) and u != v for u, v in arcs):
            raise self.reject(f"an arc joins two different nodes in 0..{len(self.hears) - 1}")
        return [(u, v) for u, v in arcs]

    def spend(self, work: int) -> None:
        """Refuse steps that would make the checker build large graphs from few bytes."""
        self.work += work
        if self.work > MAX_WORK:
            raise MalformedCertificate(f"step {self.step}: the steps make more than {MAX_WORK} arcs")

    def reject(self, why: str) -> RejectedCertificate:
        """Return the error that says what is wrong, and where; step 0 is the seed."""
        return RejectedCertificate(f"derivation, step {self.step}: {why}", "derivation")


def check_derivation(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
    """Check a seed, proven by ``proof``, and the steps that make the graph from it; return the tree nodes replayed.

    ``ids`` tells which node of the graph each node is that was made.
    """
    seed = require_keys(evidence["seed"], "the seed", "nodes arcs r s")
    proof = require_keys(evidence["proof"], "the proof of the seed", "kind")
    made = Derivation(seed["nodes"], seed["arcs"], seed["r"], seed["s"])
    hears = tuple(tuple(sorted(heard)) for heard in made.hears)
    start = CanonicalGraph(tuple(range(len(hears))), hears, "")
    tree_nodes = check_direct(start, made.r, made.s, proof, body)
    made.take(evidence["steps"])
    made.weaken(r, s)
    ids = id_list(evidence["ids"], graph.n, "ids")
    if len(ids) != len(made.hears) or sorted(ids) != list(range(graph.n)):
        raise RejectedCertificate(
            f"ids do not name each of the {graph.n} nodes once, for {len(made.hears)} nodes made", "derivation"
        )
    for i, heard in zip(ids, made.hears, strict=True):
        if {ids[j] for j in heard} != set(graph.hears[i]):
            raise RejectedCertificate(
                f"node {i} of the graph hears others than in the graph that the steps make", "derivation"
            )
    return tree_nodes
