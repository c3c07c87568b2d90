"""Every front that takes a time limit takes threads, seed and progress with it, and hands all of them to the search."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import time
from collections.abc import Callable, Iterator
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness import mending, threat_models, time_varying, traps
from robustness.decision.algorithms import subset_search
from robustness.limits import Limits, Progress
from robustness.sampling import sample_robustness
from robustness.simulation import find_attack
from robustness.traps import searching

GRAPH = nx.gnp_random_graph(19, 0.5, seed=1)
SEQUENCE = rb.TimeVaryingGraph([GRAPH, GRAPH], period=2)
SECONDS, JOBS, SEED = 1000.0, 2, 7


def note(progress: Progress) -> None:
    """Hear how far the search is."""


def certificates_of_tolerance(**effort: Any) -> None:
    threat_models.certify_tolerance(rb.tolerance(GRAPH, "malicious"), **effort)


def joint_certificate(**effort: Any) -> None:
    time_varying.joint_certificate(SEQUENCE, time_varying.check_joint_robustness(SEQUENCE, 3, window=1), **effort)


def certificate_of_mending(**effort: Any) -> None:
    mending.certify_mending(rb.mend(GRAPH, 3), **effort)


#: A call of every public front that comes to a search.
FRONTS: dict[str, Callable[..., Any]] = {
    "check_rs_robustness": lambda **effort: rb.check_rs_robustness(GRAPH, 3, 2, **effort),
    "determine_robustness": lambda **effort: rb.determine_robustness(GRAPH, algorithm="subset-search", **effort),
    "robustness_profile": lambda **effort: rb.robustness_profile(
        nx.circulant_graph(9, [1, 2]), algorithm="subset-search", **effort
    ),
    "certify": lambda **effort: rb.certify(GRAPH, 3, 2, **effort),
    "find_trap": lambda **effort: traps.find_trap(GRAPH, 1, **effort),
    "smallest_trap": lambda **effort: traps.smallest_trap(GRAPH, 1, **effort),
    "tolerance": lambda **effort: rb.tolerance(GRAPH, "malicious", **effort),
    "certify_tolerance": certificates_of_tolerance,
    "check_joint_robustness": lambda **effort: rb.check_joint_robustness(SEQUENCE, 3, **effort),
    "joint_curve": lambda **effort: time_varying.joint_curve(SEQUENCE, **effort),
    "certify_joint": lambda **effort: time_varying.certify_joint(SEQUENCE, 3, **effort),
    "joint_certificate": joint_certificate,
    "find_attack": lambda **effort: find_attack(GRAPH, 1, "delayed", **effort),
    "mend": lambda **effort: rb.mend(GRAPH, 3, **effort),
    "thin": lambda **effort: rb.thin(GRAPH, 3, keep=list(GRAPH.edges), **effort),
    "best_within": lambda **effort: mending.best_within(GRAPH, 0, **effort),
    "certify_mending": certificate_of_mending,
    "sample_robustness": lambda **effort: sample_robustness(GRAPH, 2, nodes=18, repeats=1, **effort),
    "find_graph": lambda **effort: rb.find_graph(19, satisfies=["2-robust"], method="cp-sat", **effort),
}

#: Fronts that take part of it, and why.
PARTIAL = {
    "simulate": "a run draws its own numbers, from the seed of its start, and is over in seconds",
    "run_experiment": "the same",
    "validate_certificate": "runs only; its progress counts runs",
    "survey": "its threads take networks, and every network is searched by one",
    "report": "the same",
    "margin": "one 0-1 programme: the solver takes time, threads and seed, and tells no progress",
    "confirm_least": "a counted tree, and one 0-1 programme for HiGHS, which takes time alone",
    "guaranteed": "a small seed graph",
    "replay": "the same",
    "certify_derivation": "the same",
}


def public_fronts() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield every function with a time limit that a package of the library lists."""
    for module in pkgutil.walk_packages(rb.__path__, "robustness."):
        if not module.ispkg or ".audit" in module.name or module.name.startswith("robustness.cli"):
            continue
        room = importlib.import_module(module.name)
        for name in getattr(room, "__all__", ()):
            found = getattr(room, name)
            if inspect.isfunction(found) and "time_limit" in inspect.signature(found).parameters:
                yield name, found
    for name in rb.__all__:
        found = getattr(rb, name)
        if inspect.isfunction(found) and "time_limit" in inspect.signature(found).parameters:
            yield name, found


def test_every_front_is_in_the_table() -> None:
    found = dict(public_fronts())
    assert set(found) <= set(FRONTS) | set(PARTIAL)
    assert {"certify", "find_graph", "find_attack", "check_joint_robustness", "survey", "guaranteed"} <= set(found)
    for name in set(found) - set(PARTIAL):
        assert {"time_limit", "jobs", "seed", "progress"} <= set(inspect.signature(found[name]).parameters), name


@pytest.mark.parametrize("name", FRONTS)
def test_the_search_gets_all_of_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[Limits] = []

    def listening(decide: Callable[..., Any]) -> Callable[..., Any]:
        def work(*arguments: Any, **options: Any) -> Any:
            heard.extend(each for each in arguments if isinstance(each, Limits))
            return decide(*arguments, **options)

        return work

    # Nothing is settled before the search.
    for ladder in ("robustness.decision.ladder", "robustness.decision.certification"):
        monkeypatch.setattr(f"{ladder}.settle", lambda *_: None)
    monkeypatch.setattr("robustness.decision.ladder.TRANSFORM_NODES", 1)
    for room in ("traps.ladder", "threat_models.decisions"):
        monkeypatch.setattr(f"robustness.{room}.settle_trap", lambda *_: None)
    monkeypatch.setattr(subset_search, "decide", listening(subset_search.decide))
    monkeypatch.setattr(searching, "decide", listening(searching.decide))
    prepared = {
        "certify_tolerance",
        "certify_mending",
        "joint_certificate",
    }  # whose answer to certify was found without limits
    started = time.monotonic()
    FRONTS[name](time_limit=SECONDS, jobs=JOBS, seed=SEED, progress=note)
    asked = [limits for limits in heard if limits.seed == SEED] if name in prepared else heard
    assert asked
    for limits in asked:
        assert limits.seed == SEED
        assert limits.progress is note
        assert limits.jobs == JOBS or limits.steps is not None, "a counted search has one thread"
        assert limits.deadline is not None
        assert limits.deadline <= time.monotonic() + SECONDS
        assert limits.deadline > started
