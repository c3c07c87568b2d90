"""Every attack is carried out before it is believed."""

from __future__ import annotations

from robustness.threat_models.results import ToleranceResult

__all__ = ["confirm"]


def confirm(result: ToleranceResult, steps: int = 12) -> bool | None:
    """Play the attack on ``result.refuted`` by the plain loop; does it split exactly? None without an attack.

    *Exactly*: no vehicle of the two groups moves by one bit or gains any speed, at any step. An attack repeats after
    two steps, so a few are as good as many: :mod:`robustness.simulation.attacks` has the induction.

    >>> import networkx as nx
    >>> from robustness.threat_models import tolerance
    >>> confirm(tolerance(nx.wheel_graph(5), "delayed"))
    True
    """
    from robustness.simulation.reference import simulate_plainly

    attack = result.attack
    if attack is None:
        return None
    rules = ("adp-msr", "w-msr") if attack.delayed else ("adp-msr", "dp-msr", "w-msr")
    scenarios = [attack.scenario(steps, rule=rule) for rule in rules]
    return all(simulate_plainly(each, [attack.start()])[0].exact for each in scenarios)
