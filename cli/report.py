"""``robustness report``: one self-contained page about many networks."""

from __future__ import annotations

from pathlib import Path

import click

from robustness.spelled import counted

from .many_networks import (
    ManyNetworks,
    exit_code,
    many_networks_options,
    require_outputs_apart,
    run_survey,
    state_option,
)
from .named import FILE
from .options import ReadingCommand, Seconds, json_option
from .output import Console
from .query import speaking

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/report/1"


@click.command("report", cls=ReadingCommand, short_help="Write one HTML page about many networks.")
@many_networks_options
@click.option(
    "-o",
    "--output",
    required=True,
    type=FILE,
    metavar="FILE.html",
    help="For the page.",
)
@click.option("--title", default="Robustness report", show_default=True, help="The heading of the page.")
@click.option("--no-pictures", is_flag=True, help="Neither networks nor attacks are drawn: a smaller page.")
@state_option
@click.option(
    "--mending",
    type=Seconds(can_be_none=True),
    default=5.0,
    show_default=True,
    metavar="SECONDS",
    help="For each network, to find links that give it what it lacks; 0 proposes none.",
)
@json_option
@speaking
def command(
    ctx: click.Context,
    console: Console,
    networks: ManyNetworks,
    output: Path,
    title: str,
    no_pictures: bool,
    state: Path | None,
    mending: float,
    as_json: bool,
) -> None:
    """Write one HTML page about many networks, for somebody who will not open a terminal.

    PATH is as for survey. The page is one file that loads nothing: the verdict in words, the networks as rows to sort,
    and for each its picture with the weakest pair, what it survives, the attack that splits it, to play, the links that
    would mend it, and how to verify its certificate. The verdict is printed as well, and the exit code is that of
    survey: of the worst network.
    """
    from robustness.reporting.front import Kept, report_of, require_drawing
    from robustness.reporting.wording import headline

    require_drawing(not no_pictures)
    require_outputs_apart(networks, [output, state])
    kept = Kept(not no_pictures)
    found, is_interrupted = run_survey(
        console, networks, state=state, mending=mending, on_findings=kept.add, on_kept=kept.take
    )
    made = report_of(found, dict(kept.sections), title=title, gate=networks.gate)
    made.write(output)
    told = headline(found, networks.gate)
    if as_json:
        is_complete = not is_interrupted and not found.missing
        content = {"output": str(output), "verdict": told, **made.as_dict(), "is_complete": is_complete}
        console.document(SCHEMA, content)
    else:
        console.result(told)
    written = [f"wrote {output} ({counted(len(found), 'network')})"]
    ctx.exit(exit_code(console, found, is_interrupted, written, has_shown_rows=as_json))
