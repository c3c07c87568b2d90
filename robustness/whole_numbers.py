"""Integers of NumPy are integers: public functions take them where they take Python's."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

__all__ = ["taking_numpy_integers", "whole"]

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


def whole(value: Any) -> Any:
    """Return an integer of NumPy as a Python integer, and everything else as it is."""
    kind = type(value)
    if kind.__module__ == "numpy" and kind.__name__.startswith(("int", "uint")) and hasattr(value, "__index__"):
        return operator.index(value)
    return value


def taking_numpy_integers(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Return a function that sees Python integers where it is given integers of NumPy."""

    @functools.wraps(function)
    def with_whole(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        return function(*map(whole, arguments), **{name: whole(value) for name, value in options.items()})

    return with_whole
