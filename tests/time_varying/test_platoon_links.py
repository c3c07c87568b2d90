"""The example ``examples/platoon_links.py`` says what its docstring says."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from robustness.time_varying import read_sequence

EXAMPLE = Path(__file__).parents[2] / "examples" / "platoon_links.py"


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("platoon_links", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_what_it_prints(
    example: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["platoon_links.py", "--save", str(tmp_path)])
    example.main()
    shown = capsys.readouterr().out
    for line in (
        "fast: 0 of 12 steps are 3-robust by themselves",
        "  jointly 3-robust over every l = 8 steps; tau = 11: l <= tau, so the corollary applies",
        "  simulated: 180 runs, every adversary in every vehicle: all agree",
        "slow: 0 of 240 steps are 3-robust by themselves",
        "  jointly 3-robust over every l = 142 steps; tau = 11: l > tau, so nothing is promised",
        "  spread 100 at step 0, 100 at step 2000, exact: True",
        "  simulated without any liar: split",
        "  the fast shuttle from the same start: agreement",
    ):
        assert line in shown.splitlines()
    fast = read_sequence(tmp_path / "fast.json")
    assert (fast.n, len(fast), fast.period) == (10, 12, 12)
    assert json.loads((tmp_path / "slow.json").read_text())["period"] == 240


def test_at_most_one_voice_of_the_other_lane_is_remembered_in_the_slow_shuttle(example: ModuleType) -> None:
    slow = example.shuttle(0.5)
    for start in slow.window_starts(example.TAU + 1):
        union = slow.union(start, example.TAU + 1)
        for node, label in enumerate(union.labels):
            heard = union.labels_of(union.in_neighbours(node).tolist())
            assert sum(other[0] != label[0] for other in heard) <= example.F
