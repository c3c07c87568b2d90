"""Joint robustness: a certificate for the union of every window of a sequence of graphs, or for one that fails.

A sequence is a *finite trace*, whose windows do not wrap, or *eventually periodic*: its last ``period`` steps repeat
for ever. The kernel forms the unions from the sequence itself and hands each to :func:`certificates.verify`, with
the ordinary certificate that is named for it. docs/certificate-format.md has the format.
"""

from __future__ import annotations

import hashlib
import json
import secrets
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

from certificates.envelope import kind_of, open_certificate, require_about, require_keys, shown
from certificates.errors import MalformedCertificate, MalformedGraph, RejectedCertificate
from certificates.graph import Label, encode_graph, label_key, valid_labels
from certificates.stream import Blocks, Stream
from certificates.strict_json import parse
from certificates.verification import VerifiedClaim, verify

__all__ = [
    "FORMAT",
    "MAX_SEQUENCE_BYTES",
    "MAX_STEPS",
    "MAX_UNION_SIZE",
    "MAX_VALUE",
    "SEQUENCE_FORMAT",
    "VerifiedJointClaim",
    "encode_sequence",
    "verify_joint",
]

SEQUENCE_FORMAT = "robustness/sequence/1"
FORMAT = "robustness/joint-certificate/1"

#: Bytes and stored steps of a sequence that are read at most; a certificate is limited like an ordinary one.
MAX_SEQUENCE_BYTES = 2**28
MAX_STEPS = 2**20

#: Nodes and arcs of all unions together that are handed to the ordinary kernel at most.
MAX_UNION_SIZE = 2**26

#: Unions are compared by sums, bit by bit modulo 2, of secret numbers of so many bits, one for each arc. Nobody who
#: wrote a certificate knew them, so two different unions are taken for the same with a probability of 2**-256.
_SECRET_BITS = 256

#: The greatest r and the longest window that a claim may have.
MAX_VALUE = 2**31

_Arc = tuple[int, int]


@dataclass(frozen=True, slots=True)
class VerifiedJointClaim:
    """What was proven about which sequence, and by which kind of evidence."""

    verdict: str
    r: int
    s: int
    #: The number l of consecutive steps.
    window: int
    evidence: str
    sha256: str
    nodes: int
    steps: int
    period: int | None
    #: The start of the window that fails; None unless the evidence is one.
    start: int | None
    #: Ordinary certificates that were verified.
    certificates: int
    #: Nodes of search trees that were replayed in them.
    tree_nodes: int

    def __str__(self) -> str:
        word = "is" if self.verdict == "robust" else "is not"
        kind = "a finite trace" if self.period is None else f"the last {self.period} for ever"
        place = "" if self.start is None else f" from step {self.start}"
        return (
            f"the sequence with {self.nodes} nodes, {self.steps} steps ({kind}) and SHA-256 {self.sha256} {word} "
            f"jointly ({self.r},{self.s})-robust over every {self.window} consecutive steps "
            f"(evidence: {self.evidence}{place})"
        )


def encode_sequence(labels: Sequence[Label], steps: Iterable[Iterable[_Arc]], period: int | None) -> bytes:
    """Return the canonical bytes of a sequence: labels in canonical order, for every step its sorted arcs of ids."""
    rows = [[[u, v] for u, v in step] for step in steps]
    document = {"format": SEQUENCE_FORMAT, "labels": labels, "period": period, "steps": rows}
    return json.dumps(document, ensure_ascii=True, separators=(",", ":"), sort_keys=True).encode("ascii")


def verify_joint(sequence_bytes: bytes, certificate_bytes: Blocks | Stream) -> VerifiedJointClaim:
    """Return the claim that ``certificate_bytes`` proves about the sequence in ``sequence_bytes``.

    Parameters
    ----------
    sequence_bytes : bytes
        The canonical sequence.
    certificate_bytes : bytes or iterable of bytes
        A joint certificate as docs/certificate-format.md defines it.

    Raises
    ------
    Misuse
        When an argument is not bytes.
    MalformedCertificate
        When the bytes are not of the formats (``MalformedGraph`` for the sequence).
    RejectedCertificate
        When the certificate does not prove its claim about this sequence.
    """
    document, stream = open_certificate(sequence_bytes, certificate_bytes, "sequence", [FORMAT])
    body = stream.rest()
    claim = require_keys(document["claim"], "the claim", "property r s window verdict")
    sequence = _decode_sequence(sequence_bytes)
    require_about(document, "sequence", sequence.sha256)
    check = _Check(sequence, *_claim_numbers(claim, len(sequence.labels)))
    evidence, verdict, start = document["evidence"], claim["verdict"], None
    kind = kind_of(evidence)
    match verdict, kind:
        case "robust", "windows":
            proven = check.windows(require_keys(evidence, "the evidence", "kind unions lengths"), body)
        case "not-robust", "violation":
            start = require_keys(evidence, "the evidence", "kind start")["start"]
            proven = check.violation(start, body)
        case "not-robust", "no-window":
            require_keys(evidence, "the evidence", "kind")
            proven = check.no_window(body)
        case "robust" | "not-robust", _:
            raise MalformedCertificate(f"there is no evidence of kind {shown(kind)} for the verdict {verdict!r}")
        case _:
            raise MalformedCertificate(f"a verdict is 'robust' or 'not-robust', not {shown(verdict)}")
    return VerifiedJointClaim(
        verdict,
        check.r,
        check.s,
        check.length,
        kind,
        sequence.sha256,
        len(sequence.labels),
        len(sequence.steps),
        sequence.period,
        start,
        len(proven),
        sum(each.tree_nodes for each in proven),
    )


