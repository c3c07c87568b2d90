"""Pictures to files: the same question gives the same bytes, and a suffix that names no format is told at once."""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING

from robustness.errors import InvalidParameter, MissingExtra
from robustness.files import replace_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["new_figure", "picture_format", "save_figure"]


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of this size in inches, outside pyplot's list of open ones.

    Raises
    ------
    MissingExtra
        When matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("drawing needs matplotlib: pip install 'graph-robustness[plot]'") from None
    return Figure(figsize=(width, height), layout="constrained")


def picture_format(path: str | os.PathLike[str]) -> str:
    """Return the format that a path's suffix names, such as ``"svg"``, or raise :class:`InvalidParameter`."""
    suffix = os.path.splitext(os.fspath(path))[1].lower().lstrip(".")
    formats = new_figure(1, 1).canvas.get_supported_filetypes()
    if suffix not in formats:
        raise InvalidParameter(f"a picture's suffix is one of {', '.join(sorted(formats))}, not {suffix!r}")
    return suffix


def save_figure(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, without a date and with fixed ids."""
    from matplotlib import rc_context

    kind = picture_format(path)
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with rc_context({"svg.hashsalt": "robustness"}):
        stream = io.BytesIO()
        figure.savefig(stream, format=kind, metadata=undated.get(kind), dpi=150)
    replace_file(path, stream.getvalue())
