"""No command waits for a file that never comes, and a pipe that somebody writes to is read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from robustness.whole_file import read_at_most, read_text

ROOT = Path(__file__).resolve().parent.parent
WHEEL = str(ROOT / "tests" / "data" / "square.json")

posix = pytest.mark.skipif(os.name != "posix", reason="named pipes")

#: What the kernel's own command reads.
KERNEL_READERS = ["verify PIPE OUT", f"verify {WHEEL} PIPE", "verify-joint PIPE OUT", f"verify-tolerance {WHEEL} PIPE"]

#: Every place where a command reads a file that it is given; PIPE is a named pipe that nobody writes to.
READERS = [
    "check PIPE",
    "certify PIPE -r 1 -o OUT",
    "tolerance PIPE",
    "attack PIPE",
    "draw PIPE -o OUT.svg",
    f"draw {WHEEL} --attack PIPE -o OUT.svg",
    "joint PIPE -r 1",
    "simulate PIPE",
    f"simulate {WHEEL} --attack PIPE",
    f"simulate {WHEEL} --certificate PIPE",
    "simulate --replay PIPE",
    "survey PIPE",
    f"survey {WHEEL} --state PIPE",
    "report PIPE -o OUT.html",
    "mend PIPE -r 1",
    "thin PIPE -r 1",
    "verify PIPE OUT",
    f"verify {WHEEL} PIPE",
]


@posix
@pytest.mark.parametrize("command", READERS)
def test_a_pipe_that_nobody_writes_to_is_refused_at_once(command: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    arguments = command.replace("PIPE", str(tmp_path / "pipe.json")).replace("OUT", str(tmp_path / "out")).split()
    done = subprocess.run(
        [sys.executable, "-m", "cli", *arguments], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode in (2, 3), (command, done.stdout, done.stderr)
    assert "pipe" in done.stderr + done.stdout


@posix
@pytest.mark.parametrize("command", KERNEL_READERS)
def test_the_kernel_waits_for_none_either(command: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json")
    (tmp_path / "out").write_text("{}\n")
    arguments = command.replace("PIPE", str(tmp_path / "pipe.json")).replace("OUT", str(tmp_path / "out")).split()
    kernel = [sys.executable, "-m", "certificates", *arguments]
    done = subprocess.run(kernel, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (3, "")
    assert "is a pipe that nobody writes to" in done.stderr


@posix
def test_a_pipe_that_is_written_to_is_read_whole() -> None:
    receiving, sending = os.pipe()
    with os.fdopen(sending, "wb") as stream:
        stream.write(b"x" * 1000)
    try:
        assert read_text(f"/dev/fd/{receiving}") == "x" * 1000
    finally:
        os.close(receiving)


@posix
def test_a_device_is_no_file() -> None:
    with pytest.raises(OSError, match="is a device"):
        read_at_most("/dev/zero", 10)


def test_somewhat_more_than_the_limit_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * 3 * 2**20)
    assert 10 < len(read_at_most(tmp_path / "file", 10)) < 2**21
