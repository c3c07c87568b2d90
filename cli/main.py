"""The group ``robustness``: finds commands when they are called for, and turns every exception into an exit code."""

from __future__ import annotations

import importlib
import importlib.util
import os
import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import click

from .exit_codes import ExitCode
from .interruption import end_process
from .options import talk_options
from .output import Console, pass_console
from .suggesting import SuggestingGroup

__all__ = ["COMMANDS", "main", "robustness"]

#: Every command and where it lives, counted from this package, which goes by two names (docs/adr/0005). A module is
#: imported when its command is called or listed, not before.
COMMANDS: Mapping[str, str] = MappingProxyType(
    {
        "check": ".check:command",
        "certify": ".certify:command",
        "verify": ".verify:command",
        "joint": ".joint:command",
        "tolerance": ".tolerance:command",
        "build": ".build:command",
        "find": ".find:command",
        "simulate": ".simulate:command",
        "attack": ".attack:command",
        "sample": ".sample:command",
        "survey": ".survey:command",
        "report": ".report:command",
        "draw": ".draw:command",
        "mend": ".mend:command",
        "thin": ".thin:command",
    }
)


class CommandTable(SuggestingGroup):
    """A group that looks commands up in :data:`COMMANDS` and ends every one of them in an :class:`ExitCode`."""

    def make_context(self, *arguments: Any, **options: Any) -> click.Context:
        """Read the words before the command; Ctrl-C meanwhile is what it is later, not click's "Aborted!"."""
        try:
            return super().make_context(*arguments, **options)
        except KeyboardInterrupt as stop:
            raise SystemExit(_report(Console(), stop)) from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands whose modules are there, in the order of the table."""
        places = ((name, place.partition(":")[0]) for name, place in COMMANDS.items())
        return [name for name, module in places if importlib.util.find_spec(module, __package__)]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return one command."""
        if cmd_name not in self.list_commands(ctx):
            return None
        module, _, attribute = COMMANDS[cmd_name].partition(":")
        command: click.Command = getattr(importlib.import_module(module, __package__), attribute)
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Remember whether the answer, and so an error as well, is to be JSON."""
        ctx.ensure_object(Console).as_json = "--json" in args[: args.index("--") if "--" in args else None]
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; whatever it raises ends in one line on standard error and an exit code.

        With --json an error is a document on standard output as well.
        """
        console = ctx.ensure_object(Console)
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: console.warn(str(message))
            warnings.simplefilter("once", UserWarning)  # the base of GraphWarning, whose import is not needed here
            try:
                return super().invoke(ctx)
            except click.UsageError as problem:
                from robustness.printable import printable

                message = _in_words(printable(problem.format_message(), "\n"))
                console.error_document(problem.exit_code, message)
                raise click.UsageError(message, problem.ctx) from None
            except click.ClickException as problem:
                console.error_document(problem.exit_code, problem.format_message())
                raise
            except (click.exceptions.Exit, click.Abort):
                raise
            except (Exception, KeyboardInterrupt) as problem:  # noqa: BLE001 - the one place that maps them all
                ctx.exit(_report(console, problem))


#: What click says of a value that is no number, and what people say.
_KINDS_OF_NUMBERS = {"valid integer range": "whole number", "valid integer": "whole number"} | {
    "valid float range": "number", "valid float": "number",
}  # fmt: skip


def _in_words(message: str) -> str:
    for kind, word in _KINDS_OF_NUMBERS.items():
        message = message.replace(f" is not a {kind}.", f" is not a {word}.")
    return message


def _report(console: Console, problem: BaseException) -> ExitCode:
    """Say what went wrong in one line, with a traceback where -v asks for it, and return the exit code."""
    code = ExitCode.of_exception(problem)
    if console.is_verbose:
        import traceback

        console.error("".join(traceback.format_exception(problem)).rstrip())
    match code:
        case ExitCode.INTERRUPTED:
            where = f" at {problem}" if str(problem) else ""
            message = f"interrupted{where}: nothing is claimed"
        case _ if isinstance(problem, MemoryError):
            message = "undecided: out of memory: nothing is claimed"
        case ExitCode.UNDECIDED:
            message = f"undecided: {problem}"
        case ExitCode.INTERNAL_ERROR:
            hint = "" if console.is_verbose else "; -v shows where"
            message = f"internal error, not a verdict: {type(problem).__name__}: {problem}{hint}"
        case _ if isinstance(problem, RuntimeError) and code == ExitCode.USAGE:
            message = f"error: {problem}: give fewer --jobs"
        case _ if isinstance(problem, OSError) and problem.filename is not None:
            message = f"error: cannot write {os.fsdecode(problem.filename)}: {problem.strerror}"
        case _:
            message = f"error: {problem}"
    console.error(message)
    console.error_document(code, message.removeprefix("error: ").removeprefix("undecided: "))
    return code


def _print_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        from importlib.metadata import PackageNotFoundError, version

        try:
            number = version("graph-robustness")
        except PackageNotFoundError:  # run from the sources
            number = "(not installed)"
        click.echo(f"robustness {number}")
        ctx.exit(ExitCode.DONE)


@click.group(cls=CommandTable, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the version and exit.",
)
@talk_options
@pass_console
def robustness(console: Console) -> None:
    """How many malicious nodes can resilient consensus survive on this network?

    GRAPH is a file (.json, .graphml, .gexf, .gml, .dot, .net, .edgelist, .txt, .csv, .npy, .mtx, .g6, ...), - for
    node-link JSON on standard input, or a name such as topohub:topozoo/Abilene. docs/formats.md says how each is read.

    \b
    Exit codes: 0 proven or done   10 refuted     30 undecided   2 usage
                3 bad input        1 a bug, never a verdict      130 interrupted
    """


def main() -> None:
    """Run the command line; the entry point of the distribution."""
    if "_ROBUSTNESS_COMPLETE" in os.environ:
        from .completion import mend_completion

        mend_completion()
    try:
        robustness(prog_name="robustness")
    except SystemExit as end:
        end_process(end.code if isinstance(end.code, int) else ExitCode.DONE)
    except OSError as problem:  # help or version that cannot be printed
        Console().error(f"error: cannot write standard output: {problem.strerror}")
        end_process(ExitCode.USAGE)
