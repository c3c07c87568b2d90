"""What every answer promises: a summary as text, a short repr, JSON, and a page in notebooks with a picture."""

from __future__ import annotations

import enum
import importlib
import inspect
import json
import pkgutil
import typing
from collections.abc import Iterator
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.mending.budget import best_within
from robustness.sampling import SampleResult, sample_robustness
from robustness.simulation.attacks import Attack
from robustness.simulation.finding import find_attack
from robustness.told import Told
from robustness.traps import find_trap

WHEEL = nx.wheel_graph(5)

#: Public classes that are asked with and are no answers.
ASKED_WITH = {rb.Gate, rb.Goal}

#: The base classes, which promise and hold nothing.
BASES = {"Told", "Shown", "ShownOverTime"}


def answers() -> dict[str, Any]:
    """Return an instance of every class that is told, by the name of the class."""
    decided = rb.check_rs_robustness(WHEEL, 4)
    assert decided.bounds is not None
    made = [
        rb.Digraph.from_networkx(WHEEL), decided, decided.witness, decided.bounds, decided.bounds.upper,
        rb.TimeVaryingGraph([nx.path_graph(4), nx.cycle_graph(4)], period=2),
        rb.check_joint_robustness(rb.TimeVaryingGraph([nx.path_graph(4)], period=1), 2),
        rb.tolerance(WHEEL), rb.tolerance(WHEEL, model="delayed"), find_attack(WHEEL, 1, "byzantine").attack,
        find_trap(WHEEL, 1), rb.find_graph(4, ["2-robust"]), rb.mend(nx.path_graph(4), 2),
        best_within(nx.path_graph(4), 1),
        rb.margin(nx.cycle_graph(5), rb.Goal(r=1)), rb.simulate(WHEEL, malicious=[1], f=1, steps=5, seed=1),
        sample_robustness(nx.complete_graph(40), 3, nodes=8, repeats=2, seed=1), rb.survey({"wheel": WHEEL}),
        rb.report({"wheel": WHEEL}, mending=0),
    ]  # fmt: skip
    return {type(each).__name__: each for each in made}


ANSWERS = answers()
#: Those that are about a graph, or carry one.
WITH_PICTURE = {
    "Digraph", "RobustnessResult", "TimeVaryingGraph", "JointResult", "ToleranceTable", "ToleranceResult", "Attack",
    "TrapResult", "FindResult", "MendResult", "BudgetResult", "Margin", "Outcome",
}  # fmt: skip


def classes() -> Iterator[type]:
    """Yield every class of the package that is written down in it."""
    for module in pkgutil.walk_packages(rb.__path__, "robustness."):
        if ".kernels" in module.name or module.name.endswith("__main__"):
            continue
        for found in vars(importlib.import_module(module.name)).values():
            if inspect.isclass(found) and found.__module__ == module.name and not found.__name__.startswith("_"):
                yield found


def test_every_public_class_that_is_an_answer_is_told() -> None:
    public = {found for name in dir(rb) if inspect.isclass(found := getattr(rb, name))}
    kinds = {found for found in public if not issubclass(found, BaseException | enum.Enum)}
    assert {found.__name__ for found in kinds - ASKED_WITH if not issubclass(found, Told)} == set()


def test_every_class_with_a_summary_is_told() -> None:
    assert {
        found.__name__
        for found in classes()
        if callable(getattr(found, "summary", None)) and not issubclass(found, Told)
    } == set()


def test_what_public_functions_return_is_told() -> None:
    returned: set[type] = set()
    for name in dir(rb):
        function = getattr(rb, name)
        if inspect.isfunction(function) and function.__module__.partition(".")[0] == "robustness":
            module = importlib.import_module(function.__module__)
            said = str(inspect.signature(inspect.unwrap(function)).return_annotation)
            returned |= {vars(module)[word] for word in said.split(" | ") if inspect.isclass(vars(module).get(word))}
    assert {rb.RobustnessResult, rb.MendResult, rb.ToleranceResult} < returned
    assert {found.__name__ for found in returned if not issubclass(found, Told)} == set()


def test_each_of_them_is_looked_at_here() -> None:
    told = {found.__name__ for found in classes() if issubclass(found, Told)} - BASES
    assert told == set(ANSWERS)


@pytest.mark.parametrize("name", ANSWERS)
def test_it_keeps_the_promises(name: str) -> None:
    answer = ANSWERS[name]
    assert str(answer) == answer.summary() != ""
    assert repr(answer).startswith(f"<{name}: ")
    assert "\n" not in repr(answer)
    assert len(repr(answer)) < 140
    json.loads(json.dumps(answer.as_dict(), allow_nan=False))
    page = answer._repr_mimebundle_()["text/html"] if isinstance(answer, Told) else ""
    assert page == answer._repr_html_()
    assert page.startswith("<")
    assert ("<img" in page) == (name in WITH_PICTURE)


@pytest.mark.parametrize("name", ANSWERS)
def test_nothing_is_shown_as_python_writes_it(name: str) -> None:
    answer = ANSWERS[name]
    told = [str(answer), *(text for row in answer.evidence() for text in row)]
    for text in told:
        for word in ("None", "True", "False", "frozenset(", "{'", "': ", "Verdict."):
            assert word not in text, text


def test_an_attack_and_a_sample_are_among_them() -> None:
    assert isinstance(ANSWERS["Attack"], Attack)
    assert isinstance(ANSWERS["SampleResult"], SampleResult)
    assert typing.get_type_hints(rb.Witness.summary)["return"] is str


def test_a_pair_is_still_a_pair() -> None:
    pair = rb.Witness(frozenset({1}), frozenset({2}))
    first, second = pair
    assert (first, second) == pair == rb.Witness(*pair)
    assert pair.as_dict() == {"S1": [1], "S2": [2]}
    assert str(pair) == "S1 = {1}, S2 = {2}"
