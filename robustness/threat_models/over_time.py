"""Tolerance of a time-varying network, under delays: Theorem C of docs/theorems.md.

With memory tau (a value that left its sender at most tau steps ago is still used, also when its link has gone), delays
of at most b, and updates at most g steps apart:

* *Guaranteed*: f, when the sequence is jointly (2f+1)-robust over every l steps with
  ``(l - 1) + (g - 1) + b <= tau``. (The source paper's last corollary asks for ``l <= tau`` alone and is false.)
* *Refuted*: f with a trap in the *union* of all steps, since nobody hears anybody whom it does not hear there.
* *Exactly*, for sequences that repeat: f is refuted if and only if one triple holds everything remembered apart
  (:mod:`robustness.threat_models.remembered`).

The first two are tried first. A finite trace promises and forbids nothing beyond its last step: taken to go on as it
was, what the first two leave between them stays open, however long one looks.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from robustness.errors import InvalidParameter
from robustness.limits import Limits
from robustness.results import Verdict
from robustness.spelled import counted
from robustness.threat_models.decisions import Decisions, Finding
from robustness.threat_models.models import SECOND_ORDER_GAINS, THREAT_MODELS, ThreatModel
from robustness.threat_models.remembered import BEFORE_THE_PERIOD, Remembered, find_in_all
from robustness.time_varying import TimeVaryingGraph
from robustness.time_varying.front import check_joint_within
from robustness.traps.question import Question, Sets, solves

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
        theorem=f"docs/theorems.md, Theorem C, for first-order nodes and for {SECOND_ORDER_GAINS}",
        counter_theorem=f"{threat.counter_theorem}, and Theorem C: nobody hears more than what is remembered",
    )


@dataclass(slots=True)
class JointDecisions(Decisions):
    """What has been decided about one sequence: ``graph`` is the union of its steps."""

    sequence: TimeVaryingGraph = field(kw_only=True)
    tau: int = field(kw_only=True)
    #: The bound b on delays and the longest gap g between updates.
    delay: int = field(kw_only=True)
    gap: int = field(kw_only=True)
    _joint: dict[int, Verdict] = field(default_factory=dict)
    _windows: dict[int, int] = field(default_factory=dict)
    _union: Decisions | None = None
    _remembered: Remembered | None = None

    @property
    def union(self) -> Decisions:
        """What is decided about the union of all steps, as a fixed network."""
        if self._union is None:
            self._union = Decisions(self.graph, self.limits)
        return self._union

    @property
    def remembered(self) -> Remembered:
        """The links in use at every step."""
        if self._remembered is None:
            self._remembered = Remembered.of(self.sequence, self.tau, self.delay, self.gap)
        return self._remembered

    def quick_attack(self, question: Question) -> Finding | None:
        """Return what lemmas about the union tell, which can only be an attack, or None."""
        known = self._attacks.get(question)
        if known is None or known.exists is None:
            known = self.union.quick_attack(question)
            if known is None or not known.exists:
                return None
            self._attacks[question] = known
        return known

    def attack(self, question: Question, share: float = 1.0) -> Finding:
        """Return whether an attack of this kind exists."""
        known = self._attacks.get(question)
        if known is None or known.exists is None:
            known = self._attacks[question] = self._from_others(question) or self._decide(question, share)
        return known

    def statement(self, f: int, question: Question) -> str:
        """Return in words what is known about the sequence when there is no attack of this kind on f."""
        trace = "" if self.sequence.period else " (a finite trace: nothing is said beyond its last step)"
        window = self._windows.get(2 * f + 1)
        if window is not None:
            every = "step" if window == 1 else counted(window, "step")
            return f"the network is jointly {2 * f + 1}-robust over every {every}; windows {self._room}{trace}"
        local = "f-local " if question.local else ""
        return f"no {local}triple M, S1, S2 for f = {f} holds what is remembered apart at every step ({self._ages})"

    @property
    def longest_window(self) -> int:
        """The greatest l with ``(l - 1) + (g - 1) + b <= tau``; below 1 there is none."""
        return self.tau - self.delay - self.gap + 2

    @property
    def scene(self) -> str:
        """Where traps are looked for."""
        return "in what is remembered at any step, "

    def _decide(self, question: Question, share: float) -> Finding:
        limits = self.limits.share(share)
        twice = self._jointly(question.f, limits.share(0.3))
        if twice is Verdict.ROBUST:
            return Finding(False, None, f"unions of {counted(self._windows[2 * question.f + 1], 'step')}")
        self.union.limits = limits.share(0.4)
        found = self.union.attack(question)
        if found.exists:
            return found
        if self.sequence.period is None:
            if found.exists is None or twice is Verdict.UNDECIDED:
                return Finding(None, None, "the time limit was reached")
            return Finding(None, None, "a finite trace does not say what comes after it", is_open=True)
        exists, sets, how = find_in_all(self.remembered, question, limits)
        return Finding(exists, sets, how, is_open=how == BEFORE_THE_PERIOD)

    def _from_others(self, question: Question) -> Finding | None:
        """No attack for a greater f, or a looser bound, means none here; an attack on a smaller f is one here."""
        for other, found in self._attacks.items():
            if found.exists is False and other.f >= question.f and other.local >= question.local:
                return Finding(False, None, found.how)
            if found.exists and other.f <= question.f and other.local <= question.local:
                sets = found.sets or Sets(frozenset(), frozenset(), frozenset())
                if solves(self.graph, question, sets):
                    return Finding(True, sets, found.how)
        return None

    @property
    def _ages(self) -> str:
        return f"tau = {self.tau}, delays up to {self.delay}, updates up to {counted(self.gap, 'step')} apart"

    @property
    def _room(self) -> str:
        """Why windows may be so long and no longer."""
        return f"may have up to {counted(max(self.longest_window, 0), 'step')} ({self._ages})"

    def _jointly(self, f: int, limits: Limits) -> Verdict:
        """Return whether the sequence is jointly (2f+1)-robust with ``(l - 1) + (g - 1) + b <= tau``."""
        r, longest = 2 * f + 1, self.longest_window
        if longest < 1:
            return Verdict.NOT_ROBUST
        if r not in self._joint:
            found = check_joint_within(self.sequence, r, 1, tau=longest, limits=limits)
            verdict = found.verdict
            if found.within_tau is not None:
                verdict = Verdict.ROBUST if found.within_tau else Verdict.NOT_ROBUST
            elif found.verdict is Verdict.UNDECIDED and found.at_least > longest:
                verdict = Verdict.NOT_ROBUST
            if verdict is Verdict.ROBUST and found.window is not None:
                self._windows[r] = found.window
            self._joint[r] = verdict
        return self._joint[r]
