"""Certificates of mending: accepted as they come, refused when anything false is put in; the bound is checked."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from functools import cache
from itertools import combinations
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from certificates import CertificateError, MalformedCertificate, Misuse, RejectedCertificate, verify_any, verify_mending
from certificates.questions import Question, comparison
from robustness.digraph import Digraph, as_digraph
from robustness.errors import InvalidParameter
from robustness.mending import Confirmation, LeastVerdict, MendVerdict, certify_mending
from robustness.mending import confirm_least as confirm
from robustness.mending.rebuilding import subject_of
from tests.mending.brute_force import candidates, is_robust, least_cost, survives

#: A path and a goal of each kind for which the kernel has evidence.
GOALS = [
    rb.Goal(2),
    rb.Goal(2, 2),
    rb.Goal(3),
    rb.Goal(survive=1, model="malicious"),
    rb.Goal(survive=1, model="delayed"),
    rb.Goal(survive=1, model="delayed-local"),
]
PATH = as_digraph(nx.path_graph(5))


def confirm_least(graph: bytes, data: bytes, time_limit: float | None = None) -> Confirmation:
    """Return what HiGHS says, which the kernel's tree over choices never contradicts."""
    by_highs = confirm(graph, data, time_limit=time_limit, choices=0)
    if by_highs.verdict is LeastVerdict.REFUTED:
        assert not verify_mending(graph, data, lambda looked: looked < 3_000).is_least
    return by_highs


def both(*changes: Callable[[dict[str, Any]], object]) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        for each in changes:
            each(document)

    return change


@cache
def made(goal: rb.Goal = GOALS[1], one_way: bool = False) -> bytes:
    data = certify_mending(rb.mend(PATH, goal, one_way=one_way, mandatory=[(0, 2)], max_in_degree=4))
    assert data is not None
    return data


def changed(data: bytes, change: Callable[[dict[str, Any]], object]) -> bytes:
    header, _, body = data.partition(b"\n")
    document = json.loads(header)
    change(document)
    return json.dumps(document).encode() + b"\n" + body


def put(*path: str | int, value: object) -> Callable[[dict[str, Any]], None]:
    def change(document: Any) -> None:
        for step in path[:-1]:
            document = document[step]
        document[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("goal", "one_way"), [*((goal, False) for goal in GOALS), *((goal, True) for goal in GOALS[:5])]
)
def test_what_mend_finds_is_certified_and_its_bound_confirmed(goal: rb.Goal, one_way: bool) -> None:
    data = made(goal, one_way)
    found = confirm_least(PATH.canonical_bytes(), data)
    assert found.verdict is LeastVerdict.CONFIRMED
    assert found.claim.cost == found.claim.least == found.claim.links
    assert found.claim == verify_any(PATH.canonical_bytes(), data)
    assert "left to a solver" in str(found.claim)
    assert "HiGHS confirms" in str(found)
    by_kernel = confirm(PATH.canonical_bytes(), data)
    assert (by_kernel.verdict, by_kernel.solver, by_kernel.claim.is_least) == (LeastVerdict.CONFIRMED, "kernel", True)
    assert "proven by a tree over choices" in str(by_kernel.claim)
    assert str(by_kernel).startswith("the kernel's tree over choices confirms")
    assert by_kernel.claim == verify_any(PATH.canonical_bytes(), data, lambda looked: looked < 1_000)
    assert comparison(found.claim, Question())[0]
    assert not comparison(found.claim, Question(verdict="robust", r=2))[0]


@pytest.mark.parametrize("goal", GOALS[:5], ids=map(str, GOALS[:5]))
def test_a_bound_that_is_too_high_is_refuted_by_the_other_solver(goal: rb.Goal) -> None:
    def raise_bound(document: dict[str, Any]) -> None:
        document["claim"]["least"] += 1
        document["claim"]["cost"] = document["actions"]["chosen"] = None
        document["lengths"] = []

    header = changed(made(goal), raise_bound).partition(b"\n")[0] + b"\n"
    assert confirm_least(PATH.canonical_bytes(), header).verdict is LeastVerdict.REFUTED

    def nothing_works(document: dict[str, Any]) -> None:
        raise_bound(document)
        document["claim"]["least"] = None

    header = changed(made(goal), nothing_works).partition(b"\n")[0] + b"\n"
    found = confirm_least(PATH.canonical_bytes(), header)
    assert found.verdict is LeastVerdict.REFUTED
    assert "HiGHS breaks them all with" in str(found)


