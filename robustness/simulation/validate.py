"""Certificates put to the test: every promise is attacked, every refutation is carried out.

A robust certificate promises agreement for certain f, rules and schedules; the battery plays every adversary and
schedule against it, with every malicious set where these are few enough. That is no proof (the certificate is), but a
single split, or a vehicle that leaves the safety interval, would be a counterexample to the theory, to the
certificate or to this package: it is saved so that anybody can run it again. A violation certificate carries
its own attack; the attack must split the network exactly.
"""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb
from pathlib import Path

from certificates.graph import Label
from robustness.definitions import is_violation
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.results import RobustnessResult
from robustness.simulation.adversaries import ADVERSARIES
from robustness.simulation.attacks import attack_from_violation
from robustness.simulation.claim import claim_of_certificate, claim_of_result
from robustness.simulation.draws import Draws
from robustness.simulation.outcome import Outcome, RunVerdict
from robustness.simulation.replay import write_run
from robustness.simulation.run import simulate
from robustness.simulation.scenario import Scenario, Start, random_start
from robustness.simulation.schedules import schedule_named
from robustness.simulation.topology import Topology
from robustness.spelled import counted

__all__ = ["Counterexample", "Regime", "ValidationReport", "malicious_sets", "promised_regimes", "validate_certificate"]

#: Schedules of the battery under partial asynchrony, with their tau.
_ASYNCHRONOUS = (("periodic", 3), ("random", 4), ("adversarial", 4), ("delayed", 2))

#: The sampling period where f = 0: nothing is dropped, so weights add up to 1, and with T = 1 no theorem would apply.
_T_WITHOUT_LIARS = 0.5


@dataclass(frozen=True, slots=True)
class Regime:
    """What is promised: agreement against f faults of a model, for a rule and a schedule.

    Attributes
    ----------
    rule, model : str
    schedule : str
    tau : int
    f : int
        The greatest for which the theorem applies.
    theorem : str
    """

    rule: str
    model: str
    schedule: str
    tau: int
    f: int
    theorem: str


@dataclass(frozen=True, slots=True)
class Counterexample:
    """A run that broke a promise: replay it with :func:`robustness.simulation.replay.read_run`."""

    scenario: Scenario
    start: Start
    outcome: Outcome
    saved_as: Path | None = None


@dataclass(frozen=True, slots=True)
class ValidationReport:
    """What the battery found.

    Attributes
    ----------
    verdict : str
        ``"confirmed"``: every run ended as promised. ``"counterexample"``: one did not. ``"undecided"``: some run was
        undecided at eight times the horizon, or a worker was lost.
    runs : int
    exhaustive : bool
        Whether every malicious set was played, rather than a sample.
    counterexample : Counterexample or None
    reason : str
        In words.
    promised : str
        What the certificate promises: ``"agreement"``, or ``"split"`` for a violation.
    """

    verdict: str
    runs: int
    exhaustive: bool
    counterexample: Counterexample | None
    reason: str
    promised: str = "agreement"

    @property
    def outcome(self) -> str:
        """``"agreement"`` or ``"split"`` as promised and confirmed, or as the counterexample shows; or undecided."""
        if self.counterexample is not None:
            return self.counterexample.outcome.verdict.value
        return self.promised if self.verdict == "confirmed" else "undecided"


