"""Groups whose error about a mistyped name says what was probably meant, in the word that the group goes by."""

from __future__ import annotations

import difflib

import click

__all__ = ["SuggestingGroup"]


class SuggestingGroup(click.Group):
    """A group of commands that are called ``noun``; ``where`` says where all their names stand."""

    noun = "command"
    where = "robustness --help lists them"

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; the error about a mistyped name suggests what was probably meant."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError:
            if args[0].startswith("-"):
                raise
            close = difflib.get_close_matches(args[0], self.list_commands(ctx), cutoff=0.5)
            told = f"did you mean {' or '.join(close)}?" if close else f"{self.where}."
            raise click.UsageError(f"No such {self.noun} {args[0]!r}: {told}", ctx) from None
