"""Writes tolerance/accepted, rejected and malformed: ``python -m tests.certificates.make_tolerance_samples [FOLDER]``.

Every sample is a pair of files, NAME.graph and NAME.cert, of ``robustness/tolerance-certificate/2``. See README.md.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import networkx as nx

from certificates.tolerance import FORMAT, FORMAT_WITH_REFUTATIONS
from robustness import Digraph
from robustness.traps.question import Question
from tests.certificates.forging import certificate as ordinary
from tests.certificates.forging import read, spell
from tests.certificates.forging import wander as wander_for_pairs
from tests.certificates.forging_separation import certificate, wander

HERE = Path(__file__).resolve().parent / "tolerance"

K4, K5, K6 = (Digraph.from_networkx(nx.complete_graph(n)) for n in (4, 5, 6))
WHEEL = Digraph.from_networkx(nx.wheel_graph(5))
HEXAGON = Digraph.from_networkx(nx.cycle_graph(6))
TRIANGLES = Digraph.from_networkx(nx.disjoint_union(nx.cycle_graph(3), nx.cycle_graph(3)))
#: Nine nodes on a circle that hear three on either side.
CIRCLE = Digraph.from_networkx(nx.circulant_graph(9, (1, 2, 3)))
#: No trap for one liar in all, one for a liar around every node.
CHORDS = Digraph.from_networkx(nx.circulant_graph(9, (1, 3)))
#: One arc only, between labels of two types.
ARC = Digraph([1, "1"], [(1, "1")])
TRAP = {"M": [0], "S1": [1, 2], "S2": [3, 4]}
SPLIT = {"M": [0, 3], "S1": [0, 1, 2], "S2": [3, 4, 5]}


def body(graph: Digraph, f: int, two_faces: bool = True, local: bool = False) -> bytes:
    """Return a refutation by a search that chooses at random, the same at every run."""
    return wander(graph, Question(f, two_faces, local), random.Random(1))


def proof(graph: Digraph, f: int, two_faces: bool = True, local: bool = False) -> bytes:
    """Return a certificate with it."""
    return certificate(graph, Question(f, two_faces, local), body(graph, f, two_faces, local))


def apart(graph: Digraph, f: int, sets: dict[str, Any], faces: int = 2, bound: str = "total") -> bytes:
    """Return a certificate of sets that hold the graph apart."""
    claim = {"f": f, "faces": faces, "bound": bound, "verdict": "apart"}
    header = {"format": FORMAT_WITH_REFUTATIONS, "graph": graph.sha256, "claim": claim}
    return json.dumps(header | {"evidence": {"kind": "sets"} | sets}).encode() + b"\n"


def by_robustness(graph: Digraph, f: int, r: int) -> bytes:
    """Return a certificate whose evidence is an ordinary one, of r-robustness."""
    inner = ordinary(graph, r, 1, body=wander_for_pairs(graph, r, 1, random.Random(1)))
    return certificate(graph, Question(f), inner).replace(b'"refutation"', b'"robust"', 1)


def step_changed(data: bytes, step: int, new: tuple[tuple[int, ...], ...]) -> bytes:
    """Return a certificate with other steps in the place of one."""
    header, transcript = data.split(b"\n", 1)
    tokens = read(transcript)
    return header + b"\n" + spell([*tokens[:step], *new, *tokens[step + 1 :]])


def accepted() -> Iterator[tuple[str, Digraph, bytes]]:
    """Yield true claims and their proofs: every kind of evidence, one face and two, in all and local."""
    yield "no-trap-complete-5", K5, proof(K5, 1)
    yield "no-trap-circle", CIRCLE, proof(CIRCLE, 1)
    yield "no-trap-local", CIRCLE, proof(CIRCLE, 1, True, True)
    yield "no-violation-complete-4", K4, proof(K4, 1, False)
    yield "no-violation-local", K5, proof(K5, 1, False, True)
    yield "no-trap-without-malicious-nodes", HEXAGON, proof(HEXAGON, 0)
    yield "labels-of-two-types", ARC, proof(ARC, 0)
    yield "no-trap-since-3-robust", K6, by_robustness(K6, 1, 3)
    yield "trap-wheel", WHEEL, apart(WHEEL, 1, TRAP)
    yield "trap-wheel-local", WHEEL, apart(WHEEL, 1, TRAP, bound="local")
    yield "trap-without-malicious-nodes", TRIANGLES, apart(TRIANGLES, 0, {"M": [], "S1": [0, 1, 2], "S2": [3, 4, 5]})
    yield "violation-hexagon", HEXAGON, apart(HEXAGON, 2, SPLIT, 1)


def rejected() -> Iterator[tuple[str, Digraph, bytes]]:
    """Yield what is well-formed and proves nothing: mostly false claims with the proofs of true ones."""
    yield "the-proof-of-another-graph", TRIANGLES, proof(HEXAGON, 0)
    yield "the-refutation-of-a-sibling", TRIANGLES, certificate(TRIANGLES, Question(0), body(HEXAGON, 0))
    yield "the-refutation-of-a-smaller-f", CIRCLE, certificate(CIRCLE, Question(2), body(CIRCLE, 1))
    yield "the-refutation-of-one-face", K4, certificate(K4, Question(1), body(K4, 1, False))
    yield "the-refutation-in-all", CHORDS, certificate(CHORDS, Question(1, True, True), body(CHORDS, 1))
    yield "sound-steps-and-open-leaves", WHEEL, _cut(WHEEL, Question(1))
    yield "no-tree", K5, certificate(K5, Question(1), b"")
    yield "the-end-cut-off", CIRCLE, proof(CIRCLE, 1)[:-1]
    yield "a-tail-behind-the-tree", CIRCLE, proof(CIRCLE, 1) + b"\0"
    yield "a-step-left-out", CIRCLE, step_changed(proof(CIRCLE, 1), 0, ())
    yield "a-step-twice", CIRCLE, step_changed(proof(CIRCLE, 1), 0, (read(body(CIRCLE, 1))[0],) * 2)
    yield "a-root-below-the-root", CIRCLE, step_changed(proof(CIRCLE, 1), 1, ((1, 8),))
    yield "an-exclusion-without-a-blocker", CIRCLE, step_changed(proof(CIRCLE, 1), 0, ((6, 1, 2), (0,)))
    yield "an-exclusion-that-does-not-hold", WHEEL, certificate(WHEEL, Question(1), spell([(1, 1), (7, 3, 1), (0,)]))
    yield "propagation-of-nothing", CIRCLE, step_changed(proof(CIRCLE, 1), 0, ((0,),))
    yield "an-opcode-of-nothing", CIRCLE, step_changed(proof(CIRCLE, 1), 0, ((8,),))
    yield "a-number-with-a-zero-in-front", CIRCLE, certificate(CIRCLE, Question(1), b"\1\x88\0")
    yield "robust-for-too-small-an-r", K6, by_robustness(K6, 1, 2)
    yield "sets-that-overlap", WHEEL, apart(WHEEL, 1, TRAP | {"S2": [2, 3, 4]})
    yield "sets-without-a-normal-node", WHEEL, apart(WHEEL, 1, TRAP | {"S1": []})
    yield "malicious-nodes-inside", WHEEL, apart(WHEEL, 1, TRAP | {"S1": [0, 1, 2]})
    yield "malicious-nodes-outside", HEXAGON, apart(HEXAGON, 2, SPLIT | {"S1": [1, 2]}, 1)
    yield "too-many-malicious-nodes", HEXAGON, apart(HEXAGON, 1, SPLIT, 1)
    yield "too-many-around-a-node", TRIANGLES, apart(TRIANGLES, 1, {"M": [0, 1], "S1": [2], "S2": [3]}, bound="local")
    yield "a-node-that-hears-too-much", K5, apart(K5, 1, TRAP)


def malformed() -> Iterator[tuple[str, Digraph, bytes]]:
    """Yield what is not of the format."""
    good, sets = proof(K5, 1), apart(WHEEL, 1, TRAP)
    yield "empty", K5, b""
    yield "no-newline", K5, good.split(b"\n", 1)[0]
    yield "not-json", K5, good.replace(b"{", b"(", 1)
    yield "version-of-the-future", K5, good.replace(b"certificate/2", b"certificate/3")
    yield "refutation-in-the-first-version", K5, good.replace(FORMAT_WITH_REFUTATIONS.encode(), FORMAT.encode())
    yield "f-negative", K5, good.replace(b'"f": 1', b'"f": -1')
    yield "f-true", K5, good.replace(b'"f": 1', b'"f": true')
    yield "f-a-fraction", K5, good.replace(b'"f": 1', b'"f": 1.0')
    yield "f-of-a-thousand-digits", K5, good.replace(b'"f": 1', b'"f": ' + b"9" * 1000)
    yield "three-faces", K5, good.replace(b'"faces": 2', b'"faces": 3')
    yield "bound-of-no-kind", K5, good.replace(b'"total"', b'"totally"')
    yield "verdict-robust", K5, good.replace(b'"together"', b'"robust"')
    yield "verdict-without-such-evidence", K5, good.replace(b'"together"', b'"apart"')
    yield "sets-for-together", WHEEL, sets.replace(b'"apart"', b'"together"')
    yield "removals-which-are-gone", K5, good.replace(b'"refutation"', b'"removals"')
    yield "unknown-key", K5, good.replace(b'"f": 1', b'"f": 1, "q": 2')
    yield "repeated-key", K5, good.replace(b'"f": 1', b'"f": 1, "f": 1')
    yield "missing-key", K5, good.replace(b'"faces": 2, ', b"")
    yield "a-key-too-many-in-the-evidence", K5, good.replace(b'"refutation"', b'"refutation", "lengths": []')
    yield "a-body-for-sets", WHEEL, sets + b"\0"
    yield "ids-out-of-range", WHEEL, apart(WHEEL, 1, TRAP | {"S2": [3, 5]})
    yield "ids-out-of-order", WHEEL, apart(WHEEL, 1, TRAP | {"S2": [4, 3]})
    yield "ids-twice", WHEEL, apart(WHEEL, 1, TRAP | {"S2": [3, 3]})
    yield "robust-without-a-certificate", K6, by_robustness(K6, 1, 3).split(b"\n", 1)[0] + b"\n"
    yield "nested-too-deeply", K5, good.replace(b'{"kind": "refutation"}', b"[" * 5000 + b"]" * 5000)


def _cut(graph: Digraph, question: Question) -> bytes:
    return certificate(graph, question, wander(graph, question, random.Random(1), steps=3))


def samples() -> Iterator[tuple[str, str, bytes, bytes]]:
    """Yield folder, name, graph and certificate."""
    for folder, every in (("accepted", accepted()), ("rejected", rejected()), ("malformed", malformed())):
        for name, graph, data in every:
            yield folder, name, graph.canonical_bytes(), data


def write(target: Path) -> None:
    """Write every sample below ``target``."""
    for folder, name, graph, data in samples():
        (target / folder).mkdir(parents=True, exist_ok=True)
        (target / folder / f"{name}.graph").write_bytes(graph)
        (target / folder / f"{name}.cert").write_bytes(data)


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
