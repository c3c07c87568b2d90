"""JSON as the formats here use it: no duplicate keys, no NaN, no floats, integers of at most 20 characters."""

from __future__ import annotations

import json
from typing import Any, NoReturn

from certificates.errors import MalformedCertificate

__all__ = ["parse"]

_MOST_DIGITS = 20


class Opaque(str):
    """The text of a number with a fraction or an exponent: neither a number nor, by exact type, a ``str``."""

    __slots__ = ()


def parse(data: bytes, error: type[MalformedCertificate], what: str) -> Any:
    """Return the JSON value in ``data``; whatever is wrong with it is one ``error``.

    Nesting deeper than the recursion limit of the interpreter is an error of the text, and told as one. Floats are
    :class:`Opaque` text, so that they may stand only where nobody reads them (attributes in node-link documents).
    """

    def refuse(text: str) -> NoReturn:
        raise error(f"{what} holds the number {text[:24]!r}, which the format does not have")

    def integer(text: str) -> int:
        return int(text) if len(text) <= _MOST_DIGITS else refuse(text)

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) != len(pairs):
            raise error(f"{what} repeats a key")
        return found

    try:
        return json.loads(
            data.decode("utf-8"), object_pairs_hook=unique, parse_constant=refuse, parse_int=integer, parse_float=Opaque
        )
    except RecursionError:
        raise error(f"{what} is nested too deeply") from None
    except UnicodeDecodeError as problem:
        raise error(f"{what} is not UTF-8 text: byte {problem.start}") from None
    except json.JSONDecodeError as problem:
        raise error(f"{what} is not JSON: {problem.msg} at line {problem.lineno} column {problem.colno}") from None
