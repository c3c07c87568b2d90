"""Claims about the paper's notions and examples: connectivity, bounds on malicious sets, links, windows, five nodes."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import networkx as nx

from robustness.connectivity import smallest_separation
from robustness.constructions.counterexamples import FIVE_NODE_READINGS, five_node_figure
from robustness.constructions.lemma_1 import profile
from robustness.constructions.random_families import erdos_renyi
from robustness.decision.front import check_rs_robustness, determine_robustness
from robustness.digraph import Digraph, as_digraph
from robustness.paper.audit.claims import (
    GRAPHS,
    Claim,
    Outcome,
    example,
    holding,
    marked,
    robust,
    sharper,
    trapped,
)
from robustness.spelled import counted
from robustness.threat_models.results import AttackSets
from robustness.time_varying import TimeVaryingGraph, check_joint_robustness
from robustness.traps.question import obeys_bound

__all__ = ["CLAIMS"]

_LARGEST_F = 3


def _range_of_s(graph: Digraph) -> str | None:
    table = profile(graph)
    return f"s_max = {table[1:]}" if graph.n > 2 and graph.n - 1 in table[1:] else None


def _weakly_connected_without_trap(graph: Digraph) -> str | None:
    for f in range(1, _LARGEST_F + 1):
        if not trapped(graph, f) and (graph.n <= 2 * f + 1 or smallest_separation(graph, 2 * f + 1) is not None):
            return f"no trap for f = {f}, but not {2 * f + 1}-connected"
    return None


def _connectivity() -> Outcome:
    """Is (2f+1)-connectivity needed by MSR rules too? In step it is not; with delays it is."""
    with_delays = holding(_weakly_connected_without_trap, digraphs=0)
    in_step = holding(_weakly_connected_and_robust, digraphs=0)
    if with_delays.counterexample is not None or in_step.counterexample is None:
        return Outcome("fails", with_delays.how, with_delays.note or "no such graph", with_delays.counterexample)
    note = (
        "of algorithms that find out who lies. MSR rules in step need less: "
        f"{in_step.note}. With delays they need it: all graphs without a trap are (2f+1)-connected"
    )
    return Outcome("holds corrected", with_delays.how, note, in_step.counterexample)


def _weakly_connected_and_robust(graph: Digraph) -> str | None:
    """A graph, not complete, that survives one liar in step although it is not 3-connected."""
    complete_ = graph.arc_count == graph.n * (graph.n - 1)
    if complete_ or graph.n < 4 or not robust(graph, 2, 2) or smallest_separation(graph, 3) is None:
        return None
    return f"(2,2)-robust, so f = 1 is survived in step, on {counted(graph.n, 'node')}, and not 3-connected"


def _connected_and_trapped(graph: Digraph) -> str | None:
    if graph.directed or graph.n < 4 or smallest_separation(graph, 3) is not None or not trapped(graph, 1):
        return None
    return "3-connected, but for f = 1 it has a trap"


def _total_is_local(graph: Digraph) -> str | None:
    for f in range(graph.n + 1):
        for size in range(f + 1):
            for bad in combinations(range(graph.n), size):
                if not obeys_bound(graph, frozenset(bad), f, local=True):
                    return f"M = {set(bad)} is {f}-total, but not {f}-local"
    return None


def _cut_of_complete(graph: Digraph) -> str | None:
    """A complete graph stays strongly connected whatever is removed; every other graph can be cut."""
    complete_ = graph.arc_count == graph.n * (graph.n - 1)
    cuttable = any(
        not _strongly_connected(graph, frozenset(kept))
        for size in range(1, graph.n + 1)
        for kept in combinations(range(graph.n), size)
    )
    return None if cuttable != complete_ else f"complete: {complete_}, can be cut: {cuttable}"


def _strongly_connected(graph: Digraph, kept: frozenset[int]) -> bool:
    """Return whether each kept node reaches each other within ``kept``: nobody escapes a closed set."""
    heard = {i: kept.intersection(graph.in_neighbours(i).tolist()) for i in kept}
    for start in kept:
        seen, waiting = {start}, [start]
        while waiting:
            new = heard[waiting.pop()] - seen
            seen |= new
            waiting += new
        if len(seen) < len(kept):
            return False
    return True


def _only_k5() -> Outcome:
    found = holding(_only_complete)
    wheel = five_node_figure()
    wheel.add_edge(1, 3)
    enough = "; one link more makes the wheel 3-robust" if check_rs_robustness(wheel, 3).decided() else ""
    return replace(found, note=f"{found.note}{enough}")


def _more_restrictive(graph: Digraph) -> str | None:
    table = profile(graph)
    return next((f"{r}-robust, but not ({r},2)-robust" for r in range(2, len(table)) if table[r] == 1), None)


def _only_complete(graph: Digraph) -> str | None:
    if graph.n != 5 or not robust(graph, 3) or graph.arc_count == 20:
        return None
    return f"K_5 without {(20 - graph.arc_count) // 2} of its links is 3-robust"


def _every_step_robust() -> Outcome:
    """K_5, its links dealt out over two steps: 3-robust jointly, at no step."""
    edges = sorted(nx.complete_graph(5).edges)
    star, rest = (nx.Graph(links) for links in ([e for e in edges if 0 in e], [e for e in edges if 0 not in e]))
    rest.add_node(0)
    sequence = TimeVaryingGraph([star, rest], period=2)
    jointly = check_joint_robustness(sequence, 3).window
    steps = [determine_robustness(graph).r for graph in (star, rest)]
    holds_ = jointly == 2 and max(steps) < 3
    over = counted(jointly or 0, "step")
    note = f"K_5 as a star and the rest in turn: jointly 3-robust over {over}, r* at most {max(steps)} at each"
    return Outcome("holds" if holds_ else "fails", "search: one periodic network", note)


def _sequences() -> list[list[list[tuple[int, int]]]]:
    """Return two digraphs on three nodes, for every third pair of them; they take turns."""
    arcs = [(u, v) for u in range(3) for v in range(3) if u != v]
    steps = [[arc for k, arc in enumerate(arcs) if code >> k & 1] for code in range(1 << len(arcs))]
    return [[first, second] for first, second in combinations(steps[::3], 2)]


def _longer_windows() -> Outcome:
    """What holds over every l steps holds over every l + 1: unions only grow."""
    tried = _sequences()[::6]
    for steps in tried:
        sequence = TimeVaryingGraph.from_arcs(range(3), [*steps, []], period=3)
        for r in (1, 2):
            least = check_joint_robustness(sequence, r).window
            for length in range(1, 5):
                holds_ = check_joint_robustness(sequence, r, window=length).decided()
                if holds_ != (least is not None and length >= least):
                    return Outcome("fails", "search", f"{steps}, then nothing: r = {r}, {counted(length, 'step')}")
    how = f"search: {len(tried)} periodic sequences of three digraphs on 3 nodes, the last one empty"
    return Outcome("holds", how, "so the least l decides whether some l <= tau will do")


def _joint_trees() -> Outcome:
    """Jointly 1-robust if and only if the union of a period has a spanning tree."""
    for first, second in _sequences():
        sequence = TimeVaryingGraph.from_arcs(range(3), [first, second], period=2)
        union = nx.DiGraph([*first, *second])
        union.add_nodes_from(range(3))
        rooted = any(len(nx.descendants(union, v)) == 2 for v in union)
        if (check_joint_robustness(sequence, 1).window is not None) != rooted:
            return Outcome("fails", "search", f"steps {first} and {second}")
    return Outcome("holds", f"search: {len(_sequences())} periodic sequences of two digraphs on 3 nodes", "f = 0")


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


def _five_nodes() -> Outcome:
    for reading in FIVE_NODE_READINGS:
        graph = five_node_figure(reading)
        if not check_rs_robustness(graph, 2, 2).decided() or check_rs_robustness(graph, 3).decided():
            return Outcome("fails", "the definition", f"reading {reading}", as_digraph(graph))
    trap = five_node_figure().graph["trap"]
    M, S1, S2 = (frozenset(trap[name]) for name in ("M", "S1", "S2"))
    sets = AttackSets(1, 2, False, M, S1, S2)
    note = f"the arcs are not in the text; it holds for the readings {', '.join(FIVE_NODE_READINGS)}"
    return Outcome("holds", "the definition", note, as_digraph(five_node_figure()), sets)


def _large_random_graphs() -> Outcome:
    values = []
    for n in (10, 20, 30):
        graph = erdos_renyi(n, 0.5, seed=1)
        r = next(r for r in range(1, n) if not check_rs_robustness(graph, r + 1).decided())
        values.append(f"{r} at n = {n}")
    return Outcome("not checkable", "one draw each", f"a limit; G(n, 1/2), seed 1, has r* = {', '.join(values)}")


#: Claims of this kind.
CLAIMS: tuple[Claim, ...] = (
    Claim(
        "Definition 1",
        "r and s below n; item (v) of Lemma 1 lets s be n",
        lambda: sharper("holds corrected", _range_of_s, "(r,n-1) and (r,n) are one property"),
    ),
    Claim(
        "Introduction",
        "f malicious vehicles need (2f+1)-connectivity (said of other algorithms)",
        _connectivity,
    ),
    Claim(
        "Introduction",
        "connectivity is not enough for MSR algorithms",
        lambda: marked(example(_connected_and_trapped)),
    ),
    Claim(
        "Section 2.1",
        "vertex connectivity: the least number of nodes whose removal leaves it not strongly connected",
        lambda: sharper(
            "holds corrected",
            _cut_of_complete,
            "complete graphs, and no others, stay connected whatever is removed: by convention n - 1",
            graphs=5,
        ),
    ),
    Claim(
        "Definitions 3 and 4",
        "every f-total malicious set is f-local",
        lambda: holding(_total_is_local, graphs=5, digraphs=4),
        False,
    ),
    Claim("before Corollary 2", "robustness at every single step is more than is needed", _every_step_robust),
    Claim("Definition 6", "jointly r-robust over every l steps: then over every l+1 too", _longer_windows, False),
    Claim("Section 3.2, normal vehicles", "Corollary 2 without liars asks for jointly spanning trees", _joint_trees),
    Claim("Section 4", "K_5 is the only 3-robust graph with 5 nodes; adding links to the figure leads to it", _only_k5),
    Claim("Appendix", "(r,s)-robustness is more restrictive than r-robustness", lambda: example(_more_restrictive)),
    Claim(
        "Section 3.2, added links",
        "extra links do not matter under the f-total model",
        lambda: holding(_fewer_arcs, graphs=GRAPHS - 1),
    ),
    Claim(
        "Section 3.2, added links",
        "under the f-local model an extra link may exceed f",
        lambda: example(_local_bound_broken),
    ),
    Claim("5-node figure", "it is (2,2)-robust but not 3-robust", _five_nodes),
    Claim("Appendix", "large random graphs become robust", _large_random_graphs),
    Claim(
        "Appendix",
        "checking robustness is difficult",
        lambda: Outcome("not checkable", "literature", "coNP-complete (Zhang, Fata, Sundaram 2015)"),
    ),
)