@dataclass(frozen=True, slots=True)
class _Sequence:
    """A decoded sequence: the arcs of every stored step, and the digest of the canonical bytes."""

    labels: tuple[Label, ...]
    steps: tuple[tuple[_Arc, ...], ...]
    period: int | None
    sha256: str

    def step(self, k: int) -> tuple[_Arc, ...]:
        """Return the arcs of G[k], which a trace has only for the stored k."""
        if k < len(self.steps) or self.period is None:
            return self.steps[k]
        prefix = len(self.steps) - self.period
        return self.steps[prefix + (k - prefix) % self.period]

    def starts(self, length: int) -> range:
        """Return the starts of the windows: all that fit in a trace; else those in the stored steps.

        The window at a k of at least prefix + period equals the one at k - period.
        """
        stored = len(self.steps)
        return range(max(0, stored - length + 1)) if self.period is None else range(stored)

    def unions(self, length: int, starts: range) -> Iterator[_Union]:
        """Yield the union of each window, which is one object that moves on; ``starts`` are consecutive.

        In a sequence with a period a window of as many steps as are stored contains a whole period, from every start.
        A longer one has no other arcs, so it is never walked through.
        """
        length = min(length, len(self.steps))
        union = _Union(self.labels)
        for k in range(starts.start, starts.start + length):
            union.add(self.step(k))
        for start in starts:
            yield union
            if start + 1 in starts:
                union.add(self.step(start + length))
                union.drop(self.step(start))


class _Union:
    """The union of some steps: how often each arc is in them, and a fingerprint of the arcs that are."""

    def __init__(self, labels: Sequence[Label]) -> None:
        self._labels = labels
        self._times: Counter[_Arc] = Counter()
        self._secrets: defaultdict[_Arc, int] = defaultdict(lambda: secrets.randbits(_SECRET_BITS))
        self.fingerprint = 0

    def add(self, arcs: Iterable[_Arc]) -> None:
        """Take the arcs of one more step."""
        for arc in arcs:
            self._times[arc] += 1
            if self._times[arc] == 1:
                self.fingerprint ^= self._secrets[arc]

    def drop(self, arcs: Iterable[_Arc]) -> None:
        """Give up the arcs of a step that was taken."""
        for arc in arcs:
            self._times[arc] -= 1
            if not self._times[arc]:
                del self._times[arc]
                self.fingerprint ^= self._secrets[arc]

    def size(self) -> int:
        """Return the number of nodes and arcs."""
        return len(self._labels) + len(self._times)

    def canonical(self) -> bytes:
        """Return the canonical graph."""
        return encode_graph(self._labels, sorted(self._times))


def _decode_sequence(data: bytes) -> _Sequence:
    """Return the sequence in canonical bytes, which have one spelling only."""
    if len(data) > MAX_SEQUENCE_BYTES:
        raise MalformedGraph(f"a sequence has at most {MAX_SEQUENCE_BYTES} bytes, not {len(data)}")
    document = parse(data, MalformedGraph, "the sequence")
    if not isinstance(document, dict) or set(document) != {"format", "labels", "period", "steps"}:
        raise MalformedGraph("a sequence is an object with exactly the keys format, labels, period and steps")
    if document["format"] != SEQUENCE_FORMAT:
        raise MalformedGraph(f"the format of a sequence is {SEQUENCE_FORMAT!r}, not {shown(document['format'])}")
    labels = tuple(valid_labels(document["labels"]))
    if any(not a < b for a, b in pairwise(map(label_key, labels))):
        raise MalformedGraph("labels stand in strictly ascending canonical order")
    rows, period = document["steps"], document["period"]
    if not isinstance(rows, list) or not 1 <= len(rows) <= MAX_STEPS:
        raise MalformedGraph(f"steps is a list of 1..{MAX_STEPS} steps")
    steps = tuple(_arcs_of_step(row, len(labels)) for row in rows)
    if period is not None and (type(period) is not int or not 1 <= period <= len(steps)):
        raise MalformedGraph(f"the period is null or an integer in 1..number of steps = 1..{len(steps)}")
    if encode_sequence(labels, steps, period) != data:
        raise MalformedGraph("the sequence is not in canonical spelling (spaces, key order or escapes differ)")
    return _Sequence(labels, steps, period, hashlib.sha256(data).hexdigest())


