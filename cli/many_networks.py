"""What the commands about many networks share: which networks, what is asked of each, and how far one is."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from robustness.spelled import counted

from .choices import THREAT_MODEL_NAMES
from .exit_codes import ExitCode
from .interruption import interruptibly
from .named import FILE, FOLDER
from .options import Seconds, asked_reading, complete_files, jobs_option, reading_options, seed_option, timeout_option
from .output import Console

if TYPE_CHECKING:
    from robustness.files import ReadingOptions
    from robustness.surveying import Gate, Row, Survey
    from robustness.surveying.row import Findings

__all__ = [
    "ManyNetworks",
    "exit_code",
    "many_networks_options",
    "require_outputs_apart",
    "run_survey",
    "state_option",
]

#: How many files that could not be read are told one by one where no table shows them.
_MOST_TOLD = 3


class _Listing(click.File):
    """A list of paths, of a file or of standard input."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Open it."""
        if value == "-" and sys.stdin is None:  # as after `<&-` in a shell
            from robustness.errors import UnreadableTopology

            raise UnreadableTopology("standard input: is closed")
        return super().convert(value, param, ctx)


state_option = click.option(
    "--state",
    type=FILE,
    metavar="FILE",
    help="A journal of finished rows: the same command goes on where it was stopped or killed.",
)

_OPTIONS: tuple[Callable[[Any], Any], ...] = (
    click.argument("paths", nargs=-1, metavar="PATH...", shell_complete=complete_files),
    reading_options,
    click.option(
        "--from",
        "listed",
        type=_Listing("r", encoding="utf-8"),
        metavar="FILE",
        help="A file with one PATH a line (# begins a comment); - is standard input.",
    ),
    click.option("-r", type=click.IntRange(min=0), metavar="R", help="A gate: every network is (R,S)-robust."),
    click.option("-s", type=click.IntRange(min=1), metavar="S", default=None, help="With -r; 1 unless given."),
    click.option(
        "--require", "survive", type=click.IntRange(min=0), metavar="F", help="A gate: F malicious are survived."
    ),
    click.option(
        "--model",
        "models",
        type=click.Choice(THREAT_MODEL_NAMES),
        multiple=True,
        help="Threat models to look at; all unless given.",
    ),
    click.option("--no-models", is_flag=True, help="Only r* and s: no threat model is looked at."),
    click.option(
        "--certificates",
        type=FOLDER,
        metavar="DIR",
        help="Write a certificate of r* for every network.",
    ),
    click.option(
        "--total-timeout",
        type=Seconds(),
        metavar="SECONDS",
        help="For all networks together.",
    ),
    timeout_option,
    jobs_option,
    seed_option,
)


@dataclass(frozen=True, slots=True)
class ManyNetworks:
    """Which networks a command is about, and what is asked of each.

    Attributes
    ----------
    paths : tuple of str
    listing : str or None
        The file that named some of them.
    gate : Gate
    models : tuple of str
    certificates : Path or None
    timeout, total_timeout : float or None
    jobs, seed : int
    reading : ReadingOptions
    """

    paths: tuple[str, ...]
    listing: str | None
    gate: Gate
    models: tuple[str, ...]
    certificates: Path | None
    timeout: float | None
    total_timeout: float | None
    jobs: int
    seed: int
    reading: ReadingOptions


