"""What the kernel's command reads: whole files, no device, no pipe without a writer, as much as there is room for."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from certificates import __main__ as program
from certificates.file_bytes import read_at_most

posix = pytest.mark.skipif(os.name != "posix", reason="named pipes and devices")


def test_a_file_is_read_whole_wherever_opening_can_wait_or_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_bytes(b"x" * 100)
    (tmp_path / "empty").write_bytes(b"")
    for _ in range(2):
        assert read_at_most(tmp_path / "file", 1000) == b"x" * 100
        assert read_at_most(tmp_path / "empty", 1000) == b""
        assert len(read_at_most(tmp_path / "file", 10)) > 10
        monkeypatch.delattr(os, "O_NONBLOCK", raising=False)


@posix
def test_what_may_never_end_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="is a pipe that nobody writes to"):
        read_at_most(tmp_path / "pipe", 10)
    with pytest.raises(OSError, match="is a device"):
        read_at_most("/dev/zero", 10)


def test_no_room_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def no_room(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(program, "_verify", no_room)
    assert program.main(["verify", str(tmp_path / "graph"), str(tmp_path / "proof")]) == 3
    assert capsys.readouterr().err == "malformed: the files do not fit into memory\n"
