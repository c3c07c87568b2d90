"""The page on time-varying networks shows what happens."""

from __future__ import annotations

import doctest
from pathlib import Path


def test_the_session_on_the_page() -> None:
    page = Path(__file__).parents[2] / "docs" / "time-varying.md"
    outcome = doctest.testfile(str(page), module_relative=False, encoding="utf-8")
    assert outcome.attempted > 5
    assert outcome.failed == 0
