"""The pages about tolerance: every command runs and ends as it says, and what is shown is printed."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks import traps
from certificates.__main__ import main as kernel
from cli.exit_codes import ExitCode
from cli.main import robustness
from robustness.threat_models import THREAT_MODELS
from robustness.traps import find_trap

DOCS = Path(__file__).parents[2] / "docs"
TUTORIAL = (DOCS / "tutorial-platoon.md").read_text(encoding="utf-8")
TOLERANCE = (DOCS / "tolerance.md").read_text(encoding="utf-8")


def blocks(page: str) -> list[tuple[str, list[str]]]:
    """Return language and lines of every fenced block."""
    found = re.findall(r"^```(\w+)\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    return [(language, text.splitlines()) for language, text in found]


def run(line: str) -> str:
    """Run one command of a page, expect its exit code (0, or what stands after #), and return what it prints."""
    command, _, comment = line.partition("  # ")
    expected = int(comment) if comment else ExitCode.DONE
    words = shlex.split(command)
    if words[:4] == ["python", "-I", "-m", "certificates"]:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            assert kernel(words[4:]) == expected, line
        return printed.getvalue()
    assert words[0] == "robustness"
    done = CliRunner().invoke(robustness, words[1:])
    assert done.exit_code == expected, f"{line}\n{done.output}"
    return done.output


def test_the_tutorial_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    printed = ""
    for language, lines in blocks(TUTORIAL):
        if language == "console":
            printed = "".join(run(line) for line in lines)
        else:
            assert [line for line in lines if line not in printed.splitlines()] == []
    assert (tmp_path / "split.png").stat().st_size > 10_000
    assert (DOCS / "figures" / "tutorial-platoon.png").exists()


def test_the_commands_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    steps = [[[u, v] for u in range(5) for v in range(5) if u != v and (u + v) % 2 == k] for k in (0, 1)]
    (tmp_path / "links.json").write_text(json.dumps({"nodes": list(range(5)), "period": 2, "steps": steps}))
    for language, lines in blocks(TOLERANCE):
        for line in lines if language == "console" else ():
            assert run(line)


def test_the_python_of_the_page_prints_what_its_comments_say() -> None:
    ((_, lines),) = [block for block in blocks(TOLERANCE) if block[0] == "python"]
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n".join(lines), "tolerance.md", "exec"), {})  # noqa: S102 - our own page
    promised = [line.partition("  # ")[2] for line in lines if line.startswith("print")]
    assert promised == printed.getvalue().splitlines()


def test_the_table_of_traps_is_the_benchmark_s_and_true() -> None:
    lines = TOLERANCE.partition(traps.HEAD)[2].splitlines()[2:]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
    made = traps.graphs(1)
    assert [(row[0], int(row[1])) for row in rows] == [(name, f) for name in made for f in (1, 2, 3)]
    quick = [row for row in rows if float(row[5]) < 0.02]
    assert len(quick) > 30
    for name, f, answer, *_ in quick:
        found = find_trap(made[name](), int(f), algorithm="search").decided()
        assert answer == ("yes" if found else "none"), (name, f)


def test_every_threat_model_is_on_the_page() -> None:
    for name, threat in THREAT_MODELS.items():
        (line,) = [line for line in TOLERANCE.splitlines() if line.startswith(f"| `{name}` |")]
        assert f"| {threat.condition.replace('(f+1,f+1)-robust', '$(f+1,f+1)$-robust')} |" in line