def test_a_solver_that_fails_or_counts_to_a_tolerance_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    from ortools.math_opt.python import mathopt

    def fail(*_: object, **__: object) -> object:
        raise AttributeError("'StatusNotOk' object has no attribute 'canonical_code'")

    data, graph = made(), PATH.canonical_bytes()
    with monkeypatch.context() as patched:
        patched.setattr(mathopt, "solve", fail)
        found = confirm(graph, data, choices=0)
        assert found.verdict is LeastVerdict.UNDECIDED
        assert "HiGHS failed: 'StatusNotOk'" in str(found)
        assert confirm(graph, data).verdict is LeastVerdict.CONFIRMED
    solve = mathopt.solve

    def without_the_ceiling(model: Any, *arguments: Any, **options: Any) -> Any:
        for row in list(model.linear_constraints()):
            if row.upper_bound == found.claim.least - 1:  # type: ignore[operator]
                model.delete_linear_constraint(row)
        return solve(model, *arguments, **options)

    monkeypatch.setattr(mathopt, "solve", without_the_ceiling)
    found = confirm(graph, data, choices=0)
    assert (found.verdict, found.cheaper) == (LeastVerdict.UNDECIDED, ())
    assert "the costs are too large for HiGHS" in str(found)


def test_without_its_violations_a_bound_does_not_follow() -> None:
    bare = changed(changed(made(), put("pairs", value=[])), put("covers", value=[]))
    found = confirm_least(PATH.canonical_bytes(), bare)
    assert found.verdict is LeastVerdict.REFUTED


def test_covers_bear_the_bound_and_are_of_robust_parts() -> None:
    """With its covers alone, that of the path shows what (2,2) needs; a cover with less room in it proves less."""
    subject, alone = PATH.canonical_bytes(), changed(made(), put("pairs", value=[]))
    assert verify_mending(subject, made()).covers > 0
    assert "covers" in str(verify_mending(subject, made()))
    assert json.loads(made().partition(b"\n")[0])["covers"][0][0] == 0
    assert confirm_least(subject, alone).verdict is LeastVerdict.CONFIRMED
    wide = changed(alone, put("covers", value=[[0, [], [0, 1, 2, 3, 4]]]))
    assert confirm_least(subject, wide).verdict is LeastVerdict.REFUTED
    with pytest.raises(MalformedCertificate, match=r"\(r,s\)-robust"):
        verify_mending(subject, changed(made(GOALS[4]), put("covers", value=[[0, [], [0, 1, 2, 3, 4]]])))


def test_a_start_bears_no_more_than_its_lemma_says() -> None:
    """For 3-robustness: a cover around three nodes of the path has room for 3 + 2 arcs, and 9 - 5 more are needed.

    With the required link, which lies inside the cover, that makes five.
    """
    subject = PATH.canonical_bytes()

    def with_cover(starts: list[list[int]], *cover: list[int], least: int = 5) -> LeastVerdict:
        def change(document: dict[str, Any]) -> None:
            document["pairs"], document["covers"] = [], [[0, starts, *cover]]
            document["claim"] |= {"least": least, "cost": None}
            document["actions"]["chosen"], document["lengths"] = None, []

        return confirm_least(subject, changed(made(GOALS[2]), change).partition(b"\n")[0] + b"\n").verdict

    assert with_cover([[0, 1, 2]], [0, 1, 2], [2, 3], [3, 4]) is LeastVerdict.CONFIRMED
    assert with_cover([[0, 1, 2]], [0, 1, 2], [2, 3], [3, 4], least=6) is LeastVerdict.REFUTED
    assert with_cover([], [0, 1, 2], [2, 3], [3, 4]) is LeastVerdict.REFUTED
    with pytest.raises(RejectedCertificate, match="lies inside one of its sets"):
        with_cover([[0, 1, 3]], [0, 1, 2], [2, 3], [3, 4])
    with pytest.raises(RejectedCertificate, match="has nodes"):
        with_cover([[]], [0, 1, 2], [2, 3], [3, 4])


