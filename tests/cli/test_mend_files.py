"""Files that ``mend`` and ``thin`` read and write: what is wrong with them is told before the work, by its place."""

from __future__ import annotations

from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

from cli.exit_codes import ExitCode
from cli.main import robustness
from robustness.errors import InvalidParameter
from robustness.files import write_topology
from robustness.mending.front import links_within

#: A list of links that might be a matrix, with and without weights.
LISTS = ["0,2\n1,3\n", "0,2,1\n1,3,1\n0,3,1\n", "0 2\n1 3\n"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    write_topology(nx.path_graph(4), tmp_path / "path.json")
    return tmp_path / "path.json"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(robustness, [*map(str, arguments)])


@pytest.mark.parametrize("text", LISTS)
@pytest.mark.parametrize("option", ["--candidates", "--mandatory", "--forbid"])
def test_a_file_of_links_is_read_as_links(path: Path, text: str, option: str) -> None:
    links = path.with_name("links.csv")
    links.write_text(text)
    found = run("mend", path, "-r", 2, option, links)
    if option == "--forbid":
        assert found.exit_code == ExitCode.REFUTED
    else:
        assert found.exit_code == ExitCode.DONE, found.stderr
        assert {"  add  0 -- 2", "  add  1 -- 3"} <= set(found.stdout.splitlines())
    whole = path.with_name("whole.json")
    write_topology(nx.complete_graph(4), whole)
    kept = run("thin", whole, "-r", 1, "--keep", links)
    assert "drop  0 -- 2" not in kept.stdout
    assert kept.exit_code == ExitCode.DONE, kept.stderr


def test_links_of_a_list_run_one_way_where_the_command_says_so(tmp_path: Path) -> None:
    ring, links = tmp_path / "ring.json", tmp_path / "links.csv"
    write_topology(nx.DiGraph([(0, 1), (1, 2), (2, 0)]), ring)
    links.write_text("1,0\n2,1\n0,2\n")
    both = run("mend", ring, "-r", 2, "--mandatory", links)
    assert both.stdout.count("  add  ") == 3
    assert run("mend", ring, "-r", 2, "--mandatory", links, "--directed").stdout.count("  add  ") == 3
    links.write_text("0,1\n")
    assert run("mend", ring, "-r", 1, "--mandatory", links).stdout.count("  add  1 -> 0") == 1
    assert run("mend", ring, "-r", 1, "--mandatory", links, "--directed").stdout.count("  add  ") == 0


@pytest.mark.parametrize(
    ("command", "word"),
    [
        (["mend", "-o", "net.foo"], "net.foo: the suffix tells the format and is one of"),
        (["mend", "-o", "net.npz.bz2"], "the suffix tells the format"),
        (["mend", "--plot", "picture.foo"], "a picture's suffix is one of"),
        (["thin", "-o", "net.foo"], "the suffix tells the format"),
        (["thin", "--plot", "picture"], "a picture's suffix is one of"),
        (["mend", "--range", "-1"], "a range is a number of at least 0, not -1.0"),
        (["mend", "--range", "nan"], "a range is a number of at least 0, not nan"),
        (["mend", "--max-in-degree", "x"], "a file that says it of each node; x: No such file"),
        (["mend", "--candidates", "prices.csv", "--cost", "price"], "prices.csv: a cost is a finite number"),
        (["thin", "--keep", "links.csv"], "links.csv: the link 0 -- 2 is not in the network: leave it out"),
    ],
)
def test_what_is_wrong_is_told_before_the_work_with_its_place(
    path: Path, command: list[str], word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(path.parent)
    Path("links.csv").write_text("0,2\n")
    Path("prices.csv").write_text("a,b,price\n0,2,1.5\n0,3,x\n")
    done = run(command[0], path, "-r", 1, *command[1:])
    assert done.exit_code in (ExitCode.USAGE, ExitCode.BAD_INPUT)
    assert done.stdout == ""
    assert word in done.stderr
    assert "--format tells" not in done.stderr


def test_a_network_that_would_not_be_written_is_not_searched() -> None:
    done = run("find", "--nodes", "4", "--satisfies", "2-robust", "-o", "net.foo")
    assert "the suffix tells the format" in done.stderr
    assert done.stdout == ""


def test_no_range_is_negative() -> None:
    places = {0: (0.0, 0.0), 1: (3.0, 0.0)}
    assert links_within(places, 3.0) == [(0, 1)]
    for reach in (-3.0, float("nan")):
        with pytest.raises(InvalidParameter, match="a range is a number of at least 0"):
            links_within(places, reach)
