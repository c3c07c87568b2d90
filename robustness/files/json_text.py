"""JSON of topologies: parsed strictly, with a place in every complaint."""

from __future__ import annotations

import json
from collections.abc import Hashable, Mapping
from typing import Any

from robustness.errors import UnreadableTopology

__all__ = ["flag", "kind_of", "label_of", "list_of", "parse_json", "plain_label"]


def parse_json(text: str) -> Any:
    """Return what JSON text holds; a key that stands twice in one object is refused."""
    try:
        return json.loads(text, object_pairs_hook=_object_without_repeats)
    except json.JSONDecodeError as problem:
        raise UnreadableTopology(f"line {problem.lineno}, column {problem.colno}: {problem.msg}") from None
    except UnreadableTopology:
        raise
    except ValueError as problem:  # an integer with more digits than Python converts
        raise UnreadableTopology(f"a number cannot be read: {problem}") from None


def _object_without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise UnreadableTopology(f"the key {twice!r} stands twice in one object: keep one")
    return found


def flag(document: Mapping[str, Any], key: str, *, default: bool | None) -> Any:
    """Return a truth value of an object, or ``default`` where it has none."""
    value = document.get(key, default)
    if key in document and not isinstance(value, bool):
        raise UnreadableTopology(f"'{key}' is true or false, not {kind_of(value)}")
    return value


def list_of(document: Mapping[str, Any], key: str) -> list[Any]:
    """Return a list of an object."""
    if key not in document:
        raise UnreadableTopology(f"node-link JSON needs the key '{key}', which is missing")
    value = document[key]
    if not isinstance(value, list):
        raise UnreadableTopology(f"'{key}' is a list, not {kind_of(value)}")
    return value


def label_of(item: Any, key: str, place: str) -> Hashable:
    """Return the label under ``key`` of an object."""
    if not isinstance(item, dict):
        raise UnreadableTopology(f"{place}: is an object with '{key}', not {kind_of(item)}")
    if key not in item:
        raise UnreadableTopology(f"{place}: has no '{key}'")
    return plain_label(item[key], f"{place}: '{key}'")


def plain_label(label: Any, place: str) -> Hashable:
    """Return a label; a list is a tuple."""
    if type(label) is int or type(label) is str:
        return label
    if type(label) is list:
        return _tuple(label, place)
    raise UnreadableTopology(f"{place} is an integer, a string or a list of these, not {kind_of(label)}")


def _tuple(parts: list[Any], place: str) -> tuple[Hashable, ...]:
    for part in parts:
        if type(part) not in (int, str, list):
            raise UnreadableTopology(f"{place} holds integers, strings and lists of these, not {kind_of(part)}")
    return tuple(_tuple(part, place) if type(part) is list else part for part in parts)


def kind_of(value: Any) -> str:
    """Return what a JSON value is, in words."""
    names = {dict: "an object", list: "a list", str: "a string", bool: "a truth value", type(None): "null"}
    return names.get(type(value), "a number")
