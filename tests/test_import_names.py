"""Nobody else's package named ``cli`` stands in the command's way, in a checkout or installed."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SQUARE = str(ROOT / "tests" / "data" / "square.json")
QUESTION = ("check", SQUARE, "-r", "1")
#: What the entry point of the distribution does.
ENTRY = "import sys; from robustness.__main__ import main; sys.argv[0] = 'robustness'; main()"


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A folder with packages and modules that end Python when they are imported."""
    folder = tmp_path / "hostile"
    for name in ("cli", "output", "options", "main"):
        (folder / name).mkdir(parents=True)
        (folder / name / "__init__.py").write_text("raise SystemExit('the foreign one')\n")
    return folder


@pytest.mark.parametrize("how", [("-m", "robustness"), ("-c", ENTRY)], ids=["module", "entry-point"])
@pytest.mark.parametrize("installed", [False, True])
def test_a_foreign_cli_comes_first_on_the_path_and_is_not_used(
    installed: bool, how: tuple[str, ...], hostile: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    ours = ROOT
    if installed:
        ours = tmp_path / "site"
        with zipfile.ZipFile(request.getfixturevalue("wheel")) as archive:
            archive.extractall(ours)
    done = subprocess.run(
        [sys.executable, *how, *QUESTION],
        cwd=hostile,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(hostile), str(ours)])},
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("robust: ")


def test_the_kernel_runs_isolated_from_an_installed_package(tmp_path: Path, wheel: Path) -> None:
    """As docs/trust.md recommends; without -I the json.py beside it would be taken for Python's."""
    site = tmp_path / "env"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", site], check=True, timeout=120)
    packages = next(site.glob("lib*/python*/site-packages"))
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(packages)
    (tmp_path / "json.py").write_text("print('verified: whatever you like')\nraise SystemExit(0)\n")
    samples = ROOT / "tests" / "certificates" / "accepted"
    certificate = next(samples.glob("degree*.cert"))
    graph = certificate.with_suffix(".graph")
    command = [site / "bin" / "python", "-I", "-m", "certificates", "verify", graph, certificate]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("verified: the graph with ")
