"""What a question about traps is answered with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from certificates.graph import Label
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.natural_order import in_natural_order
from robustness.showing import Shown
from robustness.spelled import labels_in_words

__all__ = ["TrapResult"]


@dataclass(frozen=True, slots=True, repr=False)
class TrapResult(Shown):
    """Whether the sets exist, and the sets.

    Attributes
    ----------
    exists : bool or None
        None when a limit stopped the search; nothing is claimed then.
    f, faces, local
        The question.
    M, S1, S2 : frozensets of labels
        When they exist, re-checked against the definition; empty otherwise.
    algorithm : str
        What decided: a name in ``TRAP_ALGORITHMS``, or ``"lemma"``.
    stats : mapping
        Counters, the lemma, or the reason why nothing is claimed.
    seconds : float
    graph : Digraph or None
        What the question was about, for :meth:`plot`.
    """

    exists: bool | None
    f: int
    faces: int
    local: bool
    M: frozenset[Label] = frozenset()
    S1: frozenset[Label] = frozenset()
    S2: frozenset[Label] = frozenset()
    algorithm: str = ""
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}), compare=False, hash=False)
    seconds: float = field(default=0.0, compare=False)
    graph: Digraph | None = field(default=None, compare=False)

    def __bool__(self) -> bool:
        raise TypeError("a TrapResult has three values, so it has no truth value: compare .exists, or call decided()")

    def summary(self) -> str:
        """Return the answer in one line."""
        kind = "trap" if self.faces == 2 else "violation"
        bound = f"{'local ' if self.local else ''}{kind} for f = {self.f}"
        if self.exists is None:
            return f"undecided: whether there is a {bound}"
        if not self.exists:
            return f"no {bound}"
        return f"{bound}: " + ", ".join(f"{name} = {text}" for name, text in self._sets())

    def evidence(self) -> list[tuple[str, str]]:
        """Return what the answer rests on, as rows of a name and a text."""
        return [*(self._sets() if self.exists else ()), ("algorithm", self.algorithm)]

    def _sets(self) -> list[tuple[str, str]]:
        nodes = None if self.graph is None else self.graph.labels
        sets = (("M", self.M), ("S1", self.S1), ("S2", self.S2))
        return [(name, labels_in_words(labels, nodes)) for name, labels in sets]

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values."""
        sets = {"M": self.M, "S1": self.S1, "S2": self.S2}
        return {
            "exists": self.exists,
            "f": self.f,
            "faces": self.faces,
            "local": self.local,
            "sets": {name: in_natural_order(labels) for name, labels in sets.items()} if self.exists else None,
            "algorithm": self.algorithm,
            "seconds": self.seconds,
        }

    def decided(self) -> bool:
        """Return whether the sets exist; raise :class:`Undecided` when a limit stopped the search."""
        if self.exists is None:
            raise Undecided(f"whether a trap for f = {self.f} exists was not decided: raise the time limit")
        return self.exists
