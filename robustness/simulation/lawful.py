"""What an adversary may do: a move that breaks its fault model or the schedule is an error, not an attack."""

from __future__ import annotations

import numpy as np

from robustness.errors import InvalidParameter
from robustness.simulation.adversaries.protocol import Move, Setting
from robustness.simulation.dynamics import Floats
from robustness.spelled import counted

__all__ = ["require_lawful"]


def require_lawful(move: Move, setting: Setting) -> None:
    """Guarantees that a move stays within the fault model and the schedule, or raises :class:`InvalidParameter`."""
    if not isinstance(move, Move):
        raise InvalidParameter(f"an adversary's play returns a Move, not {type(move).__name__}")
    for name, values in (("claims", move.sent), ("positions", move.positions)):
        if values is None:
            continue
        if (~np.isnan(values) & ~setting.malicious).any():
            raise InvalidParameter(f"an adversary decides for malicious nodes, but it set {name} of normal ones")
        if np.isinf(values).any():
            raise InvalidParameter(f"an adversary sends finite numbers, but some of its {name} are infinite")
    if move.withheld is not None and (move.withheld & ~setting.from_malicious).any():
        raise InvalidParameter("only malicious nodes withhold messages, but the adversary silenced a normal one")
    if move.told is not None:
        _require_lawful_claims(move.told, setting)
    if move.delays is not None:
        if not setting.chooses_delays and (move.delays >= 0).any():
            raise InvalidParameter("this schedule sets the delays itself: give the adversary adversarial delays")
        if move.delays.max(initial=0) > setting.longest_delay:
            longest = counted(setting.longest_delay, "step")
            raise InvalidParameter(f"delays are at most {longest}, but the adversary chose {move.delays.max()}")


def _require_lawful_claims(told: Floats, setting: Setting) -> None:
    """Guarantees that claims on single arcs come from Byzantine nodes, and are finite."""
    if not setting.model.byzantine:
        raise InvalidParameter(
            f"under the model {setting.model.name!r} a node tells all its neighbours the same: "
            "claims on single arcs need a Byzantine model"
        )
    if (~np.isnan(told) & ~setting.from_malicious).any():
        raise InvalidParameter("an adversary speaks for malicious nodes only, but it spoke on a normal node's arc")
    if np.isinf(told).any():
        raise InvalidParameter("an adversary sends finite numbers, but some of its claims are infinite")
