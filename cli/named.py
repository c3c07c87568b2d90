"""What options take that name a file or a folder."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

__all__ = ["FILE", "FILE_NAME", "FOLDER", "PLACE"]


class _Named(click.Path):
    """A path with a name: what a shell makes of ``-o "$OUT"`` where OUT is not set is not the folder one is in."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return ``value`` as a path; nothing is none."""
        if not os.fspath(value):
            self.fail("it names nothing: is a variable of the shell not set?", param, ctx)
        return super().convert(value, param, ctx)


#: A file, as a path or as text; a folder; either of them.
FILE, FILE_NAME = _Named(dir_okay=False, path_type=Path), _Named(dir_okay=False)
FOLDER, PLACE = _Named(file_okay=False, path_type=Path), _Named(path_type=Path)
