"""What a certificate claims, after the kernel has verified it."""

from __future__ import annotations

import json
from typing import NamedTuple

from certificates.graph import Label
from certificates.verification import verify
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.results import RobustnessResult, Verdict

__all__ = ["Claim", "claim_of_certificate", "claim_of_result"]


class Claim(NamedTuple):
    """A decision about (r,s)-robustness; ``pair`` is the violating pair, or None when the graph is robust."""

    r: int
    s: int
    pair: tuple[frozenset[Label], frozenset[Label]] | None


def claim_of_certificate(graph: Digraph, certificate: bytes) -> Claim:
    """Return what the kernel proves from the bytes; its errors (``CertificateError``) are left to the caller."""
    claim = verify(graph.canonical_bytes(), certificate)
    if claim.verdict == "robust":
        return Claim(claim.r, claim.s, None)
    # Verified, so the header is what docs/certificate-format.md says: one line of JSON with the evidence.
    evidence = json.loads(certificate.partition(b"\n")[0])["evidence"]
    return Claim(claim.r, claim.s, (graph.labels_of(evidence["S1"]), graph.labels_of(evidence["S2"])))


def claim_of_result(result: RobustnessResult) -> Claim:
    """Return what a result decides; an undecided one is an :class:`InvalidParameter` error."""
    if result.verdict in (Verdict.ROBUST, Verdict.DETERMINED):
        return Claim(result.r, result.s, None)
    if result.verdict is Verdict.UNDECIDED:
        raise InvalidParameter("a certificate decides robustness, but this result is undecided: raise its time limit")
    if result.witness is None:
        raise InvalidParameter("on fewer than two nodes there is no pair to attack with: take a larger network")
    return Claim(result.r, result.s, (result.witness.S1, result.witness.S2))
