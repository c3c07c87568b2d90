"""The checker that is proved correct: an executable of its own, found on the PATH or where ``make formal`` puts it."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import certificates
from certificates import MalformedCertificate, RejectedCertificate, VerifiedClaim, VerifiedToleranceClaim
from certificates.tolerance import FORMATS as TOLERANCE_FORMATS
from certificates.verification import FORMAT
from robustness.errors import InternalError

__all__ = ["FORMATS", "NAME", "CheckerUnavailable", "find_checker", "verify_with"]

NAME = "robustness-verified"

#: The formats of certificates that it knows.
FORMATS = (FORMAT, *TOLERANCE_FORMATS)

_CLAIM = re.compile(
    r"verified: the graph with (?P<nodes>\d+) nodes, (?P<arcs>\d+) arcs and SHA-256 (?P<sha256>[0-9a-f]{64}) "
    r"(?:(?P<robust>is|is not) \((?P<r>\d+),(?P<s>\d+)\)-robust"
    r"|(?P<has>has a|has no) (?P<sets>trap|violation) for f = (?P<f>\d+) (?P<where>in total|locally)) "
    r"\(evidence: (?P<evidence>[a-z]+)\); "
)


class CheckerUnavailable(Exception):
    """There is no executable of that name, or it cannot be started."""


def find_checker() -> Path | None:
    """Return the executable: the one on the PATH, else the one that ``make formal`` built in this checkout."""
    if found := shutil.which(NAME):
        return Path(found)
    built = Path(certificates.__file__).parents[1] / "build" / "formal" / NAME
    return built if built.is_file() else None


def verify_with(checker: Path, graph_bytes: bytes, certificate_bytes: bytes) -> VerifiedClaim | VerifiedToleranceClaim:
    """Return the claim that ``checker`` answers with for these bytes.

    Raises
    ------
    MalformedCertificate, RejectedCertificate
        As the checker says, by its exit codes 3 and 10.
    CheckerUnavailable
        When it cannot be started.
    InternalError
        When it ends in any other way: it crashed, or it is another program. That is never a verdict.
    """
    with tempfile.TemporaryDirectory() as folder:
        graph, certificate = Path(folder, "graph"), Path(folder, "certificate")
        graph.write_bytes(graph_bytes)
        certificate.write_bytes(certificate_bytes)
        try:
            run = subprocess.run(  # noqa: S603  # The user names the executable, by its place or the PATH.
                [checker, "verify", graph, certificate], capture_output=True, text=True, check=False
            )
        except OSError as problem:
            raise CheckerUnavailable(f"{checker} cannot be started: {problem.strerror}") from None
    why = run.stderr.strip().partition(": ")[2]
    if run.returncode == 3:
        raise MalformedCertificate(f"{why} (says {checker})")
    if run.returncode == 10:
        raise RejectedCertificate(f"{why} (says {checker})")
    found = _CLAIM.match(run.stdout)
    if run.returncode != 0 or found is None:
        raise InternalError(
            f"{checker} ended with exit code {run.returncode} and no answer: {run.stderr.strip()[:200]}"
        )
    about = found["evidence"], found["sha256"], int(found["nodes"]), int(found["arcs"])
    if found["robust"]:
        return VerifiedClaim(
            "robust" if found["robust"] == "is" else "not-robust", int(found["r"]), int(found["s"]), *about
        )
    return VerifiedToleranceClaim(
        "apart" if found["has"] == "has a" else "together",
        int(found["f"]),
        2 if found["sets"] == "trap" else 1,
        "total" if found["where"] == "in total" else "local",
        *about,
    )
