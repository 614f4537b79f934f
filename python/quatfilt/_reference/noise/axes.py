"""Noise that differs between directions: its axes, and how large it is along each."""

import numpy as np

from quatfilt._reference._arrays import Reals
from quatfilt._reference.noise.noise import increments

ORDER = 6
"""Order of the differences whose directions are looked at."""

ROUNDS = 12
"""Rounds of Tyler's iteration: after them the shape changes in the third digit at most."""

FEWEST = 12
"""Least number of differences that show a shape."""

LEAST_RATIO = 1e-3
"""Least share of a direction in the largest: below it a joint turns about fixed axes, and the rest is rounding."""


def noise_axes(q: Reals) -> tuple[Reals, Reals]:
    """Return the axes of the noise of each joint, and how large it is along each in units of the level.

    Tyler's shape `C` of the differences `d_t = Δ⁶` in the frame of the body, which knows their directions and not their lengths, is
    the fixed point of `C ∝ Σ_t d_t d_tᵀ / (d_tᵀ C⁻¹ d_t)`. With `C = V diag(s²) Vᵀ` and `Σ s² = 3`, `s` are deviations along the columns
    of `V`: 1, 1, 1 where all directions are alike.

    Parameters
    ----------
    q : array (frames, joints, 4)
        Rotations; differences that touch a missing sample are left out.

    Returns
    -------
    spread : array (joints, 3), float64
        `s`, increasing; at least 0.001 of the largest.
    axes : array (joints, 3, 3), float64
        `V`: the axes are columns. The unit matrix for joints with fewer than 12 differences, or at rest.
    """
    joints = q.shape[1]
    spread, axes = np.ones((joints, 3)), np.tile(np.eye(3), (joints, 1, 1))
    if len(q) <= ORDER:
        return spread, axes
    differences = np.diff(increments(q), n=ORDER - 1, axis=0)
    for joint in range(joints):
        own = differences[:, joint]
        own = own[np.isfinite(own).all(axis=-1) & (own != 0).any(axis=-1)]
        if len(own) >= FEWEST:
            squares, axes[joint] = np.linalg.eigh(shape(own))
            spread[joint] = np.sqrt(np.maximum(squares, LEAST_RATIO**2 * squares[2]))
            spread[joint] *= np.sqrt(3 / np.sum(spread[joint] ** 2))
    return spread, axes


def shape(vectors: Reals) -> Reals:
    """Tyler's shape of vectors `(n, 3)` with the trace 3; directions without any keep a small share."""
    result = np.eye(3)
    for _ in range(ROUNDS):
        lengths = np.einsum("ti,ij,tj->t", vectors, np.linalg.inv(result), vectors)
        result = (vectors / lengths[:, None]).T @ vectors
        result *= 3 / np.trace(result)
        # Without it the shape of a joint that turns about one axis has no inverse.
        result += LEAST_RATIO**2 * np.eye(3)
    return result
