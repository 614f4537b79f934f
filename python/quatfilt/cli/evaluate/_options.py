"""Options and habits that the measurements share."""

import contextlib
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, TypeAlias

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from quatfilt.cli import _output

Data: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Folder of CMU's recordings, at any depth. [default: the built-in synthetic walk]"
    ),
]
Seeds: TypeAlias = Annotated[
    int, typer.Option(metavar="N", help="Number of random seeds of each kind of noise.")
]
Output: TypeAlias = Annotated[
    Path, typer.Option("--output", "-o", metavar="DIR", help="Folder of the results.")
]
Workers: TypeAlias = Annotated[
    int | None, typer.Option(metavar="N", help="Number of processes. [default: one per processor]")
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print the results as JSON only.")]

RESULTS = Path("docs/results")


@contextlib.contextmanager
def progress(what: str) -> Iterator[Callable[[int, int], None]]:
    """Show on a terminal how many of how many pieces are done."""
    with Progress(
        TextColumn(what),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
    ) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def say_written(written: Sequence[Path], trouble: str) -> None:
    """Say which files there are, and why one is not."""
    for path in written:
        _output.say(f"{path}: written")
    if trouble:
        _output.say(f"no picture: {trouble}")


__all__ = ["RESULTS", "Data", "Json", "Output", "Seeds", "Workers", "progress", "say_written"]
