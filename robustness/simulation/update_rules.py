"""The update rules by name: what a normal vehicle does with what it hears."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from robustness.errors import InvalidParameter

__all__ = ["ADP_MSR", "DP_MSR", "RULES", "W_MSR", "Rule", "UpdateFunction", "rule_named"]

#: An update rule of one's own: ``function(own value, heard values in the order of their senders) -> next value``.
UpdateFunction = Callable[[float, tuple[float, ...]], float]


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
        (Algorithm 1 of the source paper). A value equal to the own one adds nothing to the control input *at the
        update*; it counts in the weights of a mean, and between updates, when the vehicle has moved on and the
        value that it kept has not.
    synchronous : bool
        Whether the rule is defined only for updates at every step without delays.
    update : function, optional
        The next value, for a rule of the user's own; the other attributes then say that it is first order.
    """

    name: str
    first_order: bool
    strict: bool
    synchronous: bool
    update: UpdateFunction | None = None


#: LeBlanc, Zhang, Koutsoukos, Sundaram 2013: first order, the weighted mean of what the filter keeps.
W_MSR = Rule("w-msr", first_order=True, strict=True, synchronous=False)
#: Dibaji, Ishii 2015: double integrators, synchronous and without delays.
DP_MSR = Rule("dp-msr", first_order=False, strict=False, synchronous=True)
#: Algorithm 1 of the source paper: double integrators, updates now and then, delays, values held in between.
ADP_MSR = Rule("adp-msr", first_order=False, strict=False, synchronous=False)

#: Every rule by its name.
RULES: Mapping[str, Rule] = MappingProxyType({rule.name: rule for rule in (W_MSR, DP_MSR, ADP_MSR)})


def rule_named(rule: str | Rule | UpdateFunction) -> Rule:
    """Return the rule of this name, or the rule that a function of one's own makes.

    Parameters
    ----------
    rule : str, Rule or function
        A function is called at every update as ``rule(own, heard)`` with the own value and a tuple of the values
        heard, in the order of their senders, and returns the next value; between updates the value stays.

    Raises
    ------
    InvalidParameter
        When there is no rule of this name.

    >>> rule_named(lambda own, heard: own).first_order
    True
    """
    if isinstance(rule, Rule):
        return rule
    if isinstance(rule, str) and rule in RULES:
        return RULES[rule]
    if callable(rule) and not isinstance(rule, type):
        name = getattr(rule, "__name__", type(rule).__name__)
        _require_two_values(rule, name)
        return Rule(name, first_order=True, strict=True, synchronous=False, update=rule)
    raise InvalidParameter(
        f"an update rule is one of {', '.join(RULES)} or a function of (own value, heard values), not {rule!r}"
    )


def _require_two_values(rule: UpdateFunction, name: str) -> None:
    """Refuse a function that cannot be called with an own value and the values heard, before anything runs."""
    try:
        inspect.signature(rule).bind(0.0, ())
    except TypeError:
        raise InvalidParameter(
            f"an update rule is called as {name}(own, heard), and this one takes other arguments: give it these two"
        ) from None
    except ValueError:  # a function that has no signature, as some built-in ones
        return
