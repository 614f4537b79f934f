"""Confidence of samples, from 0 to 1."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quatfilt._typing import Array
from quatfilt._validation.arrays import floats


def confidence(value: ArrayLike | None, frames: int, joints: int, dtype: np.dtype[Any]) -> Array | None:
    """Return `value`, ``(frames,)`` or ``(frames, joints)`` in 0…1, as ``(frames, joints)``; NaN counts as 0."""
    if value is None:
        return None
    array = floats(value, "confidence")
    if array.shape == (frames,):
        array = np.repeat(array[:, None], joints, axis=1)
    if array.shape != (frames, joints):
        raise ValueError(
            f"confidence: expected shape ({frames},) or ({frames}, {joints}), got {array.shape}",
        )
    return np.require(_shares(array), dtype, ("C_CONTIGUOUS", "ALIGNED"))


def pose_confidence(value: Any, joints: int) -> NDArray[np.float64] | None:
    """Return `value`, a number or one per joint in 0…1, as ``(joints,)``; NaN counts as 0."""
    if value is None:
        return None
    array = floats(value, "confidence").astype(np.float64)
    if array.shape not in ((), (joints,)):
        raise ValueError(
            f"confidence: expected a number or one per joint, shape ({joints},), got {array.shape}"
        )
    return np.ascontiguousarray(np.broadcast_to(_shares(array), joints))


_ROUNDING = 1e-5
"""By how much a confidence may lie outside 0…1: sums and exponentials of float32 do."""


def _shares(confidence: NDArray[Any]) -> NDArray[Any]:
    array = np.where(np.isnan(confidence), 0, confidence)
    if array.size and (array.min() < -_ROUNDING or array.max() > 1 + _ROUNDING):
        worst = array.min() if array.min() < -_ROUNDING else array.max()
        raise ValueError(f"confidence: expected values from 0 to 1, got {worst}")
    return np.clip(array, 0, 1)
