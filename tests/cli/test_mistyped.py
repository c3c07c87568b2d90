"""What is mistyped is answered with what was probably meant, and in words."""

from __future__ import annotations

import re
from pathlib import Path

import click
import networkx as nx
import pytest
from click.testing import CliRunner

from cli.main import robustness
from robustness.files import write_topology


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_topology(nx.cycle_graph(4), "square.json")
    (tmp_path / "steps").mkdir()
    return tmp_path


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("typed", "code", "answer"),
    [
        ("chek square.json", 2, "did you mean check?"),
        ("build plattoon", 2, "did you mean platoon"),
        ("build zzzz", 2, "No such family 'zzzz': robustness build --list"),
        ("check sqaure.json", 3, "cannot be read: No such file or directory: did you mean square.json?"),
        ("check square.jso", 3, "cannot be read: No such file or directory: did you mean square.json?"),
        ("check nowhere/square.json", 3, "nowhere/square.json: cannot be read: No such file or directory"),
        ("check steps", 3, "steps: is a directory, not a file; joint, tolerance --tau and simulate --over-time read"),
        ("check square.json -r x", 2, "'x' is not a whole number."),
        ("verify square.json x -r x", 2, "'x' is not a whole number."),
        ("simulate square.json --alpha x", 2, "'x' is not a number."),
        ("sample square.json --error x", 2, "'x' is not a number."),
    ],
)
def test_the_answer_says_what_is_wrong_and_what_was_meant(typed: str, code: int, answer: str) -> None:
    outcome = CliRunner().invoke(robustness, typed.split())
    assert (outcome.exit_code, answer in " ".join(outcome.stderr.split())) == (code, True), outcome.stderr


def test_no_number_is_called_by_its_type_in_python() -> None:
    context = click.Context(robustness)
    for name in robustness.list_commands(context):
        command = robustness.get_command(context, name)
        assert command is not None
        for option in command.params:
            if not isinstance(option, click.Option) or option.is_flag or option.metavar == "NODE":
                continue
            said = CliRunner().invoke(robustness, [name, option.opts[-1], "@@"]).stderr
            assert not re.search(r"valid (integer|float|range)", said), said
