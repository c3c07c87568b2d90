"""What the questions about time-varying graphs are answered with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, overload

from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.evidence import Growth
from robustness.results import Verdict, Witness
from robustness.showing import Shown
from robustness.spelled import counted, robust
from robustness.time_varying.sequence import TimeVaryingGraph

__all__ = ["JointResult", "UnionVerdict", "Unions", "Violation"]


@dataclass(frozen=True, slots=True)
class Violation:
    """A window whose union is not (r,s)-robust, with the pair that shows it, re-checked against the definition.

    Attributes
    ----------
    start, length : int
        The window is ``start, ..., start + length - 1``.
    witness : Witness or None
        The violating pair (S1, S2) of the union; None on fewer than two nodes, where a convention decides.
    """

    start: int
    length: int
    witness: Witness | None


@dataclass(frozen=True, slots=True)
class UnionVerdict:
    """The verdict on one union and why.

    Attributes
    ----------
    verdict : Verdict
        ROBUST, NOT_ROBUST or UNDECIDED.
    rule : str
        ``"exact"``: decided by :func:`~robustness.decision.front.check_rs_robustness`. ``"pair"``: a pair found in an
        earlier window violates this union too. ``"growth"``: a seed and an order (see ``growth``).
        ``"subgraph"``: it contains arcs that were proven to be enough. ``"shorter-window"``: a shorter window
        with the same start is already robust, and robustness is kept when arcs are added.
    witness : Witness or None
        For NOT_ROBUST the violating pair.
    growth : Growth or None
        For ROBUST by growth: valid for this very union, in ids of its Digraph. None too when the seed is proven by a
        search that no growth certificate can carry.
    algorithm : str
        For ``"exact"``: what decided.
    reason : str
        For UNDECIDED: the limit that was reached.
    """

    verdict: Verdict
    rule: str
    witness: Witness | None = None
    growth: Growth | None = None
    algorithm: str = ""
    reason: str = ""


class Unions(Sequence[Digraph]):
    """Distinct window unions as Digraphs, each made when it is asked for: thousands may be large."""

    def __init__(self, sequence: TimeVaryingGraph, starts: Sequence[int], length: int) -> None:
        self._sequence, self._starts, self._length = sequence, tuple(starts), length

    @property
    def sequence(self) -> TimeVaryingGraph:
        """The sequence whose windows these are."""
        return self._sequence

    def __len__(self) -> int:
        return len(self._starts)

    @overload
    def __getitem__(self, index: int) -> Digraph: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Digraph]: ...

    def __getitem__(self, index: int | slice) -> Digraph | Sequence[Digraph]:
        if isinstance(index, slice):
            return Unions(self._sequence, self._starts[index], self._length)
        return self._sequence.union(self._starts[index], self._length)


@dataclass(frozen=True, slots=True, repr=False)
class JointResult(Shown):
    """The answer to :func:`~robustness.time_varying.check_joint_robustness`.

    Attributes
    ----------
    verdict : Verdict
        ROBUST, NOT_ROBUST or UNDECIDED.
    r, s : int
        The question's values.
    asked_window : int or None
        The window length asked about; None when the smallest was asked for.
    window : int or None
        ROBUST: the window length for which it holds, the smallest when that was asked for. Otherwise None.
    violation : Violation or None
        NOT_ROBUST: the first window that fails. When the smallest length was asked for, a window that shows that
        none will do: the whole trace, or one whole period. None when no window of the asked length fits the trace.
    shorter_fails : Violation or None
        When the smallest length was asked for and it is above 1: a window one step shorter that fails.
    at_least : int
        What is proven about the smallest window length even when UNDECIDED: no shorter one holds.
    tau : int or None
        The delay bound asked about.
    within_tau : bool or None
        Whether ``window <= tau``, as the corollary on time-varying graphs demands; False when NOT_ROBUST; None when
        no ``tau`` was given or the verdict is UNDECIDED.
    examined : int
        The window length that ``unions`` and ``window_unions`` speak about.
    unions : sequence of Digraph
        The distinct unions of the windows that were decided, in order of first appearance.
    union_verdicts : tuple of UnionVerdict
        The verdict on each of ``unions``, with its evidence.
    window_unions : tuple of int
        For the windows from start 0 on, the index of each one's union. Complete when ROBUST; it ends at the first
        violating window when NOT_ROBUST, unless all windows were asked for.
    reason : str
        One sentence for a verdict that has no pair, or the limit that was reached.
    stats : mapping
        Counters: windows decided, exact searches made, and how many windows each rule settled.
    seconds : float
        Wall-clock time.
    """

    verdict: Verdict
    r: int
    s: int
    asked_window: int | None = None
    window: int | None = None
    violation: Violation | None = None
    shorter_fails: Violation | None = None
    at_least: int = 1
    tau: int | None = None
    within_tau: bool | None = None
    examined: int = 0
    unions: Sequence[Digraph] = field(default=(), repr=False, compare=False)
    union_verdicts: tuple[UnionVerdict, ...] = field(default=(), repr=False, compare=False)
    window_unions: tuple[int, ...] = field(default=(), repr=False)
    reason: str = ""
    stats: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}), compare=False, hash=False)
    seconds: float = field(default=0.0, compare=False)

    def __bool__(self) -> bool:
        raise TypeError(
            "a JointResult has three values, so it has no truth value: compare .verdict, or call .decided()"
        )

    def decided(self) -> bool:
        """Return True for ROBUST and False for NOT_ROBUST; raise :class:`Undecided` otherwise."""
        if self.verdict is Verdict.UNDECIDED:
            raise Undecided(f"joint {robust(self.r, self.s)}ness was not decided ({self.reason}): raise the limit")
        return self.verdict is Verdict.ROBUST

    def failing_starts(self) -> tuple[int, ...]:
        """Return the starts of the decided windows that fail."""
        verdicts = self.union_verdicts
        return tuple(k for k, u in enumerate(self.window_unions) if verdicts[u].verdict is Verdict.NOT_ROBUST)

    def summary(self) -> str:
        """Return the verdict in one line of plain words."""
        what = robust(self.r, self.s)
        if self.verdict is Verdict.UNDECIDED:
            known = f"; no window shorter than {self.at_least} will do" if self.at_least > 1 else ""
            return f"undecided: whether jointly {what}{known}"
        if self.verdict is Verdict.NOT_ROBUST:
            return f"not jointly {what}" + (f" over {counted(self.asked_window, 'step')}" if self.asked_window else "")
        kind = "every" if self.asked_window else "smallest window: every"
        steps = "single step" if self.window == 1 else counted(self.window or 0, "consecutive step")
        return f"jointly {what}; {kind} {steps}"

    def pictured(self) -> Digraph | None:
        """Return the union of the window that fails, or else of the first one that was decided."""
        if not isinstance(self.unions, Unions):
            return self.unions[0] if self.unions else None
        found = self.violation or self.shorter_fails
        if found is not None:
            return self.unions.sequence.union(found.start, found.length)
        return self.unions[0] if len(self.unions) else None

    def evidence(self) -> list[tuple[str, str]]:
        """Return what is known, as rows of a name and a text."""
        rows = [("seconds", f"{self.seconds:.3f}")]
        if self.reason:
            rows.append(("reason", self.reason))
        if self.within_tau is not None:
            rows.append((f"window at most tau = {self.tau}", "yes" if self.within_tau else "no"))
        for name, found in (("violating window", self.violation), ("one step shorter fails", self.shorter_fails)):
            if found is not None:
                rows.append((name, f"{counted(found.length, 'step')} from step {found.start}"))
                rows += [] if found.witness is None else found.witness.in_words(self.pictured())
        return rows

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values."""
        return {
            "verdict": self.verdict.value,
            "r": self.r,
            "s": self.s,
            "asked_window": self.asked_window,
            "window": self.window,
            "at_least": self.at_least,
            "tau": self.tau,
            "within_tau": self.within_tau,
            "violation": _as_dict(self.violation),
            "shorter_fails": _as_dict(self.shorter_fails),
            "reason": self.reason,
            "seconds": self.seconds,
        }


def _as_dict(found: Violation | None) -> dict[str, Any] | None:
    if found is None:
        return None
    witness = None if found.witness is None else found.witness.as_dict()
    return {"start": found.start, "length": found.length, "witness": witness}
