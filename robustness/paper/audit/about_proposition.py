"""Proposition 1 of the paper, sentence by sentence: its graph read literally, its proof, and a smaller graph."""

from __future__ import annotations

from collections.abc import Callable

import networkx as nx

from robustness.constructions.counterexamples import two_f_robust_counterexample
from robustness.constructions.families import complete
from robustness.decision.front import check_rs_robustness
from robustness.digraph import Digraph, as_digraph
from robustness.paper.audit.claims import Claim, Outcome, holding, robust, trapped
from robustness.simulation.adversaries import Alternating
from robustness.simulation.attacks import attack_from_trap
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario
from robustness.simulation.schedules import Schedule
from robustness.simulation.topology import Topology
from robustness.threat_models.results import AttackSets
from robustness.traps import find_trap, is_trap

__all__ = ["CLAIMS"]

_F = (1, 2, 3)


def _literal_proposition(holds: Callable[[Digraph, int], bool]) -> Outcome:
    """Try a claim about the literal graph for three f."""
    graphs = {f: as_digraph(two_f_robust_counterexample(f)) for f in _F}
    bad = [f for f, graph in graphs.items() if not holds(graph, f)]
    good = [f for f in graphs if f not in bad]
    how = "the literal graph, f = 1, 2, 3"
    if not bad:
        return Outcome("holds", how)
    note = f"not for f = {', '.join(map(str, bad))}"
    if good:
        note += f"; for f = {', '.join(map(str, good))} it does"
    return Outcome("fails", how, note, graphs[bad[0]])


def _literal_is_2f_robust() -> Outcome:
    return _literal_proposition(lambda graph, f: check_rs_robustness(graph, 2 * f).decided())


def _literal_is_robust() -> Outcome:
    return _literal_proposition(lambda graph, f: check_rs_robustness(graph, f + 1, f + 1).decided())


def _literal_degree() -> Outcome:
    return _literal_proposition(lambda graph, f: int(graph.in_degrees.min()) >= 2 * f + 1)


def _low_degree_without_trap(graph: Digraph) -> str | None:
    least = int(graph.in_degrees.min())
    for f in _F:
        if least <= 2 * f and not trapped(graph, f):
            return f"in-degree {least} <= {2 * f}, without a trap for f = {f}"
    return None


def _low_degree() -> Outcome:
    found = holding(_low_degree_without_trap)
    return found if found.result == "fails" else Outcome("holds", found.how, "one such vehicle is enough, f >= 1")


def _least_degree_of_robust_graphs() -> Outcome:
    """A 2f-robust graph has in-degrees of at least 2f, and for some it is exactly 2f."""

    def refute(graph: Digraph) -> str | None:
        least = int(graph.in_degrees.min())
        return next((f"{2 * f}-robust, in-degree {least}" for f in _F if robust(graph, 2 * f) and least < 2 * f), None)

    found = holding(refute)
    if found.result == "fails":
        return found
    attained = holding(
        lambda graph: (
            "attained: 2-robust, least in-degree 2" if robust(graph, 2) and int(graph.in_degrees.min()) == 2 else None
        )
    )
    return Outcome("holds", found.how, f"{attained.note}; no less is possible, f >= 1", attained.counterexample)


def _some_graph() -> Outcome:
    """The smaller graph, and a vehicle that hears 2f + 1 others and is heard by nobody: least in-degree exactly."""
    for f in _F:
        graph: nx.DiGraph = two_f_robust_counterexample(f, "corrected").to_directed()
        trap = graph.graph["trap"]
        graph.add_edges_from((u, "listener") for u in range(2 * f + 1))
        fits = check_rs_robustness(graph, 2 * f).decided() and min(d for _, d in graph.in_degree()) == 2 * f + 1
        attack = attack_from_trap(graph, f, trap["M"], trap["S1"], trap["S2"])
        if not (fits and attack.run(100).exact):
            return Outcome("fails", "search and simulation", f"f = {f}", as_digraph(graph))
    note = "K_{3f+2} minus a matching of f+1 edges, and one vehicle that hears 2f+1 others: all as claimed, and split"
    return Outcome("holds", "search and simulation, f = 1, 2, 3", note)


def _corrected_proposition() -> Outcome:
    for f in _F:
        graph = as_digraph(two_f_robust_counterexample(f, "corrected"))
        fits = check_rs_robustness(graph, 2 * f).decided() and check_rs_robustness(graph, f + 1, f + 1).decided()
        if not (fits and trapped(graph, f) and int(graph.in_degrees.min()) >= 2 * f + 1):
            return Outcome("fails", "f = 1, 2, 3", f"f = {f}", graph)
    found = find_trap(two_f_robust_counterexample(1, "corrected"), 1)
    sets = AttackSets(1, 2, False, found.M, found.S1, found.S2)
    wheel = as_digraph(two_f_robust_counterexample(1, "corrected"))
    return Outcome("holds", "search, f = 1, 2, 3", "for f = 1 it is the wheel on 5 nodes", wheel, sets)


def _groups(f: int) -> tuple[nx.DiGraph, dict[str, frozenset[int]]]:
    graph = two_f_robust_counterexample(f)
    named = nx.get_node_attributes(graph, "group")
    return graph, {name: frozenset(v for v in graph if named[v] == name) for name in ("G1", "G2", "G3", "G4")}


