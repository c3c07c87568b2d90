"""What every answer has in common when it is told: a line as text, and a page of evidence in notebooks.

Nothing is imported here but errors, so that graphs can be told like answers. What draws a picture is known by name
alone, and imported when something is drawn.
"""

from __future__ import annotations

import base64
import html
import importlib
import io
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from robustness.errors import InvalidParameter, MissingExtra

__all__ = ["Told", "drawing", "small_picture"]

#: Larger networks are not drawn in notebooks unless asked for: a picture of them says little and takes long.
_LARGEST = 80

#: Characters of a summary in ``repr``.
_LONGEST = 100

_LEFT = "style='text-align:left'"


class Told:
    """Something that can be printed, and looked at in a notebook.

    Subclasses have ``summary()`` and ``as_dict()``, and may have ``evidence()`` and a picture.
    """

    __slots__ = ()

    if TYPE_CHECKING:

        def summary(self) -> str:
            """Return the answer in plain words."""

        def as_dict(self) -> dict[str, Any]:
            """Return the answer as JSON-ready values."""

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        text = " ".join(self.summary().split())
        if len(text) > _LONGEST:
            text = f"{text[:_LONGEST].rpartition(' ')[0]} …"
        return f"<{type(self).__name__}: {text}>"

    def evidence(self) -> Iterable[tuple[str, str]]:
        """Return the evidence as rows of a name and a text."""
        return ()

    def _small_picture(self) -> str:
        """Return a small picture as HTML; empty where there is nothing to draw, or nothing to draw with."""
        return ""

    def _repr_html_(self) -> str:
        """Render in notebooks: the summary, a small picture, and the evidence to unfold."""
        rows = "".join(
            f"<tr><th {_LEFT}>{html.escape(name)}</th><td {_LEFT}>{html.escape(text)}</td></tr>"
            for name, text in self.evidence()
        )
        folded = f"<details><summary>evidence</summary><table>{rows}</table></details>" if rows else ""
        return f"<div><p>{html.escape(self.summary())}</p>{self._small_picture()}{folded}</div>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": self._repr_html_()}


def small_picture(nodes: int, draw_on: Callable[[Any], Any]) -> str:
    """Return as HTML what ``draw_on`` draws on axes; empty for many nodes, without matplotlib, and of no picture."""
    if not 1 <= nodes <= _LARGEST:
        return ""
    try:
        figure = drawing("saving").new_figure(6.4, 3.6)
    except MissingExtra:
        return ""
    axes = figure.subplots()
    try:
        draw_on(axes)
    except InvalidParameter:  # a run that was not recorded
        return ""
    axes.set_title("")
    stream = io.BytesIO()
    drawing("lettering").drawn_with_letters(lambda: figure.savefig(stream, format="png", dpi=80))
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f"<img alt='' src='data:image/png;base64,{data}'/>"


def drawing(technique: str) -> Any:
    """Return a module of the drawing room."""
    return importlib.import_module(f"robustness.figures.{technique}")
