"""What users pass to the simulator, checked or converted at the door: each function names the rule that was broken."""

from __future__ import annotations

import math
import numbers
import operator
from collections.abc import Hashable, Iterable, Mapping
from typing import Any

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries import ADVERSARIES, Adversary
from robustness.simulation.divergence import LARGEST_START
from robustness.simulation.schedules import SCHEDULES, Schedule, schedule_named

__all__ = [
    "adversary_from",
    "collected",
    "finite",
    "integer",
    "is_real",
    "label_set",
    "label_tuple",
    "mapping_or_none",
    "numbers_in",
    "schedule_from",
]

#: The bound on the age of values when a schedule is given by name alone.
_TAU = 3


def is_real(value: object) -> bool:
    """Return whether this is a real number, numpy's among them; a boolean is none."""
    return not isinstance(value, bool) and isinstance(value, numbers.Real)


def integer(what: str, value: Any, least: int) -> int:
    """Return an integer of at least ``least``; numpy's count, booleans do not."""
    if type(value) is not bool:
        try:
            number = operator.index(value)
        except TypeError:
            pass
        else:
            if number >= least:
                return number
    raise InvalidParameter(f"{what} is an integer of at least {least}, not {value!r}")


def finite(what: str, value: Any, *, positive: bool = False, largest: float = math.inf) -> float:
    """Return a finite number, as a float, above 0 when ``positive``, of a size of at most ``largest``."""
    kind = "positive" if positive else "finite"
    if is_real(value):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isfinite(number) and abs(number) <= largest and (number > 0 or not positive):
            return number
    most = "" if largest == math.inf else f" of at most {largest:g}"
    raise InvalidParameter(f"{what} is a {kind} number{most}, not {value!r}")


def numbers_in(what: str, values: Any) -> tuple[float, ...]:
    """Return a sequence of numbers as floats; whether they are finite and enough is asked when the network is known."""
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise InvalidParameter(f"{what} are a sequence of numbers, one for each node in id order, not {values!r}")
    row = list(values)
    wrong = [each for each in row if not is_real(each)]
    if wrong:
        raise InvalidParameter(f"{what} are finite numbers, not {wrong[0]!r}")
    return tuple(finite(f"each of the {what}", each, largest=LARGEST_START) for each in row)


def collected(what: str, values: Any, of: str) -> tuple[Any, ...]:
    """Return a collection as a tuple; a string is none."""
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise InvalidParameter(f"{what} is a collection of {of}, such as [{values!r}], not {values!r}")
    return tuple(values)


def label_tuple(what: str, labels: Any) -> tuple[Any, ...]:
    """Return node labels as a tuple; a string is one label, so it is no collection of them."""
    row = collected(what, labels, "nodes")
    for label in row:
        if not isinstance(label, Hashable):
            raise InvalidParameter(f"{what} is a collection of nodes, and {label!r} cannot be one")
    return row


def label_set(what: str, labels: Any) -> frozenset[Any]:
    """Return node labels as a set; see :func:`label_tuple`."""
    return frozenset(label_tuple(what, labels))


def mapping_or_none(what: str, value: Any) -> Mapping[Any, Any] | None:
    """Return a mapping, or None."""
    if value is None or isinstance(value, Mapping):
        return value
    raise InvalidParameter(f"{what} is a mapping from nodes to numbers, not {value!r}")


def adversary_from(value: Any) -> Adversary:
    """Return an adversary, given itself, its class or its name in ``ADVERSARIES``."""
    if isinstance(value, str):
        if value not in ADVERSARIES:
            raise InvalidParameter(f"an adversary is one of {', '.join(ADVERSARIES)}, not {value!r}")
        return ADVERSARIES[value]()
    made = value
    if isinstance(value, type):
        try:
            made = value()
        except TypeError as problem:
            raise InvalidParameter(f"an adversary is an instance, and {value.__name__} needs more: {problem}") from None
    if not callable(getattr(made, "play", None)):
        raise InvalidParameter(f"an adversary is a name ({', '.join(ADVERSARIES)}) or has a method play, not {value!r}")
    adversary: Adversary = made
    return adversary


def schedule_from(value: Any, tau: int | None = None) -> Schedule:
    """Return a schedule, given itself or its name in ``SCHEDULES``; by name, ``tau`` is 3 unless given (0 in step)."""
    if isinstance(value, Schedule):
        return value
    if not isinstance(value, str):
        raise InvalidParameter(f"a schedule is a Schedule or one of {', '.join(SCHEDULES)}, not {value!r}")
    return schedule_named(value, (0 if value == "synchronous" else _TAU) if tau is None else tau)
