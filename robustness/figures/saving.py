"""Pictures to files: the same question gives the same bytes, and a suffix that names no format is told at once."""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING

from robustness.errors import InvalidParameter, MissingExtra
from robustness.figures.lettering import drawn_with_letters, missing_letters
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
    """Write a figure to a file, without a date and with fixed ids.

    Letters that no font here has are told once; in SVG they stay text, for the fonts of whoever looks at it.
    """
    kind = picture_format(path)

    def draw() -> bytes:
        return _bytes_of(figure, kind)

    if kind not in ("svg", "svgz"):
        replace_file(path, drawn_with_letters(draw))
        return
    data, lacking = missing_letters(draw)
    if lacking:
        data, _ = missing_letters(lambda: _bytes_of(figure, kind, as_text=True))
    replace_file(path, data)


def _bytes_of(figure: Figure, kind: str, *, as_text: bool = False) -> bytes:
    from matplotlib import rc_context, rcParams

    undated = {"svg": {"Date": None}, "svgz": {"Date": None}, "pdf": {"CreationDate": None}}
    letters = "none" if as_text else rcParams["svg.fonttype"]
    stream = io.BytesIO()
    with rc_context({"svg.hashsalt": "robustness", "svg.fonttype": letters}):
        figure.savefig(stream, format=kind, metadata=undated.get(kind), dpi=150)
    return stream.getvalue()
