"""How files are read, as every command is told: the options, the note in JSON, and what they decide."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner

from cli.main import COMMANDS, robustness

OPTIONS = {"--format", "--directed", "--label-attribute", "--rows", "--columns", "--skip-lines"}


def check(path: Path, *options: str) -> dict[str, Any]:
    outcome = CliRunner().invoke(robustness, ["check", str(path), "--json", *options])
    assert outcome.exit_code == 0, outcome.output
    graph: dict[str, Any] = json.loads(outcome.stdout)["graph"]
    return graph


@pytest.mark.parametrize("name", sorted(set(COMMANDS) - {"build", "find"}))
def test_every_command_that_reads_a_network_is_told_how(name: str) -> None:
    command = robustness.get_command(click.Context(robustness), name)
    assert command is not None
    assert OPTIONS <= {option for parameter in command.params for option in parameter.opts}


def test_rows_and_directions(tmp_path: Path) -> None:
    matrix = tmp_path / "matrix.csv"
    matrix.write_text("0,1,1\n0,0,1\n0,0,0\n", encoding="utf-8")
    assert "--rows hear" in check(matrix)["read_as"]
    speak, hear = (check(matrix, "--rows", rows) for rows in ("speak", "hear"))
    assert speak["sha256"] == check(matrix)["sha256"] != hear["sha256"]
    assert check(matrix, "--undirected")["arcs"] == 6


def test_a_doubt_is_decided_by_the_option_that_the_refusal_names(tmp_path: Path) -> None:
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("1,2\n2,3\n", encoding="utf-8")
    refused = CliRunner().invoke(robustness, ["check", str(pairs)])
    assert (refused.exit_code, refused.stdout) == (3, "")
    assert "--format matrix or --format edge-list" in refused.stderr
    assert check(pairs, "--format", "edge-list")["arcs"] == 4
    gains = tmp_path / "gains.txt"
    gains.write_text("gain 1 2 -60\ngain 2 3 -60\n", encoding="utf-8")
    assert check(gains, "--columns", "source=2,target=3")["nodes"] == 3
    assert check(gains, "--columns", "source=2,target=3", "--directed")["arcs"] == 2


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--rows", "hear"], "rows means nothing in node-link JSON"),
        (["--format", "jsno"], "a format is one of json"),
        (["--columns", "time"], "columns are given as source=1,target=2"),
        (["--columns", "source=0,target=1"], "columns count from 1"),
        (["--columns", "source=1,target=1"], "names one twice"),
    ],
)
def test_options_that_mean_nothing(options: list[str], complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_text('{"nodes": [], "edges": []}', encoding="utf-8")
    outcome = CliRunner().invoke(robustness, ["check", str(path), *options])
    assert outcome.exit_code == 2
    assert complaint in outcome.stderr
    assert outcome.stderr.count("\n") == 1


def test_a_trace_is_told_its_columns(tmp_path: Path) -> None:
    trace = tmp_path / "trace.csv"
    trace.write_text("1,2,0\n2,3,1\n3,1,2\n", encoding="utf-8")
    refused = CliRunner().invoke(robustness, ["joint", str(trace), "-r", "1"])
    assert refused.exit_code == 3
    assert "--columns" in refused.stderr
    told = ["joint", str(trace), "-r", "1", "--columns", "source=1,target=2,time=3", "--json"]
    outcome = CliRunner().invoke(robustness, told)
    assert json.loads(outcome.stdout)["sequence"]["steps"] == 3
    assert "columns as asked" in json.loads(outcome.stdout)["sequence"]["read_as"]
