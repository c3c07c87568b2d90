"""``robustness survey``: one row of facts for each of many networks, with gates over all of them."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from .exit_codes import ExitCode
from .interruption import interruptibly
from .options import jobs_option, json_option, seed_option, talk_options, timeout_option
from .output import Console, pass_console
from .tolerance import MODELS

if TYPE_CHECKING:
    from robustness.surveying import Row, Survey

__all__ = ["SCHEMA", "command"]

SCHEMA = "robustness/survey/1"

#: How rows are written, by the suffix of the file they go to; written out so that --help need not import the library.
_KINDS = {".txt": "table", ".csv": "csv", ".jsonl": "jsonl", ".xml": "junit", ".md": "markdown"}
_NAMES = tuple(_KINDS.values())


@click.command("survey")
@click.argument("paths", nargs=-1, metavar="PATH...")
@click.option(
    "--from",
    "listed",
    type=click.File("r", encoding="utf-8"),
    metavar="FILE",
    help="A file with one PATH a line (# begins a comment); - is standard input.",
)
@click.option("-r", type=click.IntRange(min=0), help="A gate: every network is (R,S)-robust.")
@click.option("-s", type=click.IntRange(min=1), default=None, help="With -r; 1 unless given.")
@click.option("--require", "survive", type=click.IntRange(min=0), metavar="F", help="A gate: F malicious are survived.")
@click.option(
    "--model", "models", type=click.Choice(MODELS), multiple=True, help="Threat models to look at; all unless given."
)
@click.option("--no-models", is_flag=True, help="Only r* and s: no threat model is looked at.")
@click.option("--as", "kind", type=click.Choice(_NAMES), help="How rows are written; told by the suffix of -o.")
@click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE", help="For the rows.")
@click.option(
    "--state",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="A journal of finished rows: the same command goes on where it was stopped or killed.",
)
@click.option(
    "--certificates",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Write a certificate of r* for every network.",
)
@click.option(
    "--total-timeout", type=click.FloatRange(min=0, min_open=True), metavar="SECONDS", help="For all networks together."
)
@json_option
@timeout_option
@jobs_option
@seed_option
@talk_options
@pass_console
@click.pass_context
def command(
    ctx: click.Context,
    console: Console,
    paths: tuple[str, ...],
    listed: TextIO | None,
    r: int | None,
    s: int | None,
    survive: int | None,
    models: tuple[str, ...],
    no_models: bool,
    kind: str | None,
    output: Path | None,
    state: Path | None,
    certificates: Path | None,
    total_timeout: float | None,
    as_json: bool,
    timeout: float | None,
    jobs: int,
    seed: int,
) -> None:
    """What is known about each of many networks, and does every one pass?

    PATH is a file, a folder, a pattern such as 'nets/*.graphml', or topohub names such as 'topohub:sndlib/*'. One row a
    network; one that cannot be read has a row that says why. With -r or --require the exit code is that of the worst
    network: 0 all pass, 30 some undecided, 10 some refuted, 3 some unreadable. --timeout is for one network.
    """
    if s is not None and r is None:
        raise click.UsageError("-s says how many nodes go with -r: give -r as well.")
    if no_models and (models or survive is not None):
        raise click.UsageError("--no-models looks at none: leave out --model and --require, or leave out --no-models.")
    wanted = [*paths, *_listed(listed)]
    if not wanted:
        raise click.UsageError("name a file, a folder, a pattern or topohub names, or a list of them with --from.")
    from robustness.files.writing import require_different_files
    from robustness.surveying import Gate, survey

    require_different_files(wanted, [output, state])
    looked_at = () if no_models else models or MODELS
    line = _Line(console)

    def work() -> Survey:
        return survey(
            wanted,
            models=looked_at,
            gate=Gate(r, 1 if s is None else s, survive),
            time_limit=timeout,
            total_time_limit=total_timeout,
            jobs=jobs,
            seed=seed,
            state=state,
            certificates=certificates,
            on_row=line.note,
        )

    try:
        found: Survey | None = interruptibly(work, None, line.tick)
    except KeyboardInterrupt:
        found = None
    line.wipe()
    _show(console, found, tuple(line.rows), looked_at, kind, output, as_json)
    ctx.exit(ExitCode.INTERRUPTED if found is None else _exit_code(found.worst))


def _show(
    console: Console,
    found: Survey | None,
    finished: tuple[Row, ...],
    models: tuple[str, ...],
    kind: str | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Write and print what is known; ``found`` is None after Ctrl-C, when the finished rows are all there is."""
    from robustness.files.writing import replace_file
    from robustness.surveying.front import Survey
    from robustness.surveying.tables import TABLES

    shown = Survey(finished, models) if found is None else found
    for note in shown.notes:
        console.warn(note)
    kind = kind or ("table" if output is None else _KINDS.get(output.suffix.lower(), "table"))
    content = TABLES[kind](shown.rows, models)
    if output is not None:
        replace_file(output, content.encode())
        console.talk(f"wrote {output} ({len(shown)} networks)")
    if as_json:
        console.document(SCHEMA, shown.as_dict() | {"is_complete": found is not None and not found.missing})
    elif output is None:
        console.result(content.rstrip("\n"))
    if found is None:
        console.error("interrupted: the rows that are printed hold, nothing is claimed about the other networks")
    elif found.missing:
        console.talk(f"undecided: the time limit left {len(found.missing)} networks unasked")


def _exit_code(worst: str) -> ExitCode:
    return {
        "passed": ExitCode.DONE,
        "undecided": ExitCode.UNDECIDED,
        "refuted": ExitCode.REFUTED,
        "error": ExitCode.BAD_INPUT,
    }[worst]


def _listed(stream: TextIO | None) -> list[str]:
    """Return the paths that a list names."""
    if stream is None:
        return []
    try:
        lines = [line.strip() for line in stream]
    except UnicodeDecodeError as problem:
        raise click.UsageError(f"--from: {stream.name} is no UTF-8 text: {problem.reason}") from None
    return [line for line in lines if line and not line.startswith("#")]


class _Line:
    """The progress of a survey on a terminal: how many networks are done, which are left, and the time."""

    def __init__(self, console: Console) -> None:
        is_terminal = sys.stderr is not None and sys.stderr.isatty()
        self._is_shown = is_terminal and not console.is_quiet
        self._started = time.monotonic()
        self._text = "reading"
        self.rows: list[Row] = []

    def note(self, row: Row, finished: int, of: int) -> None:
        """Remember that one more row is finished."""
        self.rows.append(row)
        spent = time.monotonic() - self._started
        left = spent / finished * (of - finished)
        self._text = f"{finished} of {of} networks, about {left:.0f} s left, last {row.network}"

    def tick(self) -> None:
        """Draw the line anew."""
        if self._is_shown:
            spent = time.monotonic() - self._started
            click.echo(f"\r\x1b[K{f'{spent:.0f} s, {self._text}'[:100]}", err=True, nl=False)

    def wipe(self) -> None:
        """Take the line away."""
        if self._is_shown:
            click.echo("\r\x1b[K", err=True, nl=False)
