"""Evidence that is checked against the graph itself: a violating pair, the degree rule, a refutation, growth."""

from __future__ import annotations

from typing import Any

from certificates.envelope import id_list, id_set, require_keys, require_no_body, shown
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph
from certificates.refutation import check_refutation
from certificates.stream import Stream

__all__ = ["check_direct", "check_growth", "check_violation"]


def check_violation(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any]) -> None:
    """The definition: S1 and S2 are nonempty and disjoint, neither is all r-reachable, fewer than s nodes are."""
    pair = [set(id_set(evidence[name], graph.n, name)) for name in ("S1", "S2")]
    if not pair[0] or not pair[1] or pair[0] & pair[1]:
        raise RejectedCertificate("S1 and S2 are not nonempty and disjoint", "violation")
    reachable = [sum(len([j for j in graph.hears[i] if j not in S]) >= r for i in S) for S in pair]
    if reachable[0] == len(pair[0]) or reachable[1] == len(pair[1]) or sum(reachable) >= s:
        raise RejectedCertificate(
            f"the pair does not violate ({r},{s})-robustness: {reachable[0]} of {len(pair[0])} and {reachable[1]} of "
            f"{len(pair[1])} nodes have at least {r} in-neighbours outside their set",
            "violation",
        )


def check_direct(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
    """Evidence that needs no other: a degree bound or a refutation; return the tree nodes replayed.

    degree  Lemma 3: in-degrees of at least floor(n/2) + r - 1 make the graph (r,s)-robust for every s, since the
            smaller set of any pair has at most floor(n/2) nodes, so each of its nodes hears at least r outside.
    """
    if evidence["kind"] == "refutation":
        return check_refutation(graph, r, s, body)
    least = min(map(len, graph.hears))
    if evidence["kind"] != "degree":
        raise MalformedCertificate(f"a proof is of kind 'degree' or 'refutation', not {shown(evidence['kind'])}")
    require_no_body(body, "evidence of kind 'degree'")
    if least < graph.n // 2 + r - 1:
        raise RejectedCertificate(
            f"the least in-degree {least} is below floor(n/2) + r - 1 = {graph.n // 2 + r - 1}", "degree"
        )
    return 0


def check_growth(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
    """Lemma 4: a node that hears at least r + s - 1 nodes of an (r,s)-robust graph can be added to it.

    The seed is the subgraph induced on ``seed``, proven by ``proof`` (of kind degree or refutation); ``order`` lists
    every other node once.
    """
    seed = id_set(evidence["seed"], graph.n, "seed")
    order = id_list(evidence["order"], graph.n, "order")
    proof = require_keys(evidence["proof"], "the proof of the seed", "kind")
    if sorted(seed + order) != list(range(graph.n)):
        raise RejectedCertificate("seed and order together do not list every node once", "growth")
    if len(seed) < s:
        raise RejectedCertificate(
            f"a seed of {len(seed)} nodes cannot be ({r},{s})-robust: s is at most its size", "growth"
        )
    index = {node: i for i, node in enumerate(seed)}
    induced = CanonicalGraph(
        tuple(graph.labels[i] for i in seed),
        tuple(tuple(index[j] for j in graph.hears[i] if j in index) for i in seed),
        "",
    )
    tree_nodes = check_direct(induced, r, s, proof, body)
    present = set(seed)
    for node in order:
        heard = sum(j in present for j in graph.hears[node])
        if heard < r + s - 1:
            raise RejectedCertificate(
                f"node {node} hears {heard} earlier nodes, below r + s - 1 = {r + s - 1}", "growth"
            )
        present.add(node)
    return tree_nodes