def _arcs_of_step(row: Any, n: int) -> tuple[_Arc, ...]:
    """Return the arcs of a step: pairs of different ids, strictly ascending."""
    if not isinstance(row, list):
        raise MalformedGraph("a step is a list of pairs of ids")
    last = (-1, -1)
    arcs = []
    for arc in row:
        if not (isinstance(arc, list) and len(arc) == 2 and all(type(x) is int and 0 <= x < n for x in arc)):
            raise MalformedGraph(f"an arc is a pair of ids in 0..{n - 1}")
        pair = (arc[0], arc[1])
        if pair[0] == pair[1] or not last < pair:
            raise MalformedGraph("the arcs of a step join two different nodes and stand in strictly ascending order")
        last = pair
        arcs.append(pair)
    return tuple(arcs)


def _claim_numbers(claim: dict[str, Any], n: int) -> tuple[int, int, int]:
    """Return r, s and the window length of a claim in range."""
    if claim["property"] != "jointly-rs-robust":
        raise MalformedCertificate(f"the property is 'jointly-rs-robust', not {shown(claim['property'])}")
    r, s, length = (claim[name] for name in ("r", "s", "window"))
    if not all(type(value) is int and 1 <= value <= MAX_VALUE for value in (r, s, length)):
        raise MalformedCertificate(f"r, s and window are integers in 1..{MAX_VALUE}")
    if s > n:
        raise MalformedCertificate(f"s lies in 1..n = 1..{n}, not {s}")
    return r, s, length


@dataclass(frozen=True, slots=True)
class _Check:
    """One claim about one sequence; each method returns what the ordinary kernel proved, or raises."""

    sequence: _Sequence
    r: int
    s: int
    length: int

    def windows(self, evidence: dict[str, Any], body: bytes) -> list[VerifiedClaim]:
        """Check that every window's union is the graph of the certificate named for it, and each certificate once."""
        lengths, named = evidence["lengths"], evidence["unions"]
        if not isinstance(lengths, list) or not all(type(size) is int and size > 0 for size in lengths):
            raise MalformedCertificate("lengths is a list of positive integers")
        if sum(lengths) != len(body):
            raise MalformedCertificate(f"the certificates have {sum(lengths)} bytes, but {len(body)} follow the header")
        if not isinstance(named, list) or not all(type(i) is int and 0 <= i < len(lengths) for i in named):
            raise MalformedCertificate(f"unions is a list of numbers of certificates in 0..{len(lengths) - 1}")
        starts = self.sequence.starts(self.length)
        if not starts:
            raise RejectedCertificate(
                f"no window of {self.length} steps fits, and what is not seen is not claimed", "windows"
            )
        if len(named) != len(starts):
            raise RejectedCertificate(f"there are {len(starts)} windows, not {len(named)}", "windows")
        ends = list(accumulate(lengths))
        proven: dict[int, tuple[VerifiedClaim, int]] = {}
        size = 0
        for start, i, union in zip(starts, named, self.sequence.unions(self.length, starts), strict=True):
            if i not in proven:
                size += union.size()
                if size > MAX_UNION_SIZE:
                    raise MalformedCertificate(f"the unions have more than {MAX_UNION_SIZE} nodes and arcs together")
                certificate = body[ends[i] - lengths[i] : ends[i]]
                proven[i] = self._verified(start, union, certificate, "robust"), union.fingerprint
            elif union.fingerprint != proven[i][1]:
                raise RejectedCertificate(f"window {start}: its union is not the graph of certificate {i}", "windows")
        if len(proven) < len(lengths):
            raise RejectedCertificate(f"{len(lengths) - len(proven)} certificates are named for no window", "windows")
        return [claim for claim, _ in proven.values()]

    def violation(self, start: Any, body: bytes) -> list[VerifiedClaim]:
        """Check that the body proves the union of the window at ``start`` not robust."""
        if type(start) is not int:
            raise MalformedCertificate("start is an integer")
        if start not in self.sequence.starts(self.length):
            raise RejectedCertificate(f"no window of {self.length} steps to be looked at starts at {start}", "windows")
        (union,) = self.sequence.unions(self.length, range(start, start + 1))
        return [self._verified(start, union, body, "not-robust")]

    def no_window(self, body: bytes) -> list[VerifiedClaim]:
        """Check that a finite trace is too short for any window: by definition it is not jointly robust over these."""
        if body:
            raise MalformedCertificate(f"{len(body)} bytes follow the header, but evidence 'no-window' has no body")
        if self.sequence.starts(self.length):
            raise RejectedCertificate(f"there are windows of {self.length} steps", "windows")
        return []

    def _verified(self, start: int, union: _Union, certificate: bytes, verdict: str) -> VerifiedClaim:
        """Return what the ordinary kernel proves about the union, which must be the joint claim's own verdict."""
        try:
            claim = verify(union.canonical(), certificate)
        except RejectedCertificate as problem:
            raise RejectedCertificate(f"window {start}: {problem}", problem.code) from None
        except MalformedCertificate as problem:
            raise type(problem)(f"window {start}: {problem}") from None
        if (claim.verdict, claim.r, claim.s) != (verdict, self.r, self.s):
            raise RejectedCertificate(
                f"window {start}: its certificate is about ({claim.r},{claim.s}), {claim.verdict}, "
                f"not about ({self.r},{self.s}), {verdict}",
                "other-claim",
            )
        return claim
