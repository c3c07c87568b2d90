"""Turning answers into certificates that ``certificates`` verifies without any of this package.

The evidence is the shortest at hand: a violating pair; the degree rule; growth from a small seed; else the transcript
of a complete refutation. Whatever is returned has been verified by the kernel first.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from certificates import MalformedCertificate, verify
from certificates.verification import FORMAT
from robustness.decision.algorithms import Pair
from robustness.decision.front import check_rs_robustness
from robustness.decision.ladder import run
from robustness.definitions import largest_conceivable_r, require_r_and_s
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InternalError, InvalidParameter
from robustness.limits import Limits, Progress, Steps
from robustness.results import RobustnessResult, Verdict, Witness

__all__ = ["Evidence", "certify", "direct_evidence", "encode"]

#: What heuristics may spend before the exact search begins: about a quarter of a second.
_HEURISTIC_STEPS = 250_000_000

#: A header and a body: what stands in the certificate's first line as evidence, and what follows it.
Evidence = tuple[dict[str, Any], bytes]


def certify(
    G: GraphLike,
    r: int,
    s: int = 1,
    *,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    evidence: str = "shortest",
) -> RobustnessResult:
    """Decide (r,s)-robustness of G and return the result with a verified certificate of it.

    Parameters
    ----------
    G, time_limit, jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`.
    r : int
        At least 1: that every graph is (0,s)-robust needs no proof.
    s : int
        In 1..n.
    evidence : "shortest" or "refutation"
        For ROBUST: whichever kind is shortest, or always the transcript of a complete search.

    Returns
    -------
    RobustnessResult
        ``certificate`` holds the bytes for either verdict; it is None when the verdict is UNDECIDED. Pass
        ``Digraph.canonical_bytes()`` or a node-link JSON document of the graph to the verifier.

    Raises
    ------
    InvalidParameter
        For r = 0, and where a convention decides and no pair exists: on fewer than two nodes.

    >>> import networkx as nx
    >>> from certificates import MalformedCertificate, verify
    >>> wheel = Digraph.from_networkx(nx.wheel_graph(5))
    >>> print(verify(wheel.canonical_bytes(), certify(wheel, 2).certificate).verdict)
    robust
    """
    started = time.monotonic()
    graph = as_digraph(G)
    require_r_and_s(graph, r, s)
    if r == 0 or (graph.n < 2 and r > largest_conceivable_r(graph.n)):
        raise InvalidParameter(f"({r},{s})-robust on {graph.n} node(s) is settled by convention: nothing to certify")
    if evidence not in ("shortest", "refutation"):
        raise InvalidParameter(f"evidence is 'shortest' or 'refutation', not {evidence!r}")
    limits = Limits.of(time_limit, jobs, seed, progress)
    if graph.n < 2 or r > largest_conceivable_r(graph.n):
        result = check_rs_robustness(graph, r, s)
        found: Evidence | None = ({"kind": "degree"}, b"")
        if result.witness is not None:
            found = _violation(Pair(graph.ids(result.witness.S1), graph.ids(result.witness.S2)))
    else:
        result, found = _search(graph, r, s, limits, evidence == "shortest")
    if found is None:
        return replace(result, seconds=time.monotonic() - started)
    certificate = encode(graph, r, s, result.verdict, found)
    try:
        claim = verify(graph.canonical_bytes(), certificate)
    except MalformedCertificate as problem:
        stats = dict(result.stats) | {"reason": f"the proof is beyond what the kernel checks: {problem}"}
        if result.verdict is Verdict.NOT_ROBUST:  # the pair was re-checked: only its certificate cannot be written
            return replace(result, stats=stats, seconds=time.monotonic() - started)
        undecided = RobustnessResult(Verdict.UNDECIDED, r, s, algorithm=result.algorithm, stats=stats)
        return replace(undecided, seconds=time.monotonic() - started)
    if (claim.verdict, claim.r, claim.s) != (result.verdict.value, r, s):
        raise InternalError(f"the certificate proves {claim}, not the verdict {result.summary()}: please report")
    return replace(result, certificate=certificate, seconds=time.monotonic() - started)


def encode(graph: Digraph, r: int, s: int, verdict: Verdict, evidence: Evidence) -> bytes:
    """Return the certificate's bytes: one line of JSON, then the body."""
    claim = {"property": "rs-robust", "r": r, "s": s, "verdict": verdict.value}
    header = {"format": FORMAT, "graph": graph.sha256, "claim": claim, "evidence": evidence[0]}
    return json.dumps(header, separators=(",", ":")).encode("ascii") + b"\n" + evidence[1]


def _search(graph: Digraph, r: int, s: int, limits: Limits, shortest: bool) -> tuple[RobustnessResult, Evidence | None]:
    """Decide by bounds or by the recorded search, and return the result with its evidence."""
    from robustness.decision.bounds import Growth, settle

    settled = settle(graph, r, s, seed=limits.seed, steps=Steps(_HEURISTIC_STEPS, limits.expired))
    if settled is not None and settled.pair is not None:
        return _result(graph, r, s, "bounds", Verdict.NOT_ROBUST, {"rule": settled.rule}, settled.pair)
    if not shortest:
        settled = None
    if settled is not None and settled.evidence == "degree":
        found = _result(graph, r, s, "bounds", Verdict.ROBUST, {"rule": settled.rule})[0]
        return found, ({"kind": "degree"}, b"")
    if settled is not None and isinstance(settled.evidence, Growth):
        evidence = _growth(graph, r, s, settled.evidence.seed, settled.evidence.order.tolist(), limits)
        if evidence is not None:
            return _result(graph, r, s, "bounds", Verdict.ROBUST, {"rule": settled.rule})[0], evidence
    answer = run(graph, r, s, "subset-search", limits, {"transcript": True})
    found, evidence = _result(graph, r, s, "subset-search", answer.verdict, answer.stats, answer.pair)
    if answer.transcript is not None:
        evidence = ({"kind": "refutation"}, answer.transcript)
    return found, evidence


def _result(
    graph: Digraph, r: int, s: int, name: str, verdict: Verdict, stats: Mapping[str, Any], pair: Pair | None = None
) -> tuple[RobustnessResult, Evidence | None]:
    witness = None if pair is None else Witness(graph.labels_of(pair.first), graph.labels_of(pair.second))
    return RobustnessResult(verdict, r, s, witness, algorithm=name, stats=stats), pair and _violation(pair)


def _violation(pair: Pair) -> Evidence:
    return {"kind": "violation", "S1": sorted(pair.first), "S2": sorted(pair.second)}, b""


def _growth(
    graph: Digraph, r: int, s: int, seed: Sequence[int], order: Sequence[int], limits: Limits
) -> Evidence | None:
    """Return growth evidence with its seed proven by the degree rule or by a refutation; None when neither works."""
    members = sorted(seed)
    if len(members) < s:
        return None
    place = {i: k for k, i in enumerate(members)}
    arcs = [(place[j], place[i]) for i in members for j in graph.in_neighbours(i).tolist() if j in place]
    induced = Digraph(range(len(members)), arcs)
    proof = direct_evidence(induced, r, s, limits)
    if proof is None:
        return None
    return {"kind": "growth", "seed": members, "order": list(order), "proof": proof[0]}, proof[1]


def direct_evidence(graph: Digraph, r: int, s: int, limits: Limits) -> Evidence | None:
    """Return evidence of the kind "degree" or "refutation", which may prove a seed; None when neither was found."""
    if int(graph.in_degrees.min()) >= graph.n // 2 + r - 1:
        return {"kind": "degree"}, b""
    if r > largest_conceivable_r(graph.n):
        return None
    answer = run(graph, r, s, "subset-search", limits, {"transcript": True})
    return None if answer.transcript is None else ({"kind": "refutation"}, answer.transcript)
