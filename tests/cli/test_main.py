"""The group: lazy commands, shared options, colour, progress and start-up."""

from __future__ import annotations

import io
import os
import pty
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import robustness as rb
from cli import choices, main
from cli.options import Seconds
from cli.output import Console, ProgressLine, set_text
from robustness.files import FORMAT_NAMES
from robustness.limits import Progress

ROOT = Path(__file__).parents[2]
SQUARE = str(ROOT / "tests" / "data" / "square.json")
#: What only some commands need, and no start-up should pay for.
HEAVY = {"matplotlib", "networkx", "ortools", "pandas", "topohub"}


def python(*arguments: str, **environment: str) -> str:
    """Run Python in the checkout and return its standard output."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


class TestCommands:
    def test_every_module_that_is_there_exposes_its_command_and_is_listed(self) -> None:
        context = click.Context(main.robustness)
        listed = main.robustness.list_commands(context)
        assert listed[0] == "check"
        for name in listed:
            command = main.robustness.get_command(context, name)
            assert isinstance(command, click.Command)
            assert command.name == name
            assert CliRunner().invoke(main.robustness, [name, "--help"]).exit_code == 0
            assert name in CliRunner().invoke(main.robustness, ["--help"]).stdout

    def test_seconds_are_one_kind_of_number_in_every_command(self) -> None:
        """Options that take seconds are told by their metavar; each of them refuses what no clock can tell."""
        refused = []
        for name in main.COMMANDS:
            command = main.robustness.get_command(click.Context(main.robustness), name)
            assert command is not None
            for option in command.params:
                if option.metavar == "SECONDS" or "timeout" in (option.name or ""):
                    assert isinstance(option.type, Seconds), (name, option.name)
                    for value in ("nan", "inf", "-1", "soon"):
                        with pytest.raises(click.BadParameter, match="number of seconds"):
                            option.type.convert(value, option, None)
                    refused.append((name, option.name))
        assert {("verify", "timeout"), ("survey", "total_timeout"), ("report", "mending")} <= set(refused)

    def test_a_module_that_is_not_there_breaks_no_help(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(main, "COMMANDS", {"check": "cli.check:command", "gone": "cli.gone:command"})
        shown = CliRunner().invoke(main.robustness, ["--help"])
        assert shown.exit_code == 0
        assert "gone" not in shown.stdout
        assert CliRunner().invoke(main.robustness, ["gone"]).exit_code == 2

    def test_a_module_that_is_broken_is_an_internal_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(main, "COMMANDS", {"check": "cli.check:no_such_attribute"})
        outcome = CliRunner().invoke(main.robustness, ["check", SQUARE])
        assert outcome.exit_code == 1
        assert "internal error, not a verdict: AttributeError" in outcome.stderr

    def test_algorithm_names_are_those_of_the_registry(self) -> None:
        assert choices.ALGORITHM_NAMES == ("auto", *rb.ALGORITHMS)
        assert choices.FORMAT_NAMES == tuple(FORMAT_NAMES)

    def test_version(self) -> None:
        outcome = CliRunner().invoke(main.robustness, ["--version"])
        assert outcome.exit_code == 0
        assert outcome.stdout == f"robustness {version('graph-robustness')}\n"


class TestStartUp:
    def test_help_imports_nothing_but_the_shell(self) -> None:
        loaded = python("-X", "importtime", "-c", _loaded_after("--help")).splitlines()[-1].split()
        assert HEAVY.isdisjoint(loaded)
        assert {"numpy", "robustness.kernels"}.isdisjoint(loaded)

    def test_check_on_a_small_graph_loads_no_solver(self) -> None:
        loaded = python("-c", _loaded_after("check", SQUARE)).splitlines()[-1].split()
        assert HEAVY.isdisjoint(loaded)
        assert "numpy" in loaded


def _loaded_after(*arguments: str) -> str:
    return (
        "import sys\nfrom cli.main import robustness\n"
        f"try: robustness({list(arguments)!r})\nexcept SystemExit: pass\n"
        "print(*sorted(name for name in sys.modules if '.' not in name))"
    )


class TestColour:
    def shown(self, *arguments: str, **environment: str) -> bytes:
        """Run on a terminal of our own and return what appears there."""
        ours, theirs = pty.openpty()
        command = [sys.executable, "-m", "cli", "check", SQUARE, *arguments]
        clean = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
        subprocess.run(command, cwd=ROOT, env={**clean, **environment}, stdout=theirs, stderr=theirs, check=True)
        os.close(theirs)
        with os.fdopen(ours, "rb") as terminal:
            return terminal.read1(100_000)

    def test_on_a_terminal(self) -> None:
        assert b"\x1b[32m" in self.shown()
        assert b"\x1b[32m" not in self.shown(NO_COLOR="1")
        assert b"\x1b[32m" in self.shown(NO_COLOR="")
        assert b"\x1b[32m" not in self.shown("--color", "never")
        assert b"\x1b[32m" in self.shown("--color", "always", NO_COLOR="1")

    @pytest.mark.parametrize("place", [0, 2])
    def test_elsewhere(self, place: int, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("NO_COLOR", raising=False)
        plain = CliRunner().invoke(main.robustness, ["check", SQUARE])
        assert "\x1b" not in plain.stdout
        asked = ["check", SQUARE]
        asked[place:place] = ["--color", "always"]
        assert "\x1b[32m" in CliRunner().invoke(main.robustness, asked).stdout

    def test_json_has_none(self) -> None:
        asked = ["--color", "always", "check", SQUARE, "--json"]
        assert "\x1b" not in CliRunner().invoke(main.robustness, asked).stdout


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class TestProgress:
    def drawn(self, monkeypatch: pytest.MonkeyPatch, stream: io.StringIO, console: Console) -> str:
        monkeypatch.setattr(sys, "stderr", stream)
        monkeypatch.setenv("TERM", "xterm")
        monkeypatch.setenv("COLUMNS", "200")
        seconds = iter(range(100))
        monkeypatch.setattr("time.monotonic", lambda: float(next(seconds)))
        with ProgressLine(console) as line:
            line.note_bounds(rb.Bounds(rb.Bound(2, "a"), rb.Bound(5, "b")))
            line(Progress(1_234_567, "3 roots left"))
        return stream.getvalue()

    def test_on_a_terminal_one_line_is_drawn_and_wiped(self, monkeypatch: pytest.MonkeyPatch) -> None:
        drawn = self.drawn(monkeypatch, Terminal(), Console())
        assert drawn == "\r\x1b[K1 s, 2 <= r* <= 5, 1,234,567 nodes visited, 3 roots left\r\x1b[K"

    def test_elsewhere_and_with_q_nothing_is_drawn(self, monkeypatch: pytest.MonkeyPatch) -> None:
        assert self.drawn(monkeypatch, io.StringIO(), Console()) == ""
        assert self.drawn(monkeypatch, Terminal(), Console(is_quiet=True)) == ""

    def test_redrawn_ten_times_a_second_at_most(self, monkeypatch: pytest.MonkeyPatch) -> None:
        stream = Terminal()
        monkeypatch.setattr(sys, "stderr", stream)
        monkeypatch.setenv("TERM", "xterm")
        clock = iter([i / 100 for i in range(1000)])
        monkeypatch.setattr("time.monotonic", lambda: next(clock))
        line = ProgressLine(Console())
        for i in range(500):
            line(Progress(i, ""))
        assert 40 <= stream.getvalue().count("visited") <= 50


def test_sets_are_in_canonical_order() -> None:
    nodes = ("b", 10, 9, "1", (1, "x"))
    assert set_text(nodes, nodes) == "{9, 10, 1, b, (1, x)}"
    assert set_text({1, "1"}, (1, "1", "2")) == "{1, '1'}"
    assert set_text(range(100), range(100)).endswith("58, 59, … 40 more}")
    assert set_text(range(100), range(100), whole=True).endswith("98, 99}")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_completes(shell: str) -> None:
    assert "ROBUSTNESS_COMPLETE" in python("-m", "cli", _ROBUSTNESS_COMPLETE=f"{shell}_source")
    asked = {"COMP_WORDS": "robustness ch", "COMP_CWORD": "ch" if shell == "fish" else "1"}
    assert "check" in python("-m", "cli", _ROBUSTNESS_COMPLETE=f"{shell}_complete", **asked)


@pytest.mark.parametrize("command", ["check", "attack", "simulate", "joint", "survey", "report", "verify"])
def test_bash_is_left_to_complete_files(command: str) -> None:
    asked = {"COMP_WORDS": f"robustness {command} plat", "COMP_CWORD": "2"}
    assert python("-m", "cli", _ROBUSTNESS_COMPLETE="bash_complete", **asked).strip() == "file,plat"


def test_every_option_says_what_it_takes_and_what_it_is_for() -> None:
    context = click.Context(main.robustness)
    for name in main.robustness.list_commands(context):
        command = main.robustness.get_command(context, name)
        assert command is not None
        for option in command.params:
            if isinstance(option, click.Option) and not option.hidden:
                shown, text = option.get_help_record(click.Context(command)) or ("", "")
                assert not re.search(r" (INTEGER|FLOAT|FILENAME|DIRECTORY)\b", shown), f"{name} {shown}"
                assert re.sub(r"\[.*?\]", "", text).strip(), f"{name} {shown} says nothing"
