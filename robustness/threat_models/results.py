"""What a question about tolerance is answered with, as values and in words: frozen, and never more than is proven."""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certificates.graph import Label
from robustness.digraph import Digraph
from robustness.errors import InvalidParameter
from robustness.showing import Shown
from robustness.spelled import counted, counted_links
from robustness.threat_models.models import THREAT_MODELS, ThreatModel
from robustness.threat_models.parameters import Parameters

if TYPE_CHECKING:
    from robustness.simulation.attacks import Attack
    from robustness.time_varying import TimeVaryingGraph

__all__ = ["AttackSets", "Reason", "Standing", "ToleranceResult", "ToleranceTable", "number", "sentences_of"]


class Standing(enum.Enum):
    """What is known about one f under one threat model."""

    #: A theorem promises agreement.
    GUARANTEED = "guaranteed"
    #: A re-checked attack splits the network for ever.
    REFUTED = "refuted"
    #: A limit stopped the search: more time may tell.
    UNDECIDED = "undecided"
    #: Theory does not decide it from what is given, such as a finite trace: more time does not help.
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class AttackSets:
    """The sets that hold a network apart: see :mod:`robustness.traps.question`.

    ``faces`` 1: M is a subset of S1 and S2 (a violation). ``faces`` 2: M is outside both (a trap). ``remembered``: of a
    network that changes, they hold apart what is remembered at every step, but not the union of all steps.
    """

    f: int
    faces: int
    local: bool
    M: frozenset[Label]
    S1: frozenset[Label]
    S2: frozenset[Label]
    remembered: bool = False

    @property
    def kind(self) -> str:
        """What the sets are, by their faces: ``"violation"`` or ``"trap"``."""
        return "violation" if self.faces == 1 else "trap"


@dataclass(frozen=True, slots=True)
class Reason:
    """One sentence about f, the theorem behind it and the evidence for it.

    Attributes
    ----------
    standing : Standing
    f : int
        The f (for GUARANTEED the largest, for REFUTED the smallest) that the sentence is about.
    statement : str
        What was decided about the graph.
    theorem : str
        What turns that into a sentence about agreement, or why nothing does.
    evidence : str
        What decided it. Certificates: :func:`robustness.threat_models.certify_tolerance`.
    """

    standing: Standing
    f: int
    statement: str
    theorem: str
    evidence: str


