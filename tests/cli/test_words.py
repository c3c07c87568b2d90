"""The words of the command line: help that fits and has no markup, one spelling, lines that fit a terminal."""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import sys
import termios
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import click
import networkx as nx
import pytest
from click.testing import CliRunner

from cli.main import robustness
from robustness.constructions import FAMILIES
from robustness.files import write_topology

ROOT = Path(__file__).parents[2]

#: What reStructuredText, numpydoc and doctest leave behind.
MARKUP = re.compile(r":\w+:`|``|>>>|-----|\*\*|\*\w+\.?\*|\\b|\bNone\b|\bTrue\b|\bFalse\b")

COMMANDS = robustness.list_commands(click.Context(robustness))
HELPED = [(), *((name,) for name in COMMANDS), *(("build", name) for name in FAMILIES)]

#: Options that mean two things: nodes of one graph, and of each sample; one file, and a folder of them.
TWO_MEANINGS = {"--nodes", "--output", "--cost", "--expect", "--model", "--plot"}


@pytest.mark.parametrize("asked", HELPED, ids=" ".join)
@pytest.mark.parametrize("columns", ["80", "60"])
def test_help_fits_and_has_no_markup(asked: tuple[str, ...], columns: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    shown = CliRunner().invoke(robustness, [*asked, "--help"]).stdout
    assert shown.startswith("Usage: ")
    assert not MARKUP.search(shown), MARKUP.search(shown)
    assert not re.search(r"\w-\n", shown), "a name is cut"
    if columns == "80":
        assert [line for line in shown.splitlines() if len(line) > 80] == []
        assert not [line for line in shown.splitlines() if re.match(r"  [a-z-]+ +\S.*\.\.\.$", line)], "a cut sentence"


def options() -> Iterator[tuple[str, click.Command, click.Option]]:
    context = click.Context(robustness)
    for name in COMMANDS:
        command = robustness.get_command(context, name)
        assert command is not None
        for option in command.params:
            if isinstance(option, click.Option):
                yield name, command, option


def test_an_option_takes_the_same_wherever_it_is_met() -> None:
    takes: defaultdict[str, set[str]] = defaultdict(set)
    for _, command, option in options():
        for spelling in option.opts:
            if spelling.startswith("--") and spelling not in TWO_MEANINGS:
                takes[spelling].add("" if option.is_flag else option.make_metavar(click.Context(command)))
    assert {spelling: words for spelling, words in takes.items() if len(words) > 1} == {}


def test_every_command_prints_json_and_those_that_search_have_limits() -> None:
    has: defaultdict[str, set[str]] = defaultdict(set)
    for name, _, option in options():
        has[name].update(option.opts)
    for name, spellings in has.items():
        assert {"--json", "--quiet", "--verbose", "--color"} <= spellings, name
        if name not in ("build", "verify"):
            assert {"--timeout", "--jobs", "--seed"} <= spellings, name


def test_every_parameter_of_a_family_says_what_it_is() -> None:
    for name in FAMILIES:
        shown = CliRunner().invoke(robustness, ["build", name, "--help"]).stdout
        for line in shown.partition("Options:")[2].splitlines():
            if line.startswith("  -"):
                assert re.match(r"  -\S+(, --\S+)?( \S+)? {2,}[A-Za-z]", line) or line.endswith(
                    "[auto|always|never]"
                ), line
        assert shown.rstrip().endswith("Show this message and exit.")


@pytest.mark.parametrize(
    "asked",
    [
        ["attack", "NET", "-f", "1", "-o", "FILE.json"],
        ["build", "wheel", "--n", "5", "-o", "FILE.json"],
        ["certify", "NET", "-r", "1", "-o", "FILE.cert"],
        ["draw", "NET", "-r", "3", "-o", "FILE.svg"],
        ["find", "-n", "4", "-p", "2-robust", "-o", "FILE.json"],
        ["joint", "SEQ", "-r", "1", "-o", "FILE.cert"],
        ["mend", "NET", "-r", "2", "-o", "FILE.json"],
        ["report", "NET", "--no-models", "--no-pictures", "-o", "FILE.html"],
        ["simulate", "NET", "--steps", "5", "--save", "FILE.json"],
        ["simulate", "NET", "--steps", "5", "--plot", "FILE.svg"],
        ["survey", "NET", "--no-models", "-o", "FILE.csv"],
        ["thin", "NET", "-r", "1", "-o", "FILE.json"],
        ["tolerance", "NET", "--model", "malicious", "-o", "FILE.dir"],
    ],
    ids=lambda asked: f"{asked[0]} {asked[-2]}",
)
def test_what_is_written_is_said_after_the_answer(asked: list[str], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    write_topology(nx.cycle_graph(6), tmp_path / "net.json")
    target = str(tmp_path / asked[-1])
    names = {"NET": str(tmp_path / "net.json"), "SEQ": str(ROOT / "examples" / "round-robin.json")}
    command = [names.get(word, word) for word in asked[:-1]]
    outcome = CliRunner().invoke(robustness, [*command, target])
    assert outcome.exit_code in (0, 10, 30), outcome.output
    assert f"wrote {target}" in outcome.stderr
    if outcome.stdout:
        assert outcome.output.index(outcome.stdout.splitlines()[0]) < outcome.output.index(f"wrote {target}")
    quiet = CliRunner().invoke(robustness, [*command, target, "-q"])
    assert "wrote" not in quiet.output
    assert quiet.stdout.count("\n") <= 1


class TestOnATerminal:
    """Lines fit a terminal; to a program each stays one line."""

    @staticmethod
    def shown(columns: int, *arguments: str) -> str:
        ours, theirs = pty.openpty()
        termios.tcsetwinsize(theirs, (40, columns))
        clean = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES", "NO_COLOR")}
        process = subprocess.Popen(
            [sys.executable, "-m", "cli", *arguments], cwd=ROOT, env=clean, stdout=theirs, stderr=theirs
        )
        os.close(theirs)
        pieces = []
        with os.fdopen(ours, "rb", buffering=0) as terminal:
            while True:
                try:
                    piece = terminal.read(65536)
                except OSError:  # the other end is closed
                    break
                if not piece:
                    break
                pieces.append(piece)
        process.wait()
        return click.unstyle(b"".join(pieces).decode().replace("\r\n", "\n").rpartition("\r")[2])

    @pytest.mark.parametrize("columns", [60, 80])
    @pytest.mark.parametrize(
        "asked",
        [
            ["check", "tests/data/square.json"],
            ["attack", "tests/data/square.json", "-f", "1"],
            ["simulate", "tests/data/square.json", "--steps", "20"],
            ["simulate", "--experiment", "necessity"],
            ["joint", "examples/round-robin.json", "-r", "2"],
            ["tolerance", "tests/data/square.json", "--model", "malicious"],
            ["sample", "tests/data/square.json", "--seed", "1"],
            ["thin", "tests/data/square.json", "-r", "1"],
            ["check", "no/such/file/whose/name/is/rather/long/so/that/the/message/is/longer/than/a/line.json"],
        ],
        ids=" ".join,
    )
    def test_lines_fit(self, asked: list[str], columns: int) -> None:
        wide, narrow = self.shown(400, *asked), self.shown(columns, *asked)
        longest = max(map(len, re.findall(r"\S+", narrow)))
        assert max(map(len, narrow.splitlines())) <= max(columns, longest + 12)
        timeless = [re.sub(r"\d+\.\d+ s\b", "", text).split() for text in (wide, narrow)]
        assert timeless[0] == timeless[1]

    def test_what_goes_on_stands_below_what_it_says(self) -> None:
        _, split, cases = self.shown(60, "simulate", "--experiment", "necessity").partition("split      cycle of 6")
        assert split
        assert {len(line) - len(line.lstrip()) for line in cases.splitlines()[1:]} == {0, 11}

    def test_a_graph_is_never_cut(self, tmp_path: Path) -> None:
        nodes = [f"a node with a name of {k} words" for k in range(3)]
        write_topology(nx.relabel_nodes(nx.path_graph(3), dict(enumerate(nodes))), tmp_path / "net.json")
        shown = self.shown(40, "build", "five-node-figure")
        assert CliRunner().invoke(robustness, ["build", "five-node-figure"]).stdout.strip() in shown


def test_one_line_with_q_also_of_an_experiment() -> None:
    outcome = CliRunner().invoke(robustness, ["simulate", "--experiment", "necessity", "-q"])
    assert re.fullmatch(r"Theorem 1, necessity: .*: 12 of 12 cases as reported\n", outcome.stdout)


def test_pages_and_pictures_have_documents_too(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    net, page, picture = (str(tmp_path / name) for name in ("net.json", "page.html", "net.svg"))
    write_topology(nx.cycle_graph(6), net)
    report = CliRunner().invoke(robustness, ["report", net, "-r", "2", "--no-models", "-o", page, "--json"])
    found = json.loads(report.stdout)
    assert (report.exit_code, found["schema"], found["output"]) == (10, "robustness/report/1", page)
    assert found["verdict"] == "The network must be 2-robust; it fails, with a counterexample."
    assert ([row["gate"] for row in found["rows"]], found["is_complete"]) == (["refuted"], True)
    drawn = CliRunner().invoke(robustness, ["draw", net, "-r", "2", "-o", picture, "--json"])
    found = json.loads(drawn.stdout)
    assert (drawn.exit_code, found["schema"], found["verdict"]) == (0, "robustness/draw/1", "not-robust")
    assert (found["graph"]["nodes"], found["output"], found["summary"]) == (6, picture, "not 2-robust")
    for command in ("report", "draw"):
        wrong = CliRunner().invoke(robustness, [command, net, "-o", net, "--json"])
        assert (wrong.exit_code, json.loads(wrong.stdout)["schema"]) == (2, "robustness/error/1")
