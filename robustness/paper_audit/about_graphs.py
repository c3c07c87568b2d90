"""Claims that are statements about graphs: decided by search over all small ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from robustness.checking import check_rs_robustness, determine_robustness
from robustness.constructions.counterexamples import FIVE_NODE_READINGS, five_node_figure, two_f_robust_counterexample
from robustness.constructions.families import complete
from robustness.constructions.lemma_1 import profile
from robustness.constructions.random_families import erdos_renyi
from robustness.constructions.traps import is_trap
from robustness.definitions import r_reachable_ids
from robustness.digraph import Digraph, as_digraph
from robustness.graph_search.connectivity import smallest_separation
from robustness.paper_audit.claims import GRAPHS, Claim, Outcome, failing, holding, small_graphs
from robustness.results import Verdict
from robustness.threat_models.results import AttackSets
from robustness.trap_search import find_trap

__all__ = ["CLAIMS"]

_LARGEST_F = 3


@cache
def _trapped(graph: Digraph, f: int, local: bool = False) -> bool:
    return find_trap(graph, f, local=local).decided()


def _robust(graph: Digraph, r: int, s: int = 1) -> bool:
    table = profile(graph)
    return r < len(table) and table[r] >= s


def _range_of_s(graph: Digraph) -> str | None:
    table = profile(graph)
    return f"s_max = {table[1:]}" if graph.n > 2 and graph.n - 1 in table[1:] else None


def _incoming_anywhere(graph: Digraph) -> str | None:
    """The proof's reading of X without "from outside": all nodes of in-degree f + 1 or more."""
    for f in range(1, graph.n):
        pair = check_rs_robustness(graph, f + 1, f + 1).witness if f < graph.n else None
        if pair is None:
            continue
        sides = [graph.ids(side) for side in pair]
        literal = [i for side in sides for i in side if graph.in_degrees[i] >= f + 1]
        meant = sum(len(r_reachable_ids(graph, side, f + 1)) for side in sides)
        if len(literal) > f:
            return f"f = {f}: {len(literal)} nodes have {f + 1} incoming links, {meant} have them from outside"
    return None


def _trap_implied_by_violation(graph: Digraph) -> str | None:
    for f in range(_LARGEST_F + 1):
        if f < graph.n and not _robust(graph, f + 1, f + 1) and not _trapped(graph, f):
            return f"f = {f}: not ({f + 1},{f + 1})-robust, without a trap"
    return None


def _robust_and_trapped(graph: Digraph) -> str | None:
    for f in range(1, _LARGEST_F + 1):
        if _robust(graph, f + 1, f + 1) and _trapped(graph, f):
            return f"f = {f}: ({f + 1},{f + 1})-robust, with a trap"
    return None


def _twice_robust_and_trapped(local: bool) -> Outcome:
    def refute(graph: Digraph) -> str | None:
        for f in range(_LARGEST_F + 1):
            if _robust(graph, 2 * f + 1) and _trapped(graph, f, local):
                return f"{2 * f + 1}-robust, with a trap for f = {f}"
        return None

    return holding(refute)


def _gap_without_trap() -> Outcome:
    for graph in small_graphs():
        for f in range(1, _LARGEST_F + 1):
            if not _robust(graph, 2 * f + 1) and not _trapped(graph, f):
                note = f"f = {f}: not {2 * f + 1}-robust, and no trap either: nobody knows"
                return Outcome("open", "search, smallest first", note, graph)
    return Outcome("holds", "search, smallest first")


def _low_degree_without_trap(graph: Digraph) -> str | None:
    least = int(graph.in_degrees.min())
    for f in range(1, _LARGEST_F + 1):
        if least <= 2 * f and not _trapped(graph, f):
            return f"in-degree {least} <= {2 * f}, without a trap for f = {f}"
    return None


def _weakly_connected_without_trap(graph: Digraph) -> str | None:
    if graph.directed:
        return None
    for f in range(1, _LARGEST_F + 1):
        if not _trapped(graph, f) and (graph.n <= 2 * f + 1 or smallest_separation(graph, 2 * f + 1) is not None):
            return f"no trap for f = {f}, but not {2 * f + 1}-connected"
    return None


