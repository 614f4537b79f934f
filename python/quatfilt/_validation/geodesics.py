"""Samples that have one centre, and parameters along geodesics through it."""

import math
from typing import Any

import numpy as np

from quatfilt._typing import Array, Mask
from quatfilt._validation.arrays import floats

_CUT = 1e-3
"""Radians: a sample so near to half a turn from the mean may be on either side of it."""

_MOST = 1e5
"""Radians: sine and cosine are exact up to there, and larger angles have lost digits of their own."""


def centred(radius: Array, unique: Mask, name: str = "rotations") -> None:
    """Check that the samples of each joint have a unique mean and are less than half a turn from it.

    `radius` is the greatest rotation angle from the mean, NaN for a joint without samples.
    """
    if not np.isfinite(radius).any():
        raise ValueError(f"{name}: expected at least one sample, got none")
    for joint, angle in enumerate(radius):
        reach = f"{angle:.4f} rad ({math.degrees(angle):.1f}°) at joint {joint}"
        if angle > math.pi - _CUT:
            raise ValueError(
                f"{name}: samples must be less than π − {_CUT:g} rad from their mean, but reach {reach}; leave out this joint"
            )
        if not unique[joint]:
            raise ValueError(f"{name}: the mean is not unique, samples reach {reach}; leave out this joint")


def scores(value: Any, shape: tuple[int, ...], most: int) -> Array:
    """Return `value` as parameters ``(frames, *shape, k)`` of at most so many geodesics."""
    array = floats(value, "scores")
    if array.ndim != len(shape) + 2 or array.shape[1:-1] != shape or array.shape[-1] > most:
        expected = ", ".join(["frames", *map(str, shape), f"at most {most}"])
        raise ValueError(f"scores: expected shape ({expected}) as in fit, got {array.shape}")
    if (np.abs(array) > _MOST).any():
        raise ValueError(
            f"scores: expected angles of at most {_MOST:g} rad, got {np.nanmax(np.abs(array)):g}"
        )
    return array
