"""Masks of filters: weights in time."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quatfilt._validation.arrays import floats

_LONGEST_REACH = 5000
"""Frames, weighted: with longer masks, or a smaller sum of their weights, rotations would move by more turns than sine
and cosine compute exactly in float32."""


def mask(value: Any, name: str) -> NDArray[np.float64]:
    """Return `value` as weights ``(2k + 1,)``, the largest of them 1 or −1."""
    array = floats(value, name).astype(np.float64)
    if array.ndim != 1 or len(array) % 2 == 0:
        raise ValueError(f"{name}: expected an odd number of weights, shape (2k + 1,), got {array.shape}")
    if not np.isfinite(array).all():
        worst = array[~np.isfinite(array)][0]
        raise ValueError(f"{name}: expected finite weights, got {worst}")
    largest = np.abs(array).max()
    array = array / (largest or 1)
    reach = np.abs(array) @ np.abs(np.arange(len(array)) - len(array) // 2)
    if reach > _LONGEST_REACH * abs(array.sum()) or largest == 0:
        raise ValueError(f"{name}: expected weights whose sum is not near 0, got {array.sum() * largest:g}")
    return array
