"""Exported proofs: a checker that knows no graphs accepts them all, and none of what is done to them."""

from __future__ import annotations

import random
import shutil
import subprocess
import warnings
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import networkx as nx
import pytest

import robustness as rb
from certificates import RejectedCertificate
from certificates.graph import decode_graph
from certificates.masks import Contradiction
from certificates.rules import State, settle
from robustness.constructions import blow_up, certify_derivation, guaranteed
from robustness.decision.certification import certify, encode
from robustness.decision.veripb import export
from robustness.decision.veripb.inequalities import Model
from robustness.decision.veripb.proof import SYNTAXES, Proof
from robustness.decision.veripb.settling import Knowledge, Settling
from robustness.errors import InvalidParameter
from tests.certificates.forging import certificate as forged
from tests.certificates.forging import claims, wander
from tests.oracles import brute_profile, digraphs, graphs, is_violating
from tests.veripb.checker import Checker, Rejected, check

VERSIONS = ("3.0", "1.1")


def certificate(graph: rb.Digraph, r: int, s: int, evidence: str = "refutation") -> bytes:
    found = certify(graph, r, s, evidence=evidence).certificate
    assert found is not None
    return found


def exported(
    graph: rb.Digraph, r: int, s: int = 1, version: str = "3.0", evidence: str = "refutation"
) -> tuple[bytes, bytes]:
    return export(graph.canonical_bytes(), certificate(graph, r, s, evidence), version=version)


def network(G: nx.Graph) -> rb.Digraph:
    return rb.Digraph.from_networkx(G)


def grown(n: int, heard: int, seed: nx.Graph) -> nx.Graph:
    return nx.barabasi_albert_graph(n, heard, seed=1, initial_graph=seed)


def accepted(model: bytes, proof: bytes) -> bool:
    try:
        check(model, proof)
    except Rejected:
        return False
    return True


# Every proof is accepted


@pytest.mark.parametrize("graph", [G for n in range(2, 6) for G in graphs(n)])
def test_every_graph_on_at_most_five_nodes(graph: rb.Digraph) -> None:
    for r, s_max in brute_profile(graph).items():
        for s, version in product(range(1, s_max + 1), VERSIONS):
            check(*exported(graph, r, s, version))


@pytest.mark.parametrize("n", [2, 3])
def test_every_digraph_on_at_most_three_nodes_with_the_shortest_evidence(n: int) -> None:
    for graph in digraphs(n):
        for r, s_max in brute_profile(graph).items():
            for s, version in product(range(1, s_max + 1), VERSIONS):
                check(*exported(graph, r, s, version, "shortest"))


@pytest.mark.slow
def test_every_graph_on_six_nodes_and_every_digraph_on_four() -> None:
    for graph in (*graphs(6), *digraphs(4)):
        for r, s_max in brute_profile(graph).items():
            for s, evidence in product(range(1, s_max + 1), ("refutation", "shortest")):
                check(*exported(graph, r, s, evidence=evidence))


@pytest.mark.parametrize("seed", range(60))
def test_random_graphs_at_their_greatest_r(seed: int) -> None:
    draw, robust = random.Random(seed), []
    while not robust:
        n, directed, s = draw.randint(6, 14), draw.random() < 0.4, draw.randint(1, 4)
        G = nx.gnp_random_graph(n, draw.uniform(0.35, 0.9), seed=draw.randrange(10**6), directed=directed)
        robust = [r for r, s_max in rb.robustness_profile(G).items() if s_max >= s]
    for version in VERSIONS:
        check(*exported(network(G), max(robust), s, version))


@pytest.mark.parametrize("seed", range(20))
def test_odd_transcripts(seed: int) -> None:
    """The search has habits; random walks by the rules of the format have none, and are exported all the same."""
    draw = random.Random(seed)
    for _ in range(20):
        n, directed = draw.randint(3, 7), draw.random() < 0.5
        G = nx.gnp_random_graph(n, draw.uniform(0.3, 1), seed=draw.randrange(10**6), directed=directed)
        for r, s in [claim for claim in claims(network(G), true=True) if draw.random() < 0.3]:
            odd = forged(network(G), r, s, body=wander(network(G), r, s, draw))
            check(*export(network(G).canonical_bytes(), odd))


