"""Groups of commands whose errors suggest what a mistyped name probably meant."""

from __future__ import annotations

import difflib

import click

__all__ = ["SuggestingGroup"]


class SuggestingGroup(click.Group):
    """A group that answers a mistyped command with the ones most like it."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; the error about a mistyped name suggests what was probably meant."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as problem:
            close = difflib.get_close_matches(args[0], self.list_commands(ctx), cutoff=0.5)
            if not close:
                raise
            meant = f"{problem.message.rstrip('.')}: did you mean {' or '.join(close)}?"
            raise click.UsageError(meant, ctx) from None
