"""The one entry of the kernel: graph bytes and certificate bytes in, a verified claim out, or an error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from certificates.derivation import check_derivation
from certificates.direct import check_direct, check_growth, check_violation
from certificates.envelope import kind_of, open_certificate, require_about, require_keys, require_no_body, shown
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import decode_graph
from certificates.stream import Blocks, Stream

__all__ = ["FORMAT", "VerifiedClaim", "prove", "verify"]

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
            tree_nodes = check_direct(graph, r, s, require_keys(evidence, "the evidence", "kind"), body)
        case "robust", "growth":
            grown = require_keys(evidence, "the evidence", "kind seed order proof")
            tree_nodes = check_growth(graph, r, s, grown, body)
        case "robust", "derivation":
            keys = "kind seed proof steps ids"
            tree_nodes = check_derivation(graph, r, s, require_keys(evidence, "the evidence", keys), body)
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
