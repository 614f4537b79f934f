"""Gaps: runs of missing samples."""

from typing import Literal

import numpy as np

from quatfilt._reference._arrays import Indices, Mask, Reals
from quatfilt._reference.rotations.quaternion import (
    between,
    continuous,
    exp,
    is_missing,
    log,
    log_short,
    multiply,
    normalize,
)
from quatfilt._reference.rotations.resample import slerp

Method = Literal["slerp", "squad"]


def fill_gaps(q: Reals, max_gap: int, method: Method) -> tuple[Reals, Mask]:
    """Fill the runs of missing samples of each joint.

    A run between two valid samples is filled along the way from one to the other, see :func:`interpolate`. A run at an
    end of the clip is held at the nearest valid sample. Runs longer than `max_gap`, and joints without any valid sample,
    stay missing: NaN in all four components.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations.
    max_gap : int, frames
        The longest run that is filled; −1: any.
    method : "slerp" or "squad"
        Whether the way is the shorter geodesic, at constant angular velocity, or takes up the angular velocities at
        its ends.

    Returns
    -------
    rotations : array (frames, joints, 4)
        Continuous in sign from the first valid sample. The valid samples are otherwise as they were.
    filled : array (frames, joints) of bool
        Where samples have been filled in.
    """
    missing = is_missing(q)
    filled = np.zeros(missing.shape, bool)
    result = q.copy()
    result[missing] = np.nan
    for joint in range(q.shape[1]):
        valid = np.flatnonzero(~missing[:, joint])
        if len(valid) == 0:
            continue
        for start, end in runs(missing[:, joint]):
            filled[start:end, joint] = max_gap < 0 or end - start <= max_gap
        gaps = np.flatnonzero(filled[:, joint])
        times = np.clip(gaps, valid[0], valid[-1])
        result[gaps, joint] = interpolate(q[valid, joint], valid, times, method)
    return continuous(result), filled


def runs(mask: Mask) -> list[tuple[int, int]]:
    """First index, and index after the last, of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    return [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]


def interpolate(path: Reals, times: Indices, new_times: Indices, method: Method) -> Reals:
    """Rotations of one joint, `(frames, 4)`, at new times in frames within the range of `times`."""
    if method == "slerp" or len(path) < 2:
        return slerp(path[:, None], times.astype(np.float64), new_times.astype(np.float64))[:, 0]
    return squad(continuous(path[:, None])[:, 0], times, new_times).astype(path.dtype)


def squad(path: Reals, times: Indices, new_times: Indices) -> Reals:
    """Shoemake's spherical cubic through samples that are continuous in sign: `(n, 4)`.

    Between the samples `a` and `b`, which lie `h` frames apart, at the part `u` of the way,

        `q(u) = S(S(a, b, u), S(a⁺, b⁻, u), 2u(1 − u))`,    `S(x, y, u) = x · exp(u log(x⁻¹ y))`

        `a⁺ = a · exp((h ω_a − log(a⁻¹ b)) / 2)`,    `b⁻ = b · exp((log(a⁻¹ b) − h ω_b) / 2)`

    with the angular velocities of :func:`velocities`, which are those of the curve at its ends. At equal distances in
    time these are Shoemake's control points. About one axis the curve is the cubic with these values and slopes.
    """
    path = normalize(path.astype(np.float64))
    left = np.clip(np.searchsorted(times, new_times, side="right") - 1, 0, len(times) - 2)
    h = (times[left + 1] - times[left])[:, None]
    u = (new_times - times[left])[:, None] / h
    speed = velocities(path, times)
    a, b = path[left], path[left + 1]
    chord = log_short(between(a, b))
    after_a = multiply(a, exp((h * speed[left] - chord) / 2))
    before_b = multiply(b, exp((chord - h * speed[left + 1]) / 2))
    return along(along(a, b, u), along(after_a, before_b, u), 2 * u * (1 - u))


def along(x: Reals, y: Reals, part: Reals) -> Reals:
    """Rotation at `part` of the way from `x` to `y` on the sphere of quaternions, signs taken as they are."""
    return multiply(x, exp(part * log(between(x, y))))


def velocities(path: Reals, times: Indices) -> Reals:
    """Half the rotation vectors per frame at the samples of a path, `(n, 3)`.

    At a sample between two others it is the slope of the parabola through the three,
    `(h⁺ ω⁻ + h⁻ ω⁺) / (h⁻ + h⁺)` for velocities `ω⁻`, `ω⁺` over `h⁻` frames before and `h⁺` after it; at the ends of the
    clip that of the geodesic.
    """
    h = np.diff(times)[:, None]
    slopes = log_short(between(path[:-1], path[1:])) / h
    inner = (h[1:] * slopes[:-1] + h[:-1] * slopes[1:]) / (h[:-1] + h[1:])
    return np.concatenate([slopes[:1], inner, slopes[-1:]])
