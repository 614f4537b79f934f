"""The command line: one module for each verb.

Exit status 0; 2 with one line on standard error for bad input; 130 when interrupted; 1 for an error in quatfilt itself.
A traceback appears only with ``--debug``.
"""

import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Annotated

import typer

from quatfilt.cli import _steps
from quatfilt.cli._errors import explained
from quatfilt.cli._output import refuse_to_wrap
from quatfilt.cli.batch import batch
from quatfilt.cli.compare import compare
from quatfilt.cli.database import database
from quatfilt.cli.demo import demo
from quatfilt.cli.denoise import denoise
from quatfilt.cli.evaluate import evaluate
from quatfilt.cli.info import info
from quatfilt.cli.pga import pga
from quatfilt.cli.reconstruct import reconstruct
from quatfilt.cli.segment import segment

app = typer.Typer(
    name="quatfilt",
    help="Clean motion-capture rotations, and measure how clean they are.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command(epilog=_steps.explained())(denoise)
app.command(epilog=_steps.explained())(batch)
app.command()(info)
app.command()(compare)
app.command()(pga)
app.command()(segment)
app.command()(reconstruct)
app.command()(demo)
app.add_typer(database)
app.add_typer(evaluate)


def _show_version(wanted: bool) -> None:  # noqa: FBT001 - the signature of an option's callback
    if wanted:
        typer.echo(f"quatfilt {version('quatfilt')}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _options(
    context: typer.Context,
    *,
    show_version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="Print the version.")
    ] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show where an error comes from; may stand anywhere.")
    ] = False,
) -> None:
    del show_version, debug  # acted upon before the verb
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str or None, default None
        What follows the program's name; None for what the process was started with.

    Returns
    -------
    int
        Exit status.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    refuse_to_wrap(sys.stdout, sys.stderr)
    try:
        status = app(
            [word for word in given if word != "--debug"], prog_name="quatfilt", standalone_mode=False
        )
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        status = 130
    except (BrokenPipeError, SystemExit) as error:
        # Typer makes an exit of a closed pipe. Whoever read the output has seen enough, and Python must not complain
        # at its end about what was not read.
        if isinstance(error, SystemExit) and not isinstance(error.__context__, BrokenPipeError):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0
    except Exception as error:
        if debug:
            raise
        message, status = explained(error)
        sys.stderr.write(f"quatfilt: {message}\n")
    if status == 130:
        sys.stderr.write("quatfilt: interrupted\n")
    return status if isinstance(status, int) else 0


__all__ = ["app", "main"]
