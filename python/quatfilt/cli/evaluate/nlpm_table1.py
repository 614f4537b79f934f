"""``quatfilt evaluate nlpm-table1``: Table I of Dean and Lewis."""

import os
from importlib.metadata import version

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


def nlpm_table1(
    *,
    data: Data = None,
    seeds: Seeds = 5,
    output: Output = RESULTS,
    workers: Workers = None,
    json: Json = False,
) -> None:
    """Measure all filters on clips with added noise, and on real defects (Table I of Dean and Lewis).

    Writes nlpm-table1.md, nlpm-table1.json and, with matplotlib, nlpm-table1.png. Needs PyWavelets.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import (  # noqa: PLC0415
        nlpm_table1,
        nlpm_table1_page,
        nlpm_table1_picture,
        nlpm_table1_report,
        real_jitter,
    )
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.baselines import pywavelets  # noqa: PLC0415
    from quatfilt.evaluation.clips import Clip, load, thinned  # noqa: PLC0415
    from quatfilt.evaluation.noises import NOISES  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    if workers is not None:
        _validation.integer(workers, "--workers", at_least=1)
    pywavelets()
    clips = load(data)
    slow = [thinned(clip, 4) for clip in clips]
    output.mkdir(parents=True, exist_ok=True)
    with progress("filtering") as done:
        results = nlpm_table1.run(
            [*clips, *slow], seeds=seeds, workers=workers or os.cpu_count() or 1, progress=done
        )
    jitter = real_jitter.run(data) if data is not None else []
    command = f"quatfilt evaluate nlpm-table1{' --data DIR' if data else ''} --seeds {seeds}"

    def report(part: list[Clip]) -> nlpm_table1_report.Report:
        fps = part[0].motion.fps
        return nlpm_table1_report.Report(
            clips=part,
            noises=NOISES,
            results=[result for result in results if result.fps == fps],
            seeds=seeds,
            version=version("quatfilt"),
            command=command,
        )

    whole, thin = report(clips), report(slow)
    numbers = nlpm_table1_report.as_dict(whole, thin, jitter)
    written, trouble = write(
        output,
        nlpm_table1_report.STEM,
        page=nlpm_table1_page.markdown(whole, thin, jitter),
        numbers=numbers,
        draw=lambda path: nlpm_table1_picture.draw(whole, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("Mean PSNR over the clips, dB")
    _output.print_table(
        ("row", *(noise.name for noise in NOISES)),
        [
            (row, *(_output.number(whole.mean(row, noise.name, "psnr")) for noise in NOISES))
            for row in whole.rows
        ],
    )
    say_written(written, trouble)


__all__ = ["nlpm_table1"]
