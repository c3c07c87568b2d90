"""``python -m benchmarks``: every algorithm side by side; ``python -m benchmarks figures``: the named targets.

Ends with 0; with 1 when two algorithms disagree or one fails, whatever else was measured; with 3 when an optional
package is missing; with 130 on Ctrl-C.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import figures, picture, tables
from benchmarks.comparing import Comparison, Crew, Settings, compare
from benchmarks.measuring import METHODS
from benchmarks.suite import FAMILIES, instances
from robustness.errors import MissingExtra

__all__ = ["main"]

_QUICK_NODES = 30
_QUICK_METHODS = ("subset-search", "cp-sat", "cp-sat-direct", "milp")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what the command line asks for and return the exit code."""
    options = _parser().parse_args(arguments)
    options.output.mkdir(parents=True, exist_ok=True)
    try:
        failures = _figures(options) if options.what == "figures" else _suite(options)
    except MissingExtra as problem:
        print(problem, file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    for failure in failures:
        print(f"\nFAILED: {failure}", file=sys.stderr)
    return 1 if failures else 0


def _suite(options: argparse.Namespace) -> list[str]:
    quick = options.quick
    methods = tuple(options.methods or (_QUICK_METHODS if quick else METHODS))
    settings = Settings(options.cap or (2.0 if quick else 60.0), options.jobs, methods, None if quick else 2.0)
    chosen = tuple(options.family or FAMILIES)
    largest = options.largest or (_QUICK_NODES if quick else None)
    suite = instances(options.seed, chosen, largest)
    print(
        f"{len(suite)} instances, seed {options.seed}, cap {settings.cap:g} s for each method and instance, "
        f"jobs {settings.jobs}; seconds are wall-clock, cpu is the process's\n"
        "ours: until r* is known, nothing told; the others are told r*, refute it and decide r* + 1 (in brackets: "
        "times ours)\nwarm: imports happen before, and are not counted\n"
    )
    print(tables.header(settings), flush=True)
    comparisons: list[Comparison] = []
    with Crew(settings.jobs) as crew:
        try:
            for instance in suite:
                comparisons.append(compare(instance, crew, settings))
                print(tables.line(comparisons[-1], settings), flush=True)
                for failure in comparisons[-1].failures:
                    print(f"  !! {failure}", flush=True)
        finally:
            if comparisons:
                _report(comparisons, settings, options)
    return [failure for each in comparisons for failure in each.failures]


def _report(comparisons: Sequence[Comparison], settings: Settings, options: argparse.Namespace) -> None:
    """Print the means and targets, and write JSON and the picture; also of a run that was interrupted."""
    means = tables.summary(comparisons, settings)
    targets = tables.suite_targets(comparisons, settings)
    print("\ngeometric mean of time against ours, over what the method solved (solved/asked; >= over all, capped ones")
    print("counted with the cap)\n" + tables.summary_table(means, settings) + "\n")
    print(tables.table([figures.HEAD, *(target.row() for target in targets)]))
    document = {
        "schema": "robustness/benchmark/1",
        "machine": machine(),
        "seed": options.seed,
        "settings": vars(settings) | {"methods": list(settings.methods)},
        "instances": [tables.comparison_document(each) for each in comparisons],
        "summary": means,
        "targets": [vars(target) for target in targets],
    }
    _write(options.output / "suite.json", document)
    picture.draw(comparisons, settings, options.output / "time-against-n.png")
    print(f"\nwritten: {options.output / 'suite.json'}, {options.output / 'time-against-n.png'}", flush=True)


def _figures(options: argparse.Namespace) -> list[str]:
    print(f"seed {options.seed}, jobs {options.jobs}; seconds until r* is known, warm; cpu is the process's\n")
    targets: list[tables.Target] = []
    failures: list[str] = []
    print(tables.table([figures.HEAD]), flush=True)
    try:
        for target in figures.measure(options.seed, options.jobs, options.cap, quick=options.quick, failures=failures):
            targets.append(target)
            print("  ".join(target.row()).rstrip(), flush=True)
    finally:
        if targets:
            print("\n" + tables.table([figures.HEAD, *(target.row() for target in targets)]))
            document = {
                "schema": "robustness/benchmark-figures/1",
                "machine": machine(),
                "seed": options.seed,
                "jobs": options.jobs,
                "figures": [vars(target) for target in targets],
                "failures": failures,
            }
            _write(options.output / "figures.json", document)
            print(f"\nwritten: {options.output / 'figures.json'}", flush=True)
    return failures


def machine() -> dict[str, Any]:
    """Return what times depend on."""
    packages = ("ortools", "numpy", "networkx")
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "packages": {name: importlib.metadata.version(name) for name in packages},
    }


def _write(path: Path, document: dict[str, Any]) -> None:
    path.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=("suite", "figures"), default="suite")
    parser.add_argument("--quick", action="store_true", help=f"graphs up to {_QUICK_NODES} nodes, a cap of 2 s")
    parser.add_argument("--seed", type=int, default=1, help="of the random families; 1 unless given")
    parser.add_argument(
        "--cap", type=_positive, metavar="SECONDS", help="for each method and instance; 60 unless given"
    )
    parser.add_argument("--jobs", type=_count, default=1, help="threads, where a method takes them; 1 unless given")
    parser.add_argument("--output", type=Path, default=Path("build/benchmarks"), metavar="DIR")
    parser.add_argument("--family", action="append", choices=tuple(FAMILIES), help="this one only; may be repeated")
    parser.add_argument("--method", action="append", choices=tuple(METHODS), dest="methods", help="beside ours")
    parser.add_argument("--largest", type=_count, metavar="N", help="leave out graphs on more nodes")
    return parser


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"a positive, finite number, not {text}")
    return value


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"an integer of at least 1, not {text}")
    return value


if __name__ == "__main__":
    sys.exit(main())
