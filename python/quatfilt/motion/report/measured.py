"""The numbers of a report."""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from quatfilt._typing import Mask
from quatfilt.motion import metrics
from quatfilt.motion.defects import find_defects
from quatfilt.motion.legs import foot_joints
from quatfilt.motion.metrics import _samples
from quatfilt.motion.metrics._samples import Values
from quatfilt.motion.metrics.speed import jerks, peaks_kept, steps
from quatfilt.motion.motion import Motion
from quatfilt.motion.report.sides import Side
from quatfilt.noise.model import noise_model
from quatfilt.noise.noise import noise_level


@dataclass(frozen=True)
class Joint:
    """What a filter did to a joint, or to all of them.

    Parameters
    ----------
    name : str
        Name of the joint.
    change_mean, change_p95, change_max : float, degrees
        By how much samples were turned: mean, 95th percentile, largest.
    noise_before, noise_after : float, degrees
        Estimated deviation per component of the rotation vector; of all joints the root mean square.
    jerk_before, jerk_after : float, degrees per second cubed
        Mean length of the rotational jerk.
    peak_kept : float
        95th percentile of the angular speed, after divided by before.
    missing, filled : int
        Samples that were missing, and those of them that no longer are.
    spikes, spikes_replaced : int
        Samples that left both of their neighbours, and those of them that no longer do.
    error_before, error_after : float, degrees
        Mean angle to the reference; NaN without one.
    error_p95_before, error_p95_after : float, degrees
        Its 95th percentile.
    psnr_before, psnr_after : float, decibels
        Peak signal-to-noise ratio against the reference.
    jerk_reference : float, degrees per second cubed
        Jerk of the reference.
    peak_before, peak_after : float
        95th percentile of the angular speed, divided by the reference's.
    """

    name: str
    change_mean: float
    change_p95: float
    change_max: float
    noise_before: float
    noise_after: float
    jerk_before: float
    jerk_after: float
    peak_kept: float
    missing: int
    filled: int
    spikes: int
    spikes_replaced: int
    error_before: float = float("nan")
    error_after: float = float("nan")
    error_p95_before: float = float("nan")
    error_p95_after: float = float("nan")
    psnr_before: float = float("nan")
    psnr_after: float = float("nan")
    jerk_reference: float = float("nan")
    peak_before: float = float("nan")
    peak_after: float = float("nan")


@dataclass(frozen=True)
class Foot:
    """How far a foot slides on the ground.

    Parameters
    ----------
    name : str
        Name of the joint.
    slide_before, slide_after : float, centimetres
        Horizontal path while the reference's foot touches the ground, or that of the filtered motion.
    slide_reference : float, centimetres
        The reference's own; NaN without one.
    """

    name: str
    slide_before: float
    slide_after: float
    slide_reference: float = float("nan")


@dataclass(frozen=True)
class Placed:
    """What holding feet on the ground changed after the filter.

    Parameters
    ----------
    joint : str
        The joint that was turned farthest.
    frame : int
        Where it was.
    turned_max : float, degrees
        By how much.
    frames : int
        Frames in which any joint was turned.
    """

    joint: str
    frame: int
    turned_max: float
    frames: int


def placed(filtered: Motion, after: Motion) -> Placed:
    """Measure by how much joints differ from the filtered motion before its feet were placed."""
    change = np.nan_to_num(np.asarray(metrics.angle_error(filtered.rotations, after.rotations, per="sample")))
    if not change.size:
        return Placed("", 0, 0.0, 0)
    frame, joint = np.unravel_index(int(np.argmax(change)), change.shape)
    changed = int(np.count_nonzero((change > 0).any(axis=1)))
    return Placed(after.skeleton.names[joint], int(frame), float(change[frame, joint]), changed)


Column: TypeAlias = tuple[NDArray[np.generic], Any]
"""A value for each joint, and one for all of them."""


def joints(before: Side, after: Side, reference: Side | None = None) -> tuple[tuple[Joint, ...], Joint]:
    """Measure each joint, and all together."""
    clips = (before, after) if reference is None else (before, after, reference)
    turns = [steps(side.rotations) for side in clips]
    jerk = [_mean(jerks(turned, side.fps or 1.0)) for side, turned in zip(clips, turns, strict=True)]
    columns = {
        **_of_a_filter(before, after),
        "jerk_before": jerk[0],
        "jerk_after": jerk[1],
        "peak_kept": _peak(turns[0], turns[1]),
    }
    if reference is not None:
        columns |= {
            **_against(reference, before, after),
            "jerk_reference": jerk[2],
            "peak_before": _peak(turns[2], turns[0]),
            "peak_after": _peak(turns[2], turns[1]),
        }
    each = tuple(
        Joint(name, **{column: values[joint].item() for column, (values, _) in columns.items()})
        for joint, name in enumerate(before.names)
    )
    return each, Joint("all joints", **{column: overall for column, (_, overall) in columns.items()})


