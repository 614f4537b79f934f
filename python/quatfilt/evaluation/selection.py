"""The choice among candidates."""

import math

import numpy as np

from quatfilt._typing import Array
from quatfilt.evaluation.methods import Candidates, Clips
from quatfilt.rotations.quaternion import geodesic_distance


def best_of(candidates: Candidates, truth: Array, noisy: Clips) -> tuple[str, list[Array]]:
    """Return the setting of the candidate with the greatest mean PSNR over the versions, and its clips.

    Parameters
    ----------
    candidates : iterator
        Settings and clips.
    truth : ndarray (frames, joints, 4)
        The clip without noise.
    noisy : Clips
        What was filtered.

    Returns
    -------
    str
        The setting.
    list of ndarray (frames, joints, 4)
        The filtered versions.
    """
    beside = np.tile(truth, (1, noisy.versions, 1))
    best, chosen = -math.inf, None
    for setting, rotations in candidates:
        level = float(np.mean(levels(beside, rotations, noisy.versions)))
        if level > best:
            best, chosen = level, (setting, rotations)
    if chosen is None:
        raise ValueError("candidates: expected at least one with a finite error, got none")
    return chosen[0], noisy.apart(chosen[1])


def levels(truth: Array, rotations: Array, versions: int) -> list[float]:
    """PSNR of each version in decibels, both sides ``(frames, versions · joints, 4)``; see `metrics.psnr`."""
    squares = np.mean(np.square(geodesic_distance(truth, rotations)), axis=0)
    # Three components share the square of the angle.
    means = [float(np.mean(part)) / 3 for part in np.split(squares, versions)]
    return [20 * math.log10(math.pi) - 10 * math.log10(mean) if mean > 0 else math.inf for mean in means]


__all__ = ["best_of", "levels"]
