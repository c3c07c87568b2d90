"""``python -m certificates verify GRAPH CERTIFICATE``: the kernel on a bare Python.

``verify-joint SEQUENCE CERTIFICATE`` does the same for joint robustness of a sequence of graphs, and
``verify-tolerance GRAPH CERTIFICATE`` for what f malicious nodes can do.
Exit codes: 0 the certificate proves its claim (and the claim answers the question asked); 10 it does not; 3 a file is
unreadable or malformed; 2 usage.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import MAX_GRAPH_BYTES
from certificates.joint import MAX_SEQUENCE_BYTES, VerifiedJointClaim, verify_joint
from certificates.tolerance import VerifiedToleranceClaim, verify_tolerance
from certificates.verification import MAX_CERTIFICATE_BYTES, VerifiedClaim, verify

__all__ = ["main", "read_at_most"]


def main(arguments: list[str] | None = None) -> int:
    """Verify one certificate, print the claim proved, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m certificates", description="Verify a robustness certificate.")
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("verify", help="verify CERTIFICATE for GRAPH")
    one.add_argument("graph", type=Path, help="canonical graph, or node-link JSON")
    joint = commands.add_parser("verify-joint", help="verify the joint CERTIFICATE for SEQUENCE")
    joint.add_argument("sequence", type=Path, help="canonical sequence")
    tolerance = commands.add_parser("verify-tolerance", help="verify the tolerance CERTIFICATE for GRAPH")
    tolerance.add_argument("graph", type=Path, help="canonical graph, or node-link JSON")
    tolerance.add_argument("certificate", type=Path)
    tolerance.add_argument("--expect", choices=["apart", "together"], help="the verdict that must be proven")
    tolerance.add_argument("-f", type=int, help="the f that the claim must be about")
    for each in (one, joint):
        each.add_argument("certificate", type=Path)
        each.add_argument("--expect", choices=["robust", "not-robust"], help="the verdict that must be proven")
        each.add_argument("-r", type=int, help="the r that the claim must be about")
        each.add_argument("-s", type=int, help="the s that the claim must be about")
    joint.add_argument("--window", type=int, help="the number of steps that the claim must be about")
    question = parser.parse_args(arguments)
    try:
        claim = _verify(question)
    except OSError as problem:
        return _fail(3, f"error: cannot read {problem.filename}: {problem.strerror}")
    except MalformedCertificate as problem:
        return _fail(3, f"malformed: {problem}")
    except RejectedCertificate as problem:
        return _fail(10, f"rejected: {problem}")
    sys.stdout.write(f"verified: {claim}\n")
    asked = {"verdict": question.expect}
    asked |= {name: value for name, value in vars(question).items() if name in ("r", "s", "window", "f")}
    wrong = [f"{name} {value}" for name, value in asked.items() if value not in (None, getattr(claim, name))]
    if wrong:
        return _fail(10, f"rejected: the claim proved is not the one asked for ({', '.join(wrong)})")
    return 0


def _verify(question: argparse.Namespace) -> VerifiedClaim | VerifiedJointClaim | VerifiedToleranceClaim:
    """Return the claim that the files prove, read in the order of the command line."""
    if question.command == "verify-joint":
        sequence = read_at_most(question.sequence, MAX_SEQUENCE_BYTES)
        return verify_joint(sequence, read_at_most(question.certificate, MAX_CERTIFICATE_BYTES))
    if question.command == "verify-tolerance":
        graph = read_at_most(question.graph, MAX_GRAPH_BYTES)
        return verify_tolerance(graph, read_at_most(question.certificate, MAX_CERTIFICATE_BYTES))
    return verify(
        read_at_most(question.graph, MAX_GRAPH_BYTES), read_at_most(question.certificate, MAX_CERTIFICATE_BYTES)
    )


def _fail(code: int, message: str) -> int:
    sys.stderr.write(f"{message}\n")
    return code


def read_at_most(path: Path, limit: int) -> bytes:
    """Return the file's bytes, or somewhat more than ``limit`` of them: enough for the verifier to refuse it."""
    data = bytearray()
    with path.open("rb") as file:
        while len(data) <= limit and (block := file.read(2**20)):
            data += block
    return bytes(data)


if __name__ == "__main__":
    sys.exit(main())
