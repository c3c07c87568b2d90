"""find and the census with an executor: what they say is what they say without."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import robustness as rb
from cli import query
from cli.main import robustness as program
from robustness.cubes import opened_cluster, spreading
from robustness.cubes.executors import mapped
from robustness.paper.audit.census import CensusRow, census

QUESTION: dict[str, Any] = {"n": 26, "satisfies": ["6-robust"], "violates": ["8-robust"]}


@pytest.fixture
def spread(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Count the searches that are spread."""
    seen: list[object] = []
    search = spreading.search_by_cubes

    def counting(*arguments: Any, **options: Any) -> Any:
        seen.append(arguments[3].executor)
        return search(*arguments, **options)

    monkeypatch.setattr(spreading, "search_by_cubes", counting)
    return seen


@pytest.fixture
def client() -> Iterator[Any]:
    pytest.importorskip("distributed")
    for name in ("distributed", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with opened_cluster("local:2") as found:
        yield found


def digests(graphs: tuple[rb.Digraph, ...]) -> list[str]:
    return [graph.sha256 for graph in graphs]


def rows(found: tuple[CensusRow, ...]) -> list[tuple[object, ...]]:
    return [
        (row.n, row.f, row.connected, row.promised, row.refuted, digests(row.trapped), digests(row.free))
        for row in found
    ]


def test_what_breaks_a_proposal_is_searched_for_by_the_executor(spread: list[object]) -> None:
    alone = rb.find_graph(**QUESTION)
    assert spread == []
    with ThreadPoolExecutor(2) as pool:
        found = rb.find_graph(**QUESTION, executor=pool)
        assert set(spread) == {pool}
    assert (found.verdict, found.n, found.edges) == (alone.verdict, alone.n, alone.edges)


def test_traps_are_not_searched_for_by_an_executor() -> None:
    """Their search takes none."""
    with ThreadPoolExecutor(1) as pool:
        found = rb.find_graph(9, ["2-robust", "trap(1)"], ["trap(0)"], executor=pool, time_limit=60)
    assert found.graph is not None
    assert found.graph.graph["trap"] is not None


@pytest.mark.parametrize(
    ("command", "front", "jobs"),
    [
        (["find", "-n", "26", "-p", "6-robust"], "robustness.graph_search.find_graph", 1),
        (["check", "topohub:sndlib/abilene", "-r", "1"], "robustness.decision.front.check_rs_robustness", 1),
        (["check", "topohub:sndlib/abilene"], "robustness.decision.front.determine_robustness", 1),
        (["certify", "topohub:sndlib/abilene", "-r", "1", "-o"], "robustness.decision.certification.certify", 2),
    ],
    ids=["find", "check", "determine", "certify"],
)
def test_workers_of_this_machine_are_processes_to_verify_with_and_no_threads_of_solvers(
    command: list[str], front: str, jobs: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """With more threads CP-SAT proposes other graphs, and it may take minutes longer to."""
    asked: list[Any] = []

    def refuse(*_: Any, **options: Any) -> None:
        asked.append(options["jobs"])
        raise rb.InvalidParameter("enough")

    monkeypatch.setattr(front, refuse)
    monkeypatch.setattr(query, "joined_cluster", lambda _: object())
    target = [str(tmp_path / "proof")] if command[-1] == "-o" else []
    assert CliRunner().invoke(program, [*command, *target, "--cluster", "local:2"]).exit_code == 2
    assert asked == [jobs]


def test_an_executor_that_is_none() -> None:
    with pytest.raises(rb.InvalidParameter, match="executor is a"):
        rb.find_graph(5, ["2-robust"], executor=7)
    with pytest.raises(rb.InvalidParameter, match="executor is a"):
        mapped(7, abs, [1])


def test_the_census_in_other_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    """With graphs of six nodes grown from those of five, as those of eight are from seven."""
    monkeypatch.setattr(sys.modules[CensusRow.__module__], "LARGEST_GRAPHS", 5)
    alone = census(6)
    with ThreadPoolExecutor(2) as pool:
        assert rows(census(6, executor=pool)) == rows(alone)
    with ProcessPoolExecutor(2) as pool:
        assert mapped(pool, abs, [-1, 2, -3]) == [1, 2, 3]


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_on_a_real_cluster(client: Any, spread: list[object], monkeypatch: pytest.MonkeyPatch) -> None:
    found = rb.find_graph(**QUESTION, executor=client)
    assert (found.verdict.value, set(spread)) == ("found", {client})
    monkeypatch.setattr(sys.modules[CensusRow.__module__], "LARGEST_GRAPHS", 5)
    assert rows(census(6, executor=client)) == rows(census(6))


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_the_command(spread: list[object]) -> None:
    pytest.importorskip("distributed")
    done = CliRunner().invoke(program, ["find", "-n", "26", "-p", "6-robust", "-q", "--cluster", "local:2"])
    assert done.exit_code == 0, done.output
    assert spread
    wrong = CliRunner().invoke(program, ["find", "-n", "4", "-p", "2-robust", "--cluster", "local:0"])
    assert wrong.exit_code == 2
