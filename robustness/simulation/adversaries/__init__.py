"""Adversaries, one file each, and the battery of those that need no evidence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from robustness.simulation.adversaries.alternating import Alternating
from robustness.simulation.adversaries.constant import Constant
from robustness.simulation.adversaries.crash import Crash
from robustness.simulation.adversaries.extreme import ExtremeValue
from robustness.simulation.adversaries.greedy import Greedy
from robustness.simulation.adversaries.liar import Liar
from robustness.simulation.adversaries.noise import Noise
from robustness.simulation.adversaries.omission import Omission
from robustness.simulation.adversaries.protocol import Adversary, Move, Setting, View
from robustness.simulation.adversaries.ramp import Ramp
from robustness.simulation.adversaries.sine import Sine
from robustness.simulation.adversaries.two_face import TwoFace

__all__ = [
    "ADVERSARIES",
    "Adversary",
    "Alternating",
    "Constant",
    "Crash",
    "ExtremeValue",
    "Greedy",
    "Liar",
    "Move",
    "Noise",
    "Omission",
    "Ramp",
    "Setting",
    "Sine",
    "TwoFace",
    "View",
]

#: The battery: every adversary that needs nothing but a network, by the name users type.
ADVERSARIES: Mapping[str, Callable[[], Adversary]] = MappingProxyType(
    {
        "constant": Constant,
        "ramp": Ramp,
        "sine": Sine,
        "random": Noise,
        "two-face": TwoFace,
        "extreme": ExtremeValue,
        "greedy": Greedy,
        "crash": Crash,
        "omission": Omission,
    }
)
