"""The exit codes, all of them, and which exception ends in which.

Python itself ends in 1 after a crash and click in 2 after bad usage, so no verdict has these codes.
"""

from __future__ import annotations

import enum

from .interruption import Overrun

__all__ = ["ExitCode"]


class ExitCode(enum.IntEnum):
    """What the process tells its caller."""

    #: Proven, valid, or done.
    DONE = 0
    #: A bug. Never a verdict.
    INTERNAL_ERROR = 1
    #: The command line is wrong, or an optional package or an output file that it asks for is not to be had.
    USAGE = 2
    #: The input is unreadable or invalid.
    BAD_INPUT = 3
    #: Refuted by a checked counterexample, or a certificate that proves nothing.
    REFUTED = 10
    #: A limit was reached; nothing is claimed.
    UNDECIDED = 30
    #: Ctrl-C; what was printed holds all the same.
    INTERRUPTED = 130

    @classmethod
    def of_verdict(cls, verdict: str) -> ExitCode:
        """Return the code of a verdict by its value in JSON; any other word is a bug, not a success."""
        return {
            "robust": cls.DONE,
            "determined": cls.DONE,
            "not-robust": cls.REFUTED,
            "undecided": cls.UNDECIDED,
        }[verdict]

    @classmethod
    def of_outcome(cls, outcome: str, expected: str | None) -> ExitCode:
        """Return the code of a simulation's outcome; one that is neither expected nor undecided refutes."""
        if outcome == "undecided":
            return cls.UNDECIDED
        return cls.REFUTED if expected not in (None, outcome) else cls.DONE

    @classmethod
    def of_exception(cls, problem: BaseException) -> ExitCode:
        """Return the code of an exception that reached the top. The only place that decides this."""
        from certificates.errors import MalformedCertificate, RejectedCertificate
        from robustness.errors import InvalidGraph, InvalidParameter, MissingExtra, Undecided, UnreadableTopology

        match problem:
            case KeyboardInterrupt():
                return cls.INTERRUPTED
            case Undecided() | Overrun() | MemoryError():
                return cls.UNDECIDED
            case RejectedCertificate():
                return cls.REFUTED
            case InvalidGraph() | UnreadableTopology() | MalformedCertificate():
                return cls.BAD_INPUT
            case InvalidParameter() | MissingExtra():
                return cls.USAGE
            case RuntimeError() if str(problem) == "can't start new thread":  # more --jobs than the system allows
                return cls.USAGE
            case OSError() if problem.filename is not None:  # inputs are read by the library, so this is an output
                return cls.USAGE
            case _:
                return cls.INTERNAL_ERROR
