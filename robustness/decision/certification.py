"""Turning answers into certificates that ``certificates`` verifies without any of this package.

The evidence is the shortest at hand: a violating pair; the degree rule; growth from a small seed; else the transcript
of a complete refutation. Whatever is returned has been verified by the kernel first.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from certificates import MalformedCertificate, RejectedCertificate
from certificates.verification import FORMAT
from robustness.answers import Answer, Question, Verdict, answers_in_turn
from robustness.cubes.executors import require_executor
from robustness.decision.bounds import settle
from robustness.decision.bounds.degree import robust_by_degree
from robustness.decision.ladder import algorithm_rung, by_convention
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph, GraphLike
from robustness.errors import InternalError, InvalidParameter, Undecided
from robustness.evidence import Convention, DegreeRule, Evidence, Growth, Refutation, ViolatingPair
from robustness.limits import Limits, Progress
from robustness.parallel_verification import verify_listing, write_with_cubes
from robustness.results import RobustnessResult
from robustness.spelled import counted, robust
from robustness.transcripts import Transcript
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["Encoded", "certify", "certify_within", "direct_evidence", "encode", "kernel_evidence"]

#: Evidence in a certificate: what its first line says of it, and the bytes that follow.
Encoded = tuple[dict[str, Any], bytes | Transcript]


@taking_numpy_integers
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
    executor: Any = None,
    state: str | Path | None = None,
    output: str | Path | None = None,
) -> RobustnessResult:
    """Decide (r,s)-robustness of G and return the result with a verified certificate of it.

    Parameters
    ----------
    G, time_limit, seed, progress, executor, state
        As for :func:`robustness.check_rs_robustness`.
    jobs : int
        Threads, and processes of this machine that verify a long refutation
        (:mod:`robustness.parallel_verification`): an executor is not trusted with that.
    r : int
        At least 1: that every graph is (0,s)-robust needs no proof.
    s : int
        In 1..n.
    evidence : "shortest" or "refutation"
        For ROBUST: whichever kind is shortest, or always the transcript of a complete search.
    output : path, optional
        A file that the certificate is written to once it has been verified, compressed by gzip when the name ends in
        ``.gz``. A long refutation then never is in memory, and ``OUTPUT.cubes`` names the trees in it that can be
        verified apart (:mod:`robustness.parallel_verification`).

    Returns
    -------
    RobustnessResult
        ``certificate`` holds the bytes for either verdict; it is None when the verdict is UNDECIDED, or when they went
        to ``output``; then ``stats["written"]`` has the names of the files, and the bytes of the certificate. Pass
        ``Digraph.canonical_bytes()`` or a node-link JSON document of the graph to the verifier.

    Raises
    ------
    InvalidParameter
        For r = 0, and where a convention decides and no pair exists: on fewer than two nodes.

    See Also
    --------
    robustness.check_rs_robustness : the answer alone
    certificates.verify : the checker

    >>> import networkx as nx
    >>> from certificates import verify
    >>> wheel = Digraph.from_networkx(nx.wheel_graph(5))
    >>> print(verify(wheel.canonical_bytes(), certify(wheel, 2).certificate).verdict)
    robust
    """
    started = time.monotonic()
    require_executor(executor)
    if evidence not in ("shortest", "refutation"):
        raise InvalidParameter(f"evidence is 'shortest' or 'refutation', not {evidence!r}")
    limits = Limits.of(time_limit, jobs, seed, progress).spread_over(executor, state)
    place = None if output is None else Path(output)
    result = certify_within(Question.about(G, r, s), limits, shortest=evidence == "shortest", output=place)
    return replace(result, seconds=time.monotonic() - started)


def certify_within(
    question: Question, limits: Limits, *, shortest: bool = True, output: Path | None = None
) -> RobustnessResult:
    """Do what :func:`certify` does for a question that is known to be valid, within ``limits``."""
    graph, r, s = question
    if r == 0 or (graph.n < 2 and r > largest_conceivable_r(graph.n)):
        raise InvalidParameter(
            f"{robust(r, s)} on {counted(graph.n, 'node')} is settled by convention: nothing to certify"
        )
    answer, proof = _proven(question, limits, shortest)
    result = RobustnessResult.of(question, answer)
    if proof is None:
        return result
    header = _header(graph, r, s, result.verdict, proof[0])
    try:
        claim, cubes = verify_listing(graph.canonical_bytes(), header, proof[1], limits)
    except (MalformedCertificate, RejectedCertificate, Undecided) as problem:
        is_told = limits.executor is not None or limits.state is not None
        if isinstance(problem, RejectedCertificate) and not is_told:
            raise InternalError(f"the certificate does not prove {result.summary()}: please report") from problem
        reason = _why_not(problem)
        if result.verdict is Verdict.NOT_ROBUST:  # the pair was re-checked: only its certificate cannot be written
            return replace(result, stats={**answer.stats, "reason": reason})
        return RobustnessResult.of(
            question, replace(Answer.undecided(reason, answer.stats), decided_by=answer.decided_by)
        )
    if (claim.verdict, claim.r, claim.s) != (result.verdict.value, r, s):
        raise InternalError(f"the certificate proves {claim}, not the verdict {result.summary()}: please report")
    if output is None:
        return replace(result, certificate=header + bytes(proof[1]))
    return replace(result, stats={**result.stats, "written": write_with_cubes(output, header, proof[1], cubes)})


def _why_not(problem: MalformedCertificate | RejectedCertificate | Undecided) -> str:
    """Return why there is no certificate."""
    if isinstance(problem, RejectedCertificate):
        return f"what workers or the journal told is no proof, so begin with a fresh journal: {problem}"
    if isinstance(problem, Undecided):
        return str(problem)
    return f"the proof is beyond what the kernel checks: {problem}"


def _proven(question: Question, limits: Limits, shortest: bool) -> tuple[Answer, Encoded | None]:
    """Climb the ladder to the first answer whose evidence the kernel knows, and return both.

    The highest rung records its search, so its proof is known to the kernel; without one it was UNDECIDED.
    """
    rungs = by_convention, settle, algorithm_rung("subset-search", {"transcript": True})
    for answer in answers_in_turn(rungs, question, limits):
        is_wanted = shortest or isinstance(answer.evidence, ViolatingPair | Refutation | Convention)
        proof = kernel_evidence(question, answer.evidence, limits) if is_wanted else None
        if proof is not None or answer.verdict is Verdict.UNDECIDED:
            break
    return answer, proof


def kernel_evidence(question: Question, evidence: Evidence, limits: Limits) -> Encoded | None:
    """Return evidence in the form of a certificate; None for a kind that the kernel does not know.

    Growth needs a proof that its seed is robust, which is searched for within ``limits``.
    """
    match evidence:
        case ViolatingPair(pair):
            return {"kind": "violation", "S1": sorted(pair.first), "S2": sorted(pair.second)}, b""
        case DegreeRule() | Convention(holds=True):
            return {"kind": "degree"}, b""
        case Growth():
            return _growth(question, evidence, limits)
        case Refutation(transcript):
            return {"kind": "refutation"}, transcript
    return None


def encode(graph: Digraph, r: int, s: int, verdict: Verdict, evidence: Encoded) -> bytes:
    """Return the certificate's bytes: one line of JSON, then the body."""
    return _header(graph, r, s, verdict, evidence[0]) + bytes(evidence[1])


