"""The named targets: every figure the project set itself, measured one by one and told yes or no.

The geometric means over the suite are in the suite's own run, ``python -m benchmarks``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from statistics import median

from benchmarks.comparing import Crew, Settings, compare, contradiction
from benchmarks.large_graph import LARGE_GRAPHS, check_large_graph
from benchmarks.measuring import Measured, profile
from benchmarks.suite import Instance, build
from benchmarks.tables import Target, seconds_text, times_text
from benchmarks.workers import CallFailed, OutOfTime, WorkerLost

__all__ = ["HEAD", "measure"]

#: The head of the table of figures.
HEAD = ["figure", "target", "measured", "reached", "wall s", "cpu s", "note"]

#: Until this many times its target a determination may go on, so that a miss says by how much.
_PATIENCE = 5
_LONG = 120.0


@dataclass(frozen=True)
class Exact:
    """r* exactly, pair for r* + 1 and refutation of r*; ``within`` None: as far as it gets in two minutes."""

    instance: Instance
    within: float | None


def _exact(seed: int) -> list[Exact]:
    def of(builder: str, within: float | None, **arguments: float) -> Exact:
        return Exact(Instance("figures", builder, arguments), within)

    return [
        of("gnp", 2, n=40, p=0.5, seed=seed),
        of("gnp", 2, n=50, p=0.8, seed=seed),
        of("gnp", 2, n=60, p=0.8, seed=seed),
        of("gnp", 2, n=60, p=0.3, seed=seed),
        of("directed_gnp", 2, n=50, p=0.5, seed=seed),
        of("regular", 2, n=80, k=10, seed=seed),
        of("regular", 2, n=120, k=6, seed=seed),
        # The radius is not told: 0.4 is that of the first measurements at n = 120.
        *(of("unit_disk", 2, n=200, radius=radius, seed=seed) for radius in (0.2, 0.3, 0.4)),
        of("circulant", 2, n=200, k=10),
        of("platoon", 2, n=500, k=8),
        of("gnp", 20, n=50, p=0.5, seed=seed),
        of("directed_gnp", 20, n=60, p=0.5, seed=seed),
        of("regular", _LONG, n=60, k=20, seed=seed),
        of("gnp", _LONG, n=60, p=0.5, seed=seed),
        of("gnp", None, n=70, p=0.5, seed=seed),
        of("gnp", None, n=80, p=0.5, seed=seed),
    ]


def measure(seed: int, jobs: int, cap: float | None, *, quick: bool, failures: list[str]) -> Iterator[Target]:
    """Yield every figure as soon as it is measured; disagreements and crashes are appended to ``failures``.

    ``cap`` replaces the seconds allowed to each; ``quick`` allows each determination its target and 10 s at most.
    """
    with Crew(jobs) as crew:
        for name, task in _tasks(seed, jobs, cap, quick, crew, failures):
            try:
                yield task()
            except (OutOfTime, WorkerLost, CallFailed) as problem:
                failures.append(f"{name}: {problem}")
                yield Target(name, "", "failed", False, note=str(problem).strip().splitlines()[-1])


def _tasks(
    seed: int, jobs: int, cap: float | None, quick: bool, crew: Crew, failures: list[str]
) -> Iterator[tuple[str, partial[Target]]]:
    """Yield what is to be measured, with its name."""

    def gnp(n: int, p: float) -> Instance:
        return Instance("figures", "gnp", {"n": n, "p": p, "seed": seed})

    for figure in _exact(seed):
        yield figure.instance.name, partial(_determination, figure, _allowed(figure.within, cap, quick), crew, failures)
    against = Settings(10.0 if quick else cap or _LONG, jobs)
    for n, p, least in ((30, 0.8, 1000), (40, 0.8, 1000), (40, 0.5, 100)):
        yield "against CP-SAT", partial(_against_direct_cp_sat, gnp(n, p), least, against, crew, failures)
    for n, within in ((20, 0.3), (24, 8.0)):
        yield "profile", partial(_profile, gnp(n, 0.5), within, crew)
    for builder, arguments, settled_by in LARGE_GRAPHS:
        instance = Instance("figures", builder, {**arguments, "seed": seed})
        yield instance.name, partial(check_large_graph, instance, settled_by)
    yield "topohub", partial(_topohub, crew, failures)
    for n in (40, 60, 80):
        yield "(f+1,f+1)", partial(_tolerance, gnp(n, 0.5), 10.0, crew, failures)
    if not quick:
        yield "two threads", partial(_two_threads, gnp(50, 0.5), cap or _LONG, crew, failures)


def _allowed(within: float | None, cap: float | None, quick: bool) -> float:
    if quick:
        return min(within or 10.0, 10.0)
    return cap or min((within or _LONG) * _PATIENCE, _LONG)


def _determination(figure: Exact, allowed: float, crew: Crew, failures: list[str]) -> Target:
    target = "as far as it gets" if figure.within is None else f"< {figure.within:g} s"
    found, runs = crew.determine(figure.instance, allowed, s_cap=2.0)
    statements = [("ours", run.lower, True) for run in runs] + [("ours", run.upper + 1, False) for run in runs]
    wrong = contradiction(statements)
    if wrong:
        failures.append(f"DISAGREEMENT on {figure.instance.name}: {wrong}")
    if found.is_exact:
        measured = f"r* = {found.lower} in {seconds_text(found.seconds)} s"
        reached = None if figure.within is None else found.seconds < figure.within
        note = f"{found.nodes} nodes ({found.algorithm})"
        if found.whole is not None:
            note += f"; s_max {'=' if found.s_is_exact else '>='} {found.s} after {seconds_text(found.whole)} s"
    else:
        measured = f"{found.lower} <= r* <= {found.upper} after {seconds_text(found.seconds)} s"
        reached, note = None if figure.within is None else False, f"{found.nodes} nodes"
    return Target(figure.instance.name, target, measured, reached, found.seconds, found.cpu, note)


def _against_direct_cp_sat(
    instance: Instance, least: int, settings: Settings, crew: Crew, failures: list[str]
) -> Target:
    method = "cp-sat-direct"
    line = compare(instance, crew, Settings(settings.cap, settings.jobs, (method,), s_cap=None))
    failures += line.failures
    ratio, solved = line.ratio(method), line.methods.get(method)
    name, target = f"{instance.name} against {method}", f">= {least}x"
    if ratio is None or solved is None or line.ours is None:
        return Target(name, target, "not determined", False)
    note = f"ours {seconds_text(line.ours.seconds)} s, {method} {seconds_text(solved.seconds)} s"
    if not solved.is_solved:
        note += ", where its cap ended it"
    measured = f"{'' if solved.is_solved else '>= '}{times_text(ratio)}"
    return Target(name, target, measured, ratio >= least, line.ours.seconds, line.ours.cpu, note)


def _profile(instance: Instance, within: float, crew: Crew) -> Target:
    allowed = _PATIENCE * within + 10
    runs = [crew.run("auto", profile, instance, allowed, seconds=allowed)]
    if runs[0][1] < 1:
        runs += [crew.run("auto", profile, instance, allowed, seconds=allowed) for _ in range(2)]
    table, seconds, cpu = sorted(runs, key=lambda run: float(run[1]))[len(runs) // 2]
    name, told = f"profile of {instance.name}", f"< {within:g} s"
    values = " ".join(f"{r}:{s}" for r, s in table.items())
    return Target(name, told, f"{seconds_text(seconds)} s", seconds < within, seconds, cpu, f"s_max {values}")


def _topohub(crew: Crew, failures: list[str]) -> Target:
    """Determine r* of every network of topohub on at most 200 nodes."""
    from robustness.files.topohub_names import list_names

    every = [Instance("figures", "topohub", {"name": name}) for name in list_names()]
    chosen = [instance for instance in every if 2 <= build(instance).n <= 200]
    times: list[tuple[float, str]] = []
    open_names: list[str] = []
    cpu = 0.0
    for instance in chosen:
        try:
            found, _ = crew.determine(instance, 10.0, s_cap=None)
        except (OutOfTime, WorkerLost, CallFailed) as problem:
            failures.append(f"{instance.name}: {problem}")
            open_names.append(instance.name)
            continue
        times.append((found.seconds, instance.arguments["name"]))
        cpu += found.cpu
        if not found.is_exact:
            open_names.append(instance.name)
    total, (slowest, where) = sum(seconds for seconds, _ in times), max(times)
    late = sorted((each for each in times if each[0] >= 0.2), reverse=True)
    note = f"median {seconds_text(median(seconds for seconds, _ in times))} s; {len(late)} of 0.2 s or more"
    if late:
        note += ": " + ", ".join(f"{name} {seconds_text(seconds)}" for seconds, name in late[:5])
    if open_names:
        note += f"; not determined: {', '.join(open_names[:5])}"
    measured = f"{len(chosen)} graphs, {seconds_text(total)} s in all, slowest {seconds_text(slowest)} s ({where})"
    reached = not late and not open_names
    return Target("every topohub graph up to 200 nodes", "each < 0.2 s", measured, reached, total, cpu, note)


def _tolerance(instance: Instance, cap: float, crew: Crew, failures: list[str]) -> Target:
    """Decide (f+1,f+1) for f = 1..4, beside (f+1,1), which a bound may settle where (f+1,f+1) takes a search."""
    texts, decided, wall, cpu = [], True, 0.0, 0.0
    for f in range(1, 5):
        both, _ = crew.ask(instance, f + 1, f + 1, "auto", cap)
        alone, _ = crew.ask(instance, f + 1, 1, "auto", cap)
        failures += [each.reason for each in (both, alone) if each.verdict == "failed"]
        if both.verdict == "robust" and alone.verdict == "not-robust":
            failures.append(f"DISAGREEMENT on {instance.name}: ({f + 1},{f + 1})-robust, yet not {f + 1}-robust")
        decided &= both.is_decided
        texts.append(f"({f + 1},{f + 1}) {_brief(both)}, s = 1 {_brief(alone)}")
        wall, cpu = wall + both.seconds, cpu + (both.cpu or 0.0)
    name = f"(f+1,f+1), f = 1..4, of {instance.name}"
    measured = f"{seconds_text(wall)} s for the four" if decided else "undecided"
    return Target(name, f"all within {cap:g} s", measured, decided, wall, cpu, "; ".join(texts))


def _brief(measured: Measured) -> str:
    return f"{seconds_text(measured.seconds)} s" if measured.is_decided else "undecided"


def _two_threads(instance: Instance, cap: float, crew: Crew, failures: list[str]) -> Target:
    """Refute r* with one thread and with two."""
    name, target = f"two threads against one, refuting r* of {instance.name}", ">= 1.7x"
    found, _ = crew.determine(instance, cap, s_cap=None)
    if not found.is_exact:
        return Target(name, target, "r* not determined", False, found.seconds, found.cpu)
    runs = []
    for jobs in (1, 2):
        with Crew(jobs) as threads:
            runs.append(threads.ask(instance, found.lower, 1, "subset-search", cap)[0])
    one, two = runs
    failures += [f"{name}: {each.reason or each.verdict}" for each in runs if each.verdict in ("failed", "not-robust")]
    if not (one.is_decided and two.is_decided):
        return Target(name, target, "undecided", False, note=f"{_brief(one)}, {_brief(two)}")
    ratio = one.seconds / two.seconds
    sides = (f"{seconds_text(run.seconds)} s ({seconds_text(run.cpu or 0)} s CPU, {run.nodes} nodes)" for run in runs)
    note = " against ".join(sides)
    return Target(name, target, times_text(ratio), ratio >= 1.7, two.seconds, two.cpu, note)