@dataclass(frozen=True, slots=True, repr=False)
class ToleranceResult(Shown):
    """What one network survives under one threat model.

    Attributes
    ----------
    threat : ThreatModel
    guaranteed : int
        The largest f for which agreement is promised; -1 when nothing is, not even agreement without adversaries.
    refuted : int or None
        The smallest f for which an attack is known. None: no attack is known (a limit, or fewer than two nodes).
    reasons : tuple of Reason
    attack_sets : AttackSets or None
        The attack on ``refuted``, re-checked against its definition.
    sequence : TimeVaryingGraph or None
        The sequence whose windows the promise is about; ``graph`` is then the union of its steps.
    tau : int or None
        With a sequence: for how many steps after it was sent a value is used.
    delay, gap : int or None
        With a sequence: the bound on delays, and how far updates may lie apart.
    longest_window : int or None
        With a sequence: how many steps the windows may have whose joint robustness promises.
    parameters : Parameters or None
        The vehicles that were asked about: ``parameters.promise_gap(threat)`` says whether the promise applies to them.
    """

    graph: Digraph = field(repr=False)
    threat: ThreatModel
    guaranteed: int
    refuted: int | None
    reasons: tuple[Reason, ...] = field(repr=False)
    attack_sets: AttackSets | None = None
    sequence: TimeVaryingGraph | None = field(default=None, repr=False, compare=False)
    tau: int | None = None
    delay: int | None = None
    gap: int | None = None
    longest_window: int | None = None
    parameters: Parameters | None = None

    def __bool__(self) -> bool:
        raise TypeError("a ToleranceResult has no truth value: compare .guaranteed, .refuted or .standing(f)")

    @property
    def model(self) -> str:
        """The name of the threat model."""
        return self.threat.name

    @property
    def over_time(self) -> bool:
        """Whether the promise is about windows of a sequence."""
        return self.sequence is not None

    def standing(self, f: int) -> Standing:
        """Return what is known about f.

        Raises
        ------
        InvalidParameter
            For a negative f.
        """
        if type(f) is not int or f < 0:
            raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
        if self.graph.n < 2 or f <= self.guaranteed:
            return Standing.GUARANTEED
        if self.refuted is not None and f >= self.refuted:
            return Standing.REFUTED
        is_open = any(reason.f == f and reason.standing is Standing.OPEN for reason in self.reasons)
        return Standing.OPEN if is_open else Standing.UNDECIDED

    def standing_of(self, f: int) -> Standing:
        """Return what is known about f for the parameters that were asked about; OPEN where nothing applies.

        Raises
        ------
        InvalidParameter
            For a negative f.
        """
        standing, given = self.standing(f), self.parameters
        if given is None or self.graph.n < 2:
            return standing
        gaps = {Standing.GUARANTEED: given.promise_gap, Standing.REFUTED: given.attack_gap}
        return Standing.OPEN if standing in gaps and gaps[standing](self.threat) is not None else standing

    @property
    def between(self) -> tuple[int, ...]:
        """The f that are neither guaranteed nor refuted, up to the smallest refuted one; :meth:`standing` says why."""
        return tuple(range(self.guaranteed + 1, self.refuted)) if self.refuted is not None else ()

    @property
    def is_decided(self) -> bool:
        """Whether every f is guaranteed or refuted."""
        return self.graph.n < 2 or (self.refuted is not None and not self.between)

    @property
    def attack(self) -> Attack | None:
        """The attack on ``refuted`` for the simulator; ``attack.run().exact`` is True.

        None when none is known, and for sets that hold apart only what is remembered: those need the delays and update
        times of :func:`robustness.threat_models.confirm`.
        """
        if self.attack_sets is None or self.attack_sets.remembered:
            return None
        from robustness.simulation.attacks import Attack

        sets, delayed = self.attack_sets, self.threat.delayed
        return Attack(sets.kind, self.graph, sets.f, self.threat.faults, sets.M, sets.S1, sets.S2, delayed=delayed)

    def summary(self) -> str:
        """Return the result in plain words, claiming no more than the theorems do."""
        where = self.threat.where
        told = f"{where[0].upper()}{where[1:]}: {_outcome(self)}."
        return " ".join([told, *_scope([self] if self.graph.n >= 2 else [])])

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON-ready values."""
        return {
            "model": self.model,
            "setting": self.threat.setting,
            "guaranteed": self.guaranteed,
            "refuted": self.refuted,
            "undecided": list(self.between),
            "is_decided": self.is_decided,
            "summary": self.summary(),
            "reasons": [
                {
                    "standing": reason.standing.value,
                    "f": reason.f,
                    "statement": reason.statement,
                    "theorem": reason.theorem,
                    "evidence": reason.evidence,
                }
                for reason in self.reasons
            ],
            "attack": None if self.attack is None else self.attack.as_dict(),
            "parameters": None if self.parameters is None else self.parameters.as_dict(self.threat),
        }

    def evidence(self) -> list[tuple[str, str]]:
        """Return the reasons, as rows of a name and a text."""
        return [
            (f"{reason.standing.value} f = {reason.f}", f"{reason.statement} ({reason.theorem})")
            for reason in self.reasons
        ]


@dataclass(frozen=True, slots=True, repr=False)
class ToleranceTable(Shown, Mapping[str, ToleranceResult]):
    """The results of several threat models by name."""

    graph: Digraph
    results: tuple[ToleranceResult, ...]

    def __getitem__(self, model: str) -> ToleranceResult:
        for result in self.results:
            if result.model == model:
                return result
        raise KeyError(model)

    def __iter__(self) -> Iterator[str]:
        return (result.model for result in self.results)

    def __len__(self) -> int:
        return len(self.results)

    @property
    def guaranteed(self) -> dict[str, int]:
        """The largest f promised, by model."""
        return {result.model: result.guaranteed for result in self.results}

    @property
    def refuted(self) -> dict[str, int | None]:
        """The smallest f with an attack, by model."""
        return {result.model: result.refuted for result in self.results}

    @property
    def reasons(self) -> dict[str, tuple[Reason, ...]]:
        """The reasons, by model."""
        return {result.model: result.reasons for result in self.results}

    @property
    def is_decided(self) -> bool:
        """Whether no limit is to blame for anything that is not known."""
        return all(result.is_decided for result in self.results)

    def summary(self) -> str:
        """Return the table in one paragraph of plain words."""
        graph = self.graph
        size = f"A network of {counted(graph.n, 'node')} and {counted_links(graph.arc_count, graph.directed)}."
        return " ".join([size, *sentences_of(self)])

    def evidence(self) -> list[tuple[str, str]]:
        """Return the table, as rows of a model and what is known."""
        return [
            (result.model, f"guaranteed f = {largest_survived(result)}, refuted f = {number(result.refuted)}")
            for result in self.results
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the table as JSON-ready values, by model."""
        return {result.model: result.as_dict() for result in self.results}


