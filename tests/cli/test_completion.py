"""The lines that the documentation has for completion, in the shells that are installed: Tab is pressed for real."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import shutil
import subprocess
import sys
import termios
import time
from pathlib import Path

import click
import pytest

from cli.main import robustness

ROOT = Path(__file__).parents[2]

#: A table row of docs/command-line.md: a shell, its start-up file, and what to write there.
ROW = re.compile(r"^\| (bash|zsh|fish) \| `~/(\S+)` \| `(.*)` \|$", re.MULTILINE)
LINES = {
    shell: (place, line.replace("\\|", "|"))
    for shell, place, line in ROW.findall((ROOT / "docs" / "command-line.md").read_text(encoding="utf-8"))
}


def typed(shell: str, keys: str, expected: str, home: Path) -> str:
    """Return what a shell shows after keys were pressed, until it shows what is expected or half a minute is over."""
    clean = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES", "PYTHONPATH")}
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    places = {"HOME": str(home), "ZDOTDIR": str(home), "XDG_CONFIG_HOME": str(home / ".config"), "PATH": path}
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (60, 150))
    process = subprocess.Popen(
        [shell, "-i"], cwd=home, env={**clean, **places, "TERM": "xterm", "PS1": "$ "},
        stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True,
        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
    )  # fmt: skip
    os.close(theirs)
    shown, is_typed, end = b"", False, time.monotonic() + 30
    quiet_since = time.monotonic()
    while time.monotonic() < end and expected not in plain(shown):
        if select.select([ours], [], [], 0.1)[0]:
            piece = os.read(ours, 65536)
            shown += piece
            quiet_since = time.monotonic()
            if b"\x1b[6n" in piece:  # where is the cursor?
                os.write(ours, b"\x1b[1;1R")
            if b"\x1b[c" in piece or b"\x1b[0c" in piece:  # what terminal is this?
                os.write(ours, b"\x1b[?62;c")
        elif not is_typed and shown and time.monotonic() - quiet_since > 1:  # the prompt is there
            is_typed, shown = True, b""
            os.write(ours, keys.encode())
    process.kill()
    process.wait()
    os.close(ours)
    return plain(shown)


def plain(shown: bytes) -> str:
    """Return what is seen, without colours; jumps of the cursor are blanks."""
    text = re.sub(r"\x1b\[\d*[A-HJKf]|\r", " ", shown.decode(errors="replace"))
    text = re.sub(r"\x1b[\[(][\d;?]*[A-Za-z]", "", text)
    return re.sub(r" +", " ", text)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("robustness certi\t", "certify"),
        ("robustness tolerance --requ\t", "--require"),
        ("robustness tolerance --model byz\t\t\t", "byzantine-local"),
        ("robustness check plat\t", "platoon,1.json"),
        ("robustness survey plat\t", "platoon,1.json"),
    ],
)
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_tab_key_completes(shell: str, keys: str, expected: str, tmp_path: Path) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    if not (Path(sys.executable).parent / "robustness").is_file():
        pytest.skip("the command is not installed")
    place, line = LINES[shell]
    target = tmp_path / place
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(line + "\n", encoding="utf-8")
    # Or fish reads all manual pages of the machine, in a process that outlives it.
    (tmp_path / ".local/share/fish/generated_completions").mkdir(parents=True)
    (tmp_path / "platoon,1.json").write_text("{}", encoding="utf-8")
    assert expected in typed(shell, keys, expected, tmp_path)


def test_fish_shows_what_stands_behind_a_comma(tmp_path: Path) -> None:
    source = subprocess.run(
        [sys.executable, "-m", "cli"], cwd=ROOT, env={**os.environ, "_ROBUSTNESS_COMPLETE": "fish_source"},
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert source.count('string split --max 1 ","') == source.count("string split") == 1


def test_what_shells_show_beside_a_command_is_not_cut() -> None:
    context = click.Context(robustness)
    for name in robustness.list_commands(context):
        command = robustness.get_command(context, name)
        assert command is not None
        assert "..." not in command.get_short_help_str(), name
