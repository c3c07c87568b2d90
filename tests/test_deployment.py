"""The wheel as a hardened container runs it: a read-only tree, no rights, an empty environment, nothing cached."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cli.main import COMMANDS as ALL_COMMANDS

ROOT = Path(__file__).resolve().parent.parent
ROUND_ROBIN = str(ROOT / "examples" / "round-robin.json")

#: Puts the wheel first, makes sure that it is what runs and that its folder cannot be written, then is the command.
PROGRAM = """
import os, sys
site = sys.argv.pop(1)
sys.path.insert(0, site)
import robustness
from robustness import kernels
assert robustness.__file__.startswith(site), robustness.__file__
assert kernels.IS_COMPILED, kernels.WHY_NOT
try:
    open(os.path.join(site, "robustness", "kernels", "written"), "w")
except OSError:
    pass
else:
    raise SystemExit("the folder of the packages can be written")
from robustness.__main__ import main
sys.argv[0] = "robustness"
main()
"""

#: Every command with its exit code; OUT is the one folder that can be written.
COMMANDS = [
    ("check OUT/w.json", 0),
    ("certify OUT/w.json -r 2 -o OUT/w.cert", 0),
    ("verify OUT/w.json OUT/w.cert --expect robust -r 2", 0),
    ("tolerance OUT/w.json", 0),
    ("attack OUT/w.json -f 2", 0),
    ("simulate OUT/w.json", 0),
    (f"joint {ROUND_ROBIN} -r 2 --canonical OUT/w.sequence --certificate OUT/w.joint", 0),
    ("verify OUT/w.sequence OUT/w.joint --expect robust -r 2", 0),
    ("find -n 4..5 -p 2-robust", 0),
    ("sample OUT/w.json --nodes 5", 30),
    ("survey OUT/w.json", 0),
    ("draw OUT/w.json -o OUT/w.svg", 0),
    ("report OUT/w.json -o OUT/w.html", 0),
    ("mend OUT/w.json -r 3", 0),
    ("thin OUT/w.json -r 2", 0),
    ("--help", 0),
    ("--version", 0),
]


def _without_rights() -> Callable[[], None] | None:
    """Return what takes every capability from a child, so that root, too, is bound by the modes of files."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return None
    drop = ctypes.CDLL(None).prctl

    def give_up() -> None:
        for capability in range(64):
            drop(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP: gone for good with the next exec.

    return give_up


@pytest.fixture(scope="module")
def site(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The wheel, unpacked where nobody may write."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    below = [path for path in folder.rglob("*") if path.is_dir()]
    for path in (folder, *below):
        path.chmod(0o555)
    yield folder
    for path in (folder, *below):
        path.chmod(0o755)


def robustness(site: Path, command: str, out: Path) -> subprocess.CompletedProcess[str]:
    """Run the command with an empty environment, from the read-only folder."""
    return subprocess.run(
        [sys.executable, "-I", "-c", PROGRAM, str(site), *command.replace("OUT", str(out)).split()],
        cwd=site,
        env={},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        preexec_fn=_without_rights(),
    )


def test_no_command_is_left_out() -> None:
    assert {command.split()[0] for command, _ in COMMANDS} >= set(ALL_COMMANDS) - {"build"}


def test_every_command_answers(site: Path, tmp_path: Path) -> None:
    made = robustness(site, "build wheel --n 7 -o OUT/w.json", tmp_path)
    assert made.returncode == 0, made.stderr
    for command, expected in COMMANDS:
        done = robustness(site, command, tmp_path)
        assert done.returncode == expected, (command, done.stdout, done.stderr)
        assert "cannot" not in done.stderr, (command, done.stderr)
    assert not list(site.rglob("__pycache__"))
