"""What noise leaves of a mean of rotations, and which noise leaves so much."""

import math

import numpy as np

from quatfilt._reference._arrays import Reals

MOST_NOISE = math.sqrt(3)
"""Radians per component: the noise that leaves least of a mean. More noise cannot be told from it."""

HALVINGS = 60
"""How often the interval of the noise is halved: to the last digit."""


def coherence(noise: Reals) -> Reals:
    """Return the length of the mean rotation of noise, `|E R| / √3`: 1 without noise.

    For rotation vectors `v` with the deviation `σ` per component, of which the length has Maxwell's distribution,

        `E R = f I`,    `f = (1 + 2 E cos|v|) / 3`,    `E cos|v| = (1 − σ²) exp(−σ²/2)`,

    and so `E q qᵀ = f r rᵀ + (1 − f)/4 I` for quaternions `q` with this noise about `r`. Noise beyond half a turn comes out as a
    smaller turn the other way; the formula knows that.

    Parameters
    ----------
    noise : array, radians
        `σ`; what is above `MOST_NOISE` counts as that.
    """
    square = np.minimum(noise, MOST_NOISE) ** 2
    return np.asarray((1 + 2 * (1 - square) * np.exp(-square / 2)) / 3)


def noise_of(length: Reals) -> Reals:
    """Return the noise of a coherence: the inverse of `coherence`, 0 for what is above 1 and `MOST_NOISE` for what no noise leaves."""
    low, high = np.zeros_like(length), np.full_like(length, MOST_NOISE)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        more = coherence(middle) > length
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    return np.asarray(np.where(length >= 1, 0.0, high))
