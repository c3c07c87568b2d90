"""What certificates of every kind have in common: one line of JSON, a body, and parts of the forms read here."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from certificates.errors import MalformedCertificate

__all__ = [
    "MAX_CERTIFICATE_BYTES",
    "MAX_HEADER_BYTES",
    "id_list",
    "id_set",
    "kind_of",
    "require_keys",
    "shown",
    "split_header",
]

#: Bytes of a certificate, and of its first line, that are read at most.
MAX_CERTIFICATE_BYTES = 2**30
MAX_HEADER_BYTES = 2**26


def split_header(data: bytes) -> tuple[bytes, bytes]:
    """Return header and body: the first line, and all that follows it."""
    end = data.find(b"\n", 0, MAX_HEADER_BYTES)
    if end < 0:
        raise MalformedCertificate("a certificate begins with one line of JSON that ends with a newline")
    return data[:end], data[end + 1 :]


def require_keys(value: Any, what: str, keys: str) -> dict[str, Any]:
    """Return ``value`` when it is an object with exactly these keys."""
    if not isinstance(value, dict) or set(value) != set(keys.split()):
        raise MalformedCertificate(f"{what} is an object with exactly the keys {keys}")
    return value


def kind_of(evidence: Any) -> str:
    """Return the kind that evidence names."""
    kind = evidence.get("kind") if isinstance(evidence, dict) else None
    if type(kind) is not str:
        raise MalformedCertificate("the evidence is an object with a 'kind'")
    return kind


def shown(value: object) -> str:
    """Return a short text for ``value`` that never walks into nested input."""
    return repr(value[:40]) if isinstance(value, str) else f"a value of type {type(value).__name__}"


def id_set(value: Any, n: int, what: str) -> list[int]:
    """Return a strictly ascending list of ids."""
    ids = id_list(value, n, what)
    if any(not a < b for a, b in pairwise(ids)):
        raise MalformedCertificate(f"{what} is strictly ascending")
    return ids


def id_list(value: Any, n: int, what: str) -> list[int]:
    """Return a list of ids."""
    if not isinstance(value, list) or not all(type(i) is int and 0 <= i < n for i in value):
        raise MalformedCertificate(f"{what} is a list of ids in 0..{n - 1}")
    return value