def test_a_limit_leaves_the_bound_undecided() -> None:
    network = as_digraph(nx.path_graph(8))
    data = certify_mending(rb.mend(network, 3, time_limit=3))
    assert data is not None
    found = confirm_least(network.canonical_bytes(), data, time_limit=1e-3)
    assert found.verdict in (LeastVerdict.UNDECIDED, LeastVerdict.CONFIRMED)
    if found.verdict is LeastVerdict.UNDECIDED:
        assert str(found).startswith("undecided whether")
    assert confirm(network.canonical_bytes(), data, time_limit=1e-3).verdict in (found.verdict, LeastVerdict.CONFIRMED)


@pytest.mark.parametrize(("goal", "condition"), [(GOALS[0], is_robust(2)), (GOALS[4], survives(1, "delayed"))])
def test_a_rebuilt_bound_never_exceeds_what_brute_force_needs(goal: rb.Goal, condition: Any) -> None:
    rng = random.Random(7)
    for _ in range(4):
        network = nx.gnp_random_graph(5, 0.4, seed=rng.randrange(1000))
        data = certify_mending(rb.mend(network, goal))
        assert data is not None
        subject = as_digraph(network).canonical_bytes()
        least = least_cost(network, condition, candidates(network))
        assert verify_mending(subject, data).least == least
        assert confirm_least(subject, data).verdict is LeastVerdict.CONFIRMED


def test_impossible() -> None:
    path = as_digraph(nx.path_graph(4))
    result = rb.mend(path, 3)
    data = certify_mending(result)
    assert result.verdict is MendVerdict.IMPOSSIBLE
    assert data is not None
    found = confirm_least(path.canonical_bytes(), data)
    assert (found.verdict, found.claim.cost, found.claim.least) == (LeastVerdict.CONFIRMED, None, None)
    assert "no choice breaks them all" in str(found)
    assert "no choice does" in str(found.claim)
    assert certify_mending(rb.mend(nx.empty_graph(1), 2)) is None


def test_thin_is_certified_about_the_nodes_without_links() -> None:
    whole = as_digraph(nx.complete_graph(5))
    data = certify_mending(rb.thin(whole, (2, 2)))
    assert data is not None
    empty = subject_of(whole, data)
    assert empty.arc_count == 0
    assert confirm_least(empty.canonical_bytes(), data).verdict is LeastVerdict.CONFIRMED
    assert subject_of(PATH, made()) is PATH
    less = as_digraph(nx.complete_graph(5).edge_subgraph(list(nx.complete_graph(5).edges)[1:]))
    with pytest.raises(RejectedCertificate, match="does not have"):
        subject_of(less, data)
    with pytest.raises(RejectedCertificate, match="leaves out"):
        subject_of(whole, changed(data, lambda document: document["actions"]["links"].pop()))
    with pytest.raises(MalformedCertificate, match="links"):
        subject_of(whole, changed(data, put("actions", "links", value=[1])))


def test_results_without_a_question() -> None:
    result = rb.mend(PATH, 2)
    by_hand = rb.MendResult(result.verdict, result.goals, (), 0, 0, PATH, PATH)
    with pytest.raises(InvalidParameter, match="does not know its question"):
        certify_mending(by_hand)


