"""Runs as JSON: a counterexample is worth nothing that nobody else can run again.

Every part of a scenario is a frozen dataclass of plain values, so one small codec serves them all: a dataclass
becomes ``{"kind": name, field: ...}`` and only the kinds listed here are ever made from a file. Numbers are written
so that they are read back bit for bit.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter, RobustnessError
from robustness.files.writing import replace_file
from robustness.json_labels import from_json
from robustness.simulation import adversaries, motion, schedules
from robustness.simulation.outcome import Outcome
from robustness.simulation.scenario import Scenario, Start
from robustness.simulation.topology import Topology
from robustness.whole_file import read_text

__all__ = ["SCHEMA", "decode_run", "encode_run", "read_run", "write_run"]

SCHEMA = "robustness/run/1"

_KINDS: Mapping[str, type] = MappingProxyType(
    {
        kind.__name__: kind
        for kind in (
            Scenario, Start, Topology, schedules.Schedule, schedules.EveryStep, schedules.PeriodicUpdates,
            schedules.RandomUpdates, schedules.AdversarialUpdates, schedules.NoDelays, schedules.ConstantDelays,
            schedules.PeriodicDelays, schedules.RandomDelays, schedules.AdversarialDelays, schedules.LatestDelays,
            adversaries.Alternating, adversaries.Constant,
            adversaries.Crash, adversaries.ExtremeValue, adversaries.Greedy, adversaries.Liar, adversaries.Noise,
            adversaries.Omission, adversaries.Ramp, adversaries.Sine, adversaries.TwoFace, motion.Creep,
            motion.InAbsolutePositions, motion.InTurns, motion.Push, motion.Withholding,
        )
    }
)  # fmt: skip


def encode_run(scenario: Scenario, start: Start, outcome: Outcome | None = None) -> dict[str, Any]:
    """Return one run, and what came of it, as JSON-ready values.

    Raises
    ------
    InvalidParameter
        When the scenario holds a part that cannot be read back, such as an adversary of the user's own.
    """
    return {
        "schema": SCHEMA,
        "scenario": _encode(scenario),
        "start": _encode(start),
        "outcome": None if outcome is None else outcome.as_dict(),
    }


def decode_run(document: Any) -> tuple[Scenario, Start]:
    """Return the run of a document that :func:`encode_run` made.

    Raises
    ------
    InvalidParameter
        When it is not such a document; every part is validated anew.
    """
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InvalidParameter(f"a recorded run has the schema {SCHEMA}: record one with 'simulate --save'")
    try:
        scenario, start = _decode(document.get("scenario")), _decode(document.get("start"))
    except RobustnessError:
        raise
    except (KeyError, TypeError, ValueError, RecursionError) as problem:
        raise InvalidParameter(f"a recorded run is as 'simulate --save' writes it, not so: {problem}") from None
    if not isinstance(scenario, Scenario) or not isinstance(start, Start):
        raise InvalidParameter("a recorded run holds one scenario and one start: record it anew")
    return scenario, start


def write_run(path: Path, scenario: Scenario, start: Start, outcome: Outcome | None = None) -> None:
    """Write one run to a file, so that :func:`read_run` gives it back."""
    replace_file(path, (json.dumps(encode_run(scenario, start, outcome), indent=1) + "\n").encode())


def read_run(path: Path) -> tuple[Scenario, Start]:
    """Return the run in a file; see :func:`decode_run`. An unreadable file is an :class:`InvalidParameter` error."""
    try:
        document = json.loads(read_text(path))
    except (OSError, ValueError, RecursionError) as problem:
        raise InvalidParameter(f"a recorded run is a JSON file, but {path} is not readable as one: {problem}") from None
    return decode_run(document)


def _encode(value: Any) -> Any:
    if isinstance(value, Digraph):
        return {"kind": "Digraph", **json.loads(value.canonical_bytes()), "directed": value.directed}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        name = type(value).__name__
        if _KINDS.get(name) is not type(value):
            raise InvalidParameter(f"only the parts of this package can be recorded, not {name}")
        return {"kind": name} | {f.name: _encode(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {"kind": "mapping", "items": [[_encode(k), _encode(v)] for k, v in value.items()]}
    if isinstance(value, tuple):
        return {"kind": "tuple", "items": [_encode(item) for item in value]}
    if isinstance(value, frozenset):
        return {"kind": "set", "items": sorted((_encode(item) for item in value), key=json.dumps)}
    if isinstance(value, float) and not math.isfinite(value):
        raise InvalidParameter(f"only finite numbers can be recorded, not {value}")
    return value


def _decode(value: Any) -> Any:
    if not isinstance(value, dict):
        if isinstance(value, list):
            raise InvalidParameter("a recorded run has no bare lists: record it anew")
        return value
    fields = dict(value)
    kind = fields.pop("kind")
    if kind == "Digraph":
        labels = [from_json(label) for label in fields["labels"]]
        ends = [end for arc in fields["arcs"] for end in arc]
        if not all(type(end) is int and 0 <= end < len(labels) for end in ends):
            raise InvalidParameter(f"the arcs of a recorded graph join ids in 0..{len(labels) - 1}: record it anew")
        return Digraph(labels, [(labels[u], labels[v]) for u, v in fields["arcs"]], directed=fields["directed"])
    if kind == "mapping":
        return {_decode(key): _decode(item) for key, item in fields["items"]}
    if kind == "tuple":
        return tuple(_decode(item) for item in fields["items"])
    if kind == "set":
        return frozenset(_decode(item) for item in fields["items"])
    if kind not in _KINDS:
        raise InvalidParameter(f"a recorded run holds parts of this package, and {kind!r} is none")
    return _KINDS[kind](**{name: _decode(item) for name, item in fields.items()})
