"""Writes the folders accepted/, rejected/ and malformed/: ``python -m tests.certificates.make_samples [FOLDER]``.

Every sample is a pair of files, NAME.graph and NAME.cert. See README.md.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import networkx as nx

from robustness import Digraph
from tests.certificates.forging import certificate, read, spell, wander

HERE = Path(__file__).resolve().parent

WHEEL = Digraph.from_networkx(nx.wheel_graph(5))
K6 = Digraph.from_networkx(nx.complete_graph(6))
CUBE = Digraph.from_networkx(nx.hypercube_graph(3))
HEXAGON = Digraph.from_networkx(nx.cycle_graph(6))
TRIANGLES = Digraph.from_networkx(nx.disjoint_union(nx.cycle_graph(3), nx.cycle_graph(3)))
NAMES = Digraph([1, "1", "\u00e9", (2, "x")], [(1, "1"), ("1", "\u00e9"), ("\u00e9", 1), ("1", (2, "x"))])
ONE = Digraph(["alone"], [])
GROWTH = {"kind": "growth", "seed": [0, 1, 2], "order": [3, 4], "proof": {"kind": "degree"}}
#: The wheel is a cycle of four joined with a node, and also a triangle with two new nodes and some arcs.
DERIVED: dict[str, Any] = {
    "kind": "derivation",
    "seed": {"nodes": 4, "arcs": [[0, 1], [1, 0], [1, 2], [2, 1], [2, 3], [3, 2], [3, 0], [0, 3]], "r": 1, "s": 4},
    "proof": {"kind": "refutation"},
    "steps": [{"rule": "join-clique", "size": 1}],
    "ids": [1, 2, 3, 4, 0],
}
GROWN: dict[str, Any] = {
    "kind": "derivation",
    "seed": {"nodes": 3, "arcs": [[u, v] for u in range(3) for v in range(3) if u != v], "r": 2, "s": 3},
    "proof": {"kind": "degree"},
    "steps": [
        {"rule": "weaken", "r": 2, "s": 1},
        {"rule": "add-node", "hears": [0, 2]},
        {"rule": "add-node", "hears": [0, 1, 3]},
        {"rule": "add-arcs", "arcs": [[3, 0], [3, 2], [4, 0], [4, 1], [4, 3]]},
    ],
    "ids": [0, 1, 2, 3, 4],
}
TWO_RIMS = {"kind": "violation", "S1": [1, 2], "S2": [3, 4]}


def proof(graph: Digraph, r: int, s: int) -> bytes:
    """Return a refutation by a search that chooses at random, the same at every run."""
    return certificate(graph, r, s, body=body(graph, r, s))


def body(graph: Digraph, r: int, s: int) -> bytes:
    return wander(graph, r, s, random.Random(1))


def derived(evidence: dict[str, Any]) -> bytes:
    """Return a derivation of the wheel from the cycle of four."""
    cycle = Digraph.from_networkx(nx.cycle_graph(4))
    return certificate(WHEEL, 2, 1, evidence=evidence, body=body(cycle, 1, 4))


def cut(graph: Digraph, r: int, s: int) -> bytes:
    """Return a refutation that was stopped after three steps."""
    return certificate(graph, r, s, body=wander(graph, r, s, random.Random(1), steps=3))


def without(data: bytes, step: int) -> bytes:
    """Return a certificate without this step of its transcript."""
    header, transcript = data.split(b"\n", 1)
    tokens = read(transcript)
    return header + b"\n" + spell(tokens[:step] + tokens[step + 1 :])


def samples() -> Iterator[tuple[str, str, bytes, bytes]]:
    """Yield folder, name, graph and certificate."""
    wheel = WHEEL.canonical_bytes()
    for name, graph, data in (
        ("refutation-wheel-2-1", WHEEL, proof(WHEEL, 2, 1)),
        ("refutation-wheel-2-5", WHEEL, proof(WHEEL, 2, 5)),
        ("refutation-cube-1-2", CUBE, proof(CUBE, 1, 2)),
        ("refutation-labels-of-every-type", NAMES, proof(NAMES, 1, 1)),
        ("degree-complete-3-6", K6, certificate(K6, 3, 6, evidence={"kind": "degree"})),
        ("degree-one-node", ONE, certificate(ONE, 1, 1, evidence={"kind": "degree"})),
        ("growth-wheel-2-1", WHEEL, certificate(WHEEL, 2, 1, evidence=GROWTH)),
        ("derivation-wheel-is-a-joined-cycle", WHEEL, derived(DERIVED)),
        ("derivation-wheel-grown-from-a-triangle", WHEEL, certificate(WHEEL, 2, 1, evidence=GROWN)),
        ("violation-wheel-3-1", WHEEL, certificate(WHEEL, 3, 1, "not-robust", TWO_RIMS)),
        (
            "violation-with-exempt-nodes",
            HEXAGON,
            certificate(HEXAGON, 1, 5, "not-robust", {"kind": "violation", "S1": [0, 1, 2], "S2": [3, 4, 5]}),
        ),
    ):
        yield "accepted", name, graph.canonical_bytes(), data
    for name, graph, data in (
        ("another-graph-of-the-same-degrees", TRIANGLES, proof(HEXAGON, 1, 1)),
        ("the-proof-of-a-sibling", TRIANGLES, certificate(TRIANGLES, 1, 1, body=body(HEXAGON, 1, 1))),
        ("the-proof-of-a-smaller-r", WHEEL, certificate(WHEEL, 3, 1, body=body(WHEEL, 2, 1))),
        ("r-beyond-half", WHEEL, certificate(WHEEL, 4, 1, body=b"\1\0")),
        ("r-beyond-half-on-one-node", ONE, certificate(ONE, 2, 1, body=b"\1\0")),
        ("sound-steps-and-open-leaves", WHEEL, cut(WHEEL, 3, 1)),
        ("a-step-left-out", CUBE, without(proof(CUBE, 1, 1), 0)),
        ("the-end-cut-off", WHEEL, proof(WHEEL, 2, 1)[:-1]),
        ("a-tail-behind-the-tree", WHEEL, proof(WHEEL, 2, 1) + b"\0"),
        ("no-tree", WHEEL, certificate(WHEEL, 2, 1)),
        ("degree-too-small", HEXAGON, certificate(HEXAGON, 1, 1, evidence={"kind": "degree"})),
        ("growth-too-thin", WHEEL, certificate(WHEEL, 2, 2, evidence=GROWTH)),
        ("growth-without-a-node", WHEEL, certificate(WHEEL, 2, 1, evidence=GROWTH | {"order": [3]})),
        ("derivation-of-a-larger-s", WHEEL, certificate(WHEEL, 2, 2, evidence=GROWN)),
        (
            "derivation-that-skips-weaken",
            WHEEL,
            certificate(WHEEL, 2, 1, evidence=GROWN | {"steps": GROWN["steps"][1:]}),
        ),
        ("derivation-of-another-numbering", WHEEL, derived(DERIVED | {"ids": [0, 1, 2, 3, 4]})),
        ("a-pair-that-violates-nothing", WHEEL, certificate(WHEEL, 2, 1, "not-robust", TWO_RIMS)),
        ("a-pair-that-overlaps", WHEEL, certificate(WHEEL, 3, 1, "not-robust", TWO_RIMS | {"S2": [2, 4]})),
        ("an-empty-set", WHEEL, certificate(WHEEL, 3, 1, "not-robust", TWO_RIMS | {"S1": []})),
    ):
        yield "rejected", name, graph.canonical_bytes(), data
    good = proof(WHEEL, 2, 1)
    for name, data in (
        ("empty", b""),
        ("no-newline", good.split(b"\n", 1)[0]),
        ("not-json", good.replace(b"{", b"(", 1)),
        ("not-utf-8", good.replace(b"robust", b"rob\xffst", 1)),
        ("version-of-the-future", good.replace(b"certificate/1", b"certificate/2")),
        ("unknown-key", good.replace(b'"r": 2', b'"r": 2, "q": 2')),
        ("repeated-key", good.replace(b'"r": 2', b'"r": 2, "r": 2')),
        ("missing-key", good.replace(b'"s": 1, ', b"")),
        ("r-zero", good.replace(b'"r": 2', b'"r": 0')),
        ("r-a-fraction", good.replace(b'"r": 2', b'"r": 2.0')),
        ("r-nan", good.replace(b'"r": 2', b'"r": NaN')),
        ("r-true", good.replace(b'"r": 2', b'"r": true')),
        ("r-of-a-thousand-digits", good.replace(b'"r": 2', b'"r": ' + b"9" * 1000)),
        ("s-beyond-n", good.replace(b'"s": 1', b'"s": 6')),
        ("verdict-undecided", good.replace(b'"robust"', b'"undecided"')),
        ("verdict-without-such-evidence", good.replace(b'"robust"', b'"not-robust"')),
        ("evidence-of-no-kind", good.replace(b'"kind"', b'"sort"')),
        ("lone-surrogate", good.replace(b'"refutation"', rb'"\ud800"')),
        ("nested-too-deeply", good.replace(b'{"kind": "refutation"}', b"[" * 5000 + b"]" * 5000)),
        ("ids-out-of-range", certificate(WHEEL, 3, 1, "not-robust", TWO_RIMS | {"S2": [3, 5]})),
        ("ids-out-of-order", certificate(WHEEL, 3, 1, "not-robust", TWO_RIMS | {"S2": [4, 3]})),
        ("derivation-step-of-no-rule", certificate(WHEEL, 2, 1, evidence=GROWN | {"steps": [{"rule": "believe"}]})),
        ("a-body-for-degree", certificate(K6, 3, 1, evidence={"kind": "degree"}, body=b"\0")),
    ):
        yield "malformed", name, K6.canonical_bytes() if name == "a-body-for-degree" else wheel, data
    for name, graph in (
        ("graph-in-another-spelling", wheel.replace(b",", b", ", 1)),
        ("graph-with-arcs-out-of-order", wheel.replace(b"[[0,1],[0,2]", b"[[0,2],[0,1]")),
        ("graph-with-a-label-twice", wheel.replace(b'"labels":[0,1,', b'"labels":[1,1,')),
        ("graph-of-no-format", b"{}"),
    ):
        yield "malformed", name, graph, good


def write(target: Path) -> None:
    """Write every sample below ``target``."""
    for folder, name, graph, data in samples():
        (target / folder).mkdir(parents=True, exist_ok=True)
        (target / folder / f"{name}.graph").write_bytes(graph)
        (target / folder / f"{name}.cert").write_bytes(data)


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
