"""From decisions about a graph to what is guaranteed and refuted under one threat model."""

from __future__ import annotations

from robustness.spelled import counted
from robustness.threat_models.decisions import Decisions, Finding, certain_attack
from robustness.threat_models.models import ThreatModel
from robustness.threat_models.results import AttackSets, Reason, Standing, ToleranceResult
from robustness.traps.question import Sets, solves

__all__ = ["judge"]


def judge(decisions: Decisions, threat: ThreatModel) -> ToleranceResult:
    """Return what is known under one threat model.

    Agreement against f is promised if and only if there is no attack of the model's kind on f (docs/theorems.md). Both
    are monotone: no attack for f + 1 means none for f, and an attack on f is one on f + 1.
    """
    graph = decisions.graph
    if graph.n < 2:
        return _nobody_to_disagree(decisions, threat)
    found = _attacks(decisions, threat)
    guaranteed = max((f for f, each in found.items() if each.exists is False), default=-1)
    refuted = min((f for f, each in found.items() if each.exists), default=None)
    sets = None
    if refuted is not None:
        ids = found[refuted].sets or Sets(frozenset(), frozenset(), frozenset())
        M, S1, S2 = (graph.labels_of(each) for each in ids)
        remembered = not solves(graph, threat.question(refuted), ids)
        sets = AttackSets(refuted, 2 if threat.two_faces else 1, threat.local, M, S1, S2, remembered)
    reasons = _Reasons(decisions, threat, found)
    told: list[Reason] = []
    if guaranteed >= 0:
        told.append(reasons.promise(guaranteed))
    if refuted is not None and sets is not None:
        told.append(reasons.attack(refuted, sets))
    end = certain_attack(graph.n, threat.two_faces) if refuted is None else refuted
    told += [reasons.undecided(f) for f in range(guaranteed + 1, end)]
    return ToleranceResult(graph, threat, guaranteed, refuted, tuple(told), sets)


def _nobody_to_disagree(decisions: Decisions, threat: ThreatModel) -> ToleranceResult:
    reason = Reason(
        Standing.GUARANTEED,
        0,
        "there are fewer than two nodes",
        "no two normal nodes can disagree, whatever f is",
        "none",
    )
    return ToleranceResult(decisions.graph, threat, 0, None, (reason,))


def _attacks(decisions: Decisions, threat: ThreatModel) -> dict[int, Finding]:
    """Return what is known about attacks, for every f up to the first that has one.

    Lemmas first: from below while they exclude an attack, then by halving for the least f that they attack. What lies
    between is searched, from below; a limit is shared out evenly among it.
    """
    found: dict[int, Finding] = {}
    low, high = 0, certain_attack(decisions.graph.n, threat.two_faces)
    while low <= high:
        quick = decisions.quick_attack(threat.question(low))
        if quick is None or quick.exists:
            break
        found[low] = quick
        low += 1
    least, top = low, high
    while least <= top:
        middle = (least + top) // 2
        quick = decisions.quick_attack(threat.question(middle))
        if quick is not None and quick.exists:
            found[middle], high, top = quick, middle, middle - 1
        else:
            least = middle + 1
    for f in range(low, high + 1):
        if f not in found:
            found[f] = decisions.attack(threat.question(f), 1 / (1 + high - f) if high > f else 1.0)
        if found[f].exists or (found[f].exists is None and decisions.limits.expired()):
            break  # what a limit left open is told as undecided
    return found


class _Reasons:
    """The sentences about one model, each with its theorem and its evidence."""

    def __init__(self, decisions: Decisions, threat: ThreatModel, found: dict[int, Finding]) -> None:
        self._decisions, self._threat, self._found = decisions, threat, found

    def promise(self, f: int) -> Reason:
        statement = self._decisions.statement(f, self._threat.question(f))
        return Reason(Standing.GUARANTEED, f, statement, self._threat.theorem, self._how(f))

    def attack(self, f: int, sets: AttackSets) -> Reason:
        threat = self._threat
        bound = "around every normal node" if sets.local else "in all"
        if sets.faces == 2:
            rule = f"every node of S1 (of S2) hears at most {_nodes(f)} outside S1 and M (outside S2 and M)"
        else:
            rule = f"every node of S1 (of S2) outside M hears at most {_nodes(f)} outside S1 (outside S2)"
        statement = f"{self._decisions.scene}{rule}; M has {_nodes(len(sets.M))}, at most {f} {bound}"
        evidence = f"{self._found[f].how}; the sets M, S1, S2, re-checked against the definition"
        return Reason(Standing.REFUTED, f, statement, threat.counter_theorem, evidence)

    def undecided(self, f: int) -> Reason:
        how, known = self._how(f), self._found.get(f)
        if known is not None and known.is_open:
            return Reason(Standing.OPEN, f, f"what is given does not determine f = {f}", f"none: {how}", how)
        return Reason(
            Standing.UNDECIDED, f, f"nothing was decided about f = {f}", "none: a limit stopped the work", how
        )

    def _how(self, f: int) -> str:
        """Return what decided that there is no attack on f: the search for f itself, or for a greater one."""
        known = [f, *sorted(g for g in self._found if g > f and self._found[g].exists is False)]
        return next((self._found[g].how for g in known if g in self._found), "a limit was reached")


def _nodes(count: int) -> str:
    return counted(count, "node")
