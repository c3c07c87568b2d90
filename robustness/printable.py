"""Text that others have chosen, made harmless for a terminal."""

from __future__ import annotations

__all__ = ["printable"]


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
