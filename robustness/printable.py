"""Text that others have chosen, made harmless for a terminal."""

from __future__ import annotations

import unicodedata

__all__ = ["printable", "width_of"]


def printable(text: str, kept: str = "") -> str:
    r"""Return text that cannot steer a terminal: what is not printable, nor in ``kept``, stands as its escape.

    >>> printable("a\x1b[2J\n"), printable("a\n", "\n")
    ('a\\x1b[2J\\n', 'a\n')
    """
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() or letter in kept else letter.encode("unicode_escape").decode()
        for letter in text
    )


def width_of(text: str) -> int:
    """Return how many columns of a terminal text takes: two for letters such as Chinese, none for accents.

    >>> width_of("網路"), width_of("naive")
    (4, 5)
    """
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(letter) else 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        for letter in text
    )
