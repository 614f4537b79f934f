"""``quatfilt denoise``: a noisy file in, a clean one out."""

from pathlib import Path
from typing import Annotated, Any

import typer

from quatfilt.cli import _cleaning, _options, _output, _steps
from quatfilt.cli.compare import in_one_unit, refuse_others
from quatfilt.formats._table import written_as
from quatfilt.motion.motion import Motion
from quatfilt.motion.report import Report, check_path, report

_TERMINAL = Path("-")


def denoise(
    path: _options.Input,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="File to write: .bvh or .npz. [default: IN with .clean before its extension, .bvh for an .amc]",
            show_default=False,
        ),
    ] = None,
    method: _steps.Method = None,
    preset: _steps.PresetName = None,
    option: _steps.Options = None,
    search_radius: Annotated[
        str | None,
        typer.Option(metavar="FRAMES|all", help="Search radius of similar poses. [default: 10]"),
    ] = None,
    patch_radius: Annotated[
        int | None, typer.Option(metavar="FRAMES", help="Radius of the compared neighbourhood. [default: 5]")
    ] = None,
    bandwidth: Annotated[
        str | None,
        typer.Option(
            metavar="DEGREES|auto",
            help="Size of differences that are averaged out. [default: auto, the estimated noise]",
        ),
    ] = None,
    chart: Annotated[
        str | None, typer.Option(metavar="mean|local|identity", help="Chart in which rotations are vectors.")
    ] = None,
    boundary: Annotated[
        str | None,
        typer.Option(metavar="nearest|mirror|linear", help="Extension of the clip beyond its ends."),
    ] = None,
    weights: Annotated[
        str | None, typer.Option(metavar="pose|joint", help="Whether joints share their weights.")
    ] = None,
    distance: Annotated[
        str | None,
        typer.Option(metavar="mean|sum", help="Patch distance: mean, or the sum as printed in the paper."),
    ] = None,
    neighbors: Annotated[
        int | None, typer.Option(metavar="N", help="Number of most similar poses that count. [default: all]")
    ] = None,
    library: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Clean motion of the same person to take similar poses from. May be repeated.",
            show_default=False,
        ),
    ] = None,
    gaps: _steps.Gaps = None,
    max_gap: _steps.MaxGap = None,
    confidence: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Confidence of samples, 0 to 1, per frame or per frame and joint: .npy, .csv, .txt.",
        ),
    ] = None,
    translation: _steps.Translation = True,
    feet: _steps.Feet = "keep",
    reports: Annotated[
        list[Path] | None,
        typer.Option(
            "--report",
            metavar="FILE|-",
            help="Report of the effect: .png, .pdf, .svg, .json, .txt, or - for the terminal. May be repeated.",
            show_default=False,
        ),
    ] = None,
    reference: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The true motion, for the report.")
    ] = None,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    threads: _options.Threads = None,
    json: _options.Json = False,
) -> None:
    """Clean a motion file.

    By default spikes are replaced, and every joint is smoothed as much as its noise requires. --method and --preset choose
    other filters.
    """
    _options.use_threads(threads)
    wish = _steps.asked(
        method,
        preset,
        option,
        {
            "search_radius": None if search_radius is None else _search_radius(search_radius),
            "patch_radius": patch_radius,
            "bandwidth": bandwidth,
            "chart": chart,
            "boundary": boundary,
            "weights": weights,
            "distance": distance,
            "neighbors": neighbors,
            "gaps": gaps,
            "max_gap": max_gap,
        },
    )
    _steps.planned({**wish, "library": None} if library else wish)
    wanted = reports or []
    _refuse_others(wanted)
    placement = _steps.placement(feet)
    how = _cleaning.How(
        wish, translation, fps, skeleton, first_frame, confidence, tuple(library or ()), placement
    )
    target = output or beside(path)
    with _output.busy(f"reading {path.name}"):
        motion = _cleaning.read(path, target, how)
        truth = None if reference is None else _reference(reference, path, motion, how)
    cleaned = _cleaning.clean(path, target, motion, how, busy=_output.busy)
    told = None
    if wanted:
        with _output.busy("measuring"):
            told = _report(cleaned, truth)
        for file in wanted:
            if file != _TERMINAL:
                told.write(file)
    if json:
        _output.print_json({**cleaned.record, **({} if told is None else {"report": told.as_dict()})})
        return
    _say(path, target, cleaned)
    if told is not None and _TERMINAL in wanted:
        _output.print_report(told)
    for file in wanted:
        if file != _TERMINAL:
            _output.say(f"{file}: written")


def beside(path: Path) -> Path:
    """Return the default path of a cleaned file."""
    return path.with_name(f"{path.stem}.clean{written_as(path.suffix)}")


def _say(path: Path, target: Path, cleaned: _cleaning.Cleaned) -> None:
    record, motion = cleaned.record, cleaned.motion
    for note in motion.notes:
        _output.say(f"{path}: {note}")
    if record["missing_samples"]:
        _output.say(
            f"{path}: {_output.counted(record['missing_samples'], 'missing sample')}, "
            f"{record['missing_samples_left']} left missing"
        )
    _output.say(
        f"{path}: {_output.counted(len(motion), 'frame')} of {_output.counted(len(motion.skeleton), 'joint')}, "
        f"estimated noise {record['noise_degrees']:.2g}°, turned by {record['change_degrees']:.2g}° on average, "
        f"{record['seconds']:.2g} s"
    )
    if record["feet"] is not None:
        _output.say(f"{path}: {_of_feet(record['feet'])}")
    _output.say(f"{target}: written")


def _of_feet(feet: dict[str, Any]) -> str:
    """Describe the slide of the feet and the rotation of joints that holds them."""
    done = {"keep": "kept", "lock": "locked"}[feet["placement"]]
    scaled = "" if feet["scale"] == 1 else f", lengths multiplied by {feet['scale']:.3g} for a leg of 90 cm"
    return (
        f"feet {done}: slide {feet['slide_before']:.1f} cm in the input, {feet['slide_filtered']:.1f} cm filtered, "
        f"{feet['slide_after']:.1f} cm now{scaled}; joints turned by at most {feet['turned_max']:.2g}° "
        f"({feet['joint']}, frame {feet['frame']})"
    )


def _search_radius(text: str) -> str:
    try:
        return text if text == "all" else str(int(text))
    except ValueError:
        raise ValueError(f"--search-radius: expected a number of frames or all, got {text!r}") from None


def _refuse_others(reports: list[Path]) -> None:
    """Refuse reports that cannot be written, before anything is computed."""
    for file in reports:
        if file != _TERMINAL:
            try:
                check_path(file)
            except ValueError as error:
                raise ValueError(f"--report: {str(error).removeprefix('path: ')}, or -") from None


def _report(cleaned: _cleaning.Cleaned, truth: Motion | None) -> Report:
    filtered = None if cleaned.record["feet"] is None else cleaned.filtered
    if truth is None:
        return report(cleaned.motion, cleaned.result, filtered=filtered)
    truth, before = in_one_unit(truth, cleaned.motion)
    after = cleaned.result.replace(skeleton=before.skeleton)
    return report(before, after, reference=truth, filtered=filtered)


def _reference(path: Path, source: Path, motion: Motion, how: _cleaning.How) -> Motion:
    """Read the true motion, and refuse that of other joints or frames."""
    truth = _options.read(path, fps=how.fps, skeleton=how.skeleton, first_frame=how.first_frame)
    refuse_others(path, truth, source, motion)
    return truth


__all__ = ["beside", "denoise"]