@pytest.mark.parametrize(
    ("G", "r", "s"),
    [
        (nx.gnp_random_graph(20, 0.5, seed=1), 5, 1),
        (nx.gnp_random_graph(20, 0.7, seed=1), 7, 1),
        (nx.gnp_random_graph(20, 0.6, seed=3), 4, 3),
        (nx.gnp_random_graph(20, 0.7, seed=2, directed=True), 6, 2),
        (nx.gnp_random_graph(30, 0.5, seed=1), 8, 1),
        (nx.circulant_graph(24, range(1, 4)), 3, 1),
        (nx.complete_graph(24), 12, 1),
    ],
)
def test_larger_graphs(G: nx.Graph, r: int, s: int) -> None:
    check(*exported(network(G), r, s))


@pytest.mark.parametrize(
    ("G", "r", "s", "kind"),
    [
        (nx.complete_graph(1), 1, 1, b'"degree"'),
        (nx.complete_graph(40), 20, 40, b'"degree"'),
        (nx.complete_graph(41), 21, 1, b'"degree"'),
        (grown(60, 8, nx.complete_graph(16)), 8, 1, b'"growth"'),
        (grown(60, 8, nx.complete_graph(16)), 6, 3, b'"growth"'),
        (grown(60, 6, nx.gnp_random_graph(16, 0.8, seed=1)), 4, 3, b'"growth"'),
    ],
)
def test_degree_and_growth(G: nx.Graph, r: int, s: int, kind: bytes) -> None:
    graph = network(G)
    found = certificate(graph, r, s, "shortest")
    assert b'"kind":' + kind in found
    for version in VERSIONS:
        check(*export(graph.canonical_bytes(), found, version=version))


def test_growth_from_one_node() -> None:
    path = network(nx.path_graph(5))
    evidence = {"kind": "growth", "seed": [2], "order": [1, 3, 0, 4], "proof": {"kind": "degree"}}
    check(*export(path.canonical_bytes(), encode(path, 1, 1, rb.Verdict.ROBUST, (evidence, b""))))


def test_every_rule_of_a_refutation_is_exported() -> None:
    """Guarantees that sums of one and of two blockers, swaps and exempt-node counters stand in proofs checked above."""
    lines = exported(network(nx.gnp_random_graph(30, 0.5, seed=1)), 8)[1].decode().splitlines()
    counters = exported(network(nx.wheel_graph(5)), 1, 3)[1].decode()
    needs = {str(place) for place in range(2 + 30 + 1, 2 + 30 + 60 + 1)}
    swaps = [line for line in lines if line.startswith("red")]
    assert {len(needs.intersection(line.split())) for line in lines if line.startswith("pol")} == {2, 3}
    assert any(" 2 *" in line for line in lines)
    assert len(swaps) > 1
    assert all("x0 -> y0" in line for line in swaps)
    assert "q1 -> 0" in counters
    assert "rup 1 q1 >= 1 ;" in counters


@pytest.mark.parametrize("seed", range(30))
def test_states_settle_as_they_do_in_the_kernel(seed: int) -> None:
    """Asked about one node at a time, the kernel's rules come to the state that the kernel comes to, or contradict."""
    draw, contradictions, settled = random.Random(seed), 0, 0
    for _ in range(30):
        n = draw.randint(3, 9)
        G = nx.gnp_random_graph(n, draw.uniform(0.3, 1), seed=draw.randrange(10**6), directed=draw.random() < 0.5)
        model = Model.of(decode_graph(network(G).canonical_bytes()), draw.randint(1, 4), draw.randint(1, min(n, 4)))
        ours, kernels = Knowledge.of_all_pairs(n), State.of_all_pairs(n)
        for _ in range(draw.randint(0, 4)):
            sets, side, bit = draw.choice("TFP"), draw.randrange(2), 1 << draw.randrange(n)
            for state in (ours, kernels):
                getattr(state, sets)[side] ^= bit
        try:
            settle(model.question, kernels)
        except Contradiction:
            contradictions += 1
            with pytest.raises(Contradiction):
                Settling(model, model, Proof(model, SYNTAXES["3.0"]), []).settle(ours)
            continue
        settled += 1
        Settling(model, model, Proof(model, SYNTAXES["3.0"]), []).settle(ours)
        for name in ("C", "P", "F", "T", "left", "allowed"):
            assert getattr(ours, name) == getattr(kernels, name)
    assert contradictions
    assert settled


