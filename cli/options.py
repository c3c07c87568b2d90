"""Options and arguments that several commands share, each a decorator, so that they mean the same everywhere."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
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
    "Seconds",
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
        expose_value=False,
        callback=_keep,
        help=f"What the file is, whatever its suffix: {', '.join(FORMAT_NAMES)}.",
    ),
    click.option(
        "--directed/--undirected",
        default=None,
        expose_value=False,
        callback=_keep,
        help="Links of which the file says nothing run one way; or all run both ways.  [default: as the file says]",
    ),
    click.option(
        "--label-attribute",
        metavar="NAME",
        expose_value=False,
        callback=_keep,
        help="The attribute that names the nodes; id for what the file tells them apart by.",
    ),
    click.option(
        "--rows",
        type=click.Choice(["speak", "hear"]),
        expose_value=False,
        callback=_keep,
        help="Row u of a matrix says who hears u (speak), or whom u hears.  [default: speak]",
    ),
    click.option(
        "--columns",
        metavar="source=N,target=N",
        expose_value=False,
        callback=_keep_columns,
        help="Where the ends of links stand in a table: numbers from 1, or names; for contacts time=N as well.",
    ),
    click.option(
        "--skip-lines",
        type=click.IntRange(min=0),
        metavar="N",
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
    type=click.IntRange(min=0, max=2**63 - 1),
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
        write_help(ctx.get_help())
        ctx.exit()


# Not click's own, which knows no full disk.
_help_option = click.help_option("-h", "--help", callback=_print_help)


def talk_options(command: _Command) -> _Command:
    """Add -q, -v, --color and --help, which may stand before or after the command's name."""
    return _quiet_option(_verbose_option(_color_option(_help_option(command))))