def promised_regimes(r: int, s: int, f: int | None = None) -> tuple[Regime, ...]:
    """Return what (r,s)-robustness promises, for f or else for the greatest f of each theorem.

    (r,s)-robust implies (r-1,s+1)-robust, so W-MSR and DP-MSR survive f = min(r, (r+s) // 2) - 1 malicious nodes
    (LeBlanc et al. 2013). r-robust with r >= 2f+1 gives ADP-MSR under delays (Theorem 1 of the source paper),
    and W-MSR against Byzantine nodes: without any f nodes the graph is still (f+1)-robust (Vaidya et al. 2012).

    >>> [(regime.rule, regime.f) for regime in promised_regimes(3, 1)][:3]
    [('w-msr', 1), ('dp-msr', 1), ('w-msr', 1)]
    """
    plain, strong = min(r, (r + s) // 2) - 1, (r - 1) // 2
    regimes = [
        Regime("w-msr", "malicious", "synchronous", 0, plain, "(f+1,f+1)-robust"),
        Regime("dp-msr", "malicious", "synchronous", 0, plain, "(f+1,f+1)-robust"),
        Regime("w-msr", "byzantine", "synchronous", 0, strong, "(2f+1)-robust"),
        *(Regime("adp-msr", "malicious", name, tau, strong, "(2f+1)-robust") for name, tau in _ASYNCHRONOUS),
    ]
    if f is not None:
        regimes = [replace(regime, f=f) for regime in regimes if f <= regime.f]
    return tuple(regime for regime in regimes if regime.f >= 0)


def malicious_sets(graph: Digraph, f: int, most: int, seed: int) -> tuple[list[frozenset[Label]], bool]:
    """Return the sets of at most f nodes that leave a normal one, or a sample of ``most`` distinct ones of f nodes.

    Returns
    -------
    list of frozenset, bool
        The sets, and whether they are all.
    """
    largest = min(f, graph.n - 1)
    if sum(comb(graph.n, size) for size in range(largest + 1)) <= most:
        ids = (chosen for size in range(largest + 1) for chosen in combinations(range(graph.n), size))
        return [graph.labels_of(chosen) for chosen in ids], True
    draws, found = Draws([seed]), dict.fromkeys([frozenset[Label]()])
    attempt = 0
    # Sets are drawn with repetition; there are more than ``most`` of them, so this ends soon.
    while len(found) < min(most, comb(graph.n, largest)) and attempt < 100 * most:
        keys = draws.uniform("malicious sets", attempt, graph.n)[0]
        found.setdefault(graph.labels_of(keys.argsort()[:largest].tolist()))
        attempt += 1
    return list(found), False


def validate_certificate(
    G: GraphLike,
    certificate: bytes | RobustnessResult,
    *,
    f: int | None = None,
    most_sets: int = 200,
    starts_per_set: int = 2,
    steps: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    time_limit: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    save_to: Path | None = None,
) -> ValidationReport:
    """Play the battery against a robust certificate, or the attack of a violation certificate.

    Parameters
    ----------
    G : networkx graph or Digraph
    certificate : bytes or RobustnessResult
        Bytes are verified by the kernel first. A result is taken at its word (its witness is re-checked).
    f : int, optional
        Play against this f only; else each theorem with the greatest f that the certificate promises.
    most_sets : int
        Every malicious set is played when there are at most this many, otherwise a seeded sample of this many.
    starts_per_set : int
        Random starts for each malicious set.
    steps : int, optional
        The horizon; runs that are undecided there are run eight times as long. Default: ``200 + 40 n``.
    seed : int
    jobs : int
        Worker processes; the report does not depend on their number.
    time_limit : float, optional
        Wall-clock seconds, looked at between batches; what is not played by then is undecided.
    progress : callable, optional
        Called with the batches done and the batches in all.
    save_to : Path, optional
        A file for the counterexample, should there be one; folders on the way are made.

    Returns
    -------
    ValidationReport

    Raises
    ------
    InvalidParameter
        When the certificate decides nothing, or promises nothing for this f.
    certificates.CertificateError
        When the bytes are not a valid certificate of this graph.
    """
    graph = as_digraph(G)
    if isinstance(certificate, RobustnessResult):
        r, s, pair = claim_of_result(certificate)
    else:
        r, s, pair = claim_of_certificate(graph, certificate)
    if pair is not None:
        return _saved(_carry_out(graph, pair, f, steps), save_to)
    regimes = promised_regimes(r, s, f)
    if not regimes or graph.n < 2:
        raise InvalidParameter(f"({r},{s})-robustness promises nothing for f = {f}: certify a greater r, or lower f")
    horizon = 200 + 40 * graph.n if steps is None else steps
    tasks, exhaustive = [], True
    for regime in regimes:
        sets, whole = malicious_sets(graph, regime.f, most_sets, seed)
        exhaustive &= whole
        starts = [
            random_start(graph, chosen, (seed + starts_per_set * place + again) % (1 << 63))
            for place, chosen in enumerate(sets)
            for again in range(starts_per_set)
        ]
        for name in ADVERSARIES:
            tasks.append((_scenario(graph, regime, name, horizon), starts))
    deadline = float("inf") if time_limit is None else time.monotonic() + time_limit
    return _saved(_play(tasks, exhaustive, jobs, deadline, progress), save_to)


def _scenario(graph: Digraph, regime: Regime, adversary: str, steps: int) -> Scenario:
    return Scenario(
        Topology((graph,)), regime.f, regime.rule, regime.model, ADVERSARIES[adversary](),
        schedule_named(regime.schedule, regime.tau), steps, T=1.0 if regime.f else _T_WITHOUT_LIARS,
    )  # fmt: skip


def _carry_out(
    graph: Digraph, pair: tuple[frozenset[Label], frozenset[Label]], f: int | None, steps: int | None
) -> ValidationReport:
    """Run the attack of a violating pair under every rule, for the least f that it attacks."""
    first, second = graph.ids(pair[0]), graph.ids(pair[1])
    able = [k for k in range(graph.n) if is_violation(graph, first, second, k + 1, k + 1)]
    if not able or (f is not None and f not in able):
        which = "any f" if f is None else f"f = {f}"
        raise InvalidParameter(f"an attack needs a violation of (f+1,f+1)-robustness, and this is none for {which}")
    attack = attack_from_violation(graph, able[0] if f is None else f, pair)
    horizon = 1000 if steps is None else steps
    rules = ("w-msr", "dp-msr", "adp-msr")
    for rule in rules:
        outcome = attack.run(horizon, rule=rule)
        if not outcome.exact:
            found = Counterexample(attack.scenario(horizon, rule=rule), attack.start(), outcome)
            return ValidationReport("counterexample", 1, True, found, f"the attack did not split {rule}", "split")
    reason = f"split exactly, f = {attack.f}: {attack.story()}"
    return ValidationReport("confirmed", len(rules), True, None, reason, "split")


def _play(
    tasks: Sequence[tuple[Scenario, list[Start]]],
    exhaustive: bool,
    jobs: int,
    deadline: float,
    progress: Callable[[int, int], None] | None,
) -> ValidationReport:
    """Play every batch until one breaks its promise."""
    runs, undecided, done = 0, 0, 0
    try:
        for found, unsettled, played in _in_order(tasks, jobs):
            runs, undecided, done = runs + played, undecided + unsettled, done + 1
            if progress is not None:
                progress(done, len(tasks))
            if found is not None:
                reason = f"{found.outcome.verdict.value} under {found.scenario.rule} and {found.scenario.adversary}"
                return ValidationReport("counterexample", runs, exhaustive, found, reason)
            if time.monotonic() > deadline and done < len(tasks):
                reason = f"the time limit came after {done} of {counted(len(tasks), 'batch', 'batches')}"
                return ValidationReport("undecided", runs, exhaustive, None, reason)
    except BrokenProcessPool:
        return ValidationReport("undecided", runs, exhaustive, None, "a worker was lost: nothing is claimed")
    if undecided:
        return ValidationReport(
            "undecided",
            runs,
            exhaustive,
            None,
            f"{counted(undecided, 'run was', 'runs were')} undecided at the horizon",
        )
    sets = (
        "every set of malicious nodes was played"
        if exhaustive
        else "a sample of the sets of malicious nodes was played"
    )
    reason = f"{counted(runs, 'run')} agreed, none left its safety interval; {sets}"
    return ValidationReport("confirmed", runs, exhaustive, None, reason)


def _in_order(
    tasks: Sequence[tuple[Scenario, list[Start]]], jobs: int
) -> Iterator[tuple[Counterexample | None, int, int]]:
    if jobs <= 1:
        yield from map(_play_batch, tasks)
        return
    # Spawned, because a forked process would inherit the locks of this one's threads.
    context = multiprocessing.get_context("spawn")
    # Ctrl-C is the parent's business; workers finish their batch and are told to stop.
    with ProcessPoolExecutor(jobs, context, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        try:
            yield from pool.map(_play_batch, tasks)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _play_batch(task: tuple[Scenario, list[Start]]) -> tuple[Counterexample | None, int, int]:
    """Return the first broken promise of a batch, how many runs stayed undecided, and how many were played."""
    scenario, starts = task
    unsettled = []
    for start, outcome in zip(starts, simulate(scenario, starts), strict=True):
        if _breaks_the_promise(outcome):
            return Counterexample(scenario, start, outcome), 0, len(starts)
        if outcome.verdict is RunVerdict.UNDECIDED:
            unsettled.append(start)
    undecided = 0
    longer = replace(scenario, steps=8 * scenario.steps)
    for start, outcome in zip(unsettled, simulate(longer, unsettled), strict=True):
        if _breaks_the_promise(outcome):
            return Counterexample(longer, start, outcome), 0, len(starts)
        undecided += outcome.verdict is RunVerdict.UNDECIDED
    return None, undecided, len(starts)


def _breaks_the_promise(outcome: Outcome) -> bool:
    """Return whether a run is a counterexample: apart for good, out of all bounds, or outside its hull."""
    return outcome.verdict in (RunVerdict.SPLIT, RunVerdict.DIVERGENCE) or outcome.safe is False


def _saved(report: ValidationReport, path: Path | None) -> ValidationReport:
    """Write the counterexample to the file; a file that cannot be written takes nothing from the verdict."""
    found = report.counterexample
    if found is None or path is None:
        return report
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_run(path, found.scenario, found.start, found.outcome)
    except OSError as problem:
        return replace(report, reason=f"{report.reason}; {path} cannot be written: {problem.strerror}")
    return replace(report, counterexample=replace(found, saved_as=path))
