"""What the text formats share: decoding with a place for the error, and messages that stay on one line."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable

from certificates.graph import Label
from robustness.digraph import GraphWarning
from robustness.errors import InvalidGraph, UnreadableTopology

__all__ = ["decode_utf8", "one_line", "texts_of", "warn_lossy"]

_LONGEST_MESSAGE = 300


def one_line(text: str) -> str:
    """Return ``text`` on one line, without control characters, cut to a readable length."""
    flat = "".join(c if c.isprintable() else " " for c in text)
    flat = " ".join(flat.split())
    return flat if len(flat) <= _LONGEST_MESSAGE else flat[: _LONGEST_MESSAGE - 1] + "…"


def decode_utf8(data: bytes) -> str:
    """Return ``data`` as text: UTF-8, or UTF-16 where a byte order mark says so, as spreadsheets write it."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise UnreadableTopology("the byte order mark says UTF-16, and the text is not") from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise UnreadableTopology(
            f"line {line}: byte {data[problem.start]:#04x} is not UTF-8 text: save the file as UTF-8"
        ) from None


def warn_lossy(message: str, hint: str = "") -> None:
    """Warn, at the line that called this package, of what was taken for granted or is lost."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals["__name__"].partition(".")[0] == "robustness":
        level, frame = level + 1, frame.f_back
    warnings.warn(f"{message}{hint}", GraphWarning, stacklevel=level)


def texts_of(labels: Iterable[Label], form: str, *, is_allowed: Callable[[str], bool] = lambda text: True) -> list[str]:
    """Return the labels as text, or raise when two of them become the same or one cannot be written."""
    seen: dict[str, Label] = {}
    for label in labels:
        text = str(label)
        if text in seen:
            raise InvalidGraph(f"{form} cannot tell node {seen[text]!r} from node {label!r}: write .json instead")
        if not is_allowed(text):
            raise InvalidGraph(f"{form} cannot hold the label {label!r}: write .json instead")
        seen[text] = label
    return list(seen)