#: What is changed in an honest certificate, and what the kernel says.
FORGERIES: list[tuple[Callable[[dict[str, Any]], object], type[CertificateError], str]] = [
    (put("format", value="robustness/mending-certificate/1"), MalformedCertificate, "the format"),
    (put("graph", value="0" * 64), RejectedCertificate, "another graph"),
    (put("claim", "cost", value=1), RejectedCertificate, "least cost"),
    (put("claim", "cost", value=40), RejectedCertificate, "do not cost"),
    (put("claim", "cost", value=-1), MalformedCertificate, "cost is an integer"),
    (put("claim", "least", value=None), RejectedCertificate, "least cost"),
    (put("claim", "least", value=10**6), RejectedCertificate, "least cost"),
    (put("claim", "parts", value={}), MalformedCertificate, "parts is a list"),
    (
        both(put("covers", value=[]), put("claim", "parts", 0, "r", value=3)),
        RejectedCertificate,
        "does not prove that the goal",
    ),
    (put("claim", "parts", 0, "s", value=5), RejectedCertificate, "does not"),
    (put("claim", "parts", 0, "s", value=6), MalformedCertificate, "s of a part lies in"),
    (put("claim", "parts", 0, "r", value=0), MalformedCertificate, "at least 1"),
    (put("claim", "parts", 0, "f", value=0), MalformedCertificate, "keys r s"),
    (put("claim", "parts", value=[{"f": 1, "faces": 3, "bound": "total"}]), MalformedCertificate, "faces is 1 or 2"),
    (put("claim", "parts", value=[{"f": 1, "faces": 1, "bound": "global"}]), MalformedCertificate, "bound is"),
    (put("actions", "one_way", value=1), MalformedCertificate, "one_way"),
    (put("actions", "links", value=[[0, 1, 1]]), RejectedCertificate, "there already"),
    (put("actions", "links", value=[[2, 0, 1]]), MalformedCertificate, "first end"),
    (put("actions", "links", value=[[0, 3, 1], [0, 2, 1]]), MalformedCertificate, "ascending"),
    (put("actions", "links", value=[[0, 9, 1]]), MalformedCertificate, "joins two"),
    (put("actions", "links", value=[[0, 2]]), MalformedCertificate, "a link is"),
    (put("actions", "links", 0, 2, value=True), MalformedCertificate, "a number of a link"),
    (put("actions", "required", value=[0, 1, 2, 3, 4, 5]), RejectedCertificate, "required link"),
    (put("actions", "required", value=[77]), MalformedCertificate, "required"),
    (put("actions", "most", value=[0, 0, 0, 0, 0]), RejectedCertificate, "gains more"),
    (put("actions", "most", value=[1]), MalformedCertificate, "most is null"),
    (put("actions", "most", value=[-1] * 5), MalformedCertificate, "a number of most"),
    (put("actions", "chosen", value=None), MalformedCertificate, "exactly when"),
    (put("actions", "chosen", value=[]), RejectedCertificate, "required link"),
    (put("pairs", value=None), MalformedCertificate, "pairs is a list"),
    (put("pairs", 0, value=[0, [], [0]]), MalformedCertificate, "a pair is"),
    (put("pairs", 0, value=[9, [], [0], [1]]), MalformedCertificate, "a pair is"),
    (put("pairs", 0, value=[0, [1], [0], [3]]), MalformedCertificate, "M is empty"),
    (put("pairs", 0, value=[0, [], [0], [0]]), RejectedCertificate, "disjoint"),
    (put("pairs", 0, value=[0, [], [1], [3]]), RejectedCertificate, "does not violate"),
    (put("covers", value=None), MalformedCertificate, "covers is a list"),
    (put("covers", value=[[7, [], [0, 1, 2, 3, 4]]]), MalformedCertificate, "a cover is"),
    (put("covers", value=[[0, [], [4]]]), MalformedCertificate, "two nodes or more"),
    (put("covers", value=[[0, [], [0, 1], [1, 2], [2, 3]]]), RejectedCertificate, "inside no set of a cover"),
    (put("covers", value=[[0, [], [1, 0]]]), MalformedCertificate, "a set of a cover"),
    (put("covers", value=[[0, [[1, 0]], [0, 1]]]), MalformedCertificate, "a start of a cover"),
    (put("covers", value=[[0, 1, [0, 1]]]), MalformedCertificate, "the starts of a cover"),
    (put("covers", value=[[0]]), MalformedCertificate, "a cover is"),
    (put("lengths", value=[0]), MalformedCertificate, "lengths is a list"),
    (put("lengths", value=[1]), MalformedCertificate, "add up"),
    (put("lengths", value=None), MalformedCertificate, "lengths is a list"),
]


