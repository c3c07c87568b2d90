"""What the operations promise is true, by the definition; and derivations can be carried out again."""

from __future__ import annotations

import dataclasses
import json
from itertools import chain, combinations, product

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

import robustness as rb
from robustness.constructions import (
    RULES,
    Guarantee,
    add_arcs,
    add_node,
    blow_up,
    build,
    grow,
    guaranteed,
    join_clique,
    remove_in_arcs,
    remove_nodes,
    replay,
    union,
    weaken,
)
from robustness.constructions.operations import OPERATIONS
from robustness.constructions.small_graphs import each_graph
from robustness.errors import InvalidGraph, InvalidParameter


def subsets(items):
    items = list(items)
    return chain.from_iterable(combinations(items, size) for size in range(len(items) + 1))


def small(directed):
    """Every graph on up to 4 nodes, or digraph on up to 3, with every maximal promise (r, s_max(r))."""
    for graph in each_graph(3 if directed else 4, directed=directed):
        G = graph.to_networkx()
        for r, s in rb.robustness_profile(graph).items():
            if s:
                yield guaranteed(G, r, s)


@pytest.fixture(scope="session")
def sound(holds):
    def check(result):
        graph, guarantee = result
        assert guarantee.rule in RULES
        assert guarantee.sha256 == rb.Digraph.from_networkx(graph).sha256
        assert holds(graph, guarantee.r, guarantee.s), (sorted(graph.edges), guarantee)
        return result

    return check


