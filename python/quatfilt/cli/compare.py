"""``quatfilt compare``: a file against its reference."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from quatfilt.cli import _options, _output
from quatfilt.evaluation.measures import Measures, measure
from quatfilt.motion import metrics
from quatfilt.motion.motion import Motion
from quatfilt.motion.report import text
from quatfilt.motion.skeleton import Skeleton

_SHOWN = 8

_SAME_RATE = 0.01
"""Files round their frame times: rates that differ by less are the same."""


def compare(
    reference: Annotated[
        Path, typer.Argument(metavar="A", help="The reference: the true motion.", show_default=False)
    ],
    estimate: Annotated[
        Path, typer.Argument(metavar="B", help="The estimate: noisy, or cleaned.", show_default=False)
    ],
    *,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    json: _options.Json = False,
) -> None:
    """Measure a motion file against a reference of the same joints and frames."""
    with _output.busy("reading"):
        a = _options.read(reference, fps=fps, skeleton=skeleton, first_frame=first_frame)
        b = _options.read(estimate, fps=fps, skeleton=skeleton, first_frame=first_frame)
    refuse_others(reference, a, estimate, b)
    a, b = in_one_unit(a, b)
    with _output.busy("measuring"):
        measures = measure(a, b)
        scale = metrics.foot_scale(a)
        per_joint = np.asarray(metrics.angle_error(a.rotations, b.rotations, per="joint"))
    worst: list[dict[str, Any]] = [
        {"name": a.skeleton.names[joint], "angle_mean_degrees": float(per_joint[joint])}
        for joint in np.argsort(-np.nan_to_num(per_joint, nan=-1.0), kind="stable")
    ]
    if json:
        _output.print_json(
            {
                "reference": str(reference),
                "estimate": str(estimate),
                **measures.as_dict(),
                "foot_scale": scale,
                "joints": worst,
            }
        )
        return
    _output.say(f"{estimate} against {reference}: {len(a)} frames of {len(a.skeleton)} joints")
    _output.say("")
    print_measures({"value": measures})
    if scale != 1:
        _output.say(text.scaled(scale))
    _output.say("")
    _output.print_table(
        ("joint", "mean angle error °"),
        [(joint["name"], _output.number(joint["angle_mean_degrees"], 3)) for joint in worst[:_SHOWN]],
        title="Worst joints" if len(worst) > _SHOWN else "Joints",
    )


def refuse_others(path_a: Path, a: Motion, path_b: Path, b: Motion) -> None:
    """Refuse motions that are not of the same joints, frames and rate."""
    refuse_other_joints(path_a, a, path_b, b)
    if len(a) != len(b):
        raise ValueError(
            f"{path_a} and {path_b}: expected the same number of frames, got {len(a)} and {len(b)}"
        )
    if abs(a.fps - b.fps) > _SAME_RATE * a.fps:
        raise ValueError(
            f"{path_a} and {path_b}: expected the same frame rate, got {a.fps:g} and {b.fps:g}; "
            "if both have the same, pass it with --fps"
        )


def refuse_other_joints(path_a: Path, a: Motion, path_b: Path, b: Motion) -> None:
    """Refuse motions that are not of the same joints."""
    names, found = a.skeleton.names, b.skeleton.names
    if names != found:
        missing = [name for name in names if name not in found]
        detail = f"{len(names)} joints, {len(found)}"
        if len(names) == len(found):
            detail = "other joints" if missing else "the same joints in another order"
        named = (
            f"; {path_b.name} lacks {', '.join(missing[:3])}{', …' * (len(missing) > 3)}" if missing else ""
        )
        raise ValueError(f"{path_a} and {path_b}: expected the same joints, got {detail}{named}")


def in_one_unit(a: Motion, b: Motion) -> tuple[Motion, Motion]:
    """Give the unit of one motion's skeleton to the other, if that is the same and its file could not say it."""
    units = a.skeleton.centimetres_per_unit, b.skeleton.centimetres_per_unit
    if units[0] == units[1] or 1.0 not in units:
        return a, b
    if not np.allclose(a.skeleton.offsets, b.skeleton.offsets, rtol=1e-3, atol=1e-3):
        return a, b
    known = units[1] if units[0] == 1.0 else units[0]
    first, second = (
        motion.replace(
            skeleton=Skeleton(
                motion.skeleton.names,
                motion.skeleton.parents,
                motion.skeleton.offsets,
                centimetres_per_unit=known,
                end_sites=motion.skeleton.end_sites,
            )
        )
        for motion in (a, b)
    )
    return first, second


ROWS = (
    ("peak signal-to-noise ratio, dB", "psnr", 2),
    ("angle error, mean °", "angle_mean", 3),
    ("angle error, 95th percentile °", "angle_p95", 3),
    ("position error, mean cm", "position", 3),
    ("jerk, of the reference's", "jerk_ratio", 2),
    ("foot slide, cm", "foot_slide", 2),
    ("foot slide of the reference, cm", "foot_slide_reference", 2),
    ("peak angular speed kept", "peak_kept", 3),
    ("delay, frames", "delay", 2),
)


def print_measures(columns: dict[str, Measures]) -> None:
    """Print measures as a table with one column for each motion."""
    _output.print_table(
        ("measure", *columns),
        [
            (title, *(_output.number(getattr(measures, name), digits) for measures in columns.values()))
            for title, name, digits in ROWS
        ],
    )


__all__ = ["ROWS", "compare", "in_one_unit", "print_measures", "refuse_others"]
