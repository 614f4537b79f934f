"""``quatfilt evaluate compression``: ratio, time and error of `compress`, beside plain small formats."""

from importlib.metadata import version

from quatfilt import _backend
from quatfilt.cli import _output
from quatfilt.cli.evaluate._options import RESULTS, Data, Json, Output, progress, say_written


def compression(*, data: Data = None, output: Output = RESULTS, json: Json = False) -> None:
    """Measure compression to a tolerance of 0.1° beside float16 and 48-bit quaternions.

    Writes compression.md, compression.json and, with matplotlib, compression.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation import compression as measured  # noqa: PLC0415
    from quatfilt.evaluation import compression_page  # noqa: PLC0415
    from quatfilt.evaluation._written import write  # noqa: PLC0415
    from quatfilt.evaluation.clips import load  # noqa: PLC0415

    clips = load(data, measured.COMPRESSED_CLIPS)
    with progress("compressing") as done:
        outcomes, as_acl, ratios = measured.run(clips, progress=done)
    report = compression_page.Report(
        clips=clips,
        outcomes=outcomes,
        as_acl=as_acl,
        ratios=ratios,
        threads=_backend.get_num_threads(),
        version=version("quatfilt"),
        command=f"quatfilt evaluate compression{' --data DIR' if data else ''}",
    )
    numbers = compression_page.as_dict(report)
    written, trouble = write(
        output,
        compression_page.STEM,
        page=compression_page.markdown(report),
        numbers=numbers,
        draw=lambda path: compression_page.draw(report, path),
    )
    if json:
        _output.print_json(numbers)
        return
    _output.say("All clips together")
    _output.print_table(
        ("", "ratio", "angle max °", "point max cm", "write MB/s", "read MB/s"),
        [
            (
                way,
                _output.number(sums["ratio"]),
                _output.number(sums["angle_max"], 3),
                _output.number(sums["vertex_max"], 3),
                _output.number(sums["write_megabytes"], 0),
                _output.number(sums["read_megabytes"], 0),
            )
            for way, sums in numbers["totals"].items()
        ],
    )
    say_written(written, trouble)


__all__ = ["compression"]
