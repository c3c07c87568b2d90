"""``python -m certificates verify GRAPH CERTIFICATE``: the kernel on a bare Python.

It takes certificates of every kind; ``verify-joint SEQUENCE CERTIFICATE`` takes those of joint robustness alone, and
``verify-tolerance GRAPH CERTIFICATE`` those of what f malicious nodes can do. Start it as ``python -I -m
certificates``: isolated, Python does not look into the current folder, where a file named ``json.py`` could stand in
for the library.
Exit codes: 0 the certificate proves its claim (and the claim answers the question asked); 10 it does not; 3 a file is
unreadable or malformed; 2 usage.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields
from pathlib import Path

from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.file_bytes import certificate_blocks, read_at_most
from certificates.graph import MAX_GRAPH_BYTES
from certificates.joint import MAX_SEQUENCE_BYTES, verify_joint
from certificates.least_cost import DEFAULT_CHOICES
from certificates.questions import Claim, Question, comparison, verify_any
from certificates.tolerance import verify_tolerance

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> int:
    """Verify one certificate, compare its claim with the question, print it, and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m certificates", description="Verify a robustness certificate.")
    commands = parser.add_subparsers(dest="command", required=True)
    whole = commands.add_parser("verify", help="verify CERTIFICATE, of any kind, for GRAPH (a sequence if it is joint)")
    whole.add_argument("subject", metavar="graph", type=Path, help="canonical graph or sequence, or node-link JSON")
    joint = commands.add_parser("verify-joint", help="verify the joint CERTIFICATE for SEQUENCE")
    joint.add_argument("subject", metavar="sequence", type=Path, help="canonical sequence")
    tolerance = commands.add_parser("verify-tolerance", help="verify the tolerance CERTIFICATE for GRAPH")
    tolerance.add_argument("subject", metavar="graph", type=Path, help="canonical graph, or node-link JSON")
    for each in (whole, joint, tolerance):
        each.add_argument("certificate", type=Path)
        verdicts = [] if each is tolerance else ["robust", "not-robust"]
        verdicts += [] if each is joint else ["apart", "together"]
        each.add_argument("--expect", dest="verdict", choices=verdicts, help="the verdict that must be proven")
        if each is not tolerance:
            each.add_argument("-r", type=int, help="the r that the claim must be about")
            each.add_argument("-s", type=int, help="the s that the claim must be about")
            each.add_argument("--window", type=int, help="the number of steps that the claim must be about")
        if each is whole:
            least = f"of mending: nodes of the tree that proves the least cost (default {DEFAULT_CHOICES})"
            each.add_argument("--choices", type=int, default=DEFAULT_CHOICES, metavar="N", help=least)
        if each is not joint:
            each.add_argument("-f", type=int, help="the f that the claim must be about")
            each.add_argument("--faces", type=int, choices=[1, 2], help="how many faces a malicious node has")
            each.add_argument("--bound", choices=["total", "local"], help="f malicious nodes in all or around each")
    asked = vars(parser.parse_args(arguments))
    question = Question(**{each.name: asked.get(each.name) for each in fields(Question)})
    if question.gap():
        parser.error(question.gap())
    try:
        claim = _verify(asked["command"], asked["subject"], asked["certificate"], asked.get("choices", 0))
    except OSError as problem:
        return _fail(3, f"error: cannot read {problem.filename}: {problem.strerror}")
    except MemoryError:
        return _fail(3, "malformed: the files do not fit into memory")
    except MalformedCertificate as problem:
        return _fail(3, f"malformed: {problem}")
    except RejectedCertificate as problem:
        return _fail(10, f"rejected: {problem}")
    answers, how = comparison(claim, question)
    if not answers:
        return _fail(10, f"rejected: {how}; proved is that {claim}")
    sys.stdout.write(f"verified: {claim}; {how}\n")
    return 0


def _verify(command: str, subject: Path, certificate: Path, choices: int) -> Claim:
    """Return the claim that the files prove, read in the order of the command line."""
    first = read_at_most(subject, max(MAX_GRAPH_BYTES, MAX_SEQUENCE_BYTES))
    second = certificate_blocks(certificate, _progress if sys.stderr is not None and sys.stderr.isatty() else None)
    match command:
        case "verify-joint":
            return verify_joint(first, second)
        case "verify-tolerance":
            return verify_tolerance(first, second)
        case _:
            return verify_any(first, second, lambda looked: looked < choices)


def _progress(done: int, size: int) -> None:
    """Show on a terminal how much of a certificate has been read; what is printed next writes over it."""
    sys.stderr.write(f"\r{100 * done // size if size else 0} % of the certificate read\r")


def _fail(code: int, message: str) -> int:
    sys.stderr.write(f"{message}\n")
    return code


if __name__ == "__main__":
    sys.exit(main())
