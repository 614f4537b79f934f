"""``quatfilt database build``: folders of motion files in, a database out."""

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from quatfilt import _validation
from quatfilt.cli import _options, _output
from quatfilt.cli.database._describe import describe, summary
from quatfilt.formats._atomic import folder_beside
from quatfilt.formats._table import READABLE, listed
from quatfilt.reconstruction.database import MotionDatabase, building
from quatfilt.reconstruction.database.body import OtherJointsError
from quatfilt.reconstruction.database.folders import Folders
from quatfilt.reconstruction.database.takes import How


def build(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR|FILE…",
            help=f"Motion files ({listed(READABLE)}), and folders that are searched for them at any depth.",
            show_default=False,
        ),
    ],
    *,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DB", help="Database file to write.", show_default=False),
    ],
    fps: Annotated[
        float, typer.Option("--fps", metavar="HZ", help="Frames per second of the database.")
    ] = 60.0,
    mirror: Annotated[
        bool, typer.Option("--mirror", help="Add the mirror image of every clip, left and right exchanged.")
    ] = False,
    up: Annotated[str, typer.Option("--up", metavar="x|y|z", help="Vertical axis: y, or z for AMASS.")] = "y",
    source_fps: Annotated[
        float | None,
        typer.Option(
            "--source-fps", metavar="HZ", help="Frames per second of the files, instead of the rate in them."
        ),
    ] = None,
    skip_others: Annotated[
        bool,
        typer.Option(
            "--skip-others", help="Leave out files of other joints than most; by default they are refused."
        ),
    ] = False,
    max_gap: Annotated[
        float,
        typer.Option(
            "--max-gap",
            metavar="SECONDS",
            help="Longest run of missing samples that is filled; at longer ones, clips are cut.",
        ),
    ] = 0.1,
    min_length: Annotated[
        float,
        typer.Option("--min-length", metavar="SECONDS", help="Clips that are shorter are left out."),
    ] = 0.5,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            metavar="N",
            help="Number of files that are read at once. [default: one per processor]",
        ),
    ] = None,
    graph: Annotated[
        bool,
        typer.Option(
            "--graph",
            help="Add the graph of neighbours; it takes a few minutes for a million poses.",
        ),
    ] = False,
    json: _options.Json = False,
) -> None:
    """Make a database of the poses of many motion files.

    Files that cannot be read, and clips that are too short, are left out, and said to be. The database is written under a
    temporary name and renamed: whatever interrupts it leaves the file that was there before.
    """
    how = How.checked(fps=fps, up=up, max_gap=max_gap, min_length=min_length)
    source = Folders(
        inputs,
        source_fps=None if source_fps is None else _validation.number(source_fps, "--source-fps", above=0),
        skip_others=skip_others,
        workers=None if workers is None else _validation.integer(workers, "--workers", at_least=1),
    )
    with _place(output, graph=graph) as place, _progress(len(source)) as bar:
        try:
            building.to_file(
                source,
                how,
                str(place),
                mirror=mirror,
                progress=lambda done, _total: bar.update(bar.task_ids[0], completed=done),
            )
        except OtherJointsError as error:
            raise ValueError(f"{error}; --skip-others leaves out files of other joints than most") from None
        if graph:
            poses = MotionDatabase.open(place)
            poses.build_graph()
            poses.save(output)
            del poses  # some systems do not delete a file that is mapped
    db = MotionDatabase.open(output)
    if json:
        _output.print_json(describe(output, db))
        return
    for note in db.notes:
        _output.say(note)
    _output.say(f"{summary(output, db)}, written")


@contextlib.contextmanager
def _place(output: Path, *, graph: bool) -> Iterator[Path]:
    """Say where poses are written: elsewhere where a graph follows, for what has no graph is not what was asked for."""
    if not graph:
        yield output
        return
    with folder_beside(str(output)) as folder:
        yield folder / output.name


def _progress(total: int) -> Progress:
    columns = (TextColumn("reading"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), transient=True)
    bar.add_task("reading", total=total)
    return bar


__all__ = ["build"]
