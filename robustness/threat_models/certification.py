"""Certificates of tolerance: what is guaranteed and what is refuted, for anybody to check without this package.

==========================  ===================================================================  =====================
what                        the certificate proves                                               verified by
==========================  ===================================================================  =====================
guaranteed, malicious       (f+1,f+1)-robust                                                     ``verify``
guaranteed, all others      no attack of this kind on f: (2f+1)-robust, or the transcript of a   ``verify_tolerance``
                            search that finds none
guaranteed, over time       jointly (2f+1)-robust over few enough steps                          ``verify_joint``
refuted, malicious          not (f+1,f+1)-robust                                                 ``verify``
refuted, all others         the sets M, S1, S2 of the attack                                     ``verify_tolerance``
==========================  ===================================================================  =====================

The kernel proves statements about graphs. That they promise or forbid agreement is what the theorems in the result's
reasons say.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from certificates import MalformedCertificate, verify, verify_tolerance
from certificates.tolerance import FORMAT, FORMAT_WITH_REFUTATIONS
from robustness import answers
from robustness.decision.certification import certify, encode
from robustness.decision.ladder import settle_quickly
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import InternalError
from robustness.evidence import Pair
from robustness.limits import Limits, Progress
from robustness.results import Verdict
from robustness.threat_models.results import AttackSets, ToleranceResult
from robustness.traps import searching
from robustness.traps.question import Question

__all__ = ["ToleranceCertificates", "certify_promise", "certify_tolerance"]

#: Beyond this many nodes the memory for a transcript is not worth trying.
_MOST_NODES = 3_000


@dataclass(frozen=True, slots=True)
class ToleranceCertificates:
    """The certificates of one result; each has been verified by the kernel.

    ``None`` for what is not claimed; where a limit stopped the work; and for what holds only over time, for which the
    kernel has no evidence.
    For a time-varying network ``guaranteed`` is a certificate of joint robustness, bound to
    :func:`robustness.time_varying.canonical_sequence`, and ``refuted`` is about the union of the steps.
    """

    guaranteed: bytes | None
    refuted: bytes | None
    #: What of the two holds only over time.
    over_time: frozenset[str] = frozenset()


def certify_tolerance(
    result: ToleranceResult,
    *,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> ToleranceCertificates:
    """Return certificates of ``result.guaranteed`` and ``result.refuted``.

    Parameters
    ----------
    result : ToleranceResult
    time_limit : float, optional
        Wall-clock seconds; refutations are written again, with their transcripts.
    jobs, seed, progress
        As for :func:`robustness.certify`.

    >>> import networkx as nx
    >>> from robustness.threat_models import tolerance
    >>> found = certify_tolerance(tolerance(nx.wheel_graph(5), "delayed"))
    >>> print(verify_tolerance(Digraph.from_networkx(nx.wheel_graph(5)).canonical_bytes(), found.refuted).verdict)
    apart
    """
    work = _Work(result.graph, Limits.of(time_limit, jobs, seed, progress))
    guaranteed, over_time = None, set()
    if result.graph.n >= 2 and result.guaranteed >= 0:
        if result.over_time:
            guaranteed, is_joint = work.promise_over_time(result)
            over_time |= set() if is_joint else {"guaranteed"}
        else:
            guaranteed = work.promise(result.threat.question(result.guaranteed))
    if result.attack_sets is not None and result.attack_sets.remembered:
        over_time.add("refuted")
    return ToleranceCertificates(guaranteed, _refutation(result), frozenset(over_time))


def certify_promise(graph: Digraph, question: Question, limits: Limits) -> bytes | None:
    """Return a certificate that no sets answer a question about traps; None when none was found.

    With one face in total it is an ordinary one, of (f+1,f+1)-robustness.
    """
    return _Work(graph, limits).promise(question)


@dataclass(frozen=True, slots=True)
class _Work:
    """Certificates of one graph, all within the same limits."""

    graph: Digraph
    limits: Limits

    def promise(self, question: Question) -> bytes | None:
        f = question.f
        if question == Question(f, two_faces=False):
            return self.robust(self.graph, f + 1, f + 1)
        twice = answers.Question(self.graph, 2 * f + 1, 1)
        settled = None if twice.r > largest_conceivable_r(self.graph.n) else settle_quickly(twice, self.limits)
        if settled is not None and settled.verdict is Verdict.ROBUST:
            return self.twice_robust(question) or self.refutation(question)
        return self.refutation(question)

    def promise_over_time(self, result: ToleranceResult) -> tuple[bytes | None, bool]:
        """Return a certificate that the sequence is jointly (2f+1)-robust, and False where it is not within tau."""
        from robustness.time_varying import certify_joint

        if result.sequence is None or self.limits.expired():
            return None, True
        r = 2 * result.guaranteed + 1
        found, certificate = certify_joint(result.sequence, r, **self.limits.keywords())
        most = result.longest_window
        is_late = most is not None and found.at_least > most
        if found.verdict is Verdict.NOT_ROBUST or is_late:
            return None, False
        return certificate if found.window is not None else None, True

    def robust(self, graph: Digraph, r: int, s: int = 1) -> bytes | None:
        """Return an ordinary certificate of (r,s)-robustness, or None when it is not robust or the time is up."""
        if self.limits.expired():
            return None
        found = certify(graph, r, s, **self.limits.keywords())
        return found.certificate if found.verdict is Verdict.ROBUST else None

    def twice_robust(self, question: Question) -> bytes | None:
        """Return a certificate of no solution because the graph is (2f+1)-robust."""
        twice = self.robust(self.graph, 2 * question.f + 1)
        return None if twice is None else _tolerance(self.graph, question, "together", {"kind": "robust"}, twice)

    def refutation(self, question: Question) -> bytes | None:
        """Return a certificate of no solution by the transcript of a search; None when a limit stopped it."""
        if self.limits.expired() or self.graph.n > _MOST_NODES:
            return None
        found = searching.decide(self.graph, question, self.limits, transcript=True)
        if found.exists:
            raise InternalError(f"a search finds {found.sets} where no attack was to exist: please report")
        if found.transcript is None:
            return None
        try:
            return _tolerance(self.graph, question, "together", {"kind": "refutation"}, found.transcript)
        except MalformedCertificate:  # more work than the kernel takes upon itself
            return None


def _refutation(result: ToleranceResult) -> bytes | None:
    graph, sets = result.graph, result.attack_sets
    if sets is None or sets.remembered:
        return None
    if result.threat.question(sets.f) == Question(sets.f, two_faces=False):
        pair = Pair(graph.ids(sets.S1), graph.ids(sets.S2))
        evidence = {"kind": "violation", "S1": sorted(pair.first), "S2": sorted(pair.second)}
        certificate = encode(graph, sets.f + 1, sets.f + 1, Verdict.NOT_ROBUST, (evidence, b""))
        verify(graph.canonical_bytes(), certificate)
        return certificate
    return _apart(graph, sets)


def _apart(graph: Digraph, sets: AttackSets) -> bytes:
    named = {name: sorted(graph.ids(labels)) for name, labels in (("M", sets.M), ("S1", sets.S1), ("S2", sets.S2))}
    question = Question(sets.f, sets.faces == 2, sets.local)
    return _tolerance(graph, question, "apart", {"kind": "sets", **named}, b"")


def _tolerance(graph: Digraph, question: Question, verdict: str, evidence: Mapping[str, object], body: bytes) -> bytes:
    """Return a tolerance certificate after the kernel has verified it."""
    f, faces, bound = question.f, 2 if question.two_faces else 1, "local" if question.local else "total"
    claim = {"f": f, "faces": faces, "bound": bound, "verdict": verdict}
    name = FORMAT_WITH_REFUTATIONS if evidence["kind"] == "refutation" else FORMAT
    header = {"format": name, "graph": graph.sha256, "claim": claim, "evidence": evidence}
    certificate = json.dumps(header, separators=(",", ":")).encode("ascii") + b"\n" + body
    proved = verify_tolerance(graph.canonical_bytes(), certificate)
    if (proved.verdict, proved.f, proved.faces, proved.bound) != (verdict, f, faces, bound):
        raise InternalError(f"the certificate proves {proved}, which was not the claim: please report")
    return certificate
