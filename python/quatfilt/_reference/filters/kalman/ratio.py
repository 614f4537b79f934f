"""How stiff the filter is to be: process noise in units of measurement noise, chosen from the clip itself.

P. Craven and G. Wahba, *Smoothing Noisy Data with Spline Functions*, 1979: generalised cross-validation.
"""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Indices, Reals
from quatfilt._reference.filters.displacements import displacement_between
from quatfilt._reference.filters.kalman import rotations, vectors
from quatfilt._reference.filters.kalman.covariance import Covariance
from quatfilt._reference.rotations.quaternion import normalize

STEP = 0.5
"""Decades between the candidates."""

CANDIDATES = 10.0 ** (-9 + STEP * np.arange(24))
"""Ratios of process variance to measurement variance, per frame³. With the least of them the smoother sees some 200
frames to either side, with the largest it hardly changes anything."""

FEWEST = 8
"""Least number of measurements from which a ratio is chosen; with fewer it is 1."""

KNOWN = 2
"""So many measurements make the first velocity. A forecast before tells nothing."""


class Scores(NamedTuple):
    """What each candidate did to each joint, summed over the measurements; arrays `(candidates · joints,)`."""

    forecast_errors: Reals
    """Squares of the innovations, each times its confidence."""
    forecasts: Reals
    """Sum of these confidences."""
    residuals: Reals
    """Squared ways from the smoothed values to the measurements, each times its confidence."""
    shares: Reals
    """Shares that the measurements have in their own smoothed values."""


def kalman_process_noise(
    q: Reals, confidence: Reals | None, measurement_noise: Reals, block: int, lookahead: int
) -> Reals:
    """Choose the process noise of :func:`.rotations.kalman`, `(joints,)`, radians / frame^1.5.

    Each of the candidates is tried. The forward filter, `lookahead` 0, takes the one whose forecasts lie nearest to the
    samples that follow. The smoother goes on from there to a minimum of the generalised cross-validation

        `Σ c |z − x|² / (1 − Σ h / n)²`

    of the `n` samples `z` with confidence `c`, their smoothed values `x`, and the share `h` of each sample in its own
    smoothed value. A parabola through the logarithms of the neighbours refines the choice.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations without missing samples.
    confidence : array (frames, joints) or None
    measurement_noise : array (joints,), radians
    block : int, frames
        The clip consists of blocks of so many frames that do not hang together.
    lookahead : int, frames
    """
    joints = q.shape[1]
    trust = np.ones(q.shape[:2]) if confidence is None else confidence.astype(np.float64)
    # All candidates together, as if each joint were there for each of them.
    samples = np.tile(normalize(q.astype(np.float64)), (1, len(CANDIDATES), 1))
    variance = np.tile(measurement_noise**2, len(CANDIDATES))
    process_variance = np.repeat(CANDIDATES, joints) * variance
    total = Scores(*np.zeros((4, len(variance))))
    for start in range(0, len(samples), block):
        frames = slice(start, start + block)
        weights = np.tile(trust[frames], (1, len(CANDIDATES)))
        total = added(total, rotation_scores(samples[frames], weights, process_variance, variance))
    measured = np.count_nonzero(trust > 0, axis=0)
    return np.sqrt(chosen(total, measured, lookahead)) * measurement_noise


def kalman_vectors_ratio(x: Reals, block: int, lookahead: int) -> Reals:
    """Choose the ratio of :func:`.vectors.kalman_vectors`, `(columns,)`, as :func:`kalman_process_noise` does."""
    columns = x.shape[1]
    values = np.tile(x.astype(np.float64), (1, len(CANDIDATES)))
    ratio = np.repeat(CANDIDATES, columns)
    total = Scores(*np.zeros((4, len(ratio))))
    for start in range(0, len(x), block):
        total = added(total, vector_scores(values[start : start + block], ratio))
    return chosen(total, np.full(columns, len(x)), lookahead)


