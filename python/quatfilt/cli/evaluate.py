"""``quatfilt evaluate``: the papers' tables, measured."""

import os
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from quatfilt import _validation
from quatfilt.cli import _output

evaluate = typer.Typer(
    name="evaluate",
    help="Measure the methods as the papers do.",
    rich_markup_mode=None,
    no_args_is_help=False,
)


@evaluate.callback(invoke_without_command=True)
def _which(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@evaluate.command("nlpm-table1")
def run_nlpm_table1(
    *,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Folder of CMU's recordings, at any depth. [default: the built-in synthetic walk]",
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(metavar="N", help="How many noises of each kind.")] = 5,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Where the results go.")
    ] = Path("docs/results"),
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="How many processes compute. [default: one per processor]")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON, and nothing else.")
    ] = False,
) -> None:
    """Measure non-local pose means on clips with added noise (Table I of Dean and Lewis).

    Writes nlpm-table1.md, nlpm-table1.json and, with matplotlib, nlpm-table1.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import nlpm_table1, nlpm_table1_page, nlpm_table1_picture, nlpm_table1_report  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.clips import load  # noqa: PLC0415
    from quatfilt.evaluation.noises import NOISES  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    if workers is not None:
        _validation.integer(workers, "--workers", at_least=1)
    clips = load(data)
    output.mkdir(parents=True, exist_ok=True)
    processes = workers or min(os.cpu_count() or 1, len(clips) * len(NOISES))
    with Progress(
        TextColumn("filtering"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
    ) as bar:
        task = bar.add_task("filtering", total=None)
        results = nlpm_table1.run(
            clips,
            seeds=seeds,
            workers=processes,
            progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
    report = nlpm_table1_report.Report(
        clips=clips,
        noises=NOISES,
        results=results,
        seeds=seeds,
        version=version("quatfilt"),
        command=f"quatfilt evaluate nlpm-table1{' --data DIR' if data else ''} --seeds {seeds}",
    )
    numbers = nlpm_table1_report.as_dict(report)
    written, trouble = write(
        output,
        nlpm_table1_report.STEM,
        page=nlpm_table1_page.markdown(report),
        numbers=numbers,
        draw=lambda path: nlpm_table1_picture.draw(report, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("Mean PSNR over the clips, dB")
    _output.print_table(
        ("method", *(noise.name for noise in NOISES)),
        [
            (method, *(_output.number(report.mean(method, noise.name, "psnr")) for noise in report.noises))
            for method in nlpm_table1_report.ROWS
        ],
    )
    for path in written:
        _output.say(f"{path}: written")
    if trouble:
        _output.say(f"no picture: {trouble}")


__all__ = ["evaluate"]
