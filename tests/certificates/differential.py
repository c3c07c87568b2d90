"""Two checkers side by side: the Python kernel and the one that is proved correct, on certificates made at random.

``python -m tests.certificates.differential --count 100000 --seed 1`` compares so many and prints every disagreement.
It ends with 1 when there is one, with 3 when the verified checker is not built.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import networkx as nx

from certificates import MalformedCertificate, RejectedCertificate, VerifiedClaim, VerifiedToleranceClaim
from certificates.graph import digest
from certificates.questions import verify_any
from certificates.tolerance import FORMAT as FIRST_TOLERANCE_FORMAT
from certificates.tolerance import FORMAT_WITH_REFUTATIONS
from cli.verified import find_checker
from robustness import Digraph
from robustness.decision.algorithms import subset_search
from robustness.limits import Limits
from robustness.traps import searching
from robustness.traps.question import Question
from tests.certificates.forging import certificate, read, spell, wander
from tests.certificates.test_separation import wander as wander_apart

__all__ = ["Stream", "by_the_kernel", "cases", "differs"]

#: The answers: 0 and the parts of the claim, ``(0, verdict, r, s)`` or ``(0, verdict, f, faces, bound)``, as text; or
#: the exit code 3 or 10 alone.
Answer = tuple[Any, ...]
Case = tuple[str, bytes, bytes]


class Stream:
    """A running verified checker that answers one pair of graph and certificate after the other."""

    def __init__(self, checker: Path) -> None:
        self.process = subprocess.Popen([checker, "stream"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __enter__(self) -> Stream:
        return self

    def __exit__(self, kind: type[BaseException] | None, it: BaseException | None, trace: TracebackType | None) -> None:
        self.process.communicate()

    def ask(self, graph: bytes, data: bytes) -> Answer:
        """Return what it answers."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(b"%d %d\n" % (len(graph), len(data)) + graph + data)
        self.process.stdin.flush()
        code, *parts = self.process.stdout.readline().decode().split()
        return int(code), *parts


def by_the_kernel(graph: bytes, data: bytes) -> Answer:
    """Return what the Python kernel answers."""
    try:
        claim = verify_any(graph, data)
    except MalformedCertificate:
        return (3,)
    except RejectedCertificate:
        return (10,)
    if isinstance(claim, VerifiedToleranceClaim):
        return 0, claim.verdict, str(claim.f), str(claim.faces), claim.bound
    assert isinstance(claim, VerifiedClaim)
    return 0, claim.verdict, str(claim.r), str(claim.s)


def differs(stream: Stream, case: Case) -> str | None:
    """Return what the two disagree on, acceptance or the claim; which refusal it is may differ."""
    name, graph, data = case
    kernel, verified = by_the_kernel(graph, data), stream.ask(graph, data)
    if kernel == verified or 0 not in (kernel[0], verified[0]):
        return None
    return f"{name}: the kernel says {kernel}, the verified checker {verified}: {graph!r} {data!r}"


