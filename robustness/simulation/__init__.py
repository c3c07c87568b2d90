"""Simulation of resilient consensus: vehicles, filters, schedules, adversaries, and attacks made from evidence."""

from __future__ import annotations

from robustness.simulation.adversaries import ADVERSARIES
from robustness.simulation.attacks import Attack, attack_from_trap, attack_from_violation
from robustness.simulation.finding import find_attack
from robustness.simulation.gains import PromiseWarning
from robustness.simulation.outcome import Outcome, RunVerdict, Trajectory
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start, random_start
from robustness.simulation.schedules import SCHEDULES, Schedule, schedule_named
from robustness.simulation.topology import Topology, as_topology
from robustness.simulation.update_rules import RULES
from robustness.simulation.validate import ValidationReport, validate_certificate

__all__ = [
    "ADVERSARIES",
    "RULES",
    "SCHEDULES",
    "Attack",
    "Outcome",
    "PromiseWarning",
    "RunVerdict",
    "Scenario",
    "Schedule",
    "Start",
    "Topology",
    "Trajectory",
    "ValidationReport",
    "as_topology",
    "attack_from_trap",
    "attack_from_violation",
    "find_attack",
    "random_start",
    "schedule_named",
    "simulate",
    "validate_certificate",
]
