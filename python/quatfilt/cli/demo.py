"""``quatfilt demo``: what the package does, on a walk that it brings along."""

import math
from pathlib import Path
from typing import Annotated

import typer

from quatfilt import _validation
from quatfilt.cli import _output
from quatfilt.cli.compare import print_measures
from quatfilt.evaluation.measures import measure
from quatfilt.formats.files import write_motion


def demo(
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to; created if missing.")
    ] = Path("quatfilt-demo"),
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of the walk and the noise.")] = 0,
    seconds: Annotated[float, typer.Option(metavar="SECONDS", help="Length of the walk.")] = 8.0,
    sigma: Annotated[
        float,
        typer.Option(metavar="DEGREES", help="Deviation of the noise, per component of the rotation vector."),
    ] = 0.917,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON only.")] = False,
) -> None:
    """Add noise to a synthetic walk, clean it, and measure the effect.

    Writes truth.bvh, noisy.bvh, denoised.bvh and, with matplotlib, denoise.png.
    """
    # SciPy would slow down every verb.
    from quatfilt.evaluation.demonstration import SIGMA_TRANSLATION, demonstrate  # noqa: PLC0415
    from quatfilt.evaluation.picture import draw  # noqa: PLC0415

    _validation.number(sigma, "--sigma", at_least=0)
    _validation.number(seconds, "--seconds", above=0, at_most=3600)
    _validation.integer(seed, "--seed", at_least=0)
    output.mkdir(parents=True, exist_ok=True)
    with _output.busy("walking"):
        motions = demonstrate(seed=seed, seconds=seconds, sigma=math.radians(sigma))
        measures = {
            "noisy": measure(motions.truth, motions.noisy),
            "denoised": measure(motions.truth, motions.denoised),
        }
    files = {
        output / "truth.bvh": motions.truth,
        output / "noisy.bvh": motions.noisy,
        output / "denoised.bvh": motions.denoised,
    }
    for path, motion in files.items():
        write_motion(path, motion)
    written = [str(path) for path in files]
    picture = output / "denoise.png"
    trouble = ""
    try:
        with _output.busy("drawing"):
            draw(motions, picture)
        written.append(str(picture))
    except ImportError as error:
        trouble = str(error)
    if json:
        _output.print_json(
            {
                "seed": seed,
                "sigma_degrees": sigma,
                "frames": len(motions.truth),
                "files": written,
                **{name: one.as_dict() for name, one in measures.items()},
            }
        )
        return
    _output.say(
        f"A synthetic walk of {len(motions.truth)} frames and {len(motions.truth.skeleton)} joints, with noise of "
        f"{sigma:g}° on the rotations and {SIGMA_TRANSLATION:g} cm on the root (seed {seed})"
    )
    _output.say("")
    print_measures(measures)
    _output.say("")
    for name in written:
        _output.say(f"{name}: written")
    if trouble:
        _output.say(f"no picture: {trouble}")


__all__ = ["demo"]
