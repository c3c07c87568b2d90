"""Refutations of solutions made by hand, and certificates of the second tolerance format, honest and forged.

Nothing here decides anything: what a forgery claims is judged by the brute force of ``tests.tolerance``.
"""

from __future__ import annotations

import json
import math
import random
from functools import cache
from itertools import product

from certificates import CertificateError, verify_tolerance
from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.roles import Roles, Threat, excludes, settle
from certificates.tolerance import FORMAT_WITH_REFUTATIONS
from robustness import Digraph
from robustness.limits import Limits
from robustness.traps import searching
from robustness.traps.question import Question
from tests.certificates.forging import Token, spell
from tests.tolerance.brute_force import has_standing_attack, has_trap

#: Two faces, local.
KINDS = list(product((False, True), (False, True)))
PROPAGATE, ROOT, NORMAL, MALICIOUS, EXCLUDE = 0, 1, 2, 4, 6


def solvable(graph: Digraph, question: Question) -> bool:
    oracle = has_trap if question.two_faces else has_standing_attack
    return oracle(graph.in_masks, question.f, question.local)


def questions(graph: Digraph) -> list[Question]:
    return [Question(f, *kind) for f in range(3) for kind in KINDS]


@cache
def searched(graph: Digraph, question: Question) -> bytes:
    answer = searching.decide(graph, question, Limits(), transcript=True)
    assert answer.exists is False
    assert answer.transcript is not None
    return answer.transcript


def certificate(graph: Digraph, question: Question, body: bytes, version: str = FORMAT_WITH_REFUTATIONS) -> bytes:
    f, two_faces, local = question
    claim = {"f": f, "faces": 2 if two_faces else 1, "bound": "local" if local else "total", "verdict": "together"}
    header = {"format": version, "graph": graph.sha256, "claim": claim, "evidence": {"kind": "refutation"}}
    return json.dumps(header).encode() + b"\n" + body


def is_accepted(graph: Digraph, question: Question, body: bytes) -> bool:
    try:
        verify_tolerance(graph.canonical_bytes(), certificate(graph, question, body))
    except CertificateError:
        return False
    return True


def wander(graph: Digraph, question: Question, draw: random.Random, steps: float = math.inf) -> bytes:
    """Return the transcript of a random search by the kernel's own rules; what it cannot close it leaves out."""
    threat = Threat.of(decode_graph(graph.canonical_bytes()), *question)
    tokens: list[Token] = []
    waiting = [(Roles.of_all_solutions(graph.n), True)]
    while waiting:
        state, symmetric = waiting.pop()
        try:
            settle(threat, state)
            while draw.random() < 0.8 and exclude_some(threat, state, draw, tokens):
                tokens.append((PROPAGATE,))
                settle(threat, state)
        except Contradiction:
            continue
        choices: list[Token] = []
        for side, node in product((0, 1), range(graph.n)):
            if (state.P[side] & ~state.T[side]) >> node & 1:
                choices.append((NORMAL + side, node))
            if (state.Q[side] & ~(state.Z & state.F[side])) >> node & 1:
                choices.append((MALICIOUS + side, node))
        if symmetric and draw.random() < 0.8:
            choices = [(ROOT, node) for node in range(graph.n) if state.P[0] >> node & 1]
        if choices and len(tokens) < steps:
            token = draw.choice(choices)
            tokens.append(token)
            waiting += [
                (child(state, token, question, False), token[0] == ROOT),
                (child(state, token, question, True), False),
            ]
    return spell(tokens)


def exclude_some(threat: Threat, state: Roles, draw: random.Random, tokens: list[Token]) -> bool:
    nodes = range(len(threat.hears))
    found = [
        (side, j, i)
        for side, j, i in product((0, 1), nodes, nodes)
        if state.P[side] >> j & 1 and state.T[1 - side] >> i & 1 and excludes(threat, state, side, j, i)
    ]
    for side, j, i in {(side, j): (side, j, i) for side, j, i in draw.sample(found, min(len(found), 2))}.values():
        tokens.append((EXCLUDE + side, j, i))
        if state.T[side] >> j & 1:
            raise Contradiction
        state.P[side] &= ~(1 << j)
    return bool(found)


def child(state: Roles, token: Token, question: Question, is_true: bool) -> Roles:
    """Return a child of a branch, by the definition of the format."""
    opcode, node = token
    made, bit, side = state.copy(), 1 << node, 0 if opcode == ROOT else opcode & 1
    sides = (0, 1) if opcode == ROOT or (opcode >= MALICIOUS and question.two_faces) else (side,)
    if is_true and opcode >= MALICIOUS:
        made.Z |= bit
        made.F[side] |= bit
    elif is_true:
        made.T[side] |= bit
    for each in sides if not is_true else ():
        (made.Q if opcode >= MALICIOUS else made.P)[each] &= ~bit
    return made
