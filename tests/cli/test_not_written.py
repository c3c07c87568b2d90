"""A file that was asked for and is not written is told of, with the reason."""

from __future__ import annotations

from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner

from cli.main import robustness
from robustness.files import write_topology


@pytest.mark.parametrize(
    ("asked", "missing", "there"),
    [
        ("attack complete.json -f 1 -o attack.json", ["attack.json"], []),
        ("find -n 3 -p 3-robust -o found.json", ["found.json"], []),
        (
            "mend path.json -r 2 --candidates one.json -o mended.json --goal-certificate goal.cert --plot pair.svg",
            ["mended.json", "goal.cert"],
            ["pair.svg"],
        ),
        ("mend path.json -r 2 --budget 1 -o mended.json --plot links.svg", ["mended.json", "links.svg"], []),
        ("thin path.json -r 2 -o thin.json", ["thin.json"], []),
    ],
)
def test_what_is_not_written_is_told(
    asked: str, missing: list[str], there: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_topology(nx.complete_graph(5), "complete.json")
    write_topology(nx.path_graph(4), "path.json")
    write_topology(nx.Graph([(0, 2)]), "one.json")
    outcome = CliRunner().invoke(robustness, asked.split())
    assert outcome.exit_code == 10, outcome.output
    for name in missing:
        assert outcome.stderr.count(f"not written: {name}, as no ") == 1
        assert not (tmp_path / name).exists()
    for name in there:
        assert outcome.stderr.count(f"wrote {name}\n") == 1
        assert "S1: " in (tmp_path / name).read_text()
