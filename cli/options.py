"""Options and arguments that several commands share, each a decorator, so that they mean the same everywhere."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .choices import ALGORITHM_NAMES, FORMAT_NAMES
from .output import Console, write_help

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from robustness.digraph import Digraph
    from robustness.files.found import ReadingOptions
    from robustness.time_varying import TimeVaryingGraph

__all__ = [
    "ReadingCommand",
    "Seconds",
    "Seed",
    "algorithm_option",
    "asked_reading",
    "complete_files",
    "graph_argument",
    "jobs_option",
    "json_option",
    "load_graph",
    "load_sequence",
    "reading_options",
    "seed_option",
    "talk_options",
    "timeout_option",
]

_Command = TypeVar("_Command", bound=Callable[..., Any])


class Seconds(click.ParamType):  # type: ignore[type-arg]  # generic only from click 8.4 on
    """A positive, finite number of seconds, or none at all where that says that a part is left out."""

    name = "seconds"

    def __init__(self, *, can_be_none: bool = False) -> None:
        self._can_be_none = can_be_none

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return ``value`` as a number; NaN, infinity and what is below are refused."""
        try:
            seconds = float(value)
        except ValueError:
            seconds = math.nan
        if not (math.isfinite(seconds) and (seconds > 0 or (self._can_be_none and seconds == 0))):
            kind = (
                "finite number of seconds of at least 0" if self._can_be_none else "positive, finite number of seconds"
            )
            self.fail(f"{value!r} is not a {kind}.", param, ctx)
        return seconds


class Seed(click.ParamType):  # type: ignore[type-arg]
    """A seed of random choices, as every generator takes it. A range of this size would say nothing in --help."""

    name = "seed"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return ``value`` as a number of 0 to 2^63 - 1."""
        try:
            seed = int(value)
        except ValueError:
            seed = -1
        if not 0 <= seed < 2**63:
            self.fail(f"{value!r} is not a whole number of 0 to 2^63 - 1.", param, ctx)
        return seed


class _ReadingOption(click.Option):
    """An option that says how a file is read."""


class ReadingCommand(click.Command):
    """A command about networks: --help begins with what it does, and how their files are read comes last."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options of the command, and in a section of their own those that say how files are read."""
        options = [each for each in self.get_params(ctx) if isinstance(each, click.Option)]
        shown = [(each, _record(each, ctx)) for each in options]
        for title, is_about_reading in (("Options", False), ("How files are read", True)):
            records = [
                record for each, record in shown if record and isinstance(each, _ReadingOption) is is_about_reading
            ]
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def _record(option: click.Option, ctx: click.Context) -> tuple[str, str] | None:
    """Return what --help says of an option; of a choice that no line holds its names stand in the text."""
    record = option.get_help_record(ctx)
    if record is None or len(record[0]) <= 40 or not isinstance(option.type, click.Choice):
        return record
    *names, last = map(str, option.type.choices)
    left = record[0].partition("[")[0] + "NAME"
    return left, f"{', '.join(names)} or {last}. {record[1]}"


#: Where the reading options of a command are kept, in click's context.
_READING = "robustness.reading"


def _keep(ctx: click.Context, param: click.Parameter, value: Any) -> None:
    if value is not None:
        ctx.meta.setdefault(_READING, {})[param.name] = value


def _keep_columns(ctx: click.Context, param: click.Parameter, value: str | None) -> None:
    if value is not None:
        from robustness.files.found import parsed_columns

        _keep(ctx, param, parsed_columns(value))


_READING_OPTIONS: tuple[Callable[[Any], Any], ...] = (
    click.option(
        "--format",
        metavar="NAME",
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep,
        help=f"What the file is, whatever its suffix: {', '.join(FORMAT_NAMES)}.",
    ),
    click.option(
        "--directed/--undirected",
        default=None,
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep,
        help="Links of which the file says nothing run one way; or all run both ways; as the file says unless given.",
    ),
    click.option(
        "--label-attribute",
        metavar="NAME",
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep,
        help="The attribute that names the nodes; id for what the file tells them apart by.",
    ),
    click.option(
        "--rows",
        type=click.Choice(["speak", "hear"]),
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep,
        help="Row u of a matrix says who hears u (speak), or whom u hears; speak unless given.",
    ),
    click.option(
        "--columns",
        metavar="source=N,target=N",
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep_columns,
        help="Where the ends of links stand in a table: numbers from 1, or names; for contacts time=N as well.",
    ),
    click.option(
        "--skip-lines",
        type=click.IntRange(min=0),
        metavar="N",
        cls=_ReadingOption,
        expose_value=False,
        callback=_keep,
        help="So many lines at the beginning of a text are no links.",
    ),
)


