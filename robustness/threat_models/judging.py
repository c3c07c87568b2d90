"""From decisions about a graph to what is guaranteed, refuted and open under one threat model."""

from __future__ import annotations

from robustness.results import Verdict
from robustness.threat_models.deciding import Decisions, Finding, certain_attack, highest_promise
from robustness.threat_models.models import NO_TRAP, TWICE_ROBUST, ThreatModel
from robustness.threat_models.results import AttackSets, Reason, Standing, ToleranceResult

__all__ = ["judge"]


def judge(decisions: Decisions, threat: ThreatModel) -> ToleranceResult:
    """Return what is known under one threat model.

    Both conditions are monotone: what is promised for f + 1 is promised for f, and an attack on f is one on f + 1. So
    the promise is tried for f = 0, 1, ... until it fails, and attacks from there on until one is found.
    """
    graph = decisions.graph
    if graph.n < 2:
        return _nobody_to_disagree(decisions, threat)
    promised, no_promise = (-1, None) if threat.exact else _promises(decisions)
    found = _attacks(decisions, threat, promised)
    # No attack for f means none for any smaller f.
    no_attack = max((f for f, each in found.items() if each.exists is False), default=promised)
    refuted = min((f for f, each in found.items() if each.exists), default=None)
    if threat.exact:
        promised, no_promise = no_attack, refuted
    sets = None
    if refuted is not None:
        ids = found[refuted].sets or (frozenset(), frozenset(), frozenset())
        M, S1, S2 = (graph.labels_of(each) for each in ids)
        sets = AttackSets(refuted, 2 if threat.two_faces else 1, threat.local, M, S1, S2)
    reasons = _Reasons(decisions, threat, found)
    between = range(promised + 1, certain_attack(graph.n, threat.two_faces) if refuted is None else refuted)
    told: list[Reason] = []
    if promised >= 0:
        told.append(reasons.promise(promised))
    if refuted is not None and sets is not None:
        told.append(reasons.attack(refuted, sets))
    for f in between:
        is_open = no_promise is not None and no_promise <= f <= no_attack
        told.append(reasons.open(f) if is_open else reasons.undecided(f))
    return ToleranceResult(graph, threat, promised, refuted, tuple(told), sets, no_attack, no_promise)


def _nobody_to_disagree(decisions: Decisions, threat: ThreatModel) -> ToleranceResult:
    reason = Reason(
        Standing.GUARANTEED,
        0,
        "there are fewer than two nodes",
        "no two normal nodes can disagree, whatever f is",
        "none",
    )
    return ToleranceResult(decisions.graph, threat, 0, None, (reason,), no_attack=0)


def _promises(decisions: Decisions) -> tuple[int, int | None]:
    """Return the largest f with a (2f+1)-robust graph, and the smallest f known to be without (None: a limit)."""
    highest = highest_promise(decisions.graph.n)
    for f in range(highest + 1):
        verdict = decisions.twice_robust(f, 0.5).verdict
        if verdict is not Verdict.ROBUST:
            return f - 1, f if verdict is Verdict.NOT_ROBUST else None
    return highest, highest + 1


def _attacks(decisions: Decisions, threat: ThreatModel, promised: int) -> dict[int, Finding]:
    """Return what is known about attacks for each f above ``promised``, up to the first that has one."""
    highest = certain_attack(decisions.graph.n, threat.two_faces)
    found: dict[int, Finding] = {}
    easy = highest
    for f in range(promised + 1, highest + 1):
        quick = decisions.quick_attack(threat.question(f))
        if quick is not None:
            found[f] = quick
            if quick.exists:
                easy = f
                break
    for f in range(promised + 1, easy + 1):
        if f not in found:
            found[f] = decisions.attack(threat.question(f), 1 / (1 + easy - f) if easy > f else 1.0)
        if found[f].exists:
            break
    return found


class _Reasons:
    """The sentences about one model, each with its theorem and its evidence."""

    def __init__(self, decisions: Decisions, threat: ThreatModel, found: dict[int, Finding]) -> None:
        self._decisions, self._threat, self._found = decisions, threat, found

    def promise(self, f: int) -> Reason:
        threat = self._threat
        if threat.promise == TWICE_ROBUST:
            result = self._decisions.twice_robust(f)
            rule = f" ({result.stats['rule']})" if "rule" in result.stats else ""
            statement, evidence = self._decisions.strength(f, holds=True), f"decided by {result.algorithm}{rule}"
        else:
            evidence = self._how(f)
            statement = f"the network is ({f + 1},{f + 1})-robust"
            if threat.promise == NO_TRAP:
                statement = f"without any {_nodes(f)} the network is still {f + 1}-robust: there is no trap for f = {f}"
            if f == 0:
                statement = "the network is 1-robust"
        return Reason(Standing.GUARANTEED, f, statement, threat.theorem, evidence)

    def attack(self, f: int, sets: AttackSets) -> Reason:
        threat = self._threat
        bound = "around every normal vehicle" if sets.local else "in all"
        if sets.faces == 2:
            rule = f"every node of S1 (of S2) hears at most {_nodes(f)} outside S1 and M (outside S2 and M)"
        else:
            rule = f"every node of S1 (of S2) outside M hears at most {_nodes(f)} outside S1 (outside S2)"
        statement = f"{self._decisions.scene}{rule}; M has {_nodes(len(sets.M))}, at most {f} {bound}"
        evidence = f"{self._found[f].how}; the sets M, S1, S2, re-checked against the definition"
        return Reason(Standing.REFUTED, f, statement, threat.counter_theorem, evidence)

    def open(self, f: int) -> Reason:
        threat = self._threat
        kind = "trap" if threat.two_faces else "violation whose malicious nodes stand still"
        scope = "f-local " if threat.local else ""
        known = "Whether the absence of traps suffices for second-order vehicles is open. " if threat.two_faces else ""
        return Reason(
            Standing.OPEN,
            f,
            f"{self._decisions.strength(f, holds=False)}; {self._decisions.scene}there is no {scope}{kind} for f = {f}",
            f"{known}The theorem of this model promises nothing here, and its attack does not exist",
            self._how(f),
        )

    def undecided(self, f: int) -> Reason:
        return Reason(
            Standing.UNDECIDED, f, f"nothing was decided about f = {f}", "none: a limit stopped the work", self._how(f)
        )

    def _how(self, f: int) -> str:
        """Return what decided that there is no attack on f: the search for f itself, or for a greater one."""
        known = [f, *sorted(g for g in self._found if g > f and self._found[g].exists is False)]
        return next((self._found[g].how for g in known if g in self._found), "a limit was reached")


def _nodes(count: int) -> str:
    return f"{count} node" if count == 1 else f"{count} nodes"