# The model says what the definition says


@pytest.mark.parametrize("graph", [*graphs(4), *digraphs(3)])
def test_the_model_of_r_robustness_has_the_violating_pairs_as_its_solutions(graph: rb.Digraph) -> None:
    names = [f"{side}{i}" for side in "xy" for i in range(graph.n)]
    for r in range(1, graph.n + 1):
        lines = Checker(Model.of(decode_graph(graph.canonical_bytes()), r, 1).text())
        for values in product((0, 1), repeat=2 * graph.n):
            named = dict(zip(names, values, strict=True))
            first, second = ({i for i in range(graph.n) if named[f"{side}{i}"]} for side in "xy")
            assert satisfies(lines, named) == is_violating(graph, first, second, r, 1)


@pytest.mark.parametrize("graph", [*graphs(4), *digraphs(3)])
def test_the_model_of_rs_robustness_has_violating_pairs_as_its_solutions(graph: rb.Digraph) -> None:
    """u, w, e, f are taken as they are meant, which is best for every inequality they occur in."""
    hears = [{u for u, v in graph.arcs() if v == i} for i in range(graph.n)]
    for r, s in product(range(1, graph.n + 1), range(2, graph.n + 1)):
        lines = Checker(Model.of(decode_graph(graph.canonical_bytes()), r, s).text())
        for sides in product((0, 1, 2), repeat=graph.n):
            sets = [{i for i in range(graph.n) if sides[i] == k} for k in (1, 2)]
            named = {}
            for names, members in zip(("xue", "ywf"), sets, strict=True):
                for i in range(graph.n):
                    exempt = i in members and len(hears[i] - members) >= r
                    named |= {f"{names[0]}{i}": i in members, f"{names[1]}{i}": i in members and not exempt}
                    named[f"{names[2]}{i}"] = exempt
            assert satisfies(lines, named) == is_violating(graph, *sets, r, s)


def satisfies(model: Checker, named: dict[str, int] | dict[str, bool]) -> bool:
    """Return whether the values satisfy every inequality of the model."""
    true = {2 * place + (not named[name]) for name, place in model.variables.items()}
    return all(
        sum(c for c, literal in constraint.terms if literal in true) >= constraint.degree
        for constraint in model.constraints.values()
    )


@pytest.mark.parametrize("s", [1, 2])
def test_solutions_of_the_smallest_models_exist_exactly_when_the_graph_is_not_robust(s: int) -> None:
    for graph in graphs(2):
        for r in (1, 2):
            model = Checker(Model.of(decode_graph(graph.canonical_bytes()), r, s).text())
            robust = brute_profile(graph).get(r, 0) >= s
            values = product((0, 1), repeat=len(model.variables))
            assert robust != any(satisfies(model, dict(zip(model.variables, row, strict=True))) for row in values)


def test_the_model_does_not_depend_on_the_evidence() -> None:
    graph = network(nx.complete_graph(7))
    assert exported(graph, 3, 2)[0] == exported(graph, 3, 2, evidence="shortest")[0]


# What is not a proof is rejected

