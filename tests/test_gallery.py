"""The stories of the gallery run as they stand, and the page of public names has them all."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import robustness as rb

ROOT = Path(__file__).resolve().parent.parent
STORIES = sorted((ROOT / "examples" / "gallery").glob("*.py"))


@pytest.mark.parametrize("story", STORIES, ids=lambda story: story.stem)
def test_a_story_runs(story: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "MPLBACKEND": "agg"}
    command = [sys.executable, str(story)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert not list(tmp_path.glob("*.png"))
    assert "\nplt.show()\n" in story.read_text(encoding="utf-8"), "a story has a picture"


def test_the_page_of_public_names_has_every_name_once() -> None:
    page = (ROOT / "docs" / "python-api" / "public.md").read_text(encoding="utf-8")
    names = re.findall(r"^\.\. auto(?:function|class|data):: (\w+)$", page, re.MULTILINE)
    assert sorted(names) == sorted(rb.__all__)


def test_there_are_stories() -> None:
    assert len(STORIES) >= 7
