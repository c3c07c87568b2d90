"""Joint (r,s)-robustness of time-varying graphs, exactly.

``G[k]`` is *jointly (r,s)-robust over l steps* when there are windows of l steps at all
(:meth:`TimeVaryingGraph.window_starts`) and the union ``G[k], ..., G[k + l - 1]`` of every one is (r,s)-robust. It is
*jointly (r,s)-robust* when it is so for some fixed l (Definition 6 of the source paper, which has r instead of (r,s)).

Monotone in l, theorem: if it holds over l steps it holds over l + 1 steps, unless the sequence is a finite trace of
l steps. Proof: adding arcs enlarges every ``X_S^r``, so a graph that contains the arcs of an (r,s)-robust graph on
the same nodes is (r,s)-robust. A window of l + 1 steps contains the window of l steps with the same start. In a
periodic or eventually periodic sequence that window always exists; in a finite trace of T >= l + 1 steps the
starts ``0 .. T - l - 1`` of the longer windows are among the starts ``0 .. T - l`` of the shorter. For T = l no
window of l + 1 steps exists, and what is not seen is not claimed.

Hence one sweep finds the smallest l: try l = 1 from start 0; while the window fails, l grows by one step; when it
is robust, go to the next start with the same l. No start is ever looked at again.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from robustness.decision.algorithms import require_algorithm
from robustness.definitions import is_violation, largest_conceivable_r, require_r_and_s
from robustness.digraph import GraphLike
from robustness.errors import InternalError, InvalidParameter
from robustness.limits import Limits, Progress
from robustness.results import Verdict
from robustness.spelled import counted
from robustness.time_varying.results import JointResult, Unions, UnionVerdict, Violation
from robustness.time_varying.sequence import SlidingUnion, TimeVaryingGraph, as_time_varying
from robustness.time_varying.unions import RULES, TIME_IS_UP, UnionDecider
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["check_joint_robustness", "joint_curve"]

_PROGRESS_SECONDS = 0.2

#: Of results that are told before the end.
_GOES_ON = "the search goes on"
_NOT_ALL = "not all windows after it were decided"


@taking_numpy_integers
def check_joint_robustness(
    sequence: TimeVaryingGraph | Sequence[GraphLike],
    r: int,
    s: int = 1,
    *,
    window: int | None = None,
    tau: int | None = None,
    all_windows: bool = False,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    reuse: Collection[str] = RULES,
    progress: Callable[[Progress], None] | None = None,
    on_result: Callable[[JointResult], None] | None = None,
) -> JointResult:
    """Decide whether a time-varying graph is jointly (r,s)-robust, over a given or the smallest number of steps.

    Parameters
    ----------
    sequence : TimeVaryingGraph, or list of graphs
        A list is a finite trace: its windows do not wrap, and nothing is claimed beyond its last step.
    r, s : int
        As for :func:`~robustness.decision.front.check_rs_robustness`.
    window : int, optional
        The length l of the windows, at least 1. None: find the smallest l for which it holds.
    tau : int, optional
        The delay bound: the result then also says whether ``l <= tau``, which Corollary 2 of the
        source paper assumes.
    all_windows : bool
        With ``window``: go on after the first window that fails, so that every window has its verdict.
    algorithm : str
        For the unions that need an exact search.
    time_limit : float, optional
        Wall-clock seconds for everything; past it the verdict is UNDECIDED.
    jobs, seed : int
        Threads and random choices of the exact search, as for :func:`~robustness.decision.front.check_rs_robustness`.
    reuse : collection of str
        Which of the shortcuts ``"equal"``, ``"pair"``, ``"subgraph"``, ``"growth"``, ``"ahead"`` to use: all, unless
        one wants to measure what they save. The verdict does not depend on it.
    progress : callable, optional
        Called now and then with a :class:`~robustness.limits.Progress`.
    on_result : callable, optional
        Called whenever more is proven before the end: with an UNDECIDED result whose ``at_least`` has grown, or with
        the first window that fails while the others are still being decided.

    Returns
    -------
    JointResult
        ROBUST with ``window``; NOT_ROBUST with ``violation``, the first window that fails (the first found to, when
        ``reason`` says that an earlier one was not decided) and its re-checked pair (for the smallest length: the
        whole trace or one period, which shows that no length will do); or UNDECIDED.
        A window longer than a finite trace is NOT_ROBUST without a pair: up to the horizon there is no such window.

    Raises
    ------
    InvalidGraph, InvalidParameter
        For input the definition does not speak about.

    See Also
    --------
    robustness.joint_curve : the fewest steps for every r
    robustness.certify_joint : the same, with evidence
    robustness.check_rs_robustness : one network

    Notes
    -----
    At most ``steps + l`` unions are decided to find the smallest l, ``steps`` for a given one; most of them without a
    search (:mod:`robustness.time_varying.unions`). Deciding one union is coNP-complete in general.

    References
    ----------
    The source paper, Definition 6 and Corollary 2 (which assumes ``l <= tau``).

    >>> import networkx as nx
    >>> links = TimeVaryingGraph.from_arcs(range(3), [[(0, 1)], [(1, 2)], [(2, 0)]], period=3, directed=False)
    >>> check_joint_robustness(links, 1).window, check_joint_robustness(links, 2).window
    (2, 3)
    """
    started = time.monotonic()
    sequence = as_time_varying(sequence)
    require_r_and_s(sequence.graph_at(0), r, s)
    require_algorithm(algorithm)
    _require_window(window, tau, reuse)
    limits = Limits.of(time_limit, jobs, seed, progress)

    def tell(known: JointResult) -> None:
        if on_result is not None:
            on_result(replace(known, seconds=time.monotonic() - started))

    found = _check(sequence, r, s, limits, window, tau, all_windows, algorithm, frozenset(reuse), tell)
    return replace(found, seconds=time.monotonic() - started)


def check_joint_within(sequence: TimeVaryingGraph, r: int, s: int, *, tau: int, limits: Limits) -> JointResult:
    """Do what :func:`check_joint_robustness` does for a question that is known to be valid, within ``limits``."""
    return _check(sequence, r, s, limits, None, tau, False, "auto", RULES)


def _check(
    sequence: TimeVaryingGraph,
    r: int,
    s: int,
    limits: Limits,
    window: int | None,
    tau: int | None,
    all_windows: bool,
    algorithm: str,
    reuse: frozenset[str],
    tell: Callable[[JointResult], None] = lambda known: None,
) -> JointResult:
    decider = UnionDecider(sequence, r, s, algorithm, limits, reuse)

    def whole(result: JointResult) -> JointResult:
        counts = {"windows": decider.settled.total(), "searches": decider.searches}
        stats = MappingProxyType({**counts, **dict(sorted(decider.settled.items()))})
        return replace(result, asked_window=window, tau=tau, within_tau=_within(result, tau), stats=stats)

    survey = _Survey(sequence, decider, limits.progress, lambda known: tell(whole(known)))
    return whole(survey.smallest() if window is None else survey.given(window, all_windows))


@taking_numpy_integers
def joint_curve(
    sequence: TimeVaryingGraph | Sequence[GraphLike],
    s: int = 1,
    *,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    on_curve: Callable[[Mapping[int, int | None]], None] | None = None,
) -> Mapping[int, int | None]:
    """Return for r = 1 .. ceil(n/2) the smallest l for which the sequence is jointly (r,s)-robust, or None.

    Takes the parameters of :func:`check_joint_robustness`; raises :class:`Undecided` when a limit stopped it.
    ``on_curve`` is called with what is known of the curve after every r.
    (r,s)-robust graphs are (r-1,s)-robust, so the values grow with r, and each search starts where the last ended.

    See Also
    --------
    robustness.check_joint_robustness : one r

    >>> links = TimeVaryingGraph.from_arcs(range(3), [[(0, 1)], [(1, 2)], [(2, 0)]], period=3, directed=False)
    >>> dict(joint_curve(links))
    {1: 2, 2: 3}
    """
    sequence = as_time_varying(sequence)
    require_r_and_s(sequence.graph_at(0), 0, s)
    require_algorithm(algorithm)
    limits = Limits.of(time_limit, jobs, seed, progress)
    curve: dict[int, int | None] = {}
    smallest: int | None = 1
    for r in range(1, largest_conceivable_r(sequence.n) + 1):
        if smallest is not None:
            decider = UnionDecider(sequence, r, s, algorithm, limits)
            result = _Survey(sequence, decider, progress).smallest(smallest, map_windows=False)
            smallest = result.window if result.decided() else None
        curve[r] = smallest
        if on_curve is not None:
            on_curve(MappingProxyType(dict(curve)))
    return MappingProxyType(curve)


class _Survey:
    """One pass over the windows of a sequence: which union each start has, and the verdict on it."""

    def __init__(
        self,
        sequence: TimeVaryingGraph,
        decider: UnionDecider,
        progress: Callable[[Progress], None] | None,
        tell: Callable[[JointResult], None] = lambda known: None,
    ) -> None:
        self._sequence, self._decider, self._progress, self._tell = sequence, decider, progress, tell
        self._window = SlidingUnion(sequence)
        self._told = time.monotonic()

    def given(self, length: int, all_windows: bool) -> JointResult:
        """Decide the windows of ``length`` steps, up to the first that fails unless all are wanted."""
        starts = self._sequence.window_starts(length)
        if not starts:
            reason = f"no window of {counted(length, 'step')} fits in a trace of {counted(len(self._sequence), 'step')}"
            return self._result(Verdict.NOT_ROBUST, examined=length, reason=reason)
        chart = _Chart()
        violation, undecided, unsure = None, "", ""
        for start in starts:
            if self._decider.expired():
                undecided = TIME_IS_UP
                break
            key, union = self._decide(start, length)
            chart.add(start, key, union)
            if union.verdict is Verdict.NOT_ROBUST and violation is None:
                violation = self._violation(start, length, union)
                unsure = undecided and f"a window before it was not decided ({undecided})"
                if not all_windows:
                    break
                known = {"reason": unsure or _NOT_ALL, **chart.fields(self._sequence, length)}
                self._tell(self._result(Verdict.NOT_ROBUST, violation=violation, **known))
            elif union.verdict is Verdict.UNDECIDED:
                undecided = undecided or union.reason
        fields = chart.fields(self._sequence, length)
        if violation is not None:
            return self._result(Verdict.NOT_ROBUST, violation=violation, reason=unsure, **fields)
        if undecided:
            return self._result(Verdict.UNDECIDED, reason=undecided, **fields)
        return self._result(Verdict.ROBUST, window=length, **fields)

    def smallest(self, length: int = 1, *, map_windows: bool = True) -> JointResult:
        """Find the smallest window length that holds, knowing that none below ``length`` does."""
        sequence = self._sequence
        whole_start, whole = (0, len(sequence)) if sequence.period is None else (sequence.prefix, sequence.period)
        key, union = self._decide(whole_start, whole)
        if union.verdict is Verdict.UNDECIDED:
            return self._result(Verdict.UNDECIDED, at_least=length, reason=union.reason)
        if union.verdict is Verdict.NOT_ROBUST:
            violation = self._violation(whole_start, whole, union)
            tried, most = ("of any length", "one whole period")
            if sequence.period is None:
                tried, most = ("up to the horizon", "the whole trace")
            chart = _Chart()
            chart.add(whole_start, key, union)
            return self._result(
                Verdict.NOT_ROBUST,
                violation=violation,
                at_least=length,
                reason=f"no window {tried} will do, as even the union of {most} is not robust enough",
                **{**chart.fields(sequence, whole), "window_unions": ()},
            )
        return self._sweep(length, map_windows)

    def _sweep(self, length: int, map_windows: bool) -> JointResult:
        """Grow the window from ``length`` on, start by start; the longest window is known to be robust."""
        start, failed = 0, None
        while start in self._sequence.window_starts(length):
            if self._decider.expired():
                return self._result(Verdict.UNDECIDED, at_least=length, reason=TIME_IS_UP)
            _, union = self._decide(start, length)
            if union.verdict is Verdict.UNDECIDED:
                return self._result(Verdict.UNDECIDED, at_least=length, reason=union.reason)
            if union.verdict is Verdict.ROBUST:
                start += 1
            else:
                failed = (start, length, union)
                length += 1
                self._tell(self._result(Verdict.UNDECIDED, at_least=length, reason=_GOES_ON))
        chart = _Chart()
        for start in self._sequence.window_starts(length) if map_windows else ():
            chart.add(start, *self._decide(start, length, known_robust=True))
        return self._result(
            Verdict.ROBUST,
            window=length,
            at_least=length,
            shorter_fails=None if failed is None else self._violation(*failed),
            **chart.fields(self._sequence, length),
        )

    def _decide(self, start: int, length: int, *, known_robust: bool = False) -> tuple[bytes, UnionVerdict]:
        self._window.move(start, length)
        if self._progress is not None and time.monotonic() - self._told > _PROGRESS_SECONDS:
            self._told = time.monotonic()
            note = f"window of {counted(length, 'step')} from step {start} of {len(self._sequence)}"
            self._progress(Progress(self._decider.settled.total(), note))
        return self._decider.decide(self._window, known_robust=known_robust)

    def _violation(self, start: int, length: int, union: UnionVerdict) -> Violation:
        """Return the violation after re-checking its pair against the definition on the union itself."""
        pair = union.witness
        if pair is not None:
            graph = self._sequence.union(start, length)
            if not is_violation(graph, graph.ids(pair.S1), graph.ids(pair.S2), self._decider.r, self._decider.s):
                raise InternalError(
                    f"rule {union.rule!r} gave a pair that violates nothing at step {start}: please report"
                )
        return Violation(start, length, pair)

    def _result(self, verdict: Verdict, **fields: Any) -> JointResult:
        return JointResult(verdict, self._decider.r, self._decider.s, **fields)


class _Chart:
    """The distinct unions in order of first appearance, and which one each start has."""

    def __init__(self) -> None:
        self._index: dict[bytes, int] = {}
        self._firsts: list[int] = []
        self._verdicts: list[UnionVerdict] = []
        self._windows: list[int] = []

    def add(self, start: int, key: bytes, union: UnionVerdict) -> None:
        if key not in self._index:
            self._index[key] = len(self._index)
            self._firsts.append(start)
            self._verdicts.append(union)
        self._windows.append(self._index[key])

    def fields(self, sequence: TimeVaryingGraph, length: int) -> dict[str, Any]:
        return {
            "examined": length,
            "unions": Unions(sequence, self._firsts, length),
            "union_verdicts": tuple(self._verdicts),
            "window_unions": tuple(self._windows),
        }


def _within(result: JointResult, tau: int | None) -> bool | None:
    if tau is None or result.verdict is Verdict.UNDECIDED:
        return None
    return result.window is not None and result.window <= tau


def _require_window(window: int | None, tau: int | None, reuse: Collection[str]) -> None:
    if window is not None and (type(window) is not int or window < 1):
        raise InvalidParameter(f"a window has an integer number of steps of at least 1, not {window!r}")
    if tau is not None and (type(tau) is not int or tau < 0):
        raise InvalidParameter(f"tau is an integer of at least 0, not {tau!r}")
    if not RULES.issuperset(reuse):
        raise InvalidParameter(f"reuse holds some of {', '.join(sorted(RULES))}, not {sorted(set(reuse) - RULES)}")
