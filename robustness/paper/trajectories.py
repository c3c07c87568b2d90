"""The pictures of the experiments: ``robustness simulate --experiment NAME --plot FOLDER`` or ``FILE.svg``."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from robustness.figures.simulation import Run, draw_runs
from robustness.paper.experiments import CaseResult

__all__ = ["draw_experiment"]

#: Where the time axis ends, in steps: the transient and a little more.
_LAST_STEPS: dict[str, int | None] = {
    "setting-1": 2500,
    "setting-2": 8000,
    "gains-outside": None,
    "push": None,
    "swap": 12,
}


def draw_experiment(name: str, results: Sequence[CaseResult], path: str | os.PathLike[str]) -> list[Path]:
    """Draw every recorded case of an experiment for which the paper reports an outcome.

    Positions, positions relative to the moving target, and velocities against time where vehicles move; values only
    where they stand.

    Parameters
    ----------
    name : str
        The experiment's name.
    results : sequence of CaseResult
        From :func:`robustness.paper.experiments.run_experiment` with ``record=True``.
    path : path
        A file such as ``figures.svg`` for all cases, one below the other; or (without a suffix, or already there) a
        folder for one ``NAME-CASE.png`` each, made if it is not there.

    Returns
    -------
    list of Path
        What was written.
    """
    place, last_step = Path(path), _LAST_STEPS.get(name, 60)
    runs = {
        re.sub(r"[^a-z0-9]+", "-", case.name.lower()).strip("-"): Run(
            case.scenario, case.start, outcome, f"{name}, {case.name}"
        )
        for case, outcome in ((result.case, result.outcome) for result in results)
        if case.reported is not None
    }
    moving = any(run.scenario.target_speed != 0 for run in runs.values())
    quantities = ("position", "relative-position", "velocity") if moving else None
    if place.suffix and not place.is_dir():
        draw_runs(list(runs.values()), place, quantities=quantities, last_step=last_step)
        return [place]
    place.mkdir(parents=True, exist_ok=True)
    written = []
    for case, run in runs.items():
        written.append(place / f"{name}-{case}.png")
        draw_runs([run], written[-1], quantities=quantities, last_step=last_step)
    return written
