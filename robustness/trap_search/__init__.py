"""Exact search for traps and for local violations: the attacks that decide what a network tolerates.

The definitions are in :mod:`robustness.trap_search.question`. Three ways to decide, one answer: ``search``, a compiled
tree search (:mod:`~robustness.trap_search.kernel`, :mod:`~robustness.trap_search.loop`); ``cp-sat``, a 0-1 programme
(:mod:`~robustness.trap_search.cp_sat`); ``exhaustive``, the definition tried out. ``auto`` tries the cheap lemmas
first (:mod:`~robustness.trap_search.shortcuts`), then ``search``.
"""

from robustness.trap_search.finding import TRAP_ALGORITHMS, TrapResult, find_trap

__all__ = ["TRAP_ALGORITHMS", "TrapResult", "find_trap"]
