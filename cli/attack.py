"""``robustness attack``: an attack that splits the network for ever, made from evidence and carried out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .choices import THREAT_MODEL_NAMES
from .exit_codes import ExitCode
from .named import FILE
from .options import ReadingCommand, graph_argument, load_graph
from .output import Console, ProgressLine, graph_document
from .query import Query, query_options

if TYPE_CHECKING:
    from robustness.simulation.attacks import Attack
    from robustness.simulation.finding import Finding

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/attack-result/1"

#: An attack repeats after two steps: a few are as good as many.
_STEPS = 12


@click.command("attack", cls=ReadingCommand, short_help="Find an attack of F nodes that splits GRAPH and carry it out.")
@graph_argument
@click.option(
    "-f", "f", type=click.IntRange(min=0), metavar="F", default=1, show_default=True, help="How many nodes may lie."
)
@click.option(
    "--model",
    type=click.Choice(THREAT_MODEL_NAMES),
    default="malicious",
    show_default=True,
    help="One lie for all; different lies (byzantine); or delays that show two faces. -local: F around every node.",
)
@click.option(
    "-T", "--sampling-period", "period", type=float, metavar="T", help="With these three: is agreement promised ..."
)
@click.option("--alpha", type=float, metavar="A", help="... for nodes with this gain, 1.5/T unless given, ...")
@click.option(
    "--sigma",
    type=float,
    metavar="S",
    help="... whose kept weights, 1/d unless given, add up to at most this?",
)
@click.option(
    "--steps",
    type=click.IntRange(min=1),
    metavar="N",
    default=_STEPS,
    show_default=True,
    help="How long it is played; it repeats after two.",
)
@click.option("-o", "--output", type=FILE, metavar="FILE", help="Write it.")
@click.option("--expect", type=click.Choice(("agreement", "split")), help="Exit with 10 when it ends otherwise.")
@query_options(algorithm=True)
def command(
    ctx: click.Context,
    console: Console,
    query: Query,
    source: str,
    f: int,
    model: str,
    period: float | None,
    alpha: float | None,
    sigma: float | None,
    steps: int,
    output: Path | None,
    expect: str | None,
) -> None:
    """Find an attack of F nodes that splits GRAPH, carry it out, and write it to a file for 'simulate --attack'.

    Exit code 0 when the attack splits the network exactly, for all gains; 10 when it is proven that F nodes cannot, for
    the rules and gains that the answer names; 30 undecided, or the gains given lie outside the theory. With --expect: 0
    for that outcome and 10 for the other.
    """
    from robustness.files.writing import replace_file, require_different_files
    from robustness.simulation.finding import find_attack

    require_different_files([source], [output])
    graph = load_graph(source)
    with ProgressLine(console) as line:

        def work() -> Finding:
            found = find_attack(
                graph, f, model, algorithm=query.algorithm, T=period, alpha=alpha, sigma=sigma, **query.effort(line)
            )
            if found.attack is not None:
                _carry_out(found.attack, steps)
            return found

        found = query.wait_for(work, line)
    if query.as_json:
        attack = None if found.attack is None else found.attack.as_dict()
        content = {"f": f, "model": model, "outcome": found.outcome, "reason": found.reason, "attack": attack}
        console.document(SCHEMA, {"graph": graph_document(graph), **content})
    else:
        color = {"agreement": "green", "split": "red", "undecided": "yellow"}[found.outcome]
        console.result(f"{click.style(found.outcome + ':', fg=color, bold=True)} {found.reason}")
    if output is not None and found.attack is None:
        console.talk(f"not written: {output}, as no attack is known")
    elif output is not None and found.attack is not None:
        replace_file(output, (json.dumps(found.attack.as_dict(), indent=1) + "\n").encode())
        console.talk(f"wrote {output}")
    ctx.exit(ExitCode.of_outcome(found.outcome, expect or "split"))


def _carry_out(attack: Attack, steps: int) -> None:
    """Run the attack under every rule it is made for; anything but an exact split is a bug."""
    from robustness.errors import InternalError

    for rule in ("adp-msr", "w-msr") if attack.delayed else ("adp-msr", "dp-msr", "w-msr"):
        if not attack.run(steps, rule=rule).exact:
            raise InternalError(f"an attack made from checked evidence did not split under {rule}: please report")
