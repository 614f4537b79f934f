"""``quatfilt evaluate nlpm-table1``: Table I of Dean and Lewis."""

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
    from quatfilt._extras import pywavelets  # noqa: PLC0415
    from quatfilt.evaluation import (  # noqa: PLC0415
        nlpm_table1,
        nlpm_table1_page,
        nlpm_table1_picture,
        nlpm_table1_report,
        real_jitter,
    )
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.clips import MORE, Clip, load, thinned  # noqa: PLC0415
    from quatfilt.evaluation.noises import NOISES  # noqa: PLC0415

    _validation.integer(seeds, "--seeds", at_least=1)
    if workers is not None:
        _validation.integer(workers, "--workers", at_least=1)
    pywavelets()
    clips = load(data)
    slow = [thinned(clip, 4) for clip in clips]
    more = load(data, MORE) if data is not None else []
    output.mkdir(parents=True, exist_ok=True)
    with progress("filtering") as done:
        results = nlpm_table1.run([*clips, *slow, *more], seeds=seeds, workers=workers, progress=done)
    command = f"quatfilt evaluate nlpm-table1{' --data DIR' if data else ''} --seeds {seeds}"

    def report(part: list[Clip]) -> nlpm_table1_report.Report:
        which = {(clip.name, clip.motion.fps) for clip in part}
        found = [result for result in results if (result.clip, result.fps) in which]
        return nlpm_table1_report.Report(part, NOISES, found, seeds, version("quatfilt"), command)

    whole = report(clips)
    tables = nlpm_table1_report.Tables(
        table=whole,
        slow=report(slow),
        more=report(more) if more else None,
        jitter=real_jitter.run(data) if data is not None else [],
    )
    numbers = nlpm_table1_report.as_dict(tables)
    written, trouble = write(
        output,
        nlpm_table1_report.STEM,
        page=nlpm_table1_page.markdown(tables),
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
