"""What is asked of a certificate, and whether the claim that it proves answers that.

A claim answers a question when it says just that or implies it, by these rules alone:

* (r,s)-robust implies (r',s')-robust for ``r' <= r`` and ``s' <= s + r - r'`` (Lemma 1 (i) and (ii)); hence *not*
  (r,s)-robust implies *not* (r',s')-robust for ``r <= r'`` and ``s <= s' + r' - r``;
* keeping together against f implies it against every smaller f; splitting apart by f, by every greater f.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

from certificates.errors import MalformedCertificate
from certificates.joint import FORMAT as JOINT_FORMAT
from certificates.joint import VerifiedJointClaim, verify_joint
from certificates.mending import FORMAT as MENDING_FORMAT
from certificates.mending import VerifiedMendingClaim, verify_mending
from certificates.stream import Blocks, Stream
from certificates.strict_json import parse
from certificates.tolerance import FORMATS as TOLERANCE_FORMATS
from certificates.tolerance import VerifiedToleranceClaim, verify_tolerance
from certificates.verification import FORMAT, VerifiedClaim, verify

__all__ = ["Claim", "Question", "comparison", "format_of", "verify_any"]

Claim = VerifiedClaim | VerifiedJointClaim | VerifiedToleranceClaim | VerifiedMendingClaim

_VERIFIERS: dict[str, Callable[[bytes, Stream], Claim]] = {
    FORMAT: verify,
    JOINT_FORMAT: verify_joint,
    **dict.fromkeys(TOLERANCE_FORMATS, verify_tolerance),
    MENDING_FORMAT: verify_mending,
}


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked; None asks nothing.

    Attributes
    ----------
    verdict : str or None
        ``robust``, ``not-robust``; ``together``, ``apart`` for what f malicious nodes can do.
    r, s, window : int or None
        Of robustness, and of joint robustness.
    f, faces : int or None
    bound : str or None
        ``total`` or ``local``. A question about f names faces and bound as well: one face or two, and malicious nodes
        in all or around each node, are different threats.
    """

    verdict: str | None = None
    r: int | None = None
    s: int | None = None
    window: int | None = None
    f: int | None = None
    faces: int | None = None
    bound: str | None = None

    def asked(self) -> dict[str, object]:
        """Return what is asked, by name."""
        given = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: value for name, value in given.items() if value is not None}

    def gap(self) -> str:
        """Return what a question about malicious nodes leaves open, or nothing."""
        about = self.f is not None or self.faces is not None or self.bound is not None
        about = about or self.verdict in ("together", "apart")
        missing = [name for name in ("verdict", "f", "faces", "bound") if getattr(self, name) is None]
        return f"a question about malicious nodes names {', '.join(missing)} as well" if about and missing else ""


def format_of(certificate: bytes | Stream) -> str:
    """Return the format that the first line of a certificate names; of a stream nothing is taken.

    Raises
    ------
    MalformedCertificate
        When there is no such line, or no such format.
    """
    document = parse(Stream.of(certificate).line(take=False), MalformedCertificate, "the certificate")
    found = document.get("format") if isinstance(document, dict) else None
    if type(found) is not str or found not in _VERIFIERS:
        raise MalformedCertificate(f"the format of a certificate is one of {', '.join(_VERIFIERS)}")
    return found


def verify_any(
    subject_bytes: bytes, certificate_bytes: Blocks | Stream, may_go_on: Callable[[int], bool] | None = None
) -> Claim:
    """Verify a certificate of whichever kind, and return its claim.

    ``subject_bytes`` is the canonical graph, or the canonical sequence for joint robustness; ``may_go_on``
    is for certificates of mending alone, as :func:`verify_mending` takes it.
    """
    stream = Stream.of(certificate_bytes)
    if format_of(stream) == MENDING_FORMAT:
        return verify_mending(subject_bytes, stream, may_go_on)
    return _VERIFIERS[format_of(stream)](subject_bytes, stream)


def comparison(claim: Claim, question: Question) -> tuple[bool, str]:
    """Return whether the claim answers the question, and in words how it does or what differs."""
    asked = question.asked()
    if not asked:
        return True, "compared with no question: state one to have the claim compared with it"
    foreign = [name for name in asked if not hasattr(claim, name)]
    if foreign or isinstance(claim, VerifiedMendingClaim):  # which has no part that a question names
        return False, f"the certificate says nothing about {', '.join(foreign)}"
    wrong = [f"{name} {value}" for name, value in asked.items() if value != getattr(claim, name)]
    if not wrong:
        return True, "the claim is the one asked for"
    if _implies(claim, question):
        return True, f"the claim implies the one asked for ({', '.join(wrong)})"
    return False, f"the claim proved is not the one asked for ({', '.join(wrong)})"


def _implies(claim: VerifiedClaim | VerifiedJointClaim | VerifiedToleranceClaim, question: Question) -> bool:
    """Return whether a claim whose other parts are as asked implies what is asked of r and s, or of f."""
    if isinstance(claim, VerifiedToleranceClaim):
        if (question.verdict, question.faces, question.bound) != (claim.verdict, claim.faces, claim.bound):
            return False
        f = claim.f if question.f is None else question.f
        return f <= claim.f if claim.verdict == "together" else f >= claim.f
    if question.verdict != claim.verdict or question.r is None:
        return False
    if isinstance(claim, VerifiedJointClaim) and question.window not in (None, claim.window):
        return False
    r, s = question.r, 1 if question.s is None else question.s
    if r < 0 or s < 1:
        return False
    if claim.verdict == "robust":
        return r <= claim.r and s <= claim.s + claim.r - r
    return claim.r <= r and claim.s <= s + r - claim.r
