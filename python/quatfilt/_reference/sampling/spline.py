"""From frames to the source's measurements, and back by a cubic spline of the development."""

import itertools

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.filters.development import carried_about
from quatfilt._reference.filters.smooth.penalised import solve
from quatfilt._reference.motion.skeleton import rotate
from quatfilt._reference.rotations.quaternion import (
    between,
    conjugate,
    continuous,
    exp,
    is_missing,
    log_short,
    multiply,
    norm,
    normalize,
)

JUMP = 1.0
"""Radians between two samples from which a joint jumps: a spline through a jump would swing on both sides of it."""

ROUNDS = 4
"""How often the path is smoothed about the result of the round before."""


def knots(q: Reals, times: Reals) -> Reals:
    """Return rotations, or positions, at times between frames: the frame before, moved on by the increment that leads to it.

    `q_k exp(f w_{k−1} / 2)` with `k = ⌊t⌋` and `f = t − k`. A knot between two frames lies on the geodesic before it.

    Parameters
    ----------
    q : array (frames, joints, 4) or (frames, points, 3)
    times : array (n,), frames
    """
    whole = np.floor(times).astype(np.intp)
    part = (times - whole)[:, None, None]
    before = np.maximum(whole - 1, 0)
    values: Reals = q.astype(np.float64)
    if q.shape[-1] == 3:
        return np.asarray(values[whole] + part * (values[whole] - values[before]), q.dtype)
    gone = is_missing(q)
    values = normalize(np.where(gone[..., None], [1.0, 0, 0, 0], values))
    moved = multiply(values[whole], exp(part * log_short(between(values[before], values[whole]))))
    lost = gone[whole] | (gone[before] & (part[..., 0] > 0))
    return np.where(lost[..., None], np.nan, moved).astype(q.dtype)


def spline(q: Reals, times: Reals, new_times: Reals, cutoff: float) -> Reals:
    """Return rotations, or positions, at new times along a natural cubic spline of their development.

    The development in the frame that is carried along, see :mod:`~quatfilt._reference.filters.development`, is a path in R³. With a
    cutoff, it is first smoothed: `ROUNDS` times about the result of the round before,

        `Σ h_i |x_i − y_i|² + λ ∫ |x″|² dt → min`,    `λ = (2π · cutoff)⁻⁴`,

    with the local spacing `h_i` of the times as weights: gain 1/(1 + (f/cutoff)⁴). Beyond the ends the spline is a straight line.
    Where a joint turns by more than `JUMP` between two samples, its spline is cut, and a geodesic leads across.

    Parameters
    ----------
    q : array (n, joints, 4) or (n, points, 3)
        Where a rotation is missing, the spline leads from its neighbours to each other, and new times beside it are missing.
    times : array (n,), increasing
    new_times : array (m,)
    cutoff : float, cycles per unit of the times
        0 for a spline through all samples.

    Returns
    -------
    array (m, joints, 4) or (m, points, 3)
        Unit quaternions, continuous in sign; NaN beside missing samples.
    """
    result = np.full((len(new_times), *q.shape[1:]), np.nan)
    stiffness = (2 * np.pi * cutoff) ** -4.0 if cutoff > 0 else 0.0
    for joint in range(q.shape[1]):
        column = q[:, joint].astype(np.float64)
        gone = is_missing(column) if q.shape[-1] == 4 else np.zeros(len(column), bool)
        known = np.flatnonzero(~gone)
        if len(known) == 0:
            continue
        run = curve_of_vectors if q.shape[-1] == 3 else curve_of_rotations
        values = run(column[known], times[known], new_times, stiffness)
        result[:, joint] = np.where(beside(times, new_times, gone)[:, None], np.nan, values)
    return np.asarray(continuous(result) if q.shape[-1] == 4 else result, q.dtype)


def beside(times: Reals, new_times: Reals, gone: Mask) -> Mask:
    """Return the new times that are not between two samples that are there; `(m,)`."""
    left = interval(times, new_times)
    right = np.minimum(left + 1, len(times) - 1)
    at = times[left] == new_times
    return np.asarray(np.where(at, gone[left], gone[left] | gone[right]))


def interval(times: Reals, new_times: Reals) -> np.ndarray:
    """Return the index of the interval that each time lies in; the first and last one go on beyond the ends."""
    return np.clip(np.searchsorted(times, new_times, side="right") - 1, 0, max(len(times) - 2, 0))


def curve_of_vectors(values: Reals, times: Reals, new_times: Reals, stiffness: float) -> Reals:
    """Spline of vectors `(n, 3)`."""
    smooth = smoothed(values, times, stiffness) if stiffness > 0 else values
    return evaluated(smooth, times, new_times)


