"""Arguments and options of several commands."""

from pathlib import Path
from typing import Annotated, TypeAlias, cast

import typer

from quatfilt import _backend
from quatfilt.formats._table import READABLE, listed, needs_skeleton
from quatfilt.formats.files import FirstFrame, read_motion
from quatfilt.motion.motion import Motion

Input: TypeAlias = Annotated[
    Path,
    typer.Argument(metavar="IN", help=f"Motion file: {listed(READABLE, notes=True)}.", show_default=False),
]
Fps: TypeAlias = Annotated[
    float | None,
    typer.Option("--fps", metavar="HZ", help="Frames per second, instead of the rate in the file."),
]
SkeletonFile: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--skeleton", metavar="ASF", help="Skeleton of an .amc file. [default: the .asf in its folder]"
    ),
]
FirstFrameChoice: TypeAlias = Annotated[
    str,
    typer.Option(
        "--first-frame",
        metavar="auto|keep|drop",
        help="First frame that is a rest pose: auto leaves it unfiltered and writes it again, keep filters it, drop removes it.",
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print the result as JSON only.")]
Threads: TypeAlias = Annotated[
    int | None,
    typer.Option("--threads", metavar="N", help="Number of threads. [default: all processors]"),
]


def read(path: Path, *, fps: float | None, skeleton: Path | None, first_frame: str) -> Motion:
    """Read a motion; a skeleton is for those that need one."""
    needed = skeleton if needs_skeleton(path.suffix) else None
    return read_motion(path, fps=fps, skeleton=needed, first_frame=cast("FirstFrame", first_frame))


def use_threads(threads: int | None) -> None:
    """Set the number of threads of the process."""
    if threads is not None and threads < 1:
        raise ValueError(f"--threads: expected at least 1, got {threads}")
    if threads is not None:
        _backend.set_num_threads(threads)
