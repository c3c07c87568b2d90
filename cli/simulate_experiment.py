"""``robustness simulate --experiment``: an experiment of the paper, case by case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from robustness.spelled import counted

from .exit_codes import ExitCode
from .output import Console, set_text
from .query import Query
from .simulate_asked import SCHEMA, Simulation

if TYPE_CHECKING:
    from robustness.paper.experiments import CaseResult

__all__ = ["run_experiment_of_the_paper"]


def run_experiment_of_the_paper(console: Console, query: Query, asked: Simulation) -> ExitCode:
    """Run an experiment of the paper, case by case."""
    from robustness.paper.experiments import EXPERIMENTS, run_experiment

    experiment = EXPERIMENTS[str(asked.experiment)]
    results = query.wait_for(
        lambda: run_experiment(experiment, record=asked.plot is not None, time_limit=query.timeout)
    )
    overall = results[0].outcome.verdict.value
    confirmed = all(result.as_reported is not False for result in results)
    if query.as_json:
        cases = [result.as_dict() for result in results]
        content = {"experiment": experiment.name, "title": experiment.title, "outcome": overall}
        console.document(SCHEMA, {**content, "as_reported": confirmed, "cases": cases})
    else:
        console.answer(_experiment_lines(experiment.title, results))
    if asked.plot is not None:
        from robustness.paper.trajectories import draw_experiment

        for path in draw_experiment(experiment.name, results, asked.plot):
            console.talk(f"wrote {path}")
    code = ExitCode.of_outcome(overall, asked.expect)
    return code if confirmed else ExitCode.REFUTED


def _experiment_lines(title: str, results: Sequence[CaseResult]) -> Iterator[str]:
    reported = [result.as_reported for result in results if result.as_reported is not None]
    told = f": {sum(reported)} of {counted(len(reported), 'case')} as reported" if reported else ""
    yield title + told
    for result in results:
        case, outcome = result.case, result.outcome
        said = "" if case.reported is None else f" (reported: {case.reported})"
        yield f"{outcome.verdict.value:<10} {case.name}{said}"
        yield f"           {case.reading}"
        places = ", ".join(f"{set_text(labels, outcome.labels)} at {value:.6g}" for value, labels in outcome.groups)
        yield f"           {places}; gap {outcome.spread:.6g}" + (", exact" if outcome.exact else "")
