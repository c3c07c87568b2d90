"""What the questions of this package are answered with: frozen, three-valued, with evidence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple

from certificates.graph import Label
from robustness.answers import Answer, Question, Verdict
from robustness.definitions import half_split, largest_conceivable_r, r_reachable_ids
from robustness.digraph import Digraph
from robustness.errors import InternalError, Undecided
from robustness.evidence import Evidence, Pair
from robustness.natural_order import in_natural_order
from robustness.showing import Shown
from robustness.spelled import labels_in_words, robust
from robustness.told import Told

__all__ = ["Bound", "Bounds", "RobustnessResult", "Verdict", "Witness"]


class _Sets(NamedTuple):
    S1: frozenset[Label]
    S2: frozenset[Label]


class Witness(Shown, _Sets):
    """A violating pair: nonempty disjoint node sets for which the definition fails."""

    __slots__ = ()

    @classmethod
    def of(cls, graph: Digraph, pair: Pair) -> Witness:
        """Return a pair of id sets as label sets."""
        return cls(graph.labels_of(pair.first), graph.labels_of(pair.second))

    def summary(self) -> str:
        """Return the two sets in one line."""
        return ", ".join(f"{name} = {text}" for name, text in self.in_words())

    def in_words(self, graph: Digraph | None = None) -> list[tuple[str, str]]:
        """Return the name and the text of each set; with its graph, labels are in quotes only where two look alike."""
        nodes = None if graph is None else graph.labels
        return [("S1", labels_in_words(self.S1, nodes)), ("S2", labels_in_words(self.S2, nodes))]

    def as_dict(self) -> dict[str, Any]:
        """Return the sets as JSON-ready values, in natural order."""
        return {"S1": in_natural_order(self.S1), "S2": in_natural_order(self.S2)}


@dataclass(frozen=True, slots=True, repr=False)
class Bound(Told):
    """One bound on r* (or on s_max(r*)), with the reason it holds and, for an upper bound, its pair if any."""

    value: int
    reason: str
    witness: Witness | None = None

    def summary(self) -> str:
        """Return the value and why it holds."""
        return f"{self.value} ({self.reason})" if self.reason else f"{self.value}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return the pair of an upper bound, as rows of a name and a text."""
        return [] if self.witness is None else self.witness.in_words()

    def as_dict(self) -> dict[str, Any]:
        """Return the bound as JSON-ready values."""
        witness = None if self.witness is None else self.witness.as_dict()
        return {"value": self.value, "reason": self.reason, "witness": witness}


