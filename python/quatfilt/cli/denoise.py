"""``quatfilt denoise``: a noisy file in, a clean one out."""

import math
import time
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from quatfilt import _validation
from quatfilt.cli import _options, _output
from quatfilt.denoise import METHODS
from quatfilt.denoise import denoise as clean
from quatfilt.errors import FileAccessError
from quatfilt.formats.files import write_motion
from quatfilt.motion.defects import find_defects
from quatfilt.motion.motion import Motion
from quatfilt.noise.noise import noise_level

_METHODS = "|".join(METHODS).replace("_", "-")


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
    method: Annotated[str, typer.Option(metavar=_METHODS, help="The filter.")] = "auto",
    search_radius: Annotated[
        str | None,
        typer.Option(metavar="FRAMES|all", help="How far similar poses are looked for. [default: 10]"),
    ] = None,
    patch_radius: Annotated[
        int | None, typer.Option(metavar="FRAMES", help="How far around a pose is compared. [default: 5]")
    ] = None,
    bandwidth: Annotated[
        str | None,
        typer.Option(
            metavar="DEGREES|auto",
            help="Differences that count as noise. [default: auto, the estimated noise]",
        ),
    ] = None,
    chart: Annotated[
        str | None, typer.Option(metavar="mean|local|identity", help="Where rotations are vectors.")
    ] = None,
    boundary: Annotated[
        str | None,
        typer.Option(metavar="nearest|mirror|linear", help="How the clip goes on beyond its ends."),
    ] = None,
    weights: Annotated[
        str | None, typer.Option(metavar="pose|joint", help="Whether joints share their weights.")
    ] = None,
    distance: Annotated[
        str | None, typer.Option(metavar="mean|sum", help="Mean over the patch, or the printed sum.")
    ] = None,
    neighbors: Annotated[
        int | None, typer.Option(metavar="N", help="Only the N most similar poses count. [default: all]")
    ] = None,
    gaps: Annotated[
        str | None, typer.Option(metavar="fill|keep|raise", help="What becomes of missing samples.")
    ] = None,
    max_gap: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="The longest gap to fill. [default: any]")
    ] = None,
    translation: Annotated[
        bool, typer.Option("--translation/--no-translation", help="Clean the path of the root too.")
    ] = True,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    threads: _options.Threads = None,
    json: _options.Json = False,
) -> None:
    """Clean a motion file.

    Each pose becomes the mean of the poses around it in time, weighted by how alike their neighbourhoods look.
    """
    _options.use_threads(threads)
    options: dict[str, Any] = {
        "search_radius": None if search_radius is None else _search_radius(search_radius),
        "patch_radius": patch_radius,
        "bandwidth": None if bandwidth is None else _bandwidth(bandwidth),
        "chart": chart,
        "boundary": boundary,
        "weights": weights,
        "distance": distance,
        "neighbors": neighbors,
        "gaps": gaps,
        "max_gap": max_gap,
    }
    options = {name: value for name, value in options.items() if value is not None}
    if options.get("search_radius") == "all":
        options["search_radius"] = None
    target = output or _beside(path)
    if target.exists() and path.exists() and target.samefile(path):
        raise FileAccessError(target, "this is the input: write to another file")
    with _output.busy(f"reading {path.name}"):
        motion = _options.read(path, fps=fps, skeleton=skeleton, first_frame=first_frame)
    started = time.perf_counter()
    with _output.busy(f"cleaning {path.name}"):
        result = clean(motion, method=method.replace("-", "_"), translation=translation, **options)
    seconds = time.perf_counter() - started
    with _output.busy(f"writing {target.name}"):
        write_motion(target, result)
    report = _report(path, target, motion, result, seconds)
    if json:
        _output.print_json(report)
        return
    for note in motion.notes:
        _output.say(f"{path}: {note}")
    if report["missing_samples"]:
        _output.say(
            f"{path}: {report['missing_samples']} missing samples, {report['missing_samples_left']} left missing"
        )
    _output.say(
        f"{path}: {len(motion)} frames of {len(motion.skeleton)} joints, estimated noise "
        f"{report['noise_before_degrees']:.2g}° before, {report['noise_after_degrees']:.2g}° after, "
        f"{seconds:.2g} s"
    )
    _output.say(f"{target}: written")


def _beside(path: Path) -> Path:
    extension = ".bvh" if path.suffix.lower() == ".amc" else path.suffix
    return path.with_name(f"{path.stem}.clean{extension}")


def _search_radius(text: str) -> int | str:
    if text == "all":
        return text
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"--search-radius: expected a number of frames or all, got {text!r}") from None


def _bandwidth(text: str) -> float | str:
    if text == "auto":
        return text
    try:
        degrees = float(text)
    except ValueError:
        raise ValueError(f"--bandwidth: expected degrees above 0 or auto, got {text!r}") from None
    return math.radians(_validation.number(degrees, "--bandwidth", above=0))


def _report(path: Path, target: Path, motion: Motion, result: Motion, seconds: float) -> dict[str, Any]:
    def overall(clip: Motion) -> float:
        if not clip.rotations.size:
            return 0.0
        return math.degrees(float(np.sqrt(np.mean(np.square(noise_level(clip.rotations))))))

    return {
        "input": str(path),
        "output": str(target),
        "frames": len(motion),
        "joints": len(motion.skeleton),
        "fps": motion.fps,
        "notes": list(motion.notes),
        "missing_samples": _missing(motion),
        "missing_samples_left": _missing(result),
        "noise_before_degrees": overall(motion),
        "noise_after_degrees": overall(result),
        "seconds": seconds,
    }


def _missing(motion: Motion) -> int:
    return int(find_defects(motion.rotations, fps=motion.fps).missing.sum())


__all__ = ["denoise"]
