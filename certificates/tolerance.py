"""Tolerance: a certificate that f malicious nodes can hold two groups of a network apart, or that they cannot.

Let f >= 0. Three sets M, S1, S2 and the normal members ``N_k = S_k - M``, both nonempty. With *two* faces M, S1 and S2
are disjoint and every node of N_k hears at most f nodes outside ``S_k | M`` (a trap); with *one* face S1 and S2 are
disjoint, M lies in their union, and every node of N_k hears at most f nodes outside S_k (a violation). M is bounded
in *total*, ``|M| <= f``, or *locally*: every node outside M hears at most f nodes of M.

What such sets mean for consensus is no business of the kernel. docs/certificate-format.md has the format.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from certificates.envelope import id_set, kind_of, open_certificate, require_about, require_keys, require_no_body, shown
from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import CanonicalGraph, decode_graph, encode_graph
from certificates.separation import check_separation
from certificates.stream import Blocks, Stream
from certificates.verification import prove

__all__ = [
    "FORMAT",
    "FORMATS",
    "FORMAT_WITH_REFUTATIONS",
    "VerifiedToleranceClaim",
    "check_sets",
    "prove_tolerance",
    "verify_tolerance",
]

#: The second has one kind of evidence more, "refutation"; whatever the first accepts, the second does too.
FORMAT = "robustness/tolerance-certificate/1"
FORMAT_WITH_REFUTATIONS = "robustness/tolerance-certificate/2"
FORMATS = (FORMAT, FORMAT_WITH_REFUTATIONS)

_MOST = 2**31


@dataclass(frozen=True, slots=True)
class VerifiedToleranceClaim:
    """What was proven about which graph, and by which kind of evidence."""

    #: ``"apart"``: the sets exist. ``"together"``: they do not.
    verdict: str
    f: int
    faces: int
    bound: str
    evidence: str
    sha256: str
    nodes: int
    arcs: int
    #: Ordinary certificates that were verified: one for evidence of kind "robust".
    certificates: int = 0
    #: Nodes of search trees that were replayed, in it or in the certificate's own refutation.
    tree_nodes: int = 0

    def __str__(self) -> str:
        kind = "trap" if self.faces == 2 else "violation"
        word = "has a" if self.verdict == "apart" else "has no"
        where = "in total" if self.bound == "total" else "locally"
        return (
            f"the graph with {self.nodes} nodes, {self.arcs} arcs and SHA-256 {self.sha256} {word} "
            f"{kind} for f = {self.f} {where} (evidence: {self.evidence})"
        )


def verify_tolerance(graph_bytes: bytes, certificate_bytes: Blocks | Stream) -> VerifiedToleranceClaim:
    """Return the claim that ``certificate_bytes`` proves about the graph in ``graph_bytes``.

    Parameters
    ----------
    graph_bytes : bytes
        The canonical graph, or a node-link JSON document of it.
    certificate_bytes : bytes or iterable of bytes
        A tolerance certificate as docs/certificate-format.md defines it.

    Raises
    ------
    Misuse
        When an argument is not bytes.
    MalformedCertificate
        When the bytes are not of the formats (``MalformedGraph`` for the graph).
    RejectedCertificate
        When the certificate does not prove its claim about this graph.
    """
    return prove_tolerance(graph_bytes, Stream.whole(certificate_bytes))


def prove_tolerance(graph_bytes: bytes, certificate: Stream) -> VerifiedToleranceClaim:
    """Do what :func:`verify_tolerance` does; see :func:`certificates.verification.prove`."""
    document, body = open_certificate(graph_bytes, certificate, "graph", FORMATS)
    f, faces, bound, verdict = _claim(require_keys(document["claim"], "the claim", "f faces bound verdict"))
    graph = decode_graph(graph_bytes)
    require_about(document, "graph", graph.sha256)
    evidence, kind = document["evidence"], kind_of(document["evidence"])
    used = tree_nodes = 0
    match verdict, kind:
        case "apart", "sets":
            check_sets(graph, f, faces, bound, require_keys(evidence, "the evidence", "kind M S1 S2"))
            require_no_body(body, "evidence of kind 'sets'")
        case "together", "robust":
            require_keys(evidence, "the evidence", "kind")
            used, tree_nodes = 1, _check_robust(_canonical(graph), body, 2 * f + 1)
        case "together", "refutation" if document["format"] == FORMAT_WITH_REFUTATIONS:
            require_keys(evidence, "the evidence", "kind")
            tree_nodes = check_separation(graph, f, faces, bound, body)
        case _:
            raise MalformedCertificate(f"there is no evidence of kind {shown(kind)} for the verdict {verdict!r}")
    return VerifiedToleranceClaim(
        verdict, f, faces, bound, kind, graph.sha256, graph.n, graph.arc_count, used, tree_nodes
    )


def _claim(claim: dict[str, Any]) -> tuple[int, int, str, str]:
    f, faces, bound, verdict = (claim[key] for key in ("f", "faces", "bound", "verdict"))
    if type(f) is not int or not 0 <= f <= _MOST:
        raise MalformedCertificate(f"f is an integer in 0..{_MOST}")
    if type(faces) is not int or faces not in (1, 2):
        raise MalformedCertificate("faces is 1 or 2")
    if bound not in ("total", "local"):
        raise MalformedCertificate(f"a bound is 'total' or 'local', not {shown(bound)}")
    if verdict not in ("apart", "together"):
        raise MalformedCertificate(f"a verdict is 'apart' or 'together', not {shown(verdict)}")
    return f, faces, bound, verdict


def check_sets(graph: CanonicalGraph, f: int, faces: int, bound: str, evidence: dict[str, Any]) -> None:
    """The definition, clause by clause."""
    M, S1, S2 = (set(id_set(evidence[name], graph.n, name)) for name in ("M", "S1", "S2"))
    if S1 & S2 or not S1 - M or not S2 - M:
        raise RejectedCertificate("S1 and S2 are not disjoint with a normal node in each", "sets")
    if faces == 2 and M & (S1 | S2):
        raise RejectedCertificate("with two faces M is outside S1 and S2", "sets")
    if faces == 1 and M - S1 - S2:
        raise RejectedCertificate("with one face M lies inside S1 and S2", "sets")
    if bound == "total" and len(M) > f:
        raise RejectedCertificate(f"M has {len(M)} nodes, more than f = {f}", "sets")
    if bound == "local":
        for i, heard in enumerate(graph.hears):
            if i not in M and len(M.intersection(heard)) > f:
                raise RejectedCertificate(f"node {i} is outside M and hears more than f = {f} nodes of M", "sets")
    for side in (S1, S2):
        inside = side | M if faces == 2 else side
        for i in side - M:
            if sum(j not in inside for j in graph.hears[i]) > f:
                raise RejectedCertificate(f"node {i} hears more than f = {f} nodes outside its side", "sets")


def _check_robust(graph_bytes: bytes, certificate: Stream, r: int) -> int:
    """The ordinary certificate proves r-robustness; return the tree nodes replayed.

    A (2f+1)-robust graph keeps together: of any two disjoint nonempty N1, N2 one has a node that hears 2f + 1 nodes
    outside its own. At most f of these are in M, however M is bounded, so f + 1 lie outside ``N_k | M``, hence S_k.
    """
    claim = prove(graph_bytes, certificate)
    if (claim.verdict, claim.r, claim.s) != ("robust", r, 1):
        raise RejectedCertificate(f"the ordinary certificate proves another claim than {r}-robustness", "other-claim")
    return claim.tree_nodes


def _canonical(graph: CanonicalGraph) -> bytes:
    """Return the canonical bytes of a decoded graph."""
    return encode_graph(graph.labels, sorted((j, i) for i, heard in enumerate(graph.hears) for j in heard))
