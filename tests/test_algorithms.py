"""Every algorithm of the registry gives the answer of the definition, with a pair that anybody can check."""

from __future__ import annotations

import importlib
import inspect
import math
import time
from collections import Counter
from functools import cache
from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness import ALGORITHMS, Digraph, Verdict
from robustness.answers import Answer
from robustness.decision.algorithms import OPTIONS, transform
from robustness.limits import Limits
from tests.oracles import brute_profile, digraphs, graphs, is_violating, labelled_digraphs

NO_LIMITS = Limits()
#: Those that answer in well under a millisecond on the smallest graphs, so that all labellings can be tried.
FAST = ("transform", "subset-search")
SOLVERS = ("milp", "cp-sat")

every_algorithm = pytest.mark.parametrize("name", ALGORITHMS)


@cache
def profile_of(graph: Digraph) -> dict[int, int]:
    return brute_profile(graph)


def assert_decides(name: str, graph: Digraph, r: int, s: int, s_max: int) -> None:
    answer = ALGORITHMS[name](graph, r, s, NO_LIMITS)
    assert_right(answer, graph, r, s, s_max)


def assert_right(answer: Answer, graph: Digraph, r: int, s: int, s_max: int) -> None:
    question = f"({r},{s}) of {graph!r} with arcs {list(graph.arcs())}"
    assert answer.verdict is (Verdict.ROBUST if s <= s_max else Verdict.NOT_ROBUST), question
    if answer.verdict is Verdict.NOT_ROBUST:
        assert answer.pair is not None
        assert is_violating(graph, *answer.pair, r, s), f"{answer.pair} for {question}"


def assert_decides_everything(name: str, graph: Digraph) -> None:
    for r, s_max in profile_of(graph).items():
        for s in range(1, graph.n + 1):
            assert_decides(name, graph, r, s, s_max)


def assert_decides_boundary(name: str, graph: Digraph, table: dict[int, int]) -> None:
    """Try the greatest s that holds and the least that does not: the verdict is monotone in s."""
    for r, s_max in table.items():
        for s in {max(s_max, 1), min(s_max + 1, graph.n)}:
            assert_decides(name, graph, r, s, s_max)


def test_oracle_knows_the_number_of_graphs():
    assert [len(digraphs(n)) for n in range(1, 5)] == [1, 3, 16, 218]
    assert [len(graphs(n)) for n in range(1, 8)] == [1, 2, 4, 11, 34, 156, 1044]


@every_algorithm
@pytest.mark.parametrize("n", [2, 3, 4])
def test_all_digraphs(name, n):
    for graph in digraphs(n):
        assert_decides_everything(name, graph)


@every_algorithm
@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_all_graphs(name, n):
    for graph in graphs(n):
        assert_decides_everything(name, graph)


@pytest.mark.parametrize("name", FAST)
def test_all_labelled_digraphs(name):
    for n in (2, 3, 4):
        for graph in labelled_digraphs(n):
            assert_decides_boundary(name, graph, profile_of(graph))


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in ALGORITHMS if name not in FAST])
def test_all_labelled_digraphs_by_the_slower_algorithms(name):
    for graph in labelled_digraphs(4):
        assert_decides_boundary(name, graph, profile_of(graph))


@pytest.mark.slow
@every_algorithm
def test_all_graphs_on_seven_nodes(name):
    for graph in graphs(7):
        assert_decides_everything(name, graph)


@st.composite
def random_digraphs(draw: st.DrawFn, least: int = 2, most: int = 9) -> Digraph:
    """Digraphs whose arcs are drawn one by one, from sparse to dense, so that failures shrink to few arcs."""
    n = draw(st.integers(least, most))
    arcs = [(u, v) for u in range(n) for v in range(n) if u != v]
    symmetric = draw(st.booleans())
    complement = draw(st.booleans())
    chosen = draw(st.sets(st.sampled_from(arcs)))
    taken = set(arcs) - chosen if complement else chosen
    return Digraph(range(n), taken | {(v, u) for u, v in taken} if symmetric else taken)


