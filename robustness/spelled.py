"""How labels, sets of them and counts are written where people read them, in every answer and on the command line."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from robustness.natural_order import in_natural_order

__all__ = [
    "Spelling",
    "counted",
    "counted_links",
    "label_text",
    "labels_in_words",
    "listed_in_words",
    "plural",
    "robust",
]

#: Text that stands without quotes: nothing in it ends a list or a set, and nothing of it is lost at its ends.
_PLAIN = re.compile(r"[^\s,;{}()\[\]'\"](?:[^,;{}\"]*[^\s,;{}'\"])?")

#: Text that could be taken for a label that is no text.
_NUMBER = re.compile(r"[+-]?\d+")


def counted(count: float, noun: str, many: str = "") -> str:
    """Return a number of things, the one place that forms plurals.

    >>> counted(1, "node"), counted(0, "arc"), counted(2, "window that fails", "windows that fail")
    ('1 node', '0 arcs', '2 windows that fail')
    """
    return f"{count} {plural(count, noun, many)}"


def counted_links(arcs: int, directed: bool) -> str:
    """Return how many links a network has, of which an undirected one is two arcs.

    >>> counted_links(12, directed=False), counted_links(12, directed=True)
    ('6 links', '12 arcs')
    """
    return counted(arcs, "arc") if directed else counted(arcs // 2, "link")


def plural(count: float, noun: str, many: str = "") -> str:
    """Return the form of a word that goes with a number: ``many``, or with an s, unless it is 1."""
    return noun if count == 1 else many or f"{noun}s"


def robust(r: int, s: int = 1) -> str:
    """Return what a network is that is (r,s)-robust.

    >>> robust(2), robust(2, 2)
    ('2-robust', '(2,2)-robust')
    """
    return f"{r}-robust" if s == 1 else f"({r},{s})-robust"


def label_text(label: object) -> str:
    """Return a label as people write it; in quotes where it could be taken for something else than it is.

    >>> label_text("Kiel"), label_text("4"), label_text(4), label_text("a, b"), label_text(("a", 1))
    ('Kiel', "'4'", '4', "'a, b'", '(a, 1)')
    """
    return repr(label) if isinstance(label, str) and _NUMBER.fullmatch(label) else _plainly(label, label_text)


class Spelling:
    """How the nodes of one network are written: without quotes, but where two of them would look alike.

    >>> Spelling(["1", "2"])("1"), Spelling([1, "1", "2"])("1"), Spelling([1, "1", "2"])("2")
    ('1', "'1'", '2')
    """

    def __init__(self, labels: Iterable[object]) -> None:
        nodes = labels if isinstance(labels, tuple) else tuple(labels)
        is_mixed = set(map(type, nodes)) not in (
            {str},
            {int},
        )  # of one kind no two look alike, and there may be millions
        texts = Counter(map(_plain, nodes)) if is_mixed else Counter()
        self._alike = {text for text, count in texts.items() if count > 1}

    def __call__(self, label: object) -> str:
        """Return the text of one of the nodes."""
        text = _plain(label)
        return repr(label) if text in self._alike else text


def listed_in_words(
    ordered: Sequence[object], most: int | None = None, spelled: Callable[[object], str] = label_text
) -> str:
    """Return labels as the text of a set, in their order; of more than ``most`` the others are counted.

    >>> listed_in_words(range(20), 3), listed_in_words([])
    ('{0, 1, 2, … 17 more}', 'none')
    """
    if not ordered:
        return "none"
    shown = ordered if most is None else ordered[:most]
    more = f", … {len(ordered) - len(shown)} more" if len(shown) < len(ordered) else ""
    return "{" + ", ".join(map(spelled, shown)) + more + "}"


def labels_in_words(labels: Iterable[object], among: Iterable[object] | None = None) -> str:
    """Return a node set as text, in natural order; ``among`` are all nodes of its network, where they are known.

    >>> labels_in_words({"n10", "n2"}), labels_in_words({"4"}), labels_in_words({"4"}, among=["3", "4"])
    ('{n2, n10}', "{'4'}", '{4}')
    """
    return listed_in_words(in_natural_order(labels), None, label_text if among is None else Spelling(among))


def _plain(label: object) -> str:
    return _plainly(label, _plain)


def _plainly(label: object, of_parts: Callable[[object], str]) -> str:
    """Return a label without quotes, where its text has no letter that a list of labels would be misread by."""
    if isinstance(label, tuple):
        return f"({', '.join(map(of_parts, label))}{',' * (len(label) == 1)})"
    if isinstance(label, str):
        return label if _PLAIN.fullmatch(label) and label.isprintable() and "  " not in label else repr(label)
    return str(label)