def cases(seed: int) -> Iterator[Case]:
    """Yield certificates without end, honest ones and mutants of them, of every kind that both checkers know."""
    rng = random.Random(seed)
    while True:
        graph = _graph(rng)
        n = graph.n
        r, s = rng.randint(1, (n + 1) // 2), rng.choice((1, 1, rng.randint(1, n)))
        honest = [*_honest(graph, r, s, rng), *_honest_apart(graph, rng)]
        for name, data, body in honest:
            yield name, graph.canonical_bytes(), data
            for _ in range(8):
                yield f"{name}, mutated", *_mutant(graph, data, body, r, s, rng)


def _graph(rng: random.Random) -> Digraph:
    n = rng.choice((1, 2, 3, 4, 5, 5, 6, 6, 7, 8, 9, 10, 12, 63))
    p = 0.97 if n == 63 else rng.choice((0.4, 0.6, 0.8, 0.95))
    made = nx.gnp_random_graph(n, p, seed=rng.randrange(10**9), directed=rng.random() < 0.5)
    names: list[Any] = [
        i - 2 if i % 3 == 0 else f'n"\\\u00e9\U0001f600{i}' if i % 3 == 1 else (i, "x") for i in range(n)
    ]
    return Digraph.from_networkx(nx.relabel_nodes(made, dict(enumerate(names))) if rng.random() < 0.3 else made)


def _honest(graph: Digraph, r: int, s: int, rng: random.Random) -> Iterator[tuple[str, bytes, bytes]]:
    """Yield certificates that may well be right: name, bytes, and the body."""
    n = graph.n
    if n < 63:
        answer = subset_search.decide(graph, r, s, Limits(), transcript=True)
        if answer.transcript is not None:
            yield "searched", certificate(graph, r, s, body=answer.transcript), answer.transcript
        body = wander(graph, r, s, rng, 60)
        yield "wandered", certificate(graph, r, s, body=body), body
    ids = list(range(n))
    rng.shuffle(ids)
    cut, end = sorted((rng.randint(0, n), rng.randint(0, n)))
    pair = {"kind": "violation", "S1": sorted(ids[:cut]), "S2": sorted(ids[cut:end])}
    yield "violation", certificate(graph, rng.randint(r, n), s, "not-robust", pair), b""
    yield "degree", certificate(graph, rng.randint(1, r), s, evidence={"kind": "degree"}), b""
    seed = sorted(ids[: max(1, cut)])
    induced = {node: i for i, node in enumerate(seed)}
    arcs = [(induced[u], induced[v]) for u, v in _arcs(graph) if u in induced and v in induced]
    small = Digraph(range(len(seed)), arcs)
    if r <= (small.n + 1) // 2 and n < 63:
        found = subset_search.decide(small, r, min(s, small.n), Limits(), transcript=True).transcript or b""
        kind = rng.choice(("refutation", "degree"))
        grown = {"kind": "growth", "seed": seed, "order": [i for i in ids if i not in induced], "proof": {"kind": kind}}
        body = found if kind == "refutation" else b""
        yield "growth", certificate(graph, r, s, evidence=grown, body=body), body


def _honest_apart(graph: Digraph, rng: random.Random) -> Iterator[tuple[str, bytes, bytes]]:
    """Yield certificates of what f malicious nodes can do, that may well be right: name, bytes, and the body."""
    n = graph.n
    question = Question(rng.choice((0, 1, 1, 2, 3)), rng.random() < 0.5, rng.random() < 0.5)
    if n < 63:
        answer = searching.decide(graph, question, Limits(), transcript=True)
        if answer.transcript is not None:
            yield "apart: searched", _apart(graph, question, body=answer.transcript), answer.transcript
        if answer.sets is not None:
            sets = {name: sorted(ids) for name, ids in zip(("M", "S1", "S2"), answer.sets, strict=True)}
            yield "apart: sets found", _apart(graph, question, sets), b""
        body = wander_apart(graph, question, rng, 30)
        yield "apart: wandered", _apart(graph, question, body=body), body
    of = [rng.choice("MSTX") for _ in range(n)]
    drawn = {name: [i for i in range(n) if of[i] == letter] for name, letter in (("M", "M"), ("S1", "S"), ("S2", "T"))}
    if not question.two_faces:
        for i in drawn["M"]:
            drawn[rng.choice(("S1", "S2"))].append(i)
    drawn = {name: sorted(ids) for name, ids in drawn.items()}
    yield "apart: sets drawn", _apart(graph, question._replace(f=rng.randint(0, n)), drawn), b""
    r = 2 * question.f + 1
    if r <= (n + 1) // 2 and n < 63:
        found = subset_search.decide(graph, r, 1, Limits(), transcript=True).transcript or b""
        inner = certificate(graph, rng.choice((r, r, r, r + 1)), rng.choice((1, 1, 1, 2)), body=found)
        yield "apart: robust", _apart(graph, question, {"kind": "robust"}, inner), inner


def _apart(graph: Digraph, question: Question, evidence: dict[str, Any] | None = None, body: bytes = b"") -> bytes:
    """Return a tolerance certificate, of sets, of another certificate, or by default of a refutation."""
    f, two_faces, local = question
    verdict = "together" if evidence is None or "kind" in evidence else "apart"
    evidence = {"kind": "refutation" if evidence is None else "sets"} | (evidence or {})
    claim = {"f": f, "faces": 2 if two_faces else 1, "bound": "local" if local else "total", "verdict": verdict}
    form = FIRST_TOLERANCE_FORMAT if evidence["kind"] != "refutation" and f % 2 else FORMAT_WITH_REFUTATIONS
    header = {"format": form, "graph": graph.sha256, "claim": claim, "evidence": evidence}
    return json.dumps(header).encode() + b"\n" + body


def _arcs(graph: Digraph) -> list[tuple[int, int]]:
    arcs: list[list[int]] = json.loads(graph.canonical_bytes())["arcs"]
    return [(u, v) for u, v in arcs]


def _mutant(graph: Digraph, honest: bytes, body: bytes, r: int, s: int, rng: random.Random) -> tuple[bytes, bytes]:
    """Return a graph and a certificate that differ a little from an honest pair."""
    canonical = graph.canonical_bytes()
    head = honest[: len(honest) - len(body)]
    match rng.randrange(7):
        case 0 if body:
            place = rng.randrange(len(body))
            return canonical, head + body[:place] + bytes([rng.choice((*range(12), 129, 255))]) + body[place + 1 :]
        case 1 if body and graph.n < 128:
            tokens = read(body)
            i, j = sorted((rng.randrange(len(tokens)), rng.randrange(len(tokens))))
            tokens[i], tokens[j] = tokens[j], tokens[i]
            return canonical, head + spell(tokens)
        case 2 if body:
            return canonical, head + body[: rng.randrange(len(body))]
        case 3:
            document = json.loads(head)
            part = rng.choice([name for name in document["claim"] if name not in ("property", "verdict")])
            document["claim"][part] = rng.choice(
                ("total", "local", 2)
                if part in ("bound", "faces") and rng.random() < 0.8
                else (r, s, r + 1, s + 1, 1, 0, -1, 2**62, 2**70, 1.0, True, "1")
            )
            return canonical, json.dumps(document).encode() + b"\n" + body
        case 4:
            place = rng.randrange(len(head))
            return canonical, head[:place] + bytes([rng.randrange(256)]) + head[place + 1 :] + body
        case 5:
            place = rng.randrange(len(canonical))
            byte = bytes([rng.choice((*b'0123456789[],"\\ ', rng.randrange(256)))])
            other = canonical[:place] + byte + canonical[place + 1 :]
            bound = rng.random() < 0.7  # to the other graph, so that more than the digest tells them apart
            return other, honest.replace(graph.sha256.encode(), digest(other).encode()) if bound else honest
        case _:
            spaced = json.dumps(json.loads(head), indent=None, separators=(" ,\t", " : "), ensure_ascii=False)
            escaped = (
                spaced.replace("kind", "k\\u0069nd").replace("rs-robust", "rs\\u002Drobust").replace("S1", "\\u00531")
            )
            return canonical, rng.choice((spaced, escaped)).encode() + b"\r\n" + body


def main(arguments: list[str] | None = None) -> int:
    """Compare, and print each disagreement and a table of the answers."""
    parser = argparse.ArgumentParser(prog="python -m tests.certificates.differential")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(arguments)
    checker = find_checker()
    if checker is None:
        sys.stderr.write("robustness-verified is not built: make formal\n")
        return 3
    wrong, table = 0, Counter[str]()
    with Stream(checker) as stream:
        for _, case in zip(range(asked.count), cases(asked.seed), strict=False):
            told = differs(stream, case)
            table[f"{case[0]}: {by_the_kernel(case[1], case[2])[0]}"] += 1
            if told is not None:
                wrong += 1
                sys.stdout.write(f"{told}\n")
    for name, count in sorted(table.items()):
        sys.stdout.write(f"{count:8} {name}\n")
    sys.stdout.write(f"{asked.count} compared, {wrong} disagreements\n")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