QUESTIONS = [
    (network(nx.wheel_graph(5)), 2, 1, "refutation"),
    (network(nx.gnp_random_graph(9, 0.7, seed=4)), 3, 1, "refutation"),
    (network(nx.wheel_graph(5)), 2, 2, "refutation"),
    (network(nx.complete_graph(6)), 2, 4, "shortest"),
    (network(grown(9, 3, nx.complete_graph(5))), 2, 2, "shortest"),
]


def mutations(proof: str) -> Iterator[tuple[str, str]]:
    """Yield single changes to a proof, each with a word on what was done."""
    lines = proof.splitlines(keepends=True)
    for k, line in enumerate(lines):
        words = line.split()
        rule = words[0]

        def changed(place: int, word: str) -> str:
            spelled = " ".join([*words[:place], word, *words[place + 1 :]]) + "\n"  # noqa: B023 (used at once)
            return "".join([*lines[:k], spelled, *lines[k + 1 :]])  # noqa: B023

        yield f"line {k} dropped: {line}", "".join([*lines[:k], *lines[k + 1 :]])
        yield f"cut before line {k}", "".join(lines[:k])
        if rule in ("rup", "red"):
            place = words.index(">=") + 1
            yield f"degree of line {k}: {line}", changed(place, str(int(words[place]) + 1))
            if place > 2:
                yield f"literal of line {k}: {line}", changed(2, words[2][1:] if "~" in words[2] else "~" + words[2])
            if place > 2 and words[1] != "1":
                yield f"coefficient of line {k}: {line}", changed(1, "1")
        if rule == "pol":
            yield f"summand of line {k}: {line}", changed(1, str(int(words[1]) + 1))
            yield f"factor of line {k}: {line}", changed(2, f"{words[2]} 2 *")
        if "->" in words:
            place = words.index("->") + 1
            yield f"witness of line {k}: {line}", changed(place, "0" if words[place] == "1" else "1")


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_proof_is_rejected_without_one_of_its_steps(question: tuple[rb.Digraph, int, int, str], version: str) -> None:
    graph, r, s, evidence = question
    model, proof = exported(graph, r, s, version, evidence)
    lost = {
        what: text
        for what, text in mutations(proof.decode())
        if what.startswith(("line", "cut")) and "dropped: del" not in what
    }
    assert len(lost) > 10
    assert not [what for what, text in lost.items() if accepted(model, text.encode())]


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("part", ["degree", "literal", "coefficient", "witness", "summand", "factor"])
def test_steps_that_do_not_follow_are_rejected(part: str, version: str) -> None:
    """A changed step may follow still, and late in a proof anything does; but each kind is caught somewhere."""
    caught = 0
    for graph, r, s, evidence in QUESTIONS:
        model, proof = exported(graph, r, s, version, evidence)
        changes = [text for what, text in mutations(proof.decode()) if what.startswith(part)]
        caught += sum(not accepted(model, text.encode()) for text in changes)
    assert caught >= 2


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("question", QUESTIONS)
def test_nothing_refutes_a_model_with_a_solution(question: tuple[rb.Digraph, int, int, str], version: str) -> None:
    """Without "S2 holds a satisfied node", all nodes and the empty set are a solution, so no proof is right."""
    graph, r, s, evidence = question
    model, proof = exported(graph, r, s, version, evidence)
    lines = model.decode().splitlines()
    lines[4] = "1 x0 >= 0 ;"
    assert lines[3].startswith(("1 x0", "1 u0"))
    satisfiable = "\n".join(lines).encode()
    for what, text in [("nothing", proof.decode()), *mutations(proof.decode())]:
        assert not accepted(satisfiable, text.encode()), what


@pytest.mark.parametrize("version", VERSIONS)
def test_a_proof_of_another_graph_is_rejected(version: str) -> None:
    graph, other = nx.complete_graph(9), nx.complete_graph(9)
    other.remove_edges_from([(0, v) for v in range(1, 7)])
    _, proof = exported(network(graph), 3, 1, version)
    assert rb.robustness_profile(network(other)).get(3, 0) == 0
    assert not accepted(Model.of(decode_graph(network(other).canonical_bytes()), 3, 1).text().encode(), proof)


