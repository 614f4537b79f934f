"""``quatfilt evaluate robust-denoising``: the automatic method on the noise of real trackers."""

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


def robust_denoising(
    *,
    data: Data = None,
    seeds: Seeds = 5,
    clips: Annotated[
        str | None, typer.Option(metavar="NAME,…", help="Which recordings. [default: all]")
    ] = None,
    kinds: Annotated[
        str | None, typer.Option(metavar="NAME,…", help="Which kinds of noise. [default: all]")
    ] = None,
    output: Output = RESULTS,
    workers: Workers = None,
    json: Json = False,
) -> None:
    """Measure the automatic method and its presets on kinds of noise that trackers make, beside other filters.

    Writes robust-denoising.md, robust-denoising.json and, with matplotlib, robust-denoising.png. Needs PyWavelets.
    """
    # SciPy would slow down every verb.
    from quatfilt._extras import pywavelets  # noqa: PLC0415
    from quatfilt.evaluation import robust_denoising as robust  # noqa: PLC0415
    from quatfilt.evaluation import robust_denoising_page as page  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.clips import load  # noqa: PLC0415
    from quatfilt.evaluation.noise_kinds import KINDS  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    if workers is not None:
        _validation.integer(workers, "--workers", at_least=1)
    chosen = _chosen(kinds, "--kinds", tuple(KINDS))
    names = _chosen(clips, "--clips", tuple(robust.ROBUST_CLIPS))
    pywavelets()
    recordings = load(data, {name: robust.ROBUST_CLIPS[name] for name in names}, longest=robust.LONGEST)
    with progress("cleaning") as done:
        outcomes, unchanged = robust.run(
            recordings, seeds=seeds, kinds=chosen, workers=workers, progress=done
        )
    given = "".join(
        f" {option} {value}" for option, value in (("--clips", clips), ("--kinds", kinds)) if value
    )
    report = page.Report(
        clips=recordings,
        outcomes=outcomes,
        unchanged=unchanged,
        seeds=seeds,
        version=version("quatfilt"),
        command=f"quatfilt evaluate robust-denoising{' --data DIR' if data else ''} --seeds {seeds}{given}",
    )
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
    _output.say("PSNR less that of the better of kalman and a 6 Hz Butterworth filter, dB")
    _output.print_table(
        ("kind", *(f"{fps:g} fps" for fps in report.rates), "worst"),
        [
            (
                kind,
                *(
                    _output.number(
                        float(np.mean([one.margin for one in outcomes if (one.kind, one.fps) == (kind, fps)]))
                    )
                    for fps in report.rates
                ),
                _output.number(min(one.margin for one in outcomes if one.kind == kind)),
            )
            for kind in report.kinds
        ],
    )
    say_written(written, trouble)


def _chosen(names: str | None, option: str, known: tuple[str, ...]) -> tuple[str, ...]:
    if names is None:
        return known
    return tuple(_validation.choice(name.strip(), option, known) for name in names.split(","))


__all__ = ["robust_denoising"]
