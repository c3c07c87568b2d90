"""A question about (r,s)-robustness, and an answer that carries its evidence.

Everything that decides, be it a convention, a bound or a search, takes a :class:`Question` and returns an
:class:`Answer`. The verdict follows from the evidence, so an answer cannot claim more than it shows.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple

from robustness.definitions import is_violation, require_r_and_s
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InternalError
from robustness.evidence import Convention, Evidence, LimitReached, Pair, Refutation, ViolatingPair
from robustness.limits import Limits

__all__ = ["Answer", "Question", "Rung", "Verdict", "answers_in_turn"]


class Verdict(enum.Enum):
    """The answer to a question about robustness."""

    ROBUST = "robust"
    NOT_ROBUST = "not-robust"
    UNDECIDED = "undecided"
    #: r* is known exactly; ``s_bounds`` tells how exactly s_max(r*) is.
    DETERMINED = "determined"


class Question(NamedTuple):
    """Is the graph (r,s)-robust? With r >= 0 and 1 <= s <= max(n, 1)."""

    graph: Digraph
    r: int
    s: int

    @classmethod
    def about(cls, G: GraphLike, r: int, s: int) -> Question:
        """Return the question in valid form: the one place where graph, r and s are looked at.

        Raises
        ------
        InvalidGraph, InvalidParameter
            For what the definition does not speak about.
        """
        graph = as_digraph(G)
        require_r_and_s(graph, r, s)
        return cls(graph, r, s)


@dataclass(frozen=True, slots=True)
class Answer:
    """A verdict with its evidence.

    Attributes
    ----------
    evidence : Evidence
        What the answer rests on.
    stats : mapping
        Counters of the search, the rule in words, the reason of an UNDECIDED.
    decided_by : str
        The name in ``ALGORITHMS`` that decided, ``"bounds"`` or ``"definition"``.
    """

    evidence: Evidence
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    decided_by: str = ""

    @classmethod
    def violated_by(cls, pair: Pair, stats: Mapping[str, Any] = MappingProxyType({})) -> Answer:
        """Return the answer NOT_ROBUST, with the pair that shows it."""
        return cls(ViolatingPair(pair), stats)

    @classmethod
    def undecided(cls, reason: str, stats: Mapping[str, Any] = MappingProxyType({})) -> Answer:
        """Return UNDECIDED, with its reason among the stats."""
        return cls(LimitReached(reason), {**stats, "reason": reason})

    @property
    def verdict(self) -> Verdict:
        """What the evidence shows."""
        match self.evidence:
            case LimitReached():
                return Verdict.UNDECIDED
            case ViolatingPair() | Convention(holds=False):
                return Verdict.NOT_ROBUST
        return Verdict.ROBUST

    @property
    def pair(self) -> Pair | None:
        """The violating pair of a NOT_ROBUST, None where a convention decided."""
        return self.evidence.pair if isinstance(self.evidence, ViolatingPair) else None

    @property
    def transcript(self) -> bytes | None:
        """The transcript of a refutation that was recorded, whole."""
        return bytes(self.evidence.transcript) if isinstance(self.evidence, Refutation) else None

    def rechecked(self, question: Question) -> Answer:
        """Return the answer after its pair was checked against the definition; a wrong pair is an InternalError."""
        graph, r, s = question
        if self.pair is not None and not is_violation(graph, *self.pair, r, s):
            raise InternalError(f"{self.decided_by} returned {self.pair}, no violation of ({r},{s}): please report")
        return self


#: A step of the ladder: it settles the question, or returns None and leaves it to the next one.
Rung = Callable[[Question, Limits], Answer | None]


def answers_in_turn(rungs: Iterable[Rung], question: Question, limits: Limits) -> Iterator[Answer]:
    """Yield the answers of a ladder from its lowest rung up, each re-checked.

    The first one settles the question; whoever needs evidence of a certain kind takes the first that has it.
    """
    for rung in rungs:
        answer = rung(question, limits)
        if answer is not None:
            yield answer.rechecked(question)
