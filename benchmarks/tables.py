"""What a run shows: one line an instance as it is measured, then the geometric means, then the targets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.comparing import Comparison, Settings, geometric_mean
from benchmarks.measuring import METHODS

__all__ = ["Target", "comparison_document", "header", "line", "seconds_text", "suite_targets", "summary", "table"]

_CELL = 19


@dataclass(frozen=True)
class Target:
    """One figure to reach: what is asked, what was measured, and whether it is reached (None: nothing is asked)."""

    name: str
    target: str
    measured: str
    reached: bool | None
    wall: float | None = None
    cpu: float | None = None
    note: str = ""

    def row(self) -> list[str]:
        """Return the cells of the table of figures."""
        verdict = {True: "yes", False: "NO", None: "-"}[self.reached]
        times = ["-" if value is None else seconds_text(value) for value in (self.wall, self.cpu)]
        return [self.name, self.target, self.measured, verdict, *times, self.note]


def table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as aligned columns, the first row as the head.

    >>> print(table([["a", "bc"], ["1", "2"]]))
    a  bc
    1  2
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(text.rstrip() for text in lines)


def header(settings: Settings) -> str:
    """Return the head of the instances' table."""
    methods = " ".join(f"{method:>{_CELL}}" for method in settings.methods)
    return f"{'instance':<44} {'n':>4} {'r*':>6} {'ours':>9} {'cpu':>9} {'nodes':>8} {'with s':>9} {methods}"


def line(comparison: Comparison, settings: Settings) -> str:
    """Return one instance's line."""
    ours = comparison.ours
    if ours is None:
        mine = f"{'?':>6} {'failed':>9} {'-':>9} {'-':>8} {'-':>9}"
    else:
        r = str(ours.lower) if ours.is_exact else f"{ours.lower}..{ours.upper}"
        wall = seconds_text(ours.seconds) if ours.is_exact else f">{settings.cap:.3g}"
        whole = "-" if ours.whole is None else seconds_text(ours.whole)
        times = f"{wall:>9} {seconds_text(ours.cpu):>9} {ours.nodes:>8} {whole:>9}"
        mine = f"{r:>6} {times}"
    cells = " ".join(f"{_cell(comparison, method):>{_CELL}}" for method in settings.methods)
    return f"{comparison.instance.name:<44} {comparison.n:>4} {mine} {cells}"


def _cell(comparison: Comparison, method: str) -> str:
    """Return seconds and, in brackets, how many times ours that is; ``>`` when the cap was reached."""
    if method not in comparison.methods:
        return "-"
    solved, ratio = comparison.methods[method], comparison.ratio(method)
    more = "" if solved.is_solved else ">"
    times = "" if ratio is None else f" ({more}{times_text(ratio)})"
    return f"{more}{seconds_text(solved.seconds)}{times}"


def seconds_text(seconds: float) -> str:
    """Return seconds with three digits that matter.

    >>> seconds_text(0.00123456), seconds_text(12.345), seconds_text(123.4)
    ('0.00123', '12.3', '123')
    """
    return f"{seconds:.3g}" if seconds < 100 else f"{seconds:.0f}"


def times_text(ratio: float) -> str:
    """Return a ratio as ``12x``.

    >>> times_text(0.5), times_text(12345.6)
    ('0.5x', '12,346x')
    """
    return f"{ratio:,.0f}x" if ratio >= 10 else f"{ratio:.2g}x"


def cpu_ratio(comparison: Comparison, method: str) -> float | None:
    """Return the ratio in CPU seconds, where the method solved the instance."""
    ours, solved = comparison.ours, comparison.methods.get(method)
    if ours is None or not ours.is_exact or not ours.cpu or solved is None or not solved.is_solved:
        return None
    parts = [each.cpu for each in (solved.refute, solved.find) if each is not None and each.cpu is not None]
    return sum(parts) / ours.cpu or None


