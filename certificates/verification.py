"""The one entry of the kernel: graph bytes and certificate bytes in, a verified claim out, or an error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from certificates.derivation import Derivation
from certificates.envelope import (
    id_list,
    id_set,
    kind_of,
    open_certificate,
    require_about,
    require_keys,
    require_no_body,
    shown,
)
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph, decode_graph
from certificates.refutation import check_refutation
from certificates.stream import Blocks, Stream

__all__ = ["FORMAT", "VerifiedClaim", "check_violation", "prove", "verify"]

FORMAT = "robustness/certificate/1"


@dataclass(frozen=True, slots=True)
class VerifiedClaim:
    """What was proven about which graph, and by which kind of evidence."""

    verdict: str
    r: int
    s: int
    evidence: str
    sha256: str
    nodes: int
    arcs: int
    #: Nodes of the search tree that were replayed; 0 without a refutation.
    tree_nodes: int = 0

    def __str__(self) -> str:
        word = "is" if self.verdict == "robust" else "is not"
        return (
            f"the graph with {self.nodes} nodes, {self.arcs} arcs and SHA-256 {self.sha256} {word} "
            f"({self.r},{self.s})-robust (evidence: {self.evidence})"
        )


def verify(graph_bytes: bytes, certificate_bytes: Blocks | Stream) -> VerifiedClaim:
    """Return the claim that ``certificate_bytes`` proves about the graph in ``graph_bytes``.

    Parameters
    ----------
    graph_bytes : bytes
        The canonical graph, or a node-link JSON document of it.
    certificate_bytes : bytes or iterable of bytes
        A certificate as docs/certificate-format.md defines it; in pieces it is read as it is needed, and not kept.

    Raises
    ------
    Misuse
        When an argument is not bytes.
    MalformedCertificate
        When the bytes are not of the formats (``MalformedGraph`` for the graph).
    RejectedCertificate
        When the certificate does not prove its claim about this graph.
    """
    return prove(graph_bytes, Stream.whole(certificate_bytes))


def prove(graph_bytes: bytes, certificate: Stream) -> VerifiedClaim:
    """Do what :func:`verify` does; a stream may leave parts to others, and then nothing is proven by this one."""
    document, body = open_certificate(graph_bytes, certificate, "graph", [FORMAT])
    claim = require_keys(document["claim"], "the claim", "property r s verdict")
    evidence = document["evidence"]
    graph = decode_graph(graph_bytes)
    require_about(document, "graph", graph.sha256)
    r, s = _claim_numbers(claim, graph.n)
    kind, verdict = kind_of(evidence), claim["verdict"]
    if verdict == "robust" and r > (graph.n + 1) // 2:
        # Lemma 2; on one node, where no pair exists, it is the convention.
        raise RejectedCertificate(
            f"no graph on {graph.n} node(s) is ({r},{s})-robust: r is at most ceil(n/2)", "beyond-half"
        )
    tree_nodes = 0
    match verdict, kind:
        case "not-robust", "violation":
            check_violation(graph, r, s, require_keys(evidence, "the evidence", "kind S1 S2"))
        case "robust", "degree" | "refutation":
            tree_nodes = _check_direct(graph, r, s, require_keys(evidence, "the evidence", "kind"), body)
        case "robust", "growth":
            grown = require_keys(evidence, "the evidence", "kind seed order proof")
            tree_nodes = _check_growth(graph, r, s, grown, body)
        case "robust", "derivation":
            keys = "kind seed proof steps ids"
            tree_nodes = _check_derivation(graph, r, s, require_keys(evidence, "the evidence", keys), body)
        case "robust" | "not-robust", _:
            raise MalformedCertificate(f"there is no evidence of kind {shown(kind)} for the verdict {verdict!r}")
        case _:
            raise MalformedCertificate(f"a verdict is 'robust' or 'not-robust', not {shown(verdict)}")
    if kind == "violation":
        require_no_body(body, "evidence of kind 'violation'")
    return VerifiedClaim(verdict, r, s, kind, graph.sha256, graph.n, graph.arc_count, tree_nodes)


def _claim_numbers(claim: dict[str, Any], n: int) -> tuple[int, int]:
    """Return r and s of a claim in range: r >= 1 and 1 <= s <= n, on at least one node."""
    if claim["property"] != "rs-robust":
        raise MalformedCertificate(f"the property is 'rs-robust', not {shown(claim['property'])}")
    r, s = claim["r"], claim["s"]
    if type(r) is not int or type(s) is not int or not 1 <= r <= 2**31:
        raise MalformedCertificate("r and s are integers, and r lies in 1..2147483648")
    if not 1 <= s <= n:
        raise MalformedCertificate(f"s lies in 1..n = 1..{n}, not {s}")
    return r, s


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


def _check_direct(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
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


def _check_growth(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
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
    tree_nodes = _check_direct(induced, r, s, proof, body)
    present = set(seed)
    for node in order:
        heard = sum(j in present for j in graph.hears[node])
        if heard < r + s - 1:
            raise RejectedCertificate(
                f"node {node} hears {heard} earlier nodes, below r + s - 1 = {r + s - 1}", "growth"
            )
        present.add(node)
    return tree_nodes


def _check_derivation(graph: CanonicalGraph, r: int, s: int, evidence: dict[str, Any], body: Stream) -> int:
    """A seed proven by ``proof``, steps that make the graph of it, and ``ids``: which node of it each node made is."""
    seed = require_keys(evidence["seed"], "the seed", "nodes arcs r s")
    proof = require_keys(evidence["proof"], "the proof of the seed", "kind")
    made = Derivation(seed["nodes"], seed["arcs"], seed["r"], seed["s"])
    hears = tuple(tuple(sorted(heard)) for heard in made.hears)
    start = CanonicalGraph(tuple(range(len(hears))), hears, "")
    tree_nodes = _check_direct(start, made.r, made.s, proof, body)
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
