"""What all joints do together is of low rank: a few movements at a time, in each band of frequencies.

M. Gavish and D. L. Donoho, *Optimal Shrinkage of Singular Values*, IEEE Transactions on Information Theory 63(4), 2017.
"""

import itertools
import math

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.development import developed_about, undevelop
from quatfilt._reference.filters.smooth.strength import block_starts
from quatfilt._reference.rotations.quaternion import normalize

WINDOW = 512
"""Frames of a window, at most: long enough to show what goes together, short enough for a body to do few things."""

LONGEST_PERIOD = 60
"""Frames: the first band holds longer periods, each other one those down to half of the one before it."""

FEWEST = 128
"""Frames of a clip, at least: in shorter ones few cosines share a band, and chance looks like rank."""

LEAST_JOINTS = 4
"""Noisy joints, at least: with fewer there is nothing of low rank to be found."""

LEAST_NOISE = 1e-6
"""Radians per component below which a joint has no noise: little more than roundings in float32."""

VARIANCE = 0.3
"""Of the mean of pilot and samples, the variance of the errors, where the noise has 1. Were the pilot free of them it would be
a quarter; what it lets through is the same noise."""

SHARE = 0.35
"""Share of the estimate of low rank beside the pilot. Its errors are others than the pilot's."""


def smooth_rank(q: Reals, pilot: Reals, confidence: Reals | None, noise: Reals) -> Reals:
    """Take the mean of an estimate of the clean rotations and of one that has low rank in bands of frequencies.

    The vectors of all joints about the pilot, in units of their noise, make a matrix of poses; the cosine transforms of windows of
    it are cut in bands, and the singular values of each band are shrunk.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Noisy rotations without missing samples.
    pilot : array (frames, joints, 4)
        The estimate.
    confidence : array (frames, joints) or None
        From 0 to 1: how much of the way from the pilot to a sample counts.
    noise : array (joints,), float64, radians
        Deviation of the noise per component of the rotation vector. Joints with less than `LEAST_NOISE` stay as the pilot has
        them, and have no say.

    Returns
    -------
    array (frames, joints, 4)
        Unit quaternions, continuous in sign from the hemisphere of the first frame of `q`.
    """
    noisy = np.flatnonzero(noise >= LEAST_NOISE)
    path, about = (normalize(x.astype(np.float64)) for x in (q, pilot))
    moved = np.zeros((*q.shape[:2], 3))
    if len(q) < FEWEST or len(noisy) < LEAST_JOINTS:
        return undevelop(q, about, moved, moved)
    about, development, vectors = developed_about(about, path)
    trust = np.ones(q.shape[:2]) if confidence is None else confidence.astype(np.float64)
    scale = noise[noisy, None]
    clean = (development[:, noisy] / scale).reshape(len(q), -1)
    rest = (trust[..., None] * (vectors - development))[:, noisy] / scale
    move = SHARE * moves(clean, rest.reshape(len(q), -1))
    moved[:, noisy] = move.reshape(len(q), len(noisy), 3) * scale
    return undevelop(q, about, np.zeros_like(moved), moved)


def moves(clean: Reals, rest: Reals) -> Reals:
    """Return how far the estimates of low rank lie from the pilot, the mean of all windows.

    A window counts most in its middle, where the next one has its end.

    Parameters
    ----------
    clean : array (frames, columns)
        The pilot, in units of the noise.
    rest : array (frames, columns)
        From the pilot to the samples.
    """
    frames = len(clean)
    length = min(WINDOW, frames)
    cosines = basis(length)
    weight = np.minimum(np.arange(1, length + 1), np.arange(length, 0, -1))[:, None]
    total = np.zeros_like(clean)
    count = np.zeros((frames, 1))
    for start in block_starts(frames, length):
        here = slice(start, start + length)
        half = cosines @ rest[here] / 2
        middle = cosines @ clean[here] + half
        move = np.zeros_like(middle)
        for first, end in bands(length):
            move[first:end] = half[first:end] - removed(middle[first:end])
        total[here] += weight * (cosines.T @ move)
        count[here] += weight
    return total / count


def basis(length: int) -> Reals:
    """All orthonormal cosines over a window, a row for each."""
    order = np.arange(length)[:, None]
    cosines = np.cos(np.pi * order * (2 * np.arange(length) + 1) / (2 * length))
    return np.asarray(np.where(order == 0, np.sqrt(1 / length), np.sqrt(2 / length)) * cosines)


def bands(length: int) -> list[tuple[int, int]]:
    """First cosines of the bands, and the first ones after them. The mean of a window is in none.

    The cosine `k` has a period of `2 length / k` frames.
    """
    edges = [1]
    while edges[-1] < length:
        edges.append(min(length, math.ceil(2 * length / LONGEST_PERIOD * 2 ** (len(edges) - 1))))
    return list(itertools.pairwise(edges))


def removed(middle: Reals) -> Reals:
    """Return what the best estimate of low rank takes away from a matrix with errors of `VARIANCE`.

    With `λ` for the squares of the singular values and `y² = λ / (VARIANCE · n)`, `n` the longer side and `β ≤ 1` the ratio of the
    sides, each singular value is left a share of

        `√((y² − β − 1)² − 4β) / y²` where `y > 1 + √β`, else 0:

    the least squared error if the errors are white and the matrix is large.
    """
    rows, columns = middle.shape
    by_rows = rows <= columns
    squares, vectors = np.linalg.eigh(middle @ middle.T if by_rows else middle.T @ middle)
    beta = min(rows, columns) / max(rows, columns)
    y2 = squares / (VARIANCE * max(rows, columns))
    kept = np.zeros_like(y2)
    seen = y2 > (1 + math.sqrt(beta)) ** 2
    kept[seen] = np.sqrt((y2[seen] - beta - 1) ** 2 - 4 * beta) / y2[seen]
    taken = (vectors * (1 - kept)) @ vectors.T
    return np.asarray(taken @ middle if by_rows else middle @ taken)
