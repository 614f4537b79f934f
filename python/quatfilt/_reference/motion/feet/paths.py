"""Paths of foot joints: the best estimate from a path and its filtered version."""

from typing import cast

import numpy as np

from quatfilt._reference._arrays import Mask, Reals
from quatfilt._reference.filters.smooth.smooth import smooth
from quatfilt._reference.noise.noise import noise_level


def completed(path: Reals, known: Mask, other: Reals | None = None) -> Reals:
    """Fill the unknown frames of a path `(frames, 3)` from another path, and along straight lines where that is unknown too."""
    result = path.copy()
    if other is not None:
        there = ~known & np.isfinite(other).all(axis=1)
        result[there] = other[there]
        known = known | there
    if known.any() and not known.all():
        frames = np.arange(len(path))
        for column in range(path.shape[1]):
            result[~known, column] = np.interp(frames[~known], frames[known], result[known, column])
    return result


def estimated(x: Reals, f: Reals) -> tuple[Reals, float]:
    """Estimate a path from the input's path `x` and its filtered version `f`, `(frames, 3)` without unknown frames.

    A filter that removes more than noise has removed motion. With the noise level `ν` of the input's path and the mean square change per
    coordinate, `r² = Σ‖x − f‖² / 3T`, the part of the change that is no noise is

        `g = 1 − ν² / r²`, at least 0,    and    `y = f + g (smooth(x) − f)`.

    Returns
    -------
    y : array (frames, 3)
    noise : float
        `ν`, in the unit of the path.
    """
    noise = float(noise_level(x[:, None])[0])
    change = float(np.mean((x - f) ** 2))
    share = max(1 - noise**2 / change, 0.0) if change > 0 else 0.0
    if share == 0:
        return f.copy(), noise
    rest = np.tile([1.0, 0.0, 0.0, 0.0], (len(x), 1, 1))
    smoothed = cast("Reals", smooth(rest, x, None, np.zeros(1), noise)[1])
    return f + share * (smoothed - f), noise
