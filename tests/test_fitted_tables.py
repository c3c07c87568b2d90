"""The table of a survey on a terminal: it fits, and says all that the table says that is as wide as it likes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from cli import survey as survey_command
from cli.choices import THREAT_MODEL_NAMES
from cli.main import robustness
from robustness.printable import width_of
from robustness.surveying.fitting import fitted
from robustness.surveying.row import Row
from robustness.surveying.tables import cells, text

DATA = Path(__file__).parent / "data"

ROW = Row("", nodes=161, arcs=3320, r=1, r_at_most=2, s=1, s_at_most=161, gate="undecided", seconds=12.5)


def row(name: str, error: str = "") -> Row:
    if error:
        return Row(name, gate="error", error=error)
    return replace(ROW, network=name, guaranteed=dict.fromkeys(THREAT_MODEL_NAMES, 1))


names = st.text("ab網 /-", min_size=1, max_size=40).map(str.strip).filter(bool)
rows = st.lists(st.builds(row, names, st.sampled_from(["", "", "no such file " * 12])), max_size=6)


@given(rows, st.integers(70, 200), st.sets(st.sampled_from(THREAT_MODEL_NAMES)))
def test_it_fits_and_leaves_nothing_out(listed: list[Row], width: int, asked: set[str]) -> None:
    models = [model for model in THREAT_MODEL_NAMES if model in asked]
    said = fitted(listed, models, width)
    assert all(width_of(line) <= width for line in said.splitlines())
    start = re.match("All names begin with (.*/)\n", said)
    words = said.split()
    for line in cells(listed, models)[1:]:
        name = line[0].removeprefix(start[1] if start else "")
        assert set(name.split()) <= set(words)
        wanted = line[-1].split() if line[-1] else [cell for cell in line[1:] if cell]
        assert any(words[k : k + len(wanted)] == wanted for k in range(len(words)))
    assert all(model in words or f"{model}," in words for model in models) or not listed


def test_what_fits_is_the_whole_table() -> None:
    listed = [row("a"), row("bb")]
    assert fitted(listed, THREAT_MODEL_NAMES, 200) == text(listed, THREAT_MODEL_NAMES)


def test_a_folder_is_said_once() -> None:
    said = fitted([row("topohub:sndlib/sun"), row("topohub:sndlib/pdh")], THREAT_MODEL_NAMES, 80)
    assert said.count("topohub:sndlib/") == 1
    assert said.splitlines()[-1] == "d delayed, dl delayed-local"


@pytest.mark.parametrize("width", [60, 80, None])
def test_the_command_asks_the_terminal(width: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(survey_command, "terminal_width", lambda: width)
    outcome = CliRunner().invoke(robustness, ["survey", str(DATA / "square.json"), "--require", "1"])
    longest = max(map(len, outcome.stdout.splitlines()))
    assert longest > 80 if width is None else longest <= max(width, len(str(DATA / "square.json")))
