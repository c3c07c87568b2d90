"""Names that others chose do not steer the terminal: every command, in colour, on a path that tries to."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from cli.main import COMMANDS, robustness
from cli.output import Console

SQUARE = Path(__file__).parents[2] / "tests" / "data" / "square.json"
EVIL = "a\x1b[2J\x1b]0;title\x07\x9b31m\u202e"

#: GRAPH is a good file and BAD no file, both with such names; OUT begins the name of what is written.
LINES = [
    "check GRAPH", "check BAD", "check topohub:EVIL",
    "certify GRAPH -r 1 -o OUT.cert", "certify GRAPH -r 1 -o OUT/none.cert",
    "verify GRAPH BAD", "verify BAD GRAPH",
    "joint GRAPH -r 1", "joint BAD -r 1",
    "tolerance GRAPH -o OUT", "tolerance BAD",
    "build wheel --n 5 -o OUT.json", "build EVIL", "build wheel --n EVIL",
    "find -n 4 -p EVIL", "find -n 4 -p 1-robust -o OUT.json",
    "simulate GRAPH --save OUT.json", "simulate GRAPH --attack BAD", "simulate --replay BAD",
    "attack GRAPH -o OUT.json", "attack BAD",
    "sample GRAPH -r 1", "sample BAD",
    "survey GRAPH BAD", "report GRAPH BAD -o OUT.html",
    "draw GRAPH -o OUT.svg", "draw BAD -o OUT.svg",
    "mend GRAPH -r 2 -o OUT.json", "thin GRAPH -r 1 -o OUT.json", "mend BAD -r 1",
    "EVIL", "check GRAPH EVIL", "check GRAPH --EVIL", "check GRAPH --algorithm EVIL", "--EVIL",
]  # fmt: skip


def test_every_command_is_tried() -> None:
    assert {line.split()[0] for line in LINES} >= set(COMMANDS)


@pytest.mark.parametrize("line", LINES)
def test_no_command_passes_sequences_on(line: str, tmp_path: Path) -> None:
    good = tmp_path / f"{EVIL}.json"
    shutil.copy(SQUARE, good)
    places = {"GRAPH": str(good), "BAD": str(tmp_path / f"no{EVIL}.json"), "OUT": str(tmp_path / f"out{EVIL}")}
    arguments = [
        re.sub("GRAPH|BAD|OUT", lambda word: places[word[0]], part).replace("EVIL", EVIL) for part in line.split()
    ]
    outcome = CliRunner().invoke(robustness, ["--color", "always", *arguments], color=True)
    assert outcome.exit_code in (0, 2, 3, 10, 30), outcome.output
    said = re.sub(r"\x1b\[\d{1,2}m", "", outcome.output)  # colours of the toolkit's own
    assert all(letter.isprintable() or letter == "\n" for letter in said), repr(said)


@pytest.mark.parametrize("say", [Console.result, Console.talk, Console.warn, Console.error])
def test_only_the_colour_of_the_head_is_passed_on(say: object, capsys: pytest.CaptureFixture[str]) -> None:
    text = click.style("robust:", fg="green", bold=True) + " a\x1b[31m\x1b[1mb:\x1b[0m\r\x07"
    with click.Context(robustness, color=True).scope():
        say(Console(), text)  # type: ignore[operator]
    captured = capsys.readouterr()
    shown = captured.out + captured.err
    assert "a\\x1b[31m\\x1b[1mb:\\x1b[0m\\r\\x07" in shown
    assert "\x07" not in shown
