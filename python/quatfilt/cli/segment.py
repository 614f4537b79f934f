"""``quatfilt segment``: where the behaviours of a motion change."""

from pathlib import Path
from typing import Annotated

import typer

from quatfilt import _validation
from quatfilt.cli import _options, _output
from quatfilt.geodesics.segment import MOST_COMPONENTS, Segments, segments
from quatfilt.motion.motion import Motion


def segment(
    path: _options.Input,
    *,
    window: Annotated[
        float,
        typer.Option(
            metavar="S", help="Seconds at the beginning of a segment in which its behaviour is learned."
        ),
    ] = 2.0,
    min_length: Annotated[
        float | None,
        typer.Option(metavar="S", help="Seconds of the shortest segment. [default: half of the window]"),
    ] = None,
    threshold: Annotated[
        float | None,
        typer.Option(metavar="X", help="Standard deviations; a smaller number makes more cuts. [default: 3]"),
    ] = None,
    components: Annotated[
        int, typer.Option(metavar="1|2", help="Number of principal geodesics of each joint.")
    ] = 1,
    picture: Annotated[
        Path | None, typer.Option(metavar="PNG", help="Draw the cuts against the motion. Needs matplotlib.")
    ] = None,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    json: _options.Json = False,
) -> None:
    """Print where one behaviour ends and another begins, in frames (from 0) and seconds."""
    count = _validation.integer(components, "--components", at_least=1, at_most=MOST_COMPONENTS)
    with _output.busy(f"reading {path.name}"):
        motion = _options.read(path, fps=fps, skeleton=skeleton, first_frame=first_frame)
    with _output.busy("segmenting"):
        found = segments(
            motion.rotations,
            n_components=count,
            window=window,
            min_length=min_length,
            threshold="auto" if threshold is None else threshold,
            fps=motion.fps,
        )
    if picture is not None:
        _draw(motion, found, picture, path.name)
    spans = found.spans(len(motion))
    if json:
        _output.print_json(
            {
                "file": str(path),
                "frames": len(motion),
                "fps": motion.fps,
                "cuts": found.cuts,
                "cuts_seconds": found.cuts / motion.fps,
            }
        )
        return
    _output.say(
        f"{path}: {_output.counted(len(motion), 'frame')}, {motion.fps:g} per second, "
        f"{_output.counted(len(found.cuts), 'cut')}"
    )
    _output.print_table(
        ("segment", "from frame", "to frame", "from s", "to s"),
        [
            (
                str(number),
                str(start),
                str(end - 1),
                _output.number(start / motion.fps),
                _output.number(end / motion.fps),
            )
            for number, (start, end) in enumerate(spans, start=1)
        ],
    )
    if picture is not None:
        _output.say(f"{picture}: written")


def _draw(motion: Motion, found: Segments, picture: Path, title: str) -> None:
    # matplotlib is optional.
    from quatfilt.evaluation.segment_picture import draw  # noqa: PLC0415

    draw(motion, found, picture, title=title)


__all__ = ["segment"]
