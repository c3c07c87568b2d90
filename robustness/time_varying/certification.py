"""Certificates of joint robustness: one ordinary certificate for every distinct window union, or for one that fails.

``certificates.verify_joint`` verifies them without any of this package; whatever is returned here has passed it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from certificates import verify_joint
from certificates.graph import digest
from certificates.joint import FORMAT, MAX_VALUE, encode_sequence
from robustness.answers import Question
from robustness.decision.certification import certify_within, encode
from robustness.digraph import GraphLike
from robustness.errors import InternalError, InvalidParameter
from robustness.limits import Limits, Progress
from robustness.results import Verdict
from robustness.spelled import counted, robust
from robustness.time_varying.front import check_joint_robustness
from robustness.time_varying.results import JointResult
from robustness.time_varying.sequence import TimeVaryingGraph, as_time_varying
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["canonical_sequence", "certify_joint", "joint_certificate"]


@taking_numpy_integers
def certify_joint(
    sequence: TimeVaryingGraph | Sequence[GraphLike],
    r: int,
    s: int = 1,
    *,
    window: int | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> tuple[JointResult, bytes | None]:
    """Decide joint (r,s)-robustness and return the result with a verified certificate of it.

    Parameters
    ----------
    sequence, s, window, jobs, seed, progress
        As for :func:`~robustness.time_varying.check_joint_robustness`.
    r : int
        At least 1: that every graph is (0,s)-robust needs no proof.
    time_limit : float, optional
        Wall-clock seconds for deciding and certifying together.

    Returns
    -------
    tuple of JointResult and bytes or None
        The bytes prove the verdict for windows of ``result.window`` steps (ROBUST), of ``window`` or, without it, of
        ``result.violation.length`` steps (NOT_ROBUST). That no shorter window would do is not part of the claim. None
        when the verdict is UNDECIDED, or the time was up before every union had its certificate. Pass
        :func:`canonical_sequence` and the bytes to the verifier.

    Raises
    ------
    InvalidGraph, InvalidParameter
        As for the decision; also for r = 0, and where a convention decides and no pair exists: on fewer than two nodes.

    See Also
    --------
    robustness.check_joint_robustness : the answer alone
    robustness.certify : one network

    Notes
    -----
    Unlike deciding, certifying searches every distinct union for itself.

    >>> from certificates import verify_joint
    >>> links = TimeVaryingGraph.from_arcs(range(3), [[(0, 1)], [(1, 2)], [(2, 0)]], period=3, directed=False)
    >>> result, certificate = certify_joint(links, 1)
    >>> claim = verify_joint(canonical_sequence(links), certificate)
    >>> claim.verdict, claim.window, claim.certificates
    ('robust', 2, 3)
    """
    sequence = as_time_varying(sequence)
    limits = Limits.of(time_limit, jobs, seed, progress)
    result = check_joint_robustness(sequence, r, s, window=window, **limits.keywords())
    return result, joint_certificate(sequence, result, **limits.keywords())


def joint_certificate(
    sequence: TimeVaryingGraph,
    result: JointResult,
    *,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> bytes | None:
    """Return a verified certificate of a result of this very sequence; None when it is UNDECIDED or time is up.

    The parameters and errors are those of :func:`certify_joint`.
    """
    limits = Limits.of(time_limit, jobs, seed, progress)
    if result.verdict is Verdict.UNDECIDED:
        return None
    if result.r == 0:
        raise InvalidParameter("every sequence is jointly (0,s)-robust by convention: nothing to certify")
    if max(result.r, result.examined) > MAX_VALUE:
        raise InvalidParameter(f"a certificate speaks of r and windows up to {MAX_VALUE}: ask about a smaller one")
    if result.verdict is Verdict.NOT_ROBUST:
        length, evidence, body = _refutation(sequence, result)
    else:
        length, parts = result.examined, []
        for union in result.unions:
            if limits.expired():
                return None
            part = certify_within(Question(union, result.r, result.s), limits)
            if part.certificate is None:
                return None
            parts.append(part.certificate)
        lengths = [len(part) for part in parts]
        evidence, body = {"kind": "windows", "unions": result.window_unions, "lengths": lengths}, b"".join(parts)
    canonical = canonical_sequence(sequence)
    verdict = result.verdict.value
    claim = {"property": "jointly-rs-robust", "r": result.r, "s": result.s, "window": length, "verdict": verdict}
    header = {"format": FORMAT, "sequence": digest(canonical), "claim": claim, "evidence": evidence}
    certificate = json.dumps(header, separators=(",", ":")).encode("ascii") + b"\n" + body
    proven = verify_joint(canonical, certificate)
    if (proven.verdict, proven.r, proven.s, proven.window) != (verdict, result.r, result.s, length):
        raise InternalError(f"the certificate proves {proven}, not the verdict {result.summary()}: please report")
    return certificate


def canonical_sequence(sequence: TimeVaryingGraph) -> bytes:
    """Return the bytes that a joint certificate is bound to (docs/certificate-format.md)."""
    heads, tails = np.divmod(sequence.arc_codes, max(sequence.n, 1))
    steps = (sorted(zip(tails[arcs].tolist(), heads[arcs].tolist(), strict=True)) for arcs in sequence.step_arcs)
    return encode_sequence(sequence.labels, steps, sequence.period)


def _refutation(sequence: TimeVaryingGraph, result: JointResult) -> tuple[int, dict[str, Any], bytes]:
    """Return window length, evidence and body for a sequence that is not jointly robust."""
    found = result.violation
    if found is None:
        return result.examined, {"kind": "no-window"}, b""
    if found.witness is None:
        raise InvalidParameter(
            f"{robust(result.r, result.s)} on {counted(sequence.n, 'node')} is settled by convention: "
            "nothing to certify"
        )
    union = sequence.union(found.start, found.length)
    sets = {"S1": sorted(union.ids(found.witness.S1)), "S2": sorted(union.ids(found.witness.S2))}
    body = encode(union, result.r, result.s, result.verdict, ({"kind": "violation", **sets}, b""))
    return found.length, {"kind": "violation", "start": found.start}, body