def added(a: Scores, b: Scores) -> Scores:
    """Return the scores of two blocks together."""
    return Scores(*(x + y for x, y in zip(a, b, strict=True)))


def rotation_scores(samples: Reals, trust: Reals, process_variance: Reals, variance: Reals) -> Scores:
    """Judge what the filter does to a block of rotations, `(frames, joints, 4)`."""
    states, innovations = zip(*rotations.forward(samples, trust, process_variance, variance), strict=True)
    smooth = rotations.smoothed(list(states), trust, process_variance, len(samples) - 1, 0)[::-1]
    residuals = np.array([displacement_between(*pair) for pair in zip(samples, smooth, strict=True)])
    own = trust * smoothed_variances([state.covariance for state in states], process_variance) / variance
    # How many samples there were before.
    before: Indices = np.cumsum(trust > 0, axis=0) - (trust > 0)
    judging = np.where(before >= KNOWN, trust, 0)
    return Scores(
        np.sum(judging * np.sum(np.square(innovations), axis=-1), axis=0),
        np.sum(judging, axis=0),
        np.sum(trust * np.sum(np.square(residuals), axis=-1), axis=0),
        np.sum(own, axis=0),
    )


def vector_scores(x: Reals, ratio: Reals) -> Scores:
    """Judge what the filter does to a block of numbers, `(frames, columns)`."""
    states, innovations = zip(*vectors.forward(x, ratio), strict=True)
    residuals = x - vectors.smoothed(list(states), ratio, len(x) - 1, 0)[::-1]
    return Scores(
        np.sum(np.square(innovations[KNOWN:]), axis=0) if len(x) > KNOWN else np.zeros(x.shape[1]),
        np.full(x.shape[1], max(len(x) - KNOWN, 0.0)),
        np.sum(np.square(residuals), axis=0),
        np.sum(smoothed_variances([state.covariance for state in states], ratio), axis=0),
    )


def smoothed_variances(covariances: list[Covariance], process_variance: Reals) -> Reals:
    """Variances of the smoothed poses, `(frames, joints)`."""
    smooth = np.stack(covariances[-1][:3])
    result = [smooth[0]]
    for covariance in covariances[-2::-1]:
        smooth = covariance.smoothed(smooth, process_variance)
        result.append(smooth[0])
    return np.array(result[::-1])


def chosen(scores: Scores, measured: Indices, lookahead: int) -> Reals:
    """Return the best ratio of each joint, of which `measured` samples have confidence."""
    result = np.ones(len(measured))
    errors, weights, residuals, shares = (x.reshape(len(CANDIDATES), -1) for x in scores)
    with np.errstate(divide="ignore", invalid="ignore"):
        forecast = errors / weights
        validation = residuals / np.maximum(1 - shares / measured, 0) ** 2
    for joint in np.flatnonzero(measured >= FEWEST):
        criterion, best = forecast[:, joint], int(np.argmin(forecast[:, joint]))
        if lookahead != 0:
            criterion = validation[:, joint]
            best = descended(criterion, best)
        result[joint] = CANDIDATES[best] * 10 ** (STEP * vertex(criterion, best))
    return result


def descended(criterion: Reals, start: int) -> int:
    """Return the minimum to which steps to the better neighbour lead."""
    best = start
    while True:
        near = [i for i in (best - 1, best + 1) if 0 <= i < len(criterion) and criterion[i] < criterion[best]]
        if not near:
            return best
        best = min(near, key=lambda i: criterion[i])


def vertex(criterion: Reals, best: int) -> float:
    """Where the parabola through the logarithms of a minimum and its neighbours has its vertex, in steps from it."""
    around = criterion[max(best - 1, 0) : best + 2]
    if len(around) < 3 or not (np.isfinite(around) & (around > 0)).all():
        return 0.0
    before, here, after = np.log(around)
    bend = before - 2 * here + after
    return float((before - after) / (2 * bend)) if bend > 0 else 0.0