@pytest.mark.parametrize("directed", [False, True])
class TestPromisesOnAllSmallGraphs:
    def test_add_node(self, sound, directed):
        for base in small(directed):
            for hears in subsets(base.graph):
                for heard_by in subsets(base.graph) if directed else [()]:
                    _, guarantee = sound(add_node(base, "new", hears, heard_by))
                    if len(hears) >= base.guarantee.r + base.guarantee.s - 1:
                        assert guarantee.implies(base.guarantee.r, base.guarantee.s)

    def test_remove_in_arcs(self, sound, directed):
        for base in small(directed):
            for arcs in subsets(base.graph.edges):
                heads = [v for _, v in arcs] if directed else list(chain(*arcs))
                w = max(map(heads.count, heads), default=0)
                _, guarantee = sound(remove_in_arcs(base, arcs))
                assert (guarantee.r, guarantee.s) == (max(base.guarantee.r - w, 0), base.guarantee.s)

    def test_remove_nodes(self, sound, directed):
        for base in small(directed):
            for nodes in subsets(base.graph):
                _, guarantee = sound(remove_nodes(base, nodes))
                left = len(base.graph) - len(nodes)
                assert guarantee.r >= min(base.guarantee.r - len(nodes), (left + 1) // 2)

    def test_join_clique(self, sound, directed):
        for base, size in product(small(directed), (1, 2, 3)):
            sound(join_clique(base, size))

    def test_blow_up(self, sound, directed):
        for base, copies, cliques in product(small(directed), (1, 2), (False, True)):
            _, guarantee = sound(blow_up(base, copies, cliques=cliques))
            if copies == 1 and base.guarantee.r >= 2 and cliques:
                assert guarantee.r >= min(base.guarantee.r, (min(d for _, d in in_degrees(base.graph)) + 2) // 2)

    def test_add_arcs_and_union(self, sound, directed):
        bases = list(small(directed))
        for base in bases:
            sound(add_arcs(base, combinations(base.graph, 2)))
        for one, two in product(bases[::3], bases[::3]):
            if set(one.graph) == set(two.graph):
                _, guarantee = sound(union(one, two))
                assert guarantee.r == max(one.guarantee.r, two.guarantee.r)

    def test_grow(self, sound, directed):
        for base, more, seed in product(small(directed), (0, 1, 2), (0, 1)):
            graph, _ = sound(grow(base, len(base.graph) + more, seed=seed))
            assert len(graph) == len(base.graph) + more

    def test_weaken(self, sound, directed):
        for base in small(directed):
            for r in range(base.guarantee.r + 1):
                for s in range(1, len(base.graph) + 1):
                    if base.guarantee.implies(r, s):
                        sound(weaken(base, r, s))


def in_degrees(graph):
    return graph.in_degree if graph.is_directed() else graph.degree


class TestSharpness:
    """The rules are not weaker than the families whose value is known."""

    def test_wheel_is_a_cycle_joined_with_a_node(self):
        assert join_clique(build("cycle", n=8), 1).guarantee.r == 2

    def test_cliques_join_to_cliques(self):
        assert [join_clique(build("complete", n=n), 2).guarantee.r for n in range(1, 8)] == [2, 2, 3, 3, 4, 4, 5]

    def test_cocktail_party_is_a_blow_up_of_a_clique(self):
        assert [blow_up(build("complete", n=m), 2).guarantee.r for m in range(2, 7)] == [1, 2, 3, 4, 5]

    def test_a_clique_is_a_blow_up_of_a_node(self):
        assert blow_up(nx.empty_graph(1), 5, cliques=True).guarantee.r == 3

    def test_join_is_not_simply_r_plus_m(self, holds):
        """The tempting rule min(r + m, ceil(N/2)) fails: K_4 with two nodes grown on it, joined with K_3."""
        base = add_node(add_node(build("complete", n=4), 4, [0, 1]), 5, [2, 4])
        graph, guarantee = join_clique(base, 3)
        tempting = min(base.guarantee.r + 3, 5)
        assert not holds(graph, tempting)
        assert guarantee.r < tempting


class TestChains:
    def chain(self):
        start = guaranteed(build("complete", n=5))
        step = add_node(start, ("a", 1), hears=range(5))
        step = remove_in_arcs(step, [(0, 1), (2, 3)])
        step = grow(step, 8, links=4, seed=3)
        step = union(step, guaranteed(step.graph, 1))
        step = blow_up(weaken(step, 2, 1), 2)
        return start, step

    def test_survives_json_and_replays(self, sound):
        start, end = self.chain()
        again = Guarantee.from_dict(json.loads(json.dumps(end.guarantee.as_dict())))
        assert again == end.guarantee
        assert hash(again) == hash(end.guarantee)
        leaf = end.guarantee.premises[0].premises[0].premises[1]
        assert leaf.rule == "checked"
        second = union_seed(end)
        replayed = replay(again, [start.graph, second])
        assert nx.utils.graphs_equal(replayed.graph, end.graph)

    def test_explains_itself_down_to_the_leaves(self):
        _, end = self.chain()
        text = end.guarantee.explain()
        assert text.count("\n") == text.count(" by ") - 1
        assert "checked" in text.splitlines()[-1]

    def test_a_forged_conclusion_is_refused(self):
        start, end = self.chain()
        forged = dataclasses.replace(end.guarantee, r=end.guarantee.r + 1)
        with pytest.raises(InvalidParameter, match="carrying it out gives"):
            replay(forged, [start.graph, union_seed(end)])

    def test_a_forged_leaf_is_refused(self):
        start = guaranteed(nx.cycle_graph(5))
        forged = dataclasses.replace(start.guarantee, r=2)
        with pytest.raises(InvalidParameter, match="not \\(2,5\\)-robust"):
            replay(forged, [start.graph])

    def test_a_missing_seed_is_named(self):
        _, end = self.chain()
        with pytest.raises(InvalidParameter, match="seed graph"):
            replay(end.guarantee, [])

    @pytest.mark.parametrize("change", [{"parameters": {"nodes": 3}}, {"premises": ()}])
    def test_a_step_of_another_form_is_refused(self, change):
        _, guarantee = remove_nodes(nx.complete_graph(5), [0])
        with pytest.raises(InvalidParameter):
            replay(dataclasses.replace(guarantee, **change), [nx.complete_graph(5)])

    @pytest.mark.parametrize(
        "document", [{}, {"r": 1}, {"r": 1, "s": 1, "rule": "magic", "sha256": "", "premises": []}]
    )
    def test_other_documents_are_refused(self, document):
        with pytest.raises(InvalidParameter, match="derivation"):
            Guarantee.from_dict(document)

    def test_every_rule_but_checked_is_an_operation(self):
        assert set(OPERATIONS) == set(RULES) - {"checked"}


def union_seed(end):
    """The second seed of the chain: the graph before the union, which adds nothing to it."""
    sha256 = end.guarantee.premises[0].premises[0].premises[1].sha256
    before = grow(
        remove_in_arcs(add_node(guaranteed(build("complete", n=5)), ("a", 1), range(5)), [(0, 1), (2, 3)]),
        8,
        links=4,
        seed=3,
    )
    assert before.guarantee.sha256 == sha256
    return before.graph


@given(st.data())
def test_random_chains_keep_their_promise(sound, data):
    directed = data.draw(st.booleans())
    start = build(
        "erdos-renyi", n=data.draw(st.integers(1, 5)), p=0.7, directed=directed, seed=data.draw(st.integers(0, 99))
    )
    result = guaranteed(start)
    for name in data.draw(
        st.lists(st.sampled_from(["add_node", "remove_in_arcs", "add_arcs", "join", "remove_nodes"]), max_size=4)
    ):
        nodes = sorted(result.graph, key=repr)
        if name == "add_node":
            result = add_node(
                result, ("n", len(nodes)), data.draw(st.sets(st.sampled_from(nodes)) if nodes else st.just(set()))
            )
        elif name == "remove_in_arcs" and result.graph.size():
            result = remove_in_arcs(
                result, data.draw(st.sets(st.sampled_from(sorted(result.graph.edges, key=repr)), max_size=3))
            )
        elif name == "add_arcs" and len(nodes) > 1:
            result = add_arcs(result, data.draw(st.sets(st.sampled_from(list(combinations(nodes, 2))), max_size=3)))
        elif name == "join" and len(nodes) < 7:
            result = join_clique(result, 1)
        elif name == "remove_nodes" and nodes:
            result = remove_nodes(result, [data.draw(st.sampled_from(nodes))])
    sound(result)


class TestMisuse:
    def test_the_graph_given_is_not_changed(self):
        base = nx.complete_graph(4)
        add_node(base, "x", [0, 1])
        remove_in_arcs(base, [(0, 1)])
        join_clique(base, 1)
        assert nx.utils.graphs_equal(base, nx.complete_graph(4))

    def test_a_graph_changed_after_its_guarantee_is_refused(self):
        base = guaranteed(nx.complete_graph(4))
        base.graph.remove_edge(0, 1)
        with pytest.raises(InvalidGraph, match="changed"):
            add_arcs(base, [(0, 1)])

    @pytest.mark.parametrize(
        ("operation", "error"),
        [
            (lambda G: add_node(G, 0, [1]), InvalidGraph),
            (lambda G: add_node(G, "x", ["y"]), InvalidGraph),
            (lambda G: add_node(G, "x", [0], [1]), InvalidParameter),
            (lambda G: add_arcs(G, [(0, 9)]), InvalidGraph),
            (lambda G: add_arcs(G, [(0, 0)]), InvalidGraph),
            (lambda G: remove_in_arcs(G, [(0, 2)]), InvalidGraph),
            (lambda G: remove_nodes(G, [9]), InvalidGraph),
            (lambda G: union(G, nx.cycle_graph(5)), InvalidGraph),
            (lambda G: grow(G, 3), InvalidParameter),
            (lambda G: grow(G, 9, links=5), InvalidParameter),
            (lambda G: join_clique(G, 0), InvalidParameter),
            (lambda G: blow_up(G, 0), InvalidParameter),
            (lambda G: weaken(G, 2, 1), InvalidParameter),
            (lambda G: guaranteed(G, 2), InvalidParameter),
        ],
    )
    def test_is_one_line(self, operation, error):
        with pytest.raises(error) as caught:
            operation(nx.cycle_graph(4))
        assert "\n" not in str(caught.value)

    def test_labels_one_and_one_in_quotes_are_two_nodes(self, sound):
        graph, _ = sound(add_node(nx.complete_graph([0, 1, 2]), "1", [0, 1, 2]))
        assert set(graph) == {0, 1, 2, "1"}

    def test_corners(self, sound):
        sound(add_node(nx.Graph(), 0, []))
        sound(remove_nodes(nx.complete_graph(3), range(3)))
        sound(join_clique(nx.Graph(), 3))
        sound(blow_up(nx.Graph(), 2))
        sound(grow(nx.DiGraph(), 2))
