"""Update rules of the user's own: a plain function of (own value, heard values), called vehicle by vehicle."""

from __future__ import annotations

import numpy as np

from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.simulation.arguments import is_real
from robustness.simulation.hearing import Hearing, States, Stores
from robustness.simulation.update_rules import UpdateFunction

__all__ = ["advance_by", "called"]


def called(function: UpdateFunction, own: float, heard: tuple[float, ...]) -> float:
    """Return the next value that a user's rule gives, or raise :class:`InvalidParameter` when it is no number.

    An infinite value or NaN is returned as it is: the run then diverges.
    """
    value = function(own, heard)
    if not is_real(value):
        raise InvalidParameter(
            f"an update rule returns the next value, a number, but for own value {own!r} and heard values {heard!r} "
            f"it returned {value!r}"
        )
    return float(value)


def advance_by(
    function: UpdateFunction,
    graph: Digraph,
    step: int,
    tau: int,
    hearing: Hearing,
    stores: Stores,
    states: States,
) -> None:
    """Advance every run by one step of a user's rule: what the compiled kernel does for the rules of this package.

    Reads ``states.p``, writes ``states.new_p``, and 0 to ``states.new_q``.

    Notes
    -----
    One Python call for every vehicle that updates.
    """
    p, _, new_p, new_q = states
    new_p[:], new_q[:] = p, 0.0
    runs, n = p.shape
    update = np.broadcast_to(hearing.update, p.shape)
    delay, status = (np.broadcast_to(each, (runs, graph.arc_count)) for each in (hearing.delay, hearing.status))
    for b in range(runs):
        for i in range(n):
            heard = []
            for e in range(graph.in_indptr[i], graph.in_indptr[i + 1]):
                if status[b, e] == 1:
                    sent_at = step - int(delay[b, e])
                    heard.append(float(hearing.ring[sent_at % len(hearing.ring), b, hearing.channel[e]]))
                    if stores.remember:
                        stores.memory[b, e], stores.stamp[b, e] = heard[-1], sent_at
                elif status[b, e] == 0 and stores.remember and step - stores.stamp[b, e] <= tau:
                    heard.append(float(stores.memory[b, e]))
            if update[b, i]:
                new_p[b, i] = called(function, float(p[b, i]), tuple(heard))