@every_algorithm
@settings(max_examples=60)
@given(graph=random_digraphs(), data=st.data())
def test_random_digraphs(name, graph, data):
    r = data.draw(st.integers(1, (graph.n + 1) // 2))
    s = data.draw(st.integers(1, graph.n))
    assert_decides(name, graph, r, s, brute_profile(graph)[r])


@pytest.mark.parametrize("name", [name for name in ALGORITHMS if name not in ("exhaustive", "transform")])
@pytest.mark.parametrize("n", [11, 14])
@pytest.mark.parametrize("directed", [False, True])
def test_larger_graphs_against_the_transform(name, n, directed):
    for seed, p in enumerate((0.3, 0.55, 0.8)):
        graph = Digraph.from_networkx(nx.gnp_random_graph(n, p, seed=seed, directed=directed))
        assert_decides_boundary(name, graph, transform.profile(graph, NO_LIMITS))


@every_algorithm
def test_the_front_gives_the_same_profile_and_determination(name):
    for graph in [*digraphs(3), *graphs(5)]:
        table = profile_of(graph)
        assert rb.robustness_profile(graph, algorithm=name) == table
        result = rb.determine_robustness(graph, algorithm=name)
        best = max((r for r, s in table.items() if s), default=0)
        assert (result.verdict, result.r) == (Verdict.DETERMINED, best)
        assert result.s == (table[best] if best else graph.n)


@every_algorithm
@pytest.mark.parametrize("n", [0, 1])
def test_fewer_than_two_nodes(name, n):
    G = nx.empty_graph(n)
    assert rb.robustness_profile(G, algorithm=name) == ({1: 1} if n else {})
    assert rb.check_rs_robustness(G, n, 1, algorithm=name).verdict is Verdict.ROBUST
    assert rb.check_rs_robustness(G, n + 1, 1, algorithm=name).verdict is Verdict.NOT_ROBUST


@every_algorithm
def test_witnesses_carry_the_users_labels(name):
    G = nx.DiGraph([(1, "1"), ("1", 1), ((2, "a"), 3)])
    result = rb.check_rs_robustness(G, 1, 1, algorithm=name)
    assert result.verdict is Verdict.NOT_ROBUST
    assert result.witness is not None
    assert result.witness.S1 | result.witness.S2 <= set(G)
    assert all(not rb.r_reachable_nodes(G, side, 1) for side in result.witness)


@every_algorithm
def test_a_limit_is_no_verdict(name):
    # Robust as far as anybody knows, and out of reach of every search.
    graph = Digraph.from_networkx(nx.gnp_random_graph(120, 0.5, seed=1))
    answer = ALGORITHMS[name](graph, 28, 1, Limits(deadline=time.monotonic() + 0.5))  # without the limit: years
    assert answer.verdict is Verdict.UNDECIDED
    assert answer.pair is None
    assert answer.stats["reason"]
    with pytest.raises(rb.Undecided):
        rb.is_r_robust(graph, 28, algorithm=name, time_limit=0.2)


def decide_of(name):
    return importlib.import_module(f"robustness.decision.algorithms.{name.replace('-', '_')}").decide


@every_algorithm
def test_an_unknown_option_is_refused(name):
    for graph in (nx.cycle_graph(5), nx.complete_graph(5), nx.empty_graph(1), nx.petersen_graph()):
        for option in ("colour", "timeout"):
            with pytest.raises(TypeError, match=f"'{option}'.*'{name}'"):
                rb.check_rs_robustness(graph, 1, algorithm=name, **{option: 1})
    assert set(inspect.signature(decide_of(name)).parameters) - {"graph", "r", "s", "limits"} == OPTIONS[name]


@pytest.mark.parametrize("graph", [nx.complete_graph(5), nx.petersen_graph(), nx.gnp_random_graph(30, 0.5, seed=1)])
def test_an_unknown_option_of_auto_is_refused_on_every_graph(graph):
    for ask in (rb.check_rs_robustness, rb.is_r_robust):
        with pytest.raises(TypeError, match="timeout"):
            ask(graph, 2, timeout=1)
    with pytest.raises(TypeError, match="timeout"):
        rb.is_rs_robust(graph, 2, 1, timeout=1)
    with pytest.raises(TypeError, match="timeout"):
        rb.determine_robustness(graph, timeout=1)


def test_a_type_error_inside_an_algorithm_is_no_fault_of_the_user(monkeypatch):
    def broken(*_, **__):
        raise TypeError("f() got an unexpected keyword argument 'colour'")

    monkeypatch.setattr("robustness.decision.algorithms.exhaustive.decide", broken)
    with pytest.raises(TypeError, match="colour"):
        rb.check_rs_robustness(nx.cycle_graph(5), 2, algorithm="exhaustive")


@every_algorithm
def test_seed_and_jobs_change_no_verdict(name):
    graph = Digraph.from_networkx(nx.gnp_random_graph(9, 0.6, seed=5))
    for r, s_max in profile_of(graph).items():
        for s in (max(s_max, 1), min(s_max + 1, 9)):
            answer = ALGORITHMS[name](graph, r, s, Limits(jobs=2, seed=2**40 + 7))
            assert_right(answer, graph, r, s, s_max)


# Known values, by the front.


def undirected_circulant(n: int, k: int) -> nx.Graph:
    return nx.circulant_graph(n, range(1, k + 1))


def directed_circulant(n: int, k: int) -> nx.DiGraph:
    return nx.DiGraph([(i, (i + step) % n) for i in range(n) for step in range(1, k + 1)])


def nearest_platoon(n: int, k: int) -> nx.Graph:
    return nx.Graph([(i, j) for i, j in combinations(range(n), 2) if j - i <= k])


CLOSED_FORMS = [
    *[pytest.param(nx.complete_graph(n), (n + 1) // 2, id=f"K{n}") for n in range(2, 12)],
    *[pytest.param(nx.random_labeled_tree(n, seed=n), 1, id=f"tree{n}") for n in range(3, 13)],
    *[pytest.param(nx.star_graph(n), 1, id=f"star{n}") for n in range(2, 9)],
    *[pytest.param(nx.path_graph(n), 1, id=f"path{n}") for n in range(3, 12)],
    *[pytest.param(nx.cycle_graph(n), 1, id=f"cycle{n}") for n in range(4, 13)],
    *[pytest.param(nx.grid_2d_graph(a, b), 1, id=f"grid{a}x{b}") for a in (2, 3, 4) for b in (2, 3, 4)],
    *[pytest.param(nx.hypercube_graph(d), 1, id=f"hypercube{d}") for d in (2, 3, 4)],
    *[pytest.param(nx.wheel_graph(n), 2, id=f"wheel{n}") for n in range(4, 13)],
    *[
        pytest.param(nx.complete_bipartite_graph(a, b), min(a, (b + 1) // 2), id=f"K{a},{b}")
        for a in range(1, 6)
        for b in range(a, 8)
    ],
    *[pytest.param(nx.complete_multipartite_graph(*[2] * m), m - 1, id=f"cocktail{m}") for m in range(2, 7)],
    *[pytest.param(nearest_platoon(n, k), k, id=f"P{n}^{k}") for k in (1, 2, 3, 4) for n in range(2 * k, 2 * k + 5)],
    *[
        pytest.param(undirected_circulant(n, k), k if n >= 2 * k + 2 else k + 1, id=f"C{n}(1..{k})")
        for k in (1, 2, 3, 4)
        for n in range(2 * k + 1, 2 * k + 6)
    ],
    *[
        pytest.param(directed_circulant(n, k), (k + 1) // 2 if k % 2 else k // 2 + n % 2, id=f"directed C{n}(1..{k})")
        for k in (1, 2, 3, 4, 5)
        for n in range(k + 2, k + 9)
    ],
    pytest.param(nx.petersen_graph(), 1, id="Petersen"),
    pytest.param(nx.heawood_graph(), 1, id="Heawood"),
    pytest.param(nx.icosahedral_graph(), 2, id="icosahedron"),
    pytest.param(nx.hoffman_singleton_graph(), 3, id="Hoffman-Singleton"),
]


@pytest.mark.parametrize(("G", "expected"), CLOSED_FORMS)
def test_closed_forms(G, expected):
    assert rb.is_r_robust(G, expected)
    assert not rb.is_r_robust(G, expected + 1)


@pytest.mark.parametrize("n", range(2, 11))
def test_complete_graphs_have_every_s(n):
    assert set(rb.robustness_profile(nx.complete_graph(n)).values()) == {n}


@pytest.mark.parametrize("m", range(2, 7))
def test_cocktail_parties_have_every_s(m):
    table = rb.robustness_profile(nx.complete_multipartite_graph(*[2] * m))
    assert all(table[r] == 2 * m for r in range(1, m))


@pytest.mark.parametrize(("n", "counts"), [(5, [13, 13, 6, 2]), (6, [44, 67, 37, 8])])
def test_how_many_graphs_have_which_r(n, counts):
    found = Counter(max((r for r, s in profile_of(graph).items() if s), default=0) for graph in graphs(n))
    assert [found[r] for r in range(len(counts))] == counts


@pytest.mark.parametrize("n", [3, 4, 5, 6, pytest.param(7, marks=pytest.mark.slow)])
def test_least_edges_of_2_2_robust_graphs(n):
    assert min(graph.arc_count // 2 for graph in graphs(n) if profile_of(graph)[2] >= 2) == 2 * n - 3


@pytest.mark.parametrize("r", [2, 3, pytest.param(4, marks=pytest.mark.slow)])
def test_least_edges_of_the_largest_r(r):
    least = min(graph.arc_count // 2 for graph in graphs(2 * r - 1) if profile_of(graph)[r])
    assert least == 3 * r * (r - 1) // 2


# Implications, over all small graphs and random ones above.


def small_graphs() -> list[Digraph]:
    return [*digraphs(2), *digraphs(3), *digraphs(4), *graphs(5), *graphs(6)]


def largest_r(table: dict[int, int]) -> int:
    return max((r for r, s in table.items() if s), default=0)


def check_implications(graph: Digraph, table: dict[int, int]) -> None:
    """Assert every implication between (r,s)-robustness and degrees, trees and smaller pairs."""
    n, least, best = graph.n, int(graph.in_degrees.min()), largest_r(table)
    G = nx.DiGraph(list(graph.arcs()))
    G.add_nodes_from(range(n))
    assert (best >= 1) == any(len(nx.descendants(G, v)) == n - 1 for v in G), "1-robust iff one node reaches all"
    assert best <= max(1, least)
    for r, s in table.items():
        if r > 1 and s:
            assert table[r - 1] >= min(s + 1, n), "(r,s) implies (r-1,s+1)"
        for more in range(1, n + 1):
            if table.get(r + more - 1, 0):
                assert s >= more, "(r+s-1)-robust implies (r,s)-robust"
        if least >= n // 2 + r - 1:
            assert s == n, "least in-degree floor(n/2) + r - 1 gives every s"
    if graph.is_symmetric:
        check_undirected_implications(G.to_undirected(), best)


def check_undirected_implications(G: nx.Graph, best: int) -> None:
    assert (best >= 1) == nx.is_connected(G)
    adjacency = nx.to_numpy_array(G)
    spectrum = np.linalg.eigvalsh(np.diag(adjacency.sum(axis=0)) - adjacency)
    assert best >= math.ceil(spectrum[1] / 2 - 1e-9), "ceil(lambda_2 / 2), a float: hence the slack"
    assert best <= nx.node_connectivity(G)
    halves = [set(S) for size in range(1, len(G) // 2 + 1) for S in combinations(G, size)]
    assert best >= min(nx.cut_size(G, S) / len(S) for S in halves), "the isoperimetric constant"


def test_implications_on_all_small_graphs():
    for graph in small_graphs():
        check_implications(graph, profile_of(graph))


@settings(max_examples=60)
@given(graph=random_digraphs(most=8))
def test_implications_on_random_graphs(graph):
    check_implications(graph, transform.profile(graph, NO_LIMITS))


@settings(max_examples=100)
@given(graph=random_digraphs(most=8), data=st.data())
def test_a_new_node_with_enough_in_neighbours_keeps_robustness(graph, data):
    heard = data.draw(st.sets(st.sampled_from(range(graph.n))))
    back = data.draw(st.sets(st.sampled_from(range(graph.n))))
    new = graph.n
    grown = Digraph(range(new + 1), [*graph.arcs(), *((u, new) for u in heard), *((new, v) for v in back)])
    after = transform.profile(grown, NO_LIMITS)
    for r, s_max in transform.profile(graph, NO_LIMITS).items():
        for s in range(1, s_max + 1):
            if len(heard) >= r + s - 1:
                assert after[r] >= s


@settings(max_examples=100)
@given(graph=random_digraphs(most=8), data=st.data(), most=st.integers(1, 3))
def test_removing_few_in_arcs_per_node_costs_as_much_r(graph, data, most):
    removed = set()
    for v in range(graph.n):
        heard = graph.in_neighbours(v).tolist()
        if heard:
            removed |= {(u, v) for u in data.draw(st.sets(st.sampled_from(heard), max_size=most))}
    after = transform.profile(Digraph(range(graph.n), set(graph.arcs()) - removed), NO_LIMITS)
    for r, s_max in transform.profile(graph, NO_LIMITS).items():
        if r > most:
            assert after[r - most] >= s_max


@pytest.mark.parametrize("seed", range(4))
def test_large_sets_are_counted_like_small_ones(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays over the whole graph and a loop over the members say the same of X_S^r, of traps and of violations."""
    from robustness import definitions
    from robustness.threat_models import THREAT_MODELS
    from robustness.traps import question as traps

    random = np.random.default_rng(seed)
    graph = Digraph.from_networkx(nx.gnp_random_graph(40, 0.15, seed=seed, directed=bool(seed % 2)))
    roles = [random.choice(4, graph.n, p=[0.3, 0.3, 0.05, 0.35]) for _ in range(150)]
    drawn = [[frozenset(np.flatnonzero(role == k).tolist()) for k in range(3)] for role in roles]

    def answers() -> list[object]:
        told: list[object] = []
        for S1, S2, M in drawn:
            told += [definitions.r_reachable_ids(graph, S1, r) for r in range(4)]
            for threat in THREAT_MODELS.values():
                for f in range(8):
                    sides = (S1, S2) if threat.two_faces else (S1 | M, S2)
                    told.append(traps.solves(graph, threat.question(f), traps.Sets(M, *sides)))
        return told

    with monkeypatch.context() as few:
        few.setattr(definitions, "MANY", 0)
        few.setattr(traps, "MANY", 0)
        by_arrays = answers()
    assert by_arrays == answers()
    assert {True, False} <= {each for each in by_arrays if isinstance(each, bool)}
