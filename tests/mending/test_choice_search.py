"""The tree search over choices of links, against every choice there is, as machine code and as plain Python."""

from __future__ import annotations

import importlib.util
import random
import sys
from itertools import combinations
from pathlib import Path
from types import ModuleType

import networkx as nx
import pytest

import robustness as rb
from robustness.kernels import choice_tree
from robustness.limits import Limits
from robustness.mending import choice_search
from robustness.mending.actions import Actions, actions_for
from robustness.mending.choice_search import ChoiceSearch
from robustness.mending.demands import Side, fit, holds_apart, masks_of, worth
from robustness.mending.goal import Part
from robustness.mending.hitting_set import Search
from robustness.traps.question import Question

FOLDER = Path(choice_tree.__file__).resolve().parent


def from_source(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"plain_{name}", FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def plain(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the kernel as plain Python, with what it calls."""
    monkeypatch.setitem(sys.modules, "robustness.kernels.twins", from_source("twins"))
    return from_source("choice_tree")


def question(rng: random.Random) -> tuple[list[int], Actions, list[tuple[Side, Side | None]]]:
    """Return a small network, what may be done, and demands on it."""
    n = rng.randint(3, 6)
    directed = rng.random() < 0.4
    network = nx.gnp_random_graph(n, rng.choice([0.2, 0.4]), seed=rng.randrange(10**6), directed=directed)
    graph = rb.Digraph.from_networkx(network)
    every = list(combinations(range(n), 2))
    price = rng.choice([None, lambda u, v: 1 + (u * v) % 3])
    one_way = rng.random() < 0.3
    allowed = (
        rng.sample([*every, *((v, u) for u, v in every if one_way)], min(len(every), 8)) if n > 4 or one_way else None
    )
    # Never without caps: these demands are not those of a network, and swapping nodes would change them.
    cap = rng.choice([n, n, 3])
    actions = actions_for(graph, allowed, price, forbid=(), require=(), max_in_degree=cap, one_way=one_way)
    part = rng.choice(
        [Part(2, 1), Part(2, 2), Part(1, 1), Part(3, 2), Part(trap=Question(1, two_faces=True, local=True))]
    )
    heard = list(masks_of(graph))
    demands: list[tuple[Side, Side | None]] = []
    for _ in range(40):
        roles = [rng.choice([0, 1, 1, 2, 2, 3]) for _ in range(n)]
        M = sum(1 << i for i in range(n) if roles[i] == 3) if part.trap is not None else 0
        first, second = (Side(part, M, sum(1 << i for i in range(n) if roles[i] == k)) for k in (1, 2))
        if first.S and second.S and fit(first, second) and holds_apart(first, second, heard):
            demands.append((first, second))
    for U in rng.sample(range(1, 1 << n), 3):
        if part.trap is None and worth(Side(part, 0, U), heard) < part.s and rng.random() < 0.5:
            demands.append((Side(part, 0, U), None))
    return heard, actions, demands


def meets(heard: list[int], demand: tuple[Side, Side | None]) -> bool:
    first, second = demand
    return worth(first, heard) >= first.part.s if second is None else not holds_apart(first, second, heard)


def with_links(heard: list[int], actions: Actions, chosen: tuple[int, ...]) -> list[int]:
    mended = list(heard)
    for a in chosen:
        for tail, head in actions.items[a].arcs:
            mended[head] |= 1 << tail
    return mended


def cheapest(heard: list[int], actions: Actions, demands: list[tuple[Side, Side | None]], most: int) -> int | None:
    """Return the least cost of a choice that meets all demands, of those that cost no more than ``most``."""
    best: int | None = None
    for size in range(len(actions.items) + 1):
        for chosen in combinations(range(len(actions.items)), size):
            cost = sum(actions.items[a].cost for a in chosen)
            if cost > most or (best is not None and cost >= best):
                continue
            mended = with_links(heard, actions, chosen)
            gains = [(new & ~old).bit_count() for new, old in zip(mended, heard, strict=True)]
            if actions.most is not None and any(g > cap for g, cap in zip(gains, actions.most, strict=True)):
                continue
            if all(meets(mended, each) for each in demands):
                best = cost
        if best is not None and size >= best:
            break
    return best


def searched(
    heard: list[int], actions: Actions, demands: list[tuple[Side, Side | None]], budget: int, rng: random.Random
) -> tuple[int | None, int | None]:
    """Return the cost of what is found within a budget, and what nothing that was given up is cheaper than.

    Demands are told one after the other, as they turn out not to be met, and the search is stopped now and then.
    """
    tree = ChoiceSearch(heard, actions, budget)
    told = demands[: rng.randint(0, 3)]
    tree.add(told)
    while True:
        is_over, chosen = tree.run(rng.choice([1, 3, 1000]))
        if is_over:
            return None, tree.beyond
        if chosen is not None:
            mended = with_links(heard, actions, tuple(chosen))
            new = [each for each in demands if not meets(mended, each)]
            if not new:
                return sum(actions.items[a].cost for a in chosen), tree.beyond
            tree.add(new[:2])


@pytest.mark.parametrize("is_plain", [False, True], ids=["machine code", "plain Python"])
def test_a_choice_is_found_within_the_budget_exactly_when_there_is_one(
    is_plain: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if is_plain:
        monkeypatch.setattr(choice_search, "ChoiceTree", plain(monkeypatch).ChoiceTree)
    rng = random.Random(7)
    found = missed = none = 0
    for _ in range(40 if is_plain else 200):
        heard, actions, demands = question(rng)
        if not actions.items or not demands:
            continue
        least = cheapest(heard, actions, demands, 9)
        for budget in range(8):
            cost, beyond = searched(heard, actions, demands, budget, rng)
            if least is not None and least <= budget:
                assert cost is not None
                assert least <= cost <= budget
                found += 1
            else:
                assert cost is None
                assert least is None or (beyond is not None and budget < beyond <= least)
                missed += least is not None
                none += least is None
    assert min(found, missed, none) > 10, (found, missed, none)


def test_one_round_of_plain_python_and_of_machine_code_look_at_the_same_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(3)
    told: list[tuple[int, int | None]] = []
    questions = [question(rng) for _ in range(30)]
    for module in (choice_tree, plain(monkeypatch)):
        monkeypatch.setattr(choice_search, "ChoiceTree", module.ChoiceTree)
        for heard, actions, demands in questions:
            if actions.items:
                tree = ChoiceSearch(heard, actions, 3)
                tree.add(demands)
                tree.run(500)
                told.append((tree.nodes, tree.beyond))
    assert told[: len(told) // 2] == told[len(told) // 2 :]


def test_a_graph_that_the_master_problem_did_not_settle_in_a_minute() -> None:
    """Four links mend 27 nodes, and three do not: a tree of 10^5 nodes."""
    found = rb.mend(rb.read_topology("topohub:sndlib/sun"), (2, 2), time_limit=300)
    assert (found.verdict.value, found.cost, found.lower_bound) == ("optimal", 4, 4)


@pytest.mark.parametrize("goal", [2, (2, 2)])
def test_one_of_links_that_swapping_makes_alike_is_enough(goal: object) -> None:
    """Caps that nobody reaches keep the tree from leaving links out; the cheapest choice costs the same."""
    for network in (nx.star_graph(5), nx.path_graph(6), nx.barbell_graph(3, 0), nx.full_rary_tree(3, 7)):
        every = len(network)
        assert rb.mend(network, goal).cost == rb.mend(network, goal, max_in_degree=every).cost


def test_more_than_64_nodes_and_links_that_cost_nothing_are_left_to_the_master() -> None:
    for network, price in ((nx.path_graph(65), None), (nx.path_graph(5), lambda u, v: (u + v) % 2)):
        graph = rb.Digraph.from_networkx(network)
        actions = actions_for(graph, None, price, forbid=(), require=(), max_in_degree=None, one_way=False)
        search = Search(graph, actions, [Part(1, 1)], Limits())
        search.run()
        assert search._deepening is None
    assert rb.mend(nx.path_graph(5), (2, 2), cost=lambda u, v: (u + v) % 2).verdict.value == "optimal"
