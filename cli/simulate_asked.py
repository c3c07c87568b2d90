"""What ``robustness simulate`` is asked: a scenario, an experiment of the paper, or a certificate to challenge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

__all__ = ["SCHEMA", "Simulation"]

SCHEMA = "robustness/simulate/1"


@dataclass(frozen=True, slots=True)
class Simulation:
    """The command's own options, which fit each other.

    Attributes
    ----------
    source, experiment, replay : str, str, Path; exactly one of them
        GRAPH, the name of an experiment, or a recorded run.
    attack_file, certificate : Path or None
        With GRAPH: an attack to play, or a certificate to challenge.
    f, malicious, adversary, rule, model, schedule, tau, active, steps, runs, period, speed, alpha, weights
        The scenario. ``period`` is the sampling period T.
    over_time, repeat : bool, int or None
        Whether GRAPH is a sequence, and how many of its last steps repeat.
    own_steps : int or None
        ``steps`` where the user gave it.
    save, plot, animate : Path or None
        What to write.
    last_step : int or None
        Where the picture and the film end; None for a while after nothing moves any more.
    expect : str or None
        The outcome that exits with 0.
    """

    source: str | None
    experiment: str | None
    replay: Path | None
    attack_file: Path | None
    certificate: Path | None
    f: int | None
    malicious: tuple[str, ...]
    adversary: str
    rule: str
    model: str
    schedule: str
    tau: int | None
    over_time: bool
    repeat: int | None
    active: tuple[str, ...]
    steps: int
    own_steps: int | None
    runs: int
    period: float
    speed: float
    alpha: float | None
    weights: str
    save: Path | None
    plot: Path | None
    animate: Path | None
    last_step: int | None
    expect: str | None

    def __post_init__(self) -> None:
        """Refuse options that contradict each other, and an output that is an input."""
        if sum(each is not None for each in (self.source, self.experiment, self.replay)) != 1:
            raise click.UsageError("give one of GRAPH, --experiment and --replay.")
        if self.source is None and (self.attack_file or self.certificate):
            raise click.UsageError("--attack and --certificate need the GRAPH they are about.")
        if self.attack_file and self.certificate:
            raise click.UsageError("give one of --attack and --certificate.")
        if self.animate is not None and (self.experiment or self.certificate):
            raise click.UsageError("--animate shows one run: give it with GRAPH or --replay.")
        if self.last_step is not None and (self.experiment or (self.plot is None and self.animate is None)):
            raise click.UsageError("--last-step says where --plot or --animate ends: give one of them, of one run.")
        if self.over_time and (self.source is None or self.certificate):
            raise click.UsageError("--over-time says what GRAPH is, and a certificate is about one graph.")
        if self.repeat is not None and not self.over_time:
            raise click.UsageError("--period belongs to a sequence: give --over-time as well.")
        from robustness.files.writing import require_different_files

        inputs = [self.source, self.replay, self.attack_file, self.certificate]
        require_different_files(inputs, [self.save, self.plot, self.animate], makes_folders=True)
        # Before the work that it might be lost for.
        if self.plot is not None and (self.plot.suffix or self.experiment is None):
            from robustness.figures.saving import picture_format

            picture_format(self.plot)
        if self.animate is not None:
            from robustness.figures.animation import film_format

            film_format(self.animate)
