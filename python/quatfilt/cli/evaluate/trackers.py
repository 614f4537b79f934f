"""``quatfilt evaluate trackers``: recordings of consumer trackers, before and after."""

from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import RESULTS, Json, Output, progress, say_written


def trackers(
    *,
    data: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Folder that holds trackers/*.bvh.", show_default=False),
    ],
    output: Output = RESULTS,
    json: Json = False,
) -> None:
    """Clean recordings of consumer trackers, and measure by what needs no truth.

    Writes trackers.md, trackers.json and, with matplotlib, trackers.png: curves of every recording before and after.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import trackers as recordings  # noqa: PLC0415
    from quatfilt.evaluation import trackers_page as page  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415

    with progress("cleaning") as done:
        takes = recordings.run(data, progress=done)
    report = page.Report(takes, version("quatfilt"), "quatfilt evaluate trackers --data DIR")
    numbers = page.as_dict(report)
    written, trouble = write(
        output,
        page.STEM,
        page=page.markdown(report),
        numbers=numbers,
        draw=lambda path: page.draw(report, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("Jerk left, and slow path moved in degrees")
    _output.print_table(
        ("recording", "jerk left", "slow path", "peaks kept"),
        [
            (
                take.name,
                _output.number(take.jerk_left),
                _output.number(take.slow_moved, 3),
                _output.number(take.peaks_kept),
            )
            for take in takes
        ],
    )
    say_written(written, trouble)


__all__ = ["trackers"]
