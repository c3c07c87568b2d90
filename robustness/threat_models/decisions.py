"""The question behind every threat model, asked once and remembered: is there an attack of this kind on f?"""

from __future__ import annotations

from dataclasses import dataclass, field

from robustness.answers import Answer
from robustness.answers import Question as RobustnessQuestion
from robustness.decision.front import check_within
from robustness.decision.ladder import settle_quickly
from robustness.definitions import r_reachable_ids
from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.results import RobustnessResult, Verdict
from robustness.spelled import counted
from robustness.traps.ladder import decide_trap
from robustness.traps.question import Question, Sets, solves
from robustness.traps.shortcuts import settle_trap

__all__ = ["Decisions", "Finding", "certain_attack"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Whether an attack of a kind exists (None: not known), its sets, and what decided it.

    ``is_open``: what is given does not determine it, so more time would not help.
    """

    exists: bool | None
    sets: Sets | None
    how: str
    is_open: bool = False


def certain_attack(n: int, two_faces: bool) -> int:
    """Return an f for which every graph on n >= 2 nodes has an attack: ceil(n/2) with one face, ceil(n/3) with two."""
    return -(-n // (3 if two_faces else 2))


@dataclass(slots=True)
class Decisions:
    """What has been decided about one graph. All methods are exact or say that a limit stopped them."""

    graph: Digraph
    limits: Limits
    _robust: dict[tuple[int, int], RobustnessResult] = field(default_factory=dict)
    _attacks: dict[Question, Finding] = field(default_factory=dict)
    _settled: dict[tuple[int, int], Answer | None] = field(default_factory=dict)

    def robust(self, r: int, s: int = 1, share: float = 1.0) -> RobustnessResult:
        """Return the result of :func:`check_rs_robustness`, from memory where it is known."""
        known = self._robust.get((r, s))
        if known is None:
            known = self._robust[r, s] = check_within(self.graph, r, s, self.limits.share(share))
        return known

    def attack(self, question: Question, share: float = 1.0) -> Finding:
        """Return whether an attack of this kind exists, by what is known already or by search."""
        known = self._attacks.get(question)
        if known is None or known.exists is None:
            known = self._attacks[question] = self._implied(question) or self._search(question, share)
        return known

    def quick_attack(self, question: Question) -> Finding | None:
        """Return what lemmas alone tell about the question, or None."""
        known = self._attacks.get(question) or self._implied(question)
        if known is None:
            settled = settle_trap(self.graph, question, self.limits.share(0.1), self._settle)
            if settled is not None:
                known = Finding(settled.exists, settled.sets, str(settled.stats["rule"]))
        if known is not None and known.exists is not None:
            self._attacks[question] = known
            return known
        return None

    def statement(self, f: int, question: Question) -> str:
        """Return in words what is known about the network when there is no attack of this kind on f."""
        if f == 0:
            return "the network is 1-robust"
        if not question.two_faces:
            kind = "there is no local violation" if question.local else f"the network is ({f + 1},{f + 1})-robust"
            return f"{kind} for f = {f}" if question.local else kind
        removed = "any f-local set of nodes" if question.local else f"any {counted(f, 'node')}"
        trap = "local trap" if question.local else "trap"
        return f"without {removed} the network is still {f + 1}-robust: there is no {trap} for f = {f}"

    @property
    def scene(self) -> str:
        """Where traps are looked for, as the beginning of a sentence."""
        return ""

    def _settle(self, question: RobustnessQuestion, limits: Limits) -> Answer | None:
        """Return what is settled at little cost; every threat model asks for the same few r and s."""
        asked = question.r, question.s
        if asked not in self._settled:
            answer = settle_quickly(question, limits)
            if limits.expired() or (answer is not None and answer.verdict is Verdict.UNDECIDED):
                return answer  # with more time there may be a better one
            self._settled[asked] = answer
        return self._settled[asked]

    def _implied(self, question: Question) -> Finding | None:
        """Derive the answer from others: see the lemmas in :mod:`robustness.traps.question`."""
        f, two_faces, local = question
        for other, found in self._attacks.items():
            if found.sets is not None and other.f <= f and other.two_faces <= two_faces and other.local <= local:
                sets = found.sets
                if two_faces and not other.two_faces:
                    sets = Sets(sets.M, sets.S1 - sets.M, sets.S2 - sets.M)
                if solves(self.graph, question, sets):
                    return Finding(True, sets, found.how)
            if found.exists is False and other.f >= f and other.two_faces >= two_faces and other.local >= local:
                return Finding(False, None, found.how)
        twice = self._robust.get((2 * f + 1, 1))
        if twice is not None and twice.verdict is Verdict.ROBUST:
            return Finding(False, None, f"{2 * f + 1}-robust, so there is none")
        return None

    def _search(self, question: Question, share: float) -> Finding:
        f, two_faces, local = question
        if f == 0 or not (two_faces or local):
            # For f = 0 all kinds are one: nodes of S_k hear neither a malicious node nor anybody else outside S_k.
            return self._violation(f, share)
        limits = self.limits.share(share)
        answer = decide_trap(self.graph, question, limits, settle=self._settle)
        exists, sets, name, stats = answer.exists, answer.sets, answer.decided_by, answer.stats
        how = str(stats.get("rule", "")) or f"complete search ({counted(stats.get('nodes', 0), 'node')})"
        if exists is None:
            how = str(stats.get("reason", "a limit was reached"))
        return Finding(exists, sets, how if name == "lemma" or exists is not True else "found by search")

    def _violation(self, f: int, share: float) -> Finding:
        """One face in total is (f+1,f+1)-robustness: the pair's reachable nodes are malicious."""
        graph = self.graph
        if graph.n < 2:
            return Finding(False, None, "fewer than two nodes: nobody to hold apart")
        result = self.robust(f + 1, min(f + 1, graph.n), share)
        if result.verdict is Verdict.UNDECIDED:
            return Finding(None, None, str(result.stats.get("reason", "a limit was reached")))
        if result.witness is None:
            return Finding(False, None, f"({f + 1},{f + 1})-robust, decided by {result.algorithm}")
        S1, S2 = graph.ids(result.witness.S1), graph.ids(result.witness.S2)
        bad = r_reachable_ids(graph, S1, f + 1) | r_reachable_ids(graph, S2, f + 1)
        return Finding(True, Sets(bad, S1, S2), f"violating pair of ({f + 1},{f + 1})-robustness ({result.algorithm})")