def many_networks_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of :class:`ManyNetworks` to a command, which gets one in the keyword ``networks``."""

    @wraps(command)
    def with_networks(
        *arguments: Any,
        paths: tuple[str, ...],
        listed: TextIO | None,
        r: int | None,
        s: int | None,
        survive: int | None,
        models: tuple[str, ...],
        no_models: bool,
        certificates: Path | None,
        total_timeout: float | None,
        timeout: float | None,
        jobs: int,
        seed: int,
        **others: Any,
    ) -> Any:
        if s is not None and r is None:
            raise click.UsageError("-s says how many nodes go with -r: give -r as well.")
        if no_models and (models or survive is not None):
            raise click.UsageError(
                "--no-models looks at none: leave out --model and --require, or leave out --no-models."
            )
        wanted = (*paths, *_lines_of(listed))
        if not wanted and listed is not None:
            raise click.UsageError(f"--from: {listed.name} names no network.")
        if not wanted:
            raise click.UsageError("name a file, a folder, a pattern or topohub names, or a list of them with --from.")
        from robustness.surveying import Gate

        gate = Gate(r, 1 if s is None else s, survive)
        looked_at = () if no_models else models or THREAT_MODEL_NAMES
        networks = ManyNetworks(
            wanted,
            None if listed is None else listed.name,
            gate,
            looked_at,
            certificates,
            timeout,
            total_timeout,
            jobs,
            seed,
            asked_reading(),
        )
        return command(*arguments, networks=networks, **others)

    for option in reversed(_OPTIONS):
        with_networks = option(with_networks)
    return with_networks


def require_outputs_apart(networks: ManyNetworks, outputs: Iterable[Path | None]) -> None:
    """Guarantees that no output is a network, be it named, in a folder or met by a pattern, nor the list of them."""
    from robustness.files.writing import require_different_files
    from robustness.surveying.networks import expand

    outputs = tuple(outputs)
    require_different_files([*networks.paths, networks.listing], outputs)
    if any(output is not None and output.is_file() for output in outputs):
        require_different_files(expand(networks.paths).names, outputs)


def _lines_of(stream: TextIO | None) -> list[str]:
    """Return the paths that a list names."""
    if stream is None:
        return []
    try:
        lines = [line.strip() for line in stream]
    except UnicodeDecodeError as problem:
        raise click.UsageError(f"--from: {stream.name} is no UTF-8 text: {problem.reason}") from None
    return [line for line in lines if line and not line.startswith("#")]


def run_survey(
    console: Console,
    networks: ManyNetworks,
    *,
    state: Path | None = None,
    mending: float = 0.0,
    on_findings: Callable[[Findings], Any] | None = None,
    on_kept: Callable[[Row, Any], bool] | None = None,
    executor: Any = None,
) -> tuple[Survey, bool]:
    """Return the survey of the networks and whether it was interrupted; then it holds the rows that were finished."""
    from robustness.surveying import Survey, survey
    from robustness.surveying.networks import expand

    line = _Line(console)

    def work() -> Survey:
        return survey(
            networks.paths,
            models=networks.models,
            gate=networks.gate,
            time_limit=networks.timeout,
            total_time_limit=networks.total_timeout,
            jobs=networks.jobs,
            seed=networks.seed,
            mending=mending,
            state=state,
            certificates=networks.certificates,
            on_row=line.note,
            on_findings=on_findings,
            on_kept=on_kept,
            reading=networks.reading,
            executor=executor,
        )

    try:
        return interruptibly(work, None, line.tick), False
    except KeyboardInterrupt:
        # Threads finish in any order: the rows are put in that of the networks, and those left out are named.
        rows = {row.network: row for row in line.rows}
        asked = expand(networks.paths)
        finished = tuple(rows[name] for name in asked.names if name in rows)
        missing = tuple(name for name in asked.names if name not in rows)
        return Survey(finished, networks.models, asked.notes, missing), True
    finally:
        line.wipe()


def exit_code(
    console: Console, found: Survey, is_interrupted: bool, written: Iterable[str], *, has_shown_rows: bool
) -> ExitCode:
    """Return the exit code of a survey, and say what was left out and what was written."""
    unread = [] if has_shown_rows else [row.error for row in found.rows if row.error]
    for problem in unread[:_MOST_TOLD]:
        console.warn(problem)
    if len(unread) > _MOST_TOLD:
        console.warn(f"{len(unread) - _MOST_TOLD} more could not be read: their rows say why")
    for line in written:
        console.talk(line)
    if is_interrupted:
        console.error("interrupted: the rows that are shown hold, nothing is claimed about the other networks")
        return ExitCode.INTERRUPTED
    if found.missing:
        console.talk(f"undecided: the time limit left {counted(len(found.missing), 'network')} unasked")
    return {
        "passed": ExitCode.DONE,
        "undecided": ExitCode.UNDECIDED,
        "refuted": ExitCode.REFUTED,
        "error": ExitCode.BAD_INPUT,
    }[found.worst]


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
        self._text = f"{finished} of {counted(of, 'network')}, about {left:.0f} s left, last {row.network}"

    def tick(self) -> None:
        """Draw the line anew."""
        if self._is_shown:
            from robustness.printable import printable

            text = printable(f"{time.monotonic() - self._started:.0f} s, {self._text}")
            click.echo(f"\r\x1b[K{text[: shutil.get_terminal_size().columns - 1]}", err=True, nl=False)

    def wipe(self) -> None:
        """Take the line away."""
        if self._is_shown:
            click.echo("\r\x1b[K", err=True, nl=False)