def _fewer_arcs(graph: Digraph) -> str | None:
    """Adding one arc never lowers any s_max(r)."""
    table = profile(graph)
    labels, arcs = graph.labels, [(graph.labels[u], graph.labels[v]) for u, v in graph.arcs()]
    present = set(arcs)
    for u in labels:
        for v in labels:
            if u == v or (u, v) in present:
                continue
            more = profile(Digraph(labels, [*arcs, (u, v)]))
            if any(a > b for a, b in zip(table, more, strict=True)):
                return f"with {u}→{v} s_max falls from {table[1:]} to {more[1:]}"
    return None


def _local_bound_broken(graph: Digraph) -> str | None:
    """A malicious set that is 1-local until one of its members adds a link."""
    for a in range(graph.n):
        for b in range(a):
            bad = {a, b}
            others = [i for i in range(graph.n) if i not in bad]
            heard = {i: bad.intersection(graph.in_neighbours(i).tolist()) for i in others}
            if others and all(len(each) <= 1 for each in heard.values()) and any(len(heard[i]) == 1 for i in others):
                hit = next(i for i in others if len(heard[i]) == 1)
                return f"M = {{{b}, {a}}} is 1-local; with one more link from M, {hit} hears both"
    return None


def _literal_proposition(holds: Callable[[Digraph, int], bool]) -> Outcome:
    """Try a claim about the literal graph of Proposition 1 for three f."""
    graphs = {f: as_digraph(two_f_robust_counterexample(f)) for f in (1, 2, 3)}
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


def _malicious_as_printed() -> Outcome:
    graph = two_f_robust_counterexample(1)
    group = {name: [v for v, data in graph.nodes(data=True) if data["group"] == name] for name in ("G2", "G3", "G4")}
    printed = is_trap(graph, 1, group["G2"], group["G3"], group["G4"])
    meant = is_trap(graph, 1, group["G4"], group["G3"], group["G2"])
    sets = AttackSets(1, 2, False, frozenset(group["G4"]), frozenset(group["G3"]), frozenset(group["G2"]))
    result = "holds" if printed else "holds corrected" if meant else "fails"
    note = "M = G2 is no trap; M = G4, which the proof moves, is one for G3 and G2"
    return Outcome(result, "the definition of a trap, f = 1", note, as_digraph(graph), sets)


def _corrected_proposition() -> Outcome:
    for f in (1, 2, 3):
        graph = as_digraph(two_f_robust_counterexample(f, "corrected"))
        fits = check_rs_robustness(graph, 2 * f).decided() and check_rs_robustness(graph, f + 1, f + 1).decided()
        if not (fits and _trapped(graph, f) and int(graph.in_degrees.min()) >= 2 * f + 1):
            return Outcome("fails", "f = 1, 2, 3", f"f = {f}", graph)
    found = find_trap(two_f_robust_counterexample(1, "corrected"), 1)
    sets = AttackSets(1, 2, False, found.M, found.S1, found.S2)
    wheel = as_digraph(two_f_robust_counterexample(1, "corrected"))
    return Outcome("holds", "search, f = 1, 2, 3", "for f = 1 it is the wheel on 5 nodes", wheel, sets)


def _five_nodes() -> Outcome:
    for reading in FIVE_NODE_READINGS:
        graph = five_node_figure(reading)
        if not check_rs_robustness(graph, 2, 2).decided() or check_rs_robustness(graph, 3).decided():
            return Outcome("fails", "the definition", f"reading {reading}", as_digraph(graph))
    trap = five_node_figure().graph["trap"]
    sets = AttackSets(1, 2, False, *(frozenset(trap[name]) for name in ("M", "S1", "S2")))
    note = f"the arcs are not in the text; it holds for the readings {', '.join(FIVE_NODE_READINGS)}"
    return Outcome("holds", "the definition", note, as_digraph(five_node_figure()), sets)


def _and_more(result: str, refute: Callable[[Digraph], str | None], sharper: str) -> Outcome:
    """Return ``result`` with a sharper statement, when no small graph refutes that; else "fails"."""
    found = holding(refute)
    return found if found.counterexample is not None else Outcome(result, found.how, sharper)


