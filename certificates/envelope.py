"""What certificates of every kind have in common: one line of JSON, a body, and parts of the forms read here."""

from __future__ import annotations

from collections.abc import Collection
from itertools import pairwise
from typing import Any

from certificates.errors import MalformedCertificate, Misuse, RejectedCertificate
from certificates.stream import Blocks, Stream
from certificates.strict_json import parse

__all__ = [
    "id_list",
    "id_set",
    "kind_of",
    "open_certificate",
    "require_about",
    "require_keys",
    "require_no_body",
    "shown",
]

_KEYS = "claim evidence"


def open_certificate(
    subject_bytes: bytes, certificate: Blocks | Stream, subject: str, formats: Collection[str], keys: str = _KEYS
) -> tuple[dict[str, Any], Stream]:
    """Return the header and, to be read, the body of a certificate of one of these formats about a graph or a sequence.

    The header has exactly these keys beside ``format`` and ``subject``. The digest of the subject, which the header
    names under the key ``subject``, is compared by :func:`require_about`.

    Raises
    ------
    Misuse
        When an argument is not bytes; the certificate may also be an iterable of bytes.
    MalformedCertificate
        When it is not a certificate of the formats.
    """
    if not isinstance(subject_bytes, bytes):
        raise Misuse(f"a verifier takes two bytes objects: the {subject} and the certificate")
    body = Stream.of(certificate)
    document = parse(body.line(), MalformedCertificate, "the certificate")
    document = require_keys(document, "the certificate", f"format {subject} {keys}")
    found = document["format"]
    if type(found) is not str or found not in formats:
        raise MalformedCertificate(f"the format is {' or '.join(map(repr, formats))}, not {shown(found)}")
    return document, body


def require_about(document: dict[str, Any], subject: str, sha256: str) -> None:
    """Refuse a certificate about another graph or sequence than the one with this digest."""
    if document[subject] != sha256:
        raise RejectedCertificate(
            f"the certificate is about another {subject}: this one has SHA-256 {sha256}", "other-subject"
        )


def require_keys(value: Any, what: str, keys: str) -> dict[str, Any]:
    """Return ``value`` when it is an object with exactly these keys."""
    if not isinstance(value, dict) or set(value) != set(keys.split()):
        raise MalformedCertificate(f"{what} is an object with exactly the keys {keys}")
    return value


def require_no_body(body: Stream, what: str) -> None:
    """Refuse bytes after a header that says all."""
    if not body.is_over():
        raise MalformedCertificate(f"{body.left()} bytes follow the header, but {what} has no body")


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
