"""The noise level of a clip, estimated from the clip."""

import math

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.noise.coherence import noise_of
from quatfilt._reference.rotations.quaternion import between, is_missing, log_short, normalize

ORDERS = (4, 6, 8)
"""Orders of the differences of the motion. Each takes away what a polynomial of one degree less describes."""

MEDIAN_OF_NORMAL = 0.6744897501960817
"""Median of `|x|` for a normal `x` with deviation 1."""

FEWEST = 2
"""Least number of differences whose median is taken."""

HEAVY = 0.25
"""Radians from which noise is heavy: increments of two samples are not the sums of their noises any more, and beyond half a turn they
come out as smaller ones. Their differences read 1 % too low at 0.25, 2 % at 0.5, 16 % at 0.8, and no more than 0.71 at all."""

LAGS = (1, 2, 3, 4)
"""Frames between the samples of the pairs that heavy noise is read off."""


def noise_level(q: Reals) -> Reals:
    """Estimate the deviation of white noise per component of the rotation vector, in radians: `(joints,)`.

    The increments in the frame of the body, `ω_t = 2 log(q_t⁻¹ q_{t+1})`, are first differences of the motion. Of the
    n-th differences `Δⁿ⁻¹ω` smooth motion leaves little, and white noise of deviation `σ` has `σ √C(2n, n)`. Hence for
    each coordinate

        `σ̂ = median |Δⁿ⁻¹ω| / √C(2n, n) / 0.6745`,

    for each joint the root mean square over its three coordinates, and of the orders 4, 6 and 8 the smallest, because
    motion can only add. Differences that touch a missing sample are left out. An order with fewer than two differences
    does not count, and without any order the level is 0.

    Heavy noise is read off pairs of samples instead. Rotations with noise of the coherence `f` (:func:`.coherence.coherence`)
    about the same rotation have `E (4 (q·q')² − 1)/3 = f²`. Motion takes away from that by the square of the lag between the two,
    but for higher powers; so `f²` is where a straight line over the squared lags 1, 4, 9, 16 comes to 0. Joints with fewer than two
    pairs at one of the lags keep the level of the differences.

    The mean over many clips of white noise is 2 % too high at 30 frames, 5 % at 20, 10 % at 12; from 40 to 2000 frames
    it is within 2 %. One clip's deviation from that is 20 % at 30 frames, 7 % at 200, 2 % at 2000. A swing of 60° to
    either side at 3 Hz and 30 frames per second, with noise of 0.016 rad, reads 1 % too low, where order 4 alone reads
    11 % too high. What moves faster stays in: CMU's walks and dances at 30 frames per second read 1 to 9 % too high on
    average over the joints with 0.016 rad, a run of 37 frames 24 %; all are within 4 % with 0.08 rad or more, and at
    120 frames per second.

    Positions have a level too, in their unit: their increments are plain differences.

    Parameters
    ----------
    q : array (frames, joints, 4) or (frames, points, 3)
        Rotations, or positions without missing ones.
    """
    level = np.min([level_of_order(increments(q), order) for order in ORDERS], axis=0)
    level = np.where(np.isfinite(level), level, 0)
    if q.shape[-1] == 4 and (level >= HEAVY).any():
        heavy = heavy_level(q)
        level = np.where((level >= HEAVY) & np.isfinite(heavy), heavy, level)
    return np.asarray(level, q.dtype)


def heavy_level(q: Reals) -> Reals:
    """Noise level from pairs of samples; NaN for joints with fewer than two of them at one of the lags; `(joints,)`."""
    missing = is_missing(q)
    rotations = normalize(np.where(missing[..., None], 1.0, q.astype(np.float64)))
    likeness = np.full((len(LAGS), q.shape[1]), np.nan)
    for row, lag in zip(likeness, LAGS, strict=True):
        pairs = ~(missing[lag:] | missing[:-lag])
        alike = (4 * np.sum(rotations[lag:] * rotations[:-lag], axis=-1) ** 2 - 1) / 3
        count = pairs.sum(axis=0)
        total = np.where(pairs, alike, 0).sum(axis=0)
        row[count >= FEWEST] = (total / np.maximum(count, 1))[count >= FEWEST]
    squares = np.square(LAGS, dtype=np.float64)
    around = squares - squares.mean()
    at_zero = 1 / len(LAGS) - squares.mean() * around / np.sum(around**2)
    length = np.sqrt(np.maximum(at_zero @ likeness, 0))
    return np.where(np.isfinite(length), noise_of(np.where(np.isfinite(length), length, 1)), np.nan)


def increments(q: Reals) -> Reals:
    """Rotation vectors from each frame to the next, NaN beside missing samples; `(frames − 1, joints, 3)`.

    Of positions `(frames, points, 3)` the differences.
    """
    if q.shape[-1] == 3:
        return np.diff(q.astype(np.float64), axis=0)
    missing = is_missing(q)
    rotations = normalize(np.where(missing[..., None], 1.0, q.astype(np.float64)))
    result = 2 * log_short(between(rotations[:-1], rotations[1:]))
    result[missing[:-1] | missing[1:]] = np.nan
    return result


def level_of_order(steps: Reals, order: int) -> Reals:
    """Noise level from the differences of one order; infinite for joints with fewer than two of them; `(joints,)`."""
    joints = steps.shape[1]
    differences = np.abs(np.diff(steps, n=order - 1, axis=0))
    level = np.full(joints, np.inf)
    for joint in range(joints):
        usable = differences[np.isfinite(differences[:, joint, 0]), joint]
        if len(usable) >= FEWEST:
            deviation = np.median(usable, axis=0) / math.sqrt(math.comb(2 * order, order)) / MEDIAN_OF_NORMAL
            level[joint] = np.sqrt(np.mean(deviation**2))
    return level
