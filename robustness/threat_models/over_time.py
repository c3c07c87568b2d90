"""Tolerance of a time-varying network, under delays.

Promised: agreement against f, when the sequence is jointly (2f+1)-robust over every l steps for some ``l <= tau``. Here
``tau`` bounds delays and how old the value of a link that has gone may be (the source paper's last corollary).

Refuted: f with a trap in the *union* of all steps. A vehicle hears at any step, also through links that have gone, only
in-neighbours of the union. So a node of S_k still hears at most f values other than its own from outside, and discards
them; with ``tau >= 1`` delays show either side its own face of every malicious node, as in a fixed network.

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
from robustness.time_varying.checking import check_joint_within

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
        theorem="the source paper, corollary on time-varying networks: jointly (2f+1)-robust with l <= tau, "
        f"{SECOND_ORDER_GAINS}",
        counter_theorem=f"{threat.counter_theorem}; no vehicle ever hears anybody it does not hear in the union",
    )


@dataclass(slots=True)
class JointDecisions(Decisions):
    """What has been decided about one sequence: ``graph`` is the union of its steps, promises are about windows."""

    sequence: TimeVaryingGraph = field(kw_only=True)
    tau: int = field(kw_only=True)
    _joint: dict[int, RobustnessResult] = field(default_factory=dict)
    _windows: dict[int, int] = field(default_factory=dict)

    def twice_robust(self, f: int, share: float = 1.0) -> RobustnessResult:
        """Return whether the sequence is jointly (2f+1)-robust with ``l <= tau``."""
        if f not in self._joint:
            self._joint[f] = self._decide(2 * f + 1, share)
        return self._joint[f]

    def strength(self, f: int, *, holds: bool) -> str:
        """Return in words over how many steps the sequence is jointly robust, or that it is not within tau."""
        r = 2 * f + 1
        if not holds:
            return f"the network is not jointly {r}-robust over any number of steps up to tau = {self.tau}"
        trace = "" if self.sequence.period else " (a finite trace: nothing is said beyond its last step)"
        return f"the network is jointly {r}-robust over every {self._windows[r]} steps, within tau = {self.tau}{trace}"

    @property
    def scene(self) -> str:
        """Where traps are looked for."""
        return "in the union of all steps, "

    def _decide(self, r: int, share: float) -> RobustnessResult:
        started = time.monotonic()
        found = check_joint_within(self.sequence, r, 1, tau=self.tau, limits=self.limits.share(share))
        verdict = found.verdict
        if found.within_tau is not None:
            verdict = Verdict.ROBUST if found.within_tau else Verdict.NOT_ROBUST
        elif found.verdict is Verdict.UNDECIDED and found.at_least > self.tau:
            verdict = Verdict.NOT_ROBUST
        if verdict is Verdict.ROBUST and found.window is not None:
            self._windows[r] = found.window
        return RobustnessResult(
            verdict, r, 1, algorithm="unions of windows", stats=found.stats, seconds=time.monotonic() - started
        )
