"""Tolerance of a time-varying network, under delays.

Promised: agreement against f, when the sequence is jointly (2f+1)-robust over every l steps with
``(l - 1) + (g - 1) + b <= tau``. Here b bounds the delays, g is the longest gap between two updates of a vehicle, and a
link that has gone is remembered: a value that left its sender at most tau steps ago is still used.

Why the three add up. A vehicle that updates at step k used some step of the last g. What it has of a link was sent
while the link was there, up to l - 1 steps before, and arrived up to b steps late. Only when the oldest of these values
is still remembered does the vehicle hear, whenever it updates, a union of l steps. The source paper's last corollary
asks for ``l <= tau`` alone and is false: K_5, whose even steps lack the links 03, 12 and whose odd steps lack 02, 13,
is jointly 3-robust over 2 steps, and with tau = 2 and all delays 2 one liar splits it for ever, exactly
(tests/tolerance).

Refuted: f with a trap in the *union* of all steps. A vehicle hears at any step, also through links that have gone, only
in-neighbours of the union. So a node of S_k still hears at most f values other than its own from outside, and discards
them; with ``b >= 1`` delays show either side its own face of every malicious node, as in a fixed network.

A finite trace promises and forbids nothing beyond its last step.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

from robustness.errors import InvalidParameter
from robustness.results import RobustnessResult, Verdict
from robustness.threat_models.deciding import Decisions
from robustness.threat_models.models import SECOND_ORDER_GAINS, THREAT_MODELS, ThreatModel
from robustness.time_varying import TimeVaryingGraph
from robustness.time_varying.front import check_joint_within

__all__ = ["MODELS_OVER_TIME", "JointDecisions", "over_time"]

#: The threat models that theory speaks about for time-varying networks.
MODELS_OVER_TIME = ("delayed", "delayed-local")


def over_time(name: str) -> ThreatModel:
    """Return the threat model of this name with its theorems for time-varying networks."""
    if name not in MODELS_OVER_TIME:
        raise InvalidParameter(
            f"for a time-varying network a threat model is {' or '.join(MODELS_OVER_TIME)}, not {name!r}"
        )
    threat = THREAT_MODELS[name]
    return replace(
        threat,
        setting=f"{threat.setting}; links come and go",
        theorem="the source paper, corollary on time-varying networks, corrected: jointly (2f+1)-robust with "
        f"(l - 1) + (g - 1) + b <= tau, {SECOND_ORDER_GAINS}",
        counter_theorem=f"{threat.counter_theorem}; no vehicle ever hears anybody it does not hear in the union",
    )


@dataclass(slots=True)
class JointDecisions(Decisions):
    """What has been decided about one sequence: ``graph`` is the union of its steps, promises are about windows."""

    sequence: TimeVaryingGraph = field(kw_only=True)
    tau: int = field(kw_only=True)
    #: The bound b on delays and the longest gap g between updates.
    delay: int = field(kw_only=True)
    gap: int = field(kw_only=True)
    _joint: dict[int, RobustnessResult] = field(default_factory=dict)
    _windows: dict[int, int] = field(default_factory=dict)

    def twice_robust(self, f: int, share: float = 1.0) -> RobustnessResult:
        """Return whether the sequence is jointly (2f+1)-robust with ``(l - 1) + (g - 1) + b <= tau``."""
        if f not in self._joint:
            self._joint[f] = self._decide(2 * f + 1, share)
        return self._joint[f]

    def strength(self, f: int, *, holds: bool) -> str:
        """Return in words over how many steps the sequence is jointly robust, or that it is not within tau."""
        r = 2 * f + 1
        if not holds:
            return f"the network is not jointly {r}-robust over any number of steps that {self._room}"
        trace = "" if self.sequence.period else " (a finite trace: nothing is said beyond its last step)"
        return f"the network is jointly {r}-robust over every {self._windows[r]} steps; windows {self._room}{trace}"

    @property
    def longest_window(self) -> int:
        """The greatest l with ``(l - 1) + (g - 1) + b <= tau``; below 1 there is none."""
        return self.tau - self.delay - self.gap + 2

    @property
    def _room(self) -> str:
        """Why windows may be so long and no longer."""
        return (
            f"may have up to {max(self.longest_window, 0)} steps (tau = {self.tau}, delays up to {self.delay}, "
            f"updates up to {self.gap} steps apart)"
        )

    @property
    def scene(self) -> str:
        """Where traps are looked for."""
        return "in the union of all steps, "

    def _decide(self, r: int, share: float) -> RobustnessResult:
        started = time.monotonic()
        longest = self.longest_window
        if longest < 1:
            return RobustnessResult(Verdict.NOT_ROBUST, r, 1, algorithm="no window is short enough")
        found = check_joint_within(self.sequence, r, 1, tau=longest, limits=self.limits.share(share))
        verdict = found.verdict
        if found.within_tau is not None:
            verdict = Verdict.ROBUST if found.within_tau else Verdict.NOT_ROBUST
        elif found.verdict is Verdict.UNDECIDED and found.at_least > longest:
            verdict = Verdict.NOT_ROBUST
        if verdict is Verdict.ROBUST and found.window is not None:
            self._windows[r] = found.window
        return RobustnessResult(
            verdict, r, 1, algorithm="unions of windows", stats=found.stats, seconds=time.monotonic() - started
        )
