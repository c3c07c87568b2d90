"""What the README promises is what the program does: commands, exit codes, examples."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cli.exit_codes import ExitCode
from cli.main import COMMANDS

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMAND_LINE = (ROOT / "docs" / "command-line.md").read_text(encoding="utf-8")
CODE = re.compile(r"^\| (\d+) \|", flags=re.MULTILINE)


def blocks(text: str, language: str) -> list[str]:
    """Return the fenced blocks of ``language``."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [README, COMMAND_LINE], ids=["README", "docs/command-line"])
def test_the_table_of_exit_codes_is_whole(page: str) -> None:
    assert sorted(map(int, CODE.findall(page))) == sorted(ExitCode)


def test_every_command_is_documented() -> None:
    assert set(re.findall(r"^\| `(\w+) ", COMMAND_LINE, flags=re.MULTILINE)) == set(COMMANDS)


def test_the_tour_of_the_command_line_runs(tmp_path: Path) -> None:
    """In the order of the README, in a folder of its own: each line gives an answer, yes or no."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    (tour,) = (block for block in blocks(README, "console") if block.startswith("robustness "))
    for line in tour.splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == "robustness"
        command = [sys.executable, "-m", "cli", *arguments]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode in (ExitCode.DONE, ExitCode.REFUTED), f"{line}\n{done.stderr}"
        assert done.stdout, line


@pytest.mark.parametrize("page", ["README.md", "docs/getting-started.md", "docs/simulation.md"])
def test_the_python_example_prints_what_its_comments_say(page: str) -> None:
    examples = blocks((ROOT / page).read_text(encoding="utf-8"), "python")
    assert examples
    for example in examples:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(example, page, "exec"), {})  # noqa: S102 - our own page
        promised = [line.partition("  # ")[2] for line in example.splitlines() if line.startswith("print")]
        for said, done in zip(promised, printed.getvalue().splitlines(), strict=True):
            assert said == done