@pytest.mark.parametrize(("change", "error", "words"), FORGERIES, ids=[words for *_, words in FORGERIES])
def test_one_thing_changed_in_an_honest_certificate(
    change: Callable[[dict[str, Any]], object], error: type[CertificateError], words: str
) -> None:
    with pytest.raises(error, match=words):
        verify_mending(PATH.canonical_bytes(), changed(made(), change))


def test_a_choice_that_does_not_reach_the_goal_is_refused() -> None:
    """Every other choice of as many links is certified only if it is robust: the body proves another graph."""
    data, subject = made(), PATH.canonical_bytes()
    document = json.loads(data.partition(b"\n")[0])
    honest, links = document["actions"]["chosen"], document["actions"]["links"]
    for chosen in combinations(range(len(links)), len(honest)):
        if list(chosen) != honest:
            with pytest.raises(CertificateError):
                verify_mending(subject, changed(data, put("actions", "chosen", value=list(chosen))))


def test_bodies_are_counted_and_belong_to_a_choice() -> None:
    data, subject = made(), PATH.canonical_bytes()

    def nothing_chosen(document: dict[str, Any]) -> None:
        document["claim"]["cost"] = document["actions"]["chosen"] = None

    with pytest.raises(RejectedCertificate, match="not one for every part"):
        verify_mending(subject, changed(data, nothing_chosen))
    with pytest.raises(MalformedCertificate, match="add up"):
        verify_mending(subject, data + b"x")
    tolerant = made(GOALS[4])
    with pytest.raises(CertificateError):
        verify_mending(subject, changed(tolerant, put("claim", "parts", 0, "f", value=2)))
    with pytest.raises(CertificateError):
        verify_mending(subject, changed(tolerant, put("claim", "parts", 0, "bound", value="local")))


def test_mutations_never_prove_more() -> None:
    """Any number of a certificate of two parts, replaced by another: refused, or a claim that is still true."""
    rng, subject = random.Random(11), PATH.canonical_bytes()
    data = certify_mending(rb.mend(PATH, [rb.Goal(2), rb.Goal(survive=1, model="delayed")]))
    assert data is not None
    true = {"least": verify_mending(subject, data).least}
    for _ in range(300):
        header, _, body = data.partition(b"\n")
        places = [k for k, byte in enumerate(header) if chr(byte).isdigit()]
        place = rng.choice(places)
        mutated = header[:place] + rng.choice("0123456789").encode() + header[place + 1 :] + b"\n" + body
        try:
            claim = verify_mending(subject, mutated)
        except CertificateError:
            continue
        assert claim.cost is not None
        assert claim.goal == "(2,1)-robust and no trap for f = 1 in total"
        if claim.least is not None and claim.least > (true["least"] or 0):
            assert confirm_least(subject, mutated).verdict is not LeastVerdict.CONFIRMED
            assert not verify_mending(subject, mutated, lambda looked: looked < 3_000).is_least


def test_misuse_and_size(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(Misuse):
        verify_mending("graph", b"")  # type: ignore[arg-type]
    monkeypatch.setattr("certificates.stream.MAX_CERTIFICATE_BYTES", 10)
    with pytest.raises(MalformedCertificate, match="at most"):
        verify_mending(PATH.canonical_bytes(), made())


def test_one_way_links_of_a_directed_graph() -> None:
    ring = as_digraph(nx.DiGraph([(0, 1), (1, 2), (2, 3), (3, 0)]))
    data = certify_mending(rb.mend(ring, 2))
    assert data is not None
    assert confirm_least(ring.canonical_bytes(), data).verdict is LeastVerdict.CONFIRMED
    assert isinstance(ring, Digraph)


def test_work_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    network = nx.cycle_graph(6)
    data = certify_mending(rb.mend(network, 2))
    assert data is not None
    graph = as_digraph(network).canonical_bytes()
    verify_mending(graph, data)
    monkeypatch.setattr("certificates.mending.MAX_LOOKS", 17)
    with pytest.raises(MalformedCertificate, match="pairs take more than 17 looks at nodes and arcs"):
        verify_mending(graph, data)
    with pytest.raises(MalformedCertificate, match="covers take more than 17 looks at nodes"):
        verify_mending(graph, changed(data, put("pairs", value=[])))