def _header(graph: Digraph, r: int, s: int, verdict: Verdict, evidence: dict[str, Any]) -> bytes:
    """Return the first line of a certificate."""
    claim = {"property": "rs-robust", "r": r, "s": s, "verdict": verdict.value}
    header = {"format": FORMAT, "graph": graph.sha256, "claim": claim, "evidence": evidence}
    return json.dumps(header, separators=(",", ":")).encode("ascii") + b"\n"


def _growth(question: Question, growth: Growth, limits: Limits) -> Encoded | None:
    """Return growth evidence with its seed proven by the degree rule or by a refutation; None when neither works."""
    graph, r, s = question
    members = sorted(growth.seed)
    if len(members) < s:
        return None
    place = {i: k for k, i in enumerate(members)}
    arcs = [(place[j], place[i]) for i in members for j in graph.in_neighbours(i).tolist() if j in place]
    proof = direct_evidence(Question(Digraph(range(len(members)), arcs), r, s), limits)
    if proof is None:
        return None
    return {"kind": "growth", "seed": members, "order": growth.order.tolist(), "proof": proof[0]}, proof[1]


def direct_evidence(question: Question, limits: Limits) -> Encoded | None:
    """Return evidence of the kind "degree" or "refutation", which may prove a seed; None when neither was found."""
    graph, r, _ = question
    if robust_by_degree(graph, r) or graph.n == r == 1:
        return kernel_evidence(question, DegreeRule(), limits)
    if r > largest_conceivable_r(graph.n):
        return None
    answer = algorithm_rung("subset-search", {"transcript": True})(question, limits)
    return kernel_evidence(question, answer.evidence, limits) if answer.verdict is Verdict.ROBUST else None
