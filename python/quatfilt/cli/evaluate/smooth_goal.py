"""``quatfilt evaluate smooth-goal``: the automatic method beside the best classical filters."""

from importlib.metadata import version
from typing import Annotated

import numpy as np
import typer

from quatfilt import _validation
from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import (
    RESULTS,
    Data,
    Json,
    Output,
    Seeds,
    Workers,
    progress,
    say_written,
)
from quatfilt.denoise import METHODS


def smooth_goal(
    *,
    data: Data = None,
    method: Annotated[str, typer.Option(metavar="NAME", help="What `quatfilt denoise` is to run.")] = "auto",
    seeds: Seeds = 5,
    output: Output = RESULTS,
    workers: Workers = None,
    json: Json = False,
) -> None:
    """Measure the automatic method beside classical filters that know the truth, on recordings used for nothing else.

    Writes smooth-goal.md, smooth-goal.json and, with matplotlib, smooth-goal.png. Needs PyWavelets.
    """
    # SciPy would slow down every verb.
    from quatfilt._extras import pywavelets  # noqa: PLC0415
    from quatfilt.evaluation import smooth_goal as goal  # noqa: PLC0415
    from quatfilt.evaluation import smooth_goal_page  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.clips import load  # noqa: PLC0415

    _validation.choice(method, "--method", METHODS)
    _validation.integer(seeds, "--seeds", at_least=1)
    if workers is not None:
        _validation.integer(workers, "--workers", at_least=1)
    pywavelets()
    clips = load(data, goal.GOAL_CLIPS, longest=goal.LONGEST)
    with progress("filtering") as done:
        outcomes = goal.run(clips, goal.automatic(method), seeds=seeds, workers=workers, progress=done)
    given = (
        f"{' --data DIR' if data else ''}{'' if method == 'auto' else f' --method {method}'} --seeds {seeds}"
    )
    report = smooth_goal_page.Report(
        clips=clips,
        outcomes=outcomes,
        method=method,
        seeds=seeds,
        version=version("quatfilt"),
        command=f"quatfilt evaluate smooth-goal{given}",
    )
    numbers = smooth_goal_page.as_dict(report)
    written, trouble = write(
        output,
        smooth_goal_page.STEM,
        page=smooth_goal_page.markdown(report),
        numbers=numbers,
        draw=lambda path: smooth_goal_page.draw(report, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("PSNR less that of the best classical filter, dB")
    _output.print_table(
        ("m", "mean", "least", "peak kept"),
        [
            (
                str(multiple),
                _output.number(float(np.mean([one.margin for one in report.at(multiple)]))),
                _output.number(min(one.margin for one in report.at(multiple))),
                _output.number(float(np.mean([one.peak_kept for one in report.at(multiple)]))),
            )
            for multiple in report.multiples
        ],
    )
    say_written(written, trouble)


__all__ = ["smooth_goal"]
