"""``robustness survey``: one row of facts for each of many networks, with gates over all of them."""

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
from .output import Console, terminal_width
from .query import cluster_option, joined_cluster, speaking

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/survey/1"

#: How rows are written, by the suffix of the file they go to; written out so that --help need not import the library.
_KINDS = {".txt": "table", ".csv": "csv", ".jsonl": "jsonl", ".xml": "junit", ".md": "markdown"}
_NAMES = tuple(_KINDS.values())


@click.command("survey", cls=ReadingCommand, short_help="One row of facts for each of many networks with gates.")
@many_networks_options
@click.option("--as", "kind", type=click.Choice(_NAMES), help="How rows are written; told by the suffix of -o.")
@click.option("-o", "--output", type=FILE, metavar="FILE", help="For the rows.")
@state_option
@click.option(
    "--mending",
    type=Seconds(can_be_none=True),
    default=0.0,
    metavar="SECONDS",
    help="For each network of up to 80 nodes, to find the fewest links that give it what is required (or one more r).",
)
@cluster_option
@json_option
@speaking
def command(
    ctx: click.Context,
    console: Console,
    networks: ManyNetworks,
    kind: str | None,
    output: Path | None,
    state: Path | None,
    mending: float,
    cluster: str | None,
    as_json: bool,
) -> None:
    """What is known about each of many networks, and does every one pass?

    PATH is a file, a folder, a pattern such as 'nets/*.graphml', or topohub names such as 'topohub:sndlib/*'. One row a
    network; one that cannot be read has a row that says why. With -r or --require the exit code is that of the worst
    network: 0 all pass, 30 some undecided, 10 some refuted, 3 some unreadable. --timeout is for one network.
    """
    from robustness.files.writing import replace_file
    from robustness.reporting.wording import headline
    from robustness.surveying.fitting import fitted
    from robustness.surveying.tables import TABLES

    require_outputs_apart(networks, [output, state])
    executor = None if cluster is None else joined_cluster(cluster)
    found, is_interrupted = run_survey(console, networks, state=state, mending=mending, executor=executor)
    for note in found.notes:
        console.warn(note)
    kind = kind or ("table" if output is None else _KINDS.get(output.suffix.lower(), "table"))
    content = TABLES[kind](found.listed, found.models)
    written = []
    if output is not None:
        replace_file(output, content.encode())
        written.append(f"wrote {output} ({counted(len(found), 'network')})")
    if as_json:
        is_complete = not is_interrupted and not found.missing
        console.document(SCHEMA, found.as_dict() | {"is_complete": is_complete})
    elif output is None and console.is_quiet and kind == "table":
        console.result(headline(found, networks.gate))
    else:
        if output is None:
            columns = terminal_width()
            if kind == "table" and columns is not None:
                content = fitted(found.listed, found.models, columns)
            console.content(content.rstrip("\n"))
        console.talk(headline(found, networks.gate))
    ctx.exit(exit_code(console, found, is_interrupted, written, has_shown_rows=as_json or output is None))
