"""Settings of the whole suite: how hard Hypothesis works, and that its draws are the same everywhere."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# The same examples on every machine, and no clock: a slow or busy machine is not a failure.
settings.register_profile("ci", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
# New examples at every run, many more of them: HYPOTHESIS_PROFILE=explore make test
settings.register_profile("explore", deadline=None, max_examples=2000, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


# Shells start work in the background deaf to Ctrl-C, and children inherit it: tests that send it would wait for ever.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure() -> None:
    """Refuse to test machine code that is not of these sources: as plain Python the tests take hours."""
    from robustness import kernels

    if "made from other sources" in kernels.WHY_NOT:
        raise pytest.UsageError(kernels.WHY_NOT)


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from this checkout without a network."""
    root = Path(__file__).resolve().parent.parent
    folder = tmp_path_factory.mktemp("wheel")
    build = root / "build"
    build.mkdir(exist_ok=True)
    # One at a time: setuptools works in build/, and would put what it finds there of deleted modules into the wheel.
    with (build / "lock-of-the-tests").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for stale in build.glob("lib*"):
            shutil.rmtree(stale)
        done = subprocess.run(
            [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-index", "--no-deps",
             "--no-build-isolation", "--wheel-dir", str(folder), str(root)],
            cwd=folder, capture_output=True, text=True, timeout=600, check=False,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (built,) = folder.glob("*.whl")
    return built
