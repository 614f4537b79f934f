"""Means of columns of numbers along time under a mask."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.filters.boundary import Boundary, extend_by_index, extend_vectors


def gaussian_mask(sigma: float) -> Reals:
    """Gaussian weights `(2·radius + 1,)` of deviation `sigma` frames, cut off at four deviations, with the sum 1."""
    radius = int(4 * sigma + 0.5)
    lags = np.arange(-radius, radius + 1)
    weights = np.exp(-0.5 * (lags / sigma) ** 2)
    return np.asarray(weights / weights.sum())


def weighted_mean(columns: Reals, trust: Reals | None, mask: Reals, boundary: Boundary) -> Reals:
    """Take means of columns `(frames, k)`, at least two frames, under a mask whose sum is 1.

    With the trust `c` of the frames, `Σ_j m_j c_{t+j} x_{t+j} / Σ_j m_j c_{t+j}`; where none under the mask is trusted, the
    column stays as it is.
    """
    radius = len(mask) // 2
    around = extend_vectors(columns, radius, boundary)
    if trust is None:
        return masked(around, mask)
    weights = extend_by_index(trust[:, None], radius, boundary)
    total = masked(weights, mask)
    mean = masked(weights * around, mask)
    return np.where(total > 0, mean / np.where(total > 0, total, 1), columns)


def masked(around: Reals, mask: Reals) -> Reals:
    """Add up `Σ_j m_j x_{t+j}` along columns that go on by the mask's radius beyond both ends."""
    frames = len(around) - len(mask) + 1
    result = np.zeros((frames, around.shape[1]))
    for j, weight in enumerate(mask):
        result += weight * around[j : j + frames]
    return result
