"""All measures of one motion against another, as the reports show them."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from quatfilt._typing import Array, Mask
from quatfilt.motion import metrics
from quatfilt.motion.motion import Motion
from quatfilt.rotations.quaternion import geodesic_distance

_FARTHEST_SHIFT = 12
"""Frames by which an estimate is looked for before and after its place."""

_ENOUGH = 1000
"""Frames that are compared at each shift; of longer clips every second, third, … frame."""


@dataclass(frozen=True)
class Measures:
    """An estimate against its reference.

    Parameters
    ----------
    psnr : float, decibels
        Peak signal-to-noise ratio of the rotations.
    angle_mean, angle_p95 : float, degrees
        Mean and 95th percentile of the rotation angle of the error.
    position : float, centimetres
        Mean distance of the joints.
    jerk_ratio : float
        Rotational jerk, estimate divided by reference.
    foot_slide, foot_slide_reference : float, centimetres
        Path of the feet while the reference's feet touch the ground, mean over the foot joints; NaN without any.
    peak_kept : float
        Share of the peak angular speed.
    delay : float, frames
        How much later the estimate comes than the reference; NaN for motion too short or too still to tell.
    """

    psnr: float
    angle_mean: float
    angle_p95: float
    position: float
    jerk_ratio: float
    foot_slide: float
    foot_slide_reference: float
    peak_kept: float
    delay: float

    def as_dict(self) -> dict[str, Any]:
        """Return the measures by name."""
        return asdict(self)


def measure(reference: Motion, estimate: Motion, *, joints: Mask | None = None) -> Measures:
    """Measure a motion against its reference.

    Parameters
    ----------
    reference, estimate : Motion
        Motions of the same joints and frames.
    joints : ndarray of bool, shape (joints,), or None
        The joints whose rotations count; None for all. Positions are always those of all joints.

    Returns
    -------
    Measures
        NaN where there is nothing to measure.

    Raises
    ------
    ValueError
        If joints or frames differ; the message says how.
    """
    position = float(metrics.position_error(reference, estimate))
    chosen = slice(None) if joints is None else np.flatnonzero(joints)
    truth, other = reference.rotations[:, chosen], estimate.rotations[:, chosen]
    angles = np.asarray(metrics.angle_error(truth, other, per="sample"))
    present = angles[~np.isnan(angles)]
    rough = float(metrics.jerk(truth))
    try:
        slides = metrics.foot_slide(estimate, reference=reference), metrics.foot_slide(reference)
    except ValueError:  # no joint is called a foot
        slides = np.nan, np.nan
    return Measures(
        psnr=float(metrics.psnr(truth, other)),
        angle_mean=float(np.mean(present)) if len(present) else np.nan,
        angle_p95=float(np.percentile(present, 95)) if len(present) else np.nan,
        position=position,
        jerk_ratio=float(metrics.jerk(other)) / rough if rough > 0 else np.nan,
        foot_slide=float(slides[0]),
        foot_slide_reference=float(slides[1]),
        peak_kept=float(metrics.peak_velocity_kept(truth, other)),
        delay=delay(truth, other),
    )


def delay(truth: Array, other: Array) -> float:
    """How many frames the second clip comes later than the first: where its mean squared angle to it is least.

    Between whole frames, a parabola through the three values around the least tells.
    """
    shifts = np.arange(-_FARTHEST_SHIFT, _FARTHEST_SHIFT + 1)
    if len(truth) < 4 * _FARTHEST_SHIFT or not truth.shape[1]:
        return float("nan")
    frames = np.arange(_FARTHEST_SHIFT, len(truth) - _FARTHEST_SHIFT)
    frames = frames[:: 1 + len(frames) // _ENOUGH]
    within = truth[frames]
    apart = np.zeros(len(shifts))
    for place, shift in enumerate(shifts):
        squares = np.square(geodesic_distance(within, other[frames + shift]))
        apart[place] = np.nanmean(squares) if np.isfinite(squares).any() else np.nan
    least = int(np.argmin(np.where(np.isnan(apart), np.inf, apart)))
    if not 0 < least < len(shifts) - 1 or np.isnan(apart).any():
        return float("nan")
    before, here, after = apart[least - 1 : least + 2]
    curvature = before - 2 * here + after
    return float(shifts[least] + (before - after) / (2 * curvature)) if curvature > 0 else float("nan")


__all__ = ["Measures", "delay", "measure"]
