"""Good bytes made bad: what a broken disk, a careless editor or an attacker makes of a file."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

__all__ = ["HOSTILE_WORDS", "mutated"]

#: Values that have broken readers, here or elsewhere.
HOSTILE_WORDS = (
    "-1", "0", "-0", "1.0", "1e999", "1e-999", "1_0", "NaN", "Infinity", "99999999999999999999", "3000000000", "0x10",
    "true", "null",
    "[]", "{}", '""', '"\\ud800"', "\x00", "\x1b[2J", "\u202e", "\u0663", "nan", "-", "--", "=", ",", ";",
    "1/0", "..", "*", "$x", "\r", "\n", "\t", " ", "\ufeff", "a" * 5000, "[" * 2000, "{" * 2000,
)  # fmt: skip

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
_TOKEN = re.compile(rb'"[^"]*"|-?\d+|\w+|[^\w\s]')


def mutated(data: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """Return ``data`` after one to four changes; ``others`` lend pieces of theirs."""
    for _ in range(draw.choice((1, 1, 1, 2, 2, 4))):
        data = draw.choice(_CHANGES)(data, others, draw)
    return data


def _flip(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    if not data:
        return b"\xff"
    place = draw.randrange(len(data))
    return data[:place] + bytes([draw.randrange(256)]) + data[place + 1 :]


def _cut(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


def _drop(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    begin, end = _stretch(data, draw)
    return data[:begin] + data[end:]


def _repeat(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    begin, end = _stretch(data, draw)
    return data[:end] + data[begin:end] * draw.choice((1, 1, 2, 50)) + data[end:]


def _graft(data: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    other = draw.choice(others)
    begin, end = _stretch(other, draw)
    place = draw.randrange(len(data) + 1)
    return data[:place] + other[begin:end] + data[place:]


def _number(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    return _replace_one(_NUMBER, data, draw)


def _token(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    return _replace_one(_TOKEN, data, draw)


def _replace_one(pattern: re.Pattern[bytes], data: bytes, draw: random.Random) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data + draw.choice(HOSTILE_WORDS).encode()
    one = draw.choice(found)
    return data[: one.start()] + draw.choice(HOSTILE_WORDS).encode() + data[one.end() :]


def _encoded(data: bytes, _: Sequence[bytes], draw: random.Random) -> bytes:
    return data.decode("utf-8", "replace").encode(draw.choice(("utf-16", "utf-32", "utf-8-sig")), "replace")


def _stretch(data: bytes, draw: random.Random) -> tuple[int, int]:
    begin = draw.randrange(len(data) + 1)
    return begin, min(len(data), begin + draw.choice((1, 2, 8, 64, 1000)))


_CHANGES = (_flip, _cut, _drop, _repeat, _graft, _number, _number, _token, _token, _encoded)
