"""The two checkers of certificates side by side: ``python -m benchmarks.verified_checker [--long]``.

For each refutation: its bytes and steps, the processor time of the Python kernel and of the checker that is proved
correct, each in a process of its own, the least of some runs. The searches that write the refutations are not timed. A
stack of 128 KB is all that the verified checker is given. ``--long`` has it verify one of 51,557,757 steps instead,
which takes minutes to make and is not given to the Python kernel.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import networkx as nx

import certificates
from cli.verified import find_checker
from robustness import Digraph
from robustness.decision.algorithms import subset_search
from robustness.limits import Limits
from robustness.traps import searching
from robustness.traps.question import Question

__all__ = ["main"]

#: Operands of every opcode. All numbers of a graph with fewer than 128 nodes are one byte.
OPERANDS = (0, 1, 1, 1, 1, 1, 2, 2, 3, 3)
KERNEL = "import sys; sys.path.insert(0, sys.argv.pop(1)); from certificates.__main__ import main; sys.exit(main())"


def of_robustness(graph: Digraph, r: int) -> bytes:
    """Return a certificate that the graph is (r,1)-robust, as the search writes it."""
    body = subset_search.decide(graph, r, 1, Limits(), transcript=True).transcript
    claim = {"property": "rs-robust", "r": r, "s": 1, "verdict": "robust"}
    return _file(graph, "robustness/certificate/1", claim, body)


def of_no_solution(graph: Digraph, question: Question) -> bytes:
    """Return a certificate that the graph has no trap or no violation, as the search writes it."""
    body = searching.decide(graph, question, Limits(), transcript=True).transcript
    faces, bound = 2 if question.two_faces else 1, "local" if question.local else "total"
    claim = {"f": question.f, "faces": faces, "bound": bound, "verdict": "together"}
    return _file(graph, "robustness/tolerance-certificate/2", claim, body)


def _file(graph: Digraph, form: str, claim: dict[str, object], body: bytes | None) -> bytes:
    if body is None:
        raise SystemExit(f"the search refutes nothing: {claim}")
    header = {"format": form, "graph": graph.sha256, "claim": claim, "evidence": {"kind": "refutation"}}
    return json.dumps(header).encode() + b"\n" + body


def steps(certificate: bytes) -> int:
    """Return the number of steps of a refutation of a graph with fewer than 128 nodes."""
    place, count = certificate.index(b"\n") + 1, 0
    while place < len(certificate):
        place += 1 + OPERANDS[certificate[place]]
        count += 1
    return count


def processor_time(command: list[str], runs: int) -> float:
    """Return the least user and system time of some runs, each of which must verify."""
    found = []
    for _ in range(runs):
        before = os.times()
        if subprocess.run(command, capture_output=True, check=False).returncode:
            raise SystemExit(f"not verified: {command}")
        after = os.times()
        found.append(after.children_user - before.children_user + after.children_system - before.children_system)
    return min(found)


def refutations(long: bool) -> Iterator[tuple[str, Digraph, bytes]]:
    """Yield the name, the graph and the certificate of every line of the table."""
    for n, p, r in ((74, 0.5, 18),) if long else ((50, 0.5, 13), (60, 0.8, 25), (70, 0.5, 17)):
        graph = Digraph.from_networkx(nx.gnp_random_graph(n, p, seed=0))
        yield f"({r},1)-robust: G({n}, {p})", graph, of_robustness(graph, r)
    if not long:
        graph = Digraph.from_networkx(nx.gnp_random_graph(60, 0.5, seed=0))
        question = Question(9, two_faces=False, local=True)
        yield "no violation for f = 9, local: G(60, 0.5)", graph, of_no_solution(graph, question)


def main(arguments: list[str] | None = None) -> int:
    """Print a table; 3 when the verified checker is not built."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.verified_checker")
    parser.add_argument("--long", action="store_true", help="one refutation of 5 * 10**7 steps instead")
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args(arguments)
    checker = find_checker()
    if checker is None:
        sys.stderr.write("robustness-verified is not built: make formal\n")
        return 3
    root = str(Path(certificates.__file__).parents[1])
    print("| refutation | bytes | steps | Python kernel | verified | times |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        paths = [str(Path(folder, name)) for name in ("graph", "certificate")]
        for name, graph, certificate in refutations(asked.long):
            for path, data in zip(paths, (graph.canonical_bytes(), certificate), strict=True):
                Path(path).write_bytes(data)
            limited = ["bash", "-c", 'ulimit -s 128; exec "$@"', "-", str(checker), "verify", *paths]
            verified = processor_time(limited, asked.runs)
            cells = [name, f"{len(certificate):,}", f"{steps(certificate):,}"]
            if asked.long:
                cells += ["", f"{verified:.3g} s", ""]
            else:
                kernel = processor_time([sys.executable, "-I", "-c", KERNEL, root, "verify", *paths], asked.runs)
                cells += [f"{kernel:.3g} s", f"{verified:.2g} s", f"{kernel / verified:.0f}"]
            print("| " + " | ".join(cells) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
