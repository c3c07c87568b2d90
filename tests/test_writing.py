"""Files are written whole or not at all, devices are written into, and no output is an input or another output."""

from __future__ import annotations

import errno
import os
import re
import stat
import threading
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner

import robustness as rb
from cli.main import robustness
from robustness.files import write_topology
from robustness.files.writing import forget_unfinished, replace_file, require_different_files


def test_a_device_is_written_into_and_stays_a_device() -> None:
    replace_file("/dev/null", b"gone")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_a_pipe_is_written_into(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()))
    reader.start()
    replace_file(pipe, b"through")
    reader.join(20)
    assert read == [b"through"]
    assert stat.S_ISFIFO(os.stat(pipe).st_mode)


def test_a_link_stays_and_what_it_leads_to_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "old").write_bytes(b"old")
    (tmp_path / "link").symlink_to("old")
    replace_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "old").read_bytes() == b"new"


def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left") as caught:
        replace_file(tmp_path / "file", b"new")
    assert caught.value.filename == str(tmp_path / "file")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_a_process_that_ends_while_a_thread_writes_leaves_nothing_half_written(tmp_path: Path) -> None:
    begun, goes_on = threading.Event(), threading.Event()
    problems: list[OSError] = []

    def blocks() -> Iterator[bytes]:
        yield b"half"
        begun.set()
        assert goes_on.wait(30)

    def work() -> None:
        try:
            replace_file(tmp_path / "x.cert", blocks())
        except OSError as problem:
            problems.append(problem)

    thread = threading.Thread(target=work)
    thread.start()
    assert begun.wait(30)
    assert len(list(tmp_path.iterdir())) == 1
    forget_unfinished()
    assert list(tmp_path.iterdir()) == []
    goes_on.set()
    thread.join(30)
    assert len(problems) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        replace_file(tmp_path, b"")


def test_files_are_told_apart_by_what_they_are_and_not_by_name(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"")
    (tmp_path / "link").symlink_to("a")
    for inputs, outputs in (
        ([tmp_path / "a"], [tmp_path / "a"]),
        ([tmp_path / "a"], [tmp_path / "link"]),
        ([], [tmp_path / "b", tmp_path / "." / "b"]),
    ):
        with pytest.raises(rb.InvalidParameter, match="is the same file as"):
            require_different_files(inputs, outputs)
    require_different_files(["-", None, tmp_path / "a"], [tmp_path / "b", None, "/dev/null", "/dev/null"])


#: Every command that writes, with an output that is its input; {graph} stands for both.
OVERWRITING = [
    ["certify", "{graph}", "-r", "2", "-o", "{graph}"],
    ["certify", "{graph}", "-r", "2", "-o", "{folder}/x", "--canonical", "{folder}/x"],
    ["attack", "{graph}", "-o", "{graph}"],
    ["simulate", "{graph}", "--save", "{graph}"],
    ["simulate", "{graph}", "--plot", "{folder}/p.svg", "--animate", "{folder}/p.svg"],
    ["tolerance", "{graph}", "-o", "{folder}"],
    ["joint", "{graph}", "-r", "2", "--certificate", "{graph}"],
    ["joint", "{graph}", "-r", "2", "--canonical", "{folder}/x", "--certificate", "{folder}/x"],
    ["draw", "{graph}", "-o", "{graph}"],
]


@pytest.mark.parametrize("arguments", OVERWRITING, ids=lambda given: f"{given[0]} {given[-1]}")
def test_no_command_overwrites_its_input_or_its_own_output(arguments: list[str], tmp_path: Path) -> None:
    graph = tmp_path / "graph.json"
    write_topology(nx.wheel_graph(5), graph)
    before = graph.read_bytes()
    outcome = CliRunner().invoke(robustness, [each.format(graph=graph, folder=tmp_path) for each in arguments])
    assert outcome.exit_code == 2, outcome.output
    assert "is the same file as" in outcome.stderr
    assert graph.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["graph.json"]


@pytest.mark.parametrize("suffix", [".json", ".graphml", ".gexf", ".gml", ".dot"])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_network_is_written_with_its_map(suffix: str, tmp_path: Path) -> None:
    """Labels such as 2 and 10 stand in another order once they are text."""
    drawn = nx.cycle_graph(12)
    nx.set_node_attributes(drawn, {i: (1.5 * i, -i / 3) for i in drawn}, "pos")
    mended = rb.mend(drawn, 2).graph
    write_topology(mended, tmp_path / f"mended{suffix}")
    read = rb.read_topology(tmp_path / f"mended{suffix}")
    assert read.places is not None
    assert {int(str(label)): place for label, place in zip(read.labels, read.places, strict=True)} == {
        i: (1.5 * i, -i / 3) for i in drawn
    }


def test_half_a_map_is_not_written(tmp_path: Path) -> None:
    half = nx.cycle_graph(3)
    half.nodes[0]["pos"] = (1, 2)
    assert rb.Digraph.from_networkx(half).places is None
    write_topology(half, tmp_path / "half.json")
    assert "pos" not in (tmp_path / "half.json").read_text(encoding="utf-8")


LINES = [
    "survey GRAPH -o OUT.csv", "survey GRAPH --state OUT", "report GRAPH -o OUT.html", "draw GRAPH -r 2 -o OUT.svg",
    "find -n 4 -p 1-robust -o OUT.json", "attack GRAPH -o OUT.json", "mend GRAPH -r 2 -o OUT.json",
    "certify GRAPH -r 1 -o OUT.cert", "simulate GRAPH --steps 3 --save GRAPH/out.json",
    "tolerance GRAPH -o GRAPH/evidence", "simulate GRAPH --plot x.odd", "simulate GRAPH --animate x.png",
    "joint GRAPH -r 1 --plot x.odd",
]  # fmt: skip


@pytest.mark.parametrize("line", LINES)
def test_no_work_is_done_for_a_place_that_cannot_be_written(line: str, tmp_path: Path) -> None:
    graph = str(Path(__file__).parent / "data" / "square.json")
    arguments = line.replace("OUT", str(tmp_path / "none" / "out")).replace("GRAPH", graph).split()
    outcome = CliRunner().invoke(robustness, arguments)
    assert outcome.exit_code == 2
    assert re.match("error: (cannot write|a picture's suffix|an animation's suffix) ", outcome.stderr)
    assert outcome.stdout == ""
