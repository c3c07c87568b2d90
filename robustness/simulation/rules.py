"""The update rules by name: what a normal vehicle does with what it hears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from robustness.errors import InvalidParameter

__all__ = ["ADP_MSR", "DP_MSR", "RULES", "W_MSR", "Rule", "rule_named"]


@dataclass(frozen=True, slots=True)
class Rule:
    """An update rule.

    Attributes
    ----------
    name : str
        As users type it.
    first_order : bool
        Nodes hold a number and move to a weighted mean; otherwise they are double integrators.
    strict : bool
        Whether only values strictly beyond the own one may be dropped (W-MSR as published), or also equal ones
        (Algorithm 1 of the source paper). The difference shows only in the weights of the mean: an equal value
        contributes nothing to a control input.
    synchronous : bool
        Whether the rule is defined only for updates at every step without delays.
    """

    name: str
    first_order: bool
    strict: bool
    synchronous: bool


#: LeBlanc, Zhang, Koutsoukos, Sundaram 2013: first order, the weighted mean of what the filter keeps.
W_MSR = Rule("w-msr", first_order=True, strict=True, synchronous=False)
#: Dibaji, Ishii 2015: double integrators, synchronous and without delays.
DP_MSR = Rule("dp-msr", first_order=False, strict=False, synchronous=True)
#: Algorithm 1 of the source paper: double integrators, updates now and then, delays, values held in between.
ADP_MSR = Rule("adp-msr", first_order=False, strict=False, synchronous=False)

#: Every rule by its name.
RULES: Mapping[str, Rule] = MappingProxyType({rule.name: rule for rule in (W_MSR, DP_MSR, ADP_MSR)})


def rule_named(name: str) -> Rule:
    """Return the rule of this name, or raise :class:`InvalidParameter` naming those there are."""
    if name not in RULES:
        raise InvalidParameter(f"an update rule is one of {', '.join(RULES)}, not {name!r}")
    return RULES[name]
