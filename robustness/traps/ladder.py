"""THE ladder of a question about traps: lemmas, cheapest first, and then one exact search."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from robustness.answers import Rung
from robustness.decision.ladder import settle_quickly
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits
from robustness.traps.question import Question, TrapAnswer
from robustness.traps.shortcuts import settle_trap

__all__ = ["TRAP_ALGORITHMS", "decide_trap"]

#: Every exact algorithm for traps by the name users type, and the module that is imported when it is asked for.
_MODULES: Mapping[str, str] = MappingProxyType({"search": "searching", "cp-sat": "cp_sat", "exhaustive": "exhaustive"})

TRAP_ALGORITHMS = tuple(_MODULES)

#: The switches of ``search``; the others have none.
_SWITCHES = frozenset({"counting", "look_ahead"})


def decide_trap(
    graph: Digraph,
    question: Question,
    limits: Limits,
    algorithm: str = "auto",
    options: Mapping[str, Any] = MappingProxyType({}),
    settle: Rung = settle_quickly,
) -> TrapAnswer:
    """Return the answer to one question on ids; its sets were checked against the definition.

    ``settle`` is what :func:`robustness.traps.shortcuts.settle_trap` asks.
    """
    if algorithm == "auto" and not options:
        settled = settle_trap(graph, question, limits, settle)
        if settled is not None:
            return settled.rechecked(graph, question)
    name = "search" if algorithm == "auto" else algorithm
    if options and (name != "search" or not _SWITCHES.issuperset(options)):
        raise InvalidParameter(
            f"the trap algorithm {name!r} does not take {', '.join(options)}: only 'search' has counting and look_ahead"
        )
    if limits.expired():
        return TrapAnswer.undecided("the time limit was reached", decided_by=name)
    module = importlib.import_module(f"robustness.traps.{_MODULES[name]}")
    answer: TrapAnswer = module.decide(graph, question, limits, **options)
    return answer._replace(decided_by=name).rechecked(graph, question)
