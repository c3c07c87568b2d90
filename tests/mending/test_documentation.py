"""The page about mending: its Python prints what it says, and its table is the benchmark's."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "mending.md").read_text(encoding="utf-8")


def test_the_python_of_the_page_prints_what_its_comments_say() -> None:
    (code,) = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "mending.md", "exec"), {})  # noqa: S102 - our own page
    promised = [line.partition("  # ")[2] for line in code.splitlines() if line.startswith("print")]
    assert promised == printed.getvalue().splitlines()


def test_the_pictures_are_there() -> None:
    for name in re.findall(r"\(figures/([\w-]+\.svg)\)", PAGE):
        assert (Path(__file__).parents[2] / "docs" / "figures" / name).stat().st_size > 5_000
