"""``quatfilt database``: the poses that motion is reconstructed from."""

import typer

from quatfilt.cli.database.build import build
from quatfilt.cli.database.info import info

database = typer.Typer(
    name="database",
    help="Make databases of poses, and look into them.",
    rich_markup_mode=None,
    no_args_is_help=False,
)
database.command()(build)
database.command()(info)


@database.callback(invoke_without_command=True)
def _which(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


__all__ = ["database"]
