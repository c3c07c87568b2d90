"""``robustness simulate``: consensus under attack, the paper's experiments, and certificates put to the test."""

from __future__ import annotations

from typing import Any

import click

from .choices import ADVERSARY_NAMES, EXPERIMENT_NAMES, FAULT_MODEL_NAMES, RULE_NAMES, SCHEDULE_NAMES
from .named import FILE, PLACE
from .options import ReadingCommand, complete_files, reading_options
from .output import Console
from .query import Query, query_options
from .simulate_asked import SCHEMA, Simulation

__all__ = ["SCHEMA", "command"]


@click.command("simulate", cls=ReadingCommand, short_help="Run resilient consensus under attack: agreement or split?")
@click.argument("source", metavar="[GRAPH]", required=False, shell_complete=complete_files)
@reading_options
@click.option(
    "--experiment",
    type=click.Choice(EXPERIMENT_NAMES),
    help="Instead of GRAPH an experiment of Safi, Dibaji and Pirani, Resilient Coordinated Movement of "
    "Connected Autonomous Vehicles.",
)
@click.option("--replay", type=FILE, metavar="FILE", help="A run recorded with --save instead of GRAPH.")
@click.option("--attack", "attack_file", type=FILE, metavar="FILE", help="Play the attack that 'attack -o' wrote.")
@click.option("--certificate", type=FILE, metavar="FILE", help="Play the whole battery against a certificate.")
@click.option("-f", "f", type=click.IntRange(min=0), metavar="F", help="The bound on faults; 1 unless given.")
@click.option("--malicious", multiple=True, metavar="NODE", help="May be repeated; the F heard by most unless given.")
@click.option(
    "--adversary",
    type=click.Choice(ADVERSARY_NAMES),
    default="auto",
    show_default=True,
    help="auto: the attack that splits this network, where a short search finds one; else greedy.",
)
@click.option("--rule", type=click.Choice(RULE_NAMES), default="adp-msr", show_default=True, help="What a node does.")
@click.option(
    "--model", type=click.Choice(FAULT_MODEL_NAMES), default="malicious", show_default=True, help="What liars may do."
)
@click.option(
    "--schedule", type=click.Choice(SCHEDULE_NAMES), default="synchronous", show_default=True, help="Who updates when."
)
@click.option(
    "--tau",
    type=click.IntRange(min=0),
    metavar="T",
    help="The bound on the age of values; 0, or 3 with delays, unless given.",
)
@click.option("--over-time", is_flag=True, help="GRAPH is a sequence of graphs, as 'joint' reads it.")
@click.option("--period", "repeat", type=click.IntRange(min=1), metavar="P", help="With it: the last P steps repeat.")
@click.option("--active", multiple=True, metavar="NODE", help="Senses actively; may be repeated.")
@click.option("--steps", type=click.IntRange(min=1), metavar="N", default=1000, show_default=True, help="How long.")
@click.option("--runs", type=click.IntRange(min=1), metavar="N", default=1, show_default=True, help="Random starts.")
@click.option(
    "-T", "--sampling-period", "period", type=float, metavar="T", default=1.0, show_default=True, help="Of a step."
)
@click.option("--speed", type=float, metavar="V", default=0.0, show_default=True, help="The target speed.")
@click.option("--alpha", type=float, metavar="A", help="The gain of every node; 1.5/T unless given.")
@click.option(
    "--weights",
    type=click.Choice(("uniform", "unit")),
    default="uniform",
    show_default=True,
    help="Of links: 1/d, or 1.",
)
@click.option("--save", type=FILE, metavar="FILE", help="Record the (first) run, or a counterexample.")
@click.option(
    "--plot",
    type=PLACE,
    metavar="PATH",
    help="A picture (.png, .svg, .pdf); with --experiment also a folder for one per case.",
)
@click.option("--animate", type=FILE, metavar="FILE", help="The first run as a film: .gif, or .html to play.")
@click.option(
    "--last-step",
    type=click.IntRange(min=1),
    metavar="K",
    help="Where the picture and the film end; otherwise a while after nothing moves any more.",
)
@click.option("--expect", type=click.Choice(("agreement", "split")), help="Exit with 10 when it ends otherwise.")
@query_options()
def command(ctx: click.Context, console: Console, query: Query, /, **options: Any) -> None:
    """Run resilient consensus on GRAPH under attack, and say whether it ends in agreement or split.

    Exit code 0 for agreement, split or divergence, 30 when undecided at the horizon; with --expect 10 for another one.
    An experiment ends in 10 when a case differs from what the paper reports. With --certificate, 10 is a
    counterexample; it is saved for --replay, as counterexample.json unless --save names another file.
    """
    is_given = ctx.get_parameter_source("steps") is click.core.ParameterSource.COMMANDLINE
    asked = Simulation(**options, own_steps=options["steps"] if is_given else None)
    if asked.experiment is not None:
        from .simulate_experiment import run_experiment_of_the_paper as work
    elif asked.certificate is not None:
        from .simulate_certificate import challenge_certificate as work
    else:
        from .simulate_runs import run_scenario as work
    ctx.exit(work(console, query, asked))
