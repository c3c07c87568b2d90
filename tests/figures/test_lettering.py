"""Letters that no font of the machine has: one line in all, and pictures that are written all the same."""

from __future__ import annotations

import warnings
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner

import robustness as rb
from cli.main import robustness
from robustness.digraph import GraphWarning
from robustness.figures.lettering import missing_letters
from robustness.figures.network import draw_to_file
from robustness.files import write_topology

LETTERS = "\u8282\u70b9\u7f51\u7edc\u5317\u4eac"
ABROAD = nx.relabel_nodes(nx.cycle_graph(6), dict(enumerate(LETTERS)))


@pytest.mark.parametrize("suffix", [".png", ".pdf"])
def test_one_line_tells_of_all_letters_and_the_file_is_there(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"drawn{suffix}"
    with pytest.warns(GraphWarning, match="no font of matplotlib here has .* and 1 more, and boxes") as heard:
        draw_to_file(ABROAD, None, path)
    assert len(heard) == 1
    assert path.stat().st_size > 1000


def test_notebooks_tell_it_once() -> None:
    with pytest.warns(GraphWarning) as heard:
        page = rb.check_rs_robustness(ABROAD, 2)._repr_html_()
    assert len(heard) == 1
    assert "<img" in page


def test_in_svg_the_letters_stay_text(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        draw_to_file(ABROAD, None, tmp_path / "abroad.svg")
        draw_to_file(nx.cycle_graph(3), None, tmp_path / "home.svg")
    drawn = (tmp_path / "abroad.svg").read_text(encoding="utf-8")
    assert all(f">{letter}</text>" in drawn for letter in LETTERS)
    assert "</text>" not in (tmp_path / "home.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("asked", "written"),
    [
        (["draw", "-r", "2", "-o"], "a.png"),
        (["simulate", "-f", "0", "--steps", "3", "--animate"], "a.gif"),
        (["simulate", "-f", "0", "--steps", "3", "--animate"], "a.html"),
        (["simulate", "-f", "0", "--steps", "3", "--plot"], "a.png"),
    ],
)
def test_on_the_command_line_it_is_one_line(asked: list[str], written: str, tmp_path: Path) -> None:
    write_topology(ABROAD, tmp_path / "abroad.json")
    command, *options = asked
    shown = CliRunner().invoke(robustness, [command, str(tmp_path / "abroad.json"), *options, str(tmp_path / written)])
    assert "Glyph" not in shown.stderr
    assert shown.stderr.count("no font of matplotlib") == 1
    assert (tmp_path / written).stat().st_size > 1000


def test_other_warnings_are_kept() -> None:
    def draw() -> int:
        warnings.warn("Glyph 33410 (x) missing from font(s) A.", UserWarning, stacklevel=1)
        warnings.warn("something else", UserWarning, stacklevel=1)
        return 7

    with pytest.warns(UserWarning, match="something else") as heard:
        assert missing_letters(draw) == (7, "\u8282")
    assert len(heard) == 1