def reading_options(command: _Command) -> _Command:
    """Add what every command understands that reads a network: how its file is to be read."""
    wrapped: Any = command
    for option in reversed(_READING_OPTIONS):
        wrapped = option(wrapped)
    return wrapped  # type: ignore[no-any-return]  # each option returns what it is given


def graph_argument(command: _Command) -> _Command:
    """Add the argument GRAPH, as ``source``, and the reading options."""
    return click.argument("source", metavar="GRAPH", shell_complete=complete_files)(reading_options(command))


def complete_files(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Leave the names of files to the shell: what an argument means is settled by its reader, not by click."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(incomplete, type="file")]


def asked_reading() -> ReadingOptions:
    """Return the reading options of the command that runs."""
    from robustness.files.found import ReadingOptions

    return ReadingOptions(**click.get_current_context().meta.get(_READING, {}))


json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON document with a schema key.")

timeout_option = click.option(
    "--timeout", type=Seconds(), metavar="SECONDS", help="Stop after this time; what is not decided is undecided."
)

jobs_option = click.option(
    "--jobs", type=click.IntRange(min=1), default=1, show_default=True, metavar="N", help="Threads."
)

seed_option = click.option(
    "--seed",
    type=Seed(),
    default=0,
    show_default=True,
    metavar="N",
    help="Of every random choice; it never changes a verdict.",
)

algorithm_option = click.option(
    "--algorithm",
    type=click.Choice(ALGORITHM_NAMES),
    default="auto",
    show_default=True,
    help="The exact algorithm; all give the same verdict.",
)


def load_graph(source: str) -> Digraph:
    """Return the graph that GRAPH means; see :func:`robustness.files.read_topology`."""
    from robustness.files.front import read_with

    graph = read_with(source, asked_reading())
    click.get_current_context().ensure_object(Console).note_reading(graph.read_as)
    return graph


def load_sequence(source: str, **how: Any) -> TimeVaryingGraph:
    """Return the sequence that GRAPH means; see :func:`robustness.time_varying.read_sequence`, which takes ``how``."""
    from robustness.time_varying import read_sequence

    sequence = read_sequence(source, reading=asked_reading(), **how)
    click.get_current_context().ensure_object(Console).note_reading(sequence.read_as)
    return sequence


def _set_color(ctx: click.Context, _: click.Parameter, when: str | None) -> None:
    if when is None and ctx.parent is not None:
        return  # the group has settled it
    automatic = False if os.environ.get("NO_COLOR") else None
    color = {"always": True, "never": False}.get(when or "auto", automatic)
    for each in (ctx, ctx.find_root()):
        each.color = color


def _set_verbose(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        ctx.ensure_object(Console).is_verbose = True


def _set_quiet(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        ctx.ensure_object(Console).is_quiet = True


_quiet_option = click.option(
    "-q", "--quiet", is_flag=True, expose_value=False, callback=_set_quiet, help="Only results and errors."
)
_verbose_option = click.option(
    "-v", "--verbose", is_flag=True, expose_value=False, callback=_set_verbose, help="Say more, in full."
)
_color_option = click.option(
    "--color",
    type=click.Choice(["auto", "always", "never"]),
    expose_value=False,
    callback=_set_color,
    help="Colour; auto means on a terminal, unless NO_COLOR is set.",
)


def _print_help(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        formatter = _WholeWords(width=ctx.terminal_width, max_width=ctx.max_content_width)
        ctx.command.format_help(ctx, formatter)
        write_help(formatter.getvalue().rstrip("\n"))
        ctx.exit()


class _WholeWords(click.HelpFormatter):
    """Writes help whose lines never end within a name such as ``byzantine-local``."""

    #: The hyphen at which no line ends, while lines are made.
    _FIRM = "\N{NON-BREAKING HYPHEN}"

    def write_text(self, text: str) -> None:
        """Write a paragraph."""
        super().write_text(text.replace("-", self._FIRM))

    def write_dl(self, rows: Iterable[tuple[str, str]], col_max: int = 30, col_spacing: int = 2) -> None:
        """Write a list of terms and what they mean."""
        firm = [(term, text.replace("-", self._FIRM)) for term, text in rows]
        super().write_dl(firm, col_max, col_spacing)

    def getvalue(self) -> str:
        """Return what was written."""
        return super().getvalue().replace(self._FIRM, "-")


# Not click's own, which knows no full disk.
_help_option = click.help_option("-h", "--help", callback=_print_help)


def talk_options(command: _Command) -> _Command:
    """Add -q, -v, --color and --help, which may stand before or after the command's name."""
    return _quiet_option(_verbose_option(_color_option(_help_option(command))))