@dataclass(frozen=True, slots=True, repr=False)
class Bounds(Told):
    """What is proven: ``lower.value <= r* <= upper.value``, or the same of s_max(r)."""

    lower: Bound
    upper: Bound

    @classmethod
    def trivial(cls, graph: Digraph) -> Bounds:
        """Return what every graph satisfies, ``0 <= r* <= ceil(n/2)``, with the pair of the upper bound."""
        pair = Witness.of(graph, half_split(graph)) if graph.n >= 2 else None
        return cls(Bound(0, "every graph is 0-robust"), Bound(largest_conceivable_r(graph.n), "r* <= ceil(n/2)", pair))

    @classmethod
    def by_convention(cls, n: int) -> Bounds:
        """Return r* of a graph on n < 2 nodes, which no pair of sets decides: n."""
        settled = Bound(n, "convention for fewer than two nodes")
        return cls(settled, settled)

    def narrowed_by(self, question: Question, answer: Answer, reason: str = "") -> Bounds:
        """Return these bounds on r* after an answer: the only place that says what an answer does to bounds.

        (r,s)-robust gives ``r* >= r``. A violation of (r,s) gives ``r* < r + s - 1``, because (r+s-1)-robust implies
        (r,s)-robust; for s = 1 its pair is the witness. ``reason`` says in words why the new bound holds.
        """
        graph, r, s = question
        if answer.verdict is Verdict.ROBUST and r > self.lower.value:
            return Bounds(Bound(r, reason or robust(r, s)), self.upper)
        if answer.verdict is Verdict.NOT_ROBUST and r + s - 2 < self.upper.value:
            reason = reason or f"violating pair of {robust(r, s)}ness"
            witness = Witness.of(graph, answer.pair) if s == 1 and answer.pair is not None else None
            return Bounds(self.lower, Bound(r + s - 2, reason, witness))
        return self

    def s_narrowed_by(self, question: Question, answer: Answer, reason: str) -> Bounds:
        """Return these bounds on s_max(r) after an answer.

        (r,s)-robust gives ``s_max(r) >= s``. A pair violates (r,s) for every s above its own number of exempt nodes,
        ``|X_S1^r| + |X_S2^r|``, so s_max(r) is at most that.
        """
        graph, r, s = question
        if answer.verdict is Verdict.ROBUST:
            return Bounds(Bound(s, reason), self.upper)
        if answer.verdict is Verdict.NOT_ROBUST:
            if answer.pair is None:
                raise InternalError(f"a violation of ({r},{s})-robustness without a pair: please report")
            exempt = sum(len(r_reachable_ids(graph, side, r)) for side in answer.pair)
            return Bounds(self.lower, Bound(exempt, reason, Witness.of(graph, answer.pair)))
        return self

    def met_with(self, other: Bounds) -> Bounds:
        """Return the tighter bound on either side; of equal upper bounds one that has a pair."""
        lower = max(self.lower, other.lower, key=lambda bound: bound.value)
        upper = min(self.upper, other.upper, key=lambda bound: (bound.value, bound.witness is None))
        return Bounds(lower, upper)

    @property
    def are_equal(self) -> bool:
        """Whether one value is left."""
        return self.lower.value == self.upper.value

    def summary(self) -> str:
        """Return what is proven in one line."""
        if self.are_equal:
            return f"exactly {self.lower.value}"
        return f"at least {self.lower.summary()}, at most {self.upper.summary()}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return why each bound holds, as rows of a name and a text."""
        return [("at least", self.lower.summary()), ("at most", self.upper.summary()), *self.upper.evidence()]

    def as_dict(self) -> dict[str, Any]:
        """Return the bounds as JSON-ready values."""
        return {
            "lower": self.lower.value,
            "upper": self.upper.value,
            "lower_reason": self.lower.reason,
            "upper_reason": self.upper.reason,
        }