@pytest.mark.parametrize(
    "proof",
    [
        "",
        "pseudo-Boolean proof version 3.0\n",
        "pseudo-Boolean proof version 1.1\n",
        "pseudo-Boolean proof version 3.0\nf 13 ;\noutput NONE ;\nconclusion UNSAT : 1 ;\nend pseudo-Boolean proof ;\n",
        "pseudo-Boolean proof version 3.0\nf 13 ;\noutput NONE ;\nconclusion NONE ;\nend pseudo-Boolean proof ;\n",
        "pseudo-Boolean proof version 1.1\nf 13\n",
        "pseudo-Boolean proof version 1.1\nf 13\nc 1\n",
        "pseudo-Boolean proof version 1.1\nf 13\na >= 1 ;\nc 14\n",
        "pseudo-Boolean proof version 1.1\nf 13\nrup >= 1 ;\nc 14\n",
        "pseudo-Boolean proof version 9.9\nf 13 ;\n",
    ],
)
def test_empty_and_unfounded_proofs_are_rejected(proof: str) -> None:
    model, whole = exported(network(nx.cycle_graph(4)), 1)
    assert accepted(model, whole)
    assert not accepted(model, proof.encode())


def test_proof_is_bound_to_what_the_kernel_verified() -> None:
    wheel, cycle = network(nx.wheel_graph(5)), network(nx.cycle_graph(5))
    with pytest.raises(RejectedCertificate, match="another graph"):
        export(cycle.canonical_bytes(), certificate(wheel, 2, 1))
    with pytest.raises(RejectedCertificate):
        export(wheel.canonical_bytes(), certificate(wheel, 2, 1)[:-1])
    with pytest.raises(InvalidParameter, match="shows that it is not"):
        export(wheel.canonical_bytes(), certificate(wheel, 3, 1))
    made = blow_up(guaranteed(nx.cycle_graph(4)), 2)
    derived = certify_derivation(made.guarantee, [nx.cycle_graph(4)]).certificate
    with pytest.raises(InvalidParameter, match="a derivation has no VeriPB proof"):
        export(rb.Digraph.from_networkx(made.graph).canonical_bytes(), derived)
    with pytest.raises(InvalidParameter, match=r"one of 3\.0, 1\.1, not '2\.0'"):
        export(wheel.canonical_bytes(), certificate(wheel, 2, 1), version="2.0")


# A real VeriPB


@pytest.mark.filterwarnings("default:no veripb is on the PATH")
@pytest.mark.parametrize("question", [*QUESTIONS, (network(nx.gnp_random_graph(30, 0.5, seed=1)), 8, 1, "shortest")])
def test_a_third_party_agrees(question: tuple[rb.Digraph, int, int, str], tmp_path: Path) -> None:
    """VeriPB, where there is one, says what the checker here says; where there is none, the run's summary says so."""
    graph, r, s, evidence = question
    program = shutil.which("veripb")
    old = False
    if program is None:
        warnings.warn("no veripb is on the PATH: only tests/veripb/checker.py has read the proofs", stacklevel=1)
    else:
        run = subprocess.run([program, "--help"], capture_output=True, text=True, check=True)
        old = "--requireUnsat" in run.stdout
    model, proof = exported(graph, r, s, "1.1" if old else "3.0", evidence)
    lines = proof.decode().splitlines(keepends=True)
    for text, right in [(proof, True), ("".join([*lines[:3], *lines[4:]]).encode(), False), (b"", False)]:
        assert accepted(model, text) == right
        if program is not None:
            (tmp_path / "model.opb").write_bytes(model)
            (tmp_path / "proof.pbp").write_bytes(text)
            command = [program, *(["--requireUnsat"] if old else []), "model.opb", "proof.pbp"]
            run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
            verified = run.returncode == 0 and (old or "VERIFIED UNSATISFIABLE" in run.stdout)
            assert verified == right, run.stdout + run.stderr