def _large_random_graphs() -> Outcome:
    values = []
    for n in (10, 20, 30):
        found = determine_robustness(erdos_renyi(n, 0.5, seed=1))
        values.append(f"{found.r} at n = {n}" if found.verdict is Verdict.DETERMINED else f"unknown at n = {n}")
    return Outcome("not checkable", "one draw each", f"a limit; G(n, 1/2), seed 1, has r* = {', '.join(values)}")


def _complete_graphs() -> Outcome:
    """K_{3f+1} is between the conditions and has no trap."""
    for f in (1, 2, 3):
        graph = as_digraph(complete(3 * f + 1))
        if not _robust(graph, f + 1, f + 1) or _robust(graph, 2 * f + 1) or _trapped(graph, f):
            return Outcome("fails", "search, f = 1, 2, 3", f"f = {f}", graph)
    return Outcome("holds", "search, f = 1, 2, 3", "the smallest is K_4 with f = 1", as_digraph(complete(4)))


#: In the order of the paper.
CLAIMS: tuple[Claim, ...] = (
    Claim(
        "Definition 1",
        "r and s below n; item (v) of Lemma 1 lets s be n",
        lambda: _and_more("holds corrected", _range_of_s, "(r,n-1) and (r,n) are one property"),
    ),
    Claim(
        "Theorem 1, proof",
        "X are the nodes with at least f+1 incoming links",
        lambda: failing(_incoming_anywhere, "it must be links from outside the set", "holds corrected"),
    ),
    Claim(
        "Theorem 1",
        "(f+1,f+1)-robustness is necessary under delays",
        lambda: holding(_trap_implied_by_violation),
    ),
    Claim(
        "Theorem 1",
        "(f+1,f+1)-robustness suffices under delays (nobody says so; the gap)",
        lambda: failing(_robust_and_trapped, "a trap splits it"),
        False,
    ),
    Claim(
        "Theorem 1",
        "(2f+1)-robust graphs have no trap: sufficiency does not contradict the sharper condition",
        lambda: _twice_robust_and_trapped(local=False),
        False,
    ),
    Claim(
        "Theorem 1",
        "every graph is either (2f+1)-robust or has a trap: the gap would be closed",
        _gap_without_trap,
        False,
    ),
    Claim("Theorem 1", "K_n with n = 3f+1 lies in the gap and has no trap", _complete_graphs, False),
    Claim("before Proposition 1", "the graph of four cliques is 2f-robust", _literal_is_2f_robust),
    Claim("Proposition 1", "its least degree is 2f+1", _literal_degree),
    Claim("Proposition 1, proof", "it is (f+1,f+1)-robust", _literal_is_robust),
    Claim("Proposition 1, proof", "the malicious vehicles are those of G2", _malicious_as_printed),
    Claim(
        "Proposition 1",
        "K_{3f+2} minus a matching of f+1 edges has all properties claimed, and a trap",
        _corrected_proposition,
        False,
    ),
    Claim(
        "before Proposition 1",
        "agreement is impossible when more than two vehicles have only 2f neighbours",
        lambda: _and_more("holds", _low_degree_without_trap, "one such vehicle is enough, f >= 1"),
    ),
    Claim(
        "Introduction",
        "f malicious vehicles need (2f+1)-connectivity (said of other algorithms)",
        lambda: _and_more("holds", _weakly_connected_without_trap, "graphs without a trap have it"),
    ),
    Claim(
        "Corollary 1",
        "(2f+1)-robust graphs have no f-local trap either",
        lambda: _twice_robust_and_trapped(local=True),
        False,
    ),
    Claim(
        "Section 3.2, added links",
        "extra links do not matter under the f-total model",
        lambda: holding(_fewer_arcs, graphs=GRAPHS - 1),
    ),
    Claim(
        "Section 3.2, added links",
        "under the f-local model an extra link may exceed f",
        lambda: Outcome(
            "holds", "search, smallest first", (found := holding(_local_bound_broken)).note, found.counterexample
        ),
    ),
    Claim("5-node figure", "it is (2,2)-robust but not 3-robust", _five_nodes),
    Claim("Appendix", "large random graphs become robust", _large_random_graphs),
    Claim(
        "Appendix",
        "checking robustness is difficult",
        lambda: Outcome("not checkable", "literature", "coNP-complete (Zhang, Fata, Sundaram 2015)"),
    ),
)
