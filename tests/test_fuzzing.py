"""Every command ends in a code it promises: the fuzzer for a moment, and what it has found before."""

from __future__ import annotations

from itertools import islice

import pytest

from tests.fuzzing.cases import Case, cases
from tests.fuzzing.mutation import HOSTILE_WORDS
from tests.fuzzing.promises import ALLOWED, broken_promise

SQUARE = b'{"directed":false,"multigraph":false,"nodes":[{"id":0},{"id":1}],"edges":[{"source":0,"target":1}]}'
FILES = {"square.json": SQUARE}

GRAPH = b'{"kind": "Digraph", "arcs": [[0, 1], [%s, 0]], "labels": [0, 1], "directed": false}'
TIMES = b'{"kind": "tuple", "items": [1.0, 2.0]}'
RUN = (
    b'{"schema": "robustness/run/1", "scenario": {"kind": "Scenario", "f": 0, "T": 0.5, "steps": 9,'
    b'"network": {"kind": "Topology",'
    b'"graphs": {"kind": "tuple", "items": [' + GRAPH + b']}, "sequence": {"kind": "tuple", "items": [0]}}}, "start": '
    b'{"kind": "Start", "malicious": {"kind": "set", "items": []}, "positions": ' + TIMES + b', "velocities": ' + TIMES
) + b"}}"

#: Cases that once broke a promise, and the code that they end in.
FOUND = {
    "an id beyond every index": (Case(("simulate", "--replay", "run.json"), {"run.json": RUN % (b"9" * 20)}), 3),
    "an id from the end": (Case(("simulate", "--replay", "run.json"), {"run.json": RUN % b"-1"}), 3),
    "an id that is a truth": (Case(("simulate", "--replay", "run.json"), {"run.json": RUN % b"true"}), 3),
    "a period of nothing": (Case(("attack", "square.json", "-T", "0"), FILES), 2),
    "a period of nothing, beside a bound": (Case(("attack", "square.json", "-T", "0", "--sigma", "5"), FILES), 2),
}


@pytest.mark.parametrize("name", FOUND)
def test_what_was_found(name: str) -> None:
    case, code = FOUND[name]
    assert broken_promise(case, frozenset({code})) == ""


def test_a_run_that_is_as_it_should_be() -> None:
    case = Case(("simulate", "--replay", "run.json"), {"run.json": RUN % b"1"})
    assert broken_promise(case, frozenset({0, 30})) == ""  # after 9 steps nobody can say how it ends


def test_a_hundred_cases() -> None:
    for case in islice(cases(0), 100):
        assert broken_promise(case) == "", case.arguments


def test_the_same_seed_makes_the_same_cases() -> None:
    assert list(islice(cases(5), 40)) == list(islice(cases(5), 40))
    assert list(islice(cases(5), 40)) != list(islice(cases(6), 40))


def test_a_broken_promise_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cli.check.load_graph", lambda _: 1 / 0)
    assert "exit code 1" in broken_promise(Case(("check", "square.json"), FILES))
    assert 1 not in ALLOWED
    assert 130 not in ALLOWED
    assert all("\n" not in word or word == "\n" for word in HOSTILE_WORDS)