def curve_of_rotations(values: Reals, times: Reals, new_times: Reals, stiffness: float) -> Reals:
    """Splines of the development of rotations `(n, 4)`, cut where they jump; geodesics lead across the cuts."""
    path = continuous(normalize(values)[:, None])
    steps = 2 * norm(log_short(between(path[:-1, 0], path[1:, 0])))
    bounds = [0, *(np.flatnonzero(steps > JUMP) + 1).tolist(), len(path)]
    smooth = path.copy()
    for start, end in itertools.pairwise(bounds):
        smooth[start:end] = smooth_path(path[start:end], times[start:end], stiffness)
    left = interval(times, new_times)
    right = np.minimum(left + 1, len(times) - 1)
    span = np.where(right > left, times[right] - times[left], 1)
    part = np.clip((new_times - times[left]) / span, 0, 1)[:, None]
    result = multiply(smooth[left, 0], exp(part * log_short(between(smooth[left, 0], smooth[right, 0]))))
    for start, end in itertools.pairwise(bounds):
        inside = (new_times >= times[start]) | (start == 0)
        inside &= (new_times <= times[end - 1]) | (end == len(path))
        result[inside] = curve(smooth[start:end], times[start:end], new_times[inside])
    return normalize(result)


def smooth_path(path: Reals, times: Reals, stiffness: float) -> Reals:
    """Smooth a path `(n, 1, 4)` of rotations, `ROUNDS` times about the result of the round before."""
    reference = path
    for _ in range(ROUNDS if stiffness > 0 else 0):
        frame, development, vectors = carried_about(reference, path)
        moved = smoothed(vectors[:, 0], times, stiffness)[:, None]
        reference = normalize(multiply(reference, exp(rotate(conjugate(frame), moved - development) / 2)))
    return reference


def curve(path: Reals, times: Reals, new_times: Reals) -> Reals:
    """Spline of the development of a path `(n, 1, 4)` at new times."""
    frame, development, _ = carried_about(path, path)
    at = evaluated(development[:, 0], times, new_times)
    left = interval(times, new_times)
    way = rotate(conjugate(frame[left, 0]), at - development[left, 0])
    return normalize(multiply(path[left, 0], exp(way / 2)))


def smoothed(values: Reals, times: Reals, stiffness: float) -> Reals:
    """Values of the smoothing spline at its knots (Reinsch): `(R + λ Qᵀ W⁻¹ Q) γ = Qᵀ y`, `x = y − λ W⁻¹ Q γ`."""
    n, h = len(times), np.diff(times)
    if n < 3:
        return values
    weights = np.empty(n)
    weights[0], weights[-1] = h[0] / 2, h[-1] / 2
    weights[1:-1] = (h[1:] + h[:-1]) / 2
    # Column i of Q: second divided differences at the knots i, i + 1, i + 2.
    q = np.stack([1 / h[:-1], -1 / h[:-1] - 1 / h[1:], 1 / h[1:]])
    bands = curvature_bands(h)
    for k in range(3):
        for i in range(3 - k):
            # Entry (c + k, c) of QᵀW⁻¹Q: rows that columns c and c + k share.
            rows = n - 2 - k
            bands[k, :rows] += (
                stiffness * q[i, k : k + rows] * q[i + k, :rows] / weights[i + k : i + k + rows]
            )
    curvature = solved(bands, second_differences(values, h))
    bent = np.zeros_like(values)
    for i in range(3):
        bent[i : i + n - 2] += q[i][:, None] * curvature
    return np.asarray(values - stiffness * bent / weights[:, None])


def evaluated(values: Reals, times: Reals, new_times: Reals) -> Reals:
    """Natural cubic spline through values `(n, 3)` at new times; straight lines beyond the ends."""
    n = len(times)
    if n < 2:
        return np.repeat(values, len(new_times), axis=0)
    h = np.diff(times)
    curvature = np.zeros_like(values)
    if n > 2:
        curvature[1:-1] = solved(curvature_bands(h), second_differences(values, h))
    i = interval(times, new_times)
    inside = np.clip(new_times, times[0], times[-1])
    b = ((inside - times[i]) / h[i])[:, None]
    a, width = 1 - b, h[i][:, None]
    cubic = (a**3 - a) * curvature[i] + (b**3 - b) * curvature[i + 1]
    result = a * values[i] + b * values[i + 1] + cubic * width**2 / 6
    slope = (values[i + 1] - values[i]) / width
    slope += ((3 * b**2 - 1) * curvature[i + 1] - (3 * a**2 - 1) * curvature[i]) * width / 6
    return np.asarray(result + slope * (new_times - inside)[:, None])


def second_differences(values: Reals, h: Reals) -> Reals:
    """Second divided differences `Qᵀ y` of values at knots `h` apart, `(n − 2, 3)`."""
    slopes = np.diff(values, axis=0) / h[:, None]
    return np.diff(slopes, axis=0)


def curvature_bands(h: Reals) -> Reals:
    """Diagonal and bands below it of `R`, the Gram matrix of the hat functions of the inner knots; `(3, n − 2)`."""
    bands = np.zeros((3, len(h) - 1))
    bands[0] = (h[:-1] + h[1:]) / 3
    bands[1, :-1] = h[1:-1] / 6
    return bands


def solved(bands: Reals, right: Reals) -> Reals:
    """Solve a system of three bands for each column of the right side."""
    return np.stack([solve(bands, column) for column in right.T], axis=1)