def number(f: int | None) -> str:
    """Return an f as people write it: ``none`` for -1 and None."""
    return "none" if f is None or f < 0 else str(f)


def largest_survived(result: ToleranceResult) -> str:
    """Return the largest f guaranteed as people write it: ``any`` where nobody can disagree."""
    return "any" if result.graph.n < 2 else number(result.guaranteed)


def _outcome(result: ToleranceResult) -> str:
    """Return what is known under one model, without saying which."""
    if result.graph.n < 2:
        return "fewer than two nodes cannot disagree"
    parts = [_promised(result), _refuted(result)]
    standings = {f: result.standing(f).value for f in result.between}
    late = [str(f) for f, standing in standings.items() if standing == "undecided"]
    unsaid = [str(f) for f, standing in standings.items() if standing == "open"]
    if late:
        parts.append(f"f = {', '.join(late)} {'was' if len(late) == 1 else 'were'} not decided within the limit")
    if unsaid:
        why = next(reason.evidence for reason in result.reasons if reason.standing.value == "open")
        parts.append(f"f = {', '.join(unsaid)} {'is' if len(unsaid) == 1 else 'are'} open: {why}")
    return "; ".join(part for part in parts if part)


def sentences_of(table: ToleranceTable) -> list[str]:
    """Return a sentence for each outcome, which models with one and the same share, and what the promises rest on."""
    if table.graph.n < 2:
        return ["Fewer than two nodes cannot disagree, whatever the threat."]
    sentences: dict[str, list[str]] = {}
    for result in table.results:
        sentences.setdefault(_outcome(result), []).append(result.threat.where)
    told = [f"{'; and '.join(where)}: {outcome}." for outcome, where in sentences.items()]
    if len(sentences) == 1 and len(table) == len(THREAT_MODELS):
        told = [f"under every threat model: {next(iter(sentences))}."]
    return [*(sentence[0].upper() + sentence[1:] for sentence in told), *_scope(table.results)]


def _scope(results: Sequence[ToleranceResult]) -> Iterator[str]:
    """Yield what the promises rest on."""
    given = results[0].parameters if results else None
    if given is not None:
        yield f"For {given.told([result.threat for result in results])}."
    elif any(result.guaranteed >= 0 for result in results):
        yield "What is guaranteed holds for the update rules, weights and gains that its theorem names."
    sequence = results[0].sequence if results else None
    if sequence is not None and sequence.period is None:
        yield "A finite trace is taken to go on as it was: no new link, and every window as good as those seen."


def _promised(result: ToleranceResult) -> str:
    f = result.guaranteed
    if f < 0:
        if result.refuted == 0:
            return ""
        is_open = result.standing(0).value == "open"
        return "nothing is guaranteed" if is_open else "nothing is guaranteed within the limit"
    if f == 0:
        return "agreement is guaranteed only while nobody lies (f = 0)"
    return f"agreement is guaranteed for f = {f}" + (" and below" if f > 1 else "")


def _refuted(result: ToleranceResult) -> str:
    f, sets = result.refuted, result.attack_sets
    if f is None or sets is None:
        return "no attack is known within the limit"
    if f == 0:
        return "agreement fails even though nobody lies: two groups hear nothing from outside"
    if not sets.M:
        return f"for f = {f} it stays split for ever without a single liar, since everybody discards too much"
    return f"for f = {f} an attack by {len(sets.M)} {'liar' if len(sets.M) == 1 else 'liars'} keeps it split for ever"