def _malicious_as_printed() -> Outcome:
    graph, group = _groups(1)
    printed = is_trap(graph, 1, group["G2"], group["G3"], group["G4"])
    meant = is_trap(graph, 1, group["G4"], group["G3"], group["G2"])
    sets = AttackSets(1, 2, False, group["G4"], group["G3"], group["G2"])
    result = "holds" if printed else "holds corrected" if meant else "fails"
    note = "M = G2 is no trap; M = G4, which the proof moves, is one for G3 and G2"
    return Outcome(result, "the definition of a trap, f = 1", note, as_digraph(graph), sets)


def _first_group() -> Outcome:
    wrong = [f for f in _F if not check_rs_robustness(complete(4 * f), 2 * f).decided()]
    return Outcome("fails" if wrong else "holds", "search, f = 1, 2, 3", f"f = {wrong}" if wrong else "")


def _growing() -> Outcome:
    """Is the part on G1 and G2 2f-robust; and how far does Lemma 1 (vii) lead when G4 comes first?"""
    printed, meant, smallest = True, True, None
    for f in _F:
        graph, group = _groups(f)
        part = graph.subgraph(group["G1"] | group["G2"])
        if not check_rs_robustness(part, 2 * f).decided():
            printed, smallest = False, smallest or as_digraph(part)
        present = group["G1"]
        for name in ("G4", "G3", "G2"):
            for v in sorted(group[name]):
                meant &= len(present.intersection(graph.predecessors(v))) >= 2 * f
                present |= {v}
    note = (
        "G2 hears only f vehicles of G1, and G1 with G2 is not 2f-robust; item (iv) is about spanning trees. "
        "Meant is (vii): G4 first, then G3, then G2, each vehicle hears 2f present ones"
    )
    result = "holds" if printed else "holds corrected" if meant else "fails"
    return Outcome(result, "search and Lemma 1 (vii), f = 1, 2, 3", note, smallest)


def _delays_as_printed() -> Outcome:
    """The delays of the proof are those of links from V2, so everybody sees V4 without delay, going to and fro."""
    ends = []
    for f in _F:
        graph, group = _groups(f)
        attack = attack_from_trap(graph, f, group["G4"], group["G3"], group["G2"])
        scenario = Scenario(Topology((attack.graph,)), f, adversary=Alternating(0.0, 100.0), schedule=Schedule())
        ends.append(simulate(scenario, [attack.start()])[0].verdict.value)
    note = (
        "as printed they are those of links from V2, which is at rest: then nobody is deceived "
        f"({', '.join(f'f = {f}: {end}' for f, end in zip(_F, ends, strict=True))}). "
        "Links from V4 are meant; with them it splits"
    )
    result = "holds" if set(ends) == {"split"} else "holds corrected"
    return Outcome(result, "simulation: the literal graph, f = 1, 2, 3", note)


def _formation() -> Outcome:
    """The split with a formation: normal vehicles stay b - a away from where their formation wants them."""
    for f in _F:
        graph, group = _groups(f)
        attack = attack_from_trap(graph, f, group["G4"], group["G3"], group["G2"])
        offsets = {v: 8.0 * v for v in graph}
        outcome = attack.run(200, offsets=offsets)
        if not outcome.exact or outcome.spread != 100.0:
            return Outcome("fails", "simulation", f"f = {f}, spread {outcome.spread}")
    note = "distances that fit: the start a - delta_il/2 depends on i and l, so it needs one delta for all such pairs"
    return Outcome("holds", "simulation: the literal graph in a formation, f = 1, 2, 3", note)


#: In the order of the paper.
CLAIMS: tuple[Claim, ...] = (
    Claim("before Proposition 1", "the graph of four cliques is 2f-robust", _literal_is_2f_robust),
    Claim("before Proposition 1", "the least degree of a 2f-robust graph is 2f", _least_degree_of_robust_graphs),
    Claim("before Proposition 1", "the least degree of the graph of four cliques is 2f+1 or more", _literal_degree),
    Claim(
        "before Proposition 1",
        "agreement is impossible when more than two vehicles have only 2f neighbours",
        _low_degree,
    ),
    Claim(
        "Proposition 1",
        "some 2f-robust network with least degree 2f+1 does not reach agreement",
        _some_graph,
    ),
    Claim(
        "Proposition 1",
        "K_{3f+2} minus a matching of f+1 edges has all properties claimed, and a trap",
        _corrected_proposition,
        False,
    ),
    Claim("Proposition 1, proof", "the graph of four cliques is (f+1,f+1)-robust", _literal_is_robust),
    Claim("Proposition 1, proof", "the malicious vehicles are those of G2", _malicious_as_printed),
    Claim("Proposition 1, proof", "G1 is 2f-robust by Lemma 1 (v)", _first_group),
    Claim("Proposition 1, proof", "adding G2, then G3 and G4, keeps it 2f-robust by Lemma 1 (iv)", _growing),
    Claim("Proposition 1, proof", "the delays that show each group a face of its own", _delays_as_printed),
    Claim("Proposition 1, proof", "the groups stay delta + (b - a) apart instead of delta", _formation),
)
