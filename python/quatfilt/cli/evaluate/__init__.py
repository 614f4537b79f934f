"""``quatfilt evaluate``: the papers' tables and figures, measured."""

import typer

from quatfilt.cli.evaluate.bilateral_figs import bilateral_figs
from quatfilt.cli.evaluate.compression import compression
from quatfilt.cli.evaluate.nlpm_table1 import nlpm_table1
from quatfilt.cli.evaluate.pga_figs import pga_figs
from quatfilt.cli.evaluate.reconstruction_tables import reconstruction_tables
from quatfilt.cli.evaluate.robust_denoising import robust_denoising
from quatfilt.cli.evaluate.smooth_goal import smooth_goal
from quatfilt.cli.evaluate.trackers import trackers

evaluate = typer.Typer(
    name="evaluate",
    help="Measure the methods as the papers do.",
    rich_markup_mode=None,
    no_args_is_help=False,
)
evaluate.command("nlpm-table1")(nlpm_table1)
evaluate.command("bilateral-figs")(bilateral_figs)
evaluate.command("pga-figs")(pga_figs)
evaluate.command("reconstruction-tables")(reconstruction_tables)
evaluate.command("smooth-goal")(smooth_goal)
evaluate.command("robust-denoising")(robust_denoising)
evaluate.command("trackers")(trackers)
evaluate.command("compression")(compression)


@evaluate.callback(invoke_without_command=True)
def _which(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


__all__ = ["evaluate"]
