"""Letters that no font of a machine has: told in one line, not in one for each, and what else is warned of is kept."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from typing import TypeVar

from robustness.digraph import GraphWarning

__all__ = ["drawn_with_letters", "missing_letters"]

_Drawn = TypeVar("_Drawn")

#: How matplotlib tells of a letter: by its number in Unicode.
_TOLD = re.compile(r"Glyph (\d+) .*missing from")

#: So many letters are named.
_NAMED = 5


def missing_letters(draw: Callable[[], _Drawn]) -> tuple[_Drawn, str]:
    """Return what ``draw`` returns, and the letters that the fonts lacked while it drew, in order of appearance."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        drawn = draw()
    letters = dict.fromkeys("")
    for each in heard:
        told = _TOLD.match(str(each.message))
        if told:
            letters[chr(int(told[1]))] = None
        else:
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
    return drawn, "".join(letters)


def drawn_with_letters(draw: Callable[[], _Drawn]) -> _Drawn:
    """Return what ``draw`` returns, with one :class:`GraphWarning` where fonts lack letters of it."""
    drawn, lacking = missing_letters(draw)
    if lacking:
        more = f" and {len(lacking) - _NAMED} more" if len(lacking) > _NAMED else ""
        warnings.warn(
            f"no font of matplotlib here has {', '.join(lacking[:_NAMED])}{more}, and boxes stand for them: write "
            ".svg, whose reader's fonts are used, or name a font that has them in rcParams['font.family']",
            GraphWarning,
            stacklevel=3,
        )
    return drawn
