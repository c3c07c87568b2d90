"""Every rule of the trap kernel keeps every solution: by enumeration, on states at random."""

from __future__ import annotations

import random
from itertools import product

import networkx as nx
import numpy as np
import pytest

import robustness as rb
from certificates.graph import decode_graph
from certificates.separation import check_separation
from robustness.kernels.layout import (
    MALICIOUS,
    NORMAL,
)
from robustness.kernels.layout import TRAP_F as F
from robustness.kernels.layout import TRAP_P as P
from robustness.kernels.layout import TRAP_Q as Q
from robustness.kernels.layout import TRAP_T as T
from robustness.kernels.layout import TRAP_Z as Z
from robustness.kernels.trap_rules import TrapRules, assume
from robustness.traps import find_trap
from robustness.traps.question import Question, Sets, solves
from robustness.traps.searching import _Run, _whole_state
from tests.oracles import digraphs, graphs
from tests.tolerance.brute_force import has_standing_attack, has_trap

KINDS = list(product((False, True), (False, True)))

#: What a literal is: kind, side, node, true.
Literal = tuple[int, int, int, int]


def solutions(graph: rb.Digraph, question: Question) -> list[tuple[str, Sets]]:
    """Return every solution and the roles of its nodes: nowhere, normal on side 1 or 2, malicious (a, b: on which)."""
    found = []
    for roles in product("-12M" if question.two_faces else "-12ab", repeat=graph.n):
        held = {role: frozenset(i for i in range(graph.n) if roles[i] == role) for role in "12Mab"}
        sets = Sets(held["M"] | held["a"] | held["b"], held["1"] | held["a"], held["2"] | held["b"])
        if solves(graph, question, sets):
            found.append(("".join(roles), sets))
    return found


def obeys(roles: str, literal: Literal, two_faces: bool) -> bool:
    kind, side, node, true = literal
    wanted = "12"[side] if kind == NORMAL else "M" if two_faces else "ab"[side]
    return (roles[node] == wanted) == bool(true)


def literal_of(node: int, role: str) -> Literal:
    """Return the literal that gives a node its role."""
    return (NORMAL, int(role) - 1, node, 1) if role in "12" else (MALICIOUS, int(role == "b"), node, 1)


def kept(roles: str, state: np.ndarray) -> bool:
    """Return whether the state still stands for the solution with these roles."""
    places = {"P0": P, "P1": P + 1, "Q0": Q, "Q1": Q + 1, "F0": F, "F1": F + 1, "T0": T, "T1": T + 1, "Z": Z}
    rows = {name: {i for i in range(len(roles)) if int(state[row, 0]) >> i & 1} for name, row in places.items()}
    bad = {i for i, role in enumerate(roles) if role in "Mab"}
    if not rows["Z"] <= bad:
        return False
    for side in range(2):
        normal = {i for i, role in enumerate(roles) if role == "12"[side]}
        inside_bad = {i for i, role in enumerate(roles) if role in ("M", "ab"[side])}
        if not (normal <= rows[f"P{side}"] and inside_bad <= rows[f"Q{side}"] and rows[f"T{side}"] <= normal):
            return False
        if not rows[f"F{side}"] <= normal | inside_bad:
            return False
    return True


@pytest.mark.parametrize(("two_faces", "local"), KINDS)
def test_propagation_keeps_every_solution(two_faces: bool, local: bool) -> None:
    draw = random.Random(f"{two_faces}{local}")
    stood_for = closed = 0
    for _ in range(60 if local else 30):
        n = 5 if two_faces or not local else draw.choice((5, 6))
        graph = rb.Digraph.from_networkx(
            nx.gnp_random_graph(n, draw.uniform(0.4, 1), seed=draw.randrange(2**31), directed=draw.random() < 0.7)
        )
        question = Question(draw.choice((0, 1, 1, 2)), two_faces, local)
        every = solutions(graph, question)
        need = np.maximum(graph.in_degrees - question.f, 0).astype(np.int64)
        for _ in range(8):
            if draw.random() < 0.5:
                literals = [
                    (draw.choice((NORMAL, MALICIOUS)), draw.randrange(2), draw.randrange(n), draw.randrange(2))
                    for _ in range(draw.randrange(4))
                ]
            else:
                # Part of a solution, so that nodes become malicious and tight ones are told from others.
                roles = draw.choice(every)[0] if every else "-" * n
                known = draw.sample(range(n), draw.randrange(1, n))
                literals = [literal_of(node, roles[node]) for node in known if roles[node] != "-"]
            state = _whole_state(n, 1)
            for kind, side, node, true in literals:
                assume(state, kind, side, node, true, two_faces)
            expected = [roles for roles, _ in every if all(obeys(roles, each, two_faces) for each in literals)]
            alive = TrapRules(graph.in_words, need, question.f, two_faces, local, True).propagate(state)
            assert alive or not expected, (graph.in_masks, question, literals, expected[:1])
            closed += not alive
            for roles in expected if alive else ():
                stood_for += 1
                assert kept(roles, state), (graph.in_masks, question, literals, roles)
    assert stood_for > 1000
    assert closed > 20


def test_a_malicious_node_that_has_no_side_yet_costs_nothing_more() -> None:
    """It was once counted as a further malicious one."""
    masks = (118, 57, 123, 54, 72, 26, 63)
    graph = rb.Digraph(range(7), [(j, i) for i in range(7) for j in range(7) if masks[i] >> j & 1])
    assert find_trap(graph, 1, faces=1, local=True, algorithm="search").M == {0, 2, 6}


@pytest.mark.parametrize(("two_faces", "local"), KINDS)
@pytest.mark.parametrize(("look_ahead", "eager"), [(False, False), (True, False), (True, True)])
def test_each_strategy_alone_is_right_on_all_small_graphs_and_writes_what_the_kernel_of_certificates_accepts(
    two_faces: bool, local: bool, look_ahead: bool, eager: bool
) -> None:
    """Together they take turns, so that one of them could hide behind the other."""
    truth = has_trap if two_faces else has_standing_attack
    refuted = tried = 0
    for graph in (each for n in (2, 3, 4, 5) for each in (*graphs(n), *(digraphs(n) if n < 4 else ()))):
        for f in range(3):
            need = np.maximum(graph.in_degrees - f, 0).astype(np.int64)
            run = _Run(graph.in_words, need, Question(f, two_faces, local), True, look_ahead, eager, True)
            while not run.is_closed and run.solution is None:
                run.advance()
            assert run.is_closed != truth(graph.in_masks, f, local), (graph.in_masks, f)
            tried += run.probes
            if run.is_closed:
                canonical = decode_graph(graph.canonical_bytes())
                body = b"".join(run.transcript)
                assert check_separation(canonical, f, 2 if two_faces else 1, "local" if local else "total", body) >= 1
                refuted += 1
    assert refuted > 40
    assert (tried > 0) == look_ahead


@pytest.mark.slow
@pytest.mark.parametrize(("two_faces", "local"), KINDS)
def test_search_on_thousands_of_random_digraphs(two_faces: bool, local: bool) -> None:
    draw = random.Random(11)
    truth = has_trap if two_faces else has_standing_attack
    for _ in range(3000):
        graph = rb.Digraph.from_networkx(
            nx.gnp_random_graph(draw.choice((6, 7)), draw.uniform(0.4, 1), seed=draw.randrange(2**31), directed=True)
        )
        for f in (1, 2):
            found = find_trap(graph, f, faces=2 if two_faces else 1, local=local, algorithm="search")
            assert found.exists == truth(graph.in_masks, f, local), (graph.in_masks, f)
