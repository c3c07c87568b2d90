"""Certificates made by hand, honest and forged, by docs/certificate-format.md and the kernel's own rules.

Nothing here decides anything: what a forgery claims is judged by ``tests.oracles``.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Iterator, Sequence
from functools import cache

from certificates import CertificateError, VerifiedClaim, verify
from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.rules import Question, State, excludes, settle
from robustness import Digraph
from robustness.decision.algorithms import subset_search
from robustness.limits import Limits
from tests.oracles import brute_profile

PROPAGATE, ROOT, SATISFIED, MEMBER, EXCLUDE_ONE, EXCLUDE_TWO = 0, 1, 2, 4, 6, 8

#: An opcode and its operands.
Token = tuple[int, ...]


def certificate(
    graph: Digraph, r: object, s: object, verdict: str = "robust", evidence: object = None, body: bytes = b""
) -> bytes:
    """Return a certificate with this evidence, by default a refutation, whatever it proves."""
    claim = {"property": "rs-robust", "r": r, "s": s, "verdict": verdict}
    evidence = {"kind": "refutation"} if evidence is None else evidence
    header = {"format": "robustness/certificate/1", "graph": graph.sha256, "claim": claim, "evidence": evidence}
    return json.dumps(header).encode() + b"\n" + body


def verdict_of(graph: Digraph, data: bytes) -> VerifiedClaim | None:
    """Return what the kernel says about ``data``: the claim, or None for a refusal of any of its kinds."""
    try:
        return verify(graph.canonical_bytes(), data)
    except CertificateError:
        return None


@cache
def profile(graph: Digraph) -> dict[int, int]:
    """Return the oracle's profile, once per graph."""
    return brute_profile(graph)


def holds(graph: Digraph, r: int, s: int) -> bool:
    """Return the oracle's answer."""
    return s <= profile(graph).get(r, 0)


def claims(graph: Digraph, *, true: bool) -> Iterator[tuple[int, int]]:
    """Yield every (r,s) for which the graph is robust, or every one for which it is not, r up to ceil(n/2) + 1."""
    for r in range(1, (graph.n + 1) // 2 + 2):
        for s in range(1, graph.n + 1):
            if holds(graph, r, s) is true:
                yield r, s


@cache
def searched(graph: Digraph, r: int, s: int) -> bytes:
    """Return the transcript of the search for a true claim."""
    answer = subset_search.decide(graph, r, s, Limits(), transcript=True)
    assert answer.transcript is not None
    return answer.transcript


def varint(value: int) -> bytes:
    """Return the shortest spelling of a number."""
    digits = bytearray()
    while value >= 128:
        digits.append(value & 127 | 128)
        value >>= 7
    return bytes(digits) + bytes([value])


def spell(tokens: Sequence[Token]) -> bytes:
    """Return the bytes of a transcript."""
    return b"".join(varint(number) for token in tokens for number in token)


def read(body: bytes) -> list[Token]:
    """Return the steps of a well-formed transcript of a graph with fewer than 128 nodes."""
    tokens, place = [], 0
    while place < len(body):
        size = {0: 1, 1: 2, 6: 3, 7: 3, 8: 4, 9: 4}.get(body[place], 2)
        tokens.append(tuple(body[place : place + size]))
        place += size
    return tokens


def wander(graph: Digraph, r: int, s: int, rng: random.Random, steps: float = math.inf) -> bytes:
    """Return the transcript of a random search by the kernel's own rules; what it cannot close it leaves out.

    For a true claim this is a proof, however odd, unless it ends after ``steps``. For a false one it is the best
    forgery there is: every step of it is sound, and only subtrees that stand for violating pairs are missing.
    """
    question = Question.of(decode_graph(graph.canonical_bytes()), r, s)
    tokens: list[Token] = []
    waiting = [(State.of_all_pairs(graph.n), True)]
    while waiting:
        state, symmetric = waiting.pop()
        try:
            settle(question, state)
            while rng.random() < 0.8 and _exclude_some(question, state, rng, tokens):
                tokens.append((PROPAGATE,))
                settle(question, state)
        except Contradiction:
            continue
        choices: list[Token] = [
            (opcode + side, node)
            for opcode, may, must in ((SATISFIED, state.P, state.T), (MEMBER, state.C, state.F))
            for side in (0, 1)
            for node in range(graph.n)
            if (may[side] & ~must[side]) >> node & 1
        ]
        if symmetric and rng.random() < 0.8:
            choices = [(ROOT, node) for node in range(graph.n) if state.P[0] >> node & 1]
        if choices and len(tokens) < steps:
            token = rng.choice(choices)
            tokens.append(token)
            false, true = (_child(state, token, is_true) for is_true in (False, True))
            waiting += [(false, token[0] == ROOT), (true, False)]
    return spell(tokens)


def _exclude_some(question: Question, state: State, rng: random.Random, tokens: list[Token]) -> bool:
    """Apply one or two exclusions that hold, with one or two blockers, and write them down."""
    found: list[tuple[int, int, list[int]]] = []
    for side in (0, 1):
        blockers = [i for i in range(len(question.hears)) if state.T[1 - side] >> i & 1]
        groups = [[i] for i in blockers] + [[i, j] for i in blockers for j in blockers if i != j]
        for node in range(len(question.hears)):
            if state.P[side] >> node & 1:
                found += [(side, node, group) for group in groups if excludes(question, state, side, node, group)]
    chosen = {(side, node): group for side, node, group in rng.sample(found, min(len(found), rng.randint(1, 2)))}
    for (side, node), group in chosen.items():
        tokens.append(((EXCLUDE_ONE, EXCLUDE_TWO)[len(group) - 1] + side, node, *group))
        if state.T[side] >> node & 1:
            raise Contradiction
        state.P[side] &= ~(1 << node)
    return bool(chosen)


def _child(state: State, token: Token, is_true: bool) -> State:
    """Return a child of a branch, by the definition of the format."""
    opcode, node = token
    child, bit = state.copy(), 1 << node
    member, side = opcode >= MEMBER, 0 if opcode == ROOT else opcode & 1
    if is_true:
        (child.F if member else child.T)[side] |= bit
        return child
    child.P[side] &= ~bit
    if member:
        child.C[side] &= ~bit
    if opcode == ROOT:
        child.P[1] &= ~bit
    return child
