"""What every command promises about how it ends."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from click.testing import CliRunner, Result

from cli.main import robustness
from tests.fuzzing.cases import Case

__all__ = ["ALLOWED", "broken_promise"]

#: Done, usage, bad input, refuted, undecided. 1 is a bug, and nobody presses Ctrl-C here.
ALLOWED = frozenset({0, 2, 3, 10, 30})

#: Seconds of processor time that any case may take; each is about a few nodes, or has --timeout 1.
_LONG = 20


def broken_promise(case: Case, allowed: frozenset[int] = ALLOWED) -> str:
    """Run the case in a folder of its own; return which promise it breaks, in a line, or nothing."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, data in case.files.items():
            Path(name).write_bytes(data)
        began = time.process_time()
        try:
            with _alarm():
                outcome = CliRunner().invoke(robustness, list(case.arguments), input=b"")
        except _TooLongError:
            return f"{case.arguments[0]} took more than {_LONG} s"
        if time.process_time() - began > _LONG:
            return f"{case.arguments[0]} took more than {_LONG} s"
        return _judged(outcome, allowed, is_verbose=bool({"-v", "--verbose"} & set(case.arguments)))


def _judged(outcome: Result, allowed: frozenset[int], *, is_verbose: bool) -> str:
    said = re.sub(r"\x1b\[\d{1,2}m", "", outcome.output)  # colours, which --color always asks for
    if outcome.exception is not None and not isinstance(outcome.exception, SystemExit):
        return f"{type(outcome.exception).__name__}: {str(outcome.exception)[:150]}"
    if outcome.exit_code not in allowed:
        return f"exit code {outcome.exit_code}: {re.sub('[0-9]+', '#', outcome.stderr[-150:].strip())}"
    if "Traceback" in said and not is_verbose:
        return "a traceback"
    if not all(letter.isprintable() or letter == "\n" for letter in said):
        return "a sequence that steers the terminal"
    return ""


class _TooLongError(BaseException):
    """Raised by the alarm; no ``except Exception`` stops it."""


@contextlib.contextmanager
def _alarm() -> Iterator[None]:
    def ring(_: int, __: FrameType | None) -> None:
        raise _TooLongError

    if os.name != "posix":
        yield
        return
    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(6 * _LONG)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
