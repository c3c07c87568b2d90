"""The trusted kernel: checks robustness certificates with the standard library alone.

>>> from certificates import verify  # verify(graph_bytes, certificate_bytes) -> VerifiedClaim
>>> from certificates import verify_joint  # verify_joint(sequence_bytes, certificate_bytes) -> VerifiedJointClaim
>>> from certificates import verify_tolerance  # (graph_bytes, certificate_bytes) -> VerifiedToleranceClaim
>>> from certificates import verify_mending  # (bytes of the graph before, certificate_bytes) -> VerifiedMendingClaim
"""

from certificates.errors import (
    CertificateError,
    MalformedCertificate,
    MalformedGraph,
    Misuse,
    RejectedCertificate,
)
from certificates.joint import VerifiedJointClaim, verify_joint
from certificates.mending import VerifiedMendingClaim, verify_mending
from certificates.questions import Question, comparison, verify_any
from certificates.tolerance import VerifiedToleranceClaim, verify_tolerance
from certificates.verification import VerifiedClaim, verify

__all__ = [
    "CertificateError",
    "MalformedCertificate",
    "MalformedGraph",
    "Misuse",
    "Question",
    "RejectedCertificate",
    "VerifiedClaim",
    "VerifiedJointClaim",
    "VerifiedMendingClaim",
    "VerifiedToleranceClaim",
    "comparison",
    "verify",
    "verify_any",
    "verify_joint",
    "verify_mending",
    "verify_tolerance",
]
