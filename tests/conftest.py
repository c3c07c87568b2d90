"""Settings of the whole suite: how hard Hypothesis works, and that its draws are the same everywhere."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings

# The same examples on every machine, and no clock: a slow or busy machine is not a failure.
settings.register_profile("ci", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
# New examples at every run, many more of them: HYPOTHESIS_PROFILE=explore make test
settings.register_profile("explore", deadline=None, max_examples=2000, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


def pytest_configure() -> None:
    """Refuse to test machine code that is not of these sources: as plain Python the tests take hours."""
    from robustness import kernels

    if "made from other sources" in kernels.WHY_NOT:
        raise pytest.UsageError(kernels.WHY_NOT)
