"""The pictures of the experiments, one per case: ``robustness simulate --experiment NAME --plot FOLDER``."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from robustness.figures.simulation import draw_run
from robustness.simulation.experiments import CaseResult

__all__ = ["draw_experiment"]

#: Where the time axis ends, in steps: the transient and a little more.
_LAST_STEPS = {"setting-1": 2500, "setting-2": 8000}


def draw_experiment(name: str, results: Sequence[CaseResult], folder: str | os.PathLike[str]) -> list[Path]:
    """Draw every recorded case of an experiment for which the paper reports an outcome.

    Parameters
    ----------
    name : str
        The experiment's name.
    results : sequence of CaseResult
        From :func:`robustness.simulation.experiments.run_experiment` with ``record=True``.
    folder : path
        Made if it is not there.

    Returns
    -------
    list of Path
        ``NAME-CASE.png``: positions, positions relative to the moving target, and velocities against time where
        vehicles move; values only where they stand.
    """
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    written = []
    for result in results:
        case, outcome = result.case, result.outcome
        if case.reported is None:
            continue
        path = place / f"{name}-{re.sub(r'[^a-z0-9]+', '-', case.name.lower()).strip('-')}.png"
        moving = case.scenario.target_speed != 0
        quantities = ("position", "relative-position", "velocity") if moving else ("relative-position", "velocity")
        draw_run(
            case.scenario, case.start, outcome, path, quantities=quantities,
            title=f"{name}, {case.name}: {outcome.verdict.value}", last_step=_LAST_STEPS.get(name, 60),
        )  # fmt: skip
        written.append(path)
    return written
