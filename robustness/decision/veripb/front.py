"""Proofs for a third party's checker: a certificate of robustness, written as a pseudo-Boolean proof that VeriPB reads.

``export`` writes two files. The *model* (OPB) is the definition of a violating pair of (r,s), in 0-1 variables and
linear inequalities, made from the graph alone; it has no solution exactly when the graph is (r,s)-robust. The *proof*
derives the contradiction ``0 >= 1`` from the model in steps that a checker follows without knowing anything of graphs.
docs/veripb.md explains both and says how to check them.

:mod:`~robustness.decision.veripb.inequalities` is what a reader has to trust beside the checker; nothing in
the other modules can make a wrong model unsatisfiable.
"""

from __future__ import annotations

import json

from certificates import verify
from certificates.graph import decode_graph
from robustness.decision.veripb.inequalities import Model
from robustness.decision.veripb.lemmas import derive_degree, derive_growth
from robustness.decision.veripb.proof import SYNTAXES, Proof
from robustness.decision.veripb.transcript import derive_refutation
from robustness.errors import InvalidParameter

__all__ = ["export"]


def export(graph_bytes: bytes, certificate_bytes: bytes, *, version: str = "3.0") -> tuple[bytes, bytes]:
    """Return model and proof, the contents of ``NAME.opb`` and ``NAME.pbp``, that the graph is (r,s)-robust.

    Parameters
    ----------
    graph_bytes : bytes
        The canonical graph, or a node-link JSON document of it.
    certificate_bytes : bytes
        A certificate that this graph is robust, with evidence of any kind but a derivation; it is verified first.
    version : "3.0" or "1.1"
        The syntax of the proof: that of VeriPB 3, or that of the checkers before 2.0.

    Raises
    ------
    InvalidParameter
        When ``version`` is another, or the certificate is that the graph is not robust, or a derivation.
    CertificateError
        When the certificate does not prove its claim about this graph.

    Notes
    -----
    Takes about as long as verifying the certificate. The proof has a few lines for every node of the tree and every
    exclusion, each of O(n) terms: some ten to twenty times the bytes of the certificate.

    >>> import networkx as nx
    >>> from robustness import Digraph
    >>> from robustness.decision.certification import certify
    >>> triangle = Digraph.from_networkx(nx.complete_graph(3))
    >>> certificate = certify(triangle, 2, evidence="refutation").certificate
    >>> model, proof = export(triangle.canonical_bytes(), certificate)
    >>> proof.decode().splitlines()[-3:]
    ['output NONE ;', 'conclusion UNSAT : 17 ;', 'end pseudo-Boolean proof ;']
    """
    if version not in SYNTAXES:
        raise InvalidParameter(f"the VeriPB version is one of {', '.join(SYNTAXES)}, not {version!r}")
    claim = verify(graph_bytes, certificate_bytes)
    if claim.verdict != "robust":
        raise InvalidParameter("a VeriPB proof shows that a graph is robust, but this certificate shows that it is not")
    header, _, body = certificate_bytes.partition(b"\n")
    evidence = json.loads(header)["evidence"]
    if evidence["kind"] == "derivation":
        raise InvalidParameter("a derivation has no VeriPB proof: certify the graph with evidence='refutation'")
    model = part = Model.of(decode_graph(graph_bytes), claim.r, claim.s)
    proof = Proof(model, SYNTAXES[version])
    if evidence["kind"] == "growth":
        part = derive_growth(model, evidence["seed"], evidence["order"], proof)
        evidence = evidence["proof"]
    if evidence["kind"] == "degree":
        derive_degree(part, proof)
    else:
        derive_refutation(part, model, body, proof)
    return model.text().encode("ascii"), proof.text().encode("ascii")
