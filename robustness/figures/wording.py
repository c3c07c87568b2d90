"""Node labels in pictures: short, in natural order, and never read as formulas."""

from __future__ import annotations

from collections.abc import Iterable

from robustness.natural_order import in_natural_order
from robustness.spelled import listed_in_words

__all__ = ["name_on_picture", "nodes_in_words", "plain"]

#: Letters of a node's name on a picture; longer ones run over the whole of it.
_LONGEST_NAME = 32


def plain(text: object) -> str:
    """Return text that matplotlib shows as it is: a dollar sign opens no formula, control characters are spelt out.

    >>> plain("$x_1$")
    '\\\\$x_1\\\\$'
    """
    shown = "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in str(text))
    return shown.replace("$", r"\$")


def name_on_picture(label: object) -> str:
    """Return a node's name, cut where it would cover other nodes; the answers themselves have it whole.

    >>> name_on_picture("n10"), name_on_picture("a" * 99)
    ('n10', 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa…')
    """
    text = str(label)
    return plain(text if len(text) <= _LONGEST_NAME else text[: _LONGEST_NAME - 1] + "…")


def nodes_in_words(labels: Iterable[object], most: int = 8) -> str:
    """Return a node set as text, at most so many labels of it, in natural order.

    >>> nodes_in_words(["n10", "n2"]), nodes_in_words(range(20), 3)
    ('{n2, n10}', '{0, 1, 2, … 17 more}')
    """
    return listed_in_words(in_natural_order(labels), most, plain)
