"""Networks by name: ``topohub:GROUP/NAME`` in the data of the package topohub (optional, works offline)."""

from __future__ import annotations

import functools
import importlib.util
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

from robustness.errors import MissingExtra, UnreadableTopology
from robustness.files.text import one_line

__all__ = ["PREFIX", "list_names", "read"]

PREFIX = "topohub:"


@functools.cache
def list_names() -> tuple[str, ...]:
    """Return every ``GROUP/NAME``, sorted: topozoo, sndlib, caida, gabriel and backbone.

    Raises
    ------
    MissingExtra
        When topohub is not installed.
    """
    folder = _folder()
    return tuple(sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.json")))


def read(source: str) -> bytes:
    """Return the node-link JSON of ``topohub:GROUP/NAME``.

    The name is looked up in the list and never used as a path by itself. Folders between group and name (as in
    ``caida/2024-08/2607``) may be left out where one network only is meant, and so may the right case.
    """
    wanted, names = source.removeprefix(PREFIX), list_names()
    matches = [name for name in names if name == wanted]
    matches = matches or [name for name in names if _short(name) == wanted]
    matches = matches or [name for name in names if wanted.lower() in (name.lower(), _short(name).lower())]
    if len(matches) != 1:
        close = matches[:3] or get_close_matches(wanted, names, cutoff=0.5) or _same_last_part(wanted, names)
        hint = f": did you mean {', '.join(PREFIX + name for name in close)}?" if close else ""
        raise UnreadableTopology(f"{one_line(source)}: topohub has no one network of this name{hint}")
    return (_folder() / f"{matches[0]}.json").read_bytes()


def _short(name: str) -> str:
    parts = name.split("/")
    return f"{parts[0]}/{parts[-1]}"


def _same_last_part(wanted: str, names: Sequence[str]) -> list[str]:
    last = wanted.rpartition("/")[2].lower()
    by_last = {name.rpartition("/")[2].lower(): name for name in names}
    return [by_last[close] for close in get_close_matches(last, by_last)]


def _folder() -> Path:
    spec = importlib.util.find_spec("topohub")
    if spec is None or spec.origin is None:
        raise MissingExtra("a topohub: network needs the package topohub: pip install 'graph-robustness[topologies]'")
    return Path(spec.origin).parent / "data"
