"""Given parameters: does what is promised about a network, or the attack on it, hold for these vehicles?

A promise of :func:`robustness.threat_models.tolerance` is a theorem with hypotheses (docs/theorems.md). Here they are
compared with one choice of the sampling period, the gain, the weights, the delays and the update times. The gains are
judged by :func:`robustness.gain_region.gain_gap`, which ``simulate`` asks for its warnings too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robustness.errors import InvalidParameter
from robustness.gain_region import gain_gap, gain_region
from robustness.threat_models.models import ThreatModel

__all__ = ["Parameters"]


@dataclass(frozen=True, slots=True)
class Parameters:
    """How vehicles move and hear; what is None was not given, and may be anything that the theorem allows.

    Attributes
    ----------
    T : float or None
        The sampling period of second-order vehicles, positive. None: first-order ones, for which every kept value has a
        positive weight and there is no gain.
    alpha : float or None
        Their gain, positive; ``1.5 / T`` when only T was given.
    sigma : float or None
        A bound on the sum of the weights that a vehicle keeps, positive; 1 when only T was given.
    delay : int or None
        No message is older than so many steps when it arrives; 0 or more.
    gap : int or None
        Every vehicle updates at least once in so many consecutive steps; 1 or more.
    """

    T: float | None = None
    alpha: float | None = None
    sigma: float | None = None
    delay: int | None = None
    gap: int | None = None

    @classmethod
    def of(
        cls, T: float | None, alpha: float | None, sigma: float | None, delay: int | None, gap: int | None
    ) -> Parameters | None:
        """Return the parameters with their defaults filled in, or None when none was given.

        Raises
        ------
        InvalidParameter
            For a gain or weights without a sampling period, and for a number out of its range.
        """
        if T is None:
            for name, value in (("alpha", alpha), ("sigma", sigma)):
                if value is not None:
                    raise InvalidParameter(f"{name} = {value!r} says something only with a sampling period: give T too")
        else:
            alpha = 1.5 / T if alpha is None and _is_positive(T) else alpha
            sigma = 1.0 if sigma is None else sigma
            for name, number in (("T", T), ("alpha", alpha), ("sigma", sigma)):
                if not _is_positive(number):
                    raise InvalidParameter(f"{name} is a positive number, not {number!r}")
        for name, steps, least in (("delay", delay, 0), ("gap", gap, 1)):
            if steps is not None and (type(steps) is not int or steps < least):
                raise InvalidParameter(f"{name} is an integer of at least {least}, not {steps!r}")
        if all(each is None for each in (T, delay, gap)):
            return None
        return cls(T, alpha, sigma, delay, gap)

    def promise_gap(self, threat: ThreatModel) -> str | None:
        """Return why a promise of this model does not apply and what would make it apply; None when it does."""
        if not threat.two_faces:
            late = self.delay is not None and self.delay > 0
            if late or (self.gap is not None and self.gap > 1):
                met = "delays" if late else "updates out of step"
                return f"Theorem B knows no {met}: take delay 0 and gap 1, or a delayed model"
        if self.T is None or self.alpha is None or self.sigma is None:
            return None
        return gain_gap(self.T, self.alpha, self.sigma)

    def attack_gap(self, threat: ThreatModel) -> str | None:
        """Return why the attack of this model cannot be carried out, and whom to ask instead; None when it can."""
        if threat.delayed and self.delay == 0 and self.gap == 1:
            return "without delays and with updates at every step liars have one face: take a malicious model"
        return None

    def told(self, threats: Sequence[ThreatModel]) -> str:
        """Return in one line whether what is known about these models applies, and what would make it apply."""
        gaps: dict[str, list[str]] = {}
        for threat in threats:
            for what, gap in (("promise", self.promise_gap(threat)), ("attack", self.attack_gap(threat))):
                if gap is not None:
                    gaps.setdefault(f"the {what} does not apply ({gap})", []).append(threat.name)
        if not gaps:
            return f"{self}: what is known applies"
        apart = [
            reason if len(names) == len(threats) else f"{', '.join(names)}: {reason}" for reason, names in gaps.items()
        ]
        return f"{self}: {'; '.join(apart)}"

    def as_dict(self, threat: ThreatModel) -> dict[str, Any]:
        """Return the parameters and whether they fit one model, as JSON-ready values."""
        gaps = {"promise_gap": self.promise_gap(threat), "attack_gap": self.attack_gap(threat)}
        given = {"T": self.T, "alpha": self.alpha, "sigma": self.sigma, "delay": self.delay, "gap": self.gap}
        return given | {"applies": not any(gaps.values())} | gaps

    def __str__(self) -> str:
        parts = ["first order"]
        if self.T is not None and self.alpha is not None and self.sigma is not None:
            parts = [f"T = {self.T:g}, alpha = {self.alpha:g}, sigma = {self.sigma:g}"]
            region = gain_region(self.T, self.sigma)
            if region is not None and gain_gap(self.T, self.alpha, self.sigma) is None:
                parts[0] += f" (alpha T = {self.alpha * self.T:.6g} in {region[0]:.6g} .. {region[1]:.6g})"
        if self.delay is not None:
            parts.append(f"delays up to {self.delay}" if self.delay else "no delays")
        if self.gap is not None:
            parts.append(f"updates at most {self.gap} {'step' if self.gap == 1 else 'steps'} apart")
        return ", ".join(parts)


def _is_positive(value: float | None) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) and value > 0