def _of_a_filter(before: Side, after: Side) -> dict[str, Column]:
    a, b = before.rotations, after.rotations
    change = np.asarray(metrics.angle_error(a, b, per="sample"))
    rate = {} if before.fps is None else {"fps": before.fps}
    found, left = find_defects(a, **rate).spikes, find_defects(b, **rate).spikes
    missing, still_missing = (np.asarray(np.isnan(q[..., 0])) for q in (a, b))
    return {
        "change_mean": _mean(change),
        "change_p95": _percentile(change),
        "change_max": _largest(change),
        "noise_before": _noise(a),
        "noise_after": _noise(b),
        "missing": _count(missing),
        "filled": _count(missing & ~still_missing),
        "spikes": _count(found),
        "spikes_replaced": _count(found & ~left),
    }


def _against(reference: Side, before: Side, after: Side) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    for when, side in (("before", before), ("after", after)):
        error = np.asarray(metrics.angle_error(reference.rotations, side.rotations, per="sample"))
        columns |= {
            f"error_{when}": _mean(error),
            f"error_p95_{when}": _percentile(error),
            f"psnr_{when}": _psnr(error),
        }
    return columns


def _mean(values: Values) -> Column:
    return _samples.mean(values, axis=0), float(_samples.mean(values))


def _psnr(error: Values) -> Column:
    """Peak signal-to-noise ratio from angles in degrees: a square of an angle is that of three components."""
    each, overall = _mean(np.square(np.radians(error)) / 3)
    with np.errstate(divide="ignore"):
        return (
            20 * np.log10(np.pi) - 10 * np.log10(each),
            float(20 * np.log10(np.pi) - 10 * np.log10(np.float64(overall))),
        )


def _percentile(values: Values) -> Column:
    present = values[~np.isnan(values)]
    overall = float(np.percentile(present, 95)) if len(present) else float("nan")
    return _samples.percentile(values, 95), overall


def _largest(values: Values) -> Column:
    known = np.where(np.isnan(values), -np.inf, values)
    largest = np.max(known, axis=0, initial=-np.inf)
    largest = np.where(np.isinf(largest), np.nan, largest)
    present = largest[~np.isnan(largest)]
    return largest, float(present.max()) if len(present) else float("nan")


def _noise(q: Values) -> Column:
    noise = np.degrees(noise_level(q).astype(np.float64))
    return noise, float(np.sqrt(np.mean(noise**2))) if len(noise) else float("nan")


def model(before: Side) -> str:
    """Return in words what was measured of the noise."""
    found = noise_model(before.rotations, fps=1.0 if before.fps is None else before.fps)
    return "; ".join(f"{name}: {value}" for name, value in found.describe())


def _peak(reference: Values, other: Values) -> Column:
    each = peaks_kept(reference, other)
    return each, float(_samples.mean(each))


def _count(samples: Mask) -> Column:
    return np.sum(samples, axis=0), int(np.sum(samples))


def feet(before: Side, after: Side, reference: Side | None = None) -> tuple[Foot, ...]:
    """Measure how far the feet slide."""
    if before.motion is None or after.motion is None:
        return ()
    ground = after.motion if reference is None or reference.motion is None else reference.motion
    names = [before.names[joint] for joint in foot_joints(before.motion.skeleton)]
    if not names:
        return ()
    slides = [
        np.asarray(metrics.foot_slide(motion, reference=ground, feet=names, per="joint"), np.float64)
        for motion in (before.motion, after.motion, ground)
    ]
    own = slides[2] if reference is not None else np.full(len(names), np.nan)
    return tuple(
        Foot(name, *map(float, values))
        for name, *values in zip(names, slides[0], slides[1], own, strict=True)
    )


def foot_scale(before: Side) -> float:
    """Return the factor by which lengths of the feet were multiplied; 1 without a skeleton."""
    return 1.0 if before.motion is None else metrics.foot_scale(before.motion)


__all__ = ["Foot", "Joint", "Placed", "feet", "foot_scale", "joints", "model", "placed"]
