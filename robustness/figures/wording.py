"""Node labels in pictures: short, in natural order, told apart, and never read as formulas."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from robustness.natural_order import in_natural_order
from robustness.spelled import listed_in_words

__all__ = ["Names", "plain"]

#: Letters of a node's name on a picture; longer ones run over the whole of it.
_LONGEST_NAME = 32


def plain(text: object) -> str:
    """Return text that matplotlib shows as it is: a dollar sign opens no formula, control characters are spelt out.

    >>> plain("$x_1$")
    '\\\\$x_1\\\\$'
    """
    shown = "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in str(text))
    return shown.replace("$", r"\$")


class Names:
    """How the nodes of one network are named on its pictures: in quotes only where two of them would look alike.

    >>> named = Names([1, "1", "n10", "n2"])
    >>> named(1), named("1"), named("n2"), named.together(["n10", "n2", "1"])
    ('1', "'1'", 'n2', "{'1', n2, n10}")
    """

    def __init__(self, labels: Iterable[object]) -> None:
        nodes = labels if isinstance(labels, tuple) else tuple(labels)
        self._alike = _repeated(map(str, nodes))
        self._alike_when_cut = _repeated(map(_cut, {self._text(label) for label in nodes}))

    def __call__(self, label: object) -> str:
        """Return a node's whole name."""
        return plain(self._text(label))

    def short(self, label: object) -> str:
        """Return a node's name, cut where it would cover other nodes; the answers themselves have it whole.

        >>> Names(["a" * 99]).short("a" * 99), Names(["a" * 40 + "1", "a" * 40 + "2"]).short("a" * 40 + "2")
        ('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa…', 'aaaaaaaaaaaaaaa…aaaaaaaaaaaaaaa2')
        """
        text = self._text(label)
        cut = _cut(text)
        if cut != text and cut in self._alike_when_cut:
            half = (_LONGEST_NAME - 1) // 2
            cut = f"{text[:half]}…{text[-half - 1 :]}"
        return plain(cut)

    def together(self, labels: Iterable[object], most: int = 8) -> str:
        """Return a node set as text, at most so many labels of it, in natural order.

        >>> Names(range(20)).together(range(20), 3)
        '{0, 1, 2, … 17 more}'
        """
        return listed_in_words(in_natural_order(labels), most, self)

    def _text(self, label: object) -> str:
        text = str(label)
        return repr(label) if text in self._alike else text


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST_NAME else text[: _LONGEST_NAME - 1] + "…"


def _repeated(texts: Iterable[str]) -> frozenset[str]:
    return frozenset(text for text, count in Counter(texts).items() if count > 1)
