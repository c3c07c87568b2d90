"""The same document on every machine, busy or idle, and the same order of nodes wherever they are shown."""

from __future__ import annotations

import json
import random
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner

import robustness as rb
from cli.main import robustness
from robustness.natural_order import in_natural_order

COMMANDS = [
    "check {graph}",
    "check {graph} -r 3",
    "certify {graph} -r 2 -o {folder}/proof.cert",
    "tolerance {graph}",
    "attack {graph} -f 2",
    "simulate {graph} --steps 40 --adversary greedy",
    "simulate {hard} --steps 10 -f 2 --schedule delayed",
    "joint {trace} -r 2",
    "find -n 6 -p 2-robust --fewest-edges",
    "survey {graph}",
    "mend {graph} -r 4",
]


class JumpingClock:
    """A clock that stands still for a while and then jumps, as one does on a machine that is busy with other work."""

    def __init__(self) -> None:
        self._draws, self._now = random.Random(4), time.monotonic()

    def __call__(self) -> float:
        self._now += self._draws.choice((0.0, 0.0, 0.0, 1e-6, 0.3, 40.0))
        return self._now


def without_seconds(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: without_seconds(each) for name, each in value.items() if name != "seconds"}
    return [without_seconds(each) for each in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("same")
    graph = nx.relabel_nodes(nx.gnp_random_graph(24, 0.35, seed=3), "n{}".format)
    rb.write_topology(graph, folder / "graph.json")
    rb.write_topology(nx.random_regular_graph(10, 80, seed=1), folder / "hard.json")
    links = [f"{k % 4},{u},{v}\n{k % 4},{v},{u}" for k, (u, v) in enumerate(graph.edges)]
    (folder / "trace.csv").write_text("time,source,target\n" + "\n".join(sorted(links)) + "\n")
    return {
        "graph": folder / "graph.json",
        "hard": folder / "hard.json",
        "trace": folder / "trace.csv",
        "folder": folder,
    }


def document_of(command: str, places: dict[str, Path]) -> Any:
    answer = CliRunner().invoke(robustness, [*command.format(**places).split(), "--json"])
    assert answer.exit_code in (0, 10, 30), answer.output
    return without_seconds(json.loads(answer.stdout))


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.partition(" ")[0])
def test_a_clock_that_jumps_changes_no_document(
    command: str, places: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    calm = document_of(command, places)
    clock = JumpingClock()
    monkeypatch.setattr(time, "monotonic", clock)
    monkeypatch.setattr(time, "perf_counter", clock)
    assert document_of(command, places) == calm


def lists_of_nodes(value: Any) -> Iterator[list[str]]:
    """Yield every list of labels in a document."""
    if isinstance(value, dict):
        for each in value.values():
            yield from lists_of_nodes(each)
    elif isinstance(value, list):
        if value and all(isinstance(each, str) and re.fullmatch(r"n\d+", each) for each in value):
            yield value
        for each in value:
            yield from lists_of_nodes(each)


@pytest.mark.parametrize("command", COMMANDS[:-2], ids=lambda command: command.partition(" ")[0])
def test_sets_are_shown_in_natural_order(command: str, places: dict[str, Path]) -> None:
    """``n2`` stands before ``n10``, in the document and in the text."""
    for shown in lists_of_nodes(document_of(command, places)):
        assert shown == in_natural_order(shown)
    text = CliRunner().invoke(robustness, [*command.format(**places).split(), "-v"]).stdout
    for braces in re.findall(r"\{([^{}]*)\}", text):
        shown = re.findall(r"n\d+", braces)
        assert shown == in_natural_order(shown)
