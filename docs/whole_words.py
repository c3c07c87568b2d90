"""Lines of code that go on below on a narrow screen never end within an option or a name: browsers break at hyphens."""

from __future__ import annotations

import re
from typing import Any

#: A word of code that has a hyphen and fits the line of a phone; tags and escaped letters end it.
_HYPHENED = re.compile(r"(?<![^\s<>;])(?=[^\s<>&]{1,30}(?![^\s<>&]))[^\s<>&]*-[^\s<>&]*")

_BLOCK = re.compile(r"(<pre\b[^>]*>)(.*?)(</pre>)", re.DOTALL)
_TAG = re.compile(r"(<[^>]*>)")


def kept_whole(page: str) -> str:
    """Return a page in whose blocks of code no line ends within a word that has a hyphen."""

    def whole(block: re.Match[str]) -> str:
        parts = _TAG.split(block[2])
        parts[::2] = [_HYPHENED.sub(r"<span class='whole'>\g<0></span>", text) for text in parts[::2]]
        return block[1] + "".join(parts) + block[3]

    return _BLOCK.sub(whole, page)


def _change(_app: Any, _name: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    if "body" in context:
        context["body"] = kept_whole(context["body"])


def setup(app: Any) -> dict[str, bool]:
    """Change pages before they are written."""
    app.connect("html-page-context", _change)
    return {"parallel_read_safe": True}
