"""``robustness simulate --certificate``: the whole battery of attacks against what a certificate claims."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .exit_codes import ExitCode
from .options import load_graph
from .output import Console, graph_document
from .query import Query
from .simulate_asked import SCHEMA, Simulation

if TYPE_CHECKING:
    from robustness.simulation.validate import ValidationReport

__all__ = ["challenge_certificate"]

#: Where a counterexample to a certificate is written when --save names no other place.
_COUNTEREXAMPLE = "counterexample.json"


def challenge_certificate(console: Console, query: Query, asked: Simulation) -> ExitCode:
    """Put a certificate to the test."""
    from certificates.file_bytes import certificate_blocks
    from certificates.stream import Stream
    from robustness.simulation.validate import validate_certificate

    graph = load_graph(str(asked.source))
    place = Path(str(asked.certificate))
    try:
        evidence = Stream(certificate_blocks(place)).rest()
    except OSError as problem:
        console.error(f"error: cannot read {place}: {problem.strerror}")
        return ExitCode.BAD_INPUT
    # Elsewhere than on a terminal click would still print the label.
    is_shown = sys.stderr is not None and sys.stderr.isatty() and not console.is_quiet
    with click.progressbar(length=1, label="battery", file=sys.stderr if is_shown else io.StringIO()) as bar:

        def advance(done: int, total: int) -> None:
            bar.length = total
            bar.update(done - bar.pos)

        def work() -> ValidationReport:
            return validate_certificate(
                graph, evidence, f=asked.f, steps=asked.own_steps, seed=query.seed, jobs=query.jobs,
                time_limit=query.timeout, progress=advance, save_to=asked.save or Path(_COUNTEREXAMPLE),
            )  # fmt: skip

        report = query.wait_for(work)
    found = report.counterexample
    if query.as_json:
        content = {
            "graph": graph_document(graph),
            "outcome": report.outcome,
            "validation": report.verdict,
            "runs": report.runs,
            "exhaustive": report.exhaustive,
            "reason": report.reason,
            "counterexample": None if found is None or found.saved_as is None else str(found.saved_as),
        }
        console.document(SCHEMA, content)
    else:
        console.result(f"{report.verdict}: {report.reason}")
    if found is not None and found.saved_as is not None:
        console.talk(f"wrote {found.saved_as}: play it with 'simulate --replay'")
    if report.verdict == "undecided":
        return ExitCode.UNDECIDED
    return ExitCode.REFUTED if found is not None else ExitCode.of_outcome(report.outcome, asked.expect)