@dataclass(frozen=True, slots=True, repr=False)
class RobustnessResult(Shown):
    """The answer to ``check_rs_robustness`` or ``determine_robustness``.

    Attributes
    ----------
    verdict : Verdict
        ``ROBUST``, ``NOT_ROBUST`` or ``UNDECIDED`` for a decision; ``DETERMINED`` or ``UNDECIDED`` for
        ``determine_robustness``. UNDECIDED claims nothing beyond ``bounds``.
    r, s : int
        The question's values; for ``determine_robustness`` the greatest r and then the greatest s that are proven.
    witness : Witness or None
        For NOT_ROBUST the violating pair, already re-checked against the definition. None on fewer than two
        nodes, where no pair exists and a convention decides. For DETERMINED: the pair that refutes (r + 1, 1).
    certificate : bytes or None
        The certificate, when one was asked for.
    bounds : Bounds or None
        What is proven about r*.
    s_bounds : Bounds or None
        What is proven about s_max(r), for ``determine_robustness``.
    profile : mapping or None
        The whole table r -> s_max(r), where ``determine_robustness`` computed it on the way.
    algorithm : str
        The name in ``ALGORITHMS`` that decided, or the bound or rule that made a search unnecessary.
    basis : Evidence or None
        What a decision rests on, as one of the types of :mod:`robustness.evidence`.
    stats : mapping
        Counters of the search: nodes, leaves, solver status, the reason of an UNDECIDED.
    seconds : float
        Wall-clock time.
    graph : Digraph or None
        What the question was about, for :meth:`plot`.
    """

    verdict: Verdict
    r: int
    s: int
    witness: Witness | None = None
    certificate: bytes | None = field(default=None, repr=False)
    bounds: Bounds | None = None
    s_bounds: Bounds | None = None
    profile: Mapping[int, int] | None = field(default=None, compare=False, hash=False)
    algorithm: str = ""
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}), compare=False, hash=False)
    seconds: float = field(default=0.0, compare=False)
    graph: Digraph | None = field(default=None, compare=False)
    basis: Evidence | None = field(default=None, repr=False, compare=False, hash=False)

    @classmethod
    def of(cls, question: Question, answer: Answer, seconds: float = 0.0) -> RobustnessResult:
        """Return what a user is told of an answer."""
        graph, r, s = question
        return cls(
            answer.verdict,
            r,
            s,
            None if answer.pair is None else Witness.of(graph, answer.pair),
            bounds=Bounds.trivial(graph).narrowed_by(question, answer),
            algorithm=answer.decided_by,
            stats=answer.stats,
            seconds=seconds,
            graph=graph,
            basis=answer.evidence,
        )

    def __bool__(self) -> bool:
        raise TypeError(
            "a RobustnessResult has three values, so it has no truth value: compare .verdict, or call is_rs_robust"
        )

    @property
    def s_is_exact(self) -> bool:
        """Whether ``s`` is the greatest s for ``r``, after ``determine_robustness``."""
        if self.verdict is not Verdict.DETERMINED:
            return False
        return self.s_bounds is None or self.s_bounds.lower.value == self.s_bounds.upper.value

    def decided(self) -> bool:
        """Return True for ROBUST and False for NOT_ROBUST; raise :class:`Undecided` otherwise."""
        if self.verdict is Verdict.ROBUST:
            return True
        if self.verdict is Verdict.NOT_ROBUST:
            return False
        raise Undecided(
            f"{robust(self.r, self.s)}ness was not decided ({self.stats.get('reason', 'a limit was reached')}): "
            "raise the time limit or choose another algorithm",
            bounds=self.bounds,
        )

    def summary(self) -> str:
        """Return the verdict in one line of plain words."""
        match self.verdict:
            case Verdict.ROBUST:
                return robust(self.r, self.s)
            case Verdict.NOT_ROBUST:
                return f"not {robust(self.r, self.s)}"
            case Verdict.DETERMINED:
                if self.s_bounds is None or self.s_is_exact:
                    return f"r* = {self.r}, s_max({self.r}) = {self.s}"
                return f"r* = {self.r}, {self.s} <= s_max({self.r}) <= {self.s_bounds.upper.value}"
            case Verdict.UNDECIDED:
                known = f", {self.bounds.lower.value} <= r* <= {self.bounds.upper.value}" if self.bounds else ""
                return f"undecided{known}"

    def evidence(self) -> list[tuple[str, str]]:
        """Return what the answer rests on, as rows of a name and a text."""
        rows = [("algorithm", self.algorithm), ("seconds", f"{self.seconds:.3f}")]
        if self.witness is not None:
            rows += self.witness.in_words(self.graph)
        if self.bounds is not None:
            rows += [("r* at least", self.bounds.lower.summary())]
            rows += [("r* at most", self.bounds.upper.summary())]
        return rows

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values (without the certificate, which is bytes of its own)."""
        return {
            "verdict": self.verdict.value,
            "r": self.r,
            "s": self.s,
            "witness": None if self.witness is None else self.witness.as_dict(),
            "bounds": None if self.bounds is None else self.bounds.as_dict(),
            "s_bounds": None if self.s_bounds is None else self.s_bounds.as_dict(),
            "profile": None if self.profile is None else {str(r): s for r, s in self.profile.items()},
            "algorithm": self.algorithm,
            "seconds": self.seconds,
        }
