"""Completion with the Tab key: what click's scripts for shells leave to be mended."""

from __future__ import annotations

from click.shell_completion import FishComplete, add_completion_class

__all__ = ["WholeFish", "mend_completion"]


class WholeFish(FishComplete):
    """Completion in fish that keeps what stands behind a comma, in descriptions and in names of files."""

    source_template = FishComplete.source_template.replace('string split ","', 'string split --max 1 ","')


def mend_completion() -> None:
    """Let click use the completion of this module."""
    add_completion_class(WholeFish)
