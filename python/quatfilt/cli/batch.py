"""``quatfilt batch``: folders of noisy files in, a folder of clean ones out."""

import json as standard_json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from quatfilt import _validation
from quatfilt.cli import _cleaning, _errors, _options, _output, _steps
from quatfilt.cli._batch import Task, done
from quatfilt.errors import FileAccessError
from quatfilt.formats._table import READABLE, WRITABLE, listed, written_as

_LOG = "quatfilt-batch.jsonl"


def batch(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR|FILE…", help="Folders, searched at any depth, and motion files.", show_default=False
        ),
    ],
    *,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="Folder to write to, with the folders below DIR.",
            show_default=False,
        ),
    ],
    method: _steps.Method = None,
    preset: _steps.PresetName = None,
    option: _steps.Options = None,
    gaps: _steps.Gaps = None,
    max_gap: _steps.MaxGap = None,
    translation: _steps.Translation = True,
    feet: _steps.Feet = "keep",
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="bvh|npz", help="Format to write. [default: that of the input, .bvh for .amc]"
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Clean files again whose output exists.")] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Number of files that are cleaned at once. [default: one per processor]"
        ),
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help=f"File to which one line of JSON per input is appended. [default: OUT/{_LOG}]",
        ),
    ] = None,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    json: Annotated[bool, typer.Option("--json", help="Print one line of JSON per file only.")] = False,
) -> None:
    """Clean many motion files, several at once.

    An existing output is kept, so an interrupted run continues. Files are written under temporary names and renamed: none
    is half written. After a failed file the remaining files are still processed; the exit status is then 2.
    """
    wish = _steps.asked(method, preset, option, {"gaps": gaps, "max_gap": max_gap})
    _steps.planned(wish)
    how = _cleaning.How(wish, translation, fps, skeleton, first_frame, feet=_steps.placement(feet))
    tasks = found(inputs, output, to)
    count = os.cpu_count() or 1
    at_once = min(
        count if workers is None else _validation.integer(workers, "--workers", at_least=1), len(tasks)
    )
    for folder in sorted({task.target.parent for task in tasks}):
        folder.mkdir(parents=True, exist_ok=True)
    totals = {"written": 0, "kept": 0, "failed": 0}
    with ExitStack() as stack:
        lines = stack.enter_context((log or output / _LOG).open("a", encoding="utf-8"))
        bar = stack.enter_context(_progress(len(tasks)))
        for record in done(tasks, how, force=force, workers=at_once, threads=max(1, count // at_once)):
            totals[record["status"]] += 1
            line = standard_json.dumps(_output.plain(record), ensure_ascii=False)
            lines.write(line + "\n")
            lines.flush()
            bar.advance(bar.task_ids[0])
            if json:
                _output.say(line)
            elif record["status"] != "failed":
                _output.say(f"{record['output']}: {record['status']}")
            if record["status"] == "failed":
                sys.stderr.write(f"quatfilt: {record['error']}\n")
    if not json:
        _output.say(", ".join(f"{number} {status}" for status, number in totals.items()))
    if totals["failed"]:
        raise typer.Exit(_errors.OF_THE_USER)


def found(inputs: Sequence[Path], output: Path, to: str | None) -> list[Task]:
    """Return the files to clean with their targets.

    Raises
    ------
    ValueError
        If there is none, or if two of them have the same target.
    """
    extension = None if to is None else "." + _validation.choice(to, "--to", tuple(x[1:] for x in WRITABLE))
    targets: dict[Path, Path] = {}
    for path in inputs:
        for source in _below(path, output):
            place = Path(source.name) if source == path else source.relative_to(path)
            target = output / place.with_suffix(extension or written_as(source.suffix))
            if targets.setdefault(target, source) != source:
                raise ValueError(
                    f"{source} and {targets[target]}: both would be written to {target}; clean them into different folders"
                )
    if not targets:
        names = ", ".join(map(str, inputs))
        raise ValueError(f"{names}: no motion files ({listed(READABLE)}) found")
    return [Task(source, target) for target, source in targets.items()]


def _below(path: Path, output: Path) -> Iterator[Path]:
    """Find the motion files of a folder, but for those that this command writes."""
    if not path.exists():
        raise FileAccessError(str(path), "No such file or directory")
    if not path.is_dir():
        if path.suffix.lower() not in READABLE:
            raise ValueError(
                f"{path}: expected {listed(READABLE)}, or a folder, got {path.suffix or 'no extension'}"
            )
        yield path
        return
    for source in sorted(path.rglob("*")):
        written = source.resolve().is_relative_to(output.resolve()) and not path.resolve().is_relative_to(
            output.resolve()
        )
        if source.suffix.lower() in READABLE and source.is_file() and not written:
            yield source


def _progress(total: int) -> Progress:
    columns = (TextColumn("cleaning"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty(), transient=True)
    bar.add_task("cleaning", total=total)
    return bar


__all__ = ["batch", "found"]