def means(comparisons: Iterable[Comparison], method: str) -> dict[str, Any]:
    """Return the geometric mean of a method's ratios over what it solved, and over all with the capped as bounds."""
    asked = [each for each in comparisons if method in each.methods]
    pairs = [(each.methods[method].is_solved, each.ratio(method)) for each in asked]
    cpu = [cpu_ratio(each, method) for each in asked]
    solved = [ratio for is_solved, ratio in pairs if is_solved and ratio is not None]
    known = [ratio for _, ratio in pairs if ratio is not None]
    return {
        "asked": len(pairs),
        "solved": sum(is_solved for is_solved, _ in pairs),
        "geometric_mean": geometric_mean(solved),
        "at_least_over_all": geometric_mean(known),
        "geometric_mean_cpu": geometric_mean(ratio for ratio in cpu if ratio is not None),
    }


def summary(comparisons: Sequence[Comparison], settings: Settings) -> dict[str, dict[str, Any]]:
    """Return the geometric means by family and method; the family ``all`` is everything."""
    families = list(dict.fromkeys(each.instance.family for each in comparisons))
    members = {name: [each for each in comparisons if each.instance.family == name] for name in families}
    members["all"] = list(comparisons)
    return {name: {method: means(group, method) for method in settings.methods} for name, group in members.items()}


def summary_table(means_by_family: dict[str, dict[str, Any]], settings: Settings) -> str:
    """Return the geometric means as a table: ratio over what was solved, how many, and the bound over all."""
    rows = [["family", *settings.methods]]
    for family, by_method in means_by_family.items():
        rows.append([family, *(_mean_cell(by_method[method]) for method in settings.methods)])
    cpu = [by_method["geometric_mean_cpu"] for by_method in means_by_family["all"].values()]
    rows.append(["all, in CPU seconds", *("-" if value is None else times_text(value) for value in cpu)])
    return table(rows)


def _mean_cell(mean: dict[str, Any]) -> str:
    if not mean["asked"]:
        return "-"
    solved = "-" if mean["geometric_mean"] is None else times_text(mean["geometric_mean"])
    everything = "-" if mean["at_least_over_all"] is None else times_text(mean["at_least_over_all"])
    return f"{solved} ({mean['solved']}/{mean['asked']}; >={everything})"


def suite_targets(comparisons: Sequence[Comparison], settings: Settings) -> list[Target]:
    """Return the targets that speak about the whole suite."""
    targets = []
    for method, least in (("cp-sat-direct", 30), ("cp-sat", 30), ("milp-direct", 1000), ("milp", 1000)):
        if method in settings.methods:
            mean = means(comparisons, method)
            value = mean["geometric_mean"]
            targets.append(
                Target(
                    f"geometric mean over what {method} solves",
                    f">= {least}x",
                    "nothing solved" if value is None else times_text(value),
                    None if value is None else value >= least,
                    note=f"{mean['solved']} of {mean['asked']} instances within {settings.cap:g} s",
                )
            )
    return [*targets, _no_slower(comparisons)]


def _no_slower(comparisons: Sequence[Comparison]) -> Target:
    """Return the target that no instance is more than twice slower than the best peer."""
    name, asked = "slowest against the best peer", "<= 2x"
    against = []
    for each in comparisons:
        best = each.best_peer()
        if best is not None and each.ours is not None:
            # An undetermined instance that a peer solves counts with the time spent in vain.
            against.append((each.ours.seconds / best[1], best[0], each))
    if not against:
        return Target(name, asked, "no peer solved anything", None)
    worst, peer, where = max(against, key=lambda each: each[0])
    slower = [f"{each.instance.name} {times_text(ratio)} ({other})" for ratio, other, each in against if ratio > 2]
    measured = f"{times_text(worst)} ({where.instance.name}, {peer})"
    return Target(name, asked, measured, not slower, note="; ".join(slower))


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """Return one instance as JSON-ready values, with the recipe that rebuilds it."""
    document = asdict(comparison)
    document["name"] = comparison.instance.name
    for method, solved in document["methods"].items():
        solved["ratio"] = comparison.ratio(method)
        solved["is_peer"] = METHODS[method].is_peer
    return document
