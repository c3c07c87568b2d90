"""Exact search for traps and for local violations: the attacks that decide what a network tolerates.

The definitions are in :mod:`robustness.traps.question`. Three ways to decide, one answer: ``search``, a compiled
tree search (:mod:`~robustness.kernels.trap_rules`, :mod:`~robustness.kernels.trap_loop`); ``cp-sat``, a 0-1 programme
(:mod:`~robustness.traps.cp_sat`); ``exhaustive``, the definition tried out. ``auto`` tries the cheap lemmas
first (:mod:`~robustness.traps.shortcuts`), then ``search``.
"""

from robustness.traps.front import find_trap
from robustness.traps.ladder import TRAP_ALGORITHMS
from robustness.traps.results import TrapResult
from robustness.traps.smallest import Trap, is_trap, smallest_trap

__all__ = ["TRAP_ALGORITHMS", "Trap", "TrapResult", "find_trap", "is_trap", "smallest_trap"]
